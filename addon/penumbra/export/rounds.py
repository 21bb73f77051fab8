"""Hair curves and point clouds as arrays."""

import numpy as np

# What Blender takes for the radius of a point that has none.
_RADIUS = 0.01


def hand_over(scene, key, data):
    """Gives curves or points to the engine's scene as shape `key`; False where there are none."""
    count = len(data.points)
    position = data.attributes.get("position")
    if count == 0 or position is None:
        return False
    positions = np.empty(count * 3, np.float32)
    position.data.foreach_get("vector", positions)
    radii = np.full(count, _RADIUS, np.float32)
    radius = data.attributes.get("radius")
    if radius is not None:
        radius.data.foreach_get("value", radii)
    ends = np.empty(0, np.uint32)
    if hasattr(data, "curves"):
        offsets = np.empty(len(data.curve_offset_data), np.int32)
        data.curve_offset_data.foreach_get("value", offsets)
        ends = offsets[1:].astype(np.uint32)
    scene.set_rounds(key, data.name, positions, radii, ends, True)
    return True
