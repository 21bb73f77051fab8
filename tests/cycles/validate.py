"""Penumbra beside Cycles, every stage, pass and door: renders all, judges, writes the pages.

    tests/run                                               # once: the Python environment with bpy 5.0.1
    cargo build --release --ignore-rust-version
    target/test-venv/bin/python tests/cycles/validate.py    # builds the add-on

writes target/validation/index.html, a list of pages in which A is Cycles and B Penumbra, and docs/validation/cycles.md.
`--stages A,B` takes some and leaves docs/ alone, `--size`, `--samples` say how well, `--wheel FILE` takes a wheel that is
built already. `--references` renders Cycles' pictures for the tests instead. Exits with 1 where a pass differs that is
not known to.
"""

import argparse
import json
import os
import subprocess
import sys
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path[:0] = [str(HERE), str(ROOT / "addon")]

import doors
import exr
import report

OUT = ROOT / "target" / "validation"
REFERENCES = HERE / "references"
REFERENCE_SIZE, REFERENCE_SAMPLES = (64, 48), 512


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--stages", help="names separated by commas; all unless set")
    parser.add_argument("--size", default="128x96")
    parser.add_argument("--samples", type=int, default=512)
    parser.add_argument("--wheel", type=Path)
    parser.add_argument("--program", type=Path, default=ROOT / "target/release/penumbra")
    parser.add_argument("--references", action="store_true", help="render Cycles' pictures for the tests")
    parser.add_argument("--again", action="store_true", help="judge what is rendered already")
    return parser.parse_args()


def all_facts():
    """What stages.py says, which only Blender's Python can read."""
    code = (
        "import sys, json; sys.path.insert(0, sys.argv[1]); import bpy, stages\n"
        "facts = {}\n"
        "for name, it in stages.STAGES.items():\n"
        "    bpy.ops.wm.read_factory_settings(use_empty=True)\n"
        "    it.build()\n"
        "    scene = bpy.context.scene\n"
        "    distance = scene.world.light_settings.distance\n"
        "    frame = scene.frame_current if scene.render.use_motion_blur else None\n"
        "    passes = {door: {**stages.FACTORS, **it.passes.get('all', {}), **stages.NOT_CARRIED.get(door, {}), **it.passes.get(door, {})} for door in stages.DOORS}\n"
        "    facts[name] = dict(what=it.what, doors=it.doors, passes=passes, lamps_alone=it.lamps_alone, bounces=it.bounces, ao_distance=distance, frame=frame, by_chance=it.by_chance)\n"
        "print('FACTS' + json.dumps(facts))\n"
    )
    done = subprocess.run([sys.executable, "-c", code, HERE], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return json.loads(next(line for line in done.stdout.splitlines() if line.startswith("FACTS"))[5:])


def make_references(names, facts, wheel):
    for name in names:
        folder = OUT / "references" / name
        doors.engines(name, folder, wheel, REFERENCE_SIZE, REFERENCE_SAMPLES, "cycles")
        (REFERENCES / name).mkdir(parents=True, exist_ok=True)
        exr.pack(*([where / f"cycles-{seed}.exr" for seed in (1, 2)] for where in (folder, REFERENCES / name)))
        print(name, flush=True)
    tell_facts(facts)


def tell_facts(facts):
    """What the tests have to know, of the stages that have references."""
    there = {name: {**it, "passes": {door: sorted(passes) for door, passes in it["passes"].items()}}
             for name, it in facts.items() if (REFERENCES / name / "cycles-2.exr").exists()}
    text = json.dumps({"size": REFERENCE_SIZE, "samples": REFERENCE_SAMPLES, "stages": there}, indent=1)
    (REFERENCES / "facts.json").write_text(text + "\n")


def judge(name, facts, options, wheel, among):
    """Renders a stage through all doors; the passes of each, by door."""
    folder, size = OUT / name, [int(n) for n in options.size.split("x")]
    if not options.again:
        doors.engines(name, folder, wheel, size, options.samples, "cycles,penumbra,files")
    found = {}
    for door in doors.DOORS:
        if door in facts["doors"]:
            continue
        if door != "blender" and not options.again:
            doors.render(options.program, folder, door, facts, size, options.samples)
        found[door] = doors.compare(options.program, folder, folder, door, "--html", OUT / "pages" / f"{name}-{door}", "--among", among)
        for it in found[door]:
            if it["verdict"] == "differs":
                it["known"] = facts["passes"][door].get(it["pass"])
    return found


def closed_forms(wheel):
    """Both engines beside what is known to be right; of the last time where there is no wheel."""
    if wheel:
        subprocess.run([sys.executable, HERE / "closed_forms.py", OUT, "--wheel", wheel], check=True)
    return json.loads((OUT / "tables.json").read_text())


def main():
    options = arguments()
    facts = all_facts()
    names = options.stages.split(",") if options.stages else list(facts)
    wheel = options.wheel
    if wheel is None and not options.again and not options.references:
        from build import build_wheel

        wheel = build_wheel(OUT / "wheel", "release")
    if options.references:
        return make_references(names, facts, wheel)
    start, found, among = time.time(), {}, 20 * len(doors.DOORS) * len(names)
    for name in names:
        begun = time.time()
        found[name] = judge(name, facts[name], options, wheel, among)
        wrong = [f"{door} {it['pass']}" for door, passes in found[name].items() for it in passes if it["verdict"] == "differs" and not it["known"]]
        print(f"{name}: {time.time() - begun:.0f} s; {'differs: ' + ', '.join(wrong) if wrong else 'agrees'}", flush=True)
    report.index(OUT, found, facts)
    if not options.stages:
        tables = closed_forms(None if options.again else wheel)
        run = OUT / "run.json"
        if not options.again:
            run.write_text(json.dumps({"size": options.size, "samples": options.samples, "seconds": time.time() - start, "cores": os.cpu_count()}))
        report.document(ROOT / "docs" / "validation" / "cycles.md", OUT, found, facts, json.loads(run.read_text()), tables)
    return any(it["verdict"] == "differs" and not it["known"] for doors_ in found.values() for passes in doors_.values() for it in passes)


if __name__ == "__main__":
    sys.exit(main())
