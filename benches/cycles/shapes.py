"""Triangle meshes of the cases: (vertices N×3 float32, triangles M×3 int32), metres, z up, facets without normals."""

import numpy as np


def quad(corners):
    return np.array(corners, np.float32), np.array([[0, 1, 2], [0, 2, 3]], np.int32)


def floor(half, z=0.0):
    """A square about the origin that faces up."""
    return quad([(-half, -half, z), (half, -half, z), (half, half, z), (-half, half, z)])


def merge(meshes):
    vertices, triangles, first = [], [], 0
    for v, t in meshes:
        vertices.append(v)
        triangles.append(t + first)
        first += len(v)
    return np.concatenate(vertices).astype(np.float32), np.concatenate(triangles).astype(np.int32)


def box(center, half, turn=0.0):
    """`half` extents, turned about z by `turn` radians."""
    c, s = np.cos(turn), np.sin(turn)
    frame = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) * np.array(half, float)
    faces = []
    for axis in range(3):
        for sign in (-1.0, 1.0):
            u, v = np.eye(3)[(axis + 1) % 3], np.eye(3)[(axis + 2) % 3] * sign
            out = np.eye(3)[axis] * sign
            corners = [out - u - v, out + u - v, out + u + v, out - u + v]
            faces.append(quad([center + frame @ corner for corner in corners]))
    return merge(faces)


def ball(n, radius=1.0, center=(0, 0, 0), roughness=None):
    """A sphere of 12 n² triangles: a cube's grid, normalized. `roughness` maps directions to radii."""
    grid = np.linspace(-1, 1, n + 1)
    a, b = (g.reshape(-1, 1) for g in np.meshgrid(grid, grid, indexing="xy"))
    j, i = np.meshgrid(np.arange(n), np.arange(n), indexing="ij")
    k, row = j * (n + 1) + i, n + 1
    halves = (k, k + 1, k + row + 1), (k, k + row + 1, k + row)
    cells = np.concatenate([np.stack(half, -1).reshape(-1, 3) for half in halves])
    sides = []
    for u, v in (((1, 0, 0), (0, 1, 0)), ((0, 1, 0), (0, 0, 1)), ((0, 0, 1), (1, 0, 0))):
        for sign in (1.0, -1.0):
            d = a * np.array(u, float) + sign * b * np.array(v, float) + sign * np.cross(u, v)
            sides.append((d / np.linalg.norm(d, axis=1, keepdims=True), cells))
    directions = np.concatenate([d for d, _ in sides])
    triangles = np.concatenate([t + s * (n + 1) ** 2 for s, (_, t) in enumerate(sides)]).astype(np.int32)
    if roughness is not None:
        directions = directions * roughness(directions)[:, None]
    return (directions * radius + np.array(center, float)).astype(np.float32), triangles


def fbm(p, octaves):
    """Fractal value noise on a hashed lattice, about −1 to 1."""
    return sum(0.5 ** (octave + 1) * noise(p * 2.03**octave) for octave in range(octaves))


def noise(p):
    """Value noise, −1 to 1, trilinear in smoothstep."""
    cell = np.floor(p).astype(np.int64)
    f = p - cell
    w = f * f * (3 - 2 * f)
    total = np.zeros(len(p))
    for corner in np.ndindex(2, 2, 2):
        weight = np.prod(np.where(corner, w, 1 - w), axis=1)
        total += weight * hashed(*(cell + corner).T)
    return total * 2 - 1


def hashed(x, y, z):
    """0 to 1 from three integers."""
    mixed = (x * 0x8DA6B343) ^ (y * 0xD8163841) ^ (z * 0xCB1AB31F)
    h = (mixed & 0xFFFFFFFF).astype(np.uint32)
    h ^= h >> np.uint32(13)
    h *= np.uint32(0x5BD1E995)
    h ^= h >> np.uint32(15)
    return (h & np.uint32(0xFFFFFF)) / 16777216.0
