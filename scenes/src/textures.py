"""Small tileable textures made with numpy: noise with a power-law spectrum, shaped into wood, plaster, linen and skins.

A texture is an array (height, width, 3) of display-referred values in 0..1, row 0 at the bottom as Blender stores it.
"""
import pathlib

import bpy
import numpy as np


def noise(shape, beta=2.0, stretch=(1.0, 1.0), seed=0, low=1.0):
    """Periodic Gaussian noise with power spectrum f**-beta, zero mean, unit variance.

    `stretch` = (along u, along v): a value above 1 draws the features out along that axis.
    `low` removes frequencies below that many cycles per tile.
    """
    h, w = shape
    rng = np.random.default_rng(seed)
    fv = np.fft.fftfreq(h)[:, None] * h * stretch[1]
    fu = np.fft.fftfreq(w)[None, :] * w * stretch[0]
    f = np.hypot(fu, fv)
    gain = np.where(f >= low, np.maximum(f, 1e-6) ** (-beta / 2.0), 0.0)
    field = np.fft.ifft2(np.fft.fft2(rng.standard_normal(shape)) * gain).real
    return (field - field.mean()) / field.std()


def step(low, high, x):
    """Hermite ramp from 0 at `low` to 1 at `high`."""
    t = np.clip((x - low) / (high - low), 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)


def ramp(t, *stops):
    """Piecewise linear colours: `stops` are (position, (r, g, b)), positions ascending."""
    at = [s[0] for s in stops]
    return np.stack([np.interp(t, at, [s[1][c] for s in stops]) for c in range(3)], axis=-1)


def normal_map(height, strength):
    """Tangent-space normals (OpenGL convention, +v up) of a periodic height field in texels."""
    du = (np.roll(height, -1, 1) - np.roll(height, 1, 1)) * 0.5 * strength
    dv = (np.roll(height, -1, 0) - np.roll(height, 1, 0)) * 0.5 * strength
    n = np.stack([-du, -dv, np.ones_like(height)], axis=-1)
    return n / np.linalg.norm(n, axis=-1, keepdims=True) * 0.5 + 0.5


def save(folder, name, pixels, quality=88):
    """Writes `name`.jpg into `folder` and returns it as a Blender image (colour space chosen by the material)."""
    h, w, _ = pixels.shape
    rgba = np.ones((h, w, 4), np.float32)
    rgba[..., :3] = np.clip(pixels, 0.0, 1.0)
    image = bpy.data.images.new(name, w, h)
    image.pixels.foreach_set(rgba.ravel())
    path = pathlib.Path(folder) / f"{name}.jpg"
    image.file_format = "JPEG"
    image.filepath_raw = str(path)
    image.save(quality=quality)
    bpy.data.images.remove(image)
    image = bpy.data.images.load(str(path))
    image.name = name
    return image


def wood(shape, seed, dark, mid, light):
    """Boards' grain along u: (colour, height)."""
    wide = noise(shape, 2.6, (14.0, 1.0), seed, 1.0)
    v = np.linspace(0.0, 1.0, shape[0], endpoint=False)[:, None]
    rings = 0.5 + 0.5 * np.sin(2.0 * np.pi * (7.0 * v) + 3.4 * wide)
    fine = noise(shape, 0.9, (60.0, 1.0), seed + 1, 3.0)
    pores = step(1.2, 2.2, noise(shape, 0.2, (36.0, 1.0), seed + 2, 20.0))
    tone = np.clip(0.45 + 0.22 * (rings - 0.5) + 0.12 * wide + 0.07 * fine, 0.0, 1.0)
    color = ramp(tone, (0.0, dark), (0.5, mid), (1.0, light)) * (1.0 - 0.25 * pores[..., None])
    return color, 0.25 * rings + 0.12 * fine - 0.6 * pores


def planks(shape, seed, rows, dark, mid, light):
    """A plank floor, boards along u, `rows` boards a tile, each cut out of its own stretch of grain."""
    h, w = shape
    rng = np.random.default_rng(seed)
    color = np.zeros((h, w, 3))
    height = np.zeros((h, w))
    each = h // rows
    for row in range(rows):
        grain, bumps = wood((each * 2, w), seed + 10 * row + 1, dark, mid, light)
        joint = int(rng.integers(w))
        tint = np.ones((w, 1))
        tint[:joint] = rng.uniform(0.86, 1.08)
        tint[joint:] = rng.uniform(0.86, 1.08)
        rows_at = slice(row * each, row * each + each)
        edge = np.minimum(np.arange(each), each - 1 - np.arange(each))[:, None]
        along = np.abs((np.arange(w)[None, :] - joint + w // 2) % w - w // 2)
        seam = np.minimum(step(-0.5, 1.6, edge), step(-0.5, 1.6, along) * np.ones((each, 1)))
        color[rows_at] = grain[:each] * tint[None] * (0.35 + 0.65 * seam[..., None])
        height[rows_at] = 0.5 * bumps[:each] + 3.0 * seam
    return color, height


def linen(shape, seed, threads, color, contrast=0.1):
    """A plain weave of `threads` threads per tile each way: (colour, height)."""
    h, w = shape
    v, u = np.mgrid[0:h, 0:w] / np.array([h, w]).reshape(2, 1, 1)
    slub_u = noise(shape, 1.2, (30.0, 1.0), seed)
    slub_v = noise(shape, 1.2, (1.0, 30.0), seed + 1)
    a = np.abs(np.sin(np.pi * threads * u)) * (0.5 + 0.5 * np.sign(np.sin(np.pi * threads * u) * np.sin(np.pi * threads * v)))
    b = np.abs(np.sin(np.pi * threads * v)) * (0.5 - 0.5 * np.sign(np.sin(np.pi * threads * u) * np.sin(np.pi * threads * v)))
    height = np.maximum(a, b) + 0.25 * (slub_u + slub_v) * 0.5
    tone = 1.0 + contrast * (height - 0.8) + 0.05 * (slub_u + slub_v) * 0.5
    return np.asarray(color)[None, None] * tone[..., None], height
