"""One stage by both engines, in a process of its own: what Cycles and Penumbra make of it, and files for the other doors.

    python engines.py STAGE FOLDER [--wheel FILE] [--size WxH] [--samples N] [--only cycles,penumbra,files]

writes cycles-1.exr, cycles-2.exr, blender-1.exr, blender-2.exr (of other seeds), scene.usdc and scene.glb.

Cycles is honest: no adaptive sampling, denoising, clamping, blurred gloss, light threshold or terminator offset, a box
filter. Where all light is of lamps, two renders more, with the lamps' shadows on and off and without multiple
importance sampling (with it Cycles' paths still meet the lamp's occluders, see the facts), give Shadow and Diffuse
Direct Unshadowed, which are added to its file.
"""

import argparse
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parents[1] / "benches" / "cycles")]

import bpy  # isort: skip (what follows is found through it)
import numpy as np

import addon
import stages
from exr import parts, save
from lab import write

PASSES = ("z", "mist", "position", "normal", "uv", "object_index", "material_index", "diffuse_direct", "diffuse_indirect",
          "diffuse_color", "glossy_direct", "glossy_indirect", "glossy_color", "transmission_direct", "transmission_indirect",
          "transmission_color", "emit", "environment", "ambient_occlusion", "cryptomatte_object", "cryptomatte_material")


def prepare(stage, size, samples):
    scene = bpy.context.scene
    render, cycles = scene.render, scene.cycles
    render.resolution_x, render.resolution_y = size
    render.resolution_percentage, render.dither_intensity = 100, 0.0
    settings = {
        "device": "CPU", "samples": samples, "use_adaptive_sampling": False, "use_denoising": False, "sample_clamp_direct": 0,
        "sample_clamp_indirect": 0, "blur_glossy": 0, "light_sampling_threshold": 0, "caustics_reflective": True,
        "caustics_refractive": True, "pixel_filter_type": "BOX", "filter_width": 1, "transparent_max_bounces": 64,
    }  # fmt: skip
    for name in ("max_bounces", "diffuse_bounces", "glossy_bounces", "transmission_bounces"):
        settings[name] = stage.bounces
    for name, value in settings.items():
        setattr(cycles, name, value)
    for obj in bpy.data.objects:
        if hasattr(obj, "shadow_terminator_geometry_offset"):
            obj.shadow_terminator_geometry_offset = 0.0
            obj.shadow_terminator_shading_offset = 0.0
    layer = scene.view_layers[0]
    for name in PASSES:
        setattr(layer, f"use_pass_{name}", True)
    if hasattr(scene, "penumbra"):
        layer.penumbra.use_pass_shadow = layer.penumbra.use_pass_unshadowed = True
        scene.penumbra.spp, scene.penumbra.max_bounces = samples, stage.bounces
    return scene


def cycles(stage, folder, seed):
    """Renders by Cycles, with what it lacks added."""
    scene, path = bpy.context.scene, folder / f"cycles-{seed}.exr"
    scene.render.engine, scene.cycles.seed = "CYCLES", seed
    write(path)
    if not stage.lamps_alone:
        return
    found = parts(path)
    direct = []
    for shadow in (True, False):
        for light in bpy.data.lights:
            light.cycles.use_multiple_importance_sampling, light.use_shadow = False, shadow
        # Other samples than those of the picture, and both times the same: the mean of a ratio is too large by the
        # variance of its lower part, which was 0.8 % of Shadow below seventy lamps with 64 samples of their own.
        scene.cycles.seed = seed + 100
        write(folder / "shadow.exr")
        direct.append(parts(folder / "shadow.exr")["ViewLayer.Diffuse Direct"][1].astype(float))
    for light in bpy.data.lights:
        light.cycles.use_multiple_importance_sampling = light.use_shadow = True
    (folder / "shadow.exr").unlink()
    lit, unshadowed = direct
    names = lambda name: tuple(f"ViewLayer.{name}.{c}" for c in "RGB")
    found["ViewLayer.Diffuse Direct Unshadowed"] = (names("Diffuse Direct Unshadowed"), unshadowed)
    shadow = np.where(unshadowed > 0.0, lit / np.where(unshadowed > 0.0, unshadowed, 1.0), 1.0)
    found["ViewLayer.Shadow"] = (names("Shadow"), shadow)
    save(path, found)


def as_principled(tree):
    """Diffuse BSDFs as what files can hold: Blender's glTF exporter knows none."""
    from jobs import _as_principled

    _as_principled(tree)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("stage", choices=stages.STAGES)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--wheel", help="not needed for Cycles alone")
    parser.add_argument("--size", default="64x48")
    parser.add_argument("--samples", type=int, default=64)
    parser.add_argument("--only", default="cycles,penumbra,files")
    options = parser.parse_args()
    wanted = options.only.split(",")
    bpy.ops.wm.read_factory_settings(use_empty=True)
    if wanted != ["cycles"]:
        addon.register(options.wheel)
    stage = stages.STAGES[options.stage]
    stage.build()
    # What has no material has another default in each format.
    for obj in bpy.data.objects:
        if obj.type in ("MESH", "CURVES") and not obj.data.materials:
            obj.data.materials.append(bpy.data.materials["Plain"])
    for material in bpy.data.materials:
        as_principled(material.node_tree)
    options.folder.mkdir(parents=True, exist_ok=True)
    samples = max(1, round(options.samples * stage.share))
    scene = prepare(stage, [int(n) for n in options.size.split("x")], samples)
    for seed in (1, 2):
        if "cycles" in wanted:
            cycles(stage, options.folder, seed)
        if "penumbra" in wanted:
            scene.render.engine, scene.penumbra.seed = "PENUMBRA", seed
            write(options.folder / f"blender-{seed}.exr")
    if "files" in wanted:
        scene.render.engine = "PENUMBRA"
        for ending in ("usdc", "glb"):
            bpy.ops.penumbra.export(filepath=str(options.folder / f"scene.{ending}"), animation=scene.render.use_motion_blur)


if __name__ == "__main__":
    main()
