"""Runs in a headless Blender: the extension installed, enabled, disabled, installed again and uninstalled.

    python lifecycle.py FILE.zip ANSWER.json

The answer has, step by step, what Blender holds then; BLENDER_USER_RESOURCES is a folder of its own.
"""

import json
import os
import sys

import bpy  # isort: skip (what follows is found through it)
import addon_utils

EXTENSION = "bl_ext.user_default.penumbra"
MENUS = ("TOPBAR_MT_file_export", "TOPBAR_MT_file_import", "VIEW3D_MT_add", "TOPBAR_MT_editor_menus")


def held():
    """What an add-on may leave in Blender, as plain data."""
    panels = [panel for panel in bpy.types.Panel.__subclasses__() if hasattr(bpy.types, panel.__name__)]
    handlers = [name for name in dir(bpy.app.handlers) if isinstance(getattr(bpy.app.handlers, name), list)]
    holders = (bpy.types.Scene, bpy.types.ViewLayer, bpy.types.Object, bpy.types.WindowManager)
    return {
        "classes": sorted(name for name in dir(bpy.types) if "penumbra" in name.lower()),
        "engines": {panel.__name__: sorted(getattr(panel, "COMPAT_ENGINES", ())) for panel in panels},
        "own_engines": sorted(panel.__name__ for panel in panels if "COMPAT_ENGINES" in panel.__dict__),
        "handlers": {name: [f.__qualname__ for f in getattr(bpy.app.handlers, name)] for name in handlers},
        "menus": {
            name: [function.__module__ for function in getattr(getattr(bpy.types, name).draw, "_draw_funcs", ())]
            for name in MENUS
        },
        "properties": {holder.__name__: sorted(holder.bl_rna.properties.keys()) for holder in holders},
        "addons": sorted(addon.module for addon in bpy.context.preferences.addons),
    }


def files():
    """All files of the user's folder."""
    root = os.environ["BLENDER_USER_RESOURCES"]
    found = [os.path.relpath(os.path.join(folder, name), root) for folder, _, names in os.walk(root) for name in names]
    return sorted(found)


def install(path):
    """Installs and enables."""
    bpy.ops.extensions.package_install_files(filepath=path, repo="user_default", enable_on_install=True)


def main():
    path, target = sys.argv[1:]
    bpy.ops.wm.read_factory_settings(use_empty=True)
    steps = {}

    def step(name):
        steps[name] = {"held": held(), "files": files(),
                       "modules": sorted(name for name in sys.modules if name.startswith(EXTENSION))}

    step("before")
    install(path)
    step("installed")
    addon_utils.disable(EXTENSION, default_set=True)
    step("disabled")
    addon_utils.enable(EXTENSION, default_set=True)
    step("enabled")
    install(path)
    step("installed again")
    repo = next(i for i, repo in enumerate(bpy.context.preferences.extensions.repos) if repo.module == "user_default")
    bpy.ops.extensions.package_uninstall(repo_index=repo, pkg_id="penumbra")
    step("uninstalled")
    with open(target, "w") as file:
        json.dump(steps, file)


main()
