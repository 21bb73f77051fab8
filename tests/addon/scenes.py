"""Scenes made by script, for Penumbra and Cycles alike; each is a function of this file."""

import math

import bpy
from mathutils import Matrix


def add(name, data, **properties):
    """Adds an object with these properties."""
    obj = bpy.data.objects.new(name, data)
    for key, value in properties.items():
        setattr(obj, key, value)
    bpy.context.scene.collection.objects.link(obj)
    return obj


def lamp(kind, location=(0.0, 0.0, 3.0), rotation=(0.0, 0.0, 0.0), **properties):
    """Adds a lamp."""
    light = bpy.data.lights.new(kind, kind)
    for key, value in properties.items():
        setattr(light, key, value)
    return add(kind, light, location=location, rotation_euler=rotation)


def material(name, node_type="ShaderNodeBsdfPrincipled", **inputs):
    """A material of one shader."""
    result = bpy.data.materials.new(name)
    result.use_nodes = True
    tree = result.node_tree
    tree.nodes.clear()
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    shader = tree.nodes.new(node_type)
    for key, value in inputs.items():
        shader.inputs[key.replace("_", " ")].default_value = value
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    return result


def world(strength, color=(1.0, 1.0, 1.0)):
    """A constant world."""
    scene = bpy.context.scene
    scene.world = bpy.data.worlds.new("World")
    scene.world.use_nodes = True
    background = scene.world.node_tree.nodes["Background"]
    background.inputs["Color"].default_value = (*color, 1.0)
    background.inputs["Strength"].default_value = strength


def room(floor=None):
    """A floor and a cube, diffuse; the camera looks down at them."""
    plain = floor or material("Plain", "ShaderNodeBsdfDiffuse", Color=(0.6, 0.5, 0.4, 1.0))
    for create, values in ((bpy.ops.mesh.primitive_plane_add, {"size": 12}),
                           (bpy.ops.mesh.primitive_cube_add, {"size": 1, "location": (0, 0, 0.51)})):
        create(**values)
        bpy.context.object.data.materials.append(plain)
    camera = _looking_down()
    world(0.0)
    return camera


def _looking_down():
    camera = add("Camera", bpy.data.cameras.new("Camera"), location=(0, -6, 4), rotation_euler=(math.radians(57), 0, 0))
    bpy.context.scene.camera = camera
    return camera


def point_soft():
    room()
    lamp("POINT", (1.2, -0.8, 2.0), energy=100.0, shadow_soft_size=0.4)


def point_sphere():
    room()
    lamp("POINT", (1.2, -0.8, 2.0), energy=100.0, shadow_soft_size=0.4, use_soft_falloff=False)


def point_delta():
    room()
    lamp("POINT", (1.2, -0.8, 2.0), energy=100.0, shadow_soft_size=0.0)


def spot():
    room()
    lamp("SPOT", (1.2, -0.8, 2.5), (0.3, 0.4, 0.0), energy=300.0, shadow_soft_size=0.2, spot_size=1.2, spot_blend=0.4)


def sun():
    room()
    lamp("SUN", rotation=(0.5, 0.4, 0.0), energy=3.0, angle=0.2, color=(1.0, 0.8, 0.6))


def area_square():
    room()
    lamp("AREA", (1.2, -0.8, 2.5), (0.3, 0.4, 0.0), energy=100.0, size=1.0)


def area_ellipse():
    room()
    obj = lamp("AREA", (1.2, -0.8, 2.5), (0.3, 0.4, 0.0), energy=100.0, shape="ELLIPSE", size=1.0, size_y=0.5)
    obj.scale = (1.5, 0.8, 1.0)


def area_spread():
    room()
    lamp("AREA", (0.0, 0.0, 3.0), energy=100.0, shape="RECTANGLE", size=1.0, size_y=2.0, spread=math.radians(60))


def falloff_linear():
    room()
    obj = lamp("POINT", (1.2, -0.8, 2.0), energy=100.0, shadow_soft_size=0.1)
    obj.data.use_nodes = True
    tree = obj.data.node_tree
    emission = next(node for node in tree.nodes if node.type == "EMISSION")
    falloff = tree.nodes.new("ShaderNodeLightFalloff")
    falloff.inputs["Strength"].default_value = 0.5
    falloff.inputs["Smooth"].default_value = 0.2
    tree.links.new(falloff.outputs["Linear"], emission.inputs["Strength"])
    black_body = tree.nodes.new("ShaderNodeBlackbody")
    black_body.inputs["Temperature"].default_value = 3500.0
    tree.links.new(black_body.outputs[0], emission.inputs["Color"])


def world_constant():
    room()
    world(0.7, (0.4, 0.6, 1.0))


def world_image():
    room()
    world(1.0)
    image = bpy.data.images.new("sky", 64, 32, float_buffer=True)
    pixels = []
    for y in range(32):
        for x in range(64):
            glow = math.exp(-((x - 20) ** 2 + (y - 22) ** 2) / 20.0)
            pixels += [0.2 + 8.0 * glow, 0.3 + 5.0 * glow, 0.5 + 2.0 * glow, 1.0]
    image.pixels.foreach_set(pixels)
    image.update()
    tree = bpy.context.scene.world.node_tree
    environment = tree.nodes.new("ShaderNodeTexEnvironment")
    environment.image = image
    mapping = tree.nodes.new("ShaderNodeMapping")
    mapping.inputs["Rotation"].default_value = (0.2, 0.1, 0.7)
    coordinates = tree.nodes.new("ShaderNodeTexCoord")
    tree.links.new(coordinates.outputs["Generated"], mapping.inputs["Vector"])
    tree.links.new(mapping.outputs[0], environment.inputs["Vector"])
    tree.links.new(environment.outputs[0], tree.nodes["Background"].inputs["Color"])


def _background(color):
    """Links an output of a node of the world to its Background; returns the tree."""
    tree = bpy.context.scene.world.node_tree
    tree.links.new(color, tree.nodes["Background"].inputs["Color"])
    return tree


def _nodes(*kinds):
    room()
    world(1.0)
    tree = bpy.context.scene.world.node_tree
    return [tree, *(tree.nodes.new(f"ShaderNode{kind}") for kind in kinds)]


def world_gradient():
    tree, coordinates, mapping, gradient, ramp = _nodes("TexCoord", "Mapping", "TexGradient", "ValToRGB")
    mapping.inputs["Rotation"].default_value = (0.0, math.radians(90), 0.3)
    mapping.inputs["Location"].default_value = (0.5, 0.0, 0.0)
    mapping.inputs["Scale"].default_value = (0.5, 0.5, 0.5)
    ramp.color_ramp.elements[0].color = (0.9, 0.5, 0.2, 1.0)
    ramp.color_ramp.elements[1].color = (0.1, 0.3, 0.9, 1.0)
    ramp.color_ramp.elements.new(0.4).color = (0.5, 0.6, 0.8, 1.0)
    tree.links.new(coordinates.outputs["Generated"], mapping.inputs["Vector"])
    tree.links.new(mapping.outputs[0], gradient.inputs[0])
    tree.links.new(gradient.outputs[0], ramp.inputs[0])
    _background(ramp.outputs[0])


def world_clouds():
    tree, noise, ramp = _nodes("TexNoise", "ValToRGB")
    noise.inputs["Scale"].default_value = 3.0
    noise.inputs["Detail"].default_value = 6.0
    ramp.color_ramp.elements[0].position = 0.45
    ramp.color_ramp.elements[0].color = (0.1, 0.2, 0.5, 1.0)
    ramp.color_ramp.elements[1].position = 0.6
    ramp.color_ramp.elements[1].color = (2.0, 1.8, 1.5, 1.0)
    tree.links.new(noise.outputs[0], ramp.inputs[0])
    _background(ramp.outputs[0])


def world_camera_ray():
    """Another background for the camera than for what lights the scene."""
    tree, path, mix, other, noise = _nodes("LightPath", "MixShader", "Background", "TexNoise")
    lit = tree.nodes["Background"]
    lit.inputs["Color"].default_value = (0.8, 0.7, 0.5, 1.0)
    tree.links.new(noise.outputs["Color"], other.inputs["Color"])
    tree.links.new(path.outputs["Is Camera Ray"], mix.inputs[0])
    tree.links.new(lit.outputs[0], mix.inputs[1])
    tree.links.new(other.outputs[0], mix.inputs[2])
    output = next(node for node in tree.nodes if node.type == "OUTPUT_WORLD")
    tree.links.new(mix.outputs[0], output.inputs["Surface"])


def world_mixed():
    """Two Backgrounds, mixed by where one looks."""
    tree, coordinates, parts, mix, other = _nodes("TexCoord", "SeparateXYZ", "MixShader", "Background")
    tree.nodes["Background"].inputs["Color"].default_value = (0.1, 0.2, 0.8, 1.0)
    other.inputs["Color"].default_value = (0.9, 0.8, 0.3, 1.0)
    other.inputs["Strength"].default_value = 2.0
    tree.links.new(coordinates.outputs["Object"], parts.inputs[0])
    tree.links.new(parts.outputs[0], mix.inputs[0])
    tree.links.new(tree.nodes["Background"].outputs[0], mix.inputs[1])
    tree.links.new(other.outputs[0], mix.inputs[2])
    output = next(node for node in tree.nodes if node.type == "OUTPUT_WORLD")
    tree.links.new(mix.outputs[0], output.inputs["Surface"])


def _sky(kind, **properties):
    tree, sky = _nodes("TexSky")
    sky.sky_type = kind
    for key, value in properties.items():
        setattr(sky, key, value)
    tree.nodes["Background"].inputs["Strength"].default_value = 0.1
    _background(sky.outputs[0])


def sky_single():
    """The model of one scattering, under the name that this version of Blender has for it."""
    kind = "SINGLE_SCATTERING" if bpy.app.version >= (5, 0, 0) else "NISHITA"
    _sky(kind, sun_elevation=0.5, sun_rotation=0.8)


def sky_multiple():
    if bpy.app.version >= (5, 0, 0):
        _sky("MULTIPLE_SCATTERING", sun_elevation=0.5, sun_rotation=0.8)
    else:
        sky_single()


def sky_preetham():
    _sky("PREETHAM", turbidity=3.0, sun_direction=(0.3, 0.5, 0.8))


def sky_hosek():
    _sky("HOSEK_WILKIE", turbidity=3.0, ground_albedo=0.5, sun_direction=(0.3, 0.5, 0.8))


def mesh_light():
    room()
    bpy.ops.mesh.primitive_plane_add(size=1.0, location=(1.2, -0.8, 2.5))
    glow = material("Glow", "ShaderNodeEmission", Strength=10.0)
    bpy.context.object.data.materials.append(glow)


def principled():
    room(material("Principled", Base_Color=(0.6, 0.2, 0.1, 1.0), Roughness=0.4))
    lamp("AREA", (1.2, -0.8, 2.5), (0.3, 0.4, 0.0), energy=100.0, size=1.0)
    world(0.3)


def metal():
    room(material("Metal", Base_Color=(0.9, 0.6, 0.3, 1.0), Roughness=0.5, Metallic=1.0))
    lamp("AREA", (1.2, -0.8, 2.5), (0.3, 0.4, 0.0), energy=100.0, size=1.0)
    world(0.3)


def see_through():
    room()
    mixed = material("Pane", Base_Color=(0.1, 0.5, 0.2, 1.0), Alpha=0.4)
    bpy.context.object.data.materials[0] = mixed
    lamp("AREA", (1.2, -0.8, 2.5), (0.3, 0.4, 0.0), energy=100.0, size=1.0)


def depth_of_field():
    camera = room()
    camera.data.dof.use_dof = True
    camera.data.dof.focus_distance = 7.0
    camera.data.dof.aperture_fstop = 0.1
    camera.data.dof.aperture_blades = 5
    lamp("POINT", (1.2, -0.8, 2.0), energy=100.0, shadow_soft_size=0.4)


def bokeh():
    """Small lights far out of focus: the shape of the aperture, turned and narrowed."""
    camera = room()
    for obj in ("Cube", "Plane"):
        bpy.data.objects.remove(bpy.data.objects[obj])
    dof = camera.data.dof
    dof.use_dof, dof.focus_distance, dof.aperture_fstop = True, 2.0, 0.1
    dof.aperture_blades, dof.aperture_rotation, dof.aperture_ratio = 5, 0.35, 1.6
    glow = material("Glow", "ShaderNodeEmission", Strength=30.0)
    for x, color in ((-1.3, (1.0, 0.3, 0.1, 1.0)), (0.0, (0.2, 1.0, 0.2, 1.0)), (1.3, (0.2, 0.4, 1.0, 1.0))):
        own = glow.copy()
        next(node for node in own.node_tree.nodes if node.type == "EMISSION").inputs["Color"].default_value = color
        bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=1, radius=0.06, location=(x, 0.0, 0.5 + 0.3 * x))
        bpy.context.object.data.materials.append(own)


def panorama():
    camera = room()
    camera.location = (0.2, -1.5, 1.2)
    camera.rotation_euler = (math.radians(80), 0.0, 0.3)
    camera.data.type = "PANO"
    source = camera.data if hasattr(camera.data, "panorama_type") else camera.data.cycles
    source.panorama_type = "EQUIRECTANGULAR"
    lamp("POINT", (1.2, -0.8, 2.0), energy=100.0, shadow_soft_size=0.4)
    world(0.2)


def shifted():
    camera = room()
    camera.data.shift_x, camera.data.shift_y = 0.1, -0.05
    camera.data.sensor_fit = "VERTICAL"
    bpy.context.scene.render.pixel_aspect_x = 1.5
    lamp("POINT", (1.2, -0.8, 2.0), energy=100.0, shadow_soft_size=0.4)


def instances():
    room()
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=2, radius=0.15)
    ball = bpy.context.object
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=8, y_subdivisions=8, size=4, location=(0, 0, 0.3))
    grid = bpy.context.object
    ball.parent = grid
    grid.instance_type = "VERTS"
    lamp("SUN", rotation=(0.5, 0.4, 0.0), energy=3.0, angle=0.1)


def curve_and_text():
    room()
    curve = bpy.data.curves.new("Curve", "CURVE")
    curve.dimensions = "3D"
    curve.bevel_depth = 0.08
    spline = curve.splines.new("BEZIER")
    spline.bezier_points.add(2)
    for point, co in zip(spline.bezier_points, ((-2, -1, 0.3), (-1, 0, 1.2), (-2, 1, 0.3))):
        point.co = co
        point.handle_left_type = point.handle_right_type = "AUTO"
    add("Curve", curve)
    text = bpy.data.curves.new("Text", "FONT")
    text.body, text.extrude = "Penumbra", 0.05
    add("Text", text, location=(-1.5, -2.0, 0.2), rotation_euler=(0.9, 0.0, 0.0))
    meta = bpy.data.metaballs.new("Meta")
    meta.elements.new().co = (0.0, 0.0, 0.0)
    add("Meta", meta, location=(2.0, 0.0, 0.6), scale=(0.5, 0.5, 0.5))
    lamp("SUN", rotation=(0.5, 0.4, 0.0), energy=3.0, angle=0.1)


def textured():
    room()
    image = bpy.data.images.new("checks", 32, 32)
    image.generated_type = "COLOR_GRID"
    floor = material("Floor", "ShaderNodeBsdfDiffuse")
    tree = floor.node_tree
    texture = tree.nodes.new("ShaderNodeTexImage")
    texture.image = image
    texture.interpolation = "Closest"
    tree.links.new(texture.outputs["Color"], tree.nodes["Diffuse BSDF"].inputs["Color"])
    bpy.data.objects["Plane"].data.materials[0] = floor
    lamp("SUN", rotation=(0.5, 0.4, 0.0), energy=3.0, angle=0.1)


def points():
    room()
    mesh = bpy.data.meshes.new("Seeds")
    mesh.from_pydata([(x * 0.5 - 1.0, -1.0, 0.3 + 0.1 * x) for x in range(5)], [], [])
    obj = add("Seeds", mesh)
    # Geometry nodes turn the vertices into a point cloud.
    tree = bpy.data.node_groups.new("ToPoints", "GeometryNodeTree")
    tree.interface.new_socket("Geometry", in_out="INPUT", socket_type="NodeSocketGeometry")
    tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    first, last = tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")
    to_points = tree.nodes.new("GeometryNodeMeshToPoints")
    to_points.inputs["Radius"].default_value = 0.2
    tree.links.new(first.outputs[0], to_points.inputs["Mesh"])
    tree.links.new(to_points.outputs[0], last.inputs[0])
    obj.modifiers.new("Points", "NODES").node_group = tree
    lamp("SUN", rotation=(0.5, 0.4, 0.0), energy=3.0, angle=0.1)


def hair():
    room()
    curves = bpy.data.hair_curves.new("Hair")
    curves.add_curves([2] * 40)
    radius = curves.attributes.get("radius") or curves.attributes.new("radius", "FLOAT", "POINT")
    for i in range(40):
        x = i * 0.1 - 2.0
        curves.points[2 * i].position = (x, -1.5, 0.0)
        curves.points[2 * i + 1].position = (x, -1.5, 0.8)
        radius.data[2 * i].value = radius.data[2 * i + 1].value = 0.03
    add("Hair", curves)
    bpy.context.scene.cycles_curves.shape = "THICK"
    lamp("SUN", rotation=(0.5, 0.4, 0.0), energy=3.0, angle=0.1)


def _grown(obj, **settings):
    """Particles on an object."""
    obj.modifiers.new("Particles", "PARTICLE_SYSTEM")
    system = obj.particle_systems[0].settings
    for key, value in settings.items():
        setattr(system, key, value)
    return system


def particle_hair():
    """Curled hair with children, tapered and shaped, and hair of an instanced object without."""
    room()
    fur = material("Fur", "ShaderNodeBsdfDiffuse", Color=(0.8, 0.3, 0.2, 1.0))
    bpy.ops.mesh.primitive_plane_add(size=3, location=(0.3, -1.0, 0.4), rotation=(0.2, 0.1, 0.3))
    lawn = bpy.context.object
    lawn.scale = (1.0, 0.7, 1.0)
    for skin in (bpy.data.materials["Plain"], fur):
        lawn.data.materials.append(skin)
    hair = _grown(lawn, type="HAIR", count=60, hair_length=0.8, render_step=3, material=2)
    hair.child_type = "INTERPOLATED"
    hair.rendered_child_count = 10
    hair.roughness_2, hair.kink, hair.kink_amplitude = 0.05, "CURL", 0.1
    hair.radius_scale, hair.root_radius, hair.tip_radius, hair.shape = 0.08, 1.0, 0.3, -0.3
    bpy.ops.mesh.primitive_uv_sphere_add(segments=16, ring_count=8, radius=0.3)
    ball = bpy.context.object
    ball.data.materials.append(fur)
    plain = _grown(ball, type="HAIR", count=80, hair_length=0.3, render_step=2)
    plain.radius_scale, plain.use_close_tip = 0.03, True
    balls = bpy.data.collections.new("Balls")
    bpy.context.scene.collection.objects.unlink(ball)
    balls.objects.link(ball)
    for x in (-2.0, 2.2):
        add(f"Balls {x}", None, location=(x, -1.0, 1.0), instance_type="COLLECTION", instance_collection=balls)
    bpy.context.scene.cycles_curves.shape = "THICK"
    lamp("SUN", rotation=(0.5, 0.4, 0.0), energy=3.0, angle=0.1)


def particle_fur():
    """Hair of one radius: Cycles leaves the taper out of its normals.

    So thin that the ends, which are open in Cycles and round here (docs/blender.md), are a hundredth of what is lit.
    """
    particle_hair()
    for settings in bpy.data.particles:
        settings.kink, settings.use_close_tip = "NO", False
        settings.radius_scale, settings.root_radius, settings.tip_radius = 0.006, 1.0, 1.0


def particle_instances():
    """Objects on particles, and their emitter hidden."""
    room()
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=2, radius=0.5, location=(0.0, 8.0, 0.0))
    ball = bpy.context.object
    ball.data.materials.append(material("Ball", "ShaderNodeBsdfDiffuse", Color=(0.2, 0.6, 0.3, 1.0)))
    bpy.ops.mesh.primitive_plane_add(size=4, location=(0.0, -1.0, 0.5))
    emitter = bpy.context.object
    emitter.show_instancer_for_render = False
    grown = _grown(emitter, type="HAIR", count=40, render_type="OBJECT", particle_size=0.4, size_random=0.5)
    grown.use_advanced_hair = True
    grown.instance_object = ball
    lamp("SUN", rotation=(0.5, 0.4, 0.0), energy=3.0, angle=0.1)


def hair_curves_bent():
    """Hair curves that bend at their points, which are splines."""
    room()
    curves = bpy.data.hair_curves.new("Hair")
    curves.add_curves([4] * 40)
    radius = curves.attributes.get("radius") or curves.attributes.new("radius", "FLOAT", "POINT")
    for i in range(40):
        x = i * 0.1 - 2.0
        for k, (along, up) in enumerate(((0.0, 0.0), (0.5, 0.3), (-0.4, 0.7), (0.3, 1.1))):
            # From beneath the floor: Cycles' strands are open at their ends.
            curves.points[4 * i + k].position = (x + 0.3 * along, -1.5 + along, up - 0.2)
            radius.data[4 * i + k].value = 0.02
    add("Hair", curves)
    bpy.context.scene.cycles_curves.shape = "THICK"
    lamp("SUN", rotation=(0.5, 0.4, 0.0), energy=3.0, angle=0.1)


def holdout():
    """A hole in the picture by an object, one by a material, and one that only lights the others."""
    room()
    bpy.context.scene.render.film_transparent = True
    bpy.data.objects["Cube"].is_holdout = True
    bpy.ops.mesh.primitive_cube_add(size=1, location=(2.0, 0.0, 0.51))
    bpy.context.object.data.materials.append(material("Hole", "ShaderNodeHoldout"))
    bpy.ops.mesh.primitive_cube_add(size=1, location=(-2.0, 0.0, 0.51))
    hidden = bpy.context.object
    collection = bpy.data.collections.new("Hidden")
    bpy.context.scene.collection.children.link(collection)
    bpy.context.scene.collection.objects.unlink(hidden)
    collection.objects.link(hidden)
    bpy.context.view_layer.layer_collection.children["Hidden"].indirect_only = True
    lamp("SUN", rotation=(0.5, 0.4, 0.0), energy=3.0, angle=0.1)
    world(0.3)


def thin():
    """Panes on both sides of the threshold that data passes go by."""
    room()
    bpy.context.view_layer.pass_alpha_threshold = 0.5
    for x, alpha in ((-1.5, 0.3), (0.0, 0.6), (1.5, 0.8)):
        bpy.ops.mesh.primitive_plane_add(size=1.2, location=(x, -1.5, 1.5), rotation=(0.8, 0.0, 0.0))
        bpy.context.object.data.materials.append(material(f"Pane {alpha}", Alpha=alpha))
    lamp("SUN", rotation=(0.5, 0.4, 0.0), energy=3.0, angle=0.1)
    world(0.3)


def mix(name, first, second, factor=0.5, kind="ShaderNodeMixShader"):
    """A material that mixes (or adds) two shaders, each a type and its inputs."""
    result = bpy.data.materials.new(name)
    result.use_nodes = True
    tree = result.node_tree
    tree.nodes.clear()
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    both = tree.nodes.new(kind)
    offset = len(both.inputs) - 2
    if offset:
        both.inputs[0].default_value = factor
    for i, (node_type, inputs) in enumerate((first, second)):
        shader = tree.nodes.new(node_type)
        for key, value in inputs.items():
            shader.inputs[key.replace("_", " ")].default_value = value
        tree.links.new(shader.outputs[0], both.inputs[offset + i])
    tree.links.new(both.outputs[0], output.inputs["Surface"])
    return result


def lit_room(floor):
    """The room with an area lamp and a dim world."""
    room(floor)
    lamp("AREA", (1.5, -1.0, 3.0), (0.2, 0.45, 0.0), energy=150.0, size=1.5)
    world(0.3)


def rough_diffuse():
    lit_room(material("Clay", "ShaderNodeBsdfDiffuse", Color=(0.8, 0.5, 0.3, 1.0), Roughness=1.0))


def glossy():
    lit_room(material("Satin", "ShaderNodeBsdfGlossy", Color=(0.8, 0.6, 0.3, 1.0), Roughness=0.5))


def stretched():
    lit_room(material("Brushed", Metallic=1.0, Roughness=0.4, Anisotropic=0.7, Base_Color=(0.9, 0.7, 0.4, 1.0)))


def coated():
    lit_room(material("Lacquer", Base_Color=(0.6, 0.1, 0.1, 1.0), Coat_Weight=0.8, Coat_Roughness=0.2,
                      Coat_Tint=(0.9, 0.7, 0.5, 1.0)))


def cloth():
    lit_room(material("Velvet", Base_Color=(0.1, 0.1, 0.4, 1.0), Sheen_Weight=1.0, Sheen_Roughness=0.4,
                      Sheen_Tint=(0.9, 0.8, 0.7, 1.0)))


def glowing_lacquer():
    """Emission below a rough, tinted coat."""
    lit_room(material("Lacquer", Base_Color=(0.0, 0.0, 0.0, 1.0), Coat_Weight=1.0, Coat_Roughness=0.2,
                      Coat_Tint=(0.9, 0.7, 0.5, 1.0), Emission_Color=(0.3, 0.6, 0.9, 1.0), Emission_Strength=0.6))


def glowing_velvet():
    """Emission below sheen, which stands on a coat."""
    lit_room(material("Velvet", Base_Color=(0.0, 0.0, 0.0, 1.0), Sheen_Weight=1.0, Sheen_Roughness=0.5, Coat_Weight=0.4,
                      Sheen_Tint=(0.9, 0.8, 0.7, 1.0), Emission_Color=(0.9, 0.6, 0.3, 1.0), Emission_Strength=0.6))


def mixed_shaders():
    lit_room(mix("Mixed", ("ShaderNodeBsdfPrincipled", {"Base_Color": (0.2, 0.5, 0.7, 1.0), "Roughness": 0.6}),
                 ("ShaderNodeBsdfGlossy", {"Color": (0.9, 0.5, 0.2, 1.0), "Roughness": 0.3}), 0.4))


def leaf():
    lit_room(mix("Leaf", ("ShaderNodeBsdfDiffuse", {"Color": (0.2, 0.5, 0.1, 1.0)}),
                 ("ShaderNodeBsdfTranslucent", {"Color": (0.4, 0.7, 0.1, 1.0)})))


def red_film():
    """A sheet that lets red light through, and its shadow."""
    room()
    lamp("SUN", rotation=(0.3, 0.3, 0.0), energy=2.0, angle=0.05)
    world(0.2)
    bpy.ops.mesh.primitive_plane_add(size=1.6, location=(-1.2, 0.6, 0.9))
    bpy.context.object.data.materials.append(
        mix("Film", ("ShaderNodeBsdfTransparent", {"Color": (0.9, 0.2, 0.1, 1.0)}),
            ("ShaderNodeBsdfDiffuse", {"Color": (0.1, 0.2, 0.8, 1.0)}), 0.3))


def glow():
    """Light that is added to nothing: a sheet that all passes and that emits."""
    room()
    world(0.3)
    bpy.ops.mesh.primitive_plane_add(size=1.6, location=(0.8, -0.6, 1.6))
    bpy.context.object.data.materials.append(
        mix("Glow", ("ShaderNodeBsdfTransparent", {}), ("ShaderNodeEmission", {"Strength": 3.0}),
            kind="ShaderNodeAddShader"))


def catcher():
    """Shadows on a plane that is not there, in front of nothing."""
    room()
    for obj in bpy.context.scene.objects:
        if obj.type == "MESH" and obj.dimensions.x > 10:
            obj.is_shadow_catcher = True
    bpy.context.scene.render.film_transparent = True
    lamp("AREA", (1.5, -1.0, 3.0), (0.2, 0.45, 0.0), energy=150.0, size=1.5)


def _aov(tree, name, color=(0.0, 0.0, 0.0), value=0.0):
    node = tree.nodes.new("ShaderNodeOutputAOV")
    node.aov_name = name
    node.inputs["Color"].default_value = (*color, 1.0)
    node.inputs["Value"].default_value = value
    return node


def shader_aovs():
    """AOVs of surfaces by graphs, in a group, twice of one name, muted; of panes, a hole, a sphere of glass, the world."""
    for name, kind in (("Place", "COLOR"), ("Mark", "VALUE"), ("Muted", "VALUE"), ("Combined", "VALUE"),
                       ("Shadow", "VALUE")):
        aov = bpy.context.view_layer.aovs.add()
        aov.name, aov.type = name, kind
    floor = material("Floor", "ShaderNodeBsdfDiffuse", Color=(0.6, 0.5, 0.4, 1.0))
    inner = bpy.data.node_groups.new("Place", "ShaderNodeTree")
    position = inner.nodes.new("ShaderNodeNewGeometry").outputs["Position"]
    inner.links.new(position, _aov(inner, "Place").inputs["Color"])
    floor.node_tree.nodes.new("ShaderNodeGroup").node_tree = inner
    for value in (1.5, 2.0):
        _aov(floor.node_tree, "Mark", value=value)
    _aov(floor.node_tree, "Muted", value=5.0).mute = True
    camera = room(floor)
    camera.rotation_euler[0] = math.radians(72)
    lamp("SUN", rotation=(0.5, 0.4, 0.0), energy=3.0)
    # White ones: Cycles passes a pane by the weights of its shaders, colors included.
    clear = ("ShaderNodeBsdfTransparent", {})
    for x, opacity in ((-1.6, 0.3), (1.6, 0.7)):
        pane = mix(f"Pane {opacity}", clear, ("ShaderNodeBsdfDiffuse", {"Color": (1.0, 1.0, 1.0, 1.0)}), opacity)
        _aov(pane.node_tree, "Place", (x, 7.0, 8.0))
        _aov(pane.node_tree, "Mark", value=20.0)
        bpy.ops.mesh.primitive_plane_add(size=1.4, location=(x, -2.0, 1.6), rotation=(math.radians(80), 0, 0))
        bpy.context.object.data.materials.append(pane)
    for x, kind in ((-0.6, "ShaderNodeBsdfDiffuse"), (0.6, "ShaderNodeBsdfGlass")):
        ball = material(kind, kind)
        _aov(ball.node_tree, "Mark", value=9.0)
        bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=4, radius=0.35, location=(x, -2.5, 2.5))
        bpy.context.object.data.materials.append(ball)
        bpy.context.object.is_holdout = kind == "ShaderNodeBsdfDiffuse"
    tree = bpy.context.scene.world.node_tree
    direction = tree.nodes.new("ShaderNodeTexCoord").outputs["Generated"]
    tree.links.new(direction, _aov(tree, "Place").inputs["Color"])
    _aov(tree, "Mark", value=6.0)


def _ball(name, location=(0.0, 0.0, 0.0), node_type="ShaderNodeBsdfPrincipled", **inputs):
    """A smooth ball before a dark room, of one shader; the shader's node."""
    room(material("Dark", "ShaderNodeBsdfDiffuse", Color=(0.2, 0.2, 0.2, 1.0)))
    for obj in [obj for obj in bpy.context.scene.objects if obj.type == "MESH" and obj.dimensions.x < 2]:
        bpy.data.objects.remove(obj)
    bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, radius=1.0, location=(0.0, -1.0, 1.01))
    bpy.ops.object.shade_smooth()
    matter = material(name, node_type, **inputs)
    bpy.context.object.data.materials.append(matter)
    return next(node for node in matter.node_tree.nodes if node.bl_idname == node_type)


def _side_light():
    lamp("AREA", (3.0, -1.5, 3.0), (0.2, 0.8, 0.0), energy=200.0, size=0.5)
    world(0.2)


def wax():
    """Light beneath a ball, of another radius in each channel."""
    node = _ball("Wax", Base_Color=(0.8, 0.6, 0.3, 1.0), Roughness=0.3, Subsurface_Weight=0.9,
                 Subsurface_Radius=(1.0, 0.5, 0.2), Subsurface_Scale=2.0, Subsurface_Anisotropy=0.3)
    node.subsurface_method = "RANDOM_WALK"
    _side_light()


def skin():
    node = _ball("Skin", Base_Color=(0.8, 0.5, 0.4, 1.0), Roughness=0.5, Subsurface_Weight=1.0,
                 Subsurface_Radius=(1.0, 0.2, 0.1), Subsurface_Scale=0.3)
    node.subsurface_method = "RANDOM_WALK_SKIN"
    _side_light()


def burley():
    node = _ball("Wax", Base_Color=(0.8, 0.6, 0.3, 1.0), Roughness=0.4, Subsurface_Weight=1.0,
                 Subsurface_Radius=(1.0, 0.5, 0.2), Subsurface_Scale=2.0)
    node.subsurface_method = "BURLEY"
    _side_light()


def candle():
    """A thin slab before a lamp."""
    room()
    for obj in [obj for obj in bpy.context.scene.objects if obj.type == "MESH" and obj.dimensions.x < 2]:
        bpy.data.objects.remove(obj)
    bpy.ops.mesh.primitive_cube_add(size=1.0, location=(0.0, -1.0, 1.1))
    bpy.context.object.scale = (2.4, 0.1, 2.0)
    matter = material("Slab", "ShaderNodeSubsurfaceScattering", Color=(0.9, 0.7, 0.5, 1.0), Scale=1.5,
                      Radius=(1.0, 0.6, 0.3), Roughness=0.6)
    next(node for node in matter.node_tree.nodes if node.type == "SUBSURFACE_SCATTERING").falloff = "RANDOM_WALK"
    bpy.context.object.data.materials.append(matter)
    lamp("POINT", (0.3, 0.2, 1.5), energy=150.0, shadow_soft_size=0.1)


def _terminator(obj, geometry=None, shading=None):
    """Sets the shadow terminator, wherever a version of Blender has it."""
    new = hasattr(obj, "shadow_terminator_shading_offset")
    holder = obj if new else obj.cycles
    if geometry is not None:
        holder.shadow_terminator_geometry_offset = geometry
    if shading is not None:
        setattr(holder, "shadow_terminator_shading_offset" if new else "shadow_terminator_offset", shading)


def _coarse_balls(matter):
    """Smooth balls of few triangles, lit from the side; each with a shadow terminator of its own."""
    room(material("Dark", "ShaderNodeBsdfDiffuse", Color=(0.2, 0.2, 0.2, 1.0)))
    for obj in [obj for obj in bpy.context.scene.objects if obj.type == "MESH" and obj.dimensions.x < 2]:
        bpy.data.objects.remove(obj)
    for x, geometry, shading in ((-1.6, 0.0, 0.0), (0.0, None, None), (1.6, 0.3, 0.5)):
        bpy.ops.mesh.primitive_uv_sphere_add(segments=12, ring_count=7, radius=0.7, location=(x, -1.0, 0.9))
        bpy.ops.object.shade_smooth()
        _terminator(bpy.context.object, geometry, shading)
        bpy.context.object.data.materials.append(matter)


def coarse():
    _coarse_balls(material("Clay", "ShaderNodeBsdfDiffuse", Color=(0.8, 0.7, 0.6, 1.0)))
    lamp("SUN", rotation=(0.2, 1.2, 0.0), energy=3.0, angle=0.02)
    lamp("POINT", (-4.0, -4.0, 3.0), energy=200.0, shadow_soft_size=0.1)


def _waves(matter, distance, scale):
    """Waves by a bump node on the shader of a material."""
    tree = matter.node_tree
    shader = next(node for node in tree.nodes if "Normal" in node.inputs)
    bump, waves = tree.nodes.new("ShaderNodeBump"), tree.nodes.new("ShaderNodeTexWave")
    bump.inputs["Distance"].default_value = distance
    waves.inputs["Scale"].default_value = scale
    tree.links.new(tree.nodes.new("ShaderNodeTexCoord").outputs["Object"], waves.inputs["Vector"])
    tree.links.new(waves.outputs["Color"], bump.inputs["Height"])
    tree.links.new(bump.outputs["Normal"], shader.inputs["Normal"])
    return matter


def bumpy():
    """Waves by a bump node on smooth balls, light from the side."""
    _coarse_balls(_waves(material("Waves", "ShaderNodeBsdfDiffuse", Color=(0.8, 0.7, 0.6, 1.0)), 0.04, 1.5))
    lamp("SUN", rotation=(0.2, 1.2, 0.0), energy=3.0, angle=0.02)
    world(0.1)


def bumpy_mirror():
    """Steep waves on a white mirror in a white world: it shows 1 wherever it shows what is above it."""
    bpy.ops.mesh.primitive_uv_sphere_add(segments=128, ring_count=64, radius=1.6, location=(0.0, 0.0, 1.0))
    bpy.ops.object.shade_smooth()
    bpy.context.object.data.materials.append(
        _waves(material("Mirror", Base_Color=(1.0, 1.0, 1.0, 1.0), Metallic=1.0, Roughness=0.0), 0.05, 3.0))
    _looking_down()
    world(1.0)


def bumpy_shine():
    """Steep waves on rough metal, on plastic and below a lacquer."""
    for i, inputs in enumerate(({"Metallic": 1.0, "Roughness": 0.3}, {"Roughness": 0.2},
                                {"Roughness": 0.6, "Coat_Weight": 1.0, "Coat_Roughness": 0.1})):
        bpy.ops.mesh.primitive_uv_sphere_add(segments=128, ring_count=64, radius=0.8, location=(1.8 * i - 1.8, 0.0, 0.8))
        bpy.ops.object.shade_smooth()
        bpy.context.object.data.materials.append(
            _waves(material("Shine", Base_Color=(0.8, 0.7, 0.6, 1.0), **inputs), 0.09, 1.0))
    _looking_down()
    lamp("AREA", (1.5, -1.0, 3.0), (0.2, 0.45, 0.0), energy=150.0, size=1.5)
    world(0.5)


def _shiny():
    """Caustics of a mirror, of glass and of rough metal beside a diffuse floor."""
    room(material("Plain", "ShaderNodeBsdfDiffuse", Color=(0.8, 0.8, 0.8, 1.0)))
    shiny = (material("Mirror", Base_Color=(0.9, 0.9, 0.9, 1.0), Metallic=1.0, Roughness=0.0),
             material("Glass", "ShaderNodeBsdfGlass", Roughness=0.0, IOR=1.5),
             material("Steel", Base_Color=(0.7, 0.8, 0.9, 1.0), Metallic=1.0, Roughness=0.3),
             material("Lacquer", Base_Color=(0.6, 0.1, 0.1, 1.0), Roughness=0.1, Coat_Weight=1.0))
    for i, one in enumerate(shiny):
        bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, radius=0.5, location=(1.3 * i - 2.0, -1.3, 0.6))
        bpy.ops.object.shade_smooth()
        bpy.context.object.data.materials.append(one)
    lamp("AREA", (1.5, -1.0, 3.0), (0.2, 0.45, 0.0), energy=150.0, size=0.5)
    world(0.1)


def filter_glossy():
    _shiny()
    bpy.context.scene["cycles_settings"] = {"blur_glossy": 1.0}


def no_caustics():
    _shiny()
    bpy.context.scene["cycles_settings"] = {"caustics_reflective": False, "caustics_refractive": False}


def no_refractive_caustics():
    _shiny()
    bpy.context.scene["cycles_settings"] = {"caustics_refractive": False, "blur_glossy": 1.0}


def clamped():
    """Light close to a wall, far above what a contribution may add."""
    _shiny()
    bpy.context.scene["cycles_settings"] = {"sample_clamp_direct": 1.0, "sample_clamp_indirect": 0.1}


def _open_box(*others):
    """A box without a front, lit by a lamp at its ceiling."""
    white = material("White", "ShaderNodeBsdfDiffuse", Color=(0.8, 0.8, 0.8, 1.0))
    for location, rotation in (((0, 0, -1), (0, 0, 0)), ((0, 0, 1), (0, 0, 0)), ((-1, 0, 0), (0, math.pi / 2, 0)),
                               ((1, 0, 0), (0, math.pi / 2, 0)), ((0, 1, 0), (math.pi / 2, 0, 0))):
        bpy.ops.mesh.primitive_plane_add(size=2, location=location, rotation=rotation)
        bpy.context.object.data.materials.append(white)
    for i, one in enumerate(others):
        bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, radius=0.35, location=(0.8 * i - 0.4, 0.1, -0.6))
        bpy.ops.object.shade_smooth()
        bpy.context.object.data.materials.append(one)
    lamp("AREA", (0, 0, 0.95), energy=20.0, size=0.6)
    data = bpy.data.cameras.new("Camera")
    bpy.context.scene.camera = add("Camera", data, location=(0, -3.6, 0), rotation_euler=(math.pi / 2, 0, 0))
    world(0.0)


def few_diffuse_bounces():
    _open_box(material("Mirror", Base_Color=(0.9, 0.9, 0.9, 1.0), Metallic=1.0, Roughness=0.2))
    bpy.context.scene["cycles_settings"] = {"diffuse_bounces": 1}


def few_glossy_bounces():
    mirror = material("Mirror", Base_Color=(0.9, 0.9, 0.9, 1.0), Metallic=1.0, Roughness=0.0)
    _open_box(mirror, mirror)
    bpy.context.scene["cycles_settings"] = {"glossy_bounces": 1}


def few_transmission_bounces():
    glass = material("Glass", "ShaderNodeBsdfGlass", Roughness=0.0, IOR=1.3)
    _open_box(glass, glass)
    bpy.context.scene["cycles_settings"] = {"transmission_bounces": 1}


def panes():
    """Five thin panes before a floor and four between it and the sun, of which two may be passed."""
    room()
    pane = material("Pane", Base_Color=(0.8, 0.3, 0.2, 1.0), Alpha=0.4)
    for i in range(5):
        bpy.ops.mesh.primitive_plane_add(size=1.5, location=(0.4 * i - 1.0, -1.5, 0.8 + 0.2 * i))
        bpy.context.object.data.materials.append(pane)
        bpy.context.object.visible_shadow = False
    for i in range(4):
        bpy.ops.mesh.primitive_plane_add(size=1.5, location=(0.4 * i + 1.0, 0.5, 2.0 + 0.2 * i))
        bpy.context.object.data.materials.append(pane)
        bpy.context.object.visible_camera = False
    lamp("SUN", rotation=(0.3, 0.2, 0.0), energy=3.0, angle=0.1)
    world(0.2)
    bpy.context.scene["cycles_settings"] = {"transparent_max_bounces": 2}


def _filled(matter, node_type, **inputs):
    """Links a shader to the Volume socket of a material; of None a new one without surface."""
    if matter is None:
        matter = material("Volume", "ShaderNodeEmission")
        matter.node_tree.nodes.remove(next(node for node in matter.node_tree.nodes if node.type == "EMISSION"))
    tree = matter.node_tree
    shader = tree.nodes.new(node_type)
    for key, value in inputs.items():
        shader.inputs[key.replace("_", " ")].default_value = value
    output = next(node for node in tree.nodes if node.type == "OUTPUT_MATERIAL")
    tree.links.new(shader.outputs[0], output.inputs["Volume"])
    return matter


def _box(size, location, matter, scale=(1.0, 1.0, 1.0)):
    bpy.ops.mesh.primitive_cube_add(size=size, location=location)
    bpy.context.object.scale = scale
    bpy.context.object.data.materials.append(matter)
    return bpy.context.object


def _volume_limits():
    """Cycles' own ways through volumes: no bounce within, exact for volumes that are the same everywhere."""
    bpy.context.scene.cycles.volume_bounces = 0


def murky():
    """Boxes of absorption alone before a lit floor: two that overlap, one that casts its shadow on all."""
    room()
    lamp("AREA", (1.5, -1.0, 3.0), (0.2, 0.45, 0.0), energy=150.0, size=1.5)
    world(0.3)
    _box(1.0, (-1.3, -1.0, 0.8), _filled(None, "ShaderNodeVolumeAbsorption", Color=(0.9, 0.5, 0.2, 1.0), Density=1.5))
    _box(0.8, (-0.9, -1.4, 0.95), _filled(None, "ShaderNodeVolumeAbsorption", Color=(0.2, 0.6, 0.9, 1.0), Density=2.0))
    _box(1.2, (1.5, -0.2, 1.6), _filled(None, "ShaderNodeVolumePrincipled", Color=(0.0, 0.0, 0.0, 1.0), Density=1.2,
                                       Absorption_Color=(0.6, 0.2, 0.1, 1.0)))
    _volume_limits()


def submerged():
    """Camera, lamp and room within one volume."""
    room()
    lamp("POINT", (1.2, -0.8, 2.0), energy=300.0, shadow_soft_size=0.3)
    _box(30.0, (0.0, 0.0, 0.0), _filled(None, "ShaderNodeVolumeAbsorption", Color=(0.95, 0.85, 0.7, 1.0), Density=0.8))
    _volume_limits()


def tinted_glass():
    """Glass and thin alpha with something inside of them, a ball in the glass."""
    room(material("Plain", "ShaderNodeBsdfDiffuse", Color=(0.7, 0.7, 0.7, 1.0)))
    for obj in [obj for obj in bpy.context.scene.objects if obj.type == "MESH" and obj.dimensions.x < 2]:
        bpy.data.objects.remove(obj)
    glass = material("Glass", "ShaderNodeBsdfGlass", Roughness=0.0, IOR=1.3)
    _box(1.2, (-1.0, -1.2, 0.7), _filled(glass, "ShaderNodeVolumeAbsorption", Color=(0.3, 0.8, 0.5, 1.0), Density=2.0))
    bpy.ops.mesh.primitive_uv_sphere_add(radius=0.3, location=(-1.0, -1.2, 0.7))
    bpy.ops.object.shade_smooth()
    bpy.context.object.data.materials.append(material("Core", "ShaderNodeBsdfDiffuse", Color=(0.8, 0.6, 0.5, 1.0)))
    veil = material("Veil", Alpha=0.3, Base_Color=(0.8, 0.3, 0.3, 1.0))
    _box(1.0, (1.0, -1.2, 0.7), _filled(veil, "ShaderNodeVolumeAbsorption", Color=(0.5, 0.5, 0.9, 1.0), Density=1.5))
    world(0.8)
    _volume_limits()


def _uv_of(obj, name, turn):
    """Adds a UV map: the first one turned about the middle."""
    first = obj.data.uv_layers[0]
    points = [tuple(loop.uv) for loop in first.data]
    layer = obj.data.uv_layers.new(name=name)
    cos, sin = math.cos(turn), math.sin(turn)
    for loop, (u, v) in zip(layer.data, points):
        loop.uv = (0.5 + cos * (u - 0.5) - sin * (v - 0.5), 0.5 + sin * (u - 0.5) + cos * (v - 0.5))
    obj.data.uv_layers.active = obj.data.uv_layers[0]
    obj.data.uv_layers[0].active_render = True


def brushed_by_map():
    """Metal that is brushed along a UV map which is not the one to render with, beside the one that is."""
    room()
    for obj in [obj for obj in bpy.context.scene.objects if obj.type == "MESH" and obj.dimensions.x < 2]:
        bpy.data.objects.remove(obj)
    for x, name in ((-1.2, "Second"), (1.2, "")):
        matter = material(f"Brushed {name}", Metallic=1.0, Roughness=0.4, Anisotropic=0.9,
                          Base_Color=(0.9, 0.7, 0.4, 1.0))
        tree = matter.node_tree
        tangent = tree.nodes.new("ShaderNodeTangent")
        tangent.direction_type, tangent.uv_map = "UV_MAP", name
        shader = next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED")
        tree.links.new(tangent.outputs[0], shader.inputs["Tangent"])
        bpy.ops.mesh.primitive_plane_add(size=2.2, location=(x, -1.0, 0.4), rotation=(0.3, 0.0, 0.0))
        _uv_of(bpy.context.object, "Second", 1.0)
        bpy.context.object.data.materials.append(matter)
    lamp("AREA", (0.5, 1.5, 2.5), (-0.5, 0.1, 0.0), energy=150.0, size=0.5)
    world(0.05)


def varying_index():
    """Indices of refraction that follow a texture: of a dielectric, its coat, and a film on metal, which up to 4.5 shows
    none."""
    def varying(name, low, high, **inputs):
        def with_index(socket):
            matter = material(socket, **inputs)
            tree = matter.node_tree
            coordinates, waves, span = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("TexCoord", "TexWave", "MapRange"))
            waves.inputs["Scale"].default_value = 1.0
            span.inputs["To Min"].default_value, span.inputs["To Max"].default_value = low, high
            tree.links.new(coordinates.outputs["Object"], waves.inputs["Vector"])
            tree.links.new(waves.outputs["Fac"], span.inputs["Value"])
            shader = next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED")
            tree.links.new(span.outputs[0], shader.inputs[socket])
            return matter
        return with_index(name)

    room()
    for obj in [obj for obj in bpy.context.scene.objects if obj.type == "MESH" and obj.dimensions.x < 2]:
        bpy.data.objects.remove(obj)
    dark = {"Base_Color": (0.05, 0.05, 0.05, 1.0), "Roughness": 0.3}
    film = {"Metallic": 1.0, "Roughness": 0.3, "Thin_Film_Thickness": 400.0, "Base_Color": (0.7, 0.7, 0.7, 1.0)}
    balls = [varying("IOR", 1.0, 2.5, **dark),
             varying("Coat IOR", 1.0, 2.5, Coat_Weight=1.0, Coat_Roughness=0.2, **dark),
             varying("Thin Film IOR", 1.1, 2.0, **film)]
    for i, matter in enumerate(balls):
        bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, radius=0.7, location=(1.6 * i - 1.6, -1.2, 0.8))
        bpy.ops.object.shade_smooth()
        bpy.context.object.data.materials.append(matter)
    lamp("AREA", (1.5, -1.0, 3.0), (0.2, 0.45, 0.0), energy=150.0, size=1.5)
    world(0.5)


def zoomed():
    """A room through a shifted lens that zooms while the shutter is open."""
    camera = room()
    camera.data.shift_x = 0.1
    scene = bpy.context.scene
    scene.render.use_motion_blur, scene.render.motion_blur_shutter = True, 1.0
    for frame, lens in ((1, 30.0), (3, 60.0)):
        camera.data.lens = lens
        camera.data.keyframe_insert("lens", frame=frame)
    scene.frame_set(2)
    lamp("AREA", (1.5, -1.0, 3.0), (0.2, 0.45, 0.0), energy=150.0, size=1.5)
    world(0.5)


def uncorrected():
    """Bumps of a material without Bump Map Correction."""
    bumpy()
    bpy.data.materials["Waves"].cycles.use_bump_map_correction = False


def attributes():
    """What geometry nodes and scripts leave on a mesh, shown by Attribute nodes."""
    room()
    kinds = (("FLOAT", "POINT"), ("INT", "FACE"), ("BOOLEAN", "CORNER"), ("FLOAT_VECTOR", "POINT"), ("FLOAT2", "CORNER"),
             ("FLOAT_COLOR", "FACE"), ("BYTE_COLOR", "POINT"), ("FLOAT", "CORNER"))
    for i, (kind, domain) in enumerate(kinds):
        location = (0.9 * (i % 4) - 1.35, -1.2 - 0.9 * (i // 4), 0.05)
        bpy.ops.mesh.primitive_grid_add(x_subdivisions=4, y_subdivisions=4, size=0.8, location=location)
        mesh = bpy.context.object.data
        # Positions that are colors.
        mesh.transform(Matrix.Translation((0.5, 0.5, 0.0)))
        bpy.context.object.location = [x - shift for x, shift in zip(location, (0.5, 0.5, 0.0))]
        own = f"mine {i}"
        values = mesh.attributes.new(own, kind, domain)
        width = {"FLOAT_VECTOR": 3, "FLOAT2": 2, "FLOAT_COLOR": 4, "BYTE_COLOR": 4}.get(kind, 1)
        name = {1: "value", 2: "vector", 3: "vector", 4: "color"}[width]
        numbers = [0.1 + 0.8 * ((7 * k * k + 3 * k) % 11) / 11.0 for k in range(len(values.data) * width)]
        cast = {"INT": lambda x: round(3.0 * x), "BOOLEAN": lambda x: x > 0.5}.get(kind, float)
        values.data.foreach_set(name, [cast(x) for x in numbers])
        for shown, output in ((own, "Color"), (own, "Fac"), ("position", "Vector"))[i % 3: i % 3 + 1]:
            matter = material(f"Shown {i}", "ShaderNodeEmission")
            tree = matter.node_tree
            node = tree.nodes.new("ShaderNodeAttribute")
            node.attribute_name = shown
            shader = next(one for one in tree.nodes if one.type == "EMISSION")
            tree.links.new(node.outputs[output], shader.inputs["Color"])
            mesh.materials.append(matter)
    lamp("SUN", rotation=(0.3, 0.2, 0.0), energy=1.0, angle=0.1)


def overridden():
    """A view layer with a material of its own for everything, and where Blender has it, a world."""
    room()
    bpy.ops.mesh.primitive_cube_add(size=0.8, location=(1.5, -1.0, 0.5))
    layer = bpy.context.view_layer
    layer.material_override = material("Override", "ShaderNodeBsdfDiffuse", Color=(0.9, 0.2, 0.1, 1.0))
    world(0.5)
    if hasattr(layer, "world_override"):
        other = bpy.data.worlds.new("Other")
        other.use_nodes = True
        other.node_tree.nodes["Background"].inputs["Color"].default_value = (0.1, 0.3, 0.9, 1.0)
        layer.world_override = other
    lamp("SUN", rotation=(0.3, 0.2, 0.0), energy=1.0, angle=0.1)


def filtered():
    """A view layer without the world."""
    room()
    world(1.0)
    bpy.context.view_layer.use_sky = False
    lamp("SUN", rotation=(0.3, 0.2, 0.0), energy=1.0, angle=0.1)
