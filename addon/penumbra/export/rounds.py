"""Hair curves and point clouds as arrays."""

import numpy as np

from . import mesh

# What Blender takes for the radius of a point that has none.
_RADIUS = 0.01


def hand_over(scene, key, data, moving):
    """Gives curves or points to the engine's scene as shape `key`; False where there are none."""
    count = len(data.points)
    if count == 0 or data.attributes.get("position") is None:
        return False
    radii = np.full(count, _RADIUS, np.float32)
    radius = data.attributes.get("radius")
    if radius is not None:
        radius.data.foreach_get("value", radii)
    ends = np.empty(0, np.uint32)
    if hasattr(data, "curves"):
        offsets = np.empty(len(data.curve_offset_data), np.int32)
        data.curve_offset_data.foreach_get("value", offsets)
        ends = offsets[1:].astype(np.uint32)
    scene.set_rounds(key, data.name, mesh.positions(data), radii, ends, True, moving=moving)
    return True
