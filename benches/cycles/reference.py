"""Renders one case with Cycles, in a process of its own: reference.py CASE FOLDER SPP SEEDS THREADS PATTERN.

Cycles' sampling is that of a new scene (multiple importance sampling, light tree, automatic sampling pattern, which
is blue noise); what trades bias for noise is off: adaptive sampling, denoising, clamping, light threshold, terminator
offset. Nothing bounces and the pixel filter is a box. Pictures that are there already are left alone.
"""

import json
import os
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

import bpy
import numpy as np
from mathutils import Matrix

import images
import scenes


def prepare(spp, threads, pattern):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    render, cycles = scene.render, scene.cycles
    render.engine, cycles.device = "CYCLES", "CPU"
    render.threads_mode, render.threads = "FIXED", threads
    render.resolution_x = render.resolution_y = scenes.SIZE
    render.resolution_percentage = 100
    render.use_persistent_data = True
    cycles.samples, cycles.sampling_pattern = spp, pattern
    cycles.use_light_tree = True
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = cycles.blur_glossy = 0
    cycles.light_sampling_threshold = 0
    cycles.max_bounces = 0
    cycles.pixel_filter_type = "BOX"
    scene.view_layers[0].use_pass_diffuse_direct = True
    image = render.image_settings
    image.media_type = "MULTI_LAYER_IMAGE"
    image.file_format, image.color_depth, image.exr_codec = "OPEN_EXR_MULTILAYER", "32", "ZIP"
    return scene


def material(name, color, emission):
    nodes = bpy.data.materials.new(name)
    nodes.use_nodes = True
    tree = nodes.node_tree
    tree.nodes.clear()
    surface = tree.nodes.new("ShaderNodeEmission" if emission else "ShaderNodeBsdfDiffuse")
    surface.inputs["Color"].default_value = (1, 1, 1, 1) if emission else (*color, 1)
    if emission:
        surface.inputs["Strength"].default_value = emission
    tree.links.new(surface.outputs[0], tree.nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
    return nodes


def add_objects(scene, objects):
    meshes = {}
    for number, thing in enumerate(objects):
        key = (id(thing.mesh[0]), thing.color, thing.emission)
        if key not in meshes:
            vertices, triangles = thing.mesh
            mesh = bpy.data.meshes.new(f"mesh{number}")
            mesh.vertices.add(len(vertices))
            mesh.vertices.foreach_set("co", vertices.ravel())
            mesh.loops.add(triangles.size)
            mesh.loops.foreach_set("vertex_index", triangles.ravel())
            mesh.polygons.add(len(triangles))
            mesh.polygons.foreach_set("loop_start", np.arange(0, triangles.size, 3, dtype=np.int32))
            mesh.update(calc_edges=True)
            mesh.shade_flat()
            mesh.materials.append(material(f"material{number}", thing.color, thing.emission))
            meshes[key] = mesh
        place(scene, bpy.data.objects.new(f"object{number}", meshes[key]), thing.matrix)


def place(scene, thing, matrix):
    scene.collection.objects.link(thing)
    thing.matrix_world = Matrix(matrix.tolist())
    if hasattr(thing, "shadow_terminator_geometry_offset"):
        thing.shadow_terminator_geometry_offset = 0
    return thing


def add_lamp(scene, number, lamp):
    area = lamp.kind in ("rect", "disk")
    data = bpy.data.lights.new(f"lamp{number}", "AREA" if area else lamp.kind.upper())
    data.energy, data.color = lamp.power, lamp.color
    if area:
        data.shape = "RECTANGLE" if lamp.kind == "rect" else "ELLIPSE"
        data.size, data.size_y = lamp.size
        data.spread = lamp.spread
    elif lamp.kind == "sun":
        data.angle = lamp.angle
    else:
        data.shadow_soft_size, data.use_soft_falloff = lamp.radius, lamp.soft
    if lamp.kind == "spot":
        data.spot_size, data.spot_blend = lamp.angle, lamp.blend
    place(scene, bpy.data.objects.new(f"lamp{number}", data), lamp.matrix)


def add_world(scene, case, folder):
    world = scene.world = bpy.data.worlds.new("world")
    world.use_nodes = True
    tree = world.node_tree
    tree.nodes.clear()
    background = tree.nodes.new("ShaderNodeBackground")
    background.inputs["Color"].default_value = (*(case.world or (0, 0, 0)), 1)
    if case.image is not None:
        picture = tree.nodes.new("ShaderNodeTexEnvironment")
        picture.image = bpy.data.images.load(str(images.write_sky(case, folder)))
        picture.image.colorspace_settings.name = "Linear Rec.709"
        tree.links.new(picture.outputs["Color"], background.inputs["Color"])
    tree.links.new(background.outputs[0], tree.nodes.new("ShaderNodeOutputWorld").inputs["Surface"])


def add_camera(scene, case):
    data = bpy.data.cameras.new("camera")
    data.sensor_fit, data.angle, data.clip_start = "HORIZONTAL", np.radians(case.fov), 0.01
    scene.camera = place(scene, bpy.data.objects.new("camera", data), scenes.look(case.eye, case.at))


def main(name, folder, spp, seeds, threads, pattern):
    case, folder = scenes.CASES[name](), Path(folder)
    scene = prepare(int(spp), int(threads), pattern)
    add_objects(scene, case.objects)
    for number, lamp in enumerate(case.lamps):
        add_lamp(scene, number, lamp)
    add_world(scene, case, folder)
    add_camera(scene, case)
    for seed in range(int(seeds)):
        path = images.path(folder, f"cycles-{pattern.lower()}", spp, seed)
        if path.exists():
            continue
        scene.cycles.seed = seed
        unfinished = path.with_suffix(".part.exr")
        scene.render.filepath = str(unfinished)
        start, cpu = time.perf_counter(), time.process_time()
        bpy.ops.render.render(write_still=True)
        # The first render builds the trees, too.
        took = {"wall": time.perf_counter() - start, "cpu": time.process_time() - cpu, "threads": int(threads)}
        path.with_suffix(".json").write_text(json.dumps(took))
        os.replace(unfinished, path)


if __name__ == "__main__":
    main(*sys.argv[1:])
