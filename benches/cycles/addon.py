"""The add-on of this checkout in the running Blender, without installing it."""

import importlib.util
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def wheel(profile):
    """The engine's wheel, built from this checkout."""
    sys.path.insert(0, str(ROOT / "addon"))
    from build import build_wheel

    return build_wheel(tempfile.mkdtemp(), profile)


def register(path):
    """Makes the engine PENUMBRA known, with the wheel at `path`; returns the add-on."""
    folder = tempfile.mkdtemp()
    with zipfile.ZipFile(path) as archive:
        archive.extractall(folder)
    sys.path.insert(0, folder)
    source = ROOT / "addon" / "penumbra"
    # Not by its own name, which is that of the engine.
    spec = importlib.util.spec_from_file_location(
        "penumbra_addon", source / "__init__.py", submodule_search_locations=[str(source)]
    )
    addon = sys.modules[spec.name] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(addon)
    addon.register()
    return addon
