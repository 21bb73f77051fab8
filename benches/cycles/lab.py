"""Small scenes in Blender for measuring what Cycles computes: no bias, no clamping, box filter."""

import os
import tempfile
from pathlib import Path

import bpy
import numpy as np
import OpenImageIO as oiio
from mathutils import Vector


def reset(resolution, samples, threads=1):
    """An empty, black scene with an honest Cycles."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.resolution_x, scene.render.resolution_y = resolution
    scene.render.resolution_percentage = 100
    scene.render.threads_mode, scene.render.threads = "FIXED", threads
    scene.render.dither_intensity = 0
    settings = {
        "samples": samples, "use_adaptive_sampling": False, "use_denoising": False, "sample_clamp_direct": 0,
        "sample_clamp_indirect": 0, "blur_glossy": 0, "light_sampling_threshold": 0, "max_bounces": 64,
        "diffuse_bounces": 64, "glossy_bounces": 64, "transmission_bounces": 64, "transparent_max_bounces": 64,
        "caustics_reflective": True, "caustics_refractive": True, "pixel_filter_type": "BOX", "filter_width": 1,
    }  # fmt: skip
    for name, value in settings.items():
        setattr(scene.cycles, name, value)
    return scene


def mesh(name, vertices, faces, material=None):
    data = bpy.data.meshes.new(name)
    data.from_pydata(vertices, [], faces)
    data.update()
    if material:
        data.materials.append(material)
    obj = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(obj)
    return obj


def orthographic_camera(location, scale):
    """Looks down."""
    data = bpy.data.cameras.new("camera")
    data.type, data.ortho_scale, data.clip_end = "ORTHO", scale, 1000
    obj = bpy.data.objects.new("camera", data)
    bpy.context.scene.collection.objects.link(obj)
    obj.location = location
    bpy.context.scene.camera = obj
    return obj


def light(kind, **properties):
    data = bpy.data.lights.new("light", kind)
    for name, value in properties.items():
        setattr(data, name, value)
    obj = bpy.data.objects.new("light", data)
    bpy.context.scene.collection.objects.link(obj)
    return obj


def towards(obj, direction):
    """Turns a light so that it shines from `direction`; the direction that it then has."""
    obj.rotation_mode = "QUATERNION"
    obj.rotation_quaternion = Vector(direction).to_track_quat("Z", "Y")
    bpy.context.view_layer.update()
    z = np.array(obj.matrix_world.col[2][:3], float)
    return z / np.linalg.norm(z)


def write(path):
    """Renders to a file of one part for each pass, and prints nothing."""
    image = bpy.context.scene.render.image_settings
    if hasattr(image, "media_type"):
        image.media_type = "MULTI_LAYER_IMAGE"
    image.file_format, image.color_depth, image.exr_codec = "OPEN_EXR_MULTILAYER", "32", "ZIP"
    bpy.context.scene.render.filepath = str(path)
    saved, null = os.dup(1), os.open(os.devnull, os.O_WRONLY)
    os.dup2(null, 1)
    try:
        bpy.ops.render.render(write_still=True)
    finally:
        os.dup2(saved, 1)
        os.close(saved)
        os.close(null)


def render():
    """Channels of the picture by their full names, rows from top to bottom."""
    with tempfile.TemporaryDirectory() as folder:
        path = str(Path(folder) / "picture.exr")
        write(path)
        file = oiio.ImageInput.open(path)
        channels, part = {}, 0
        while file.seek_subimage(part, 0):
            spec = file.spec()
            pixels = file.read_image(part, 0, 0, spec.nchannels, "float")
            pixels = pixels.reshape(spec.height, spec.width, spec.nchannels)
            channels.update({name: pixels[..., i] for i, name in enumerate(spec.channelnames)})
            part += 1
    return channels
