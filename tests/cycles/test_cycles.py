"""Every pass of every stage, through every door, held against Cycles by `penumbra compare`.

Cycles' pictures stand in references/ (`validate.py --references` makes them). Every day another five stages are
rendered and another reference is made anew, to see whether it is still what Cycles gives; all of them with

    PENUMBRA_ALL=1 target/test-venv/bin/python -m pytest tests/cycles
"""

import datetime
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("OpenImageIO")
HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path.insert(0, str(HERE))
import doors  # noqa: E402

REFERENCES = HERE / "references"
FACTS = json.loads((REFERENCES / "facts.json").read_text())
PROGRAM = ROOT / os.environ.get("PENUMBRA", "target/debug/penumbra")
SIZE = FACTS["size"]
SAMPLES = 64
AMONG = 20 * len(doors.DOORS) * len(FACTS["stages"])
"""Passes that are judged in all."""


@pytest.fixture(scope="session")
def wheel(tmp_path_factory):
    if named := os.environ.get("PENUMBRA_WHEEL"):
        return (ROOT / named).resolve()
    sys.path.insert(0, str(ROOT / "addon"))
    from build import build_wheel

    return build_wheel(tmp_path_factory.mktemp("wheel"), "dev")


def differing(passes, facts, door):
    """Sentences on the passes that differ, but for those that are known to."""
    known = facts["passes"][door]
    return [f"{door} {it['pass']}: {it['why']}" for it in passes if it["verdict"] == "differs" and it["pass"] not in known]


def of_today(number):
    """So many stages, others every day; all where that is asked for."""
    names = list(FACTS["stages"])
    if os.environ.get("PENUMBRA_ALL"):
        return names
    first = number * datetime.date.today().toordinal()
    return [names[(first + i) % len(names)] for i in range(number)]


@pytest.mark.parametrize("stage", of_today(5))
def test_passes_are_those_of_cycles(stage, tmp_path, wheel):
    facts = FACTS["stages"][stage]
    doors.engines(stage, tmp_path, wheel, SIZE, SAMPLES, "penumbra,files")
    wrong, judged = [], {}
    for door in doors.DOORS:
        if door in facts["doors"]:
            continue
        if door != "blender":
            doors.render(PROGRAM, tmp_path, door, facts, SIZE, SAMPLES)
        passes = doors.compare(PROGRAM, REFERENCES / stage, tmp_path, door, "--no-flip", "--among", AMONG)
        judged[door] = {it["pass"] for it in passes}
        wrong += differing(passes, facts, door)
        assert all(it["not_finite"] == {"a": 0, "b": 0} for it in passes)
    assert not wrong, "\n".join(wrong)
    assert {"Combined", "Ambient Occlusion", "Diffuse Direct", "Depth", "Glossy Light Direct", "Transmission Light Indirect"} <= judged["blender"]
    assert ("Shadow" in judged["blender"]) == facts["lamps_alone"]


@pytest.mark.parametrize("stage", of_today(1))
def test_references_are_what_cycles_gives(stage, tmp_path, wheel):
    doors.engines(stage, tmp_path, wheel, SIZE, SAMPLES, "cycles")
    passes = doors.compare(PROGRAM, REFERENCES / stage, tmp_path, "cycles", "--no-flip", "--among", AMONG)
    assert not [it["why"] for it in passes if it["verdict"] == "differs" and it["pass"] not in FACTS["stages"][stage]["by_chance"]]
    assert len(passes) > 15


def test_a_bias_of_five_percent_is_found(tmp_path, wheel):
    """The judge can say no: a lamp of 5 % more power."""
    doors.engines("area_square", tmp_path, wheel, SIZE, SAMPLES, "files")
    scene = tmp_path / doors.FILES["usd"]
    brighter = tmp_path / "brighter.py"
    brighter.write_text(
        "import sys\nfrom pxr import Usd, UsdLux\nstage = Usd.Stage.Open(sys.argv[1])\n"
        "for prim in stage.Traverse():\n"
        "    if light := UsdLux.LightAPI(prim):\n"
        "        light.GetIntensityAttr().Set(1.05 * light.GetIntensityAttr().Get(1.0))\n"
        "stage.Save()\n"
    )
    done = subprocess.run([sys.executable, brighter, scene], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    facts = FACTS["stages"]["area_square"]
    doors.render(PROGRAM, tmp_path, "usd", facts, SIZE, SAMPLES)
    passes = doors.compare(PROGRAM, REFERENCES / "area_square", tmp_path, "usd", "--no-flip", "--among", AMONG)
    verdicts = {it["pass"]: it["verdict"] for it in passes}
    assert verdicts["Combined"] == verdicts["Diffuse Direct"] == "differs"
    assert verdicts["Ambient Occlusion"] != "differs" and verdicts["Shadow"] != "differs"


def test_closed_forms(tmp_path, wheel):
    """Where it is known what is right, Penumbra is: light within 0.1 %, its division into a color and the rest within 0.5 %."""
    done = subprocess.run([sys.executable, HERE / "closed_forms.py", tmp_path, "--wheel", wheel, "--engines", "PENUMBRA"], capture_output=True, text=True)
    assert done.returncode == 0, (done.stdout + done.stderr)[-4000:]
    tables = json.loads((tmp_path / "tables.json").read_text())
    # Nearer to a face than rounding is as if on it, which the table says.
    known = ("Ambient occlusion beside a wall", "0.0001 m, faces of 2000 m")
    wrong, rows = [], 0
    for table in tables:
        bar = 0.005 if table["title"].startswith("Color") else 0.001
        for name, truth, found in table["rows"]:
            rows += 1
            if abs(found / truth - 1.0) > bar and (table["title"], name) != known:
                wrong.append(f"{table['title']}, {name}: {found} instead of {truth}")
    assert not wrong, "\n".join(wrong)
    assert rows > 60
