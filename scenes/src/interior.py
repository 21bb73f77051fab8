"""A living room in late morning: a large window, a clear sky outside and the sun laying the window's bars on the floor."""
import math

import numpy as np

from . import kit, sky, textures as tx

WIDE, DEEP, HIGH = 4.6, 5.6, 2.75
WINDOW_Y, WINDOW_Z = (1.75, 4.45), (0.42, 2.38)
THICK = 0.34
SUN = (-1.0, -0.30, 0.64)


def surfaces(folder):
    """Materials by name, with their textures."""
    m = {}
    color, height = tx.planks((512, 512), 31, 8, (0.42, 0.27, 0.16), (0.64, 0.46, 0.30), (0.78, 0.61, 0.43))
    m["floor"] = kit.material("Oak planks", rough=0.38, image=tx.save(folder, "planks", color),
                              normal=tx.save(folder, "planks_normal", tx.normal_map(height, 0.5)), bump=0.6)
    color, height = tx.wood((256, 512), 45, (0.16, 0.08, 0.045), (0.36, 0.20, 0.115), (0.52, 0.32, 0.19))
    m["walnut"] = kit.material("Walnut", rough=0.4, image=tx.save(folder, "walnut", color))
    trowel = tx.noise((256, 256), 2.2, seed=50)
    plaster = tx.save(folder, "plaster_normal", tx.normal_map(trowel, 0.5), 80)
    m["wall"] = kit.material("White plaster", (0.78, 0.755, 0.71), 0.9, normal=plaster, bump=0.35)
    m["accent"] = kit.material("Sage plaster", (0.50, 0.55, 0.47), 0.9, normal=plaster, bump=0.35)
    m["ceiling"] = kit.material("Ceiling", (0.82, 0.81, 0.79), 0.95)
    m["paint"] = kit.material("White lacquer", (0.80, 0.79, 0.76), 0.35)
    color, height = tx.linen((256, 256), 52, 48, (0.83, 0.78, 0.70))
    weave = tx.save(folder, "weave_normal", tx.normal_map(height, 0.6), 80)
    m["curtain"] = kit.material("Linen curtain", (0.74, 0.70, 0.63), 0.95, normal=weave)
    m["sofa"] = kit.material("Wool", (0.50, 0.165, 0.075), 0.95, normal=weave)
    m["mustard"] = kit.material("Mustard velvet", (0.66, 0.36, 0.06), 0.9, normal=weave)
    m["cream"] = kit.material("Cream linen", (0.72, 0.66, 0.56), 0.95, normal=weave)
    m["rug"] = kit.material("Rug", rough=1.0, image=tx.save(folder, "rug", rug_pattern(), 84), normal=weave)
    m["brass"] = kit.material("Brass", (0.85, 0.60, 0.26), 0.22, 1.0)
    m["black"] = kit.material("Blackened steel", (0.03, 0.03, 0.032), 0.4)
    m["stone"] = kit.material("Stoneware", (0.66, 0.62, 0.55), 0.5)
    m["blue"] = kit.material("Blue glaze", (0.045, 0.13, 0.22), 0.3, coat=0.9)
    m["terracotta"] = kit.material("Terracotta", (0.50, 0.19, 0.095), 0.75)
    m["soil"] = kit.material("Soil", (0.05, 0.035, 0.025), 1.0)
    m["leaf"] = kit.material("Leaf", (0.045, 0.17, 0.05), 0.3, coat=0.2, coat_rough=0.3)
    m["bark"] = kit.material("Bark", (0.16, 0.10, 0.06), 0.9)
    m["picture"] = kit.material("Picture", rough=0.8, image=tx.save(folder, "picture", picture_pattern(), 88))
    m["paper"] = kit.material("Paper lantern", (0.82, 0.79, 0.72), 0.95)
    m["grass"] = kit.material("Lawn", (0.07, 0.105, 0.035), 1.0)
    m["hedge"] = kit.material("Hedge", (0.035, 0.075, 0.022), 0.9)
    for i, c in enumerate([(0.42, 0.08, 0.05), (0.06, 0.14, 0.20), (0.70, 0.60, 0.42), (0.10, 0.20, 0.13), (0.62, 0.33, 0.08)]):
        m[f"book{i}"] = kit.material(f"Book {i}", c, 0.7)
    return m


def rug_pattern():
    """A cream rug with a woven border and rows of diamonds."""
    v, u = np.mgrid[0:320, 0:512] / np.array([320.0, 512.0]).reshape(2, 1, 1)
    color = np.ones((320, 512, 3)) * (0.72, 0.66, 0.57)
    x, y = u * 1.6, v
    edge = np.minimum(np.minimum(x, 1.6 - x), np.minimum(y, 1 - y))
    for near, far, tint in [(0.05, 0.075, (0.24, 0.30, 0.33)), (0.10, 0.112, (0.62, 0.34, 0.22))]:
        color[(edge > near) & (edge < far)] = tint
    cell = 0.16
    diamond = np.abs((x / cell) % 1 - 0.5) + np.abs((y / cell) % 1 - 0.5)
    inside = edge > 0.17
    color[inside & (np.abs(diamond - 0.40) < 0.045)] = (0.36, 0.42, 0.43)
    color[inside & (diamond < 0.13)] = (0.66, 0.38, 0.25)
    worn = tx.noise((320, 512), 1.2, seed=60)[..., None]
    return color * (1 + 0.05 * worn) + 0.02 * worn


def picture_pattern():
    """An abstract landscape: a pale sun over washed hills."""
    h, w = 288, 384
    v, u = np.mgrid[0:h, 0:w] / np.array([h, w]).reshape(2, 1, 1)
    grain = tx.noise((h, w), 1.6, seed=63)
    color = tx.ramp(v + 0.02 * grain, (0, (0.90, 0.82, 0.70)), (1, (0.86, 0.84, 0.80)))
    disk = (1 - tx.step(0.138, 0.148, np.hypot((u - 0.66) * w / h, v - 0.68) + 0.003 * grain))[..., None]
    color = color * (1 - disk) + np.array((0.82, 0.42, 0.22)) * disk
    for base, amp, f, ph, tint in [(0.50, 0.07, 1.1, 0.3, (0.66, 0.70, 0.68)), (0.38, 0.08, 0.8, 2.2, (0.42, 0.53, 0.54)),
                                   (0.24, 0.07, 1.3, 4.4, (0.20, 0.33, 0.37)), (0.11, 0.04, 1.0, 1.0, (0.11, 0.18, 0.21))]:
        line = base + amp * np.sin(2 * np.pi * f * u + ph) + 0.012 * tx.noise((h, w), 2.4, seed=int(base * 100))
        under = tx.step(-0.004, 0.004, line - v)[..., None]
        color = color * (1 - under) + np.asarray(tint) * (1 + 0.06 * grain[..., None]) * under
    mat = (u < 0.09) | (u > 0.91) | (v < 0.11) | (v > 0.89)
    color[mat] = (0.90, 0.88, 0.84)
    return color


def block(name, low, high, made, bevel=0.0, uv=1.0, seed=0):
    """A box between two corners."""
    low, high = np.asarray(low, float), np.asarray(high, float)
    return kit.link(name, kit.box(name, high - low, made, bevel, uv, seed), (low + high) / 2)


def room(m):
    """Floor, walls as thick as walls are, ceiling, skirting and the window."""
    (y0, y1), (z0, z1) = WINDOW_Y, WINDOW_Z
    floor = [[(x, y, 0.0) for x in (0, WIDE)] for y in (0, DEEP)]
    kit.link("Floor", kit.grid("floor", floor, m["floor"], (1.0, 1.0)))
    layer = kit_uv(floor, 1.25)
    floor_mesh = kit.bpy.data.objects["Floor"].data
    floor_mesh.uv_layers[0].data.foreach_set("uv", layer)
    block("Slab", (-THICK, -THICK, -0.25), (WIDE + THICK, DEEP + THICK, -0.01), m["stone"])
    block("Ceiling", (-THICK, -THICK, HIGH), (WIDE + THICK, DEEP + THICK, HIGH + 0.3), m["ceiling"])
    block("Back wall", (-THICK, DEEP, 0), (WIDE + THICK, DEEP + THICK, HIGH), m["accent"])
    block("Near wall", (-THICK, -THICK, 0), (WIDE + THICK, 0, HIGH), m["wall"])
    block("Right wall", (WIDE, 0, 0), (WIDE + THICK, DEEP, HIGH), m["wall"])
    block("Wall under", (-THICK, y0, 0), (0, y1, z0), m["wall"])
    block("Wall over", (-THICK, y0, z1), (0, y1, HIGH), m["wall"])
    block("Wall near", (-THICK, 0, 0), (0, y0, HIGH), m["wall"])
    block("Wall far", (-THICK, y1, 0), (0, DEEP, HIGH), m["wall"])
    block("Sill", (-0.22, y0 - 0.05, z0), (0.09, y1 + 0.05, z0 + 0.035), m["paint"], 0.008)
    for name, low, high in [("Skirting back", (0, DEEP - 0.018, 0), (WIDE, DEEP, 0.12)),
                            ("Skirting left", (0, 0, 0), (0.018, DEEP, 0.12)),
                            ("Skirting right", (WIDE - 0.018, 0, 0), (WIDE, DEEP, 0.12))]:
        block(name, low, high, m["paint"], 0.005)
    x0, x1, bar = -0.25, -0.20, 0.05
    for name, a, b in [("bottom", z0 + 0.03, z0 + 0.03 + bar), ("top", z1 - bar, z1)]:
        block(f"Frame {name}", (x0, y0, a), (x1, y1, b), m["paint"], 0.006)
    for i, y in enumerate(np.linspace(y0, y1 - bar, 5)):
        block(f"Mullion {i}", (x0, y, z0 + 0.03 + bar), (x1, y + bar, z1 - bar), m["paint"], 0.006)
    for i, part in enumerate((0.36, 0.68)):
        z = z0 + part * (z1 - z0)
        block(f"Transom {i}", (x0 + 0.005, y0 + bar, z), (x1 - 0.005, y1 - bar, z + 0.04), m["paint"], 0.006)
    lawn = [[(-60, -40, -0.5), (-THICK, -40, -0.5)], [(-60, 50, -0.5), (-THICK, 50, -0.5)]]
    kit.link("Lawn", kit.grid("lawn", lawn, m["grass"]))
    rng = np.random.default_rng(66)
    a, e = np.linspace(0, 2 * np.pi, 25)[:-1], np.linspace(-1.2, 1.57, 13)
    d = np.stack([np.cos(e)[:, None] * np.cos(a), np.cos(e)[:, None] * np.sin(a), np.sin(e)[:, None] * np.ones_like(a)], -1)
    r = 1 + sum(0.13 / k**0.5 * np.sin(d @ rng.normal(size=3) * 2.6 * k + rng.uniform(0, 6)) for k in (1, 2, 3, 4))
    bush = kit.grid("bush", d * r[..., None], m["hedge"], wrap_u=True)
    for i in range(22):
        size = rng.uniform(0.9, 2.1)
        kit.link(f"Bush {i}", bush, (rng.uniform(-20, -15), -4 + 2.0 * i + rng.uniform(-0.6, 0.6), -0.5 + 0.5 * size),
                 (0, 0, rng.uniform(0, 360)), size)


def kit_uv(points, size):
    """Corner UVs of a single floor quad, boards running along y, one tile every `size` metres."""
    (a, b), (c, d) = points
    return np.array([(p[1] / size, p[0] / size) for p in (a, b, d, c)], np.float32).ravel()


def curtains(m):
    """Two drawn curtains, a rod and its ends."""
    rng = np.random.default_rng(70)
    for name, y0, y1 in [("near", 1.20, 1.82), ("far", 4.38, 5.05)]:
        s = np.linspace(0, 1, 90)
        z = np.linspace(0.03, 2.50, 14)
        folds = 7.0
        phase = rng.uniform(0, 6)
        rows = []
        for h in z:
            t = 1 - h / 2.5
            depth = 0.030 + 0.022 * t
            wander = 0.5 * t * np.sin(5 * s + phase)
            x = 0.11 + depth * np.sin(2 * np.pi * folds * s + wander) + 0.008 * np.sin(2 * np.pi * 2.5 * s + 2 * t)
            y = y0 + (y1 - y0) * (s + 0.02 * t * np.sin(2 * np.pi * folds * s * 0.5 + phase))
            rows.append(np.stack([x, y, np.full_like(s, h)], 1))
        kit.link(f"Curtain {name}", kit.grid(f"curtain {name}", rows, m["curtain"], (5.0, 10.0)))
    kit.link("Rod", kit.tube("rod", [(0.11, 1.05, 2.53), (0.11, 3.1, 2.53), (0.11, 5.2, 2.53)], 0.011, m["brass"], 12))
    knob = kit.ball("knob", 0.022, m["brass"], 16, 10)
    for i, y in enumerate((1.05, 5.2)):
        kit.link(f"Knob {i}", knob, (0.11, y, 2.53))


def sofa(m):
    """A sofa along the right wall, turned to the window, with cushions and tapered legs."""
    x1, y0, y1 = 4.45, 2.75, 4.85
    x0 = x1 - 0.90
    def pad(name, low, high, made, power=0.2):
        low, high = np.asarray(low, float), np.asarray(high, float)
        return kit.link(name, kit.cushion(name, high - low, made, power, 8), (low + high) / 2)
    pad("Sofa base", (x0, y0, 0.15), (x1, y1, 0.34), m["sofa"], 0.08)
    pad("Sofa back", (x1 - 0.22, y0 + 0.02, 0.28), (x1, y1 - 0.02, 0.80), m["sofa"], 0.16)
    middle = (y0 + y1) / 2
    for i, (a, b) in enumerate([(y0 + 0.16, middle), (middle, y1 - 0.16)]):
        pad(f"Sofa seat {i}", (x0 - 0.02, a, 0.30), (x1 - 0.18, b, 0.48), m["sofa"], 0.16)
        back = pad(f"Sofa cushion {i}", (x1 - 0.40, a + 0.01, 0.44), (x1 - 0.18, b - 0.01, 0.86), m["sofa"], 0.26)
        back.rotation_euler = (0, math.radians(8), 0)
    for i, y in enumerate((y0, y1 - 0.17)):
        pad(f"Sofa arm {i}", (x0, y, 0.16), (x1, y + 0.17, 0.60), m["sofa"], 0.12)
    leg = kit.lathe("sofa leg", [(0.0, 0.0), (0.013, 0.0), (0.022, 0.16), (0.0, 0.16)], m["walnut"], 16, sharp=40)
    for i, (x, y) in enumerate([(x0 + 0.07, y0 + 0.08), (x0 + 0.07, y1 - 0.08), (x1 - 0.08, y0 + 0.08), (x1 - 0.08, y1 - 0.08)]):
        kit.link(f"Sofa leg {i}", leg, (x, y, 0))
    kit.link("Pillow mustard", kit.cushion("pillow a", (0.44, 0.13, 0.44), m["mustard"], 0.55, 12), (3.98, 4.40, 0.67), (-20, -6, -38))
    kit.link("Pillow cream", kit.cushion("pillow b", (0.42, 0.13, 0.42), m["cream"], 0.55, 12), (3.95, 3.92, 0.65), (-22, 8, -62))


def table(m):
    """A round low table with books, a bowl and a bottle vase."""
    x, y = 2.35, 3.45
    top = np.array([(0.0, 0.385), (0.40, 0.385), (0.425, 0.395), (0.43, 0.405), (0.425, 0.418), (0.415, 0.42), (0.0, 0.42)])
    kit.link("Table top", kit.lathe("table top", top, m["walnut"], 64, sharp=40), (x, y, 0))
    for i in range(3):
        a = math.radians(50 + 120 * i)
        foot = [(0.36 * math.cos(a), 0.36 * math.sin(a), 0.0), (0.24 * math.cos(a), 0.24 * math.sin(a), 0.39)]
        kit.link(f"Table leg {i}", kit.tube(f"table leg {i}", foot, [0.012, 0.02], m["walnut"], 12), (x, y, 0))
    for i, (w, d, h, turn, c) in enumerate([(0.27, 0.20, 0.03, 12, 1), (0.24, 0.17, 0.024, 25, 2)]):
        kit.link(f"Table book {i}", kit.box(f"table book {i}", (w, d, h), m[f"book{c}"], 0.003),
                 (x + 0.14, y - 0.11, 0.435 + 0.027 * i), (0, 0, turn))
    vase = kit.curve([(0.0, 0.0), (0.05, 0.0), (0.085, 0.05), (0.09, 0.10), (0.06, 0.16), (0.026, 0.21), (0.022, 0.26), (0.03, 0.285),
                      (0.022, 0.28), (0.016, 0.25), (0.0, 0.24)], 40)
    kit.link("Vase", kit.lathe("vase", vase, m["blue"], 40), (x - 0.10, y + 0.07, 0.42))
    rng = np.random.default_rng(77)
    for i in range(7):
        a, lean = rng.uniform(0, 6.28), rng.uniform(0.08, 0.2)
        tip = np.array([lean * math.cos(a), lean * math.sin(a), rng.uniform(0.36, 0.50)])
        path = kit.curve([(0, 0, 0), tip * (0.3, 0.3, 0.5), tip], 8)
        kit.link(f"Stalk {i}", kit.tube(f"stalk {i}", path, 0.0022, m["bark"], 5), (x - 0.10, y + 0.07, 0.65))
        ear = kit.lathe(f"ear {i}", kit.curve([(0.0, 0.0), (0.012, 0.03), (0.010, 0.08), (0.0, 0.12)], 8), m["cream"], 8)
        kit.link(f"Ear {i}", ear, np.array((x - 0.10, y + 0.07, 0.64)) + tip, (math.degrees(-lean * 2 * math.sin(a)),
                 math.degrees(lean * 2 * math.cos(a)), 0))
    bowl = kit.curve([(0.0, 0.01), (0.04, 0.0), (0.08, 0.02), (0.11, 0.055), (0.107, 0.057), (0.075, 0.027), (0.0, 0.016)], 24)
    kit.link("Bowl", kit.lathe("bowl", bowl, m["stone"], 40), (x - 0.18, y - 0.17, 0.42))


def sideboard(m):
    """A walnut sideboard at the back wall with a lamp, books and a jar, and a picture above it."""
    x0, x1, y1 = 1.25, 3.15, DEEP - 0.03
    y0 = y1 - 0.42
    block("Sideboard", (x0, y0 + 0.02, 0.20), (x1, y1, 0.72), m["walnut"], 0.006, 1.1, 3)
    third = (x1 - x0) / 3
    for i in range(3):
        a = x0 + i * third
        block(f"Door {i}", (a + 0.012, y0, 0.225), (a + third - 0.012, y0 + 0.022, 0.695), m["walnut"], 0.004, 1.0, 5 + i)
        kit.link(f"Pull {i}", kit.tube(f"pull {i}", [(a + third / 2 - 0.06, y0 - 0.014, 0.64), (a + third / 2 + 0.06, y0 - 0.014, 0.64)],
                                       0.006, m["brass"], 10))
    for i, (x, y) in enumerate([(x0 + 0.1, y0 + 0.08), (x1 - 0.1, y0 + 0.08), (x0 + 0.1, y1 - 0.06), (x1 - 0.1, y1 - 0.06)]):
        kit.link(f"Sideboard leg {i}", kit.tube(f"sideboard leg {i}", [(x, y, 0), (x, y, 0.21)], [0.012, 0.02], m["walnut"], 12))
    rng = np.random.default_rng(80)
    x = x0 + 0.15
    for i in range(9):
        w, h = rng.uniform(0.022, 0.045), rng.uniform(0.19, 0.26)
        book = kit.box(f"book {i}", (w, rng.uniform(0.14, 0.17), h), m[f"book{rng.integers(5)}"], 0.003)
        lean = 0 if i < 8 else 14
        kit.link(f"Book {i}", book, (x + w / 2 + (0.035 if lean else 0), y0 + 0.2, 0.72 + h / 2 - (0.002 if lean else 0)), (0, -lean, 0))
        x += w + 0.001
    jar = kit.curve([(0.0, 0.0), (0.06, 0.0), (0.10, 0.08), (0.105, 0.16), (0.07, 0.23), (0.05, 0.25), (0.055, 0.27), (0.045, 0.265),
                     (0.0, 0.22)], 36)
    kit.link("Jar", kit.lathe("jar", jar, m["terracotta"], 40), (x1 - 0.30, y0 + 0.22, 0.72))
    small = kit.lathe("jar small", jar * 0.55, m["stone"], 32)
    kit.link("Jar small", small, (x1 - 0.52, y0 + 0.17, 0.72))
    w, h, px, pz = 1.20, 0.90, 2.2, 1.62
    for name, low, high in [("left", (-w / 2, -h / 2), (-w / 2 + 0.03, h / 2)), ("right", (w / 2 - 0.03, -h / 2), (w / 2, h / 2)),
                            ("bottom", (-w / 2, -h / 2), (w / 2, -h / 2 + 0.03)), ("top", (-w / 2, h / 2 - 0.03), (w / 2, h / 2))]:
        block(f"Picture frame {name}", (px + low[0], DEEP - 0.045, pz + low[1]), (px + high[0], DEEP - 0.002, pz + high[1]),
              m["walnut"], 0.003, 1.0)
    sheet = [[(px - w / 2 + 0.02, DEEP - 0.02, pz - h / 2 + 0.02), (px + w / 2 - 0.02, DEEP - 0.02, pz - h / 2 + 0.02)],
             [(px - w / 2 + 0.02, DEEP - 0.02, pz + h / 2 - 0.02), (px + w / 2 - 0.02, DEEP - 0.02, pz + h / 2 - 0.02)]]
    kit.link("Picture", kit.grid("picture", sheet, m["picture"]))


def plant(m):
    """A fiddle-leaf fig in a terracotta pot, in the corner by the window."""
    x, y = 0.62, 5.05
    pot = kit.curve([(0.0, 0.0), (0.13, 0.0), (0.15, 0.06), (0.185, 0.30), (0.20, 0.31), (0.20, 0.345), (0.18, 0.345), (0.172, 0.31),
                     (0.0, 0.31)], 40)
    kit.link("Pot", kit.lathe("pot", pot, m["stone"], 48, sharp=50), (x, y, 0))
    kit.link("Soil", kit.lathe("soil", [(0.175, 0.318), (0.1, 0.325), (0.0, 0.32)], m["soil"], 24), (x, y, 0))
    u, v = np.linspace(-1, 1, 7), np.linspace(0, 1, 11)
    wide = (0.10 * np.sin(np.pi * v**0.75) ** 0.8 * (0.75 + 0.35 * v) + 0.002)[:, None]
    wave = 0.010 * np.sin(14 * v)[:, None] * np.abs(u)[None]
    blade = np.stack([wide * u, 0.30 * v[:, None] * np.ones_like(u), 0.03 * np.abs(u)[None] + wave + (0.10 * v - 0.20 * v * v)[:, None]], -1)
    leaf = kit.grid("leaf", blade, m["leaf"])
    rng = np.random.default_rng(90)
    n = 0
    for k, (lean, turn, tall) in enumerate([(0.10, 20, 1.55), (0.26, 150, 1.15), (0.24, 275, 1.30)]):
        a = math.radians(turn)
        path = kit.curve([(0, 0, 0.30), (lean * 0.35 * math.cos(a), lean * 0.35 * math.sin(a), 0.30 + 0.45 * tall),
                          (lean * math.cos(a), lean * math.sin(a), 0.22 + tall)], 24)
        kit.link(f"Stem {k}", kit.tube(f"stem {k}", path, np.linspace(0.014, 0.006, 24), m["bark"], 8), (x, y, 0))
        for j in range(15):
            p = path[8 + j]
            spin = math.degrees(a) + 137.5 * j + rng.uniform(-15, 15)
            rise = 8 + 46 * (j / 14) ** 2 + rng.uniform(-10, 10)
            kit.link(f"Leaf {n}", leaf, (x + p[0], y + p[1], p[2]), (rise, rng.uniform(-12, 12), spin), rng.uniform(0.62, 0.95))
            n += 1


def build(out, folder):
    """Writes interior.glb and sky.hdr into `out`; textures pass through `folder`."""
    kit.clear()
    m = surfaces(folder)
    room(m)
    curtains(m)
    sofa(m)
    table(m)
    sideboard(m)
    plant(m)
    kit.link("Rug", kit.box("rug", (2.0, 2.5, 0.016), m["rug"], 0.006), (2.45, 3.55, 0.008))
    rug = kit.bpy.data.objects["Rug"].data
    uv = np.array([(rug.vertices[l.vertex_index].co.y / 2.5 + 0.5, 0.5 - rug.vertices[l.vertex_index].co.x / 2.0) for l in rug.loops])
    rug.uv_layers[0].data.foreach_set("uv", uv.astype(np.float32).ravel())
    lantern = kit.curve([(0.04, -0.20), (0.16, -0.15), (0.22, 0.0), (0.16, 0.15), (0.04, 0.20)], 49)
    lantern[:, 0] -= 0.006 * (np.arange(49) % 3 == 0)
    kit.link("Lantern", kit.lathe("lantern", lantern, m["paper"], 48), (2.35, 3.45, 2.13))
    kit.link("Cord", kit.tube("cord", [(2.35, 3.45, 2.3), (2.35, 3.45, HIGH)], 0.003, m["black"], 6))
    kit.sun("Sun", SUN, 16.5, (1.0, 0.86, 0.68), 0.53)
    kit.camera((3.22, 0.22, 1.38), (2.0, 5.2, 0.98), 23.5)
    sky.sky(out / "sky.hdr", SUN, zenith=(0.20, 0.40, 0.86), horizon=(0.78, 0.90, 1.05), glow=(1.15, 1.05, 0.90),
            ground=(0.20, 0.24, 0.15), scale=6.8, clouds=0.45, lit=(1.15, 1.15, 1.15))
    kit.export(out / "interior.glb")
