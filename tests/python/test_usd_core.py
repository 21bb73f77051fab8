"""Stages as Penumbra reads them, against OpenUSD itself (usd-core): prim by prim world transforms, points,
UVs, bindings, lights, cameras and visibility."""

import json
import math
import os
import subprocess
import sys
from collections import defaultdict
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("pxr", reason="usd-core is not installed")
from pxr import Tf, Usd, UsdGeom, UsdLux  # noqa: E402
from usd_judge import LIGHTS, Stage  # noqa: E402

ROOT = Path(__file__).resolve().parents[2]
PENUMBRA = ROOT / os.environ.get("PENUMBRA", "target/debug/penumbra")
ASSETS = Path(os.environ.get("PENUMBRA_ASSETS", ROOT.parent / "shared/assets")) / "usd"
STAGES = sorted([*ASSETS.rglob("*.usd*"), *(ROOT / "tests/usd/stages").glob("*.usd*")])

# Stages that OpenUSD itself does not answer for, or where it is known to answer something else.
NOT_JUDGED = {
    "timeCodesPerSecond_0.usda": "usd-core never ends",
    "bad.usda": "OpenUSD drops a point instancer with one wrong index, we keep the others; tests/usd/bad.rs has it",
}


def read(path, *args):
    """Penumbra's answer: its JSON, and by path what it warned of."""
    command = [PENUMBRA, "info", path, "--json", "--values", "--subdivision", "0", *args]
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


class Answer:
    """What Penumbra says, by the path of the prim."""

    def __init__(self, info):
        values = info["values"]
        self.meshes, self.rounds, self.warnings = values["meshes"], values["rounds"], info["warnings"]
        by_place = lambda things: {thing["place"]: thing for thing in things}
        self.lights, self.cameras = by_place(values["lights"]), by_place(values["cameras"])
        self.materials = values["materials"]
        self.instances = defaultdict(list)
        for instance in values["instances"]:
            self.instances[instance["place"]].append(instance)

    def shutter(self):
        """From when to when a camera's shutter is open; `None` where it is for an instant."""
        open_for = [camera["shutter"] for camera in self.cameras.values() if camera["shutter"][0] < camera["shutter"][1]]
        return [min(o for o, _ in open_for), max(c for _, c in open_for)] if open_for else None

    def warned(self, path, *words):
        """True where something was said of the prim or one of its properties, with one of `words` in it."""
        of_prim = [warning for warning in self.warnings if any(f", {path}{end}" in warning for end in (":", "."))]
        return any(not words or any(word in warning for word in words) for warning in of_prim)


def near(found, expected, tolerance=1e-6):
    found, expected = np.asarray(found, dtype=float), np.asarray(expected, dtype=float)
    scale = max(1e-12, np.abs(expected).max()) if expected.size else 1.0
    return found.shape == expected.shape and (np.abs(found - expected) <= tolerance * scale).all()


def rows(values, digits=5):
    """The distinct rows, sorted, to `digits` of the largest number."""
    values = np.asarray(values, dtype=float)
    scale = max(np.abs(values).max(initial=0.0), 1e-30)
    return np.unique(np.round(values / scale, digits) + 0.0, axis=0)


class Differences(list):
    def check(self, ok, path, what):
        if not ok:
            self.append(f"{path}: {what}")


def judge(path, *args, frame=None, interpolation=None, info=None):
    """All differences between Penumbra, which said `info`, and OpenUSD at the stage `path`."""
    stage, answer, found = Stage(path, frame, interpolation), Answer(info or read(path, *args)), Differences()
    judge_shapes(stage, answer, found)
    judge_lights(stage, answer, found)
    judge_cameras(stage, answer, found)
    return found


def judge_shapes(stage, answer, found):
    left = dict(answer.instances)
    for prim in stage.gprims():
        path = str(prim.GetPath())
        instances = left.pop(path, [])
        is_mesh = prim.GetTypeName() == "Mesh"
        faces = stage.faces(prim) if is_mesh else None
        if not instances:
            nothing = is_mesh and faces is not None and not faces[1]
            left_out = nothing or answer.warned(path, "left out")
            found.check(left_out, path, "is not there, and nothing was said of it")
            continue
        if len(instances) == 1:
            world = stage.world(prim)
            if not near(world[:, 3], [0, 0, 0, 1]):
                found.check(answer.warned(path, "projective"), path, "is projected, and nothing was said of it")
                world[:, 3] = [0, 0, 0, 1]
            ours = np.reshape(instances[0]["matrix"], (4, 4))
            found.check(near(ours, world), path, f"stands at\n{ours}\nand not at\n{world}")
            judge_motion(stage, prim, instances[0], answer, found)
        if is_mesh and faces is not None:
            judge_mesh(stage, prim, faces, instances[0], answer, found)
        if prim.GetTypeName() in ("Points", "BasisCurves") and not answer.warned(path, "value", "point", "curve"):
            judge_rounds(stage, prim, instances[0], answer, found)
    judge_stand_ins(stage, answer, left, found)
    expected = stage.instanced()
    if expected is not None:
        row = lambda matrix, color: np.concatenate([np.reshape(matrix, 16), color])
        ours = [row(i["matrix"], i["color"] or np.zeros(4)) for instances in left.values() for i in instances]
        expected = [row(matrix, color) for matrix, color in expected]
        same = len(ours) == len(expected) and near(rows(ours), rows(expected), 2e-5) if ours or expected else True
        found.check(same, "/", f"{len(ours)} other instances ({sorted(left)[:5]}), not the {len(expected)} of USD")


def judge_motion(stage, prim, ours, answer, found):
    """Where `ours` is at other times of the shutter."""
    path, motion, shutter = str(prim.GetPath()), ours["motion"], answer.shutter()
    if shutter is None or stage.time == Usd.TimeCode.EarliestTime():
        return found.check(not motion, path, "moves, though no shutter is open")
    if stage.has_skeleton(prim):
        return None
    world = stage.world(prim)
    if not motion:
        stays = all(near(stage.world_at(prim, t), world) for t in np.linspace(*shutter, 9))
        return found.check(stays, path, "does not move")
    found.check([motion[0]["time"], motion[-1]["time"]] == shutter, path, "does not move for all of the shutter")
    # What turns the space of the prim into that of our lights.
    own = np.reshape(ours["matrix"], (4, 4)) @ np.linalg.inv(world)
    for key in motion:
        expected, matrix = own @ stage.world_at(prim, key["time"]), np.reshape(key["matrix"], (4, 4))
        found.check(near(matrix, expected), path, f"is at\n{matrix}\nnot\n{expected} after {key['time']} frames")


def judge_deformation(stage, prim, used, motion, answer, found):
    """Where the points `used` of a mesh are at other times of the shutter; those of triangles without area are left out."""
    path, shutter = str(prim.GetPath()), answer.shutter()
    if shutter is None or stage.time == Usd.TimeCode.EarliestTime():
        return found.check(not motion, path, "deforms, though no shutter is open")
    times = [key["time"] for key in motion] or list(np.linspace(*shutter, 5))
    if stage.has_skeleton(prim):
        return
    now = stage.points_at(prim, 0)
    for i, time in enumerate(times):
        theirs = stage.points_at(prim, time)
        if not motion:
            found.check(near(theirs, now), path, "does not deform")
            continue
        ours = np.array(motion[i]["points"], dtype=np.float32).reshape(-1, 3)[used]
        # Each of ours is one of theirs, with its own way since the frame.
        off = np.abs(ours[:, None] - theirs[None]).max(axis=-1).min(axis=1).max()
        found.check(off <= 1e-5 * np.abs(theirs).max(), path, f"has points {off} off after {time} frames")


def judge_stand_ins(stage, answer, left, found):
    for prim in stage.stand_ins():
        path, mode = str(prim.GetPath()), stage.draw_mode(prim)
        instances = left.pop(path, [])
        if len(instances) != 1:
            found.check(False, path, f"is drawn as {mode} by {len(instances)} instances")
            continue
        world = stage.world(prim)
        found.check(near(np.reshape(instances[0]["matrix"], (4, 4)), world), path, "stands elsewhere")
        points = np.array(answer.meshes[instances[0]["mesh"]]["points"], dtype=float)
        ours = np.array([points.min(axis=0), points.max(axis=0)])
        expected = np.array([[0.0] * 3, [1.0] * 3]) if mode == "origin" else stage.bounds(prim)
        thickness = np.linalg.norm(expected[1] - expected[0]) / 200
        # Cards across the middle reach no further than those that are there.
        ok = (expected[0] - thickness <= ours[0]).all() and (ours[1] <= expected[1] + thickness).all()
        tight = np.abs(ours - expected).max() <= thickness or mode == "cards"
        found.check(ok and tight, path, f"is drawn as {mode} within\n{ours}\nnot\n{expected}")


def judge_rounds(stage, prim, instance, answer, found):
    path, rounds = str(prim.GetPath()), instance["rounds"]
    if prim.GetTypeName() == "BasisCurves":
        expected = stage.strands(prim)
        if expected is None:
            return found.check(instance["mesh"] is not None, path, "is no ribbon")
    if rounds is None:
        return found.check(False, path, "is no set of strands or balls")
    rounds = answer.rounds[rounds]
    balls = np.column_stack([rounds["points"], rounds["radii"]])
    color = UsdGeom.PrimvarsAPI(prim).FindPrimvarWithInheritance("displayColor")
    if prim.GetTypeName() == "Points":
        expected = stage.balls(prim)
        found.check(near(balls, expected), path, f"has the balls\n{balls}\nand not\n{expected}")
        if rounds["colors"] and color and color.HasValue() and len(expected) == len(color.ComputeFlattened(stage.time)):
            colors = np.array(rounds["colors"])[:, :3]
            found.check(near(colors, color.ComputeFlattened(stage.time)), path, "has other colours")
        return
    ends = [strand["end"] for strand in rounds["strands"]]
    found.check(len(ends) == len(expected), path, f"has {len(ends)} strands, not {len(expected)}")
    for ours, strand, (theirs, closed) in zip(np.split(balls, ends), rounds["strands"], expected):
        size = np.ptp(theirs[:, :3], axis=0).max() + theirs[:, 3].max()
        found.check(strand["closed"] == closed, path, "is closed or open where it should not be")
        # Ours lie on the curve, and the curve is nowhere far from ours.
        off = np.abs(theirs[None] - ours[:, None]).max(axis=-1).min(axis=1).max()
        found.check(off < 0.02 * size, path, f"has a point {off} off its curve")
        chain = np.concatenate([ours, ours[:1]]) if closed else ours
        gap = distance_from_chain(theirs[:, :3], chain[:, :3]).max()
        allowed = 0.06 * np.max(theirs[:, 3]) + 1e-4 * size
        found.check(gap < allowed, path, f"leaves its curve by {gap}, more than {allowed}")
        starts = near(ours[0], theirs[0], 1e-5) and (closed or near(ours[-1], theirs[-1], 1e-5))
        found.check(starts, path, "starts or ends elsewhere")


def distance_from_chain(points, chain):
    a, step = chain[:-1], np.diff(chain, axis=0)
    t = np.einsum("pck,ck->pc", points[:, None] - a, step) / np.maximum((step**2).sum(-1), 1e-30)
    nearest = a + np.clip(t, 0, 1)[..., None] * step
    return np.linalg.norm(points[:, None] - nearest, axis=-1).min(axis=1)


def judge_mesh(stage, prim, faces, instance, answer, found):
    path, mesh = str(prim.GetPath()), answer.meshes[instance["mesh"]]
    points, kept = faces
    corners = np.concatenate([corners for _, corners in kept] or [np.zeros(0, int)])
    triangles = np.array(mesh["triangles"], dtype=int).reshape(-1, 3)
    ours = np.array(mesh["points"], dtype=np.float32).reshape(-1, 3)
    warned = answer.warned(path, "face", "point", "corner", "left out")
    count = sum(len(corners) - 2 for _, corners in kept)
    found.check(len(triangles) == count, path, f"has {len(triangles)} triangles, not {count}")
    if not warned:
        same = near(rows(ours[triangles.ravel()]), rows(points[corners]), 2e-5)
        found.check(same, path, "has other points")
        # The vector area of a polygon does not depend on how it is cut.
        area = lambda p: 0.5 * np.cross(p, np.roll(p, -1, axis=-2)).sum(axis=-2)
        sums = area(ours[triangles].astype(float)).sum(axis=0)
        expected = sum((area(points[corners].astype(float)) for _, corners in kept), np.zeros(3))
        if UsdGeom.Gprim(prim).GetOrientationAttr().Get(stage.time) == UsdGeom.Tokens.leftHanded:
            expected = -expected
        size = np.abs(area(ours[triangles].astype(float))).sum()
        found.check(np.abs(sums - expected).max() <= 1e-5 * max(size, 1e-30), path, f"faces {sums}, not {expected}")
        judge_deformation(stage, prim, np.unique(triangles), mesh["motion"], answer, found)
        judge_primvars(stage, prim, kept, points[corners], ours[triangles].reshape(-1, 3), triangles, mesh, found)
    if prim.HasAPI(UsdLux.LightAPI):
        return
    slots = set(mesh["material_slots"] or [0])
    used = [instance["materials"][slot] for slot in slots if slot < len(instance["materials"])]
    is_material = lambda m: m and m["place"] and stage.has_surface(stage.stage.GetPrimAtPath(m["place"]))
    names = {m["name"] for m in used if is_material(m)}
    expected = {material.GetName() for material in stage.materials(prim, kept)}
    found.check(names == expected, path, f"has the materials {names}, not {expected}")


def judge_primvars(stage, prim, kept, points, ours, triangles, mesh, found):
    """UVs, normals and colours of every corner, wherever it lies; `ours` are the points of the triangles."""

    def judge(what, values, expected):
        if values is None or expected is None:
            return
        flat = np.array(values["values"], dtype=float).reshape(-1, expected.shape[1])
        flat = flat[triangles.ravel()] if values["per"] == "point" else flat
        found.check(len(flat) == len(ours), path, f"has {len(flat)} {what} for {len(ours)} corners")
        pairs = lambda points, values: rows(np.hstack([points / size, values / np.abs(expected).max()]), 4)
        same = len(flat) == len(ours) and near(pairs(ours, flat), pairs(points, expected), 3e-4)
        found.check(same, path, f"has other {what}")

    path, size = str(prim.GetPath()), max(np.abs(points).max(), 1e-30)
    uvs = stage.corners(prim, kept, "st", 2)
    # The image's top row is v = 0 in Penumbra.
    judge("UVs", mesh["uvs"][0] if mesh["uvs"] else None, uvs if uvs is None else uvs * [1, -1] + [0, 1])
    normals = stage.normal_corners(prim, kept)
    found.check(normals is None or mesh["normals"] is not None, path, "lost its normals")
    judge("normals", mesh["normals"], normals)
    colors, opacities = stage.corners(prim, kept, "displayColor", 3), stage.corners(prim, kept, "displayOpacity", 1)
    if colors is not None or opacities is not None:
        colors = np.full((len(points), 3), 0.5) if colors is None else np.maximum(colors, 0.0)
        opacities = np.ones((len(points), 1)) if opacities is None else np.clip(opacities, 0.0, 1.0)
        judge("colours", mesh["colors"], np.hstack([colors, opacities]))


def judge_lights(stage, answer, found):
    left = dict(answer.lights)
    for prim in stage.of_type(*LIGHTS):
        path, light = str(prim.GetPath()), left.pop(str(prim.GetPath()), None)
        if not stage.visible(prim):
            found.check(light is None, path, "is invisible and shines")
            continue
        if light is None:
            found.check(False, path, "is no light")
            continue
        expected, kind = stage.light(prim), light["kind"]
        # Sums over a profile are those of another rule.
        tolerance = 1e-4 if stage.ies(prim) else 1e-6
        for key, value in expected.items():
            same = kind[key] == value if key == "kind" else key in kind and near(kind[key], value, tolerance)
            found.check(same, path, f"{key} is {kind.get(key)}, not {value}")
        judge_image(stage, prim, kind, found)
        matrix = np.reshape(light["matrix"], (4, 4))
        if kind["kind"] == "dome":
            # Ours: the centre is +x, the left quarter −z, the top +y.
            ours = np.array([matrix[0], -matrix[2], matrix[1]])[:, :3]
            ours /= np.linalg.norm(ours, axis=1, keepdims=True)
            expected = stage.dome_directions(prim)
            found.check(near(ours, expected), path, f"its image lies to\n{ours}\nnot\n{expected}")
            judge_shadow(stage, prim, light["links"], found)
            judge_motion(stage, prim, light, answer, found)
            continue
        found.check(near(matrix, stage.world(prim)), path, f"stands at\n{matrix}\nand not at\n{stage.world(prim)}")
        judge_motion(stage, prim, light, answer, found)
        judge_shaping(stage, prim, light, found)
        judge_shadow(stage, prim, light["links"], found)
    judge_shining(stage, answer, found)


def judge_shaping(stage, prim, light, found):
    path, shaping, cone = str(prim.GetPath()), stage.shaping(prim), light["shaping"]["cone"]
    if shaping is None or light["kind"]["kind"] == "distant":
        found.check(cone is None, path, f"has the cone {cone}, and no ShapingAPI")
        return
    angle, softness, focus, tint = shaping
    found.check(near(light["shaping"]["focus"], max(focus, 0.0)), path, f"focus is not {focus}")
    ours = light["shaping"]["focus_tint"]
    found.check(near(ours, tint if focus > 0 else np.zeros(3)), path, f"the tint is {ours}, not {tint}")
    judge_ies(stage.ies(prim), light["shaping"]["ies"], path, found)
    if cone is not None:
        soft = "blend" if stage.blender else "softness"
        same = near([cone["angle"], cone[soft]], [math.radians(angle), min(max(softness, 0.0), 1.0)])
        found.check(same, path, f"has the cone {cone}, not {angle} degrees, {softness}")
    else:
        flat = light["kind"]["kind"] in ("rect", "disk")
        found.check(softness <= 0 and angle >= (90 if flat else 180), path, f"lost its cone of {angle} degrees")


def judge_image(stage, prim, kind, found):
    """The image of a light; domes whose image is not lat-long have one of that name that is."""
    file = prim.GetAttribute("inputs:texture:file").Get(stage.time) if prim.HasAttribute("inputs:texture:file") else None
    name = os.path.basename(file.path) if file and file.resolvedPath else None
    ours = kind.get("image") and os.path.basename(kind["image"].rstrip("]").replace("[", "/"))
    found.check(ours == name or not ours and not file, str(prim.GetPath()), f"shows {ours}, not {name}")


def judge_ies(expected, ies, path, found):
    """Its factor is part of the emission."""
    if expected is None or ies is None:
        return found.check(expected is None and ies is None, path, f"has the profile {ies}, not {expected}")
    same = ies["profile"] == expected[0] and near(ies["angle_scale"], expected[1]) and not ies["keep_power"]
    return found.check(same, path, f"has the profile {ies}, not {expected}")


def judge_shadow(stage, prim, links, found):
    path, (casts, shadow) = str(prim.GetPath()), stage.shadow(prim)
    found.check(links["cast_shadow"] == casts or stage.blender, path, f"cast_shadow is {links['cast_shadow']}")
    ours = links["shadow"]
    for key, value in zip(("color", "distance", "falloff", "gamma"), shadow):
        mine = math.inf if ours[key] is None else ours[key]
        same = mine == value if np.ndim(value) == 0 and math.isinf(value) else near(mine, value)
        found.check(same, path, f"{key} of its shadows is {ours[key]}, not {value}")


def judge_shining(stage, answer, found):
    """Shapes that are lights."""
    for path, (light, own) in stage.shining().items():
        instances, shape = answer.instances.get(str(path), []), stage.stage.GetPrimAtPath(path)
        if len(instances) != 1 or not instances[0]["materials"]:
            continue
        name, instance = str(light.GetPath()), instances[0]
        judge_shadow(stage, light, instance["links"], found)
        expected = stage.glow(light, shape, own)
        if expected is None or len(instance["materials"]) != 1 or not instance["materials"][0]:
            continue
        material = answer.materials[instance["materials"][0]["index"]]
        ours = np.array(material["emission"]["factor"]) * material["emission_strength"]
        found.check(near(ours, expected[0], 1e-5), name, f"it shines with {ours}, not {expected[0]}")
        black = material["base_color"]["factor"] == [0, 0, 0] and material["specular"]["factor"] == 0
        found.check(black or not expected[1], name, "its material responds to light")


def judge_cameras(stage, answer, found):
    left = dict(answer.cameras)
    for prim in stage.of_type("Camera"):
        path, camera = str(prim.GetPath()), left.pop(str(prim.GetPath()), None)
        if camera is None:
            found.check(False, path, "is no camera")
            continue
        expected = stage.camera(prim)
        found.check(near(np.reshape(camera["matrix"], (4, 4)), stage.world(prim)), path, "stands elsewhere")
        judge_motion(stage, prim, camera, answer, found)
        for key in ("clip_near", "clip_far", "shift", "shutter", "exposure"):
            same = near(camera[key] if camera[key] is not None else math.inf, expected[key])
            found.check(same, path, f"{key} is {camera[key]}, not {expected[key]}")
        for key in ("projection", "lens"):
            for name, value in (expected[key] or {}).items():
                ours = (camera[key] or {}).get(name)
                found.check(ours is not None and near(ours, value), path, f"{name} is {ours}, not {value}")
        found.check(expected["lens"] is not None or camera["lens"] is None, path, "has a lens")


@pytest.mark.parametrize("path", STAGES, ids=lambda path: "/".join(path.parts[-3:]))
def test_stages_are_read_as_openusd_reads_them(path):
    if path.name in NOT_JUDGED:
        pytest.skip(NOT_JUDGED[path.name])
    try:
        Stage(path)
    except Tf.ErrorException as error:
        pytest.skip(f"usd-core does not open it: {str(error).splitlines()[0]}")
    found = judge(path)
    assert not found, "\n".join(found[:20])


@pytest.mark.parametrize("frame", [None, 2.5, 3, 4.25, 5])
def test_joints_and_blend_shapes_move_points_as_openusd_has_it(frame):
    path = ROOT / "tests/usd/stages/skel.usda"
    args = [] if frame is None else ["--frame", frame]
    found = judge(path, *args, frame=frame)
    assert not found, "\n".join(found)
    stage, answer, judged = Stage(path, frame), Answer(read(path, *args)), 0
    for prim in stage.of_type("Mesh"):
        (instance,) = answer.instances[str(prim.GetPath())]
        mesh = answer.meshes[instance["mesh"]]
        to_world = lambda points, matrix: np.asarray(points, dtype=float) @ matrix[:3, :3] + matrix[3, :3]
        ours = to_world(mesh["points"], np.reshape(instance["matrix"], (4, 4)))
        points, faces = stage.faces(prim)
        expected = to_world(points, stage.world(prim))
        assert np.abs(ours - expected).max() <= 1e-5 * np.ptp(expected, axis=0).max(), prim
        normals = np.array(UsdGeom.Mesh(prim).GetNormalsAttr().Get(stage.time) or [], dtype=float)
        if len(normals) == 0:
            continue
        corners = np.concatenate([corners for _, corners in faces])
        by_corner = len(normals) == len(corners)
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        at_points = {point: normals[corners == point] if by_corner else normals[[point]] for point in range(len(points))}
        # Where normals are those of points, so are ours.
        used = np.ravel(mesh["triangles"]) if by_corner else np.arange(len(points))
        for point, normal in zip(used, mesh["normals"]["values"], strict=True):
            assert np.abs(at_points[point] - normal).max(axis=1).min() < 1e-5, f"{prim}: {point} has {normal}"
        judged += 1
    assert judged >= 6


HEAD = '#usda 1.0\n(\n    metersPerUnit = 0.1\n    upAxis = "Z"\n    startTimeCode = 3\n    endTimeCode = 9\n{}\n)\n'

MESH = """
    int[] faceVertexCounts = [4, 3]
    int[] faceVertexIndices = [0, 1, 2, 3, 1, 4, 2]
    point3f[] points = [(0, 0, 0), (1, 0, 0), (1, 1, 0.5), (0, 1, 0), (2, 0, 1)]
    texCoord2f[] primvars:st = [(0, 0), (1, 0), (1, 1), (0, 1), (0.5, 0.25)] (interpolation = "vertex")
    uniform token subdivisionScheme = "none"
"""



def material(path):
    return f"""
    def Material "{path.split("/")[-1]}" {{
        token outputs:surface.connect = <{path}/Shader.outputs:surface>
        def Shader "Shader" {{
            uniform token info:id = "UsdPreviewSurface"
            token outputs:surface
        }}
    }}
    """


FLAT = MESH.replace("(1, 1, 0.5)", "(1, 1, 0)")

# The cosine of the angle to the axis, times 7 candela, up to a right angle.
COSINE = "IESNA:LM-63-2002\nTILT=NONE\n1 1000 2 181 1 1 2 0 0 0 1 1 1\n{}\n0\n{}\n".format(
    " ".join(str(i / 2) for i in range(181)),
    " ".join(f"{3.5 * math.cos(math.radians(i / 2)):.9f}" for i in range(181)),
)

CASES = {
    "instances": {
        "root.usda": HEAD.format("")
        + """
        def Mesh "One" (instanceable = true; references = @asset.usda@</Mesh>) {}
        def Mesh "Two" (instanceable = true; references = @asset.usda@</Mesh>) {
            double3 xformOp:translate = (1, 2, 3)
            uniform token[] xformOpOrder = ["xformOp:translate"]
        }
        def SphereLight "Lamp" (instanceable = true; references = @asset.usda@</Lamp>) {}
        def Camera "View" (instanceable = true; references = @asset.usda@</View>) {}
        def PointInstancer "Row" (instanceable = true; references = @asset.usda@</Row>) {
            double3 xformOp:translate = (0, 7, 0)
            uniform token[] xformOpOrder = ["xformOp:translate"]
        }
        def PointInstancer "Out" {
            rel prototypes = </Out/Tile>
            int[] protoIndices = [0, 0]
            point3f[] positions = [(1, 2, 3), (4, 5, 6)]
            def Mesh "Tile" (instanceable = true; references = @asset.usda@</Mesh>) {}
        }
        """,
        "asset.usda": """#usda 1.0
        def Mesh "Mesh" {""" + MESH + """
            def Mesh "Below" {""" + MESH + """}
        }
        def SphereLight "Lamp" { float inputs:radius = 2 }
        def Camera "View" { float focalLength = 30 }
        def PointInstancer "Row" {
            rel prototypes = </Row/Tile>
            int[] protoIndices = [0, 0]
            point3f[] positions = [(1, 0, 0), (2, 0, 0)]
            def Mesh "Tile" {""" + MESH + """}
        }
        """,
    },
    "clips": {
        "root.usda": HEAD.format("")
        + """
        def Mesh "Sets" (
            clips = {
                dictionary a = {
                    asset[] assetPaths = [@c.03.usda@]
                    asset manifestAssetPath = @manifest.usda@
                    string primPath = "/M"
                    double2[] active = [(0, 0)]
                    double2[] times = [(0, 0), (10, 10)]
                }
                dictionary b = {
                    asset[] assetPaths = [@c.06.usda@]
                    asset manifestAssetPath = @manifest.usda@
                    string primPath = "/M"
                    double2[] active = [(0, 0)]
                    double2[] times = [(0, 0), (10, 10)]
                }
            }
        ) {""" + MESH + """}
        def Mesh "Holes" (
            clips = {
                dictionary default = {
                    string templateAssetPath = "./c.##.usda"
                    double templateStartTime = 2
                    double templateEndTime = 8
                    double templateStride = 1
                    double templateActiveOffset = 0.5
                    string primPath = "/M"
                }
            }
        ) {
            double3 xformOp:translate
            uniform token[] xformOpOrder = ["xformOp:translate"]
        """ + MESH + """}
        """,
        "manifest.usda": """#usda 1.0
        over "M" { token visibility
        }
        """,
        "c.03.usda": """#usda 1.0
        over "M" {
            token visibility.timeSamples = { 3: "inherited", 5: "invisible" }
            double3 xformOp:translate.timeSamples = { 3: (3, 0, 0) }
        }
        """,
        "c.06.usda": """#usda 1.0
        over "M" {
            token visibility.timeSamples = { 3: "invisible", 5: "inherited" }
            double3 xformOp:translate.timeSamples = { 6: (6, 0, 0), 9: (0, 9, 0) }
        }
        """,
    },
    "composition": {
        "root.usda": HEAD.format("    subLayers = [@over.usda@ (offset = 2; scale = 0.5), @base.usda@]")
        + """
        def Xform "Instances" {
            def "A" (instanceable = true; references = @asset.usda@) {
                double3 xformOp:translate = (1, 2, 3)
                uniform token[] xformOpOrder = ["xformOp:translate"]
            }
            def "B" (instanceable = true; references = @asset.usda@; variants = { string shape = "tall" }) {
                float xformOp:rotateY = 30
                uniform token[] xformOpOrder = ["xformOp:rotateY"]
            }
            def "C" (payload = @asset.usda@</Asset/Geo> (offset = -3)) {}
        }
        class "_Kind" { token visibility = "invisible" }
        def Mesh "Hidden" (inherits = </_Kind>) {""" + MESH + """}
        def Mesh "Special" (specializes = </_Kind>) { token visibility = "inherited"; """ + MESH + """}
        def Scope "Guides" { token purpose = "guide"
            def Mesh "Guide" {""" + MESH + """}
            def Mesh "Shown" { token purpose = "render"; """ + MESH + """}
        }
        """,
        "over.usda": """#usda 1.0
        over "World" { double3 xformOp:translate.timeSamples = { 0: (0, 0, 0), 10: (10, 0, 0) } }
        """,
        "base.usda": """#usda 1.0
        def Xform "World" (prepend apiSchemas = ["MaterialBindingAPI"]) {
            double3 xformOp:translate = (5, 5, 5)
            double3 xformOp:rotateXYZ = (10, 20, 30)
            float3 xformOp:scale = (1, 2, 3)
            uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:rotateXYZ", "xformOp:scale"]
            rel material:binding = </Looks/Red> (bindMaterialAs = "strongerThanDescendants")
            texCoord2f[] primvars:st = [(0.25, 0.5)] (interpolation = "constant")
            def Mesh "Left" (prepend apiSchemas = ["MaterialBindingAPI"]) {
                uniform token orientation = "leftHanded"
                rel material:binding = </Looks/Blue>
                int[] faceVertexCounts = [3]
                int[] faceVertexIndices = [0, 1, 2]
                point3f[] points.timeSamples = { 1: [(0, 0, 0), (1, 0, 0), (0, 1, 0)], 5: [(0, 0, 0), (3, 0, 0), (0, 1, 0)] }
                uniform token subdivisionScheme = "none"
            }
            def Mesh "Free" { bool reset = 1; uniform token[] xformOpOrder = ["!resetXformStack!"]
        """ + MESH + """}
        }
        def Scope "Looks" {""" + material("/Looks/Red") + material("/Looks/Blue") + "}",
        "asset.usda": """#usda 1.0
        ( defaultPrim = "Asset" )
        def Xform "Asset" (variantSets = "shape"; variants = { string shape = "flat" }) {
            def Xform "Geo" {
                def Mesh "Faces" (prepend apiSchemas = ["MaterialBindingAPI"]) {
                    rel material:binding = </Asset/Looks/Green>
        """ + MESH + """
                    def GeomSubset "Some" (prepend apiSchemas = ["MaterialBindingAPI"]) {
                        uniform token elementType = "face"
                        uniform token familyName = "materialBind"
                        int[] indices = [1]
                        rel material:binding = </Asset/Looks/White>
                    }
                }
            }
            def Scope "Looks" {""" + material("/Asset/Looks/Green") + material("/Asset/Looks/White") + """}
            variantSet "shape" = {
                "flat" {}
                "tall" { over "Geo" { float3 xformOp:scale = (1, 1, 7); uniform token[] xformOpOrder = ["xformOp:scale"] } }
            }
        }
        """,
    },
    "instancer": {
        "root.usda": HEAD.format("")
        + """
        def PointInstancer "Many" {
            double3 xformOp:translate = (0, 3, 0)
            uniform token[] xformOpOrder = ["xformOp:translate"]
            int[] protoIndices = [0, 1, 0, 1, 0]
            int64[] ids = [10, 11, 12, 13, 14]
            int64[] invisibleIds = [13]
            point3f[] positions = [(0, 0, 0), (1, 0, 0), (2, 0, 0), (3, 0, 0), (4, 0, 0)]
            quath[] orientations = [(1, 0, 0, 0), (0.7071, 0, 0.7071, 0), (0, 1, 0, 0), (1, 0, 0, 0), (0.5, 0.5, 0.5, 0.5)]
            float3[] scales = [(1, 1, 1), (2, 1, 1), (1, 3, 1), (1, 1, 1), (1, 1, 0.5)]
            rel prototypes = [</Many/Flat>, </Many/Group>]
            def Mesh "Flat" { float xformOp:rotateX = 45; uniform token[] xformOpOrder = ["xformOp:rotateX"]
        """ + MESH + """}
            def Xform "Group" { def Xform "Up" {
                double3 xformOp:translate = (0, 0, 1)
                uniform token[] xformOpOrder = ["xformOp:translate"]
                def Mesh "Leaf" {""" + MESH + """}
            } }
        }
        """,
    },
    "curves and points": {
        "root.usda": HEAD.format("")
        + """
        def Xform "Hair" {
            float3 xformOp:scale = (2, 2, 3)
            uniform token[] xformOpOrder = ["xformOp:scale"]
        """
        + "".join(
            f"""
            def BasisCurves "{basis}_{wrap}" {{
                uniform token type = "{"linear" if basis == "linear" else "cubic"}"
                uniform token basis = "{"bezier" if basis == "linear" else basis}"
                uniform token wrap = "{wrap}"
                int[] curveVertexCounts = [{count}, {count}]
                point3f[] points = {points}
                float[] widths.timeSamples = {{ 0: {widths[:size]}, 10: {widths[1 : size + 1]} }}
                uniform token purpose = "render"
            }}
            """.replace("float[] widths", f'float[] widths (interpolation = "{how}")\n                float[] widths')
            for basis, wrap, count, how, size in (
                ("linear", "nonperiodic", 6, "vertex", 12),
                ("linear", "periodic", 6, "uniform", 2),
                ("bezier", "nonperiodic", 7, "varying", 6),
                ("bezier", "periodic", 6, "constant", 1),
                ("bspline", "nonperiodic", 6, "vertex", 12),
                ("bspline", "periodic", 6, "varying", 12),
                ("bspline", "pinned", 6, "vertex", 12),
                ("catmullRom", "nonperiodic", 6, "varying", 8),
                ("catmullRom", "periodic", 6, "vertex", 12),
                ("catmullRom", "pinned", 6, "vertex", 12),
            )
            for points in ([(round(math.cos(2.4 * i), 3), round(math.sin(1.7 * i), 3), i % 5) for i in range(2 * count)],)
            for widths in ([round(0.1 + 0.05 * (i % 3), 3) for i in range(16)],)
        )
        + """
            def Points "Dust" {
                point3f[] points.timeSamples = { 0: [(0, 0, 0), (1, 2, 3), (4, 5, 6)], 10: [(0, 0, 9), (1, 2, 3), (4, 5, 6)] }
                float[] widths = [0.5, 1, 2]
                color3f[] primvars:displayColor = [(1, 0, 0), (0, 1, 0.5)] (interpolation = "vertex")
                int[] primvars:displayColor:indices = [1, 0, 1]
            }
            def Points "Even" {
                point3f[] points = [(0, 0, 0), (1, 2, 3)]
                float[] widths = [0.5] (interpolation = "constant")
            }
        }
        """,
    },
    "lights": {
        "root.usda": HEAD.format("")
        + """
        def Xform "Rig" {
            float3 xformOp:scale = (2, 2, 2)
            float xformOp:rotateZ.timeSamples = { 0: 0, 10: 90 }
            uniform token[] xformOpOrder = ["xformOp:rotateZ", "xformOp:scale"]
            def SphereLight "Sphere" (prepend apiSchemas = ["ShapingAPI"]) {
                float inputs:intensity.timeSamples = { 0: 1, 10: 11 }
                bool inputs:normalize = 1
                float inputs:shaping:cone:angle = 35
                float inputs:shaping:cone:softness = 0.2
                float inputs:shaping:focus = 2
            }
            def SphereLight "Point" { bool treatAsPoint = 1; float inputs:radius = 0.1; float inputs:exposure = 3 }
            def RectLight "Rect" {
                float3 xformOp:scale = (1, 3, 1)
                uniform token[] xformOpOrder = ["xformOp:scale"]
                float inputs:width = 4
                bool inputs:normalize = 1
                bool inputs:enableColorTemperature = 1
                float inputs:colorTemperature = 4321
            }
            def DiskLight "Disk" { bool inputs:normalize = 1 }
            def CylinderLight "Tube" { bool inputs:normalize = 1; float inputs:length = 3 }
            def DistantLight "Sun" { bool inputs:normalize = 1; float inputs:intensity = 3 }
            def DistantLight "Wide" { float inputs:angle = 60 }
            def DistantLight "Sharp" { float inputs:angle = 0 }
            def DomeLight "Dome" { float xformOp:rotateX = 30; uniform token[] xformOpOrder = ["xformOp:rotateX"] }
            def DomeLight_1 "Pole" { float xformOp:rotateX = 30; uniform token[] xformOpOrder = ["xformOp:rotateX"] }
            def SphereLight "Off" { token visibility = "invisible" }
            def SphereLight "Measured" (prepend apiSchemas = ["ShapingAPI", "ShadowAPI"]) {
                asset inputs:shaping:ies:file = @./cosine.ies@
                float inputs:shaping:ies:angleScale = 0.25
                float inputs:shaping:cone:angle = 180
                float inputs:shaping:focus = 3
                color3f inputs:shaping:focusTint = (0.5, 0.25, 0.125)
                bool inputs:shadow:enable = 0
                color3f inputs:shadow:color = (0.25, 0.5, 0.75)
                float inputs:shadow:distance = 200
                float inputs:shadow:falloff.timeSamples = { 0: 50, 10: 150 }
                float inputs:shadow:falloffGamma = 2
            }
            def DiskLight "Mean" (prepend apiSchemas = ["ShapingAPI", "ShadowAPI"]) {
                asset inputs:shaping:ies:file = @./cosine.ies@
                bool inputs:shaping:ies:normalize = 1
                float inputs:shadow:falloff = 50
            }
            def DomeLight "Shaded" (prepend apiSchemas = ["ShadowAPI"]) { float inputs:shadow:distance = 7 }
            def PortalLight "Door" (prepend apiSchemas = ["ShadowAPI"]) {
                float3 xformOp:scale = (1, 3, 1)
                uniform token[] xformOpOrder = ["xformOp:scale"]
                float inputs:width = 3
                float inputs:height = 2
            }
            def PortalLight "Window" {}
            def Material "Look" {
                color3f inputs:tint.timeSamples = { 0: (1, 0, 0), 10: (0, 1, 0.5) }
                token outputs:surface.connect = </Rig/Look/S.outputs:surface>
                def Shader "S" { uniform token info:id = "UsdPreviewSurface"
                    color3f inputs:emissiveColor = (1, 2, 4)
                    token outputs:surface
                }
            }
            def SphereLight "Connected" {
                color3f inputs:color.connect = </Rig/Look.inputs:tint>
                float inputs:intensity = 3
            }
            def Mesh "Glow" (prepend apiSchemas = ["MeshLightAPI", "MaterialBindingAPI"]) {
                rel material:binding = </Rig/Look>
                float inputs:intensity = 3
                bool inputs:normalize = 1
        """ + FLAT + """}
            def Mesh "Alone" (prepend apiSchemas = ["MeshLightAPI", "MaterialBindingAPI", "ShadowAPI"]) {
                rel material:binding = </Rig/Look>
                uniform token light:materialSyncMode = "independent"
                color3f inputs:shadow:color = (1, 0.5, 0)
        """ + FLAT + """}
            def Sphere "Ball" (prepend apiSchemas = ["LightAPI"]) {
                color3f inputs:color.timeSamples = { 0: (1, 0, 0), 10: (0, 1, 0.5) }
            }
            def Mesh "Lit" {""" + FLAT + """}
            def GeometryLight "Old" { rel geometry = </Rig/Lit>
                float inputs:exposure = 2
                bool inputs:normalize = 1
            }
            def Camera "Cam" {
                float horizontalApertureOffset = 3
                float verticalApertureOffset = -2
                float fStop = 4
                float focusDistance = 70
                float exposure = 1.5
                float exposure:iso = 400
                float focalLength.timeSamples = { 0: 20, 10: 70 }
            }
            def Camera "Flat" { token projection = "orthographic"; float2 clippingRange = (0.5, 60) }
        }
        """,
        "cosine.ies": COSINE,
    },
}


def write(folder, files):
    for file, text in files.items():
        # One statement a line, as usda wants it.
        (folder / file).write_text(text.replace("{ ", "{\n").replace("} ", "}\n").replace(" }", "\n}"))


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("frame", [None, 4.5, 9])
def test_cases_are_read_as_openusd_reads_them(tmp_path, name, frame):
    write(tmp_path, CASES[name])
    args = [] if frame is None else ["--frame", frame]
    found = judge(tmp_path / "root.usda", *args, frame=frame)
    assert not found, "\n".join(found)


# Each of these is another light.
OTHER_LIGHTS = [
    ("focusTint = (0.5, 0.25, 0.125)", "focusTint = (0.5, 0.25, 0.25)"),
    ("shaping:focus = 3", "shaping:focus = 4"),
    ("angleScale = 0.25", "angleScale = 0.5"),
    ("bool inputs:shaping:ies:normalize = 1", ""),
    ("asset inputs:shaping:ies:file = @./cosine.ies@", ""),
    ("bool inputs:shadow:enable = 0", ""),
    ("shadow:color = (0.25, 0.5, 0.75)", "shadow:color = (0.25, 0.5, 0.5)"),
    ("shadow:distance = 200", "shadow:distance = 201"),
    ("shadow:falloff.timeSamples = { 0: 50", "shadow:falloff.timeSamples = { 0: 10"),
    ("falloffGamma = 2", "falloffGamma = 3"),
    ("shadow:distance = 7", "shadow:distance = 8"),
    ("float inputs:width = 3", "float inputs:width = 4"),
    ("tint.timeSamples = { 0: (1, 0, 0)", "tint.timeSamples = { 0: (1, 0, 1)"),
    ("emissiveColor = (1, 2, 4)", "emissiveColor = (1, 2, 5)"),
    ("float inputs:intensity = 3\n                bool inputs:normalize = 1\n        ", "float inputs:intensity = 3\n"),
    ('"independent"', '"noMaterialResponse"'),
    ("shadow:color = (1, 0.5, 0)", "shadow:color = (1, 0.5, 1)"),
    ("inputs:color.timeSamples = { 0: (1, 0, 0)", "inputs:color.timeSamples = { 0: (1, 0, 1)"),
    ("float inputs:exposure = 2", "float inputs:exposure = 3"),
]


@pytest.fixture(scope="module")
def lit(tmp_path_factory):
    """The case of lights, and what Penumbra says of it."""
    folder = tmp_path_factory.mktemp("lit")
    write(folder, CASES["lights"])
    return folder, read(folder / "root.usda")


@pytest.mark.parametrize("change", OTHER_LIGHTS, ids=lambda change: change[0])
def test_another_light_is_a_difference(lit, change):
    folder, info = lit
    files = CASES["lights"]
    assert change[0] in files["root.usda"]
    write(folder, {"changed.usda": files["root.usda"].replace(*change, 1)})
    assert judge(folder / "changed.usda", info=info)
    assert not judge(folder / "root.usda", info=info)


EXPORT = """
import sys
import bpy

bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene


def put(name, data, **at):
    thing = bpy.data.objects.new(name, data)
    scene.collection.objects.link(thing)
    for key, value in at.items():
        setattr(thing, key, value)


def lamp(name, kind, at={}, **values):
    data = bpy.data.lights.new(name, kind)
    for key, value in values.items():
        setattr(data, key, value)
    put(name, data, **at)


lamp("point", "POINT", {"scale": (2, 2, 2), "location": (1, 2, 3)}, energy=100, shadow_soft_size=0.3)
lamp("pin", "POINT", energy=100, shadow_soft_size=0)
lamp("spot", "SPOT", energy=50, shadow_soft_size=0.1, spot_size=1.0, spot_blend=0.3)
lamp("sun", "SUN", {"rotation_euler": (0.3, 0.2, 0.1)}, energy=3, angle=0.2)
lamp("area", "AREA", {"scale": (1, 2, 1)}, energy=20, shape="RECTANGLE", size=2, size_y=0.5)
lamp("disk", "AREA", energy=20, shape="DISK", size=2)
camera = bpy.data.cameras.new("camera")
camera.shift_x, camera.shift_y = 0.1, 0.2
camera.dof.use_dof, camera.dof.focus_distance, camera.dof.aperture_fstop = True, 4, 2
put("camera", camera, location=(0, -5, 1), rotation_euler=(1.4, 0, 0.2))
bpy.ops.mesh.primitive_monkey_add(location=(0, 1, 2), rotation=(0.1, 0.2, 0.3))
monkey = bpy.context.object
for name in ("red", "blue"):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    monkey.data.materials.append(material)
for i, face in enumerate(monkey.data.polygons):
    face.material_index = i % 2
world = bpy.data.worlds.new("world")
scene.world, world.use_nodes = world, True
image = bpy.data.images.new("sky", 64, 32, float_buffer=True)
image.filepath_raw, image.file_format = sys.argv[-1] + "/sky.exr", "OPEN_EXR"
image.save()
nodes, links = world.node_tree.nodes, world.node_tree.links
nodes.clear()
sky, background, out = (nodes.new("ShaderNode" + n) for n in ("TexEnvironment", "Background", "OutputWorld"))
sky.image = image
links.new(sky.outputs[0], background.inputs[0])
links.new(background.outputs[0], out.inputs[0])
bpy.ops.wm.usd_export(filepath=sys.argv[-1] + "/m.usda")
bpy.ops.wm.usd_export(filepath=sys.argv[-1] + "/cm.usdc", convert_scene_units="CENTIMETERS")
bpy.ops.wm.usd_export(filepath=sys.argv[-1] + "/y.usda", convert_orientation=True)
"""


def test_values_of_each_instance_are_those_that_openusd_flattens():
    path = ROOT / "tests/usd/stages/instance_primvars.usda"
    answer = Answer(read(path))
    stage = Usd.Stage.Open(str(path))
    of = UsdGeom.PrimvarsAPI(stage.GetPrimAtPath("/World/Many"))
    indices = list(UsdGeom.PointInstancer(of.GetPrim()).GetProtoIndicesAttr().Get())
    for name in ("tint", "cell", "displayColor"):
        flat = of.GetPrimvar(name).ComputeFlattened()
        expected = [list(flat[i]) for i, prototype in enumerate(indices) if prototype == 0]
        found = [i["attributes"][name][: len(expected[0])] for i in answer.instances["/World/Many/Leaf"]]
        assert found == expected, name


@pytest.fixture(scope="module")
def blender(tmp_path_factory):
    """A folder of stages that Blender wrote, by a process of its own: Blender brings a USD of its own."""
    pytest.importorskip("bpy")
    folder = tmp_path_factory.mktemp("blender")
    done = subprocess.run([sys.executable, "-c", EXPORT, str(folder)], capture_output=True, text=True)
    assert (folder / "y.usda").exists(), done.stdout + done.stderr
    return folder


@pytest.mark.parametrize("file", ["m.usda", "cm.usdc", "y.usda"])
def test_what_blender_wrote_is_read_as_openusd_reads_it(blender, file):
    found = judge(blender / file)
    assert not found, "\n".join(found)


@pytest.mark.parametrize("file", ["m.usda", "cm.usdc", "y.usda"])
def test_blenders_lamps_come_back_as_cycles_has_them(blender, file):
    """Cycles: I = P / 4π of a point, L = P / 4π²r² of a sphere, P / πA of an area, E = S of a sun."""
    lights = {light["name"]: light["kind"] for light in read(blender / file)["values"]["lights"]}
    value = lambda name, key="radiance": lights[name][key][0] if isinstance(lights[name][key], list) else lights[name][key]
    pi = math.pi
    expected = {
        ("point", "radius"): 0.3,
        ("point", "radiance"): 100 / (4 * pi**2 * 0.09),
        ("pin", "intensity"): 100 / (4 * pi),
        ("spot", "radiance"): 50 / (4 * pi**2 * 0.01),
        ("sun", "irradiance"): 3.0,
        ("sun", "angle"): 0.2,
        ("area", "width"): 2.0,
        ("area", "height"): 1.0,
        ("area", "radiance"): 20 / (pi * 2.0),
        ("disk", "radiance"): 20 / (pi * pi),
    }
    for (name, key), number in expected.items():
        assert value(name, key) == pytest.approx(number, rel=1e-5), (name, key)


def assert_seen(folder, pixels, texel, toward, up="Y", dome="DomeLight", lines=""):
    """Asserts that the one bright `texel` (row, column) of a dome of these `pixels` is seen by a camera that looks
    `toward`, in the dome's own space; the dome is turned by 40 degrees about z."""
    oiio = pytest.importorskip("OpenImageIO")
    pixels[texel] = [0.0, 9.0, 0.0]
    spec = oiio.ImageSpec(pixels.shape[1], pixels.shape[0], 3, "float")
    image = oiio.ImageOutput.create(str(folder / "sky.exr"))
    assert image.open(str(folder / "sky.exr"), spec) and image.write_image(pixels) and image.close()
    # About z by 40 degrees, with the light.
    sin, cos = math.sin(math.radians(40)), math.cos(math.radians(40))
    toward = np.array([cos * toward[0] - sin * toward[1], sin * toward[0] + cos * toward[1], toward[2]])
    right = np.cross(toward, [0.3, 0.5, 0.8])
    right /= np.linalg.norm(right)
    axes = np.array([right, np.cross(right, toward), -toward])
    matrix = ", ".join("({}, {}, {}, 0)".format(*axis) for axis in axes)
    (folder / "dome.usda").write_text(
        f"""#usda 1.0
        ( upAxis = "{up}" )
        def {dome} "Sky" {{
            asset inputs:texture:file = @./sky.exr@
            {lines}
            float xformOp:rotateZ = 40
            uniform token[] xformOpOrder = ["xformOp:rotateZ"]
        }}
        def Camera "Cam" {{
            float horizontalAperture = 20
            float verticalAperture = 20
            matrix4d xformOp:transform = ( {matrix}, (0, 0, 0, 1) )
            uniform token[] xformOpOrder = ["xformOp:transform"]
        }}
        """
    )
    out = folder / "out.exr"
    command = [PENUMBRA, "render", folder / "dome.usda", "-o", out, "--size", "33x33", "--spp", "1"]
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    picture = oiio.ImageInput.open(str(out)).read_image(0, 0, 0, 3, oiio.FLOAT)
    rows, columns = np.nonzero(picture[..., 1] > 0.5 * picture[..., 1].max())
    assert picture[16, 16, 1] > 6 and abs(rows.mean() - 16) < 1.5 and abs(columns.mean() - 16) < 1.5


@pytest.mark.parametrize("up", ["Y", "Z"])
@pytest.mark.parametrize("dome", ["DomeLight", "DomeLight_1"])
def test_a_bright_texel_of_a_dome_is_seen_where_usd_has_it(tmp_path, up, dome):
    """OpenEXR's lat-long maps: u = 0.5 - lon / 2 pi, v = 0.5 + lat / pi, lon = atan2(x, z), lat = asin(y)."""
    width, height, column, row = 64, 32, 10, 8
    lon = 2 * math.pi * (0.5 - (column + 0.5) / width)
    lat = math.pi * (0.5 - (row + 0.5) / height)
    toward = np.array([math.cos(lat) * math.sin(lon), math.sin(lat), math.cos(lat) * math.cos(lon)])
    if dome == "DomeLight_1" and up == "Z":
        toward = np.array([toward[0], -toward[2], toward[1]])
    assert_seen(tmp_path, np.full((height, width, 3), 0.01, np.float32), (row, column), toward, up, dome)


@pytest.mark.parametrize("format", ["automatic", "latlong", "mirroredBall", "angular", "cubeMapVerticalCross"])
def test_a_bright_texel_of_a_dome_is_seen_where_its_format_has_it(tmp_path, format):
    """UsdLux: the environment "reflected in a sphere, using an implicitly orthogonal projection"; the same with the
    angle "mapped linearly" along the radius; the faces of a cube "laid out as a vertical cross". Seen as any camera of
    USD looks, along -z with y up."""
    if format in ("automatic", "latlong"):
        shape, texel = (32, 64), (8, 10)
        lon, lat = 2 * math.pi * (0.5 - 10.5 / 64), math.pi * (0.5 - 8.5 / 32)
        toward = np.array([math.cos(lat) * math.sin(lon), math.sin(lat), math.cos(lat) * math.cos(lon)])
    elif format == "cubeMapVerticalCross":
        # The upper face, which joins the one ahead (+z) by its lower edge.
        shape, texel = (128, 96), (10, 40)
        x, down = 2 * (40.5 - 32) / 32 - 1, 2 * 10.5 / 32 - 1
        toward = np.array([-x, 1.0, down])
    else:
        shape, texel = (64, 64), (20, 44)
        x, y = 2 * 44.5 / 64 - 1, 1 - 2 * 20.5 / 64
        radius = math.hypot(x, y)
        angle = 2 * math.asin(radius) if format == "mirroredBall" else math.pi * radius
        toward = np.array([x / radius * math.sin(angle), y / radius * math.sin(angle), math.cos(angle)])
    lines = f'token inputs:texture:format = "{format}"'
    toward = toward / np.linalg.norm(toward)
    assert_seen(tmp_path, np.full((*shape, 3), 0.01, np.float32), texel, toward, lines=lines)
