"""Every way to look an image up beside Cycles: a wall of glowing tiles, one for each image and setting."""

import math
import os

import bpy
import numpy as np

import scenes

TILE = 48
"""Pixels on each side of a tile."""


def _texels(size, alpha):
    """Noise that is the same in every run, rows from the bottom; half of it dark, so that neighbours are unlike."""
    values = np.random.default_rng(7).random((size, size, 4), np.float32)
    values[..., :3] = np.where(values[..., :3] < 0.5, 0.3 * values[..., :3], values[..., :3])
    if not alpha:
        values[..., 3] = 1.0
    return values


def _image(name, size, alpha=False, floats=False):
    image = bpy.data.images.new(name, size, size, alpha=alpha, float_buffer=floats)
    image.pixels.foreach_set(_texels(size, alpha).ravel())
    image.update()
    return image


def _saved(image, folder, kind="PNG", depth="8"):
    """The image as a file, read again."""
    path = os.path.join(folder, f"{image.name}.{'exr' if kind == 'OPEN_EXR' else 'png'}")
    settings = bpy.context.scene.render.image_settings
    if hasattr(settings, "media_type"):
        settings.media_type = "IMAGE"
    settings.file_format, settings.color_mode, settings.color_depth = kind, "RGBA", depth
    if depth == "8":
        image.filepath_raw, image.file_format = path, kind
        image.save()
    else:
        image.save_render(path)
    return bpy.data.images.load(path)


def cases(folder):
    """Names of all tiles, what they show, and how: image, repetitions, what the node is like, and its output."""
    plain, veiled = _image("plain", 16), _image("veiled", 16, alpha=True)
    deep = _image("deep", 16, alpha=True, floats=True)
    files = {"plain file": _saved(plain, folder), "veiled file": _saved(veiled, folder),
             "deep file": _saved(deep, folder, "OPEN_EXR", "32")}
    images = {"plain": plain, "veiled": veiled, "deep": deep, **files}
    for name, image in images.items():
        for interpolation in ("Linear", "Closest", "Cubic", "Smart"):
            for output in ("color", "both", "alpha") if "plain" not in name else ("color",):
                yield f"{name} {interpolation} {output}", image, 1.3, {"interpolation": interpolation}, output
    for extension in ("EXTEND", "CLIP", "MIRROR"):
        for interpolation in ("Linear", "Cubic"):
            yield (f"{extension} {interpolation}", images["plain file"], 1.8,
                   {"interpolation": interpolation, "extension": extension}, "color")
    for mode in ("CHANNEL_PACKED", "NONE"):
        image = files["veiled file"].copy()
        image.alpha_mode = mode
        yield f"{mode} color", image, 1.3, {}, "color"
        yield f"{mode} both", image, 1.3, {}, "both"
    for space in ("Non-Color", "Linear Rec.2020"):
        image = files["veiled file"].copy()
        image.colorspace_settings.name = space
        for output in ("color", "both"):
            yield f"{space} {output}", image, 1.3, {}, output
    # Many texels in a pixel.
    fine, thin = _image("fine", 256), _image("thin", 256, alpha=True)
    for interpolation in ("Linear", "Cubic"):
        yield f"fine {interpolation}", fine, 1.0, {"interpolation": interpolation}, "color"
        yield f"fine far {interpolation}", fine, 6.0, {"interpolation": interpolation}, "color"
        yield f"thin {interpolation} color", thin, 1.0, {"interpolation": interpolation}, "color"
        yield f"thin {interpolation} over", thin, 1.0, {"interpolation": interpolation}, "over"


def _material(image, repetitions, properties, output):
    """Glows in the image's colour, its alpha, both multiplied, or its colour over what is behind."""
    material = bpy.data.materials.new("m")
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    mapping = tree.nodes.new("ShaderNodeMapping")
    mapping.inputs["Scale"].default_value = (repetitions,) * 3
    mapping.inputs["Location"].default_value = (-0.23, 0.11, 0.0)
    tree.links.new(tree.nodes.new("ShaderNodeTexCoord").outputs["UV"], mapping.inputs["Vector"])
    texture = tree.nodes.new("ShaderNodeTexImage")
    texture.image = image
    for key, value in properties.items():
        setattr(texture, key, value)
    tree.links.new(mapping.outputs[0], texture.inputs["Vector"])
    glow = tree.nodes.new("ShaderNodeEmission")
    color, alpha = texture.outputs["Color"], texture.outputs["Alpha"]
    tree.links.new(alpha if output == "alpha" else color, glow.inputs["Color"])
    if output == "both":
        add = tree.nodes.new("ShaderNodeMath")
        add.inputs[1].default_value = 0.2
        tree.links.new(alpha, add.inputs[0])
        tree.links.new(add.outputs[0], glow.inputs["Strength"])
    shown = glow.outputs[0]
    if output == "over":
        mix = tree.nodes.new("ShaderNodeMixShader")
        tree.links.new(alpha, mix.inputs[0])
        tree.links.new(tree.nodes.new("ShaderNodeBsdfTransparent").outputs[0], mix.inputs[1])
        tree.links.new(shown, mix.inputs[2])
        shown = mix.outputs[0]
    tree.links.new(shown, tree.nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
    return material


def wall(folder):
    """The scene; returns the tiles' names, row by row from the bottom, and how many are in a row and a column."""
    made = list(cases(folder))
    columns = math.ceil(math.sqrt(len(made)))
    rows = math.ceil(len(made) / columns)
    for number, (name, *what) in enumerate(made):
        mesh = bpy.data.meshes.new(name)
        mesh.from_pydata([(-0.5, -0.5, 0), (0.5, -0.5, 0), (0.5, 0.5, 0), (-0.5, 0.5, 0)], [], [(0, 1, 2, 3)])
        mesh.uv_layers.new(name="UVMap").data.foreach_set("uv", [0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 1.0])
        mesh.materials.append(_material(*what))
        scenes.add(name, mesh, location=(number % columns + 0.5 - columns / 2, number // columns + 0.5 - rows / 2, 0.0))
    camera = bpy.data.cameras.new("Camera")
    camera.type, camera.ortho_scale, camera.sensor_fit = "ORTHO", columns, "HORIZONTAL"
    bpy.context.scene.camera = scenes.add("Camera", camera, location=(0, 0, 5))
    scenes.world(0.0)
    return [name for name, *_ in made], columns, rows
