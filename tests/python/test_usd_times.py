"""What changes in time, and what newer OpenUSD writes into layers, against OpenUSD itself (usd-core): curves,
value clips, velocities, held samples, edits of ids."""

import random

import numpy as np
import pytest

pytest.importorskip("pxr", reason="usd-core is not installed")
from pxr import Sdf, Usd, UsdGeom  # noqa: E402
from test_usd_core import CASES, Answer, judge, read, write  # noqa: E402
from usd_judge import Stage  # noqa: E402

HEAD = '#usda 1.0\n(\nmetersPerUnit = 1\nupAxis = "Y"\nstartTimeCode = 0\nendTimeCode = 40\ntimeCodesPerSecond = 10\n{}\n)\n'

TRIANGLE = """
int[] faceVertexCounts = [3]
int[] faceVertexIndices = [0, 1, 2]
uniform token subdivisionScheme = "none"
"""
POINTS = "point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]\n"


def nothing_differs(path, *args, frame=None, interpolation=None):
    found = judge(path, *args, *([] if frame is None else [f"--frame={frame}"]), frame=frame, interpolation=interpolation)
    assert not found, "\n".join(found)


def of(path, prim):
    """Penumbra's mesh at `prim`; it is there."""
    return lambda *args: Answer(read(path, *args)).instances[prim]


def random_curve(rng):
    """The lines of a curve with every kind of segment, tangent, end and, at times, loop of the whole."""
    number = lambda low, high: repr(round(rng.uniform(low, high), 4))
    hermite = rng.random() < 0.3
    ends = ["none", "held", "linear", f"sloped({number(-2, 2)})", "loop repeat", "loop reset", "loop oscillate"]
    lines = ["hermite" if hermite else "bezier", f"pre: {rng.choice(ends)}", f"post: {rng.choice(ends)}"]
    # Half of what may be wider than its segment is.
    width = lambda: number(0, rng.choice([0.0, 2.0, 9.0]))
    tangent = lambda: f"({number(-3, 3)})" if hermite else f"({width()}, {number(-3, 3)})"
    for time in sorted(rng.sample(range(20), rng.choice([1, 2, 3, 4, 5]))):
        value = number(-5, 5) if rng.random() < 0.7 else f"{number(-5, 5)} & {number(-5, 5)}"
        segment = rng.choice(["none", "held", "linear", "curve", "curve", "curve"])
        after = f"{segment} {tangent()}" if segment == "curve" else segment
        lines.append(f'{time}: {value}; pre {tangent()}; post {after}; {{ string note = "{time}" }}')
    return "{\n" + ",\n".join(lines) + "\n}\n"


def curves(rng, count):
    """Prims that curves move along, turn about and stretch along an axis."""
    prims = []
    for i in range(count):
        operations = [("double", "translateX"), ("float", "rotateZ"), ("float", "scaleY"), ("half", "translateZ:more")]
        body = "".join(f"{kind} xformOp:{name}.spline = {random_curve(rng)}" for kind, name in operations)
        names = ", ".join(f'"xformOp:{name}"' for _, name in operations)
        body += f"uniform token[] xformOpOrder = [{names}]\n"
        prims.append(f'def Xform "P{i}" {{\n{body}def Mesh "T" {{\n{TRIANGLE}{POINTS}}}\n}}\n')
    return "".join(prims)


@pytest.fixture(scope="module")
def curved(tmp_path_factory):
    """A stage of curves as text, in binary and in a package, and others that shift and hold it."""
    folder = tmp_path_factory.mktemp("curves")
    text = HEAD.format("") + 'def Xform "World" {\n' + curves(random.Random(11), 40) + "}\n"
    (folder / "text.usda").write_text(text)
    layer = Sdf.Layer.FindOrOpen(str(folder / "text.usda"))
    assert layer.Export(str(folder / "binary.usdc"))
    writer = Sdf.ZipFileWriter.CreateNew(str(folder / "package.usdz"))
    writer.AddFile(str(folder / "binary.usdc"), "binary.usdc")
    assert writer.Save()
    (folder / "shifted.usda").write_text(HEAD.format("subLayers = [@binary.usdc@ (offset = 3; scale = 0.5)]"))
    (folder / "held.usda").write_text(
        HEAD.format("") + 'def "World" (\nreferences = @text.usda@</World> (offset = -2; scale = 2)\n) {\n'
        'over "P0" {\ndouble xformOp:translateX = 3\n}\n'
        'over "P1" {\ndouble xformOp:translateX.timeSamples = { 0: 1, 20: 5 }\n}\n'
        'over "P2" {\ndouble xformOp:translateX = AnimationBlock\n}\n}\n'
    )
    return folder


@pytest.mark.parametrize("file", ["text.usda", "binary.usdc", "package.usdz", "shifted.usda", "held.usda"])
@pytest.mark.parametrize("frame", [0, 3, 4.7, 9.31, 12, 19.5, 27.25, 40])
def test_curves_have_openusds_values(curved, file, frame):
    nothing_differs(curved / file, frame=frame)


def test_curves_of_lights_and_cameras_have_openusds_values(tmp_path):
    curve = "{\nbezier,\n0: 20; post curve (4, 2),\n10: 60; pre (5, 1); post linear,\n20: 30,\n}\n"
    path = tmp_path / "stage.usda"
    path.write_text(
        HEAD.format("")
        + f'def SphereLight "L" {{\nfloat inputs:intensity.spline = {curve}float inputs:radius.spline = {curve}}}\n'
        + f'def Camera "C" {{\nfloat focalLength.spline = {curve}float fStop = 2\nfloat focusDistance.spline = {curve}}}\n'
    )
    for frame in (0, 3.5, 10, 17, 30):
        nothing_differs(path, frame=frame)


def test_newer_text_is_read_as_openusd_reads_it(tmp_path):
    """Comments in C's manner, numbers without a digit before or after the point, blocks of animation."""
    text = '#usda 1.1\n// a { " line\n' + HEAD.format("").split("\n", 1)[1] + """
    /* a block that { does " not
       close */
    def Xform "A" /* between */ { // after
        double3 xformOp:translate = (.5, -.25e1, 3.) // (1, 2, 3)
        string note = "// no comment, .5 no number, /* nothing */ = AnimationBlock"
        string three = '''a // \\''' .5 \\' /* b'''
        asset there = @http://x//y.usda@
        uniform token[] xformOpOrder = ["xformOp:translate"]
        def Mesh "T" {
            TRIANGLE
            point3f[] points = [(.0, 0, 0), (1., 0, 0), (0, 1.e0, .0)] (
                doc = "points // here"
            )
        }
    }
    """.replace("TRIANGLE", TRIANGLE)
    (tmp_path / "text.usda").write_text(text)
    assert Usd.Stage.Open(str(tmp_path / "text.usda"))
    nothing_differs(tmp_path / "text.usda", frame=1)


BLOCKED = {
    "weaker samples": ["double x = AnimationBlock", "double x.timeSamples = { 1: 5 }", "double x = 8"],
    "a weaker curve": ["double x = AnimationBlock (\ndoc = \"h\"\n)", "double x.spline = {\n1: 5,\n}", "double x = 8"],
    "own samples": ["double x = AnimationBlock\ndouble x.timeSamples = { 1: 2 }", "double x.timeSamples = { 1: 5 }"],
    "own default": ["double x = AnimationBlock", "double x = 7\ndouble x.timeSamples = { 1: 5 }"],
}


@pytest.mark.parametrize("name", BLOCKED)
@pytest.mark.parametrize("ending", ["usda", "usdc"])
def test_animation_that_is_blocked_does_not_shine_through(tmp_path, name, ending):
    for i, body in enumerate(BLOCKED[name]):
        body = body.replace("double x", "double xformOp:translateX")
        layer = Sdf.Layer.CreateAnonymous("layer.usda")
        layer.ImportFromString(f'#usda 1.1\nover "A" {{\n{body}\n}}\n')
        assert layer.Export(str(tmp_path / f"{i}.{ending}"))
    layers = ", ".join(f"@./{i}.{ending}@" for i in range(len(BLOCKED[name])))
    order = 'uniform token[] xformOpOrder = ["xformOp:translateX"]\n'
    prim = f'def Xform "A" {{\n{order}def Mesh "T" {{\n{TRIANGLE}{POINTS}}}\n}}\n'
    (tmp_path / "root.usda").write_text(HEAD.format(f"subLayers = [{layers}]") + prim)
    for frame in (0, 1, 3):
        nothing_differs(tmp_path / "root.usda", frame=frame)


@pytest.mark.parametrize("ending", ["usda", "usdc"])
def test_ids_that_layers_switch_off_and_on(tmp_path, ending):
    edits = [
        "delete inactiveIds = [3]\nappend inactiveIds = [5]",
        "prepend inactiveIds = [1, 3]",
        "inactiveIds = [0, 5]" if ending == "usda" else "append inactiveIds = [0]",
    ]
    for i, edit in enumerate(edits):
        layer = Sdf.Layer.CreateAnonymous("layer.usda")
        layer.ImportFromString(f'#usda 1.0\nover "I" (\n{edit}\n) {{\n}}\n')
        assert layer.Export(str(tmp_path / f"{i}.{ending}"))
    layers = ", ".join(f"@./{i}.{ending}@" for i in range(len(edits)))
    (tmp_path / "root.usda").write_text(
        HEAD.format(f"subLayers = [{layers}]")
        + f"""def PointInstancer "I" {{
int[] protoIndices = [0, 0, 0, 0, 0, 0]
point3f[] positions = [(0, 0, 0), (1, 0, 0), (2, 0, 0), (3, 0, 0), (4, 0, 0), (5, 0, 0)]
int64[] invisibleIds = [2]
rel prototypes = </I/T>
def Mesh "T" {{
{TRIANGLE}{POINTS}}}
}}
"""
    )
    stage = Usd.Stage.Open(str(tmp_path / "root.usda"))
    assert len(set(UsdGeom.PointInstancer(stage.GetPrimAtPath("/I")).ComputeMaskAtTime(0))) == 2
    nothing_differs(tmp_path / "root.usda", frame=0)


def test_edits_of_arrays_are_told(tmp_path):
    prim = f'def Mesh "T" {{\n{TRIANGLE}point3f[] points = edit [append (0, 0, 1)]\n}}\n'
    layer = Sdf.Layer.CreateAnonymous("edit.usda")
    layer.ImportFromString(f"#usda 1.1\n{prim}")
    for ending in ("usda", "usdc"):
        assert layer.Export(str(tmp_path / f"edit.{ending}"))
        base = f'over "T" {{\n{POINTS}}}\n'
        (tmp_path / "base.usda").write_text("#usda 1.0\n" + base)
        root = tmp_path / f"root_{ending}.usda"
        root.write_text(HEAD.format(f"subLayers = [@./edit.{ending}@, @./base.usda@]"))
        answer = Answer(read(root))
        assert len(answer.meshes) == 1 and len(answer.meshes[0]["points"]) == 3
        told = [warning for warning in answer.warnings if "is an edit of an array" in warning]
        assert len(told) == 1 and f"edit.{ending}, /T.points:" in told[0], answer.warnings


ALIGNED = {
    "both": "{ 0: [(0, 1, 0), (1, 0, 0)], 10: [(0, 2, 0), (1, 1, 1)] }",
    "not above": "{ 0: [(0, 1, 0), (1, 0, 0)], 9: [(0, 2, 0), (1, 1, 1)] }",
    "not below": "{ 1: [(0, 1, 0), (1, 0, 0)], 10: [(0, 2, 0), (1, 1, 1)] }",
    "one": "{ 0: [(0, 1, 0), (1, 0, 0)] }",
    "fewer": "{ 0: [(0, 1, 0)], 10: [(0, 2, 0)] }",
}
MOVED = """
point3f[] {array}.timeSamples = {{ 0: [(0, 0, 0), (4, 0, 0)], 10: [(10, 0, 0), (4, 5, 0)], 20: [(0, 0, 0), (4, 0, 0)] }}
vector3f[] velocities{rates}
vector3f[] accelerations.timeSamples = {gains}
"""


def moved(array, rates, gains):
    rates = f".timeSamples = {rates}" if rates else " = [(0, 1, 0), (1, 0, 0)]"
    return MOVED.format(array=array, rates=rates, gains=gains)


@pytest.mark.parametrize("rates", [*ALIGNED, None])
@pytest.mark.parametrize("gains", ["both", "not above"])
def test_velocities_count_where_openusd_says(tmp_path, rates, gains):
    path = tmp_path / "stage.usda"
    path.write_text(
        HEAD.format("")
        + f"""def PointInstancer "I" {{
{moved("positions", ALIGNED.get(rates), ALIGNED[gains])}
int[] protoIndices = [0, 0]
quath[] orientations.timeSamples = {{ 0: [(1, 0, 0, 0), (0.5, 0.5, 0.5, 0.5)], 10: [(0, 1, 0, 0), (0, 1, 0, 0)] }}
vector3f[] angularVelocities.timeSamples = {{ 0: [(90, 0, 0), (0, 45, 90)], 10: [(0, 9, 0), (0, 0, 0)] }}
float3[] scales.timeSamples = {{ 0: [(1, 1, 1), (1, 2, 1)], 10: [(2, 2, 2), (1, 1, 1)] }}
rel prototypes = </I/T>
def Mesh "T" {{
{TRIANGLE}{POINTS}}}
}}
def PointInstancer "J" {{
{moved("positions", ALIGNED.get(rates), ALIGNED[gains])}
int[] protoIndices = [0, 0]
float3[] scales.timeSamples = {{ 0: [(1, 1, 1), (1, 2, 1)], 10: [(2, 2, 2), (1, 1, 1)] }}
rel prototypes = </I/T>
}}
def Points "P" {{
{moved("points", ALIGNED.get(rates), ALIGNED[gains])}
float[] widths = [1, 2]
}}
"""
    )
    for frame in (-3, 0, 4, 10, 13, 25):
        nothing_differs(path, frame=frame)
    told = any("are not at the times of those" in warning for warning in read(path, "--frame=4")["warnings"])
    assert told == (rates not in ("both", "fewer") or (rates == "both" and gains == "not above"))


def clip(first, second, points):
    return f"""#usda 1.0
def Xform "Clip" {{
double3 xformOp:translate.timeSamples = {{ {first}, {second} }}
def Mesh "T" {{
point3f[] points.timeSamples = {{ {points} }}
}}
}}
"""


def triangle(z):
    return f"[(0, 0, {z}), (1, 0, 0), (0, 1, 0)]"


LAYERS = {
    "a.usda": clip("0: (0, 0, 0)", "10: (10, 0, 0)", f"0: {triangle(0)}, 10: {triangle(5)}"),
    "b.usda": clip("0: (0, 0, 0)", "10: (0, 100, 0)", f"0: {triangle(10)}, 10: {triangle(20)}"),
    "empty.usda": '#usda 1.0\ndef Xform "Clip" {\ndef Mesh "T" {\n}\n}\n',
    "manifest.usda": '#usda 1.0\ndef Xform "Clip" {\ndouble3 xformOp:translate\ndef Mesh "T" {\npoint3f[] points\n}\n}\n',
    "no_points.usda": '#usda 1.0\ndef Xform "Clip" {\ndouble3 xformOp:translate\n}\n',
    "defaults.usda": f"""#usda 1.0
def Xform "Clip" {{
double3 xformOp:translate = (7, 7, 7)
def Mesh "T" {{
point3f[] points = {triangle(3)}
}}
}}
""",
    "blocks.usda": """#usda 1.0
def Xform "Clip" {
double3 xformOp:translate.timeSamples = { 10: None }
def Mesh "T" {
point3f[] points.timeSamples = { 10: None }
}
}
""",
    **{
        f"t.{i:03}.usda": clip(f"{10 * i - 10}: ({i}, 0, 0)", f"{10 * i}: ({i}, 5, 0)", f"{10 * i - 10}: {triangle(i)}")
        for i in (1, 2, 3)
    },
}
TWO = "asset[] assetPaths = [@./a.usda@, @./b.usda@]\ndouble2[] active = [(0, 0), (10, 1)]\n"
GAP = """asset[] assetPaths = [@./a.usda@, @./empty.usda@, @./b.usda@]
double2[] active = [(0, 0), (10, 1), (20, 2)]
double2[] times = [(0, 0), (10, 10), (10, 0), (20, 10), (20, 0), (30, 10)]
"""
TIMES = "double2[] times = [(0, 0), (10, 10), (10, 0), (20, 10)]\n"
TEMPLATE = """string templateAssetPath = "./t.###.usda"
double templateStartTime = 1
double templateEndTime = 3
double templateStride = 1
"""
MISSING = "bool interpolateMissingClipValues = true\n"
MANIFEST = "asset manifestAssetPath = @./manifest.usda@\n"
CLIPS = {
    "two": TWO + TIMES + MANIFEST,
    "without times": TWO + MANIFEST,
    "without manifest": TWO + TIMES,
    "manifest without points": TWO + TIMES + MANIFEST.replace("manifest.usda", "no_points.usda"),
    "jumps": TWO + "double2[] times = [(0, 0), (5, 10), (5, 2), (10, 4), (10, 0), (15, 5), (15, 8), (20, 9)]\n" + MANIFEST,
    "backwards": TWO + "double2[] times = [(0, 10), (10, 0), (10, 0), (20, 10)]\n" + MANIFEST,
    "gap": GAP + MANIFEST,
    "gap filled": GAP + MANIFEST + MISSING,
    "gap of the manifest's default": GAP + MANIFEST.replace("manifest.usda", "defaults.usda"),
    "gap filled beside a default": GAP + MANIFEST.replace("manifest.usda", "defaults.usda") + MISSING,
    "gap that is blocked": GAP + MANIFEST.replace("manifest.usda", "blocks.usda"),
    "gap filled without manifest": GAP + MISSING,
    "template": TEMPLATE + MANIFEST,
    "template with offset": TEMPLATE + "double templateActiveOffset = 0.5\n" + MANIFEST,
    "template without manifest": TEMPLATE,
}


@pytest.mark.parametrize("name", CLIPS)
@pytest.mark.parametrize("declared", ["", "point3f[] points\n", f"point3f[] points = {triangle(1)}\n"])
def test_value_clips_have_openusds_values(tmp_path, name, declared):
    for file, text in LAYERS.items():
        (tmp_path / file).write_text(text)
    clips = f'clips = {{\ndictionary default = {{\n{CLIPS[name]}string primPath = "/Clip"\n}}\n}}\n'
    prim = f"""def Xform "Clipped" (
{clips})
{{
double3 xformOp:translate
uniform token[] xformOpOrder = ["xformOp:translate"]
def Mesh "T" {{
{TRIANGLE}{declared}}}
}}
"""
    (tmp_path / "root.usda").write_text(HEAD.format("") + prim)
    path = tmp_path / "root.usda"
    for frame in (0, 4.9, 10, 12, 19, 25):
        nothing_differs(path, frame=frame)
        # What OpenUSD shows is not merely told of.
        stage, answer = Stage(path, frame), Answer(read(path, f"--frame={frame}"))
        for prim in stage.gprims():
            faces = stage.faces(prim)
            assert bool(answer.instances[str(prim.GetPath())]) == bool(faces and faces[1]), (frame, answer.warnings)


def test_samples_are_held_where_that_is_asked_for(tmp_path):
    path = tmp_path / "stage.usda"
    path.write_text(
        HEAD.format("")
        + f"""def Xform "A" {{
double3 xformOp:translate.timeSamples = {{ 0: (0, 0, 0), 10: (10, 0, 0) }}
float xformOp:rotateZ.spline = {{
0: 0; post linear,
10: 90,
}}
uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:rotateZ"]
def Mesh "T" {{
{TRIANGLE}point3f[] points.timeSamples = {{ 0: {triangle(0)}, 10: {triangle(10)} }}
}}
}}
"""
    )
    for frame in (-1, 0, 4, 10, 12):
        nothing_differs(path, "--interpolation", "held", frame=frame, interpolation="held")
        nothing_differs(path, "--interpolation", "linear", frame=frame)
    held = np.reshape(of(path, "/A/T")("--frame=4", "--interpolation", "held")[0]["matrix"], (4, 4))
    assert held[3, 0] == 0.0


def samples(rng, value):
    """Values at a few times of 0 to 10, some of them close together."""
    times = sorted({round(rng.uniform(0, 10), rng.choice([0, 1, 2])) for _ in range(rng.choice([1, 2, 4, 20]))})
    return "{ " + ", ".join(f"{time}: {value(rng)}" for time in times) + " }"


def moving(rng, kind, name, body=""):
    """A prim of `kind` whose transform has samples, or not."""
    place = lambda rng: tuple(round(rng.uniform(-5, 5), 3) for _ in range(3))
    angle, size = (lambda rng: round(rng.uniform(-180, 180), 2)), (lambda rng: round(rng.uniform(0.5, 2), 3))
    lines, order = [], []
    for type_, operation, value in (("double3", "translate", place), ("float", "rotateY", angle), ("float", "scaleX", size)):
        if rng.random() < 0.5:
            moves = rng.random() < 0.7
            lines.append(f"{type_} xformOp:{operation}" + (f".timeSamples = {samples(rng, value)}" if moves else f" = {value(rng)}"))
            order.append(f'"xformOp:{operation}"')
    lines.append(f"uniform token[] xformOpOrder = [{', '.join(order)}]")
    return f'def {kind} "{name}" {{\n' + "\n".join(lines) + f"\n{body}}}\n"


@pytest.mark.parametrize("seed", range(6))
def test_what_moves_within_the_shutter_moves_as_in_openusd(tmp_path, seed):
    rng = random.Random(seed)
    points = lambda rng: "[" + ", ".join(str(tuple(round(rng.uniform(-3, 3), 3) for _ in range(3))) for _ in range(3)) + "]"
    mesh = f"{TRIANGLE}point3f[] points.timeSamples = {samples(rng, points)}\n"
    still = TRIANGLE + POINTS
    flowing = f"{TRIANGLE}point3f[] points.timeSamples = {{ 4: {points(rng)} }}\nvector3f[] velocities.timeSamples = {{ 4: {points(rng)} }}\n"
    (tmp_path / "asset.usda").write_text('#usda 1.0\n(\ndefaultPrim = "Asset"\n)\n' + moving(rng, "Xform", "Asset", moving(rng, "Mesh", "Inner", mesh)))
    shared = 'def "Late" (references = @asset.usda@ (offset = 1.5; scale = 0.5)) {}\ndef "One" (instanceable = true; references = @asset.usda@) {}\n'
    lights = ["SphereLight", "RectLight", "DiskLight", "CylinderLight", "DistantLight", "DomeLight", "DomeLight_1"]
    inner = "".join(moving(rng, kind, f"L{i}") for i, kind in enumerate(lights))
    inner += moving(rng, "Mesh", "Soft", mesh) + moving(rng, "Mesh", "Hard", still) + moving(rng, "Mesh", "Flowing", flowing)
    open_, close = sorted(round(rng.uniform(-1, 2), 2) for _ in range(2))
    camera = moving(rng, "Camera", "Eye", f"double shutter:open = {open_}\ndouble shutter:close = {close}\n")
    path = tmp_path / "stage.usda"
    path.write_text(HEAD.format("") + moving(rng, "Xform", "World", inner + camera + shared))
    for frame in (0, 4, 5.5, 9):
        nothing_differs(path, frame=frame)
    answer = Answer(read(path, "--frame=5"))
    everything = [*answer.lights.values(), *answer.cameras.values(), *(i for all_ in answer.instances.values() for i in all_)]
    assert any(thing["motion"] for thing in everything), "nothing moves"


@pytest.mark.parametrize("frame", [-7, 0, 4.5, 10, 33])
@pytest.mark.parametrize("name", ["lights", "curves and points"])
def test_frames_of_stages_without_a_range_are_held_at_the_ends(tmp_path, name, frame):
    lines = ("    startTimeCode = 3\n", "    endTimeCode = 9\n")
    files = {file: text.replace(lines[0], "").replace(lines[1], "") for file, text in CASES[name].items()}
    write(tmp_path, files)
    nothing_differs(tmp_path / "root.usda", frame=frame)
    told = [warning for warning in read(tmp_path / "root.usda", f"--frame={frame}")["warnings"] if "no range" in warning]
    outside = [f"frame {frame}: ", " from 0 to 10; "]
    assert len(told) == (0 if 0 <= frame <= 10 else 1) and all(words in one for one in told for words in outside)
