"""The scenes of tests/hard_cases/, made in Blender with the same numbers and under the same names."""

import math
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Callable

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / folder) for folder in ("tests/addon", "benches/cycles")]

import bpy  # isort: skip (what follows is found through it)
import numpy as np
from mathutils import Matrix

import lab
import scenes

PI = math.pi
DOWN = (0.0, -1.0, 0.0)
MOVED = np.array([1234.5, -987.6, 2345.7])
TILT = 0.5


@dataclass
class Row:
    """A scene by the name that it has in Rust: the mean of a layer, or another measure of the channels and the place."""

    name: str
    build: Callable
    spp: int
    layer: str = "Diffuse Direct"
    size: tuple = (4, 4)
    moved: np.ndarray = None
    by: Callable = None
    bounces: int = 64
    passes: tuple = ()
    offset: float = 0.0


def e(number):
    """As Rust writes it with {:e}."""
    mantissa, power = f"{number:.9e}".split("e")
    return f"{mantissa.rstrip('0').rstrip('.')}e{int(power)}"


def g(number):
    return f"{number:.12g}"


# Scenes stand in Blender as they do in Rust, y upwards: Cycles knows no up.


class NotExpressible(Exception):
    """Blender clamps a value."""


class Place:
    """Where in the world the scene stands."""

    at = np.zeros(3)


def affine(linear, by=(0.0, 0.0, 0.0)):
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = linear, by
    return matrix


def moved(*by):
    return affine(np.eye(3), by)


def diagonal(*scale):
    return affine(np.diag(scale))


def turned(axis, angle):
    """About an axis, in radians."""
    i, j = [(1, 2), (2, 0), (0, 1)][axis]
    matrix = np.eye(4)
    matrix[i, i] = matrix[j, j] = math.cos(angle)
    matrix[j, i] = math.sin(angle)
    matrix[i, j] = -matrix[j, i]
    return matrix


def put(obj, transform=None):
    """By the matrix itself: what Blender takes apart into turn and scale is rounded and loses shear."""
    root = bpy.data.objects.get("Root") or scenes.add("Root", None)
    obj.parent = root
    obj.matrix_parent_inverse = Matrix((moved(*Place.at) @ (np.eye(4) if transform is None else transform)).tolist())
    return obj


def assign(thing, **values):
    """Sets properties, which have to be those that were given."""
    for name, value in values.items():
        setattr(thing, name, value)
        if isinstance(value, float) and not math.isclose(getattr(thing, name), value, rel_tol=1e-6, abs_tol=1e-45):
            raise NotExpressible(f"{name} of {value} becomes {getattr(thing, name)}")


def white(albedo=1.0):
    return scenes.material("Matte", "ShaderNodeBsdfDiffuse", Color=(albedo, albedo, albedo, 1.0))


def mesh(vertices, faces, material, transform=None):
    return put(lab.mesh("Mesh", np.asarray(vertices, float).tolist(), faces, material), transform)


def ground(half, material=None, transform=None):
    return mesh([(-half, 0, half), (3 * half, 0, half), (-half, 0, -3 * half)], [(0, 1, 2)], material or white(), transform)


def quad(corner, a, b, material):
    corner, a, b = (np.array(v, float) for v in (corner, a, b))
    return mesh([corner, corner + a, corner + a + b, corner + b], [(0, 1, 2), (0, 2, 3)], material)


def ball(n, material, radius=1.0, smooth=False):
    def at(i, j):
        return i * 2 * n + j % (2 * n)

    points = [(math.sin(t) * math.cos(p), math.cos(t), math.sin(t) * math.sin(p))
              for t in (PI * i / n for i in range(n + 1)) for p in (PI * j / n for j in range(2 * n))]
    faces = [face for i in range(n) for j in range(2 * n)
             for face in ((at(i, j), at(i, j + 1), at(i + 1, j)), (at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)))]
    obj = mesh(points, faces, material, diagonal(*[radius] * 3))
    if smooth:
        obj.data.polygons.foreach_set("use_smooth", [True] * len(faces))
        obj.data.normals_split_custom_set_from_vertices(points)
    return obj


def camera(transform=None, **values):
    data = bpy.data.cameras.new("Camera")
    assign(data, clip_start=1e-6, clip_end=1e15, **values)
    bpy.context.scene.camera = put(scenes.add("Camera", data), transform)
    return data


def look(forward, half, target=(0.0, 0.0, 0.0), away=1.0, at=None):
    """Orthographic, as the builder of Rust's tests has it; `away` times what that puts between it and the origin."""
    x, y, z = forward = np.array(forward) / np.linalg.norm(forward)
    sign = math.copysign(1.0, z)
    right = np.array([-x * y / (sign + z), sign - y * y / (sign + z), -y])
    position = away * (np.array(target) - forward) if at is None else at
    return camera(affine(np.stack([right, np.cross(right, forward), -forward], axis=1), position), type="ORTHO", ortho_scale=2.0 * half)


def lamp(kind, transform=None, **values):
    obj = put(scenes.lamp(kind, (0.0, 0.0, 0.0)), transform)
    assign(obj.data, **values)
    return obj


def sun(tilt=TILT, irradiance=PI, angle=0.0):
    return lamp("SUN", turned(0, tilt - PI / 2), energy=irradiance, angle=angle)


def sphere(radius, radiance, at):
    return lamp("POINT", moved(*at), energy=4.0 * PI**2 * radius**2 * radiance, shadow_soft_size=radius, use_soft_falloff=False)


def point(intensity=PI, at=(0.0, 1.0, 0.0)):
    return lamp("POINT", moved(*at), energy=4.0 * PI * intensity, shadow_soft_size=0.0)


def rectangle(transform, radiance=1.0, width=1.0, height=1.0, shape="RECTANGLE"):
    """Unnormalized, so that one without area has a radiance."""
    return lamp("AREA", transform, energy=PI * radiance, normalize=False, shape=shape, size=width, size_y=height)


def down(*at):
    return moved(*at) @ turned(0, -PI / 2)


def along_x(*at):
    return moved(*at) @ turned(1, -PI / 2)


def floor(half=1e-9):
    ground(10.0)
    look(DOWN, half)


def above(*lamps):
    """The floor, then lamps: each a function and what it is given."""
    def build():
        floor()
        for make, *given in lamps:
            make(*given)
    return build


def of(material, socket, node_type, output=0, **values):
    """Puts a node before a socket of the material's shader."""
    tree = material.node_tree
    node = tree.nodes.new(node_type)
    for name, value in values.items():
        setattr(node, name, value)
    shader = next(one for one in tree.nodes if socket in one.inputs)
    tree.links.new(node.outputs[output], shader.inputs[socket])
    return node


def image(texels, size, space="Non-Color"):
    """Rows from the bottom."""
    made = bpy.data.images.new("image", *size, float_buffer=True)
    made.colorspace_settings.name = space
    made.pixels.foreach_set(np.concatenate([np.reshape(texels, (-1, 3)), np.ones((size[0] * size[1], 1))], axis=1).ravel().astype(np.float32))
    made.update()
    return made


def multiple(material):
    """Microfacets that light leaves at last."""
    next(node for node in material.node_tree.nodes if hasattr(node, "distribution")).distribution = "MULTI_GGX"
    return material


def glass(ior, roughness=0.0):
    return multiple(scenes.material("Glass", "ShaderNodeBsdfGlass", Color=(1.0, 1.0, 1.0, 1.0), IOR=ior, Roughness=roughness))


def metal(roughness):
    return multiple(scenes.material("Metal", Base_Color=(1.0, 1.0, 1.0, 1.0), Metallic=1.0, Roughness=roughness))


def glow(radiance=1.0):
    return scenes.material("Glow", "ShaderNodeEmission", Strength=radiance)


# Rows, room by room.


def scales():
    def build(scale):
        ground(10.0 * scale)
        sphere(0.2 * scale, 25.0, (0.0, scale, 0.0))
        # Blender's cameras see nothing within a micrometre.
        look((0.3, -1.0, 0.2), 1e-3 * scale, away=max(scale, 1e-5))

    def far():
        build(1.0)
        obj = next(obj for obj in bpy.data.objects if obj.type == "MESH")
        obj.data.transform(Matrix.Translation((1024.0, 2048.0, -1024.0)))
        put(obj, moved(-1024.0, -2048.0, 1024.0))

    for scale in (1e-6, 1e-3, 1.0, 1e3, 1e6, 1e9):
        yield Row(f"floor under a ball of light, scale {e(scale)}", lambda s=scale: build(s), 256, moved=MOVED * max(scale, 1.0))
    for away in (1e6, 1e7):
        yield Row(f"floor under a ball of light, {e(away)} m from the origin", lambda: build(1.0), 256, moved=np.array([0.6, -0.48, 0.64]) * away)
    yield Row("vertices 2.5 km off, brought back by their object", far, 256)


def coincident():
    def pair(cover):
        ground(1.0)
        ground(1.0, transform=cover)
        sun()
        look(DOWN, 0.1, (0.01, 0.0, 0.02))

    def many():
        faces = [(0, 1, 2)] * 1000 + [(0, 0, 0)] * 5000 + [(0, 3, 3)] * 5000
        mesh([(-1, 0, 1), (3, 0, 1), (-1, 0, -3), (0, 0, 0)], faces, white())
        sun()
        look(DOWN, 0.1, (0.01, 0.0, 0.02))

    def instances():
        instanced(ground(1.0), np.zeros((100_000, 3)))
        sun()
        look(DOWN, 0.1, (0.01, 0.0, 0.02))

    for gap in (0.0, 1e-7, 1e-6, 1e-5, 1e-4):
        yield Row(f"two faces, {e(gap)} m apart, under a sun", lambda y=gap: pair(moved(0, y, 0)), 16)
    for lean in (1e-7, 1e-6, 1e-4):
        about = moved(-0.5, 0, 0)
        yield Row(f"two faces that lean by {e(lean)}", lambda a=lean: pair(about @ turned(2, a) @ np.linalg.inv(about)), 16)
    yield Row("1,000 triangles in one place and 10,000 without area", many, 16)
    yield Row("100,000 instances in one place", instances, 4, size=(2, 2))


def instanced(obj, points):
    """At each of the points."""
    many = mesh(points, [], None)
    obj.parent, obj.matrix_parent_inverse = many, Matrix.Identity(4)
    many.instance_type, many.show_instancer_for_render = "VERTS", False


def thin():
    def grazed(tilt):
        ground(10.0)
        sun(tilt)
        look(DOWN, 0.1)

    def aslant(tilt):
        ground(10.0)
        scenes.world(1.0)
        look((math.sin(tilt), -math.cos(tilt), 0.0), 1e-6)

    def needles():
        count = 1000
        points = [((i - 0.5 * count) * 1e-6, 0.0, z) for i in range(count + 1) for z in (0.5, -0.5)]
        mesh(points, [t for i in range(count) for t in ((2 * i, 2 * i + 2, 2 * i + 3), (2 * i, 2 * i + 3, 2 * i + 1))], white())
        sun()
        look(DOWN, 4e-4, (0.0, 0.0, 0.1))
        bpy.context.scene.render.film_transparent = True

    for degrees in (89.0, 89.99, 89.999):
        tilt = math.radians(degrees)
        yield Row(f"sun {g(degrees)} degrees from the zenith", lambda t=tilt: grazed(t), 16)
        yield Row(f"floor in a white world, seen {g(degrees)} degrees from its normal", lambda t=tilt: aslant(t), 256)
    yield Row("floor of 2,000 needles, 1 m long and 1 um wide", needles, 64, size=(16, 16))
    yield Row("the same floor: alpha", needles, 64, "Combined", (16, 16), by=lambda seen, _: seen("Combined", "A").mean())


def transforms():
    def placed(matrix, unit=10.0):
        ground(unit, transform=matrix)
        sun()
        look(DOWN, 1e-3)

    def flat():
        placed(np.eye(4))
        for linear in (np.zeros((3, 3)), np.diag([1, 0, 0]), [[1, 1, 1], [0, 0, 0], [0, 0, 0]]):
            ground(10.0, transform=affine(linear, (0.0, 0.5, 0.0)))

    sheared = np.eye(4)
    sheared[0, 2] = 1000.0
    for name, matrix, unit in (
        ("mirrored", diagonal(-1, 1, 1), 10.0), ("turned inside out", diagonal(-1, -1, -1), 10.0),
        ("of 1e8 m, scaled by 1e-8", diagonal(*[1e-8] * 3), 1e9), ("of 1e-8 m, scaled by 1e8", diagonal(*[1e8] * 3), 1e-7),
        ("scaled to 0 along its normal", diagonal(1, 0, 1), 10.0), ("scaled by 1e6 and 1e-6", diagonal(1e6, 1, 1e-6), 1e4),
        ("sheared by 1000", sheared, 1e4),
    ):  # fmt: skip
        yield Row(f"floor {name}", lambda m=matrix, u=unit: placed(m, u), 16)
    yield Row("beside instances that are points and lines", flat, 16)

    def chain():
        held = ground(10.0)
        held.matrix_parent_inverse = Matrix()
        for _ in range(720):
            holder = scenes.add("Holder", None, location=(1.0, 0.0, 0.0), rotation_euler=(0.0, math.radians(1.0), 0.0))
            held.parent, held = holder, holder
        put(held)
        sun()
        look(DOWN, 1e-3)

    yield Row("at the end of a chain of 720 nodes of a glTF file", chain, 16)


def occlusion():
    def build(size, away):
        bpy.context.scene.world.light_settings.distance = 1e5
        ground(0.3 * size)
        quad((-0.37 * size, 0.0, -away), (size, 0.0, 0.0), (0.0, 1.0, 0.0), white())
        look(DOWN, 0.1 * away)

    for size, away in ((20.0, 1e-5), (20.0, 1e-3), (2000.0, 1e-3), (2000.0, 1e-4)):
        yield Row(f"ambient occlusion {e(away)} m from a wall of {g(size)} m", lambda s=size, a=away: build(s, a), 4096, "Ambient Occlusion")


def stadium():
    def build():
        ground(1e5)
        corners = np.array([(0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1)])
        points = [(corners + (2 * (i % 50), 0, 2 * (i // 50))) * 1e-3 for i in range(2500)]
        faces = [t for k in range(0, 10_000, 4) for t in ((k, k + 2, k + 1), (k, k + 3, k + 2))]
        patch = mesh(np.concatenate(points), faces, white())
        for i in range(400):
            put(patch if i == 0 else scenes.add("Patch", patch.data), moved(i % 20 * 0.1 - 1.0, 0.5, i // 20 * 0.1 - 1.0))
        sun(0.0)
        look(DOWN, 0.5)

    yield Row("a million specks of 1 mm above a floor of 200 km, seen from the sun", build, 256, size=(32, 32))


def balls():
    def build(radius, away):
        # Scripts can't make points, geometry nodes can.
        tree = bpy.data.node_groups.new("Ball", "GeometryNodeTree")
        for way in ("INPUT", "OUTPUT"):
            tree.interface.new_socket("Geometry", in_out=way, socket_type="NodeSocketGeometry")
        chain = [tree.nodes.new(kind) for kind in ("NodeGroupInput", "GeometryNodeMeshToPoints", "GeometryNodeSetMaterial", "NodeGroupOutput")]
        for one, other in zip(chain, chain[1:]):
            tree.links.new(one.outputs[0], other.inputs[0])
        chain[1].inputs["Radius"].default_value, chain[2].inputs["Material"].default_value = radius, white()
        mesh([(0.0, 0.0, 0.0)], [], None).modifiers.new("Ball", "NODES").node_group = tree
        scenes.world(1.0)
        look((0.0, 0.0, -1.0), 0.999 * radius, away=radius * away)

    def covered(seen, _):
        light = seen("Diffuse Direct")
        return light[light > 0.0].mean() if (light > 0.0).sum() > 150 else 0.0

    for radius in (1e-5, 1.0, 1e6):
        for away in (2.0, 1e3, 1e6):
            yield Row(f"ball of radius {e(radius)} m, seen from {e(away)} radii: radiance in a white world", lambda r=radius, a=away: build(r, a),
                      64, size=(16, 16), moved=MOVED * min(radius, 1.0), by=covered)


def within():
    def inside():
        ball(16, glass(1.5), 5.0)
        scenes.world(1.0)
        look(DOWN, 0.5, (0.3, 0.1, 0.2))

    def upon(forward):
        ground(10.0, white(0.0))
        scenes.world(1.0)
        look(forward, 0.1, at=(0.0, 0.0, 0.0))

    yield Row("camera inside glass in a white world", inside, 256, "Combined", bounces=1000)
    for name, forward in (("up", (0.0, 1.0, 0.0)), ("into it", DOWN)):
        yield Row(f"camera on a black floor, looking {name}, in a white world", lambda f=forward: upon(f), 16, "Combined")


def rectangles():
    for gap in (1.0, 1e-1, 1e-2, 1e-3, 1e-4, 1e-5):
        yield Row(f"rectangle of 1 m, {e(gap)} m above", above((rectangle, down(-0.1237, gap, -0.0412))), 1024)
    yield Row("rectangle of a solid angle of 1e-9", above((rectangle, down(0, math.sqrt(1e9), 0), 1e9)), 64)
    yield Row("rectangle edge-on", above((rectangle, along_x(0, 1, 0))), 64)
    for away in (1e-3, 1e-6):
        yield Row(f"rectangle {e(away)} m from edge-on", above((rectangle, along_x(-away, 1, 0))), 1024)
    for away in (1.0, 1e-3, 1e-6):
        yield Row(f"rectangle that stands on the floor, {e(away)} m away", above((rectangle, along_x(-away, 0.5, 0))), 4096)
    for away in (1.0, 1e-3):
        yield Row(f"rectangle that the floor cuts in half, {e(away)} m away", above((rectangle, along_x(-away, 0, 0))), 4096)


def spheres():
    def small(d):
        ground(1e-2)
        look(DOWN, 1e-9, away=1e-2)
        sphere(1e-3, d * d, (0.0, d * 1e-3, 0.0))

    for name, d in (("1e-6 radii from its skin", 1.0 + 1e-6), ("1e-3 radii from its skin", 1.0 + 1e-3), ("1e3 radii away", 1e3), ("1e6 radii away", 1e6)):
        yield Row(f"sphere light {name}", lambda d=d: small(d), 16384)
    yield Row("inside a sphere light", above((sphere, 1.0, 1.0, (0.0, 0.5, 0.0))), 1024)
    for d in (1e-5, 1.0, 1e5):
        yield Row(f"disk of radius 1 m, {e(d)} m above", above((rectangle, down(0, d, 0), 1.0 + d * d, 2.0, 2.0, "DISK")), 1024)


def suns():
    def sky(bright):
        floor()
        texels = np.full((128, 256, 3), 1e-3)
        texels[127 - 30, 100] = bright
        scenes.world(1.0)
        tree = bpy.context.scene.world.node_tree
        texture, turn, direction = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("TexEnvironment", "Mapping", "TexCoord"))
        texture.image = image(texels, (256, 128), "Linear Rec.709")
        turn.inputs["Rotation"].default_value = (PI / 2, 0.0, 0.0)  # Its poles are along z.
        tree.links.new(direction.outputs["Generated"], turn.inputs["Vector"])
        tree.links.new(turn.outputs[0], texture.inputs["Vector"])
        tree.links.new(texture.outputs["Color"], tree.nodes["Background"].inputs["Color"])

    for name, degrees, tilt, spp in (
        ("of 0 degrees", 0.0, TILT, 16), ("of 0.01 degrees", 0.01, TILT, 64),
        ("of 0.01 degrees, 89.99 degrees from the zenith", 0.01, math.radians(89.99), 4096),
        ("of 180 degrees in the zenith", 180.0, 0.0, 1024), ("of 180 degrees, 60 degrees from the zenith", 180.0, PI / 3, 4096),
    ):  # fmt: skip
        yield Row(f"sun {name}", above((sun, tilt, PI, math.radians(degrees))), spp)
    yield Row("black dome", above((scenes.world, 0.0)), 64, "Combined")
    for bright in (1e2, 1e8):
        yield Row(f"dome of 1e-3 with one texel of {e(bright)}", lambda b=bright: sky(b), 1024)


def many():
    def pair():
        floor()
        for name, intensity, height in (("dim", 1e-12, 1.0), ("bright", 1e12, 2.0)):
            bpy.context.view_layer.lightgroups.add(name=name)
            point(intensity * PI, (0.0, height, 0.0)).lightgroup = name

    def spiral():
        floor()
        share = (np.arange(100_000) + 0.5) / 100_000
        r, phi = 5.0 * np.sqrt(share), np.arange(100_000) * 2.399963
        instanced(point(1e-5, (0.0, 0.0, 0.0)), np.stack([r * np.cos(phi), 1.0 + 3.0 * share, r * np.sin(phi)], axis=1))

    yield Row("lamps of 1e-12 and 1e12 W/sr, together", pair, 64)
    for name in ("dim", "bright"):
        yield Row(f"lamps of 1e-12 and 1e12 W/sr, the {name} one's layer", pair, 64, f"Combined_{name}")
    yield Row("100,000 lamps", spiral, 4096)


def sizes():
    def triangle():
        mesh([(0.5, 0.5, 0.0), (0.5, 0.7, 0.0), (0.5, 0.9, 0.0)], [(0, 1, 2)], glow(5.0))

    def spot(degrees, blend):
        lamp("SPOT", down(0, 1, 0), energy=4.0 * PI**2, shadow_soft_size=0.0, spot_size=math.radians(degrees), spot_blend=blend)

    beside = down(0.3, 0.5, 0.0)
    for name, other in (("rectangle without width", (rectangle, beside, 5.0, 0.0)), ("disk without size", (rectangle, beside, 5.0, 0.0, 0.0, "DISK")), ("triangle", (triangle,))):
        yield Row(f"emitter of zero area: {name}", above((point,), other), 16)
    for degrees in (0.0, 0.02, 180.0):
        for blend in (0.0, 1.0):
            yield Row(f"spot of {g(degrees)} degrees, blend {g(blend)}, on its axis", above((spot, degrees, blend)), 16)
    for name, other in (("point", (point, PI, (0, -1, 0))), ("rectangle", (rectangle, down(0, -1, 0))), ("sphere", (sphere, 0.5, 1.0, (0, -1, 0))), ("sun", (sun, PI, 1.0, 0.1))):
        yield Row(f"light behind the surface: {name}", above(other), 64)


def terminator():
    towards = np.array([0.0, math.cos(math.radians(80)), math.sin(math.radians(80))])

    def build():
        ball(8, white(), smooth=True)
        sun(math.radians(80))
        look(DOWN, 1.1, away=3.0)

    def black(seen, _):
        normal = np.stack([seen("Normal", axis) for axis in "XYZ"], axis=-1)
        lit = (normal @ towards > 0.05) & (np.linalg.norm(normal, axis=-1) > 0.99)
        assert lit.sum() > 1000
        return (seen("Combined")[lit] <= 0.0).mean()

    yield Row("terminator on a ball of 16 x 8 faces: share of lit pixels that are black", build, 4, "Combined", (96, 96), by=black, bounces=0, passes=("normal",), offset=0.1)


def furnace(material, degrees):
    ground(10.0, material)
    scenes.world(1.0)
    angle = math.radians(degrees)
    look((math.sin(angle), -math.cos(angle), 0.0), 1e-4)


def roughness():
    for rough in (0.0, 1e-7, 1e-4, 1e-2, 0.1, 0.5, 1.0):
        for degrees in (45.0, 89.999):
            yield Row(f"white metal of roughness {e(rough)} in a white world, {g(degrees)} degrees from its normal",
                      lambda r=rough, d=degrees: furnace(metal(r), d), 1024, "Combined")


def shells(*layers):
    """Balls of glass by index and radius."""
    for index, radius in layers:
        ball(12, glass(index), radius)
    scenes.world(1.0)
    look(DOWN, 0.9, away=3.0)


def index():
    for ior in (1.0, 1.0 + 1e-6, 1.0 - 1e-6, 0.5, 3.0):
        for rough in (0.0, 0.3):
            for degrees in (45.0, 89.999):
                yield Row(f"white glass of index {g(ior)} and roughness {g(rough)} in a white world, {g(degrees)} degrees from its normal",
                          lambda i=ior, r=rough, d=degrees: furnace(glass(i, r), d), 1024, "Combined")
    for ior in (1.0, 1.0 + 1e-6, 0.5, 1.5, 3.0):
        yield Row(f"ball of glass of index {g(ior)} in a white world", lambda i=ior: shells((i, 1.0)), 64, "Combined", (8, 8), bounces=1000)


def nested():
    yield Row("balls of index 2.4 in 1.33 in 1.5 in a white world", lambda: shells((1.5, 1.0), (1.33, 0.7), (2.4, 0.4)), 64, "Combined", (8, 8), bounces=1000)


def bounces():
    def build():
        box = white()
        tree = box.node_tree
        both, glows = tree.nodes.new("ShaderNodeAddShader"), tree.nodes.new("ShaderNodeEmission")
        glows.inputs["Strength"].default_value = 1e-3
        tree.links.new(next(node for node in tree.nodes if node.type == "BSDF_DIFFUSE").outputs[0], both.inputs[0])
        tree.links.new(glows.outputs[0], both.inputs[1])
        tree.links.new(both.outputs[0], next(node for node in tree.nodes if node.type == "OUTPUT_MATERIAL").inputs["Surface"])
        ball(8, box)
        look(DOWN, 0.4, (0.0, -0.5, 0.0))

    yield Row("closed box of albedo 1, 1,000 bounces", build, 16, "Combined", bounces=1000)


def maps():
    def textured(material):
        obj = mesh([(-1, 0, 1), (1, 0, 1), (1, 0, -1), (-1, 0, -1)], [(0, 1, 2), (0, 2, 3)], material)
        uv = obj.data.uv_layers.new(name="UVMap").data
        for loop, corner in zip(obj.data.loops, uv):
            corner.uv = ((0, 0), (1, 0), (1, 1), (0, 1))[loop.vertex_index]
        scenes.world(1.0)

    def bumped(normal, material):
        node = of(material, "Normal", "ShaderNodeNormalMap", uv_map="UVMap")
        texture = material.node_tree.nodes.new("ShaderNodeTexImage")
        texture.image, texture.interpolation = image(normal, (1, 1)), "Closest"
        material.node_tree.links.new(texture.outputs["Color"], node.inputs["Color"])
        textured(material)
        look((0.866, -0.5, 0.0), 0.1)

    def spoilt(bad):
        material = white()
        of(material, "Color", "ShaderNodeTexImage", image=image([bad] * 9 + [0.5] * 3, (2, 2)), interpolation="Closest")
        textured(material)
        look(DOWN, 0.9)

    for name, normal in (("along the surface", (1, 0.5, 0.5)), ("into the surface", (0.5, 0.5, 0)), ("aside and into it", (1, 0.5, 0.2)), ("nowhere", (0.5, 0.5, 0.5))):
        for kind, made in (("matte", white), ("metal", lambda: metal(0.2))):
            yield Row(f"normals {name}, white {kind} in a white world: light above 1", lambda n=normal, m=made: bumped(n, m()), 256, "Combined",
                      by=lambda seen, _: max(seen("Combined").mean() - 1.0, 0.0))
    for name, bad in (("NaN", math.nan), ("infinity", math.inf), ("-infinity", -math.inf), ("1e-40", 1e-40)):
        yield Row(f"texture with three texels of four {name}", lambda b=bad: spoilt(b), 256, "Combined", (16, 16))


def opacity():
    def build(alpha):
        ground(10.0, white(0.25))
        quad((-1, 0.5, 1), (2, 0, 0), (0, 0, -2), scenes.material("Film", Base_Color=(0.75, 0.75, 0.75, 1.0), Specular_IOR_Level=0.0, Alpha=alpha))
        sun(0.0)
        look(DOWN, 0.1)

    for alpha in (0.0, 1.0):
        yield Row(f"film of opacity {g(alpha)} above a floor", lambda a=alpha: build(a), 16, "Combined")


def wall(away, **values):
    half = 1e3 * away
    quad((-0.7 * half, -0.9 * half, -away), (2 * half, 0, 0), (0, 2 * half, 0), white())
    return camera(**values)


def perspective(degrees, least=1.0):
    """By a sensor that is as high as the lens, of at least a millimetre, asks for."""
    half = math.tan(math.radians(0.5 * degrees))
    lens = max(least, least / half)
    return {"lens": lens, "sensor_fit": "VERTICAL", "sensor_height": 2.0 * half * lens}


def projections():
    def astray(half):
        def measure(seen, at):
            x, y = (seen("Position", axis).astype(float) - shift for axis, shift in zip("XY", at))
            h, w = x.shape
            across, upwards = ((2 * np.arange(w) + 1) / w - 1) * half[0], (1 - (2 * np.arange(h) + 1) / h) * half[1]
            return max(np.abs(x - across).max(), np.abs(y - upwards[:, None]).max()) / half[1]
        return measure

    def places(name, build, half, to):
        return Row(f"{name}: largest error of a position, in halves of the picture", build, 1, "Position", (15, 15), np.array(to), astray(half))

    def stretched(aspect):
        render = bpy.context.scene.render
        assign(render, pixel_aspect_x=max(aspect, 1.0), pixel_aspect_y=max(1.0 / aspect, 1.0))
        wall(1.0, **perspective(60.0))

    for degrees, away, to in ((0.01, 1000.0, (1.0, -2.0, 1e3)), (179.0, 1.0, MOVED)):
        half = away * math.tan(math.radians(0.5 * degrees))
        yield places(f"field of view of {g(degrees)} degrees", lambda d=degrees, a=away: wall(a, **perspective(d)), (half, half), to)
    yield places("orthographic, 2e-6 m wide", lambda: wall(1.0, type="ORTHO", ortho_scale=2e-6), (1e-6, 1e-6), (1e-6, -1e-6, 1e3))
    for aspect in (0.01, 100.0):
        half = math.tan(PI / 6)
        yield places(f"pixel aspect of {g(aspect)}", lambda a=aspect: stretched(a), (half * aspect, half), (1.0, -2.0, 3.0))
    for size in ((1, 1), (32768, 8)):
        yield Row(f"picture of {size[0]} x {size[1]} of a wall in a white world", lambda: (wall(1.0, **perspective(1.0)), scenes.world(1.0)), 1, size=size)


def lenses():
    def glowing(edge, away, radius, focus):
        quad((edge, -50, -away), (100, 0, 0), (0, 100, 0), glow())
        data = camera(**perspective(1e-4))
        data.dof.use_dof = True
        assign(data.dof, focus_distance=focus, aperture_fstop=data.lens * 1e-3 / (2.0 * radius))

    for edge in (-0.6, 0.0, 0.3):
        yield Row(f"lens of a metre, focus at infinity, edge {g(edge)} m aside", lambda x=edge: glowing(x, 1.0, 1.0, 1e10), 16384, "Combined")
        yield Row(f"lens of a metre, focus at 4 m, edge {g(edge)} m aside at 2 m", lambda x=edge: glowing(x, 2.0, 1.0, 4.0), 16384, "Combined")
    for name, radius, focus in (("of 0", 1e-30, 1.0), ("in focus at 0", 1.0, 0.0)):
        for edge in (-0.01, 0.01):
            yield Row(f"lens {name}, edge {g(edge)} m aside", lambda x=edge, r=radius, f=focus: glowing(x, 1.0, r, f), 16, "Combined")


def vanishing():
    def build():
        ground(10.0)
        for i in range(4):
            quad((-1, 0.1 + 0.1 * i, -1), (2, 0, 0), (0, 0, 2), scenes.material("Film", "ShaderNodeBsdfTransparent", Color=(1e-10, 1e-10, 1e-10, 1.0)))
        point(1.0)
        look((0.99, -0.01, 0.0), 1e-6)

    yield Row("light through four films of 1e-10", build, 16)


MADE = (scales, coincident, thin, transforms, occlusion, stadium, balls, within, rectangles, spheres, suns, many, sizes, terminator,
        roughness, index, nested, bounces, maps, opacity, projections, lenses, vanishing)  # fmt: skip
