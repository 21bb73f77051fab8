"""Runs in a headless Blender: installs the extension's zip, and takes it away again where asked.

    python install.py FILE.zip [remove]
"""

import sys

import bpy  # isort: skip (what follows is found through it)
import addon_utils

bpy.ops.wm.read_factory_settings(use_empty=True)
path = sys.argv[1]
print(bpy.ops.extensions.package_install_files(filepath=path, repo="user_default", enable_on_install=True))
if "remove" in sys.argv:
    addon_utils.disable("bl_ext.user_default.penumbra", default_set=True)
    print(bpy.ops.extensions.package_uninstall(repo_index=0, pkg_id="penumbra"))
else:
    addon_utils.disable("bl_ext.user_default.penumbra")
