"""Nine booths, a lamp of another kind in each: writes lamps.glb with Python alone.

The lamps are `extras.penumbra` of their nodes (docs/gltf.md, "Lights beyond KHR_lights_punctual").
"""

import json
import math
import struct

DOWN = [-math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5)]
SIDE = 2.0
WARM, COOL = [1.0, 0.78, 0.52], [0.72, 0.86, 1.0]

LAMPS = [
    ("soft point", {"type": "sphere", "radius": 0.16, "power": 18, "color": WARM, "facing": True}),
    ("sphere", {"type": "sphere", "radius": 0.16, "power": 18, "color": WARM}),
    ("cylinder", {"type": "cylinder", "radius": 0.03, "length": 1.2, "power": 16, "color": COOL}),
    ("rectangle", {"type": "rect", "width": 0.9, "height": 0.45, "power": 14, "color": COOL}),
    ("rectangle, spread 50 degrees",
     {"type": "rect", "width": 0.9, "height": 0.45, "power": 9, "color": COOL, "spread": math.radians(50)}),
    ("ellipse", {"type": "disk", "width": 1.2, "height": 0.25, "power": 14, "color": WARM}),
    ("spot", {"type": "sphere", "radius": 0.03, "power": 60, "color": WARM,
              "cone": {"angle": math.radians(30), "blend": 0.3}}),
    ("measured", {"type": "point", "intensity": 7.0, "color": WARM, "ies": "rings.ies"}),
    ("linear decay", {"type": "sphere", "radius": 0.05, "power": 18, "color": COOL, "decay": "linear"}),
]


class Document:
    """A glTF document and its binary chunk."""

    def __init__(self):
        self.binary = bytearray()
        self.json = {"asset": {"version": "2.0", "generator": "scenes/src/lamps.py"}, "scene": 0,
                     "scenes": [{"nodes": []}]}

    def add(self, kind, value):
        self.json.setdefault(kind, []).append(value)
        return len(self.json[kind]) - 1

    def node(self, name, **value):
        self.json["scenes"][0]["nodes"].append(self.add("nodes", {"name": name, **value}))

    def accessor(self, rows, component, kind):
        flat = [v for row in rows for v in (row if isinstance(row, (list, tuple)) else [row])]
        data = struct.pack(f"<{len(flat)}{'f' if component == 5126 else 'I'}", *flat)
        view = self.add("bufferViews", {"buffer": 0, "byteOffset": len(self.binary), "byteLength": len(data)})
        self.binary.extend(data)
        value = {"bufferView": view, "componentType": component, "type": kind, "count": len(rows)}
        if kind == "VEC3":
            value["min"] = [min(row[i] for row in rows) for i in range(3)]
            value["max"] = [max(row[i] for row in rows) for i in range(3)]
        return self.add("accessors", value)

    def mesh(self, name, points, triangles, material, normals=None):
        attributes = {"POSITION": self.accessor(points, 5126, "VEC3")}
        if normals:
            attributes["NORMAL"] = self.accessor(normals, 5126, "VEC3")
        indices = self.accessor([i for t in triangles for i in t], 5125, "SCALAR")
        primitive = {"attributes": attributes, "indices": indices, "material": material}
        return self.add("meshes", {"name": name, "primitives": [primitive]})

    def material(self, name, color, metallic=0.0, roughness=0.5):
        pbr = {"baseColorFactor": [*color, 1.0], "metallicFactor": metallic, "roughnessFactor": roughness}
        return self.add("materials", {"name": name, "pbrMetallicRoughness": pbr, "doubleSided": True})

    def write(self, path):
        self.json["buffers"] = [{"byteLength": len(self.binary)}]
        text = json.dumps(self.json, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        out = struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(self.binary))
        out += struct.pack("<I4s", len(text), b"JSON") + text
        out += struct.pack("<I4s", len(self.binary), b"BIN\0") + self.binary
        path.write_bytes(out)


def ball(document, material):
    n = 32
    points = [
        (math.sin(i * math.pi / n) * math.cos(j * math.pi / n), math.cos(i * math.pi / n),
         math.sin(i * math.pi / n) * math.sin(j * math.pi / n))
        for i in range(n + 1) for j in range(2 * n)
    ]

    def at(i, j):
        return i * 2 * n + j % (2 * n)

    triangles = [t for i in range(n) for j in range(2 * n)
                 for t in ((at(i, j), at(i, j + 1), at(i + 1, j)), (at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)))]
    return document.mesh("ball", points, triangles, material, points)


def panel(document, material):
    """A unit square in the xz plane, facing up."""
    points = [(-0.5, 0, 0.5), (0.5, 0, 0.5), (0.5, 0, -0.5), (-0.5, 0, -0.5)]
    return document.mesh("panel", points, [(0, 1, 2), (0, 2, 3)], material)


def write_ies(path):
    """A lamp with two rings: 16 degrees wide, and a faint one at 50."""
    angles = list(range(0, 91, 2))
    candela = [1000 * math.exp(-(a / 16) ** 2) + 320 * math.exp(-((a - 50) / 5) ** 2) for a in angles]
    lines = ["IESNA:LM-63-2002", "[TEST] two rings", "TILT=NONE", f"1 -1 1 {len(angles)} 1 1 2 0 0 0", "1 1 0",
             " ".join(map(str, angles)), "0", " ".join(f"{c:.2f}" for c in candela)]
    path.write_text("\n".join(lines) + "\n")


def build(here, _folder):
    write_ies(here / "rings.ies")
    document = Document()
    wall = panel(document, document.material("wall", (0.72, 0.71, 0.69), roughness=1.0))
    brass = ball(document, document.material("brass", (0.85, 0.62, 0.28), metallic=1.0, roughness=0.25))
    clay = ball(document, document.material("clay", (0.62, 0.30, 0.22), roughness=0.7))
    half = math.sqrt(0.5)
    for i, (name, lamp) in enumerate(LAMPS):
        x, y = (i % 3 - 1) * SIDE, (1 - i // 3) * SIDE

        def place(dx, dy, dz):
            return [x + dx, y + dy, dz]

        square = {"mesh": wall, "scale": [SIDE, 1, SIDE]}
        document.node("floor", translation=place(0, -0.5 * SIDE, 0), **square)
        document.node("back", translation=place(0, 0, -0.5 * SIDE), rotation=[half, 0, 0, half], **square)
        for side in (-0.5, 0.5):
            document.node("side", translation=place(side * SIDE, 0, 0), rotation=[0, 0, half, half], **square)
        if i < 3:
            document.node("roof", translation=place(0, 0.5 * SIDE, 0), **square)
        document.node("ball", mesh=brass, translation=place(-0.38, -0.72, -0.25), scale=[0.28] * 3)
        document.node("ball", mesh=clay, translation=place(0.36, -0.78, 0.05), scale=[0.22] * 3)
        group = "warm" if lamp["color"] == WARM else "cool"
        extras = {"penumbra": {"light": lamp, "light_group": group, "visibility": {"camera": True}}}
        document.node(name, translation=place(0, 0.62, -0.15), rotation=DOWN, extras=extras)
    lens = {"yfov": math.radians(34), "aspectRatio": 1.0, "znear": 0.1}
    camera = document.add("cameras", {"type": "perspective", "perspective": lens})
    document.node("camera", camera=camera, translation=[0, 0, 11.2])
    document.write(here / "lamps.glb")
