"""The cases, in a neutral description that both renderers are given.

World and objects are Blender's: metres, z up, a lamp or camera looks along its local −z. Light is given as Blender
does: a lamp's power in watts (the sun's strength in W/m²), an emitter's radiance. Everything is diffuse, facetted and
lit directly; emissive meshes and the lamps stand outside the picture.
"""

import hashlib
import pickle
from dataclasses import dataclass, field

import numpy as np

import shapes

SIZE = 128
"""Pixels along each side of the picture."""


@dataclass
class Object:
    mesh: tuple
    matrix: np.ndarray = field(default_factory=lambda: np.eye(4))
    color: tuple = (0.8, 0.8, 0.8)
    emission: float = 0.0
    """Radiance of both sides; 0 for a surface that only reflects."""


@dataclass
class Lamp:
    kind: str
    """point, spot, sun, rect or disk."""
    power: float
    """Watts; for the sun W/m² on a surface that faces it."""
    matrix: np.ndarray = field(default_factory=lambda: np.eye(4))
    color: tuple = (1.0, 1.0, 1.0)
    radius: float = 0.0
    soft: bool = False
    """Blender's soft falloff: the lamp is a disk that faces each shaded point, not a sphere."""
    size: tuple = (1.0, 1.0)
    """Of rect and disk, along local x and y."""
    spread: float = np.pi
    """Full angle of the cone that each point of rect and disk shines into, radians."""
    angle: float = 0.0
    """Full angle of the sun's disk or the spot's cone, radians."""
    blend: float = 0.0
    """Share of the spot's cone over which it fades."""


@dataclass
class Case:
    name: str
    objects: list
    lamps: list
    eye: tuple = (0.0, -5.0, 6.0)
    at: tuple = (0.0, 0.0, 0.3)
    fov: float = 40.0
    """Full angle of the square picture, degrees."""
    world: tuple = None
    """Radiance of the surroundings; none is black."""
    image: np.ndarray = None
    """Lat-long picture of the surroundings, rows from the top, that `world` is the factor of. As Blender maps it:
    the centre is +x, a quarter to the left is +y."""

    def digest(self):
        """Changes with anything that is rendered."""
        return hashlib.sha1(pickle.dumps((SIZE, self), protocol=4)).hexdigest()[:8]


def at(*position):
    matrix = np.eye(4)
    matrix[:3, 3] = position
    return matrix


def look(eye, target):
    """From `eye`, −z to `target`, y as near to world z as can be."""
    back = np.subtract(eye, target).astype(float)
    back /= np.linalg.norm(back)
    right = np.cross((0, 0, 1), back) if abs(back[2]) < 0.9999 else np.array([1.0, 0, 0])
    right /= np.linalg.norm(right)
    matrix = at(*eye)
    matrix[:3, :3] = np.stack([right, np.cross(back, right), back], axis=1)
    return matrix


def stage():
    """A floor with a ball, a block, a thin pole and a table: sharp contacts, wide and narrow penumbrae."""
    return [
        Object(shapes.floor(12)),
        Object(shapes.ball(24, 0.7, (-1.0, 0.3, 0.7))),
        Object(shapes.box((1.2, 0.8, 0.5), (0.45, 0.45, 0.5), 0.5)),
        Object(shapes.box((0.2, -1.2, 0.9), (0.05, 0.05, 0.9), 0.3)),
        Object(shapes.box((-0.2, 1.9, 0.9), (0.9, 0.3, 0.04))),
    ]


HIGH = (1.6, -1.2, 3.6)
ASLANT = look(HIGH, (0, 0, 0.3))


def lit(name, *lamps, **rest):
    return Case(name, stage(), list(lamps), **rest)


def glowing(name, mesh, emission):
    return Case(name, stage() + [Object(mesh, look((1.6, -1.2, 4.5), (0, 0, 0.3)), (0, 0, 0), emission)], [])


def s1():
    """Area light over a ball."""
    objects = [Object(shapes.floor(10)), Object(shapes.ball(60), at(0, 0, 1))]
    lamp = Lamp("rect", 12 * np.pi * 1.5**2, at(1.5, -1.0, 4.5), size=(1.5, 1.5))
    return Case("S1", objects, [lamp], (0, -7, 2.6), (0, 0, 0.8), 40)


def s3():
    """A million triangles in a hundred instances under a dome and a small, bright sphere."""
    rock = shapes.ball(29, roughness=lambda d: 0.8 + 0.35 * shapes.fbm(d * 3.0, 4))
    colors = [(0.7, 0.3, 0.2), (0.2, 0.6, 0.3), (0.6, 0.6, 0.65)]
    objects = [Object(shapes.floor(20), color=(0.5, 0.5, 0.5))]
    rng = np.random.default_rng(3)
    for y, x in np.ndindex(10, 10):
        w, i, j, k = (q := rng.normal(size=4)) / np.linalg.norm(q)
        turn = np.array([
            [1 - 2 * (j * j + k * k), 2 * (i * j - w * k), 2 * (i * k + w * j)],
            [2 * (i * j + w * k), 1 - 2 * (i * i + k * k), 2 * (j * k - w * i)],
            [2 * (i * k - w * j), 2 * (j * k + w * i), 1 - 2 * (i * i + j * j)],
        ])
        scale = rng.uniform(0.4, 0.6)
        place = at(x - 4.5 + rng.uniform(-0.15, 0.15), y - 4.5 + rng.uniform(-0.15, 0.15), 0.8 * scale)
        place[:3, :3] = turn * scale
        objects.append(Object(rock, place, colors[rng.integers(3)]))
    power = 250 * 4 * np.pi**2 * 0.2**2
    lamp = Lamp("point", power, at(3, -3, 6), color=(1.0, 0.96, 0.88), radius=0.2)
    return Case("S3", objects, [lamp], (0, -10.5, 6.5), (0, -0.6, 0), 45, world=(0.4, 0.45, 0.5))


def s4():
    """One mesh of a million triangles under a white dome."""
    rock = shapes.ball(289, roughness=lambda d: 1 + 0.18 * shapes.fbm(d * 4.0, 6))
    objects = [Object(shapes.floor(20, -0.9)), Object(rock)]
    return Case("S4", objects, [], (0, -4.2, 1.6), (0, 0, 0), 40, world=(1, 1, 1))


def many():
    """200 small lamps of very different power; some stand inside things."""
    rng = np.random.default_rng(7)
    places = rng.uniform((-4, -4, 0.5), (4, 4, 3.0), size=(200, 3))
    powers = 6 * rng.lognormal(0, 0.8, 200)
    return lit("many", *(Lamp("point", w, at(*p), radius=0.03, soft=True) for p, w in zip(places, powers)))


def sky():
    """A sky that grows darker upwards and a sun of 3° across in it, 0.7° per texel."""
    v, u = np.meshgrid((np.arange(256) + 0.5) / 256, (np.arange(512) + 0.5) / 512, indexing="ij")
    up, around = (0.5 - v) * np.pi, (0.5 - u) * 2 * np.pi
    d = np.stack([np.cos(up) * np.cos(around), np.cos(up) * np.sin(around), np.sin(up)], -1)
    picture = np.clip(1 - d[..., 2:], 0, 1) * (0.2, 0.25, 0.35) + (0.05, 0.05, 0.05)
    sun = np.array([0.5, -0.6, 0.8]) / np.linalg.norm([0.5, -0.6, 0.8])
    off = np.degrees(np.arccos(np.clip(d @ sun, -1, 1)))
    return (picture + np.clip(2 - off, 0, 1)[..., None] * (600, 560, 480)).astype(np.float32)


CASES = {
    "S1": s1,
    "S3": s3,
    "S4": s4,
    "point": lambda: lit("point", Lamp("point", 600, at(*HIGH))),
    "point_soft": lambda: lit("point_soft", Lamp("point", 600, at(*HIGH), radius=0.3, soft=True)),
    "sphere": lambda: lit("sphere", Lamp("point", 600, at(*HIGH), radius=0.3)),
    "spot": lambda: lit("spot", Lamp("spot", 900, ASLANT, radius=0.15, soft=True, angle=np.radians(50), blend=0.4)),
    "sun_small": lambda: lit("sun_small", Lamp("sun", 3, ASLANT, angle=np.radians(0.5))),
    "sun_wide": lambda: lit("sun_wide", Lamp("sun", 3, ASLANT, angle=np.radians(20))),
    "square": lambda: lit("square", Lamp("rect", 150, ASLANT)),
    "near_floor": lambda: lit("near_floor", Lamp("rect", 20, at(0.6, -0.6, 0.05))),
    "spread": lambda: lit("spread", Lamp("rect", 100, ASLANT, size=(1.5, 1.0), spread=np.radians(60))),
    "disk": lambda: lit("disk", Lamp("disk", 150, ASLANT)),
    "ellipse": lambda: lit("ellipse", Lamp("disk", 150, ASLANT, size=(2.0, 0.6))),
    "mesh_quad": lambda: glowing("mesh_quad", shapes.floor(0.5), 60.0),
    "mesh_ball": lambda: glowing("mesh_ball", shapes.ball(6, 0.35), 120.0),
    "dome": lambda: lit("dome", world=(0.6, 0.8, 1.0)),
    "dome_sun": lambda: lit("dome_sun", world=(1, 1, 1), image=sky()),
    "many": many,
    "area_dome": lambda: lit("area_dome", Lamp("rect", 100, ASLANT), world=(0.3, 0.3, 0.3)),
}
