"""Renders of a stage through every door, and what `penumbra compare` says of each."""

import json
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))

import exr  # noqa: E402

FILES = {"usd": "scene.usdc", "gltf": "scene.glb"}
DOORS = ("blender", *FILES)
# Passes of Penumbra that Cycles has too, as the command line calls them.
PASSES = ("combined,depth,position,normal,uv,diffuse_direct,diffuse_indirect,diffuse_color,glossy_direct,glossy_indirect,"
          "glossy_color,transmission_direct,transmission_indirect,transmission_color,emission,environment,ao,shadow,unshadowed,"
          "crypto_object,crypto_material")


def engines(stage, folder, wheel, size, samples, only, python=sys.executable):
    """Blender's part, in a process of its own."""
    command = [python, HERE / "engines.py", stage, folder, "--size", f"{size[0]}x{size[1]}", "--samples", samples, "--only", only]
    command += ["--wheel", wheel] if wheel else []
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
    assert done.returncode == 0, (done.stdout + done.stderr)[-4000:]


def render(program, folder, door, facts, size, samples):
    """Two pictures of an exported file, by the command line."""
    for seed in (1, 2):
        command = [program, "render", folder / FILES[door], "-o", folder / f"{door}-{seed}.exr", "--spp", samples, "--seed", seed,
                   "--max-bounces", facts["bounces"], "--filter", "box:0.5", "--size", f"{size[0]}x{size[1]}", "--passes", PASSES,
                   "--ao-distance", facts["ao_distance"], "--progress", "none"]
        command += ["--frame", facts["frame"]] if facts["frame"] is not None else []
        done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
        assert done.returncode == 0, done.stderr


def compare(program, reference, folder, door, *options):
    """The verdict on each pass; `reference` is a folder with cycles-1.exr and cycles-2.exr."""
    # The page shows the names that it was given.
    where = folder / "compared"
    where.mkdir(exist_ok=True)
    files = [exr.with_light(path / f"{who}-{seed}.exr", where / f"{side}-{seed}.exr", first=path / f"{who}-1.exr").name
             for side, path, who in (("cycles", reference, "cycles"), (f"{door} again" if door == "cycles" else door, folder, door)) for seed in (1, 2)]
    command = [Path(program).resolve(), "compare", files[0], files[2], "--more-a", files[1], "--more-b", files[3], "--json", *options]
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, cwd=where)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)["passes"]
