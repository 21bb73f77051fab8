"""A still life under a large cool softbox and a small warm lamp: glaze, copper, pewter, glass, linen, oak and fruit."""
import math

import bpy
import numpy as np

from . import kit, textures as tx


def pear(name, made, seed):
    profile = kit.curve([(0.0, 0.004), (0.012, 0.0), (0.030, 0.010), (0.039, 0.032), (0.034, 0.056), (0.022, 0.076),
                         (0.0165, 0.090), (0.010, 0.098), (0.003, 0.096), (0.0, 0.094)], 30)
    return kit.lathe(name, profile, made, 36, wobble=0.03, seed=seed)


def apple(name, made, seed):
    profile = kit.curve([(0.0, 0.008), (0.008, 0.003), (0.018, 0.0), (0.033, 0.014), (0.041, 0.040), (0.035, 0.064),
                         (0.020, 0.073), (0.008, 0.069), (0.0, 0.061)], 30)
    return kit.lathe(name, profile, made, 36, wobble=0.02, seed=seed)


def lemon(name, made, seed):
    profile = kit.curve([(0.0, 0.0), (0.005, 0.001), (0.009, 0.008), (0.022, 0.020), (0.0275, 0.042), (0.021, 0.064),
                         (0.009, 0.076), (0.006, 0.083), (0.0, 0.085)], 26)
    return kit.lathe(name, profile, made, 32, (2.0, 2.0), wobble=0.02, seed=seed)


def stem(made):
    return kit.tube("stem", [(0, 0, -0.004), (0.001, 0, 0.008), (0.004, 0.001, 0.017), (0.009, 0.002, 0.024)],
                    [0.0016, 0.0013, 0.0014, 0.0022], made, 6)


def leaf(name, made, length=0.06, width=0.024):
    u = np.linspace(-1, 1, 7)
    v = np.linspace(0, 1, 10)
    wide = np.sin(np.pi * v**0.8) ** 0.8 * width / 2
    wide[-1] = 0.0002
    x = wide[:, None] * u
    y = (v * length)[:, None] * np.ones_like(u)
    z = 0.006 * np.abs(u)[None] * np.sin(np.pi * v)[:, None] + (0.3 * v - 0.55 * v * v)[:, None] * length
    return kit.grid(name, np.stack([x, y, z], -1), made)


def cloth(made, seats):
    """A linen cloth let fall over the table's front edge by Blender's cloth solver, pressed flat under `seats`
    (x, y, radius)."""
    n, m = 76, 62
    u, v = np.meshgrid(np.linspace(-0.31, 0.31, n), np.linspace(-0.30, 0.26, m))
    # A little too much cloth for its place: shallow waves leave it room to fold.
    wave = 0.012 * np.sin(15 * u + 4 * v + 0.6) + 0.005 * np.sin(9 * v - 7 * u) + 0.004 * np.sin(23 * u * (1 + v))
    z = 0.026 + np.abs(wave)
    a = math.radians(-17)
    x = u * math.cos(a) - v * math.sin(a) + 0.115
    y = u * math.sin(a) + v * math.cos(a) - 0.17
    sheet = kit.link("cloth", kit.grid("cloth", np.stack([x, y, z], -1), made, (4.0, 3.6)))
    board = kit.link("board", kit.box("board", (2.2, 1.2, 0.05), made, 0.008), (0, 0.285, -0.025))
    mod = board.modifiers.new("Collision", "COLLISION")
    board.collision.thickness_outer = 0.003
    board.collision.cloth_friction = 8.0
    mod = sheet.modifiers.new("Cloth", "CLOTH")
    mod.settings.quality = 6
    mod.settings.mass = 0.15
    mod.settings.tension_stiffness = mod.settings.compression_stiffness = 18.0
    mod.settings.shear_stiffness = 6.0
    mod.settings.bending_stiffness = 0.8
    mod.settings.tension_damping = 8.0
    mod.settings.air_damping = 3.0
    mod.collision_settings.distance_min = 0.003
    mod.collision_settings.collision_quality = 3
    mod.point_cache.frame_start, mod.point_cache.frame_end = 1, 60
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, 60
    for frame in range(1, 56):
        scene.frame_set(frame)
    data = kit.baked(sheet, "cloth")
    bpy.data.objects.remove(board)
    scene.frame_set(1)
    p = np.empty(len(data.vertices) * 3, np.float32)
    data.vertices.foreach_get("co", p)
    p = p.reshape(-1, 3)
    for cx, cy, radius in seats:
        d = np.hypot(p[:, 0] - cx, p[:, 1] - cy)
        press = 1.0 - tx.step(radius, radius + 0.035, d)
        on_top = p[:, 2] > -0.002
        p[:, 2] = np.where(on_top, p[:, 2] * (1 - press) + 0.0022 * press, p[:, 2])
    data.vertices.foreach_set("co", p.ravel())
    data.update()
    kit.link("Linen cloth", data)


def surfaces(folder):
    """Materials by name, with their textures."""
    m = {}
    color, height = tx.wood((512, 512), 3, (0.34, 0.20, 0.11), (0.60, 0.41, 0.25), (0.76, 0.58, 0.39))
    m["oak"] = kit.material("Oak", rough=0.42, image=tx.save(folder, "oak", color),
                            normal=tx.save(folder, "oak_normal", tx.normal_map(height, 0.5)), bump=0.7)
    color, height = tx.linen((256, 256), 5, 64, (0.84, 0.80, 0.72))
    m["linen"] = kit.material("Linen", rough=0.95, image=tx.save(folder, "linen", color, 80),
                              normal=tx.save(folder, "linen_normal", tx.normal_map(height, 0.55), 80))
    shade = tx.noise((256, 256), 2.4, seed=8)
    m["wall"] = kit.material("Plaster", rough=0.9, image=tx.save(folder, "plaster", tx.ramp(
        0.5 + 0.16 * shade, (0, (0.36, 0.46, 0.46)), (1, (0.52, 0.60, 0.58)))))
    v = np.linspace(0, 1, 256)[:, None]
    streak = tx.noise((256, 256), 1.6, (1.0, 12.0), 11)
    blush = tx.step(-0.9, 1.1, tx.noise((256, 256), 3.0, seed=12) + 0.35 * streak)
    skin = tx.ramp(blush, (0, (0.80, 0.60, 0.20)), (0.45, (0.74, 0.24, 0.12)), (1, (0.52, 0.05, 0.06)))
    dimple = tx.step(0.80, 0.97, v)[..., None]
    skin = skin * (1 - dimple) + np.array([0.62, 0.60, 0.25]) * dimple
    m["apple"] = kit.material("Apple", rough=0.28, image=tx.save(folder, "apple", skin), coat=0.3, coat_rough=0.15)
    speck = tx.step(1.5, 2.4, tx.noise((256, 256), 0.3, seed=14, low=10))[..., None]
    body = tx.ramp(np.clip(0.45 + 0.25 * tx.noise((256, 256), 2.6, seed=15) + 0.25 * (v - 0.4), 0, 1),
                   (0, (0.50, 0.56, 0.16)), (0.6, (0.72, 0.66, 0.22)), (1, (0.80, 0.56, 0.22)))
    m["pear"] = kit.material("Pear", rough=0.36, image=tx.save(folder, "pear", body * (1 - 0.35 * speck)))
    dents = -np.abs(tx.noise((256, 256), 0.4, seed=17, low=14))
    peel = tx.save(folder, "peel_normal", tx.normal_map(dents, 0.22))
    m["orange"] = kit.material("Orange", (0.83, 0.22, 0.018), 0.36, normal=peel, bump=0.8)
    m["lemon"] = kit.material("Lemon", (0.86, 0.56, 0.035), 0.34, normal=peel, bump=0.8)
    line = tx.noise((256, 256), 1.0, (40.0, 1.0), 21)
    mr = np.zeros((256, 256, 3))
    mr[..., 1], mr[..., 2] = 0.34 + 0.07 * line, 1.0
    mr = tx.save(folder, "brushed_mr", mr)
    brushed = tx.save(folder, "brushed_normal", tx.normal_map(line, 0.10))
    m["copper"] = kit.material("Brushed copper", (0.93, 0.47, 0.30), rough_image=mr, normal=brushed, metal=1.0)
    m["pewter"] = kit.material("Pewter", (0.52, 0.51, 0.49), rough_image=mr, normal=brushed, metal=1.0)
    m["brass"] = kit.material("Polished brass", (0.88, 0.62, 0.27), 0.16, 1.0)
    run = tx.noise((256, 256), 2.8, (1.0, 3.0), 23)
    glaze = tx.ramp(np.clip(1.25 * v + 0.07 * run, 0, 1), (0.0, (0.74, 0.66, 0.54)), (0.14, (0.72, 0.64, 0.52)),
                    (0.17, (0.10, 0.30, 0.38)), (0.55, (0.07, 0.27, 0.38)), (0.95, (0.13, 0.40, 0.45)))
    m["glaze"] = kit.material("Glazed stoneware", rough=0.38, image=tx.save(folder, "glaze", glaze), coat=1.0,
                              coat_rough=0.04)
    m["cream"] = kit.material("Cream porcelain", (0.78, 0.73, 0.64), 0.22, coat=0.6)
    m["glass"] = kit.material("Glass", (0.96, 0.99, 0.975), 0.0, ior=1.47, transmission=1.0)
    m["grape"] = kit.material("Grape", (0.085, 0.018, 0.055), 0.24, coat=0.35, coat_rough=0.25)
    m["wood"] = kit.material("Stem", (0.10, 0.055, 0.025), 0.8)
    m["leaf"] = kit.material("Leaf", (0.055, 0.16, 0.035), 0.42)
    m["globe"] = kit.material("Globe", (0.02, 0.02, 0.02), 0.6, emission=(1.0, 0.63, 0.34), strength=1.35)
    m["pearl"] = kit.material("Pearl light", (0.02, 0.02, 0.02), 0.6, emission=(1.0, 0.63, 0.34), strength=1.5)
    return m


def vessels(m):
    """Jug, carafe, bowl, cup and the globe lamp."""
    jug = kit.curve([(0.0, 0.003), (0.046, 0.0), (0.050, 0.004), (0.066, 0.035), (0.083, 0.085), (0.082, 0.130),
                     (0.062, 0.178), (0.037, 0.210), (0.031, 0.235), (0.035, 0.262), (0.043, 0.276), (0.041, 0.279),
                     (0.036, 0.274), (0.028, 0.240), (0.027, 0.215), (0.052, 0.175), (0.0, 0.170)], 72)
    kit.link("Jug", kit.lathe("jug", jug, m["glaze"], 56, (1.0, 1.55), sharp=60), (-0.155, 0.115, 0))
    handle = kit.curve([(-0.030, 0, 0.252), (-0.062, 0, 0.262), (-0.094, 0, 0.238), (-0.104, 0, 0.196), (-0.094, 0, 0.158),
                        (-0.072, 0, 0.140)], 22)
    kit.link("Jug handle", kit.tube("handle", handle, np.linspace(0.0095, 0.0075, 22), m["glaze"], 12), (-0.155, 0.115, 0),
             (0, 0, 20))
    carafe = kit.curve([(0.0, 0.0), (0.040, 0.0), (0.050, 0.006), (0.056, 0.040), (0.055, 0.085), (0.043, 0.125),
                        (0.026, 0.155), (0.021, 0.185), (0.023, 0.215), (0.032, 0.240), (0.0335, 0.2415), (0.0325, 0.2430),
                        (0.0300, 0.2415), (0.0208, 0.215), (0.0188, 0.185), (0.0238, 0.154), (0.0408, 0.123),
                        (0.0528, 0.084), (0.0535, 0.042), (0.048, 0.011), (0.036, 0.008), (0.0, 0.008)], 84)
    kit.link("Carafe", kit.lathe("carafe", carafe, m["glass"], 64), (0.345, 0.13, 0.0005))
    bowl = kit.curve([(0.0, 0.006), (0.040, 0.004), (0.044, 0.0), (0.052, 0.002), (0.050, 0.010), (0.090, 0.030), (0.125, 0.064),
                      (0.137, 0.085), (0.138, 0.088), (0.1355, 0.089), (0.122, 0.068), (0.086, 0.036), (0.044, 0.017),
                      (0.0, 0.013)], 60)
    kit.link("Copper bowl", kit.lathe("bowl", bowl, m["copper"], 64, (2.0, 2.0)), (0.105, 0.02, 0.003))
    cup = kit.curve([(0.0, 0.003), (0.028, 0.0), (0.031, 0.002), (0.033, 0.020), (0.036, 0.055), (0.040, 0.082), (0.0395, 0.0835),
                     (0.0375, 0.082), (0.0335, 0.055), (0.030, 0.012), (0.0, 0.009)], 40)
    kit.link("Pewter cup", kit.lathe("cup", cup, m["pewter"], 48, (2.0, 2.0), sharp=50), (-0.305, 0.045, 0))
    foot = kit.curve([(0.0, 0.012), (0.0, 0.0)], 2)
    foot = np.vstack([[(0.0, 0.0), (0.052, 0.0), (0.054, 0.003), (0.050, 0.007), (0.014, 0.013), (0.0065, 0.022)],
                      kit.curve([(0.0065, 0.022), (0.006, 0.06), (0.009, 0.068), (0.006, 0.076), (0.0058, 0.150), (0.012, 0.160),
                                 (0.026, 0.168), (0.028, 0.176), (0.0, 0.174)], 40)[1:]])
    kit.link("Lamp foot", kit.lathe("lamp foot", foot, m["brass"], 40, sharp=50), (-0.405, 0.27, 0))
    kit.link("Lamp globe", kit.ball("globe", 0.052, m["globe"], 40, 24), (-0.405, 0.27, 0.222))
    dish = kit.curve([(0.0, 0.003), (0.030, 0.0), (0.034, 0.002), (0.046, 0.010), (0.047, 0.012), (0.045, 0.0122), (0.030, 0.006),
                      (0.0, 0.005)], 26)
    dish, pearl = kit.lathe("dish", dish, m["cream"], 40), kit.ball("pearl", 0.015, m["pearl"], 28, 16)
    for i, (x, y) in enumerate([(-0.10, -0.175), (0.425, -0.02)]):
        kit.link(f"Dish {i}", dish, (x, y, 0))
        kit.link(f"Pearl light {i}", pearl, (x, y, 0.0205))


def fruit(m):
    """Oranges and lemons in the bowl, pears and apples beside it, grapes on the cloth."""
    rng = np.random.default_rng(4)
    orange = kit.lathe("orange", kit.curve([(0.0, 0.002), (0.004, 0.0), (0.022, 0.006), (0.0375, 0.036), (0.024, 0.066),
                       (0.006, 0.073), (0.0, 0.071)], 26), m["orange"], 36, (2.0, 2.0), wobble=0.012, seed=2)
    nub = kit.ball("nub", 0.003, m["leaf"], 8, 5)
    yellow = lemon("lemon", m["lemon"], 3)
    bx, by = 0.105, 0.02
    for i, (x, y, z) in enumerate([(-0.062, -0.012, 0.045), (0.012, -0.058, 0.043), (0.060, 0.012, 0.046), (-0.015, 0.055, 0.045),
                                   (-0.004, -0.004, 0.094)]):
        turn = (rng.uniform(-40, 40), rng.uniform(-40, 40), rng.uniform(0, 360))
        kit.link(f"Orange {i}", orange, (bx + x, by + y, z), turn)
    kit.link("Lemon 0", yellow, (bx + 0.045, by - 0.075, 0.108), (78, 15, 62))
    kit.link("Lemon 1", yellow, (bx + 0.085, by + 0.055, 0.095), (70, -20, 140))
    kit.link("Lemon 2", yellow, (0.035, -0.215, 0.0285), (90, 0, -66))
    green = leaf("leaf", m["leaf"])
    kit.link("Leaf 0", green, (bx - 0.004, by - 0.004, 0.166), (8, 18, 205))
    kit.link("Leaf 1", green, (bx - 0.002, by - 0.002, 0.166), (14, -10, 110), 0.85)
    kit.link("Nub", nub, (bx - 0.003, by - 0.003, 0.166))
    twig = stem(m["wood"])
    for i, (x, y, turn) in enumerate([(-0.225, -0.045, (4, 3, 30)), (-0.165, -0.105, (82, 0, 118))]):
        lying = turn[0] > 45
        thing = kit.link(f"Pear {i}", pear(f"pear {i}", m["pear"], 5 + i), (x, y, 0.036 if lying else 0.0), turn)
        top = kit.link(f"Pear stem {i}", twig, (0, 0, 0.094))
        top.parent = thing
    for i, (x, y, z, turn) in enumerate([(-0.305, -0.085, 0.0, (6, -8, 10)), (-0.385, -0.005, 0.0, (-10, 14, 80))]):
        thing = kit.link(f"Apple {i}", apple(f"apple {i}", m["apple"], 15 + i), (x, y, z), turn)
        top = kit.link(f"Apple stem {i}", twig, (0, 0, 0.064))
        top.parent = thing
    grape = kit.ball("grape", 0.0105, m["grape"], 20, 12)
    placed = []
    for _ in range(4000):
        t = rng.uniform()
        x, y = 0.255 + 0.075 * t + rng.normal(0, 0.020 * (1.15 - t)), -0.185 + 0.045 * t + rng.normal(0, 0.017 * (1.15 - t))
        spots = [p for p in placed if math.hypot(p[0] - x, p[1] - y) < 0.0205]
        z = 0.0135
        for p in sorted(spots, key=lambda p: p[2]):
            gap = 0.0205**2 - (p[0] - x) ** 2 - (p[1] - y) ** 2
            z = max(z, p[2] + math.sqrt(max(gap, 0.0)))
        if z < 0.047 - 0.02 * t:
            placed.append((x, y, z))
        if len(placed) == 44:
            break
    for i, p in enumerate(placed):
        turn = rng.uniform(0, 180, 3)
        kit.link(f"Grape {i}", grape, p, turn, (1.0, 1.0, 1.12))
    kit.link("Grape stalk", kit.tube("stalk", [(0.24, -0.19, 0.03), (0.225, -0.195, 0.036), (0.205, -0.19, 0.028), (0.19, -0.20, 0.012)],
                                     [0.0018, 0.0016, 0.0018, 0.0028], m["wood"], 6))


def build(out, folder):
    """Writes still_life.glb into `out`; textures pass through `folder`."""
    kit.clear()
    m = surfaces(folder)
    kit.link("Table", kit.box("table", (2.2, 1.2, 0.05), m["oak"], 0.008, 0.9, segments=3), (0, 0.285, -0.025))
    kit.link("Wall", kit.grid("wall", [[(-3, 0.95, -1), (3, 0.95, -1)], [(-3, 0.95, 2.5), (3, 0.95, 2.5)]], m["wall"], (3, 1.75)))
    kit.link("Apron", kit.box("apron", (2.1, 0.03, 0.5), m["oak"], 0.004, 0.9, 3), (0, -0.27, -0.3))
    vessels(m)
    fruit(m)
    cloth(m["linen"], [(0.105, 0.02, 0.055), (0.035, -0.215, 0.01), (0.28, -0.165, 0.05),
                       (-0.10, -0.175, 0.04), (-0.165, -0.105, 0.04)])
    kit.quad_light("Key", (-1.30, 0.12, 0.76), (0.0, 0.05, 0.08), (0.42, 0.42), (0.93, 0.97, 1.0), 112.0)
    kit.quad_light("Warm lamp", (1.05, -0.12, 0.52), (0.05, 0.0, 0.05), (0.10, 0.10), (1.0, 0.46, 0.17), 105.0)
    kit.quad_light("Fill", (0.9, -1.6, 1.3), (0.0, 0.1, 0.1), (1.4, 1.0), (0.75, 0.85, 1.0), 0.5)
    kit.camera((0.06, -1.62, 0.50), (0.005, 0.0, 0.094), 60)
    kit.export(out / "still_life.glb")
