"""More scenes for Penumbra and Cycles alike: reliefs, colours in a shader's place, values beyond what is physical, lamps
with nodes.
"""


import math

import bpy

import scenes


def _tree(name):
    """A material of no node but its output, and its tree."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    material.node_tree.nodes.clear()
    return material, material.node_tree


def _node(tree, kind, inputs=(), **properties):
    """A node with properties; inputs are sockets to link and values, by name or index."""
    node = tree.nodes.new(kind)
    for name, value in properties.items():
        setattr(node, name, value)
    for key, value in dict(inputs).items():
        if isinstance(value, bpy.types.NodeSocket):
            tree.links.new(value, node.inputs[key])
        else:
            node.inputs[key].default_value = value
    return node


def _output(tree, **sockets):
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    for name, socket in sockets.items():
        tree.links.new(socket, output.inputs[name])


def _waves(tree, scale=2.0):
    """Heights that are smooth, in object coordinates."""
    place = _node(tree, "ShaderNodeTexCoord").outputs["Object"]
    return _node(tree, "ShaderNodeTexWave", {"Vector": place, "Scale": scale, "Distortion": 1.0, "Detail": 0.0})


def _relief(kind, method="BUMP", **displacement):
    """Two balls and a floor with a relief; one ball has a normal of its own for a part of it."""
    scenes.room()
    bpy.data.objects.remove(bpy.data.objects["Cube"])
    scenes.lamp("AREA", (2.0, -2.0, 3.0), (0.6, 0.5, 0.0), energy=150.0, size=1.0)
    scenes.world(0.2)
    for number in range(3):
        material, tree = _tree(f"Relief {number}")
        waves = _waves(tree)
        if kind == "ShaderNodeDisplacement":
            inputs = {"Height": waves.outputs["Fac"], "Midlevel": 0.3, "Scale": 0.01}
        else:
            inputs = {"Vector": waves.outputs["Color"], "Midlevel": 0.2, "Scale": 0.01}
        node = _node(tree, kind, inputs, **displacement)
        if number == 1:
            bump = _node(tree, "ShaderNodeBump", {"Height": _waves(tree, 5.0).outputs["Fac"], "Distance": 0.006})
            rough = _node(tree, "ShaderNodeBsdfDiffuse", {"Color": (0.7, 0.3, 0.2, 1.0), "Normal": bump.outputs[0]})
            shiny = _node(tree, "ShaderNodeBsdfGlossy", {"Roughness": 0.4})
            facing = _node(tree, "ShaderNodeLayerWeight", {"Blend": 0.3}).outputs["Facing"]
            shader = _node(tree, "ShaderNodeMixShader", {0: facing, 1: rough.outputs[0], 2: shiny.outputs[0]})
        else:
            shader = _node(tree, "ShaderNodeBsdfPrincipled", {"Roughness": 0.5, "Base Color": (0.6, 0.6, 0.7, 1.0)})
        _output(tree, Surface=shader.outputs[0], Displacement=node.outputs[0])
        material.displacement_method = method
        if number == 2:
            bpy.data.objects["Plane"].data.materials[0] = material
            continue
        bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, radius=1.0, location=(2.2 * number - 1.1, 0, 1))
        bpy.ops.object.shade_smooth()
        bpy.context.object.data.materials.append(material)
        bpy.context.object.scale = (1.0, 0.8, 1.2)


def relief():
    _relief("ShaderNodeDisplacement")


def relief_of_world():
    _relief("ShaderNodeDisplacement", space="WORLD")


def relief_of_vectors():
    _relief("ShaderNodeVectorDisplacement", space="OBJECT")


def relief_of_tangents():
    _relief("ShaderNodeVectorDisplacement")


def relief_of_color():
    """A texture linked to the socket as it is."""
    _relief("ShaderNodeDisplacement")
    for material in bpy.data.materials:
        tree = material.node_tree
        for node in [node for node in tree.nodes if node.bl_idname == "ShaderNodeDisplacement"]:
            color = node.inputs["Height"].links[0].from_node.outputs["Color"]
            scaled = _node(tree, "ShaderNodeVectorMath", {0: color, "Scale": 0.01}, operation="SCALE")
            output = next(node for node in tree.nodes if node.bl_idname == "ShaderNodeOutputMaterial")
            tree.links.new(scaled.outputs[0], output.inputs["Displacement"])


def colors_as_shaders():
    """Colours and numbers in a shader's place: of surfaces, within mixes and of the world."""
    scenes.room()
    cube = bpy.data.objects["Cube"]
    for name, glows in (("Cube", None), ("Plane", 0.3)):
        material, tree = _tree(name)
        place = _node(tree, "ShaderNodeTexCoord").outputs["Generated"]
        shown = place
        if glows is not None:
            number = _node(tree, "ShaderNodeSeparateXYZ", {0: place}).outputs["X"]
            matt = _node(tree, "ShaderNodeBsdfDiffuse", {"Color": (0.5, 0.6, 0.3, 1.0)}).outputs[0]
            shown = _node(tree, "ShaderNodeMixShader", {0: glows, 1: matt, 2: number}).outputs[0]
        _output(tree, Surface=shown)
        bpy.data.objects[name].data.materials[0] = material
    cube.location.z = 0.8
    scenes.world(1.0)
    tree = bpy.context.scene.world.node_tree
    # Not the same all over, of which Cycles 4.2 makes a tenth.
    direction = _node(tree, "ShaderNodeTexCoord").outputs["Generated"]
    color = _node(tree, "ShaderNodeVectorMath", {0: direction, 1: (0.1, 0.1, 0.2), 2: (0.1, 0.2, 0.4)}, operation="MULTIPLY_ADD")
    output = next(node for node in tree.nodes if node.bl_idname == "ShaderNodeOutputWorld")
    tree.links.new(color.outputs[0], output.inputs["Surface"])


def bright_colors():
    """Base colours above 1, of all that has one; the camera sees each once."""
    scenes.room()
    bpy.data.objects.remove(bpy.data.objects["Cube"])
    bpy.data.objects.remove(bpy.data.objects["Plane"])
    scenes.lamp("SUN", rotation=(0.5, 0.4, 0.0), energy=2.0)
    scenes.world(0.1)
    bright = (1.5, 1.2, 0.8, 1.0)
    made = [
        scenes.material("Principled", Base_Color=bright, Roughness=0.4),
        scenes.material("Metal", Base_Color=bright, Metallic=1.0, Roughness=0.4),
        scenes.material("Glass", Base_Color=bright, Transmission_Weight=1.0, Roughness=0.3),
        scenes.material("Diffuse", "ShaderNodeBsdfDiffuse", Color=bright),
        scenes.material("Rough", "ShaderNodeBsdfDiffuse", Color=bright, Roughness=0.8),
        scenes.material("Glossy", "ShaderNodeBsdfGlossy", Color=bright, Roughness=0.4),
        scenes.material("Leaf", "ShaderNodeBsdfTranslucent", Color=bright),
    ]
    for number, matter in enumerate(made):
        bpy.ops.mesh.primitive_uv_sphere_add(segments=48, ring_count=24, radius=0.4,
                                             location=(number % 4 - 1.5, 1.0 - number // 4, 0.4))
        bpy.ops.object.shade_smooth()
        bpy.context.object.data.materials.append(matter)


def light_taken():
    """A lamp and a surface that take light away, and a texture beyond 0."""
    scenes.room()
    scenes.lamp("AREA", (1.5, -1.5, 3.0), (0.4, 0.4, 0.0), energy=200.0, size=1.0)
    scenes.lamp("POINT", (-1.5, -1.0, 1.5), energy=-20.0, shadow_soft_size=0.2)
    glow = scenes.material("Dark", "ShaderNodeEmission", Color=(0.2, 0.6, 1.0, 1.0), Strength=-1.0)
    bpy.ops.mesh.primitive_plane_add(size=1, location=(1.5, 0.0, 1.2))
    bpy.context.object.data.materials.append(glow)
    material, tree = _tree("Signed")
    place = _node(tree, "ShaderNodeTexCoord").outputs["Object"]
    _output(tree, Surface=_node(tree, "ShaderNodeEmission", {"Color": place, "Strength": 0.4}).outputs[0])
    bpy.ops.mesh.primitive_uv_sphere_add(segments=32, ring_count=16, radius=0.6, location=(-1.3, 0.8, 0.8))
    bpy.context.object.data.materials.append(material)
    scenes.world(0.1)


def _gobo(kind, coordinates="Normal", where=(0.6, -0.8, 2.6), turn=(0.25, 0.2, 0.3), **properties):
    """A lamp whose colour is a pattern."""
    scenes.room()
    obj = scenes.lamp(kind, where, turn, **properties)
    obj.data.use_nodes = True
    tree = obj.data.node_tree
    emission = next(node for node in tree.nodes if node.type == "EMISSION")
    if coordinates == "Parametric":
        place = _node(tree, "ShaderNodeNewGeometry").outputs["Parametric"]
    else:
        place = _node(tree, "ShaderNodeTexCoord").outputs[coordinates]
    pattern = _node(tree, "ShaderNodeTexWave", {"Vector": place, "Scale": 1.1, "Distortion": 2.0})
    color = _node(tree, "ShaderNodeMix", {0: pattern.outputs["Fac"]}, data_type="RGBA")
    a, b = (socket for socket in color.inputs if socket.type == "RGBA")
    a.default_value, b.default_value = (1.0, 0.3, 0.1, 1.0), (0.1, 0.5, 1.0, 1.0)
    tree.links.new(next(socket for socket in color.outputs if socket.type == "RGBA"), emission.inputs["Color"])
    return tree, emission


def gobo_point():
    _gobo("POINT", energy=100.0, shadow_soft_size=0.1)


def gobo_of_directions():
    """The same coordinates over the sphere, of a point that is scaled."""
    _gobo("POINT", "Parametric", energy=100.0, shadow_soft_size=0.0)


def gobo_spot():
    _gobo("SPOT", "Parametric", energy=300.0, shadow_soft_size=0.05, spot_size=1.4, spot_blend=0.3)


def gobo_of_normals():
    _gobo("SPOT", energy=300.0, shadow_soft_size=0.05, spot_size=1.4, spot_blend=0.3)


def gobo_area():
    _gobo("AREA", "Parametric", energy=150.0, shape="RECTANGLE", size=1.6, size_y=0.8)


def lamp_by_distance():
    """Strength by how far the light goes."""
    tree, emission = _gobo("POINT", energy=60.0, shadow_soft_size=0.1)
    length = _node(tree, "ShaderNodeLightPath").outputs["Ray Length"]
    tree.links.new(_node(tree, "ShaderNodeMath", {0: length, 1: 0.4}, operation="MULTIPLY").outputs[0],
                   emission.inputs["Strength"])


_IES = """IESNA:LM-63-2002
TILT=NONE
1 1000 1 7 3 1 1 0 0 0
1 1 50
0 15 30 45 60 75 90
0 90 180
900 880 700 420 200 60 0
900 700 500 300 150 30 0
900 500 300 120 60 10 0
"""


def lamp_of_ies():
    """A measured distribution from a text."""
    scenes.room()
    obj = scenes.lamp("POINT", (0.6, -0.8, 2.6), (0.25, 0.2, 0.9), energy=1.0, shadow_soft_size=0.1)
    obj.data.use_nodes = True
    tree = obj.data.node_tree
    text = bpy.data.texts.new("Lamp.ies")
    text.from_string(_IES)
    node = _node(tree, "ShaderNodeTexIES", {"Strength": 1.5}, mode="INTERNAL", ies=text)
    emission = next(node for node in tree.nodes if node.type == "EMISSION")
    tree.links.new(node.outputs[0], emission.inputs["Strength"])


def few_bounces_of_lamps():
    """Small lamps that light what the camera sees, and what is lit from there once, and no more."""
    scenes.room()
    for bounces, x in ((0, -1.4), (1, 1.4)):
        obj = scenes.lamp("POINT", (x, -1.0, 1.6), energy=30.0, shadow_soft_size=0.01)
        obj.data.cycles.max_bounces = bounces
    bpy.data.objects["Plane"].data.materials[0] = scenes.material("White", "ShaderNodeBsdfDiffuse", Color=(0.9, 0.9, 0.9, 1.0))


def no_bounces_of_a_wide_lamp():
    """A wide lamp that lights only what the camera sees: what rays find of it by themselves stays, in glass and mirrors,
    and of all that scatters.
    """
    scenes.room()
    wide = scenes.lamp("AREA", (0.5, -0.5, 3.5), energy=200.0, size=3.0)
    wide.data.cycles.max_bounces = 0
    mirror = scenes.material("Mirror", "ShaderNodeBsdfAnisotropic", Color=(0.9, 0.9, 0.9, 1.0), Roughness=0.1)
    bpy.data.objects["Cube"].data.materials[0] = mirror
    bpy.ops.mesh.primitive_uv_sphere_add(segments=48, ring_count=24, radius=0.6, location=(1.5, -0.8, 0.61))
    bpy.ops.object.shade_smooth()
    glass = scenes.material("Glass", "ShaderNodeBsdfGlass", Color=(0.9, 1.0, 0.8, 1.0), Roughness=0.0)
    bpy.context.object.data.materials.append(glass)
    bpy.data.objects["Plane"].data.materials[0] = scenes.material("White", "ShaderNodeBsdfDiffuse", Color=(0.9, 0.9, 0.9, 1.0))


def islands():
    """A colour for each part of a mesh."""
    scenes.room()
    material, tree = _tree("Islands")
    number = _node(tree, "ShaderNodeNewGeometry").outputs["Random Per Island"]
    _output(tree, Surface=_node(tree, "ShaderNodeEmission", {"Color": number}).outputs[0])
    bpy.ops.mesh.primitive_cube_add(size=1, location=(1.5, 0.5, 0.5))
    parts = [bpy.context.object]
    for x in (-2.5, -1.5, 2.5):
        bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=2, radius=0.4, location=(x, 0.0, 0.5))
        parts.append(bpy.context.object)
    for part in parts:
        part.select_set(True)
    bpy.ops.object.join()
    bpy.context.object.data.materials.clear()
    bpy.context.object.data.materials.append(material)


def pointed():
    """Ridges, grooves and corners, smooth and with faces apart, as colours."""
    scenes.room()
    material, tree = _tree("Pointed")
    number = _node(tree, "ShaderNodeNewGeometry").outputs["Pointiness"]
    stretched = _node(tree, "ShaderNodeMath", {0: number, 1: 4.0, 2: -1.5}, operation="MULTIPLY_ADD").outputs[0]
    _output(tree, Surface=_node(tree, "ShaderNodeEmission", {"Color": stretched}).outputs[0])
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=24, y_subdivisions=16, size=1.0, location=(-1.2, -1.4, 0.5))
    hills = bpy.context.object
    hills.scale = (1.6, 1.2, 1.0)
    for vertex in hills.data.vertices:
        x, y, _ = vertex.co
        vertex.co.z = 0.06 * math.sin(13.0 * x) * math.cos(11.0 * y) + 0.1 * abs(y)
    bpy.ops.mesh.primitive_cube_add(size=0.9, location=(0.7, -1.2, 0.5), rotation=(0.2, 0.3, 0.4))
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=3, radius=0.5, location=(1.9, -1.0, 0.6))
    ball = bpy.context.object
    # Faces apart, and an edge that no face has.
    apart = ball.data
    corners = [tuple(apart.vertices[i].co) for face in apart.polygons for i in face.vertices]
    loose = [(0.0, 0.0, 0.5), (0.0, 0.0, 0.9)]
    split = bpy.data.meshes.new("Split")
    split.from_pydata(corners + loose, [(len(corners), len(corners) + 1)],
                      [(3 * i, 3 * i + 1, 3 * i + 2) for i in range(len(apart.polygons))])
    ball.data = split
    for obj in (hills, bpy.data.objects["Cube.001"], ball):
        obj.data.materials.append(material)


def _shows(name, attribute, output="Color"):
    """A material that glows as an attribute."""
    material, tree = _tree(name)
    shown = _node(tree, "ShaderNodeAttribute", attribute_name=attribute).outputs[output]
    _output(tree, Surface=_node(tree, "ShaderNodeEmission", {"Color": shown}).outputs[0])
    return material


def attributes_of_hair():
    """What hair curves and points have of their own, by point and by curve: numbers, pairs, vectors and colours."""
    scenes.room()
    bpy.context.scene.cycles_curves.shape = "THICK"
    kinds = (("FLOAT_COLOR", "POINT", "Color"), ("FLOAT", "CURVE", "Color"), ("FLOAT2", "CURVE", "Vector"),
             ("FLOAT_VECTOR", "POINT", "Fac"), ("INT", "POINT", "Fac"), ("radius", "POINT", "Vector"))
    for number, (kind, domain, output) in enumerate(kinds):
        curves = bpy.data.hair_curves.new(f"Hair {number}")
        curves.add_curves([4] * 6)
        radius = curves.attributes.get("radius") or curves.attributes.new("radius", "FLOAT", "POINT")
        for i in range(6):
            x = number * 0.6 + i * 0.1 - 1.8
            for k, (along, up) in enumerate(((0.0, 0.0), (0.3, 0.3), (-0.2, 0.7), (0.2, 1.2))):
                curves.points[4 * i + k].position = (x, along - 1.5, up - 0.2)
                # Thin at the tip: strands are closed by balls, where Cycles' are open.
                radius.data[4 * i + k].value = 0.035 - 0.011 * k
        # A pair of each curve is a UV map, and its name is one for all that have it.
        shown = {"radius": "radius", "FLOAT2": "pair"}.get(kind, "mine")
        if kind != "radius":
            values = curves.attributes.new(shown, kind, domain)
            width = {"FLOAT": 1, "INT": 1, "FLOAT2": 2, "FLOAT_VECTOR": 3, "FLOAT_COLOR": 4}[kind]
            numbers = [0.1 + 0.8 * ((7 * k * k + 3 * k) % 11) / 11.0 for k in range(len(values.data) * width)]
            cast = (lambda x: round(3.0 * x)) if kind == "INT" else float
            values.data.foreach_set({1: "value", 4: "color"}.get(width, "vector"), [cast(x) for x in numbers])
        curves.materials.append(_shows(f"Shown {number}", shown, output))
        scenes.add(f"Hair {number}", curves)
    mesh = bpy.data.meshes.new("Seeds")
    mesh.from_pydata([(x * 0.5 - 1.0, -2.2, 0.15) for x in range(5)], [], [])
    mesh.attributes.new("mine", "FLOAT_VECTOR", "POINT").data.foreach_set("vector", [0.05 * x for x in range(15)])
    obj = scenes.add("Seeds", mesh)
    tree = bpy.data.node_groups.new("ToPoints", "GeometryNodeTree")
    tree.interface.new_socket("Geometry", in_out="INPUT", socket_type="NodeSocketGeometry")
    tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    first, last = tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")
    to_points, dressed = tree.nodes.new("GeometryNodeMeshToPoints"), tree.nodes.new("GeometryNodeSetMaterial")
    to_points.inputs["Radius"].default_value = 0.15
    dressed.inputs["Material"].default_value = _shows("Shown by points", "mine", "Vector")
    tree.links.new(first.outputs[0], to_points.inputs["Mesh"])
    tree.links.new(to_points.outputs[0], dressed.inputs["Geometry"])
    tree.links.new(dressed.outputs[0], last.inputs[0])
    obj.modifiers.new("Points", "NODES").node_group = tree


def tangents():
    """Radial tangents around each axis, shown as colours."""
    scenes.room()
    for number, axis in enumerate("XYZ"):
        material, tree = _tree(axis)
        tangent = _node(tree, "ShaderNodeTangent", direction_type="RADIAL", axis=axis).outputs[0]
        shown = _node(tree, "ShaderNodeVectorMath", {0: tangent, 1: (0.5,) * 3, 2: (0.5,) * 3}, operation="MULTIPLY_ADD")
        _output(tree, Surface=_node(tree, "ShaderNodeEmission", {"Color": shown.outputs[0]}).outputs[0])
        bpy.ops.mesh.primitive_uv_sphere_add(segments=32, ring_count=16, radius=0.6, location=(1.6 * number - 1.6, -0.8, 1.0),
                                             rotation=(0.4, 0.3, 0.2))
        bpy.ops.object.shade_smooth()
        bpy.context.object.data.materials.append(material)


def film_through_glass():
    """Clear, rough and too rough glass before a transparent film."""
    scenes.room()
    bpy.data.objects.remove(bpy.data.objects["Cube"])
    bpy.data.objects["Plane"].location.z = -1.0
    bpy.data.objects["Plane"].scale = (0.25, 0.25, 1.0)
    scenes.lamp("SUN", rotation=(0.5, 0.4, 0.0), energy=2.0)
    scenes.world(0.3)
    for number, roughness in enumerate((0.0, 0.15, 0.4)):
        bpy.ops.mesh.primitive_uv_sphere_add(segments=48, ring_count=24, radius=0.6, location=(1.5 * number - 1.5, 0.0, 0.4))
        bpy.ops.object.shade_smooth()
        glass = scenes.material(f"Glass {number}", "ShaderNodeBsdfGlass", Color=(0.9, 1.0, 0.8, 1.0), Roughness=roughness)
        bpy.context.object.data.materials.append(glass)
    scene = bpy.context.scene
    scene.render.film_transparent = True
    scene.cycles.film_transparent_glass, scene.cycles.film_transparent_roughness = True, 0.2
