"""Node trees as plain data."""

import bpy

# What every node has: its place in the editor, not what it computes.
_COMMON = {
    "rna_type", "type", "location", "location_absolute", "width", "height", "dimensions", "name", "label",
    "inputs", "outputs", "internal_links", "parent", "warning_propagation", "use_custom_color", "color",
    "color_tag", "select", "show_options", "show_preview", "hide", "mute", "show_texture", "bl_idname", "bl_label",
    "bl_description", "bl_icon", "bl_static_type", "bl_width_default", "bl_width_min", "bl_width_max",
    "bl_height_default", "bl_height_min", "bl_height_max", "debug_zone_body_lazy_function_graph",
    "debug_zone_lazy_function_graph", "node_tree",
}


# The attribute that stands for Random Per Island.
RANDOM_PER_ISLAND = "random per island"
# That for Pointiness.
POINTINESS = "pointiness of the mesh"


def dump(tree, context):
    """The tree as dicts and lists; `context` takes in the images that its nodes name."""
    nodes = list(tree.nodes)
    index = {node.name: i for i, node in enumerate(nodes)}
    links = {}
    for link in tree.links:
        if link.is_valid and not link.is_muted:
            output = _index(link.from_node.outputs, link.from_socket)
            key = (link.to_node.name, link.to_socket.identifier)
            links.setdefault(key, [index[link.from_node.name], output])
    return {"name": tree.name, "nodes": [_node(node, links, context) for node in nodes]}


def _index(sockets, socket):
    return next(i for i, other in enumerate(sockets) if other == socket)


def _node(node, links, context):
    data = {
        "name": node.name,
        "type": node.bl_idname,
        "mute": node.mute,
        "inputs": [_input(socket, links.get((node.name, socket.identifier))) for socket in node.inputs],
        "outputs": [_socket(socket) for socket in node.outputs],
        "properties": _properties(node, context),
    }
    if node.mute:
        data["internal_links"] = [
            [_index(node.inputs, link.from_socket), _index(node.outputs, link.to_socket)]
            for link in node.internal_links
        ]
    tree = getattr(node, "node_tree", None)
    if tree is not None:
        data["tree"] = dump(tree, context)
    return data


def _socket(socket):
    return {
        "id": socket.identifier,
        "name": socket.name,
        "type": socket.type,
        "enabled": socket.enabled,
        "value": plain(getattr(socket, "default_value", None)),
    }


def _input(socket, link):
    data = _socket(socket)
    data["hide_value"] = socket.hide_value
    if link is not None:
        data["link"] = link
    return data


def plain(value):
    """A number, string or list for any property's value; None for what is no plain data."""
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    if hasattr(value, "__len__"):
        try:
            return [float(x) for x in value]
        except TypeError:
            return None
    return None


def _properties(node, context):
    data = {}
    for prop in node.bl_rna.properties:
        name = prop.identifier
        if name in _COMMON:
            continue
        value = getattr(node, name, None)
        if value is None:
            continue
        kind = type(value).__name__
        if kind == "Image":
            data[name] = context.image(value, getattr(node, "image_user", None))
        elif kind == "ColorRamp":
            data[name] = _ramp(value)
        elif kind == "CurveMapping":
            data[name] = _curves(value)
        elif kind == "Text":
            data[name] = value.as_string()
        elif name == "filepath":
            data[name] = bpy.path.abspath(value, library=node.id_data.library)
        elif kind == "Object":
            data[name] = context.object_matrix(value)
        else:
            value = plain(value)
            if value is not None:
                data[name] = value
    return data


def _ramp(ramp):
    """256 colours, which is how fine Cycles takes a ramp."""
    return {
        "constant": ramp.interpolation == "CONSTANT",
        "table": [list(map(float, ramp.evaluate(i / 255.0))) for i in range(256)],
    }


def _curves(mapping):
    """Each curve as 257 values over the range of its points, and how it goes on beyond them."""
    mapping.initialize()
    low = min((p.location[0] for curve in mapping.curves for p in curve.points), default=0.0)
    high = max((p.location[0] for curve in mapping.curves for p in curve.points), default=1.0)
    low, high = min(low, 0.0), max(high, 1.0)
    steps = [low + (high - low) * i / 256.0 for i in range(257)]
    return {
        "range": [low, high],
        "extend": mapping.extend == "EXTRAPOLATED",
        "curves": [[float(mapping.evaluate(curve, x)) for x in steps] for curve in mapping.curves],
    }


def _all_nodes():
    """Every node of every material and shader group."""
    trees = [material.node_tree for material in bpy.data.materials if material.node_tree is not None]
    trees += [tree for tree in bpy.data.node_groups if tree.type == "SHADER"]
    return (node for tree in trees for node in tree.nodes)


def attributes_asked():
    """Names of the geometry's attributes that some material asks for; RANDOM_PER_ISLAND and POINTINESS stand for those
    numbers.
    """
    asked = set()
    for node in _all_nodes():
        if node.type == "ATTRIBUTE" and node.attribute_type == "GEOMETRY" and node.attribute_name:
            asked.add(node.attribute_name)
        elif node.type == "VERTEX_COLOR" and node.layer_name:
            asked.add(node.layer_name)
        elif node.type == "NEW_GEOMETRY":
            asked.update(name for output, name in (("Random Per Island", RANDOM_PER_ISLAND), ("Pointiness", POINTINESS))
                         if node.outputs[output].is_linked)
    return frozenset(asked)


def properties_asked():
    """Type and name of what materials ask of objects, instancers and the view layer."""
    asked = (node for node in _all_nodes() if node.type == "ATTRIBUTE" and node.attribute_type != "GEOMETRY")
    return sorted({(node.attribute_type, node.attribute_name) for node in asked if node.attribute_name})
