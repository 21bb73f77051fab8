"""docs/hard-cases.md: what the Rust suite came to, and Cycles."""

import re

NONE = "No scene of Blender's asks for it."
ROOMS = {
    "Geometry": (
        ("scales", "Sizes and places", "Diffuse Direct of a white floor under a ball of light: the same at every size and in every place.", ""),
        ("coincident", "Faces in one place", "Diffuse Direct of the upper of faces that lie on each other, under a sun: cos θ.", ""),
        ("thin", "Grazing and thin", "Diffuse Direct of a floor under a grazing sun and seen at grazing angles, and of one of needles, through which nothing may be seen.", ""),
        ("transforms", "Transforms", "Diffuse Direct of a floor under a sun, whatever its transform is made of: cos θ.", ""),
        ("occlusion", "Beside a wall", "Ambient Occlusion of a floor beside a wall 1 m high: one less the wall's form factor, nearly one half.", ""),
        ("stadium", "Small beside large", "Diffuse Direct of specks and the floor below them, seen the way the sun shines: what a speck shades it hides.", ""),
        ("balls", "Balls", "Diffuse Direct of a white ball in a white world, where the ball fills the pixel.", "Blender's are points of a radius."),
        ("within", "Cameras within", "Combined of a camera inside glass, and of one on a floor. Blender's cameras see nothing within a micrometre.", ""),
    ),
    "Light": (
        ("rectangles", "Rectangles", "Diffuse Direct of one point of a white floor: Lambert's form factor of a polygon. A square metre, facing down to the floor or standing upright.", ""),
        ("spheres", "Spheres and disks", "Diffuse Direct of one point of a white floor, of a radiance by which it is 1.", ""),
        ("suns", "Suns and domes", "Diffuse Direct of a floor: cos θ while the sun is above the horizon; of the world with one bright texel the sum over what blends it with its neighbours.", ""),
        ("many", "Many and unlike", "Diffuse Direct of a floor under lamps that differ by 24 powers of ten, and under very many; layers of light groups.", ""),
        ("sizes", "Without size, or behind", "Diffuse Direct of a floor under a lamp of intensity π, 1, and beside it an emitter without area, which adds nothing; spots on their axis; lamps below the floor.",
         "Blender's spots are one degree wide at least, its lamps of radius 0 have an intensity instead of a radiance, and it has no cylinders."),
        ("terminator", "Shadow terminator", "A ball of few faces with smooth normals, 80 degrees from the sun, with the offset that Blender has by default.", ""),
    ),
    "Material": (
        ("roughness", "Roughness", "Combined of white metal in a white world: all light comes back.", ""),
        ("index", "Index of refraction", "Combined of white glass in a white world: all light comes back or through. In Cycles the Glass BSDF, whose microfacets conserve energy.", ""),
        ("nested", "Glass in glass", "Combined through media in media.", "What absorbs within what absorbs adds up in Blender, where the inner one replaces the outer here."),
        ("bounces", "Many bounces", "Combined within a closed white box that glows by 0.001: as much for each bounce, and for both ends.", ""),
        ("maps", "Maps", "Combined of a white surface in a white world under normals that can't be: nowhere above 1; and of a texture of which one texel of four, 0.5, is of use.", ""),
        ("opacity", "Opacity", "Combined of a film of albedo 0.75 above a floor of 0.25, under a sun.", ""),
    ),
    "Camera": (
        ("projections", "Projections", "The largest error in the Position pass of a wall two thousand times as wide as it is far, and Diffuse Direct of pictures of unlikely sizes. "
         "Cycles' first sample is 0.0005 pixels off the middle: 7e-5 halves of a picture of 15 pixels, times the aspect of its pixels where they are wide.", ""),
        ("lenses", "Lenses", "Combined of the edge of what glows: the share of a lens that sees it.", ""),
        ("told", "Told", "1 where a camera that can't be leads to a warning and a picture.", "Blender doesn't take such cameras, or says nothing of them."),
    ),
    "Numbers": (
        ("vanishing", "Vanishing", "Diffuse Direct of a floor that 1e-40 of the light reaches: nothing, or as little.", ""),
        ("overflow", "Overflow", "Samples that overflow are left out, and counted.", NONE),
        ("sums", "Long sums", "The mean of many samples in the film.", NONE),
        ("indices", "Far indices", "Sample patterns about the ends of 32 and 64 bits.", NONE),
        ("tables", "Tables", "What is drawn from tables that are almost all zero, and weights of multiple importance sampling.", NONE),
    ),
}  # fmt: skip
INTRO = """# Hard cases

What the author of a renderer would fear, each with an answer in closed form or in double precision. `tests/hard_cases/` holds {rows} cases to it: twice, in place and moved by some kilometres (or so far that what the case is about is still told apart), and the same bits on one thread and on three and on every instruction set that the machine has. Scenes at random are held to what must be: white ones in a white world are white, all look alike wherever they stand, however they are turned and whatever their scale is, and those that break the rules render without a panic and without a number that is none.

    cargo test --locked --ignore-rust-version --test hard_cases

The page is written by

    PENUMBRA_WRITES_PAGE=1 cargo test --locked --ignore-rust-version --test hard_cases
    target/test-venv/bin/python tests/cycles/hard_cases.py --found target/tmp/hard-cases

and with `--measure` the scenes are rendered with Cycles anew, whose figures stand in `tests/cycles/references/hard_cases.json`. The test fails where the page lacks a case, or has one that is not there any more.

Elsewhere: watertight meshes ([tests/bvh.rs](../tests/bvh.rs): two million rays every time, and 10⁸ at the vertices and edges of a mesh that is 300 times as long as it is thick by `cargo test --locked --ignore-rust-version --test bvh -- --ignored --nocapture`, none of which escaped on 2026-11-27, when the first run of that test had found six and their cause was mended), thin hairs and far balls ([tests/rounds.rs](../tests/rounds.rs)), every emitter from 1e-4 to 1e6 radii ([tests/lights/extremes.rs](../tests/lights/extremes.rs)) and lobes at extremes ([tests/bsdfs.rs](../tests/bsdfs.rs)). `cargo +nightly fuzz run scene` searches for scenes that break the build or a picture ([fuzz/fuzz_targets/scene.rs](../fuzz/fuzz_targets/scene.rs)); the tests build and render 2,000 at random and what was found before.

## How to read the tables

Figures are errors: relative ones, absolute ones where 0 is right. Penumbra's is the larger of both places; a row *holds* within its tolerance. Those of {version}, are of the same scene, made in Blender with the same numbers of samples or more, in place and moved; in **bold** beyond the tolerance, a dash where Blender can't express it. Blender keeps transforms in single precision and Cycles traces where things stand in the world, so that what is moved by 2.8 km is known to a quarter of a millimetre; Penumbra moves the scene before the camera in double precision.
"""
DIFFERS = """
## Where Cycles differs

In place, unless said otherwise:

- A rectangle close to a surface: {e:rectangle of 1 m, 1e-3 m above} of the light is missing 1 mm above the floor, {e:rectangle of 1 m, 1e-4 m above} at a tenth. One that is seen from 1 mm beside its plane lacks {e:rectangle 1e-3 m from edge-on}.
- Faces in one place are black: two of them, a thousand, and a hundred thousand instances. A ray leaves out the face it begins on and meets the other. Some kilometres away that is so for faces 1e-5 m apart, too.
- Beside very large triangles nothing has its place in Cycles: what is hit is known to a part of the triangle. Specks of a millimetre above a floor of 200 km shade other places than those below them ({e:a million specks of 1 mm above a floor of 200 km, seen from the sun} of the light; 2e-4 on a floor of 20 m), and of a wall two thousand times as wide as it is far the positions of a narrow view are off by {v:field of view of 0.01 degrees: largest error of a position, in halves of the picture} times half the picture.
- At a scale of 1e9 the floor is black: its triangle of 4e10 m is too large for single precision; one of a tenth is right.
- White metal of roughness 0.01 loses {e:white metal of roughness 1e-2 in a white world, 89.999 degrees from its normal} at a grazing angle (Penumbra about half of that, an open row), rough glass of index 0.999999 {e:white glass of index 0.999999 and roughness 0.3 in a white world, 89.999 degrees from its normal}, of 0.5 {e:white glass of index 0.5 and roughness 0.3 in a white world, 89.999 degrees from its normal}.
- The layer of a lamp that gives 1e-24 of the light is black, as it is here; without its light tree Cycles finds the lamp.
- A lens in focus at 0 sees nothing of what glows before it; here that is told, and it is a pinhole.
- A picture whose pixels are not square can't be saved by Blender 5.0.1 as EXR of several parts, as it does by default ("Error writing render result"); it takes `use_exr_interleave`.
"""


def short(number):
    """Few digits, of powers of ten where there would be many zeros."""
    if number == 0.0 or 0.01 <= abs(number) < 1000.0:
        return f"{number:.2g}" if abs(number) < 100.0 else f"{number:.0f}"
    mantissa, power = f"{number:.1e}".split("e")
    return f"{mantissa.removesuffix('.0')}e{int(power)}"


def right(number):
    mantissa, _, power = f"{number:.6g}".partition("e")
    return f"{mantissa}e{int(power)}" if power else mantissa


def error(value, truth):
    return abs(value - truth) / (abs(truth) or 1.0)


def line(row, values):
    """A row of a table."""
    cells = []
    for value in (values + [None, None])[:2]:
        off = None if value is None else error(value, row["truth"])
        cells.append("–" if off is None else short(off) if off <= row["tolerance"] else f"**{short(off)}**")
    holds = row["off"] <= row["tolerance"]
    state = f"open: {row['open']}" if row["open"] else "holds" if holds else "**does not hold**"
    return f"| {' | '.join([row['name'], right(row['truth']), short(row['off']), short(row['tolerance']), *cells, state])} |"


def page(found, version, measured):
    truths = {row["name"]: row["truth"] for rows in found.values() for row in rows}

    def figure(match):
        """Of Cycles in place: {e:NAME} its error, {v:NAME} its value."""
        kind, name = match.groups()
        return short(error(measured[name][0], truths[name]) if kind == "e" else measured[name][0])

    parts = [INTRO.format(rows=len(truths), version=version), re.sub("{([ev]):(.*?)}", figure, DIFFERS)]
    rooms = [room for group in ROOMS.values() for room in group]
    assert {room[0] for room in rooms} == set(found), "ROOMS has other rooms than the suite"
    for group, rooms in ROOMS.items():
        parts.append(f"\n## {group}\n")
        for room, title, what, why in rooms:
            sentence = f"{what} {why}".strip()
            parts.append(f"\n<a id=\"{room}\"></a>\n### {title}\n\n{sentence}\n\n| case | right | Penumbra | tolerance | Cycles | Cycles, moved | state |\n|---|---|---|---|---|---|---|\n")
            parts.append("".join(line(row, measured.get(row["name"], [])) + "\n" for row in found[room]))
    return "".join(parts)
