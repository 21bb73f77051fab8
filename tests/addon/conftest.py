"""Builds the extension once and installs it in every Blender that is there.

Blenders are the environments `target/test-venv*` that tests/run makes, each with another version of the
bpy package. PENUMBRA_WHEEL names a wheel that is built already.

Tests that are marked `by_turns` run in the newest of them and in one of the others, which goes by what they are about;
PENUMBRA_ALL=1 runs them in all.
"""

import json
import os
import pathlib
import subprocess
import sys
import threading
import zlib

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


def pytest_collection_modifyitems(config, items):
    """Leaves to each older Blender its turns."""
    older = sorted(BLENDERS)[:-1]
    if os.environ.get("PENUMBRA_ALL") or not older:
        return

    def is_due(item):
        if item.get_closest_marker("by_turns") is None:
            return True
        parameters = dict(item.callspec.params)
        version = parameters.pop("blender")
        about = zlib.crc32(f"{item.originalname} {sorted(parameters.items())}".encode())
        return version not in older or older[about % len(older)] == version

    due = [item for item in items if is_due(item)]
    config.hook.pytest_deselected(items=[item for item in items if not is_due(item)])
    items[:] = due


# Jobs that leave nothing behind in Blender which a new file does not clear: one process does them all.
SERVED = {"side_by_side", "passes_of_both", "through_the_doors"}


class Blender:
    """One version, with the extension installed in a folder of its own."""

    def __init__(self, version, folder, extension):
        self.version, self.folder = version, folder
        self.python = BLENDERS[version]
        self.server = None
        self.log = self.python_run(HERE / "install.py", extension)

    def environment(self):
        """That of its processes."""
        environment = {**os.environ, "BLENDER_USER_RESOURCES": str(self.folder / "user")}
        environment["PYTHONPATH"] = str(HERE)
        # Of this version, as the program sets them; the package of 4.2 does not, and one that was imported here did.
        libraries = next(self.python.parents[1].glob("lib/python3*/site-packages/bpy/lib/materialx/libraries"), None)
        if libraries is not None:
            environment["PXR_MTLX_STDLIB_SEARCH_PATHS"] = environment["MATERIALX_SEARCH_PATH"] = str(libraries)
        return environment

    def python_run(self, *arguments, timeout=600):
        """Runs a script; returns what it printed."""
        done = subprocess.run(
            [self.python, *map(str, arguments)], env=self.environment(), capture_output=True, text=True, timeout=timeout
        )
        output = done.stdout + done.stderr
        assert done.returncode == 0, f"Blender {self.version} ended with {done.returncode}:\n{output[-4000:]}"
        return output

    def run(self, job, *arguments):
        """Lets Blender do a job of jobs.py; returns its answer and what Blender printed."""
        target = self.folder / "answer.json"
        target.unlink(missing_ok=True)
        ask = self.serve if job in SERVED else self.do
        output = ask(job, target, *arguments)
        answer = json.loads(target.read_text())
        assert "error" not in answer, answer["traceback"] + output[-4000:]
        return answer["result"], output

    def do(self, *job):
        """A job in a process of its own."""
        return self.python_run(HERE / "harness.py", *job)

    def serve(self, *job, timeout=600):
        """A job in the process that does many; returns what it printed."""
        if self.server is None or self.server.poll() is not None:
            command = [self.python, HERE / "harness.py", "serve"]
            pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.DEVNULL}
            self.server = subprocess.Popen(command, env=self.environment(), text=True, **pipes)
        log = self.folder / "served.log"
        log.write_text("")
        self.server.stdin.write(json.dumps([str(part) for part in (log, *job)]) + "\n")
        self.server.stdin.flush()
        late = threading.Timer(timeout, self.server.kill)
        late.start()
        # What Blender prints before the first job comes on the same pipe.
        done = any(line == "done\n" for line in self.server.stdout)
        late.cancel()
        output = log.read_text(errors="replace")
        assert done, f"Blender {self.version} ended with {self.server.wait()}:\n{output[-4000:]}"
        return output

    def close(self):
        if self.server is not None:
            self.server.stdin.close()
            self.server.wait(timeout=60)


@pytest.fixture(scope="session", params=sorted(BLENDERS))
def blender(request, extension, tmp_path_factory):
    """Each version of Blender in turn."""
    found = Blender(request.param, tmp_path_factory.mktemp(f"blender-{request.param}"), extension)
    yield found
    found.close()
