"""From Blender's evaluated scene to what the engine's Scene takes."""

from . import motion
from .scene import Exporter

__all__ = ["Exporter", "motion"]
