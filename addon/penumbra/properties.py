"""Properties that are the engine's own; they follow from its tables of settings and passes."""

import bpy
import penumbra

from . import passes

# What Cycles has properties of the scene for, with their names there.
_CYCLES = {
    "diffuse_bounces": "diffuse_bounces",
    "glossy_bounces": "glossy_bounces",
    "transmission_bounces": "transmission_bounces",
    "transparent_bounces": "transparent_max_bounces",
    "clamp_direct": "sample_clamp_direct",
    "clamp_indirect": "sample_clamp_indirect",
    "caustics_reflective": "caustics_reflective",
    "caustics_refractive": "caustics_refractive",
    "filter_glossy": "blur_glossy",
}
# What Blender has properties of its own for.
_BLENDERS = {
    "passes", "threads", "half", "filter", "motion_blur", "mist_start", "mist_depth", "mist_falloff", "shadow_terminator_geometry_offset",
    "shadow_terminator_shading_offset", *_CYCLES,
}
_UNITS = {"time": "TIME_ABSOLUTE", "ao_distance": "LENGTH"}

# Digits behind the point where two are too few.
_DIGITS = {"error": 4}


def _property(row):
    kind, default = row["kind"], row["default"]
    title = row["name"].replace("_", " ").title()
    common = {"name": title, "description": row["help"]}
    if kind == "bool":
        return bpy.props.BoolProperty(default=default == "on", **common)
    if kind == "choice":
        items = [(choice, choice.replace("_", " ").capitalize(), "") for choice in row["choices"]]
        return bpy.props.EnumProperty(items=items, default=default, **common)
    if kind == "text":
        return bpy.props.StringProperty(default=default, **common)
    # 0 stands for "not set" where a setting may be absent.
    number = float(default or 0) if kind == "float" else int(default or 0)
    lowest = 0 if not default else row["min"]
    if kind == "float":
        if row["name"] in _UNITS:
            common["unit"] = _UNITS[row["name"]]
        if row["name"] in _DIGITS:
            common.update(precision=_DIGITS[row["name"]], step=0.1)
        return bpy.props.FloatProperty(default=number, min=lowest, max=min(row["max"], 3e38), **common)
    return bpy.props.IntProperty(default=number, min=lowest, max=min(row["max"], 2**31 - 1), **common)


def _annotations():
    return {row["name"]: _property(row) for row in penumbra.settings() if row["name"] not in _BLENDERS}


class PenumbraSceneSettings(bpy.types.PropertyGroup):
    """How Penumbra renders a scene."""

    __annotations__ = {
        **_annotations(),
        "use_animated_seed": bpy.props.BoolProperty(
            name="Use Animated Seed", description="Another seed, and so other noise, for every frame", default=False
        ),
        "use_noise_estimate": bpy.props.BoolProperty(
            name="Show Noise",
            description="Tell the noise of the picture so far beside the time left; an estimate takes about a fifth more samples"
            " for the same noise. With a noise target or adaptive sampling it is told anyway",
            default=False,
        ),
        "viewport_spp": bpy.props.IntProperty(
            name="Viewport Samples", description="Samples per pixel of the rendered viewport", default=256, min=1
        ),
    }


class PenumbraViewLayerSettings(bpy.types.PropertyGroup):
    """Passes that are Penumbra's own."""

    __annotations__ = {
        f"use_pass_{name}": bpy.props.BoolProperty(name=layer, description=text)
        for name, layer, text in passes.own_boxes()
    }


def settings(scene, view_layer):
    """The engine's keyword arguments for a scene."""
    own = scene.penumbra
    result = {"passes": passes.chosen(view_layer)}
    if own.use_noise_estimate and "error" not in result["passes"]:
        result["passes"].append("error")
    for row in penumbra.settings():
        name = row["name"]
        if name in _BLENDERS:
            continue
        value = getattr(own, name)
        if not row["default"] and not value:
            continue
        result[name] = value
    if own.use_animated_seed:
        # Frames one after the other lie far apart.
        result["seed"] = (own.seed + 0x9E3779B1 * scene.frame_current) & 0x7FFF_FFFF
    if scene.render.threads_mode == "FIXED":
        result["threads"] = scene.render.threads
    cycles = getattr(scene, "cycles", None)
    kind = getattr(cycles, "pixel_filter_type", "BLACKMAN_HARRIS").lower()
    width = getattr(cycles, "filter_width", 1.5)
    result["filter"] = "box:0.5" if kind == "box" else f"{kind}:{width}"
    for name, theirs in _CYCLES.items():
        if hasattr(cycles, theirs):
            result[name] = getattr(cycles, theirs)
    if bpy.app.version < (5, 0) and "transparent_bounces" in result:
        # Measured: paths of Cycles 4 pass one more than it says, its shadow rays do not (export/camera.py).
        result["transparent_bounces"] += 1
    result.update(_mist(scene.world))
    world = scene.world
    if world is not None and "ao_distance" not in result:
        result["ao_distance"] = world.light_settings.distance
    return result


def _mist(world):
    """The world's mist, as Cycles takes it; that of no world is Cycles' own."""
    if world is None:
        return {"mist_start": 0.0, "mist_depth": 100.0, "mist_falloff": "linear"}
    mist = world.mist_settings
    return {"mist_start": mist.start, "mist_depth": mist.depth, "mist_falloff": mist.falloff.lower()}


def register():
    bpy.utils.register_class(PenumbraSceneSettings)
    bpy.utils.register_class(PenumbraViewLayerSettings)
    bpy.types.Scene.penumbra = bpy.props.PointerProperty(type=PenumbraSceneSettings)
    bpy.types.ViewLayer.penumbra = bpy.props.PointerProperty(type=PenumbraViewLayerSettings)


def unregister():
    del bpy.types.ViewLayer.penumbra
    del bpy.types.Scene.penumbra
    bpy.utils.unregister_class(PenumbraViewLayerSettings)
    bpy.utils.unregister_class(PenumbraSceneSettings)
