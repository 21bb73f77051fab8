"""Scenes for data passes, rendered by Cycles and by Penumbra."""

import math
import os

import bmesh
import bpy

import scenes
from jobs import _render, _room, _scene

# Check boxes by the name of a pass: of the view layer, of Cycles' own settings, and Penumbra's.
_BOXES = {
    "Mist": (("layer", "use_pass_mist"),),
    "Vector": (("layer", "use_pass_vector"),),
    "Cryptomatte": (("layer", "use_pass_cryptomatte_material"),),
    "Shadow Catcher": (("cycles", "use_pass_shadow_catcher"),),
    "Denoising": (("cycles", "denoising_store_passes"), ("penumbra", "use_pass_denoising_normal"),
                  ("penumbra", "use_pass_denoising_albedo"), ("penumbra", "use_pass_denoising_depth")),
}


def passes_of_both(name, folder, boxes, spp=64, *arguments):
    """The scene `name` with the passes `boxes` by both engines: paths of the two EXR files."""
    globals()[name](*arguments)
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 64, 48, 100
    layer = scene.view_layers[0]
    holders = {"layer": layer, "cycles": layer.cycles, "penumbra": layer.penumbra}
    for box in boxes.split(","):
        for holder, prop in _BOXES[box]:
            setattr(holders[holder], prop, True)
    cycles = scene.cycles
    cycles.samples, cycles.use_adaptive_sampling, cycles.use_denoising = int(spp), False, False
    cycles.sample_clamp_indirect, cycles.blur_glossy, cycles.pixel_filter_type = 0.0, 0.0, "BOX"
    if hasattr(scene, "cycles_curves"):
        scene.cycles_curves.shape = "THICK"
    scene.penumbra.spp = int(spp)
    paths = []
    for engine in ("CYCLES", "PENUMBRA"):
        scene.render.engine = engine
        paths.append(os.path.join(folder, f"{name}-{engine.lower()}.exr"))
        _render(paths[-1])
    return paths


def _keyed(holder, path, first, last):
    """From the first value at frame 1 to the last at frame 9."""
    for frame, value in ((1, first), (9, last)):
        setattr(holder, path, value)
        holder.keyframe_insert(path, frame=frame)


def _pane(location, alpha):
    bpy.ops.mesh.primitive_plane_add(size=1.6, location=location, rotation=(1.2, 0.0, 0.0))
    bpy.context.object.data.materials.append(scenes.material("Pane", Alpha=alpha, Roughness=0.9))


def _take(obj, kind):
    """Makes a camera one of that type."""
    obj.data.type, obj.data.ortho_scale = kind, 8.0
    holder = obj.data if hasattr(obj.data, "panorama_type") else obj.data.cycles
    holder.panorama_type = "EQUIRECTANGULAR"


def fog(falloff, camera="PERSP"):
    """Ground, a cube and a thin pane in the world's mist."""
    _take(scenes.room(), camera)
    scenes.world(1.0)
    mist = bpy.context.scene.world.mist_settings
    mist.start, mist.depth, mist.falloff = 4.0, 6.0, falloff
    _pane((-1.2, -1.5, 0.8), 0.4)


def march(camera="PERSP"):
    """What moves, turns, grows, bends and is instanced, before a camera that moves.

    One of parallel rays stands still: once it moves, Cycles 4.5 and 5.0 compare with it in perspective.
    """
    scene = bpy.context.scene
    obj = scenes.room()
    _take(obj, camera)
    if camera != "ORTHO":
        _keyed(obj, "location", (0.0, -6.0, 4.0), (0.4, -6.2, 4.1))
        _keyed(obj, "rotation_euler", obj.rotation_euler.copy(), (math.radians(55), 0.03, 0.02))
        # Cycles 4.2 does not know of zooms here.
        if bpy.app.version >= (4, 5):
            _keyed(obj.data, "lens", 50.0, 60.0)
    cube = bpy.data.objects["Cube"]
    _keyed(cube, "location", (0.0, 0.0, 0.5), (2.0, 1.0, 1.0))
    _keyed(cube, "rotation_euler", (0.0, 0.0, 0.0), (0.0, 0.5, 2.0))
    _keyed(cube, "scale", (1.0, 1.0, 1.0), (1.5, 0.8, 1.0))
    # Settings of motion blur mean nothing for the pass.
    cube.cycles.use_motion_blur = False
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=8, y_subdivisions=8, size=1.5, location=(-2.0, 0.0, 0.6))
    grid = bpy.context.object
    grid.shape_key_add(name="Basis")
    bent = grid.shape_key_add(name="Bent")
    for point in bent.data:
        point.co.z += 2.0 * point.co.x**2
    _keyed(bent, "value", 0.0, 1.0)
    grid.cycles.use_deform_motion = False
    bpy.ops.object.text_add(location=(1.2, -2.0, 0.3), rotation=(0.9, 0.0, 0.0))
    text = bpy.context.object
    text.data.body = "Ab"
    _keyed(text.data, "size", 0.8, 1.2)
    bpy.ops.mesh.primitive_cube_add(size=0.3)
    small = bpy.context.object
    bpy.ops.mesh.primitive_plane_add(size=1.5, location=(0.0, -2.2, 0.4))
    parent = bpy.context.object
    parent.instance_type, small.parent = "VERTS", parent
    _keyed(parent, "rotation_euler", (0.0, 0.0, 0.0), (0.0, 0.0, 1.0))
    scene.frame_set(4)


def lawn():
    """Hair curves on what moves."""
    scenes.hair()
    obj = next(obj for obj in bpy.data.objects if obj.type == "CURVES")
    _keyed(obj, "location", (0.0, 0.0, 0.0), (1.0, 0.5, 0.3))
    bpy.context.scene.frame_set(4)


def catcher(transparent):
    """Shadows on a catcher, of direct light alone: what bounces from objects to catchers does not count here."""
    scenes.catcher()
    bpy.context.scene.cycles.max_bounces = bpy.context.scene.penumbra.max_bounces = 0
    bpy.context.scene.render.film_transparent = transparent == "on"


def mirrors():
    """What a denoiser is told: of mirrors, glass, rough and thin things, lamps and the world."""
    scenes.room()
    scenes.world(0.5, (0.2, 0.5, 1.0))
    cube = bpy.data.objects["Cube"]
    cube.data.materials[0] = scenes.material("Varnish", Base_Color=(0.7, 0.3, 0.2, 1.0), Roughness=0.1)
    for name, x, shader in (
        ("Mirror", -2.0, scenes.material("Mirror", "ShaderNodeBsdfGlossy", Color=(0.9, 0.8, 0.7, 1.0), Roughness=0.1)),
        ("Glass", 2.0, scenes.material("Glass", "ShaderNodeBsdfGlass", Color=(0.9, 1.0, 0.9, 1.0), Roughness=0.0)),
        ("Metal", 0.9, scenes.material("Metal", Base_Color=(0.9, 0.6, 0.3, 1.0), Metallic=1.0, Roughness=0.4)),
    ):
        bpy.ops.mesh.primitive_uv_sphere_add(radius=0.6, location=(x, -1.0, 0.6))
        bpy.ops.object.shade_smooth()
        bpy.context.object.name = name
        bpy.context.object.data.materials.append(shader)
    _pane((-0.7, -2.2, 0.8), 0.5)
    bpy.ops.mesh.primitive_plane_add(size=1.0, location=(0.0, 2.0, 1.5), rotation=(1.4, 0.0, 0.0))
    bpy.context.object.data.materials.append(scenes.material("Lit", "ShaderNodeEmission", Color=(1.0, 0.9, 0.5, 1.0), Strength=2.0))
    scenes.lamp("POINT", (1.2, -0.8, 4.0), energy=100.0, shadow_soft_size=0.3)


def sweeping(curve, rolling):
    """A glowing square that crosses the picture while a shutter opens and closes, row by row or at once."""
    scene = bpy.context.scene
    bpy.ops.mesh.primitive_plane_add(size=3.0)
    square = bpy.context.object
    square.data.materials.append(scenes.material("Lit", "ShaderNodeEmission", Strength=1.0))
    camera = scenes.add("Camera", bpy.data.cameras.new("Camera"), location=(0.0, 0.0, 10.0))
    camera.data.type, camera.data.ortho_scale = "ORTHO", 8.0
    scene.camera = camera
    scenes.world(0.0)
    _keyed(square, "location", (-2.0, 0.0, 0.0), (14.0, 0.0, 0.0))
    for point in square.animation_data.action.fcurves if hasattr(square.animation_data.action, "fcurves") else ():
        for key in point.keyframe_points:
            key.interpolation = "LINEAR"
    scene.frame_set(3)
    scene.render.use_motion_blur, scene.render.motion_blur_shutter = True, 1.0
    if curve == "on":
        mapping = scene.render.motion_blur_shutter_curve
        for point, place in zip(mapping.curves[0].points, ((0.0, 0.1), (1.0, 1.0))):
            point.location = place
        mapping.curves[0].points.new(0.6, 0.2)
        mapping.update()
    if rolling != "off":
        scene.cycles.rolling_shutter_type, scene.cycles.rolling_shutter_duration = "TOP", float(rolling)


def march_blurred():
    march()
    bpy.context.scene.render.use_motion_blur = True


def not_finite(folder):
    """A lamp and a node whose values are no numbers."""
    _scene(spp=1)
    _room()
    bpy.data.lights["Area"].energy = float("inf")
    wood = scenes.material("Wood")
    mapping = wood.node_tree.nodes.new("ShaderNodeMapping")
    mapping.inputs["Location"].default_value[0] = float("nan")
    shader = next(node for node in wood.node_tree.nodes if node.type == "BSDF_PRINCIPLED")
    wood.node_tree.links.new(mapping.outputs[0], shader.inputs["Base Color"])
    bpy.data.objects["Cube"].data.materials.append(wood)
    _render(os.path.join(folder, "not_finite.exr"))


def bare():
    """A cube without material on a floor with one."""
    scenes.room()
    bpy.data.objects["Cube"].data.materials.clear()
    scenes.world(1.0)


def through(kind):
    """A lamp or an empty mesh in place of the camera."""
    scenes.room()
    old = bpy.context.scene.camera
    place = {"location": old.location.copy(), "rotation_euler": old.rotation_euler.copy()}
    data = bpy.data.meshes.new("Eye") if kind == "MESH" else bpy.data.lights.new("Eye", kind)
    if kind == "SPOT":
        data.spot_size = 1.2
    bpy.context.scene.camera = scenes.add("Eye", data, **place)
    scenes.lamp("SUN", rotation=(0.5, 0.4, 0.0), energy=3.0, angle=0.1)


def far_vertex(folder):
    """A cube with a vertex a million kilometres off, and one without the faces there: paths of their pictures."""
    scene = _scene(spp=16)
    scene.view_layers[0].use_pass_z = True
    bpy.ops.mesh.primitive_cube_add(size=1, location=(0.0, 0.0, 0.5))
    obj = bpy.context.object
    far, without = obj.data, obj.data.copy()
    corner = next(vertex.index for vertex in far.vertices if vertex.co.x > 0.0 > vertex.co.z and vertex.co.y > 0.0)
    far.vertices[corner].co.x = 1e9
    edited = bmesh.new()
    edited.from_mesh(without)
    edited.verts.ensure_lookup_table()
    bmesh.ops.delete(edited, geom=list(edited.verts[corner].link_faces), context="FACES_ONLY")
    edited.to_mesh(without)
    paths = []
    for name, obj.data in (("far", far), ("without", without)):
        paths.append(os.path.join(folder, f"{name}.exr"))
        _render(paths[-1])
    return paths
