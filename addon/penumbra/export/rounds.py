"""Hair curves and point clouds as arrays."""

import numpy as np

from . import mesh

# What Blender takes for the radius of a point that has none.
_RADIUS = 0.01


def hand_over(scene, key, data, moving, asked):
    """Gives curves or points to the engine's scene as shape `key`, with the attributes whose names are `asked` for; False
    where there are none.
    """
    count = len(data.points)
    if count == 0 or data.attributes.get("position") is None:
        return False
    radii = np.full(count, _RADIUS, np.float32)
    radius = data.attributes.get("radius")
    if radius is not None:
        radius.data.foreach_get("value", radii)
    ends, uvs = np.empty(0, np.uint32), []
    if hasattr(data, "curves"):
        uvs = _uvs(data)
        offsets = np.empty(len(data.curve_offset_data), np.int32)
        data.curve_offset_data.foreach_get("value", offsets)
        ends = offsets[1:].astype(np.uint32)
    scene.set_rounds(key, data.name, mesh.positions(data), radii, ends, True, uvs, moving, _attributes(data, asked, uvs))
    return True


def _uvs(curves):
    """What Cycles takes for UV maps: pairs of numbers, one for each curve; that to render with is the first one."""
    pairs = (layer for layer in curves.attributes if layer.domain == "CURVE" and layer.data_type == "FLOAT2")
    return [(layer.name, mesh.as_colors(layer)[:, :2].flatten()) for layer in pairs]


def _attributes(data, asked, uvs):
    """What the Attribute node finds beside them, as four numbers for each point or curve."""
    named = (data.attributes.get(name) for name in sorted(asked - {name for name, _ in uvs}))
    return [(layer.name, mesh.as_colors(layer).reshape(-1)) for layer in named
            if layer is not None and mesh.is_known(layer) and layer.domain in {"POINT", "CURVE"}]
