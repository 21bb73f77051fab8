"""What the scene scripts share: materials, meshes of revolution, boxes, lights, cameras and the glTF export.

Lengths are metres, Blender's axes (z up); colours of materials are linear Rec.709.
"""
import json
import math
import pathlib
import struct

import bpy
import numpy as np
from mathutils import Matrix, Vector


def clear():
    """An empty file: no objects, no default materials."""
    bpy.ops.wm.read_factory_settings(use_empty=True)


# ---------------------------------------------------------------- materials


def material(name, color=(0.8, 0.8, 0.8), rough=0.5, metal=0.0, *, ior=1.5, transmission=0.0, coat=0.0,
             coat_rough=0.03, emission=None, strength=0.0, image=None, rough_image=None, normal=None, bump=1.0):
    """A Principled material, only with inputs that glTF carries. `rough_image` holds roughness in G, metalness in B."""
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    nodes, links = made.node_tree.nodes, made.node_tree.links
    bsdf = nodes["Principled BSDF"]
    bsdf.inputs["Base Color"].default_value = (*color, 1.0)
    bsdf.inputs["Roughness"].default_value = rough
    bsdf.inputs["Metallic"].default_value = metal
    bsdf.inputs["IOR"].default_value = ior
    bsdf.inputs["Transmission Weight"].default_value = transmission
    bsdf.inputs["Coat Weight"].default_value = coat
    bsdf.inputs["Coat Roughness"].default_value = coat_rough
    if emission is not None:
        bsdf.inputs["Emission Color"].default_value = (*emission, 1.0)
        bsdf.inputs["Emission Strength"].default_value = strength

    def texture(img, space):
        node = nodes.new("ShaderNodeTexImage")
        node.image = img
        img.colorspace_settings.name = space
        return node

    if image is not None:
        links.new(texture(image, "sRGB").outputs["Color"], bsdf.inputs["Base Color"])
    if rough_image is not None:
        split = nodes.new("ShaderNodeSeparateColor")
        links.new(texture(rough_image, "Non-Color").outputs["Color"], split.inputs["Color"])
        links.new(split.outputs["Green"], bsdf.inputs["Roughness"])
        links.new(split.outputs["Blue"], bsdf.inputs["Metallic"])
    if normal is not None:
        node = nodes.new("ShaderNodeNormalMap")
        node.inputs["Strength"].default_value = bump
        links.new(texture(normal, "Non-Color").outputs["Color"], node.inputs["Color"])
        links.new(node.outputs["Normal"], bsdf.inputs["Normal"])
    return made


# ---------------------------------------------------------------- meshes


def link(name, mesh, at=(0, 0, 0), turn=(0, 0, 0), scale=1.0):
    """Places a mesh; `turn` in degrees (XYZ Euler), `scale` a number or a triple."""
    thing = bpy.data.objects.new(name, mesh)
    thing.location = at
    thing.rotation_euler = [math.radians(a) for a in turn]
    thing.scale = (scale,) * 3 if np.isscalar(scale) else scale
    bpy.context.scene.collection.objects.link(thing)
    return thing


def mesh(name, points, faces, made, uvs=None, smooth=True, sharp=None):
    """A mesh. `uvs` is one pair per face corner; `sharp`: degrees above which an edge is drawn hard."""
    data = bpy.data.meshes.new(name)
    data.from_pydata([tuple(map(float, p)) for p in points], [], [tuple(map(int, f)) for f in faces])
    if uvs is not None:
        layer = data.uv_layers.new(name="UVMap")
        layer.data.foreach_set("uv", np.asarray(uvs, np.float32).ravel())
    data.polygons.foreach_set("use_smooth", [smooth] * len(data.polygons))
    if smooth and sharp is not None:
        data.set_sharp_from_angle(angle=math.radians(sharp))
    data.materials.append(made)
    data.validate()
    return data


def grid(name, points, made, uv_scale=(1.0, 1.0), wrap_u=False, sharp=None):
    """A mesh over points[v][u]; `wrap_u` joins the last column to the first."""
    points = np.asarray(points, float)
    rows, cols = points.shape[:2]
    faces, uvs = [], []
    for r in range(rows - 1):
        for c in range(cols if wrap_u else cols - 1):
            n = (c + 1) % cols
            faces.append((r * cols + c, r * cols + n, (r + 1) * cols + n, (r + 1) * cols + c))
            den = cols if wrap_u else cols - 1
            u0, u1 = c / den * uv_scale[0], (c + 1) / den * uv_scale[0]
            v0, v1 = r / (rows - 1) * uv_scale[1], (r + 1) / (rows - 1) * uv_scale[1]
            uvs += [(u0, v0), (u1, v0), (u1, v1), (u0, v1)]
    return mesh(name, points.reshape(-1, 3), faces, made, uvs, sharp=sharp)


def curve(points, count):
    """A Catmull-Rom curve through `points`, resampled to `count` points of equal arc length."""
    p = np.asarray(points, float)
    p = np.vstack([2 * p[0] - p[1], p, 2 * p[-1] - p[-2]])
    t = np.linspace(0, 1, 24, endpoint=False)[:, None]
    parts = []
    for i in range(1, len(p) - 2):
        a, b, c, d = p[i - 1:i + 3]
        parts.append(0.5 * (2 * b + (c - a) * t + (2 * a - 5 * b + 4 * c - d) * t**2 + (3 * b - a - 3 * c + d) * t**3))
    dense = np.vstack([*parts, p[-2][None]])
    length = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(dense, axis=0), axis=1))])
    at = np.linspace(0, length[-1], count)
    return np.stack([np.interp(at, length, dense[:, k]) for k in range(p.shape[1])], axis=1)


def lathe(name, profile, made, segments=48, uv_scale=(1.0, 1.0), wobble=0.0, seed=0, sharp=None):
    """Turns profile[(r, z)] about z, outside to the right of its direction of travel when it runs upward.

    `wobble` bends the form a little (relative), so that no two fruits are one.
    """
    profile = np.asarray(profile, float)
    a = np.linspace(0, 2 * np.pi, segments, endpoint=False)
    r = np.maximum(profile[:, :1], 1e-5)
    rng = np.random.default_rng(seed)
    bend = sum(rng.uniform(-1, 1) / k * np.cos(k * a + rng.uniform(0, 6.28)) for k in (1, 2, 3, 5))
    r = r * (1.0 + wobble * bend[None])
    z = np.broadcast_to(profile[:, 1:], r.shape)
    return grid(name, np.stack([r * np.cos(a), r * np.sin(a), z], axis=-1), made, uv_scale, True, sharp)


def tube(name, path, radius, made, segments=8):
    """A round tube along a path; `radius` is a number or one per point."""
    path = np.asarray(path, float)
    radius = np.broadcast_to(np.asarray(radius, float), (len(path),))
    tangents = np.gradient(path, axis=0)
    side = np.array([0.0, 1.0, 0.0]) if abs(tangents[0] @ (0, 1, 0)) < 0.9 * np.linalg.norm(tangents[0]) else np.array([1.0, 0, 0])
    rings = []
    a = np.linspace(0, 2 * np.pi, segments, endpoint=False)
    for p, t, r in zip(path, tangents, radius):
        t = t / np.linalg.norm(t)
        side = side - t * (side @ t)
        side /= np.linalg.norm(side)
        up = np.cross(t, side)
        rings.append(p + r * (np.cos(a)[:, None] * side + np.sin(a)[:, None] * up))
    return grid(name, np.array(rings), made, wrap_u=True)


def ball(name, radius, made, segments=32, rings=16):
    """A sphere about the origin."""
    t = np.linspace(0, np.pi, rings + 1)
    return lathe(name, np.stack([radius * np.sin(t), -radius * np.cos(t)], 1), made, segments)


def box(name, size, made, bevel=0.004, uv_size=1.0, seed=0, segments=2):
    """A box about the origin with rounded edges and flat faces; textures tile every `uv_size` metres, grain along
    the longest side."""
    sx, sy, sz = np.asarray(size, float) / 2
    points = [(x, y, z) for z in (-sz, sz) for y in (-sy, sy) for x in (-sx, sx)]
    faces = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    shift = np.random.default_rng(seed).uniform(0, 1, 2)
    uvs = []
    for face in faces:
        p = np.array([points[i] for i in face])
        flat = int(np.argmin(np.ptp(p, axis=0)))
        axes = sorted((i for i in range(3) if i != flat), key=lambda i: -size[i])
        uvs += [tuple(q[axes] / uv_size + shift) for q in p]
    data = mesh(name, points, faces, made, uvs, smooth=bevel > 0)
    if bevel:
        holder = bpy.data.objects.new(name, data)
        bpy.context.scene.collection.objects.link(holder)
        mod = holder.modifiers.new("Bevel", "BEVEL")
        mod.width, mod.segments, mod.harden_normals = bevel, segments, True
        data = baked(holder, name)
    return data


def baked(thing, name):
    """The object's mesh with its modifiers applied; the object itself is removed."""
    data = bpy.data.meshes.new_from_object(thing.evaluated_get(bpy.context.evaluated_depsgraph_get()))
    old = thing.data
    bpy.data.objects.remove(thing)
    bpy.data.meshes.remove(old)
    data.name = name
    return data


def cushion(name, size, made, power=0.35, cuts=12, uv_size=0.25):
    """A pillow: a superellipsoid-like box with bulging faces."""
    half = np.asarray(size, float) / 2
    points, faces, uvs, known = [], [], [], {}

    def vertex(p):
        key = tuple(np.round(p, 5))
        if key not in known:
            q = np.asarray(p, float)
            norm = np.sum(np.abs(q) ** (2 / power)) ** (power / 2)
            known[key] = len(points)
            points.append(q / norm * half * (1.0 + 0.10 * (1 - np.max(np.abs(np.delete(q, np.argmax(np.abs(q))))))))
        return known[key]

    line = np.tan(np.linspace(-np.pi / 4, np.pi / 4, cuts + 1))
    for axis in range(3):
        for sign in (-1.0, 1.0):
            for i in range(cuts):
                for j in range(cuts):
                    corners = [(line[i], line[j]), (line[i + 1], line[j]), (line[i + 1], line[j + 1]), (line[i], line[j + 1])]
                    if sign < 0:
                        corners.reverse()
                    ids = []
                    for a, b in corners:
                        p = np.zeros(3)
                        p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3] = sign, a, b
                        ids.append(vertex(p))
                        uvs.append((a * half[(axis + 1) % 3] / uv_size, b * half[(axis + 2) % 3] / uv_size))
                    faces.append(ids)
    return mesh(name, points, faces, made, uvs)


# ---------------------------------------------------------------- lights and cameras


def aim(at, target):
    """The rotation that looks from `at` along -z toward `target`, y up."""
    return (Vector(target) - Vector(at)).to_track_quat("-Z", "Y").to_euler()


def quad_light(name, at, target, size, color, radiance):
    """An emissive quad of `size` (width, height) facing `target`; radiance in W/(sr m^2) times `color`."""
    made = material(name, (0, 0, 0), 1.0, emission=color, strength=radiance)
    w, h = size[0] / 2, size[1] / 2
    data = mesh(name, [(-w, -h, 0), (-w, h, 0), (w, h, 0), (w, -h, 0)], [(0, 1, 2, 3)], made,
                [(0, 0), (0, 1), (1, 1), (1, 0)], smooth=False)
    thing = link(name, data, at)
    thing.rotation_euler = aim(at, target)
    return thing


def sun(name, toward, irradiance, color, angle):
    """A sun shining from direction `toward`. glTF has no angular size: `angle` (degrees) goes to the node's extras."""
    light = bpy.data.lights.new(name, "SUN")
    light.energy, light.color = irradiance, color
    light.angle = math.radians(angle)
    thing = bpy.data.objects.new(name, light)
    thing.rotation_euler = aim(toward, (0, 0, 0))
    thing["angle"] = math.radians(angle)
    bpy.context.scene.collection.objects.link(thing)
    return thing


def camera(at, target, lens, name="Camera"):
    """A 16:9 camera with a 36 mm wide sensor."""
    data = bpy.data.cameras.new(name)
    data.lens, data.clip_start, data.clip_end = lens, 0.02, 1000.0
    thing = bpy.data.objects.new(name, data)
    thing.location = at
    thing.rotation_euler = aim(at, target)
    scene = bpy.context.scene
    scene.collection.objects.link(thing)
    scene.camera = thing
    scene.render.resolution_x, scene.render.resolution_y = 1920, 1080
    return thing


# ---------------------------------------------------------------- export


def export(path):
    """Writes the open file as .glb: physical light units, modifiers applied, no animation."""
    bpy.ops.export_scene.gltf(
        filepath=str(path), export_format="GLB", export_apply=True, export_yup=True, export_cameras=True,
        export_lights=True, export_import_convert_lighting_mode="SPEC", export_image_format="AUTO",
        export_extras=True, export_animations=False)


def read_glb(path):
    """(JSON document, binary chunk) of a .glb file."""
    data = pathlib.Path(path).read_bytes()
    length = struct.unpack_from("<I", data, 12)[0]
    return json.loads(data[20:20 + length]), bytearray(data[28 + length:])


def write_glb(path, doc, blob):
    """Writes a .glb file out of a JSON document and its binary chunk."""
    blob = bytes(blob) + b"\0" * (-len(blob) % 4)
    doc["buffers"] = [{"byteLength": len(blob)}]
    text = json.dumps(doc, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    head = struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(blob))
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(blob), b"BIN\0") + blob
    pathlib.Path(path).write_bytes(head + chunks)


def add_instances(path, crowds):
    """Turns the nodes named in `crowds` into EXT_mesh_gpu_instancing nodes of an exported .glb.

    `crowds`: name -> (translations (n, 3), quaternions wxyz (n, 4), scales (n, 3)) in Blender's axes.
    """
    doc, blob = read_glb(path)

    def accessor(array, kind):
        blob.extend(b"\0" * (-len(blob) % 4))
        raw = np.ascontiguousarray(array, np.float32).tobytes()
        doc["bufferViews"].append({"buffer": 0, "byteOffset": len(blob), "byteLength": len(raw)})
        blob.extend(raw)
        doc["accessors"].append({"bufferView": len(doc["bufferViews"]) - 1, "componentType": 5126,
                                 "count": len(array), "type": kind})
        return len(doc["accessors"]) - 1

    for node in doc["nodes"]:
        if node.get("name") not in crowds or "mesh" not in node:
            continue
        t, q, s = crowds[node["name"]]
        for key in ("translation", "rotation", "scale"):
            node.pop(key, None)
        node.setdefault("extensions", {})["EXT_mesh_gpu_instancing"] = {"attributes": {
            "TRANSLATION": accessor(np.stack([t[:, 0], t[:, 2], -t[:, 1]], 1), "VEC3"),
            "ROTATION": accessor(np.stack([q[:, 1], q[:, 3], -q[:, 2], q[:, 0]], 1), "VEC4"),
            "SCALE": accessor(np.stack([s[:, 0], s[:, 2], s[:, 1]], 1), "VEC3")}}
    for key in ("extensionsUsed", "extensionsRequired"):
        doc[key] = sorted({*doc.get(key, []), "EXT_mesh_gpu_instancing"})
    write_glb(path, doc, blob)
