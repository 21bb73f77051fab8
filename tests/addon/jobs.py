"""What the tests let Blender do; each job returns plain data."""

import json
import os
import time

import bpy
import numpy as np


def _scene(size=(64, 48), spp=4):
    """An empty scene with a camera that looks down at the origin."""
    scene = bpy.context.scene
    scene.render.engine = "PENUMBRA"
    scene.render.resolution_x, scene.render.resolution_y = size
    scene.render.resolution_percentage = 100
    scene.penumbra.spp = spp
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location = (0, -6, 3)
    camera.rotation_euler = (1.107, 0, 0)
    scene.collection.objects.link(camera)
    scene.camera = camera
    if scene.world is None:
        scene.world = bpy.data.worlds.new("World")
    return scene


def _add(name, data, **properties):
    obj = bpy.data.objects.new(name, data)
    for key, value in properties.items():
        setattr(obj, key, value)
    bpy.context.scene.collection.objects.link(obj)
    return obj


def _lamp(name, kind, **properties):
    light = bpy.data.lights.new(name, kind)
    for key, value in properties.items():
        setattr(light, key, value)
    return light


def _room():
    """A floor, a cube and a lamp."""
    bpy.ops.mesh.primitive_plane_add(size=10)
    bpy.ops.mesh.primitive_cube_add(size=1, location=(0, 0, 0.5))
    _add("Area", _lamp("Area", "AREA", energy=200.0, size=1.0), location=(1.5, -1.0, 3.0))


def _render(path, view_layer_passes=()):
    """Renders to a multi-layer EXR."""
    scene = bpy.context.scene
    for name in view_layer_passes:
        setattr(scene.view_layers[0], name, True)
    settings = scene.render.image_settings
    if hasattr(settings, "media_type"):
        settings.media_type = "MULTI_LAYER_IMAGE"
    settings.file_format = "OPEN_EXR_MULTILAYER"
    settings.color_depth = "32"
    if hasattr(settings, "use_exr_interleave"):
        # Blender 5.0.1 can't write parts of pixels that are not square.
        settings.use_exr_interleave = scene.render.pixel_aspect_x != scene.render.pixel_aspect_y
    scene.render.filepath = path
    bpy.ops.render.render(write_still=True)


def f12(folder):
    """One picture of a lit cube with every pass; returns the path."""
    _scene(spp=16)
    _room()
    layer = bpy.context.view_layer
    for name in dir(layer):
        if name.startswith("use_pass_") and isinstance(getattr(layer, name), bool):
            setattr(layer, name, True)
    for name in layer.penumbra.__annotations__:
        setattr(layer.penumbra, name, True)
    path = os.path.join(folder, "f12.exr")
    _render(path)
    return path


def mesh_time(count):
    """Seconds that a mesh of about a million triangles takes to cross, and its triangles."""
    import penumbra
    from bl_ext.user_default.penumbra.export import mesh

    n = int(count)
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=n, y_subdivisions=n, size=2)
    obj = bpy.context.object
    obj.data.polygons.foreach_set("use_smooth", np.ones(len(obj.data.polygons), bool))
    obj.data.update()
    evaluated = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    scene = penumbra.Scene()
    times = []
    for _ in range(3):
        start = time.perf_counter()
        mesh.hand_over(scene, 1, evaluated.data)
        times.append(time.perf_counter() - start)
    return [min(times), len(evaluated.data.loop_triangles)]


def side_by_side(name, folder, spp=256, size=64):
    """The scene `name` by both engines: paths of the two EXR files."""
    import scenes

    getattr(scenes, name)()
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = int(size) * 4 // 3, int(size)
    scene.render.resolution_percentage = 100
    scene.render.filter_size = 1.5
    for layer in scene.view_layers:
        for box in ("use_pass_z", "use_pass_normal", "use_pass_position", "use_pass_diffuse_direct",
                    "use_pass_diffuse_color", "use_pass_ambient_occlusion", "use_pass_environment"):
            setattr(layer, box, True)
        layer.penumbra.use_pass_shadow = True
    for obj in scene.objects:
        for holder in (obj, getattr(obj, "cycles", None)):
            if hasattr(holder, "shadow_terminator_geometry_offset"):
                holder.shadow_terminator_geometry_offset = 0.0
    cycles = scene.cycles
    cycles.samples, cycles.use_adaptive_sampling, cycles.use_denoising = int(spp), False, False
    cycles.sample_clamp_indirect, cycles.blur_glossy = 0.0, 0.0
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = cycles.transmission_bounces = 4
    cycles.pixel_filter_type = "BOX"
    scene.penumbra.spp, scene.penumbra.max_bounces = int(spp), 4
    paths = []
    for engine in ("CYCLES", "PENUMBRA"):
        scene.render.engine = engine
        paths.append(os.path.join(folder, f"{name}-{engine.lower()}.exr"))
        _render(paths[-1])
    return paths


def _left():
    """What an export left of itself in the scene."""
    marks = [f"{obj.name}: {key}" for obj in bpy.data.objects for key in obj.keys() if "penumbra" in key]
    marks += [data.name for group in (bpy.data.objects, bpy.data.images) for data in group if "penumbra" in data.name]
    return marks + [light.name for light in bpy.data.lights if not light.users]


def _scene_of(name):
    import export_scenes
    import scenes

    getattr(export_scenes if hasattr(export_scenes, name) else scenes, name)()


class _Listener:
    """Stands in for the engine: keeps the document that a render would get."""

    def set_document(self, text):
        self.document = json.loads(text)

    def __getattr__(self, _name):
        return lambda *_arguments: None


def export(name, path, *options):
    """The scene `name` exported; what F12 would render, and what is left behind."""
    from bl_ext.user_default.penumbra.export import Exporter

    _scene_of(name)
    render, listener = bpy.context.scene.render, _Listener()
    Exporter(listener).export(bpy.context.evaluated_depsgraph_get(), [render.resolution_x, render.resolution_y])
    bpy.ops.penumbra.export(filepath=path, **{option: True for option in options})
    return [listener.document, _left()]


def export_fails(folder):
    """Exports that are refused."""
    _scene_of("point_soft")
    refused = []
    os.mkdir(os.path.join(folder, "folder.usdc"))
    for name in ("file.obj", "missing/file.usdc", "folder.usdc"):
        try:
            bpy.ops.penumbra.export(filepath=os.path.join(folder, name))
        except RuntimeError as error:
            print(error)
            refused.append(name)
    return {"refused": refused, "left": _left()}


def export_command(path):
    """What `blender --command penumbra_export` does."""
    from bl_ext.user_default.penumbra.files import operator

    _scene_of("point_soft")
    return operator.command([path])
