"""Reading USD: Penumbra beside the real OpenUSD, on stages made here.

    tests/run                                        # once: the Python environment with usd-core
    cargo build --release --ignore-rust-version
    target/test-venv/bin/python benches/usd.py [--penumbra FILE] [--rounds N]

prints, for each stage, from inside a process of its own, start and exit not counted: the seconds in which the file
becomes a scene description (`penumbra info --json` tells), those in which OpenUSD opens it and copies the same arrays
or world transforms, and their ratio. Then the same as whole processes, `penumbra info` beside Python with OpenUSD,
Penumbra's peak memory, the seconds from the start of `penumbra render` until its first ray was traced (the stage read,
the scene prepared, one sample of one pixel), and those of a whole render of one sample on 8 × 8 pixels. Medians over
rounds in turn.
"""

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from pxr import Gf, Sdf, Usd, UsdGeom, Vt

ROOT = Path(__file__).resolve().parents[1]


def grid(n):
    """Points and triangles of a wavy square, and UVs of its corners."""
    x, y = np.meshgrid(*2 * [np.linspace(-1, 1, n, dtype=np.float32)])
    points = np.stack([x, 0.1 * np.sin(20 * x) * np.cos(17 * y), y], -1).reshape(-1, 3)
    j, i = np.meshgrid(*2 * [np.arange(n - 1)], indexing="ij")
    k = (j * n + i).ravel()
    corners = np.stack([k, k + n, k + 1, k + 1, k + n, k + n + 1], -1).reshape(-1)
    return points.astype(np.float32), corners.astype(np.int32), np.stack([x, y], -1).reshape(-1, 2)[corners]


def add_mesh(stage, path, n):
    points, corners, uvs = grid(n)
    mesh = UsdGeom.Mesh.Define(stage, path)
    mesh.CreateSubdivisionSchemeAttr("none")
    mesh.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(points))
    mesh.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(corners))
    mesh.CreateFaceVertexCountsAttr(Vt.IntArray.FromNumpy(np.full(len(corners) // 3, 3, np.int32)))
    mesh.CreateNormalsAttr(Vt.Vec3fArray.FromNumpy(np.tile(np.float32([0, 1, 0]), (len(points), 1))))
    mesh.SetNormalsInterpolation("vertex")
    st = UsdGeom.PrimvarsAPI(mesh).CreatePrimvar("st", Sdf.ValueTypeNames.TexCoord2fArray, "faceVarying")
    st.Set(Vt.Vec2fArray.FromNumpy(np.ascontiguousarray(uvs)))


def million(folder):
    """One mesh of a million triangles."""
    stage = Usd.Stage.CreateNew(str(folder / "million.usdc"))
    add_mesh(stage, "/World/Mesh", 708)
    stage.GetRootLayer().Save()


def copies(folder):
    """Ten million triangles by a point instancer."""
    stage = Usd.Stage.CreateNew(str(folder / "copies.usdc"))
    instancer = UsdGeom.PointInstancer.Define(stage, "/World/Copies")
    add_mesh(stage, "/World/Copies/Prototypes/Mesh", 71)
    instancer.CreatePrototypesRel().AddTarget("/World/Copies/Prototypes/Mesh")
    places = np.random.default_rng(1).uniform(-50, 50, (1021, 3)).astype(np.float32)
    instancer.CreateProtoIndicesAttr(Vt.IntArray(1021, 0))
    instancer.CreatePositionsAttr(Vt.Vec3fArray.FromNumpy(places))
    stage.GetRootLayer().Save()


def hairs(folder):
    """20,000 hairs of six points on a ball, their tips thin, and 4,000 points, each with a colour of its own."""
    random, count = np.random.default_rng(7), 20_000
    stage = Usd.Stage.CreateNew(str(folder / "hairs.usdc"))
    out = random.normal(size=(count, 3))
    out /= np.linalg.norm(out, axis=1, keepdims=True)
    bend = 0.2 * random.normal(size=(count, 3))
    steps = [out * (1 + 0.45 * t) + (bend - (0, 0.35, 0)) * t * t for t in np.linspace(0, 1, 6)]
    points = np.stack(steps, 1) + 0.012 * random.normal(size=(count, 6, 3))
    fur = UsdGeom.BasisCurves.Define(stage, "/World/Fur")
    fur.CreateBasisAttr("catmullRom")
    fur.CreateWrapAttr("pinned")
    fur.CreateCurveVertexCountsAttr(Vt.IntArray(count, 6))
    fur.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(points.reshape(-1, 3).astype(np.float32)))
    fur.CreateWidthsAttr(Vt.FloatArray.FromNumpy(np.tile(np.float32([8, 8, 7.5, 6.5, 5, 1]) / 1000, count)))
    fur.SetWidthsInterpolation("vertex")
    beads = UsdGeom.Points.Define(stage, "/World/Beads")
    beads.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(random.uniform((-3, -1.5, -3), (3, -1.4, 3), (4000, 3)).astype(np.float32)))
    beads.CreateWidthsAttr(Vt.FloatArray.FromNumpy(random.uniform(0.04, 0.1, 4000).astype(np.float32)))
    for prim, size, interpolation in ((fur, count, "uniform"), (beads, 4000, "vertex")):
        colors = random.uniform(0, 1, (size, 3)).astype(np.float32)
        prim.CreateDisplayColorPrimvar(interpolation).Set(Vt.Vec3fArray.FromNumpy(colors))
    stage.GetRootLayer().Save()


def references(folder, instanceable=False):
    """5,000 references to an asset of 20 prims: 100,000 prims."""
    asset = folder / "asset.usda"
    if not asset.exists():
        stage = Usd.Stage.CreateNew(str(asset))
        stage.SetDefaultPrim(UsdGeom.Xform.Define(stage, "/Asset").GetPrim())
        for i in range(19):
            UsdGeom.Cube.Define(stage, f"/Asset/Cube{i}").AddTranslateOp().Set((i, 0, 0))
        stage.GetRootLayer().Save()
    layer = Sdf.Layer.CreateNew(str(folder / ("instances.usda" if instanceable else "references.usda")))
    with Sdf.ChangeBlock():
        for i in range(5000):
            prim = Sdf.CreatePrimInLayer(layer, f"/World/Copy{i}")
            prim.specifier, prim.typeName = Sdf.SpecifierDef, "Xform"
            prim.referenceList.prependedItems = [Sdf.Reference("./asset.usda")]
            if instanceable:
                prim.SetInfo("instanceable", True)
            place = Sdf.AttributeSpec(prim, "xformOp:translate", Sdf.ValueTypeNames.Double3)
            place.default = Gf.Vec3d(0, i % 70, i // 70)
            order = Sdf.ValueTypeNames.TokenArray
            Sdf.AttributeSpec(prim, "xformOpOrder", order, Sdf.VariabilityUniform).default = ["xformOp:translate"]
    layer.GetPrimAtPath("/World").specifier = Sdf.SpecifierDef
    layer.Save()


def by_openusd(path):
    """Opens the stage and copies what a renderer needs first."""
    stage = Usd.Stage.Open(str(path))
    cache = UsdGeom.XformCache()
    for prim in Usd.PrimRange(stage.GetPseudoRoot(), Usd.TraverseInstanceProxies()):
        cache.GetLocalToWorldTransform(prim)
        if prim.IsA(UsdGeom.Mesh):
            mesh = UsdGeom.Mesh(prim)
            attributes = [mesh.GetPointsAttr(), mesh.GetFaceVertexIndicesAttr(), mesh.GetFaceVertexCountsAttr()]
            for attribute in [*attributes, mesh.GetNormalsAttr(), prim.GetAttribute("primvars:st")]:
                np.array(attribute.Get(), copy=True)
        elif prim.IsA(UsdGeom.PointBased):
            for name in ("points", "widths", "curveVertexCounts", "primvars:displayColor"):
                np.array(prim.GetAttribute(name).Get(), copy=True)


def seconds(run):
    start = time.perf_counter()
    run()
    return time.perf_counter() - start


def first_ray(program, path):
    """Seconds from the start of the program until it tells of its first ray."""
    command = [program, "render", path, "--size", "8x8", "--debug-sample", "4,4,0"]
    start = time.perf_counter()
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as run:
        if not run.stdout.readline():
            sys.exit(f"{path}: no sample was traced")
        return time.perf_counter() - start


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--penumbra", type=Path, default=ROOT / "target/release/penumbra", metavar="FILE")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--by-openusd", type=Path, metavar="STAGE", help="only print the seconds that OpenUSD takes")
    options = parser.parse_args()
    if options.by_openusd:
        return print(seconds(lambda: by_openusd(options.by_openusd)))
    run = lambda *args: subprocess.run(args, check=True, capture_output=True, text=True).stdout
    program = lambda *args: run(options.penumbra, *args)
    print(f"load before: {os.getloadavg()[0]:.1f}\n")
    print("| stage | Penumbra, s | OpenUSD, s | ratio | whole `info`, s | whole Python, s | MiB | first ray, s | render, s |")
    print("|---|---|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        million(folder)
        copies(folder)
        hairs(folder)
        references(folder)
        references(folder, True)
        for file in ("million.usdc", "copies.usdc", "hairs.usdc", "references.usda", "instances.usda"):
            path = folder / file
            rounds = []
            for _ in range(options.rounds):
                ours = json.loads(program("info", "--json", path))["read_s"]
                whole = seconds(lambda: program("info", path))
                start = time.perf_counter()
                theirs = float(run(sys.executable, __file__, "--by-openusd", path))
                rounds.append((ours, theirs, whole, time.perf_counter() - start))
            out = ("-o", folder / "out.exr", "--size", "8x8", "--spp", "1", "--progress", "none")
            whole = statistics.median(seconds(lambda: program("render", path, *out)) for _ in range(3))
            first = statistics.median(first_ray(options.penumbra, path) for _ in range(3))
            once = [sys.executable, "-c", "import resource,subprocess,sys; subprocess.run(sys.argv[1:], capture_output=True);"
                    "print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)", options.penumbra, "info", path]
            peak = int(subprocess.run([str(part) for part in once], capture_output=True, text=True).stdout) / 1024
            ours, theirs, *wholes = map(statistics.median, zip(*rounds))
            cells = [f"{ours:.3f}", f"{theirs:.3f}", f"{ours / theirs:.2f}", *(f"{whole:.2f}" for whole in wholes)]
            print("|", " | ".join([file, *cells, f"{peak:.0f}", f"{first:.2f}", f"{whole:.2f}"]), "|", flush=True)


if __name__ == "__main__":
    main()
