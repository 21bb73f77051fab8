"""Writes a case as a .glb with lights in `extras.penumbra` and renders it with the penumbra program."""

import json
import struct
import subprocess

import numpy as np

import images
import scenes

Y_UP = [1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1]
"""Blender's (x, y, z) to glTF's (x, z, −y), by columns: the node under which everything stands."""


def write(case, folder):
    """Path of the scene's file."""
    writer = Writer()
    nodes = [writer.object(thing) for thing in case.objects]
    nodes += [node(lamp.matrix, extras=light(lamp)) for lamp in case.lamps]
    nodes.append(node(scenes.look(case.eye, case.at), camera=0))
    root = {"name": "z up", "matrix": Y_UP, "children": list(range(len(nodes)))}
    nodes.append(root)
    if case.world is not None:
        # A dome's own up is +y, so it is at home in glTF's world.
        dome = {"type": "dome", "radiance": 1.0, "color": list(case.world)}
        if case.image is not None:
            dome["image"] = images.write_sky(case, folder).name
        nodes.append({"name": "world", "extras": {"penumbra": {"light": dome}}})
    angle = np.radians(case.fov)
    document = {
        "asset": {"version": "2.0"},
        "extensionsUsed": ["KHR_materials_specular", "KHR_materials_emissive_strength"],
        "scene": 0,
        "scenes": [{"nodes": list(range(nodes.index(root), len(nodes)))}],
        "nodes": nodes,
        "cameras": [{"type": "perspective", "perspective": {"aspectRatio": 1.0, "yfov": angle, "znear": 0.01}}],
        **writer.tables,
        "buffers": [{"byteLength": len(writer.data)}],
    }
    file = folder / "scene.glb"
    file.write_bytes(glb(document, bytes(writer.data)))
    return file


def node(matrix, **rest):
    return {"matrix": np.asarray(matrix, float).T.ravel().tolist(), **rest}


def light(lamp):
    """As docs/gltf.md describes it. Blender's lamps are hidden from the camera."""
    it = {"color": list(lamp.color)}
    if lamp.kind == "sun":
        it |= {"type": "distant", "irradiance": lamp.power, "angle": lamp.angle}
    elif lamp.kind in ("rect", "disk"):
        width, height = lamp.size
        it |= {"type": lamp.kind, "power": lamp.power, "width": width, "height": height, "spread": lamp.spread}
    elif lamp.radius > 0:
        it |= {"type": "sphere", "power": lamp.power, "radius": lamp.radius, "facing": lamp.soft}
    else:
        it |= {"type": "point", "power": lamp.power}
    if lamp.kind == "spot":
        it["cone"] = {"angle": lamp.angle / 2, "blend": lamp.blend}
    return {"penumbra": {"light": it, "visibility": {"camera": False}}}


class Writer:
    """The tables of a glTF file that grow with its objects, each mesh and material once."""

    def __init__(self):
        self.data = bytearray()
        self.tables = {"bufferViews": [], "accessors": [], "materials": [], "meshes": []}
        self.known = {}

    def object(self, thing):
        key = ("mesh", id(thing.mesh[0]), thing.color, thing.emission)
        return node(thing.matrix, mesh=self.once(key, self.mesh, thing))

    def once(self, key, make, *what):
        if key not in self.known:
            self.known[key] = make(*what)
        return self.known[key]

    def add(self, table, item):
        self.tables[table].append(item)
        return len(self.tables[table]) - 1

    def mesh(self, thing):
        vertices, triangles = thing.mesh
        bounds = {"min": vertices.min(0).tolist(), "max": vertices.max(0).tolist()}
        positions = self.once(("vertices", id(vertices)), self.accessor, vertices, np.float32, "VEC3", 5126, bounds)
        indices = self.once(("triangles", id(vertices)), self.accessor, triangles, np.uint32, "SCALAR", 5125, {})
        material = self.once(("material", thing.color, thing.emission), self.material, thing)
        primitive = {"attributes": {"POSITION": positions}, "indices": indices, "material": material}
        return self.add("meshes", {"primitives": [primitive]})

    def accessor(self, array, dtype, kind, component, rest):
        raw = np.ascontiguousarray(array, dtype).tobytes()
        view = self.add("bufferViews", {"buffer": 0, "byteOffset": len(self.data), "byteLength": len(raw)})
        self.data += raw
        count = len(array) if kind == "VEC3" else array.size
        shape = {"bufferView": view, "componentType": component, "count": count, "type": kind}
        return self.add("accessors", {**shape, **rest})

    def material(self, thing):
        """Lambert's law alone: no metal and no specular."""
        pbr = {"baseColorFactor": [*thing.color, 1.0], "metallicFactor": 0.0, "roughnessFactor": 1.0}
        it = {"pbrMetallicRoughness": pbr, "extensions": {"KHR_materials_specular": {"specularFactor": 0.0}}}
        if thing.emission:
            it["emissiveFactor"] = [1.0, 1.0, 1.0]
            it["extensions"]["KHR_materials_emissive_strength"] = {"emissiveStrength": thing.emission}
        return self.add("materials", it)


def glb(document, data):
    """The container: header, JSON padded with spaces, data padded with zeros."""
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    data += b"\0" * (-len(data) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(data), b"BIN\0") + data
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def render(case, folder, spp, seeds, threads, program):
    """Always anew: the program changes."""
    scene = write(case, folder)
    for seed in range(seeds):
        command = [program, "render", scene, "-o", images.path(folder, "penumbra", spp, seed), "--strict"]
        command += ["--passes", "combined,diffuse_direct", "--filter", "box", "--max-bounces", 0, "--progress", "none"]
        command += ["--size", f"{scenes.SIZE}x{scenes.SIZE}", "--spp", spp, "--seed", seed, "--threads", threads]
        done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
        if done.returncode:
            raise RuntimeError(f"{case.name}: {done.stderr.strip()}")
