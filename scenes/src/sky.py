"""Small latitude-longitude skies in Radiance RGBE, without a sun disk (the sun is a lamp).

Layout: top row = up, image centre = +x (glTF and Blender alike), u = 0.5 - atan2(y, x)/2pi in Blender's axes.
"""
import pathlib

import numpy as np

from . import textures as tx


def write_hdr(path, rgb):
    """Writes (height, width, 3) linear radiance, row 0 = top, as run-length encoded Radiance RGBE."""
    h, w, _ = rgb.shape
    top = np.maximum(rgb.max(axis=-1), 1e-32)
    mantissa, exponent = np.frexp(top)
    rgbe = np.empty((h, w, 4), np.uint8)
    rgbe[..., :3] = np.clip(rgb * (mantissa * 256.0 / top)[..., None], 0, 255).astype(np.uint8)
    rgbe[..., 3] = exponent + 128
    out = bytearray(f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {h} +X {w}\n".encode())
    for row in rgbe:
        out += bytes((2, 2, w >> 8, w & 255))
        for channel in range(4):
            out += packed(row[:, channel])
    pathlib.Path(path).write_bytes(out)


def packed(values):
    """One channel of a scanline: runs (count + 128, value) where they pay, literals (count, bytes...) elsewhere."""
    out, literal, i = bytearray(), bytearray(), 0

    def flush():
        for k in range(0, len(literal), 128):
            part = literal[k:k + 128]
            out.extend(bytes((len(part),)) + part)
        literal.clear()

    while i < len(values):
        run = 1
        while i + run < len(values) and run < 127 and values[i + run] == values[i]:
            run += 1
        if run >= 4:
            flush()
            out.extend((run + 128, int(values[i])))
        else:
            literal.extend(values[i:i + run].tobytes())
        i += run
    flush()
    return out


def directions(h, w):
    """Unit directions (Blender's axes) of the texel centres, row 0 = top."""
    theta = np.pi * (np.arange(h) + 0.5)[:, None] / h
    phi = 2 * np.pi * (0.5 - (np.arange(w) + 0.5)[None, :] / w)
    return np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta) + 0 * phi], axis=-1)


def sky(path, toward_sun, zenith, horizon, glow, ground, scale, haze=0.16, clouds=0.0, lit=(1.0, 1.0, 1.0),
        h=128, seed=1):
    """A clear sky: a gradient, haze at the horizon, a broad glow about the sun's place and thin cirrus."""
    d = directions(h, 2 * h)
    sun = np.asarray(toward_sun, float) / np.linalg.norm(toward_sun)
    cosine = np.clip(d @ sun, -1, 1)
    up = np.clip(d[..., 2], 0, 1)
    low = np.exp(-up / haze)[..., None]
    color = np.asarray(zenith) * (1 - low) + np.asarray(horizon) * low
    # The horizon is warm and bright under the sun, cooler and dimmer opposite it.
    flat = d[..., :2] @ (sun[:2] / np.linalg.norm(sun[:2]))
    near = ((0.5 + 0.5 * flat) ** 2 * np.exp(-up / (1.6 * haze)))[..., None]
    color = color * (1 - 0.55 * near) + np.asarray(glow) * near * 0.9
    color = color + np.asarray(glow) * (0.5 * np.maximum(cosine, 0) ** 10 + 0.5 * np.maximum(cosine, 0) ** 60)[..., None]
    if clouds:
        veil = tx.step(0.2, 2.0, tx.noise((h, 2 * h), 2.9, (2.5, 0.8), seed, 2.0)) * tx.step(0.03, 0.22, up)
        veil = veil * (1 - tx.step(0.75, 0.95, up)) * clouds
        bright = np.asarray(lit) * (0.75 + 0.6 * (0.5 + 0.5 * cosine[..., None]) ** 2)
        color = color * (1 - veil[..., None]) + bright * veil[..., None]
    below = np.clip(-d[..., 2:] / 0.05, 0, 1)
    color = color * (1 - below) + np.asarray(ground) * below
    write_hdr(path, color * scale)
