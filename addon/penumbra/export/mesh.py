"""Meshes as arrays. Nothing here loops over vertices."""

import numpy as np
from penumbra import Scene

from .nodes import POINTINESS, RANDOM_PER_ISLAND


def _array(collection, attribute, width, dtype):
    values = np.empty(len(collection) * width, dtype)
    collection.foreach_get(attribute, values)
    return values


# Types of objects whose data has a position and more for each of its points.
WITH_ATTRIBUTES = {"MESH", "CURVES", "POINTCLOUD"}


def positions(data):
    """Three numbers for each point of a mesh, of curves or of a point cloud."""
    attribute = data.attributes.get("position") if data is not None else None
    return np.empty(0, np.float32) if attribute is None else _array(attribute.data, "vector", 3, np.float32)


def hand_over(scene, key, mesh, asked):
    """Gives the evaluated mesh to the engine's scene as mesh `key`, with the attributes whose names are `asked` for."""
    mesh.calc_loop_triangles()
    triangles = _array(mesh.loop_triangles, "loops", 3, np.int32)
    arrays = {
        "positions": positions(mesh),
        "corner_verts": _corner_verts(mesh),
        "triangles": triangles,
    }
    domain = mesh.normals_domain
    if domain == "CORNER":
        arrays["normals"] = _array(mesh.corner_normals, "vector", 3, np.float32)
    elif domain == "POINT":
        arrays["normals"] = _array(mesh.vertex_normals, "vector", 3, np.float32)
    slots = mesh.attributes.get("material_index")
    if slots is not None:
        arrays["material_index"] = _array(slots.data, "value", 1, np.int32)
        arrays["triangle_polygons"] = _array(mesh.loop_triangle_polygons, "value", 1, np.int32)
    scene.set_mesh(key, mesh.name, uvs=_uvs(mesh), colors=_colors(mesh), attributes=_attributes(mesh, asked),
                   texture_space=[list(mesh.texspace_location), list(mesh.texspace_size)], **arrays)


def is_known(attribute):
    """True for types that nodes can read."""
    return attribute.data_type in _TYPES


def _corner_verts(mesh):
    attribute = mesh.attributes.get(".corner_vert")
    if attribute is not None:
        return _array(attribute.data, "value", 1, np.int32)
    return _array(mesh.loops, "vertex_index", 1, np.int32)


def _uvs(mesh):
    """UV maps, the one to render with first."""
    layers = sorted(mesh.uv_layers, key=lambda layer: not layer.active_render)
    return [(layer.name, _array(layer.uv, "vector", 2, np.float32)) for layer in layers]


def _colors(mesh):
    """Colour attributes, the one to render with first."""
    first = mesh.color_attributes.render_color_index
    layers = list(mesh.color_attributes)
    if 0 <= first < len(layers):
        layers.insert(0, layers.pop(first))
    return [(layer.name, _array(layer.data, "color", 4, np.float32)) for layer in layers]


# Of a type of attributes, the property of its values, how many numbers they are, and what they are kept in.
_TYPES = {
    "FLOAT": ("value", 1, np.float32),
    "INT": ("value", 1, np.int32),
    "INT8": ("value", 1, np.int32),
    "BOOLEAN": ("value", 1, np.bool_),
    "FLOAT2": ("vector", 2, np.float32),
    "FLOAT_VECTOR": ("vector", 3, np.float32),
    "FLOAT_COLOR": ("color", 4, np.float32),
    "BYTE_COLOR": ("color", 4, np.float32),
}


def _attributes(mesh, asked):
    """What the Attribute node finds beside UV maps and colour attributes, as four numbers for each point or corner."""
    known = {layer.name for layer in (*mesh.uv_layers, *mesh.color_attributes)}
    found = []
    for name in sorted(asked - known):
        attribute = mesh.attributes.get(name)
        if attribute is None or not is_known(attribute) or attribute.domain == "EDGE":
            continue
        values = as_colors(attribute)
        if attribute.domain == "FACE":
            values = np.repeat(values, _array(mesh.polygons, "loop_total", 1, np.int32), axis=0)
        found.append((name, np.ascontiguousarray(values).reshape(-1)))
    if asked & {RANDOM_PER_ISLAND, POINTINESS}:
        edges = _array(mesh.edges, "vertices", 2, np.int32)
    if RANDOM_PER_ISLAND in asked:
        found.append((RANDOM_PER_ISLAND, np.repeat(Scene.random_per_island(len(mesh.vertices), edges), 4)))
    if POINTINESS in asked:
        normals = _array(mesh.vertex_normals, "vector", 3, np.float32)
        found.append((POINTINESS, np.repeat(Scene.pointiness(positions(mesh), normals, edges), 4)))
    return found


def as_colors(attribute):
    """A number is a grey; what a vector lacks is 0."""
    name, width, dtype = _TYPES[attribute.data_type]
    values = _array(attribute.data, name, width, dtype).astype(np.float32).reshape(-1, width)
    colors = np.ones((len(values), 4), np.float32)
    colors[:, :3] = 0.0
    if width == 1:
        colors[:, :3] = values
    else:
        colors[:, :width] = values
    return colors
