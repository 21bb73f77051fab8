"""A river of pinwheels through a meadow in the evening: some sixteen thousand instances of a handful of small meshes."""
import math

import numpy as np

from . import kit, sky, textures as tx

SUN = (-1.0, 0.18, 0.36)
EYE = np.array([0.0, -3.2, 0.0])


def height(x, y):
    """The ground: gentle swells that rise toward a ridge."""
    x, y = np.asarray(x, float), np.asarray(y, float)
    swell = 0.55 * np.sin(0.16 * x + 0.6) * np.cos(0.11 * y) + 0.25 * np.sin(0.31 * x - 0.23 * y + 1.0)
    ridge = 5.2 * tx.step(14, 78, y) + 2.2 * np.sin(0.045 * x + 0.9) * tx.step(25, 85, y)
    return swell * tx.step(-3, 10, y) + ridge - 3.0 * tx.step(80, 140, y)


def river(y):
    """Centre of the band of pinwheels at depth y."""
    return 1.6 + 5.5 * np.sin(y / 10.5 + 0.1) * tx.step(-4, 16, y) - 0.06 * y


def quaternions(yaw, spin=0.0, lean_x=0.0, lean_y=0.0):
    """wxyz of a turn `spin` about y, then the leans about x and y, then `yaw` about z (radians, arrays)."""
    n = len(yaw)

    def about(axis, angle):
        q = np.zeros((n, 4))
        q[:, 0] = np.cos(np.broadcast_to(angle, n) / 2)
        q[:, axis + 1] = np.sin(np.broadcast_to(angle, n) / 2)
        return q

    def times(a, b):
        w = a[:, 0] * b[:, 0] - np.sum(a[:, 1:] * b[:, 1:], axis=1)
        v = a[:, :1] * b[:, 1:] + b[:, :1] * a[:, 1:] + np.cross(a[:, 1:], b[:, 1:])
        return np.concatenate([w[:, None], v], axis=1)

    q = times(about(2, yaw), times(about(0, lean_x), times(about(1, lean_y), about(1, spin))))
    return q / np.linalg.norm(q, axis=1, keepdims=True)


def surfaces(folder):
    """Materials by name, with the ground's texture."""
    m = {}
    patch = np.clip(0.5 + 0.16 * tx.noise((512, 512), 2.0, seed=100) + 0.15 * tx.noise((512, 512), 0.7, seed=101, low=8), 0, 1)
    ground = tx.ramp(patch, (0, (0.27, 0.32, 0.10)), (0.5, (0.44, 0.49, 0.19)), (1, (0.60, 0.58, 0.30)))
    m["ground"] = kit.material("Ground", rough=1.0, image=tx.save(folder, "ground", ground, 84))
    for name, color in [("grass0", (0.13, 0.24, 0.035)), ("grass1", (0.22, 0.30, 0.05)), ("grass2", (0.40, 0.33, 0.11))]:
        m[name] = kit.material(name.replace("grass", "Grass "), color, 0.6)
    m["stem"] = kit.material("Flower stem", (0.10, 0.20, 0.04), 0.6)
    m["white"] = kit.material("White petal", (0.84, 0.83, 0.79), 0.7)
    m["yolk"] = kit.material("Yellow heart", (0.84, 0.48, 0.03), 0.8)
    m["poppy"] = kit.material("Poppy", (0.72, 0.055, 0.02), 0.6)
    m["dark"] = kit.material("Poppy heart", (0.025, 0.02, 0.025), 0.7)
    m["stone"] = kit.material("Stone", (0.36, 0.34, 0.31), 0.9)
    m["bark"] = kit.material("Bark", (0.14, 0.09, 0.06), 0.95)
    m["foliage"] = kit.material("Foliage", (0.13, 0.21, 0.04), 0.6)
    m["stick"] = kit.material("Stick", (0.74, 0.68, 0.58), 0.6)
    m["pin"] = kit.material("Brass pin", (0.88, 0.63, 0.28), 0.2, 1.0)
    for name, color in [("coral", (0.80, 0.125, 0.075)), ("saffron", (0.86, 0.42, 0.025)), ("paper", (0.82, 0.79, 0.72)),
                        ("teal", (0.02, 0.30, 0.33)), ("blue", (0.045, 0.12, 0.42)), ("rose", (0.78, 0.24, 0.30))]:
        m[name] = kit.material(name.capitalize(), color, 0.42)
    m["near hill"] = kit.material("Near hills", (0.17, 0.22, 0.17), 1.0)
    m["far hill"] = kit.material("Far hills", (0.26, 0.32, 0.38), 1.0)
    return m


def joined(name, parts):
    """One mesh with several materials out of (points, faces, material) triples, smooth shaded, without UVs."""
    points, faces, index, mats = [], [], [], []
    for p, f, made in parts:
        if made not in mats:
            mats.append(made)
        faces += [tuple(i + len(points) for i in face) for face in f]
        index += [mats.index(made)] * len(f)
        points += list(np.asarray(p, float))
    data = kit.mesh(name, points, faces, mats[0])
    for made in mats[1:]:
        data.materials.append(made)
    data.polygons.foreach_set("material_index", index)
    return data


def sheet(points):
    """(points, faces) of a grid points[v][u]."""
    points = np.asarray(points, float)
    rows, cols = points.shape[:2]
    faces = [(r * cols + c, r * cols + c + 1, (r + 1) * cols + c + 1, (r + 1) * cols + c)
             for r in range(rows - 1) for c in range(cols - 1)]
    return points.reshape(-1, 3), faces


def tuft(name, made, seed, blades=34, spread=0.15, tall=0.30):
    """A tuft of bent blades."""
    rng = np.random.default_rng(seed)
    parts = []
    for _ in range(blades):
        r, a, face = spread * math.sqrt(rng.uniform()), rng.uniform(0, 6.283), rng.uniform(0, 6.283)
        h, bend, w = tall * rng.uniform(0.5, 1.1), rng.uniform(0.15, 0.65), rng.uniform(0.0035, 0.0065)
        # The wind leans all blades a little to the right.
        out = np.array([0.6 * math.cos(a) + 0.35, 0.6 * math.sin(a) - 0.1])
        side = np.array([math.cos(face), math.sin(face), 0.0]) * w
        base = np.array([r * math.cos(a), r * math.sin(a), -0.02])
        rows = []
        for t, wide in ((0.0, 1.0), (0.38, 0.9), (0.72, 0.6), (1.0, 0.08)):
            c = base + (*(out * bend * h * t * t), h * (t - 0.22 * bend * t * t))
            rows.append([c - side * wide, c + side * wide])
        parts.append((*sheet(rows), made))
    return joined(name, parts)


def daisy(name, petals, petal_made, heart_made, stem_made, length, wide, droop, tall, seed):
    """A flower on its stem: `petals` petals that lift by `droop` radians' sine."""
    rng = np.random.default_rng(seed)
    lean = rng.uniform(-0.04, 0.06, 2)
    top = np.array([lean[0], lean[1], tall])
    path = [np.zeros(3), np.array([0.2 * lean[0], 0.2 * lean[1], 0.55 * tall]), top]
    rows = [[p + (math.cos(a) * 0.0028, math.sin(a) * 0.0028, 0) for a in (0, 2.09, 4.19, 6.283)] for p in path]
    parts = [(*sheet(rows), stem_made)]
    tilt = np.array([[1, 0, 0.0], [0, math.cos(0.6), -math.sin(0.6)], [0, math.sin(0.6), math.cos(0.6)]])
    for k in range(petals):
        a = 2 * math.pi * (k + rng.uniform(-0.1, 0.1)) / petals
        d, s = np.array([math.cos(a), math.sin(a), 0]), np.array([-math.sin(a), math.cos(a), 0])
        rows = []
        for t, w in ((0.08, 0.35), (0.55, 1.0), (0.88, 0.85), (1.0, 0.35)):
            z = np.array([0, 0, length * (droop * t - 0.3 * t * t)])
            rows.append([top + tilt @ (d * length * t + s * wide * w * u + z + (0, 0, 0.12 * wide * abs(u))) for u in (-1, 0, 1)])
        parts.append((*sheet(rows), petal_made))
    rr = length * 0.30
    dome = [[top + tilt @ np.array([rr * math.cos(e) * math.cos(a), rr * math.cos(e) * math.sin(a), 0.004 + 0.6 * rr * math.sin(e)])
             for a in np.linspace(0, 2 * math.pi, 9)] for e in (0.0, 0.7, 1.57)]
    parts.append((*sheet(dome), heart_made))
    return joined(name, parts)


def pinwheel(name, first, second, pin, radius=0.27):
    """Six curled vanes about the axis -y, hub at the origin, in two alternating papers."""
    parts = []
    s, t = np.linspace(0.04, 1, 7), np.linspace(0, 1, 10)
    for k in range(6):
        a = math.radians(60 * k)
        corner = radius * np.array([math.cos(a), 0.0, math.sin(a)])
        b = a + math.radians(62)
        bulge = radius * np.array([1.12 * math.cos(b), -0.42, 1.12 * math.sin(b)])
        front = np.array([0.0, -0.22 * radius, 0.0])
        edge = [(1 - q) ** 2 * corner + 2 * q * (1 - q) * bulge + q * q * front for q in t]
        parts.append((*sheet([[p * q for p in edge] for q in s]), first if k % 2 else second))
    ring = np.linspace(0, 2 * math.pi, 11)
    knob = [[(0.022 * math.cos(e) * math.cos(a), -0.24 * radius - 0.018 * math.sin(e), 0.022 * math.cos(e) * math.sin(a))
             for a in ring] for e in (-0.3, 0.3, 0.9, 1.57)]
    parts.append((*sheet(knob), pin))
    return joined(name, parts)


def tree(name, bark, foliage, seed=5):
    """A broad crown: trunk, limbs and leaf cards scattered over clumps."""
    rng = np.random.default_rng(seed)
    parts = []

    def limb(a, b, ra, rb):
        d = np.asarray(b, float) - a
        u = np.cross(d, (0.3, 0.9, 0.1))
        u /= np.linalg.norm(u)
        v = np.cross(d, u)
        v /= np.linalg.norm(v)
        ring = np.linspace(0, 2 * math.pi, 8)
        parts.append((*sheet([[p + r * (math.cos(q) * u + math.sin(q) * v) for q in ring] for p, r in ((np.asarray(a), ra), (b, rb))]), bark))

    fork = np.array([0.1, 0.0, 2.0])
    limb((0, 0, -0.3), fork, 0.22, 0.16)
    clumps = []
    for k in range(15):
        a, e = 2.4 * k, rng.uniform(-0.1, 1.35)
        tip = fork + np.array([2.3 * math.cos(a) * math.cos(e), 2.3 * math.sin(a) * math.cos(e), 0.75 + 2.1 * math.sin(e)]) * rng.uniform(0.8, 1.1)
        limb(fork, tip, 0.10, 0.03)
        clumps.append((tip, rng.uniform(0.75, 1.15)))
    cards, faces = [], []
    for tip, size in clumps:
        for _ in range(135):
            n = rng.normal(size=3)
            n /= np.linalg.norm(n)
            c = tip + n * size * rng.uniform(0.55, 1.0) * (1, 1, 0.75)
            facing = n + 0.6 * rng.normal(size=3)
            u = np.cross(facing, rng.normal(size=3))
            u /= np.linalg.norm(u)
            v = np.cross(facing, u)
            v /= np.linalg.norm(v)
            w = rng.uniform(0.10, 0.19)
            i = len(cards)
            cards += [c - u * w, c - v * w * 0.6, c + u * w, c + v * w * 0.6]
            faces.append((i, i + 1, i + 2, i + 3))
    parts.append((cards, faces, foliage))
    return joined(name, parts)


def stone(name, made, seed):
    """A weathered stone."""
    a, e = np.linspace(0, 2 * np.pi, 15)[:-1], np.linspace(-1.57, 1.57, 9)
    rng = np.random.default_rng(seed)
    d = np.stack([np.cos(e)[:, None] * np.cos(a), np.cos(e)[:, None] * np.sin(a), np.sin(e)[:, None] * np.ones_like(a)], -1)
    r = 1 + sum(0.22 / k * np.sin(k * (d @ rng.normal(size=3)) * 1.7 + rng.uniform(0, 6)) for k in (1, 2, 3))
    return kit.grid(name, d * r[..., None] * (0.5, 0.42, 0.3), made, wrap_u=True)


def scatter(rng, count, near, far, power, half_angle=0.72):
    """Places in the camera's wedge between two distances, dense near the eye as distance**-power per area."""
    q = rng.uniform(size=count)
    k = 2.0 - power
    r = np.exp(np.log(near) + q * np.log(far / near)) if abs(k) < 1e-6 else (near**k + q * (far**k - near**k)) ** (1 / k)
    a = rng.uniform(-half_angle, half_angle, count)
    return EYE[0] + r * np.sin(a), EYE[1] + r * np.cos(a), r


def crowd(x, y, q, scale, lift=0.0):
    """Transforms of a crowd that stands on the ground."""
    s = np.broadcast_to(np.asarray(scale, float).reshape(len(x), -1), (len(x), 3))
    return np.stack([x, y, height(x, y) + lift], 1), q, s


def meadow(m, crowds):
    """Grass, flowers and stones."""
    rng = np.random.default_rng(200)
    for i, (count, tall, made) in enumerate([(6800, 0.21, "grass0"), (6200, 0.24, "grass1"), (3400, 0.30, "grass2")]):
        x, y, r = scatter(rng, count, 1.5, 95, 1.35)
        keep = np.ones(len(x), bool) if i < 2 else (np.sin(0.5 * x + 0.23 * y) + np.sin(0.31 * y - 0.2 * x) > -0.35)
        x, y, r = x[keep], y[keep], r[keep]
        size = rng.uniform(0.7, 1.15, len(x)) * (1.0 + 0.02 * r)
        # Among the pinwheels the grass is mown, so that their shadows lie on it.
        off = np.abs(x - river(y) - 0.4) - (2.6 + 0.055 * y)
        size *= 0.40 + 0.60 * tx.step(-0.2, 2.2, off)
        stands = rng.uniform(size=len(x)) < 0.22 + 0.78 * tx.step(-0.1, 0.7, off)
        x, y, r, size = x[stands], y[stands], r[stands], size[stands]
        wide = size * (1.0 + 0.045 * r)
        q = quaternions(rng.uniform(-0.8, 0.8, len(x)))
        crowds[f"Grass {i}"] = crowd(x, y, q, np.stack([wide, wide, size], 1))
        kit.link(f"Grass {i}", tuft(f"grass {i}", m[made], 210 + i, tall=tall))
    daisies = daisy("daisy", 13, m["white"], m["yolk"], m["stem"], 0.036, 0.0085, 0.35, 0.29, 220)
    poppies = daisy("poppy", 5, m["poppy"], m["dark"], m["stem"], 0.048, 0.036, 1.15, 0.34, 221)
    for name, data, count, f, bias in [("Daisies", daisies, 4200, 0.42, -0.1), ("Poppies", poppies, 2600, 0.33, 0.35)]:
        x, y, r = scatter(rng, count, 2.0, 45, 1.25)
        patch = np.sin(f * x + 1.3 + bias) + np.sin(1.3 * f * y - 0.4 * x + 9 * bias) + rng.normal(0, 0.45, len(x))
        keep = (patch > bias) & ((np.abs(x - river(y)) > 2.4 + 0.05 * y) | (rng.uniform(size=len(x)) < 0.2))
        x, y, r = x[keep], y[keep], r[keep]
        q = quaternions(rng.uniform(-0.9, 0.9, len(x)), 0.0, rng.normal(0, 0.28, len(x)), rng.normal(0.06, 0.2, len(x)))
        crowds[name] = crowd(x, y, q, rng.uniform(0.75, 1.3, len(x)) * (1 + 0.018 * r))
        kit.link(name, data)
    x, y, r = scatter(rng, 150, 3.0, 50, 1.0)
    keep = np.abs(x - river(y)) > 3.2
    x, y = x[keep], y[keep]
    s = rng.uniform(0.18, 0.75, len(x)) ** 1.6
    crowds["Stones"] = crowd(x, y, quaternions(rng.uniform(0, 6.28, len(x))), s, lift=0.03)
    kit.link("Stones", stone("stone", m["stone"], 230))


def pinwheels(m, crowds):
    """The river: colours in bands across it, each wheel at its own phase, all turned to the wind."""
    rng = np.random.default_rng(300)
    places = []
    y = 0.6
    while y < 66:
        width = 2.6 + 0.055 * y
        gap = 0.78 + 0.004 * y
        for x in np.arange(-width, width, gap):
            px, py = x + rng.normal(0, 0.13), y + rng.normal(0, 0.16)
            places.append((px + river(py), py, px / width))
        y += 0.80 + 0.006 * y
    x, y, band = np.array(places).T
    # Nothing stands right in front of the lens.
    keep = np.hypot(x - EYE[0], y - EYE[1]) > 3.4
    x, y, band = x[keep], y[keep], band[keep]
    kinds = [("coral", "paper"), ("saffron", "paper"), ("rose", "saffron"), ("teal", "paper"), ("blue", "teal")]
    pick = np.clip(((band + 1) / 2 * 5 + rng.normal(0, 0.35, len(x))).astype(int), 0, 4)
    size = rng.uniform(0.85, 1.15, len(x))
    tall = size * rng.uniform(0.86, 1.12, len(x))
    yaw = math.radians(-34) + rng.normal(0, 0.16, len(x))
    spin = rng.uniform(0, 6.283, len(x))
    for i, (a, b) in enumerate(kinds):
        k = pick == i
        t, q, s = crowd(x[k], y[k], quaternions(yaw[k], spin[k]), size[k], lift=0.98 * tall[k])
        away = np.stack([np.sin(yaw[k]), -np.cos(yaw[k]), 0 * yaw[k]], 1)
        crowds[f"Pinwheels {i}"] = (t + 0.045 * away, q, s)
        kit.link(f"Pinwheels {i}", pinwheel(f"pinwheel {i}", m[a], m[b], m["pin"]))
    crowds["Sticks"] = crowd(x, y, quaternions(yaw), np.stack([size, size, tall], 1))
    kit.link("Sticks", kit.tube("stick", [(0, 0, -0.1), (0, 0, 0.5), (0, 0, 1.0)], 0.011, m["stick"], 8))


def trees(m, crowds):
    """One tree to the left of the river, a loose line of them along the ridge."""
    rng = np.random.default_rng(400)
    x = np.array([-9.5, -34, -27, -21, 13, 19.5, 24, 36, 41, 5, -46, 30])
    y = np.array([25.0, 66, 72, 76, 70, 74, 68, 75, 70, 82, 70, 79])
    size = np.concatenate([[1.35], rng.uniform(0.7, 1.3, len(x) - 1)])
    crowds["Trees"] = crowd(x, y, quaternions(rng.uniform(0, 6.28, len(x))), size)
    kit.link("Trees", tree("tree", m["bark"], m["foliage"]))


def land(m):
    """The ground near and the hills far away."""
    v = np.linspace(0, 1, 64)
    ys = -12 + 152 * v**1.6
    xs = np.linspace(-1, 1, 60)
    rows = [[(x * (22 + 0.75 * (y + 12)), y, 0) for x in xs] for y in ys]
    rows = np.array(rows)
    rows[..., 2] = height(rows[..., 0], rows[..., 1])
    ground = kit.grid("ground", rows, m["ground"])
    uv = np.array([ground.vertices[l.vertex_index].co[:2] for l in ground.loops], np.float32) / 5.0
    ground.uv_layers[0].data.foreach_set("uv", uv.ravel())
    kit.link("Ground", ground)
    for name, y, base, amp, f in [("near hill", 260, 9, 9, 0.013), ("far hill", 520, 26, 22, 0.0075)]:
        x = np.linspace(-420, 420, 80) * y / 300
        top = base + amp * np.sin(f * x + 0.4) + 0.35 * amp * np.sin(2.7 * f * x + 2) + 0.12 * amp * np.sin(7 * f * x)
        rows = [np.stack([x, np.full_like(x, y + 90 * k), -30 * (1 - k) + (top + 30) * k - 10 * (k > 1)], 1) for k in (0.0, 0.5, 0.85, 1.0)]
        kit.link(name.capitalize(), kit.grid(name, rows, m[name]))


def build(out, folder):
    """Writes field.glb and evening.hdr into `out`; textures pass through `folder`."""
    kit.clear()
    m = surfaces(folder)
    crowds = {}
    land(m)
    meadow(m, crowds)
    pinwheels(m, crowds)
    trees(m, crowds)
    kit.sun("Sun", SUN, 12.0, (1.0, 0.72, 0.44), 0.53)
    kit.camera((EYE[0], EYE[1], 2.15 + float(height(*EYE[:2]))), (0.35, 12.0, 1.22), 32)
    sky.sky(out / "evening.hdr", SUN, zenith=(0.22, 0.47, 0.92), horizon=(1.30, 1.02, 0.68), glow=(1.4, 0.80, 0.38),
            ground=(0.10, 0.11, 0.06), scale=0.8, haze=0.06, clouds=0.55,
            lit=(1.30, 0.98, 0.80), seed=7)
    kit.export(out / "field.glb")
    kit.add_instances(out / "field.glb", crowds)
    print("field.glb: instances", {name: len(c[0]) for name, c in crowds.items()}, "total", sum(len(c[0]) for c in crowds.values()))
