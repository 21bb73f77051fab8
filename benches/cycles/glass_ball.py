"""A ball of rough glass in Cycles, by light samples and by rays alone, beside a random walk in f64.

    target/test-venv/bin/python benches/cycles/glass_ball.py [--wheel FILE] [--paths N]

The ball has radius 0.46, index 1.5, GGX microfacets of roughness 1 that lose nothing (Cycles' compensation by tables, here
by the walk's own), and is seen from above. It is lit by a disk of radius 1 at (-2, -2.5, 4) that shines at it, or by a
white world, where a white ball is 1. `--wheel` adds Penumbra.
"""

import argparse
import math
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

import bpy
import numpy as np

import addon
import lab

RADIUS, IOR, ALPHA = 0.46, 1.5, 1.0
LAMP, POWER = np.array((-2.0, -2.5, 4.0)), 250.0
PIXELS, BOUNCES, BATCH = 12, 12, 200_000
COSINES = (np.arange(64) + 0.5) / 64


def visible_normals(wo, rng):
    """Microfacet normals that `wo` sees (Heitz 2018)."""
    u, v = rng.random((2, len(wo)))
    stretched = wo * (ALPHA, ALPHA, 1.0)
    stretched /= np.linalg.norm(stretched, axis=1, keepdims=True)
    across = np.stack([-stretched[:, 1], stretched[:, 0], np.zeros(len(wo))], -1)
    length = np.linalg.norm(across, axis=1, keepdims=True)
    across = np.where(length > 1e-9, across / np.maximum(length, 1e-9), (1.0, 0.0, 0.0))
    along = np.cross(stretched, across)
    r, phi, share = np.sqrt(u), 2.0 * math.pi * v, 0.5 * (1.0 + stretched[:, 2])
    x, y = r * np.cos(phi), r * np.sin(phi)
    y = (1.0 - share) * np.sqrt(np.maximum(1.0 - x * x, 0.0)) + share * y
    z = np.sqrt(np.maximum(1.0 - x * x - y * y, 0.0))
    h = x[:, None] * across + y[:, None] * along + z[:, None] * stretched
    h = np.stack([ALPHA * h[:, 0], ALPHA * h[:, 1], np.maximum(h[:, 2], 1e-9)], -1)
    return h / np.linalg.norm(h, axis=1, keepdims=True)


def smith(w):
    """Smith's Lambda."""
    square = np.maximum(w[:, 2] ** 2, 1e-18)
    return 0.5 * (np.sqrt(1.0 + ALPHA**2 * (1.0 - w[:, 2] ** 2) / square) - 1.0)


def fresnel(cos, eta):
    g = np.sqrt(np.maximum(eta**2 - 1.0 + cos**2, 0.0))
    a, b = (g - cos) / (g + cos), (cos * (g + cos) - 1.0) / (cos * (g - cos) + 1.0)
    return np.where(eta**2 - 1.0 + cos**2 <= 0.0, 1.0, 0.5 * a**2 * (1.0 + b**2))


def scatter(wo, eta, rng):
    """Directions, whether they are reflected, and what single scattering leaves of them."""
    h = visible_normals(wo, rng)
    cos = (wo * h).sum(1)
    reflected = rng.random(len(wo)) < fresnel(cos, eta)
    below = np.sqrt(np.maximum(1.0 - (1.0 - cos**2) / eta**2, 0.0))
    wi = np.where(reflected[:, None], 2.0 * cos[:, None] * h - wo, (cos / eta - below)[:, None] * h - wo / eta)
    seen = np.where(reflected, wi[:, 2] > 0.0, wi[:, 2] < 0.0)
    wi /= np.linalg.norm(wi, axis=1, keepdims=True)
    left = np.where(seen, (1.0 + smith(wo)) / (1.0 + smith(wo) + smith(wi)), 0.0)
    return wi, reflected, left


def kept(eta, rng):
    """What single scattering keeps by the cosine of view, and its mean."""
    views = [np.tile((math.sqrt(1.0 - mu * mu), 0.0, mu), (40_000, 1)) for mu in COSINES]
    table = np.array([scatter(wo, eta, rng)[2].mean() for wo in views])
    return table, 2.0 * (COSINES * table).mean()


def walk(base, paths, seed):
    """Means over the ball of what a white world and the lamp show, and their standard errors."""
    rng = np.random.default_rng(seed)
    tint, tables = math.sqrt(base), {False: kept(IOR, rng), True: kept(1.0 / IOR, rng)}
    axis, radiance = -LAMP / np.linalg.norm(LAMP), POWER / math.pi**2
    batches = []
    for _ in range(max(paths // BATCH, 2)):
        r, phi = np.sqrt(rng.random(BATCH)), 2.0 * math.pi * rng.random(BATCH)
        p = np.stack([r * np.cos(phi), r * np.sin(phi), np.sqrt(1.0 - r * r)], -1)
        d, beta, inside = np.tile((0.0, 0.0, -1.0), (BATCH, 1)), np.ones(BATCH), np.zeros(BATCH, bool)
        world = lamp = 0.0
        for _ in range(BOUNCES + 1):
            n = np.where(inside[:, None], -p, p)
            s = np.cross(np.where(np.abs(n[:, :1]) > 0.5, (0.0, 1.0, 0.0), (1.0, 0.0, 0.0)), n)
            s /= np.linalg.norm(s, axis=1, keepdims=True)
            t = np.cross(n, s)
            wo = -np.stack([(d * axis_).sum(1) for axis_ in (s, t, n)], -1)
            wi, reflected, factor = np.empty_like(wo), np.empty(len(wo), bool), np.empty(len(wo))
            for within in (False, True):
                here = inside == within
                if here.any():
                    wi[here], reflected[here], left = scatter(wo[here], 1.0 / IOR if within else IOR, rng)
                    table, mean = tables[within]
                    e = np.interp(wo[here, 2], COSINES, table)
                    factor[here] = left * (1.0 + tint * mean / (1.0 - tint * (1.0 - mean)) * (1.0 - e) / e)
            beta = beta * factor * np.where(reflected, 1.0, tint)
            d = wi[:, :1] * s + wi[:, 1:2] * t + wi[:, 2:] * n
            inside = inside ^ ~reflected
            out, on = ~inside & (beta > 0.0), inside & (beta > 0.0)
            world += beta[out].sum()
            towards = d[out] @ axis
            distance = ((LAMP - RADIUS * p[out]) @ axis) / np.where(towards == 0.0, 1.0, towards)
            met = RADIUS * p[out] + distance[:, None] * d[out] - LAMP
            lamp += radiance * beta[out][(towards < 0.0) & ((met**2).sum(1) < 1.0)].sum()
            p, d, beta, inside = p[on], d[on], beta[on], inside[on]
            if not len(p):
                break
            p = p - 2.0 * (p * d).sum(1)[:, None] * d
            p /= np.linalg.norm(p, axis=1, keepdims=True)
        batches.append((world / BATCH, lamp / BATCH))
    batches = np.array(batches)
    return batches.mean(0), batches.std(0, ddof=1) / math.sqrt(len(batches))


def material(kind, **inputs):
    result = bpy.data.materials.new(kind)
    tree = result.node_tree
    tree.nodes.clear()
    shader, output = tree.nodes.new(kind), tree.nodes.new("ShaderNodeOutputMaterial")
    for name, value in inputs.items():
        shader.inputs[name.replace("_", " ")].default_value = value
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    return result


def rendered(engine, base, light, samples):
    """The mean over the ball: lit by a "world", a "lamp", or a disk that is found by "rays" alone."""
    scene = lab.reset((PIXELS, PIXELS), samples, 2)
    scene.render.engine, scene.render.film_transparent = engine, True
    for name in ("max_bounces", "diffuse_bounces", "glossy_bounces", "transmission_bounces"):
        setattr(scene.cycles, name, BOUNCES)
    if engine == "PENUMBRA":
        scene.penumbra.spp, scene.penumbra.max_bounces = samples, BOUNCES
    scene.world = bpy.data.worlds.new("World")
    scene.world.use_nodes = True
    background = scene.world.node_tree.nodes["Background"]
    background.inputs[0].default_value = (1.0, 1.0, 1.0, 1.0)
    background.inputs[1].default_value = float(light == "world")
    if light == "lamp":
        lamp = lab.light("AREA", energy=POWER, shape="DISK", size=2.0)
    elif light == "rays":
        bpy.ops.mesh.primitive_circle_add(vertices=128, radius=1.0, fill_type="NGON")
        lamp = bpy.context.object
        lamp.data.materials.append(material("ShaderNodeEmission", Strength=POWER / math.pi**2))
        lamp.data.materials[0].cycles.emission_sampling = "NONE"
    if light != "world":
        lamp.location = LAMP
        lab.towards(lamp, LAMP)
        lamp.visible_camera = False
    bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, radius=RADIUS)
    ball = bpy.context.object
    ball.data.polygons.foreach_set("use_smooth", np.ones(len(ball.data.polygons), bool))
    ball.shadow_terminator_geometry_offset = 0.0
    ball.data.materials.append(material("ShaderNodeBsdfPrincipled", Base_Color=(base, base, base, 1.0), Roughness=1.0,
                                        IOR=IOR, Transmission_Weight=1.0))
    lab.orthographic_camera((0, 0, 20), 1)
    seen = lab.render()["ViewLayer.Combined.G"].astype(float).sum() / PIXELS**2
    return seen / (math.pi * RADIUS**2)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--wheel")
    parser.add_argument("--paths", type=int, default=4_000_000)
    options = parser.parse_args()
    engine = addon.register(options.wheel) if options.wheel else None
    try:
        for base in (1.0, 0.8):
            (world, lamp), (world_error, lamp_error) = walk(base, options.paths, 1)
            print(f"base {base}: walk in f64: world {world:.4f} ± {world_error:.4f}, lamp {lamp:.5f} ± {lamp_error:.5f}")
            for name in ("CYCLES", "PENUMBRA") if engine else ("CYCLES",):
                found = {light: rendered(name, base, light, samples)
                         for light, samples in (("world", 2048), ("lamp", 4096), ("rays", 16384))}
                print(f"  {name}: " + ", ".join(f"{light} {value:.5f}" for light, value in found.items()), flush=True)
    finally:
        if engine:
            engine.unregister()


if __name__ == "__main__":
    main()
