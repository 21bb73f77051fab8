"""Penumbra inside Blender: a thin door to the engine.

What happens here is copying: properties by their names into one JSON document, meshes and images as
arrays (export/), pictures back into Blender's passes (engine.py). What they mean is decided in Rust.
"""

from . import engine, files, lamps, lent, loaded, panels, properties

# Blender's glTF exporter looks for it here.
from .files import glTF2ExportUserExtension

__all__ = ["glTF2ExportUserExtension", "register", "unregister"]

MODULES = (properties, engine, lamps, panels, lent, files)


def register():
    loaded.note()
    for module in MODULES:
        module.register()


def unregister():
    for module in reversed(MODULES):
        module.unregister()
