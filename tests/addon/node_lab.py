"""Every function node beside Cycles: a wall of glowing tiles, one for each node and setting.

What goes in varies over a tile: x from left to right, y from bottom to top, and a colour of both. What comes out glows
as 1 + v / 4, held between 0 and 4.
"""

import math

import bpy

import scenes

TILE = 10
"""Pixels on each side of a tile."""


def _enum(node_type, name):
    return [item.identifier for item in getattr(bpy.types, node_type).bl_rna.properties[name].enum_items]


class Tile:
    """A material in the making: its tree, and the sockets that vary."""

    def __init__(self, name):
        self.material = bpy.data.materials.new(name)
        self.material.use_nodes = True
        self.tree = self.material.node_tree
        self.tree.nodes.clear()
        place = self.node("ShaderNodeTexCoord")
        scaled = self.node("ShaderNodeVectorMath", operation="MULTIPLY")
        scaled.inputs[1].default_value = (4.0, 4.0, 1.0)
        self.link(place.outputs["Object"], scaled.inputs[0])
        split = self.node("ShaderNodeSeparateXYZ")
        self.link(scaled.outputs[0], split.inputs[0])
        self.x, self.y = split.outputs["X"], split.outputs["Y"]
        color = self.node("ShaderNodeVectorMath", operation="MULTIPLY_ADD")
        color.inputs[1].default_value, color.inputs[2].default_value = (0.8, 0.9, 1.0), (0.5, 0.45, 0.3)
        self.link(place.outputs["Object"], color.inputs[0])
        self.vector, self.color = scaled.outputs[0], color.outputs[0]

    def node(self, kind, inputs=(), **properties):
        """A node with properties; inputs are sockets to link and values, by name or index."""
        node = self.tree.nodes.new(kind)
        for name, value in properties.items():
            setattr(node, name, value)
        for key, value in dict(inputs).items():
            if isinstance(value, bpy.types.NodeSocket):
                self.link(value, node.inputs[key])
            else:
                node.inputs[key].default_value = value
        return node

    def link(self, start, end):
        self.tree.links.new(start, end)

    def show(self, socket):
        """Lets `socket` glow."""
        shown = self.node("ShaderNodeVectorMath", {0: socket}, operation="MULTIPLY_ADD")
        shown.inputs[1].default_value, shown.inputs[2].default_value = (0.25,) * 3, (1.0,) * 3
        for operation, bound in (("MINIMUM", 4.0), ("MAXIMUM", 0.0)):
            shown = self.node("ShaderNodeVectorMath", {0: shown.outputs[0], 1: (bound,) * 3}, operation=operation)
        glow = self.node("ShaderNodeEmission", {"Color": shown.outputs[0]})
        self.link(glow.outputs[0], self.node("ShaderNodeOutputMaterial").inputs["Surface"])


def _math():
    for operation in _enum("ShaderNodeMath", "operation"):
        for clamp in (False, True) if operation == "ADD" else (False,):
            yield f"Math {operation} {clamp}", lambda t, o=operation, c=clamp: t.node(
                "ShaderNodeMath", {0: t.x, 1: t.y, 2: 0.3}, operation=o, use_clamp=c).outputs[0]


def _vector_math():
    for operation in _enum("ShaderNodeVectorMath", "operation"):
        def make(t, o=operation):
            node = t.node("ShaderNodeVectorMath", {0: t.vector, 1: t.color}, operation=o)
            third = node.inputs[2]
            third.default_value = (0.3, 0.5, -0.2) if third.type == "VECTOR" else 0.3
            if "Scale" in node.inputs:
                node.inputs["Scale"].default_value = 1.7
            return next(socket for socket in node.outputs if socket.enabled)

        yield f"Vector Math {operation}", make


def _ranges():
    for kind in _enum("ShaderNodeMapRange", "interpolation_type"):
        yield f"Map Range {kind}", lambda t, k=kind: t.node(
            "ShaderNodeMapRange", {"Value": t.x, "From Min": -0.8, "From Max": 1.1, "To Min": -1.0, "To Max": 2.0,
                                   **({"Steps": 3.0} if k == "STEPPED" else {})}, interpolation_type=k,
            clamp=k != "LINEAR").outputs[0]
    for kind in _enum("ShaderNodeClamp", "clamp_type"):
        yield f"Clamp {kind}", lambda t, k=kind: t.node(
            "ShaderNodeClamp", {"Value": t.x, "Min": t.y, "Max": 0.4}, clamp_type=k).outputs[0]


def _mix():
    for blend in _enum("ShaderNodeMix", "blend_type"):
        def make(t, b=blend):
            node = t.node("ShaderNodeMix", data_type="RGBA", blend_type=b)
            node.inputs["Factor"].default_value = 0.7
            a, b = (socket for socket in node.inputs if socket.type == "RGBA")
            t.link(t.color, a)
            b.default_value = (0.6, 0.3, 0.8, 1.0)
            return next(socket for socket in node.outputs if socket.type == "RGBA")

        yield f"Mix {blend}", make
    yield "Mix, numbers", lambda t: t.node("ShaderNodeMix", {0: 0.3, 2: t.x, 3: t.y}, data_type="FLOAT").outputs[0]


def _ramp(t, mode, interpolation, factor=None):
    node = t.node("ShaderNodeValToRGB", {"Fac": factor or t.node("ShaderNodeMath", {0: t.x, 1: 0.25, 2: 0.5},
                                                                 operation="MULTIPLY_ADD").outputs[0]})
    ramp = node.color_ramp
    ramp.color_mode, ramp.interpolation = mode, interpolation
    ramp.elements[0].color, ramp.elements[1].color = (0.1, 0.2, 0.9, 1.0), (0.9, 0.4, 0.1, 0.5)
    ramp.elements.new(0.4).color = (0.2, 0.8, 0.3, 1.0)
    return node


def _colors():
    for interpolation in ("EASE", "CARDINAL", "LINEAR", "B_SPLINE", "CONSTANT"):
        yield f"ColorRamp {interpolation}", lambda t, i=interpolation: _ramp(t, "RGB", i).outputs[0]
    for mode in ("HSV", "HSL"):
        yield f"ColorRamp {mode}", lambda t, m=mode: _ramp(t, m, "LINEAR").outputs[0]
    yield "ColorRamp alpha", lambda t: _ramp(t, "RGB", "LINEAR").outputs[1]

    def curve(t, kind, socket, source):
        node = t.node(kind, {socket: source})
        for i, curve in enumerate(node.mapping.curves):
            curve.points.new(0.35, 0.2 + 0.1 * i)
        node.mapping.update()
        return node.outputs[0]

    yield "RGB Curves", lambda t: curve(t, "ShaderNodeRGBCurve", "Color", t.color)
    yield "Vector Curves", lambda t: curve(t, "ShaderNodeVectorCurve", "Vector", t.vector)
    yield "Float Curve", lambda t: curve(t, "ShaderNodeFloatCurve", "Value", t.x)
    simple = (
        ("Hue/Saturation", "ShaderNodeHueSaturation", "Color", {"Hue": 0.7, "Saturation": 1.3, "Value": 0.8, "Fac": 0.9}),
        ("Bright/Contrast", "ShaderNodeBrightContrast", "Color", {1: 0.2, 2: 0.4}),
        ("Gamma", "ShaderNodeGamma", "Color", {"Gamma": 2.2}),
        ("Invert", "ShaderNodeInvert", "Color", {"Fac": 0.7}),
        ("RGB to BW", "ShaderNodeRGBToBW", "Color", {}),
    )
    for name, kind, socket, values in simple:
        yield name, lambda t, k=kind, s=socket, v=values: t.node(k, {**v, s: t.color}).outputs[0]

    def warm(t, kind, socket, low, high):
        value = t.node("ShaderNodeMapRange", {"Value": t.x, "From Min": -2.0, "From Max": 2.0, "To Min": low, "To Max": high})
        return t.node(kind, {socket: value.outputs[0]}).outputs[0]

    yield "Blackbody", lambda t: warm(t, "ShaderNodeBlackbody", 0, 900.0, 12000.0)
    yield "Wavelength", lambda t: warm(t, "ShaderNodeWavelength", 0, 370.0, 790.0)
    for mode in ("RGB", "HSV", "HSL"):
        def separated(t, m=mode):
            parts = t.node("ShaderNodeSeparateColor", {0: t.color}, mode=m)
            return t.node("ShaderNodeCombineXYZ", {i: parts.outputs[i] for i in range(3)}).outputs[0]

        yield f"Separate Color {mode}", separated
        yield f"Combine Color {mode}", lambda t, m=mode: t.node(
            "ShaderNodeCombineColor", {0: t.node("ShaderNodeMath", {0: t.x, 1: 0.25, 2: 0.5},
                                                 operation="MULTIPLY_ADD").outputs[0], 1: 0.7, 2: t.y}, mode=m).outputs[0]


def _vectors():
    for kind in _enum("ShaderNodeMapping", "vector_type"):
        yield f"Mapping {kind}", lambda t, k=kind: t.node(
            "ShaderNodeMapping", {"Vector": t.vector, "Location": (0.3, -0.2, 0.1), "Rotation": (0.4, 0.2, 0.9),
                                  "Scale": (1.5, 0.7, 2.0)} if k in {"POINT", "TEXTURE"} else
            {"Vector": t.vector, "Rotation": (0.4, 0.2, 0.9), "Scale": (1.5, 0.7, 2.0)}, vector_type=k).outputs[0]
    for kind in _enum("ShaderNodeVectorRotate", "rotation_type"):
        def rotated(t, k=kind):
            node = t.node("ShaderNodeVectorRotate", {"Vector": t.vector, "Center": (0.2, 0.1, 0.0)}, rotation_type=k)
            for socket in node.inputs:
                if socket.name == "Angle":
                    socket.default_value = 0.7
                elif socket.name == "Axis":
                    socket.default_value = (0.3, 0.5, 1.0)
                elif socket.name == "Rotation":
                    socket.default_value = (0.3, 0.5, 1.0)
            return node.outputs[0]

        yield f"Vector Rotate {kind}", rotated
    for kind in _enum("ShaderNodeVectorTransform", "vector_type"):
        for start, end in (("OBJECT", "WORLD"), ("WORLD", "CAMERA")):
            yield f"Vector Transform {kind} {start} {end}", lambda t, k=kind, s=start, e=end: t.node(
                "ShaderNodeVectorTransform", {0: t.vector}, vector_type=k, convert_from=s, convert_to=e).outputs[0]
    for output in (0, 1):
        yield f"Normal {output}", lambda t, o=output: t.node("ShaderNodeNormal", {0: t.vector}).outputs[o]
    for space in ("TANGENT", "OBJECT", "WORLD"):
        yield f"Normal Map {space}", lambda t, s=space: t.node(
            "ShaderNodeNormalMap", {"Color": (0.6, 0.3, 0.9, 1.0), "Strength": 0.8}, space=s).outputs[0]
    yield "Bump", lambda t: t.node("ShaderNodeBump", {"Height": t.x, "Strength": 0.6, "Distance": 0.5}).outputs[0]


def _inputs():
    for kind in ("ShaderNodeNewGeometry", "ShaderNodeObjectInfo", "ShaderNodeCameraData", "ShaderNodeLightPath",
                 "ShaderNodeTexCoord"):
        probe = Tile("probe")
        names = [socket.name for socket in probe.node(kind).outputs if socket.enabled]
        bpy.data.materials.remove(probe.material)
        for name in names:
            yield f"{kind[10:]} {name}", lambda t, k=kind, n=name: t.node(k).outputs[n]
    for name in ("Fresnel", "Facing"):
        yield f"Layer Weight {name}", lambda t, n=name: t.node(
            "ShaderNodeLayerWeight", {"Blend": 0.4, "Normal": t.node(
                "ShaderNodeVectorMath", {0: t.vector, 1: (0.2, 0.2, 1.0)}, operation="ADD").outputs[0]}).outputs[n]
    yield "Fresnel", lambda t: t.node("ShaderNodeFresnel", {"IOR": 1.6, "Normal": t.node(
        "ShaderNodeVectorMath", {0: t.vector, 1: (0.2, 0.2, 1.0)}, operation="ADD").outputs[0]}).outputs[0]
    # Around the other axes there is none on what is flat.
    yield "Tangent", lambda t: t.node("ShaderNodeTangent", direction_type="RADIAL", axis="Z").outputs[0]
    for kind, name in (("OBJECT", "mine"), ("OBJECT", "color"), ("INSTANCER", "mine"), ("VIEW_LAYER", "mine"),
                       ("OBJECT", "not there")):
        for output in ("Color", "Vector", "Fac", "Alpha"):
            yield f"Attribute {kind} {name} {output}", lambda t, k=kind, n=name, o=output: t.node(
                "ShaderNodeAttribute", attribute_type=k, attribute_name=n).outputs[o]
    yield "UV Map", lambda t: t.node("ShaderNodeUVMap", uv_map="UVMap").outputs[0]
    yield "Color Attribute", lambda t: t.node("ShaderNodeVertexColor", layer_name="Paint").outputs[0]
    yield "Attribute", lambda t: t.node("ShaderNodeAttribute", attribute_name="Paint").outputs["Vector"]


def cases():
    """Names and makers of all tiles."""
    return [case for group in (_math, _vector_math, _ranges, _mix, _colors, _vectors, _inputs) for case in group()]


def wall():
    """The scene; returns the tiles' names, row by row from the bottom, and how many are in a row."""
    made = cases()
    columns = math.ceil(math.sqrt(len(made)))
    rows = math.ceil(len(made) / columns)
    for number, (name, make) in enumerate(made):
        tile = Tile(name)
        tile.show(make(tile))
        mesh = bpy.data.meshes.new(name)
        mesh.from_pydata([(-0.5, -0.5, 0), (0.5, -0.5, 0), (0.5, 0.5, 0), (-0.5, 0.5, 0)], [], [(0, 1, 2, 3)])
        mesh.uv_layers.new(name="UVMap").data.foreach_set("uv", [0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 1.0])
        paint = mesh.color_attributes.new("Paint", "FLOAT_COLOR", "POINT")
        paint.data.foreach_set("color", [0.1, 0.2, 0.3, 1.0, 0.9, 0.1, 0.2, 1.0, 0.3, 0.8, 0.4, 1.0, 0.6, 0.5, 0.9, 1.0])
        mesh.materials.append(tile.material)
        obj = scenes.add(name, mesh, location=(number % columns + 0.5 - columns / 2, number // columns + 0.5 - rows / 2, 0.0),
                         pass_index=number % 7, color=(0.2, 0.4, 0.7, 1.0))
        obj.rotation_euler = (0.0, 0.0, 0.0)
        obj["mine"] = (0.3, 0.6, 0.1 * (number % 7))
    camera = bpy.data.cameras.new("Camera")
    camera.type, camera.ortho_scale, camera.sensor_fit = "ORTHO", columns, "HORIZONTAL"
    bpy.context.scene["mine"] = 0.7
    bpy.context.scene.camera = scenes.add("Camera", camera, location=(0, 0, 5))
    scenes.world(0.0)
    return [name for name, _ in made], columns, rows
