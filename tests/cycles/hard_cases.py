"""The rows of tests/hard_cases/ in Cycles, and docs/hard-cases.md from both.

    python hard_cases.py --found FOLDER [--measure [--only TEXT]]

FOLDER is `hard-cases/` in Cargo's folder for tests, where the Rust suite leaves what it came to. `--measure` renders the same
scenes (hard_scenes.py) with Cycles into references/hard_cases.json; without it the page (hard_page.py) is written from what
stands there.
"""

import argparse
import json
from pathlib import Path

from hard_page import page
from hard_scenes import MADE, MOVED, NotExpressible, Place, bpy, lab, np, scenes

HERE = Path(__file__).resolve().parent
REFERENCES = HERE / "references" / "hard_cases.json"
PAGE = HERE.parents[1] / "docs" / "hard-cases.md"


def value(row, at):
    """What Cycles has for a row in a place."""
    scene = lab.reset(row.size, row.spp, threads=2)
    scenes.world(0.0)
    Place.at = np.array(at, float)
    row.build()
    for limit in ("max", "diffuse", "glossy", "transmission"):
        setattr(scene.cycles, f"{limit}_bounces", row.bounces)
    for name in (row.layer, *row.passes):
        if not name.startswith("Combined"):
            setattr(bpy.context.view_layer, f"use_pass_{name.lower().replace(' ', '_')}", True)
    for obj in bpy.data.objects:
        obj.shadow_terminator_shading_offset = 0.0
        obj.shadow_terminator_geometry_offset = row.offset
    image_settings = scene.render.image_settings
    image_settings.media_type, image_settings.file_format = "MULTI_LAYER_IMAGE", "OPEN_EXR_MULTILAYER"
    # Blender 5.0.1 writes no file of several parts where pixels are not square.
    image_settings.use_exr_interleave = True
    channels = lab.render()

    def seen(layer, channel="R"):
        return channels[f"ViewLayer.{layer}.{channel}"]

    return float(row.by(seen, Place.at) if row.by else seen(row.layer).astype(float).mean())


def measure(found, only):
    """Renders the rows that the Rust suite has, in both places, and keeps what they came to."""
    wanted = {row["name"]: row for rows in found.values() for row in rows if only in row["name"]}
    kept = json.loads(REFERENCES.read_text())["values"] if only else {}
    for row in (row for rows in MADE for row in rows()):
        if row.name not in wanted:
            continue
        places = [np.zeros(3), MOVED if row.moved is None else row.moved]
        try:
            kept[row.name] = [value(row, at) for at, there in zip(places, wanted[row.name]["values"]) if there is not None]
        except NotExpressible as why:
            print(f"{row.name}: {why}", flush=True)
        else:
            print(f"{row.name}: {kept[row.name]} for {wanted[row.name]['truth']}", flush=True)
    version = f"Cycles of Blender {bpy.app.version_string}, on the CPU"
    names = [row["name"] for rows in found.values() for row in rows if row["name"] in kept]
    lines = ",\n".join(f"  {json.dumps(name)}: {json.dumps(kept[name])}" for name in names)
    REFERENCES.write_text(f'{{\n "version": {json.dumps(version)},\n "values": {{\n{lines}\n }}\n}}\n')


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--found", type=Path, required=True)
    parser.add_argument("--measure", action="store_true")
    parser.add_argument("--only", default="", help="measures the rows with this in their names, and keeps the others' figures")
    options = parser.parse_args()
    found = {file.stem: json.loads(file.read_text()) for file in sorted(options.found.glob("*.json"))}
    if options.measure:
        measure(found, options.only)
    kept = json.loads(REFERENCES.read_text())
    PAGE.write_text(page(found, kept["version"], kept["values"]))


if __name__ == "__main__":
    main()
