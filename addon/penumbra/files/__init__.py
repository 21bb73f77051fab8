"""Export for Penumbra: Blender's own USD and glTF exporters, and what they lose stamped on top."""

from . import operator
from .gltf import glTF2ExportUserExtension

__all__ = ["glTF2ExportUserExtension", "register", "unregister"]

register = operator.register
unregister = operator.unregister
