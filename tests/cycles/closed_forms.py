"""Where a closed form, or an integral in double precision, says what is right: it, Cycles and Penumbra side by side.

    python closed_forms.py FOLDER --wheel FILE [--only NAME,NAME] [--engines PENUMBRA]

writes tables.json into FOLDER: for each case what was measured, and rows of the argument, the value that is right and
those of both engines. `validate.py` calls it and puts the tables into its document, `test_cycles.py` for Penumbra alone.
"""

import argparse
import json
import math
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parents[1] / folder) for folder in ("tests/addon", "benches/cycles")]

import bpy  # isort: skip (what follows is found through it)
import numpy as np

import addon
import lab
import scenes

ENGINES = ["CYCLES", "PENUMBRA"]


def measure(passes, samples):
    """Means of the passes over the picture, by engine: numbers."""
    scene, layer = bpy.context.scene, bpy.context.scene.view_layers[0]
    for name in passes:
        setattr(layer, f"use_pass_{name.lower().replace(' ', '_')}", True)
    scene.cycles.samples = scene.penumbra.spp = samples
    scene.penumbra.max_bounces = 4
    for obj in bpy.data.objects:
        obj.shadow_terminator_geometry_offset = obj.shadow_terminator_shading_offset = 0.0
    found = {}
    for engine in ENGINES:
        scene.render.engine = engine
        channels = lab.render()
        found[engine] = [np.mean([channels[f"ViewLayer.{name}.{c}"].astype(float).mean() for c in "RGB"]) for name in passes]
    return found


def stand(samples, material=None, size=100.0, camera=(0.0, 0.0), height=10.0, width=1e-3, turn=0.0):
    """A floor, and a camera so narrow that the picture is one point of it."""
    lab.reset((4, 4), samples, threads=2)
    scenes.world(0.0)
    # The camera looks into a triangle, not at the edge between two: Cycles' rays into glass meet the neighbour there.
    left, right, front, back = (share * size for share in (-0.37, 0.63, -0.55, 0.45))
    lab.mesh("Floor", [(left, front, 0), (right, front, 0), (right, back, 0), (left, back, 0)], [(0, 1, 2, 3)],
             material() if material else scenes.material("Floor", "ShaderNodeBsdfDiffuse", Color=(1.0, 1.0, 1.0, 1.0)))
    seen = lab.orthographic_camera((camera[0], camera[1] - height * math.sin(turn), height * math.cos(turn)), width)
    seen.rotation_euler = (turn, 0.0, 0.0)
    seen.data.clip_start = 1e-4


def polygon(corners, point):
    """Lambert's form factor of a polygon above a point whose normal is +z."""
    rays = np.asarray(corners, np.float64) - np.asarray(point, np.float64)
    rays /= np.linalg.norm(rays, axis=1)[:, None]
    total = 0.0
    for a, b in zip(rays, np.roll(rays, -1, axis=0)):
        across = np.cross(a, b)
        sine = np.linalg.norm(across)
        total += math.atan2(sine, a @ b) * across[2] / sine
    return abs(total) / (2.0 * math.pi)


def rectangle():
    """A lamp of 1 m × 1 m just above the floor."""
    rows, x, y, power = [], 0.1237, 0.0412, 10.0
    corners = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)]
    for gap in (1.0, 0.1, 1e-2, 1e-3, 1e-4):
        stand(1, camera=(x, y), width=1e-6)
        scenes.lamp("AREA", (0.0, 0.0, gap), energy=power, size=1.0)
        truth = power / math.pi * polygon([(*corner, gap) for corner in corners], (x, y, 0.0))
        found = measure(["Diffuse Direct"], 1024)
        rows.append([f"{gap:g} m", truth, *(found[engine][0] for engine in ENGINES)])
    return ("Below a rectangle, close to it", "height of the lamp", "Diffuse Direct of a white floor below a square area lamp of 1 m and 10 W, off its middle; "
            "right is Lambert's form factor of a polygon. Cycles falls back to the density of a plane where the lamp covers nearly the half sphere.", rows)


def coincident():
    """Two faces, one just above the other."""
    rows, tilt = [], 0.5
    for gap in (0.0, 1e-7, 1e-5, 1e-3):
        stand(1, size=2.0)
        lab.mesh("Cover", [(-0.7, -0.7, gap), (1.3, -0.7, gap), (1.3, 1.3, gap), (-0.7, 1.3, gap)], [(0, 1, 2, 3)], bpy.data.materials["Floor"])
        scenes.lamp("SUN", rotation=(tilt, 0.0, 0.0), energy=math.pi, angle=0.0)
        found = measure(["Diffuse Direct"], 16)
        rows.append([f"{gap:g} m", math.cos(tilt), *(found[engine][0] for engine in ENGINES)])
    return ("Two faces in one place", "gap", "Diffuse Direct of the upper of two white faces under a sun; right is cos θ. "
            "Cycles leaves out the face a ray begins on, and meets the other.", rows)


def point(soft):
    rows, radius, power = [], 0.4, 100.0
    for distance in (0.5, 1.0, 2.0, 4.0):
        stand(1)
        scenes.lamp("POINT", (0.0, 0.0, distance), energy=power, shadow_soft_size=radius, use_soft_falloff=soft)
        truth = power / (4.0 * math.pi**2 * (distance**2 + (radius**2 if soft else 0.0)))
        found = measure(["Diffuse Direct"], 1024)
        rows.append([f"{distance:g} m", truth, *(found[engine][0] for engine in ENGINES)])
    what = "which turns a disk to each point: P / (4 π² (d² + r²))" if soft else "a sphere: P / (4 π² d²)"
    return (f"Point lamp {'with' if soft else 'without'} soft falloff", "distance", f"Diffuse Direct of a white floor below a point lamp of 100 W and radius 0.4 m, {what}.", rows)


def wall():
    """Ambient occlusion beside a wall."""
    rows, height = [], 1.0
    for size, away in ((20.0, 1e-5), (20.0, 1e-3), (20.0, 0.1), (20.0, 1.0), (2000.0, 1e-3), (2000.0, 1e-4)):
        stand(1, size=size, camera=(0.0, -away), height=3.0, width=0.1 * away)
        bpy.context.scene.world.light_settings.distance = 1e5
        low, high = -0.37 * size, 0.63 * size
        corners = [(low, 0, 0), (high, 0, 0), (high, 0, height), (low, 0, height)]
        lab.mesh("Wall", corners, [(0, 1, 2, 3)], bpy.data.materials["Floor"])
        truth = 1.0 - polygon(corners, (0.0, -away, 0.0))
        found = measure(["Ambient Occlusion"], 16384)
        rows.append([f"{away:g} m, faces of {size:g} m", truth, *(found[engine][0] for engine in ENGINES)])
    return ("Ambient occlusion beside a wall", "distance", "A wall of 1 m, no limit of distance; right is one less the wall's form factor, one half at its foot.", rows)


def scattered(cos, alpha, ior, steps=512):
    """What GGX microfacets of a dielectric reflect and refract of a view at `cos`, and what they would reflect if they were white.

    Over visible normals (Heitz 2018), by the midpoint rule: of each the share that Smith's masking lets out.
    """
    view = np.array([math.sqrt(max(0.0, 1.0 - cos * cos)), 0.0, cos])
    u = (np.arange(steps) + 0.5) / steps
    u1, u2 = np.meshgrid(u, u)
    stretched = view * [alpha, alpha, 1.0]
    stretched /= np.linalg.norm(stretched)
    first = np.array([0.0, 1.0, 0.0])
    second = np.cross(stretched, first)
    r, phi = np.sqrt(u1), 2.0 * math.pi * u2
    a, b = r * np.cos(phi), r * np.sin(phi)
    s = 0.5 * (1.0 + stretched[2])
    b = (1.0 - s) * np.sqrt(np.maximum(0.0, 1.0 - a * a)) + s * b
    c = np.sqrt(np.maximum(0.0, 1.0 - a * a - b * b))
    h = a[..., None] * first + b[..., None] * second + c[..., None] * stretched
    h *= [alpha, alpha, 1.0]
    h /= np.linalg.norm(h, axis=-1, keepdims=True)
    towards = h @ view
    cos_t = np.sqrt(1.0 - (1.0 - towards**2) / ior**2)
    fresnel = 0.5 * (((towards - ior * cos_t) / (towards + ior * cos_t)) ** 2 + ((ior * towards - cos_t) / (ior * towards + cos_t)) ** 2)

    def hidden(z):
        z = np.maximum(z, 1e-12)
        return 0.5 * (np.sqrt(1.0 + alpha**2 * (1.0 - z * z) / (z * z)) - 1.0)

    def leaves(z):
        return np.where(z > 0.0, (1.0 + hidden(cos)) / (1.0 + hidden(cos) + hidden(z)), 0.0)

    up = leaves(2.0 * towards * h[..., 2] - view[2])
    down = leaves(view[2] / ior - (towards / ior - cos_t) * h[..., 2])
    return (fresnel * up).mean(), ((1.0 - fresnel) * down).mean(), up.mean()


def plastic_albedo(cos, roughness, ior):
    """With what scatters more than once, by the formula of Blender's Principled BSDF (Turquin; Kulla and Conty's mean)."""
    alpha = roughness**2
    single, _, white = scattered(cos, alpha, ior)
    nodes, weights = np.polynomial.legendre.leggauss(16)
    mu = 0.5 * (nodes + 1.0)
    mean = sum(w * m * scattered(m, alpha, ior, 128)[2] for m, w in zip(mu, weights))
    fresnel = (ior - 1.0) / (4.08567 + 1.00071 * ior)
    several = fresnel * mean / (1.0 - fresnel * (1.0 - mean))
    return single * (1.0 + several * (1.0 - white) / white)


def glass_albedo(cos, roughness, ior):
    """What is refracted: what scatters more than once leaves in the same proportion, so that nothing is lost."""
    reflects, refracts, _ = scattered(cos, roughness**2, ior)
    return refracts / (reflects + refracts)


def colors(name, kind, what, truth, **inputs):
    """Color, and color times direct light in a white world, of a rough surface."""
    color, light = [], []
    for roughness in (0.2, 0.5, 1.0):
        for degrees in (0, 45, 60, 75):
            turn = math.radians(degrees)
            stand(1, lambda: scenes.material(name, Roughness=roughness, IOR=1.5, **inputs), turn=turn)
            scenes.world(1.0)
            right = truth(math.cos(turn), roughness, 1.5)
            found = measure([f"{kind} Color", f"{kind} Direct"], 16384)
            at = f"{roughness:g}, {degrees}°"
            color.append([at, right, *(found[engine][0] for engine in ENGINES)])
            light.append([at, right, *(found[engine][0] * found[engine][1] for engine in ENGINES)])
    return [(f"Color of {name.lower()}", "roughness, angle", f"{kind} Color of {what}; right is the integral over GGX' visible normals, with Blender's law for what scatters "
             "more than once. Cycles writes an estimate, and divides the light by it.", color),
            (f"Light of {name.lower()}", "roughness, angle", f"{kind} Color × {kind} Direct of the same in a world of radiance 1: the light itself.", light)]


def plastic():
    return colors("Plastic", "Glossy", "black plastic of index 1.5: the share of light that it reflects to the camera", plastic_albedo, Base_Color=(0.0, 0.0, 0.0, 1.0))


def glass():
    return colors("Glass", "Transmission", "the upper side of white glass of index 1.5: the share of light from below that it lets through to the camera", glass_albedo,
                  Base_Color=(1.0, 1.0, 1.0, 1.0), Transmission_Weight=1.0)


CASES = {"rectangle": rectangle, "coincident": coincident, "soft": lambda: point(True), "sphere": lambda: point(False), "wall": wall, "plastic": plastic, "glass": glass}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--wheel", required=True)
    parser.add_argument("--only", default=",".join(CASES))
    parser.add_argument("--engines", default=",".join(ENGINES))
    options = parser.parse_args()
    ENGINES[:] = options.engines.split(",")
    bpy.ops.wm.read_factory_settings(use_empty=True)
    addon.register(options.wheel)
    tables = []
    for name in options.only.split(","):
        made = CASES[name]()
        tables += made if isinstance(made, list) else [made]
    options.folder.mkdir(parents=True, exist_ok=True)
    keys = ("title", "argument", "what", "rows")
    (options.folder / "tables.json").write_text(json.dumps([dict(zip(keys, table)) for table in tables], indent=1))


if __name__ == "__main__":
    main()
