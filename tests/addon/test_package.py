"""The extension as a package: Blender's own checks, what it leaves behind, and the wheel as a Python package."""

import json
import os
import subprocess
import sys
import zipfile

import pytest
from conftest import BLENDERS, HERE, ROOT


def blenders_tool(version):
    """Blender's command-line tool for extensions."""
    (found,) = BLENDERS[version].parents[1].glob("lib/python3*/site-packages/bpy/*/scripts/addons_core/bl_pkg/cli/blender_ext.py")
    return found


@pytest.mark.parametrize("version", sorted(BLENDERS))
def test_blender_validates_and_builds_it(extension, tmp_path, version):
    def tool(*arguments):
        command = [BLENDERS[version], blenders_tool(version), *arguments]
        done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
        assert done.returncode == 0 and "ERROR" not in done.stdout, done.stdout + done.stderr

    tool("validate", extension)
    source = tmp_path / "source"
    zipfile.ZipFile(extension).extractall(source)
    tool("validate", source)
    tool("build", "--source-dir", source, "--output-dir", tmp_path)
    (built,) = tmp_path.glob("*.zip")
    ours, theirs = (set(zipfile.ZipFile(path).namelist()) for path in (extension, built))
    assert {name for name in theirs if not name.endswith("/")} == ours


@pytest.mark.parametrize("version", sorted(BLENDERS))
def test_nothing_is_left_behind(extension, tmp_path, version):
    answer = tmp_path / "answer.json"
    environment = {**os.environ, "BLENDER_USER_RESOURCES": str(tmp_path / "user")}
    command = [BLENDERS[version], HERE / "lifecycle.py", extension, answer]
    done = subprocess.run([str(part) for part in command], env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "Traceback" not in done.stdout + done.stderr
    steps = json.loads(answer.read_text())
    before, on = steps["before"], steps["installed"]
    for kind in ("classes", "engines", "menus", "properties", "addons"):
        assert on["held"][kind] != before["held"][kind], kind
    assert on["files"] and on["modules"]
    for step in ("enabled", "installed again"):
        assert steps[step]["held"] == on["held"], step
        assert steps[step]["files"] == on["files"], step
    assert steps["disabled"]["held"] == before["held"]
    assert steps["uninstalled"] == before


@pytest.mark.parametrize("version", sorted(BLENDERS))
def test_an_engine_of_the_same_version_takes_the_place_of_another(extension, tmp_path, version):
    """Blender keeps wheels by name and version; two builds of the same version are told apart all the same."""
    wheel = tmp_path / "first.whl"
    with zipfile.ZipFile(extension) as archive:
        (name,) = (name for name in archive.namelist() if name.endswith(".whl"))
        wheel.write_bytes(archive.read(name))
    edited = tmp_path / "edited" / name.partition("/")[2]
    edited.parent.mkdir()
    with zipfile.ZipFile(wheel) as source, zipfile.ZipFile(edited, "w") as target:
        for info in source.infolist():
            mark = b"\nEDITED = True\n" if info.filename == "penumbra/__init__.py" else b""
            target.writestr(info, source.read(info) + mark)
    command = [sys.executable, ROOT / "addon" / "build.py", "--out", tmp_path / "out", "--wheel", edited]
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    other = done.stdout.strip().splitlines()[-1]
    environment = {**os.environ, "BLENDER_USER_RESOURCES": str(tmp_path / "user")}
    for package, is_edited in ((extension, False), (other, True), (extension, False)):
        command = [str(part) for part in (BLENDERS[version], HERE / "install.py", package)]
        done = subprocess.run(command, env=environment, capture_output=True, text=True)
        assert done.returncode == 0 and "Traceback" not in done.stdout + done.stderr, done.stdout + done.stderr
        found = list((tmp_path / "user").rglob("site-packages/penumbra/__init__.py"))
        assert len(found) == 1 and ("EDITED" in found[0].read_text()) == is_edited, package
        assert len(list((tmp_path / "user").rglob("penumbra-*.dist-info"))) == 1


# What `import penumbra` is to be capable of outside of Blender.
SCRIPT = """
import sys
import numpy as np
import penumbra
from pxr import Gf, Sdf, Usd, UsdGeom, UsdLux

assert penumbra.__doc__ and penumbra.render.__doc__
names = {row["name"] for row in penumbra.settings()}
assert {"spp", "seed", "max_bounces"} <= names

stage = Usd.Stage.CreateInMemory()
UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.y)
UsdGeom.SetStageMetersPerUnit(stage, 1.0)
floor = UsdGeom.Mesh.Define(stage, "/floor")
floor.CreatePointsAttr([(-5, 0, -5), (-5, 0, 5), (5, 0, 5), (5, 0, -5)])
floor.CreateFaceVertexCountsAttr([4])
floor.CreateFaceVertexIndicesAttr([0, 1, 2, 3])
light = UsdLux.SphereLight.Define(stage, "/light")
light.CreateRadiusAttr(0.1)
light.CreateIntensityAttr(100.0)
UsdGeom.XformCommonAPI(light).SetTranslate((0, 2, 0))
camera = UsdGeom.Camera.Define(stage, "/camera")
UsdGeom.XformCommonAPI(camera).SetTranslate((0, 1, 4))

options = dict(size=(32, 24), spp=16, passes=["combined", "ao", "shadow"])
first = penumbra.render(stage, **options)
assert first.layers == ["Combined", "Ambient Occlusion", "Shadow"], first.layers
assert first["Combined"].shape == (24, 32, 4) and first["Combined"].dtype == np.float32
assert first["Combined"].mean() > 0.0

# An edit that exists in memory alone.
light.GetIntensityAttr().Set(200.0)
second = penumbra.render(stage, **options)
assert np.allclose(second["Combined"][..., :3], 2.0 * first["Combined"][..., :3], rtol=1e-5)
stage.SetEditTarget(stage.GetSessionLayer())
UsdGeom.Imageable(floor).MakeInvisible()
assert penumbra.render(stage, **options)["Combined"][..., :3].max() < second["Combined"][..., :3].max()

# The same from a file.
stage.GetRootLayer().Export(sys.argv[1])
filed = penumbra.render(sys.argv[1], **options)
assert np.array_equal(filed["Combined"], second["Combined"])

seen = []
stopped = penumbra.render(sys.argv[1], size=(64, 48), spp=1000000, observer=lambda told: seen.append(told) or len(seen) > 3)
assert stopped.interrupted and seen
for wrong, error in ((dict(passes=["nonsense"]), ValueError), (dict(nonsense=1), TypeError), (dict(spp=-1), ValueError)):
    try:
        penumbra.render(sys.argv[1], **wrong)
    except error as raised:
        assert str(raised), wrong
    else:
        raise AssertionError(wrong)
for source, error in ((sys.argv[1] + ".none.usda", OSError), (7, TypeError)):
    try:
        penumbra.render(source)
    except error as raised:
        assert str(raised), source
    else:
        raise AssertionError(source)
"""


def test_the_wheel_is_a_package_of_its_own(extension, tmp_path):
    pytest.importorskip("pxr", reason="usd-core is not installed")
    with zipfile.ZipFile(extension) as archive:
        (wheel,) = [name for name in archive.namelist() if name.endswith(".whl")]
        archive.extract(wheel, tmp_path)
    zipfile.ZipFile(tmp_path / wheel).extractall(tmp_path / "packages")
    package = tmp_path / "packages" / "penumbra"
    assert (package / "py.typed").exists() and (package / "__init__.pyi").exists()
    environment = {**os.environ, "PYTHONPATH": str(tmp_path / "packages")}
    done = subprocess.run([sys.executable, "-c", SCRIPT, str(tmp_path / "stage.usda")], env=environment,
                          capture_output=True, text=True, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
