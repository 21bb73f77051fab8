#!/usr/bin/env python3
"""How long Blender's scenes take to cross, and a stop to be heard, in each Blender that tests/run installed.

    target/test-venv/bin/python benches/blender.py [FILE.zip]

Builds the extension unless its zip is given.
"""

import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tests" / "addon"))

from conftest import BLENDERS, Blender  # noqa: E402


def main():
    if len(sys.argv) > 1:
        extension = pathlib.Path(sys.argv[1])
    else:
        built = subprocess.run([sys.executable, ROOT / "addon" / "build.py"], capture_output=True, text=True, check=True)
        extension = pathlib.Path(built.stdout.split()[-1])
    print(f"{'Blender':<10}{'triangles':>12}{'cross, s':>10}{'stop, s':>10}")
    for version in sorted(BLENDERS):
        with tempfile.TemporaryDirectory() as folder:
            blender = Blender(version, pathlib.Path(folder), extension)
            (seconds, triangles), _ = blender.run("mesh_time", 708)
            (stop, _), _ = blender.run("cancel", folder)
        print(f"{version:<10}{triangles:>12}{seconds:>10.3f}{stop:>10.3f}")


main()
