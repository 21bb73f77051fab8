"""The camera and what of the scene's settings frames the picture."""

import math

import bpy

_PROJECTION = ("lens", "sensor_width", "sensor_height", "sensor_fit", "shift_x", "shift_y", "clip_start", "clip_end",
               "ortho_scale")


# What Cycles takes where something else stands for the camera.
_OTHERS = {"lens": 50.0, "sensor_width": 36.0, "sensor_height": 24.0, "sensor_fit": "AUTO", "shift_x": 0.0, "shift_y": 0.0,
           "clip_start": 1e-5, "clip_end": 1e5, "ortho_scale": 1.0}
# What it takes of lamps that are no spots: a new one's size.
_SPOT_SIZE = math.pi / 4.0


def kind(obj):
    """The type of the camera that the object `obj` is or stands for."""
    return obj.data.type if obj.type == "CAMERA" else "PERSP"


def projection(obj):
    """How the object `obj` projects, which is a camera or stands for one: names and values."""
    if obj.type == "CAMERA":
        return {name: getattr(obj.data, name) for name in _PROJECTION}
    if obj.type == "LIGHT":
        return {**_OTHERS, "lens": 16.0 / math.tan(0.5 * getattr(obj.data, "spot_size", _SPOT_SIZE))}
    return _OTHERS


def camera(obj):
    """The object `obj` as a camera, whatever it is, as Blender has it; None for none."""
    if obj is None:
        return None
    data = obj.data
    result = {
        "name": obj.name,
        "matrix": [list(map(float, row)) for row in obj.matrix_world],
        "type": kind(obj),
        **projection(obj),
    }
    if obj.type != "CAMERA":
        return result
    dof = data.dof
    if dof.use_dof:
        result["dof"] = {
            "distance": _focus(obj, dof),
            "fstop": dof.aperture_fstop,
            "blades": dof.aperture_blades,
            "ratio": dof.aperture_ratio,
            "rotation": dof.aperture_rotation,
        }
    if data.type == "PANO":
        # The panorama's own settings moved from the Cycles add-on to the camera in 5.0.
        source = data if hasattr(data, "panorama_type") else getattr(data, "cycles", None)
        names = ("panorama_type", "latitude_min", "latitude_max", "longitude_min", "longitude_max", "fisheye_fov",
                 "fisheye_lens")
        result["panorama"] = {name: getattr(source, name) for name in names if hasattr(source, name)}
    return result


def _focus(obj, dof):
    """Distance along the axis to the object in focus, or as set."""
    target = dof.focus_object
    if target is None:
        return dof.focus_distance
    place = target.matrix_world.translation
    if target.type == "ARMATURE" and dof.focus_subtarget:
        bone = target.pose.bones.get(dof.focus_subtarget)
        if bone is not None:
            place = (target.matrix_world @ bone.matrix).translation
    view = obj.matrix_world.normalized().inverted() @ place
    return abs(view.z)


def render(scene, size, view_layer):
    """Settings that are the scene's own."""
    cycles = getattr(scene, "cycles", None)
    result = {
        "size": list(size),
        "pixel_aspect": [scene.render.pixel_aspect_x, scene.render.pixel_aspect_y],
        "exposure": getattr(cycles, "film_exposure", 1.0),
        "film_transparent": scene.render.film_transparent,
        "pass_alpha_threshold": view_layer.pass_alpha_threshold,
    }
    if getattr(cycles, "film_transparent_glass", False):
        result["transparent_glass"] = cycles.film_transparent_roughness
    if bpy.app.version < (5, 0):
        # Of what properties.py adds for paths, shadow rays have nothing.
        result["fewer_in_shadow"] = 1
    rectangle = border(scene, size)
    if rectangle is not None:
        result["border"] = rectangle
    return result


def border(scene, size):
    """The render border in pixels from the lower left corner (left, lower, right, upper), or None."""
    render = scene.render
    if not render.use_border:
        return None
    edges = (render.border_min_x, render.border_min_y, render.border_max_x, render.border_max_y)
    left, lower, right, upper = (int(edge * size[i % 2]) for i, edge in enumerate(edges))
    if right <= left or upper <= lower:
        raise ValueError("the render border holds no pixel: draw it larger, or clear it (Ctrl Alt B)")
    return [left, lower, right, upper]
