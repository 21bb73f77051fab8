"""Builds the extension once and installs it in every Blender that is there.

Blenders are the environments `target/test-venv*` that tests/run makes, each with another version of the
bpy package. PENUMBRA_WHEEL names a wheel that is built already.
"""

import json
import os
import pathlib
import subprocess
import sys

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
HERE = pathlib.Path(__file__).resolve().parent


def _blenders():
    """Python of each Blender, by version."""
    found = {}
    for python in sorted((ROOT / "target").glob("test-venv*/bin/python")):
        packages = next((python.parents[1] / "lib").glob("python3*/site-packages"))
        version = next((p.name.split("-")[1] for p in packages.glob("bpy-*.dist-info")), None)
        if version is not None:
            found[".".join(version.split(".")[:2])] = python
    return found


BLENDERS = _blenders()


@pytest.fixture(scope="session")
def extension(tmp_path_factory):
    """The extension's zip."""
    wheel = os.environ.get("PENUMBRA_WHEEL")
    folder = tmp_path_factory.mktemp("addon")
    command = [sys.executable, ROOT / "addon" / "build.py", "--out", folder, "--profile", "dev"]
    if wheel:
        command += ["--wheel", wheel]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    return pathlib.Path(done.stdout.strip().splitlines()[-1])


class Blender:
    """One version, with the extension installed in a folder of its own."""

    def __init__(self, version, folder, extension):
        self.version, self.folder = version, folder
        self.python = BLENDERS[version]
        self.log = self.python_run(HERE / "install.py", extension)

    def python_run(self, *arguments, timeout=600):
        """Runs a script; returns what it printed."""
        environment = {**os.environ, "BLENDER_USER_RESOURCES": str(self.folder / "user")}
        environment["PYTHONPATH"] = str(HERE)
        # Of this version, as the program sets them; the package of 4.2 does not, and one that was imported here did.
        libraries = next(self.python.parents[1].glob("lib/python3*/site-packages/bpy/lib/materialx/libraries"), None)
        if libraries is not None:
            environment["PXR_MTLX_STDLIB_SEARCH_PATHS"] = environment["MATERIALX_SEARCH_PATH"] = str(libraries)
        done = subprocess.run(
            [self.python, *map(str, arguments)], env=environment, capture_output=True, text=True, timeout=timeout
        )
        output = done.stdout + done.stderr
        assert done.returncode == 0, f"Blender {self.version} ended with {done.returncode}:\n{output[-4000:]}"
        return output

    def run(self, job, *arguments):
        """Lets Blender do a job of jobs.py; returns its answer and what Blender printed."""
        target = self.folder / "answer.json"
        target.unlink(missing_ok=True)
        output = self.python_run(HERE / "harness.py", job, target, *arguments)
        answer = json.loads(target.read_text())
        assert "error" not in answer, answer["traceback"] + output[-4000:]
        return answer["result"], output


@pytest.fixture(scope="session", params=sorted(BLENDERS))
def blender(request, extension, tmp_path_factory):
    """Each version of Blender in turn."""
    return Blender(request.param, tmp_path_factory.mktemp(f"blender-{request.param}"), extension)
