"""The scenes on which Penumbra is held against Cycles: each a function that builds it, and what is to be known of it.

A scene that a file format can't carry names the door and the reason; so does a pass that is not the same by intention.
"""

import math
import sys
from dataclasses import dataclass, field
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "addon"))

import bpy
import scenes

DOORS = ("blender", "usd", "gltf")

# What glTF and USD turn to their own axes, and what they have no place for.
_INDEX = "pass indices are Blender's"
_AXES = "files are rendered with y up and in metres (docs/passes.md)"
NOT_CARRIED = {
    "usd": {"Object Index": _INDEX, "Material Index": _INDEX, "Position": _AXES, "Normal": _AXES,
            "CryptoObject": "names of prims hold no dots", "CryptoMaterial": "names of prims hold no dots"},
    "gltf": {"Object Index": _INDEX, "Material Index": _INDEX, "Position": _AXES, "Normal": _AXES},
}

# Factors of which only the product is held to Cycles: `exr.with_light` adds it to both sides.
_ESTIMATE = ("Cycles' color of a rough {0} surface is an estimate, and the light is divided by it: of {4} it is up to {1} % off the "
             "integral, ours {2} % (below); the light itself, color times direct or indirect, is held to Cycles as {3} Light")
FACTORS = {f"{name} {part}": _ESTIMATE.format(*figures, name, stuff) for name, stuff, figures in
           (("Glossy", "plastic", ("reflecting", 4.6, 0.4)), ("Transmission", "glass", ("refracting", 21, 0.1))) for part in ("Color", "Direct", "Indirect")}


@dataclass
class Stage:
    build: callable
    what: str
    """What it is there for, in a line."""
    doors: dict = field(default_factory=dict)
    """Doors that can't carry it, with the reason."""
    passes: dict = field(default_factory=dict)
    """Passes that are not held to Cycles, with the reason."""
    lamps_alone: bool = True
    """All light is of lamps, so that Cycles can leave out shadows: the reference of Shadow and Unshadowed."""
    bounces: int = 4
    share: float = 1.0
    """Samples, as a share of what is asked for."""
    by_chance: tuple = ()
    """Passes that Cycles takes from one random sample: with another number of samples they are others."""


def area_disk():
    scenes.room()
    scenes.lamp("AREA", (1.2, -0.8, 2.5), (0.3, 0.4, 0.0), energy=100.0, shape="DISK", size=1.0)


def area_rectangle():
    scenes.room()
    scenes.lamp("AREA", (1.2, -0.8, 2.5), (0.3, 0.4, 0.0), energy=100.0, shape="RECTANGLE", size=1.4, size_y=0.4)


def dome_and_sun():
    scenes.world_image()
    scenes.lamp("SUN", rotation=(0.5, 0.4, 0.0), energy=3.0, angle=0.02, color=(1.0, 0.9, 0.7))


def many_lights():
    """Seventy lamps of all kinds, most of them far from most of what they light."""
    scenes.room()
    kinds = ("POINT", "SPOT", "AREA")
    for i in range(70):
        angle, radius = i * 2.399963, 0.35 * math.sqrt(i + 1.0)
        where = (radius * math.cos(angle), radius * math.sin(angle), 0.8 + 0.7 * (i % 3))
        color = [0.6 + 0.4 * math.sin(i + phase) for phase in (0.0, 2.1, 4.2)]
        kind = kinds[i % 3]
        lamp = scenes.lamp(kind, where, energy=3.0 + (i % 5), color=color)
        if kind == "AREA":
            lamp.data.size = 0.1
        else:
            lamp.data.shadow_soft_size = 0.03


def _ao(distance):
    scenes.room()
    scenes.world(0.0)
    bpy.context.scene.world.light_settings.distance = distance
    scenes.lamp("SUN", rotation=(0.5, 0.4, 0.0), energy=3.0, angle=0.1)


def ao_short():
    _ao(0.4)


def ao_long():
    _ao(1000.0)


def ao_transparent():
    """Panes that hide a part of what is behind them."""
    _ao(20.0)
    for x, alpha in ((-1.4, 0.3), (1.4, 0.7)):
        bpy.ops.mesh.primitive_plane_add(size=1.5, location=(x, -0.5, 0.6), rotation=(0.5, 0.0, 0.4))
        bpy.context.object.data.materials.append(scenes.material("Pane", Base_Color=(0.5, 0.5, 0.5, 1.0), Alpha=alpha, Roughness=1.0))


def _quad(name, corners, matter):
    data = bpy.data.meshes.new(name)
    data.from_pydata(corners, [], [(0, 1, 2, 3)])
    data.materials.append(matter)
    return scenes.add(name, data)


def cornell_box():
    """The box: white, red and green walls, two blocks, a lamp of its ceiling's."""
    white, red, green = (scenes.material(name, "ShaderNodeBsdfDiffuse", Color=(*color, 1.0)) for name, color in
                         (("White", (0.73, 0.73, 0.73)), ("Red", (0.65, 0.05, 0.05)), ("Green", (0.12, 0.45, 0.15))))
    low, high = -1.0, 1.0
    box = {
        "Floor": [(low, low, 0), (high, low, 0), (high, high, 0), (low, high, 0)],
        "Ceiling": [(low, low, 2), (low, high, 2), (high, high, 2), (high, low, 2)],
        "Back": [(low, high, 0), (high, high, 0), (high, high, 2), (low, high, 2)],
        "Left": [(low, low, 0), (low, high, 0), (low, high, 2), (low, low, 2)],
        "Right": [(high, low, 0), (high, low, 2), (high, high, 2), (high, high, 0)],
    }
    for name, corners in box.items():
        _quad(name, corners, {"Left": red, "Right": green}.get(name, white))
    for name, size, where, turn in (("Short", (0.6, 0.6, 0.6), (0.35, -0.3, 0.3), -0.3), ("Tall", (0.6, 0.6, 1.2), (-0.33, 0.3, 0.6), 0.3)):
        bpy.ops.mesh.primitive_cube_add(size=1.0, location=where, rotation=(0.0, 0.0, turn))
        bpy.context.object.scale = size
        bpy.context.object.data.materials.append(white)
    scenes.lamp("AREA", (0.0, 0.0, 1.98), energy=12.0, size=0.5)
    camera = scenes.add("Camera", bpy.data.cameras.new("Camera"), location=(0.0, -4.6, 1.0), rotation_euler=(math.pi / 2, 0.0, 0.0))
    camera.data.lens = 42.0
    bpy.context.scene.camera = camera
    scenes.world(0.0)


def _balls(*materials, world=0.5):
    scenes.room()
    bpy.data.objects.remove(bpy.data.objects["Cube"])
    n = len(materials)
    for i, matter in enumerate(materials):
        x = (i - 0.5 * (n - 1)) * 4.2 / n
        bpy.ops.mesh.primitive_uv_sphere_add(segments=48, ring_count=24, radius=1.7 / n, location=(x, 0.0, 1.7 / n))
        bpy.ops.object.shade_smooth()
        bpy.context.object.data.materials.append(matter)
    scenes.lamp("AREA", (1.2, -0.8, 3.0), (0.2, 0.3, 0.0), energy=120.0, size=1.5)
    scenes.world(world)


def glossy_and_glass():
    """Rough metal, rough glass, plastic."""
    _balls(scenes.material("Metal", Base_Color=(0.9, 0.7, 0.4, 1.0), Metallic=1.0, Roughness=0.3),
           scenes.material("Glass", Base_Color=(1.0, 1.0, 1.0, 1.0), Transmission_Weight=1.0, Roughness=0.3),
           scenes.material("Plastic", Base_Color=(0.1, 0.3, 0.7, 1.0), Roughness=0.2))


def principled_grid():
    """Coat, sheen, metal, transmission, anisotropy, alpha."""
    base = {"Base_Color": (0.6, 0.3, 0.2, 1.0), "Roughness": 0.4}
    _balls(*(scenes.material(name, **{**base, **more}) for name, more in (
        ("Coat", {"Coat_Weight": 1.0, "Coat_Roughness": 0.1, "Coat_Tint": (0.8, 0.9, 1.0, 1.0)}),
        ("Sheen", {"Sheen_Weight": 1.0, "Sheen_Roughness": 0.4}),
        ("Half metal", {"Metallic": 0.5, "Specular_Tint": (0.7, 0.8, 1.0, 1.0)}),
        ("Half glass", {"Transmission_Weight": 0.5, "Roughness": 0.2}),
        ("Half there", {"Alpha": 0.5}),
        ("Index", {"IOR": 2.0, "Specular_IOR_Level": 0.8}),
    )))


def textured_and_bumpy():
    scenes.textured()
    bpy.data.objects.remove(bpy.data.objects["Cube"])
    bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, radius=0.8, location=(0.0, 0.0, 0.8))
    bpy.ops.object.shade_smooth()
    matter = scenes._waves(scenes.material("Waves", "ShaderNodeBsdfDiffuse", Color=(0.7, 0.6, 0.5, 1.0)), 0.02, 1.0)
    bpy.context.object.data.materials.append(matter)


def hair():
    """Wires from below the floor to above the picture: Cycles' strands are open at their ends, Penumbra's are not."""
    scenes.room()
    curves = bpy.data.hair_curves.new("Hair")
    curves.add_curves([2] * 40)
    radius = curves.attributes.get("radius") or curves.attributes.new("radius", "FLOAT", "POINT")
    for i in range(40):
        for k, z in enumerate((-0.2, 12.0)):
            curves.points[2 * i + k].position = (0.1 * i - 2.0, -1.5, z)
            radius.data[2 * i + k].value = 0.01
    scenes.add("Hair", curves)
    bpy.context.scene.cycles_curves.shape = "THICK"
    scenes.lamp("SUN", rotation=(0.5, 0.4, 0.0), energy=3.0, angle=0.1)


def motion_blur():
    scenes.room()
    cube, scene = bpy.data.objects["Cube"], bpy.context.scene
    scene.frame_start, scene.frame_end = 1, 3
    for frame, x, turn in ((1, -0.8, 0.0), (3, 0.8, 1.0)):
        cube.location.x, cube.rotation_euler.z = x, turn
        cube.keyframe_insert("location", frame=frame)
        cube.keyframe_insert("rotation_euler", frame=frame)
    # Files hold whole frames, and what is between them is on the straight line.
    for curve in cube.animation_data.action.layers[0].strips[0].channelbags[0].fcurves:
        for key in curve.keyframe_points:
            key.interpolation = "LINEAR"
    scene.frame_set(2)
    scene.render.use_motion_blur, scene.render.motion_blur_shutter = True, 0.7
    scenes.lamp("AREA", (1.2, -0.8, 2.5), (0.3, 0.4, 0.0), energy=100.0, size=1.0)


def interior():
    """A room with a window in a wall and things in it; most light has bounced."""
    walls = scenes.material("Walls", "ShaderNodeBsdfDiffuse", Color=(0.75, 0.72, 0.68, 1.0))
    floor = scenes.material("Floor", Base_Color=(0.35, 0.22, 0.12, 1.0), Roughness=0.35)
    far, deep, high = 2.0, 2.5, 2.4
    _quad("Floor", [(-far, -deep, 0), (far, -deep, 0), (far, deep, 0), (-far, deep, 0)], floor)
    _quad("Ceiling", [(-far, -deep, high), (-far, deep, high), (far, deep, high), (far, -deep, high)], walls)
    _quad("Back", [(-far, deep, 0), (far, deep, 0), (far, deep, high), (-far, deep, high)], walls)
    _quad("Front", [(-far, -deep, 0), (-far, -deep, high), (far, -deep, high), (far, -deep, 0)], walls)
    _quad("Right", [(far, -deep, 0), (far, -deep, high), (far, deep, high), (far, deep, 0)], walls)
    for name, y0, y1, z0, z1 in (("Below", -deep, deep, 0.0, 0.8), ("Above", -deep, deep, 2.0, high),
                                 ("Near", -deep, -0.3, 0.8, 2.0), ("Far", 1.2, deep, 0.8, 2.0)):
        _quad(name, [(-far, y0, z0), (-far, y1, z0), (-far, y1, z1), (-far, y0, z1)], walls)
    cloth = scenes.material("Cloth", "ShaderNodeBsdfDiffuse", Color=(0.2, 0.35, 0.5, 1.0))
    # No two faces in one place: Cycles' pixels there are of either.
    for size, where in (((0.9, 1.6, 0.45), (1.3, 0.4, 0.23)), ((0.25, 1.7, 0.9), (1.75, 0.4, 0.47)), ((0.8, 0.8, 0.4), (0.0, 0.6, 0.21))):
        bpy.ops.mesh.primitive_cube_add(size=1.0, location=where)
        bpy.context.object.scale = size
        bpy.context.object.data.materials.append(cloth)
    bpy.ops.mesh.primitive_uv_sphere_add(segments=48, ring_count=24, radius=0.25, location=(0.0, 0.6, 0.65))
    bpy.ops.object.shade_smooth()
    bpy.context.object.data.materials.append(scenes.material("Bowl", Base_Color=(0.9, 0.9, 0.9, 1.0), Metallic=1.0, Roughness=0.35))
    scenes.lamp("AREA", (-far - 0.1, 0.45, 1.4), (0.0, -math.pi / 2, 0.0), energy=160.0, shape="RECTANGLE", size=1.2, size_y=1.5,
                color=(0.9, 0.95, 1.0))
    camera = scenes.add("Camera", bpy.data.cameras.new("Camera"), location=(-0.6, -2.3, 1.4), rotation_euler=(math.radians(80), 0.0, -0.15))
    camera.data.lens = 22.0
    bpy.context.scene.camera = camera
    scenes.world(0.0)


# Passes behind a pane thinner than the view layer's Alpha Threshold.
_CHANCE = "behind a thin pane Cycles takes its one sample's random way, Penumbra always looks through (docs/passes.md)"
_ODDS = "behind a thin pane Cycles counts the samples that pass it, which are more than it lets through; Penumbra is as long as the pane is clear (docs/passes.md)"
THIN = {"Depth": _CHANCE, "Position": _CHANCE, "Object Index": _CHANCE, "Material Index": _CHANCE, "Normal": _ODDS, "UV": _ODDS,
        "Mist": "both subtract what is clear from 1 and cut below 0, so that noise behind panes is all mist: at 512 samples they agree"}
_MOMENT = dict.fromkeys(("Depth", "Position", "Object Index", "Material Index"),
                        "ours is of the middle of the shutter, Cycles' of its first sample's random moment (docs/passes.md)")
_FACETS = ("no direct light passes a closed ball; Cycles has some 10⁻⁶ of Combined where the smooth normal of a facet leans over its edge "
           "(none on flat facets, a thirteenth with four times as many)")
_THIN_GLASS = "Blender's exporter writes glass without a volume, which in glTF is a film that does not refract"

STAGES = {
    "point_soft": Stage(scenes.point_soft, "point lamp, soft falloff"),
    "point_sphere": Stage(scenes.point_sphere, "point lamp, a true sphere"),
    "point_delta": Stage(scenes.point_delta, "point lamp without size"),
    "spot": Stage(scenes.spot, "spot lamp with blend"),
    "sun": Stage(scenes.sun, "sun"),
    "area_square": Stage(scenes.area_square, "area lamp, square"),
    "area_rectangle": Stage(area_rectangle, "area lamp, rectangle"),
    "area_disk": Stage(area_disk, "area lamp, disk"),
    "area_ellipse": Stage(scenes.area_ellipse, "area lamp, ellipse, scaled"),
    "area_spread": Stage(scenes.area_spread, "area lamp with spread"),
    "mesh_light": Stage(scenes.mesh_light, "a mesh that shines", lamps_alone=False),
    "dome_and_sun": Stage(dome_and_sun, "image of a sky and a sun", lamps_alone=False),
    "many_lights": Stage(many_lights, "seventy lamps"),
    "ao_short": Stage(ao_short, "ambient occlusion within 0.4 m"),
    "ao_long": Stage(ao_long, "ambient occlusion within 1000 m"),
    "ao_transparent": Stage(ao_transparent, "ambient occlusion through panes", passes={"all": THIN}, by_chance=("Depth", "Position")),
    "cornell_box": Stage(cornell_box, "color that bleeds", bounces=8),
    "glossy_and_glass": Stage(glossy_and_glass, "rough metal, rough glass, plastic", lamps_alone=False, bounces=8,
                              doors={"gltf": _THIN_GLASS}, passes={"all": {"Transmission Light Direct": _FACETS}}),
    "principled_grid": Stage(principled_grid, "six materials", lamps_alone=False, bounces=8,
                             doors={"gltf": _THIN_GLASS + ", and no tint of coats"},
                             passes={"all": {"Transmission Light Direct": _FACETS}}),
    "textured_and_bumpy": Stage(textured_and_bumpy, "image texture and bump"),
    "instances": Stage(scenes.instances, "instances of a mesh"),
    "depth_of_field": Stage(scenes.depth_of_field, "a lens wide open, five blades",
                            passes={"all": {"Depth": "Cycles' is that of its first sample's random way through the lens, ours that through its middle"}}, by_chance=("Depth",)),
    "motion_blur": Stage(motion_blur, "a cube that moves and turns", doors={"gltf": "glTF has no shutter"},
                         passes={"all": _MOMENT}, by_chance=tuple(_MOMENT)),
    "hair": Stage(hair, "forty wires, thinner than a pixel", doors={"gltf": "glTF has no curves"},
                  passes={"all": {"Position": "two pixels whose center's ray grazes a wire: Cycles' first ray is 5 · 10⁻⁴ pixels beside the center"}}),
    "interior": Stage(interior, "a room lit through a window", bounces=8,
                      passes={"all": {"Shadow": "where a pixel's edge alone could be lit it is little over little, and 1 where no sample met that edge"}}),
}
