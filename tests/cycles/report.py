"""What validate.py found, as an index of pages and as the document with its pictures."""

import html

import numpy as np
import OpenImageIO as oiio

NAMES = {"blender": "add-on", "usd": "USD", "gltf": "glTF"}
SHOWN = {"Combined": "combined", "Ambient Occlusion": "ao", "Shadow": "shadow"}
PAGE = """<!doctype html><meta charset="utf-8"><title>Penumbra beside Cycles</title>
<style>body{font:15px/1.5 system-ui,sans-serif;background:#1d1d1d;color:#ddd;margin:24px}a{color:#7fb2e5}td,th{padding:2px 14px;text-align:left}
.differs{color:#ff7f6e}.agrees{color:#7fc97f}.known{color:#e0b060}</style>
<h1>Penumbra beside Cycles</h1><p>A is Cycles, B Penumbra; each page has all passes of a stage by one door.</p>
<table><tr><th>stage<th>what<th>add-on<th>USD<th>glTF</tr>%s</table>"""


def index(out, found, facts):
    """A list of all pages."""
    rows = []
    for name, by_door in found.items():
        cells = [html.escape(name), html.escape(facts[name]["what"])]
        for door in NAMES:
            if door not in by_door:
                cells.append(html.escape(facts[name]["doors"].get(door, "")))
                continue
            wrong = [it for it in by_door[door] if it["verdict"] == "differs"]
            kind = "agrees" if not wrong else "known" if all(it["known"] for it in wrong) else "differs"
            text = f"{len(by_door[door])} passes" + "".join(f", {it['pass']} differs" for it in wrong)
            cells.append(f'<a class="{kind}" href="pages/{name}-{door}/index.html">{html.escape(text)}</a>')
        rows.append("<tr>" + "".join(f"<td>{cell}" for cell in cells) + "</tr>")
    (out / "index.html").write_text(PAGE % "".join(rows))


def _cell(it):
    if it is None:
        return "—"
    if it["verdict"] == "same":
        return "same"
    share, error = it["bias_share"], it["standard_error"]
    if share is None:
        text = "0" if it["bias"] == 0.0 else f"{it['bias']:.1e}"
    else:
        text = f"{100 * share:+.2f}"
        if error is not None and it["mean"]:
            text += f" ± {100 * error / it['mean']:.2f}"
    return f"**{text}**" if it["verdict"] == "differs" else text


def _state(passes):
    """Of one stage through one door: how many agree, and what does not."""
    judged = [it for it in passes if it["verdict"] != "not judged"]
    wrong = [it for it in judged if it["verdict"] == "differs"]
    known = sum(bool(it["known"]) for it in wrong)
    text = f"{len(judged) - len(wrong)} agree"
    if known:
        text += f", {known} excepted"
    if len(wrong) > known:
        text += f", **{len(wrong) - known} differ**"
    return text


def _exceptions(found, facts):
    """Each reason once, with the passes that differ by it, where, and by how much."""
    reasons = {}
    for name, by_door in found.items():
        for door, passes in by_door.items():
            for it in passes:
                if it["verdict"] == "differs" and it["known"]:
                    at = reasons.setdefault(it["known"], {}).setdefault(it["pass"], {})
                    at.setdefault(door, []).append((name, it["bias_share"]))
    lines = []
    for reason, passes in reasons.items():
        lines += [f"- {reason[0].upper() + reason[1:]}:"]
        for which, doors in passes.items():
            # Doors at which the same stages differ share a line.
            lists = {}
            for door, at in doors.items():
                lists.setdefault(tuple(name for name, _ in at), []).append(door)
            for stages, at_doors in lists.items():
                text = "all stages" if len(stages) == len(found) else ", ".join(stages) if len(stages) <= 6 else f"{len(stages)} stages"
                shares = [100 * abs(share) for door in at_doors for _, share in doors[door] if share is not None]
                lines.append(f"    - {which} ({', '.join(NAMES[door] for door in at_doors)}): {text}" + (f"; bias up to {max(shares):.2f} %" if shares else ""))
    for door in NAMES:
        missing = {}
        for name in found:
            if why := facts[name]["doors"].get(door):
                missing.setdefault(why, []).append(name)
        lines += [f"- Not through {NAMES[door]}, {why}: {', '.join(names)}." for why, names in missing.items()]
    return lines or ["None."]


def _figure(value):
    return f"{value:.4g}"


def _closed_forms(tables):
    lines = []
    for table in tables:
        lines += [f"### {table['title']}", "", table["what"], "", f"| {table['argument']} | right | Cycles | Penumbra | Cycles is off by | Penumbra is off by |", "|---|---|---|---|---|---|"]
        for name, truth, *both in table["rows"]:
            shares = [100 * (value / truth - 1.0) for value in both]
            # What is off by more than one percent stands out.
            shares = [f"**{share:+.3g} %**" if abs(share) > 1.0 else f"{share:+.3f} %" for share in shares]
            lines.append(f"| {name} | {_figure(truth)} | " + " | ".join(_figure(value) for value in both) + " | " + " | ".join(shares) + " |")
        lines.append("")
    return lines


def document(path, out, found, facts, run, tables):
    """docs/validation/cycles.md and its pictures."""
    judged = [it for by_door in found.values() for passes in by_door.values() for it in passes if it["verdict"] != "not judged"]
    differs = [it for it in judged if it["verdict"] == "differs"]
    known = sum(bool(it["known"]) for it in differs)
    lines = [
        "# Every pass beside Cycles", "",
        "Made by `python tests/cycles/validate.py`; do not edit. Penumbra is held against Cycles 5.0.1 on every stage of",
        "[tests/cycles/stages.py](../../tests/cycles/stages.py), pass by pass, through three doors: the add-on, and the command line on what",
        "*Export for Penumbra* wrote as USD and as glTF. Cycles is set to be unbiased; Shadow and Unshadowed are taken from two renders of",
        "its more, where all light is of lamps, since it has no such pass. Glossy Light and Transmission Light are color × direct and",
        "color × indirect, of both sides.", "",
        f"{run['size'].replace('x', ' × ')} pixels, two pictures of {run['samples']} samples by each; the whole took {run['seconds'] / 60:.0f} minutes on {run['cores']} cores.", "",
        f"**{len(judged)} passes judged: {len(judged) - len(differs)} agree, {known} differ for a [known reason](#exceptions), {len(differs) - known} differ without one.**",
        "A pass differs where the mean of some block of 16 × 16 pixels, or of the picture, is off by more than three standard errors (corrected for",
        "the number of tests) *and* by more than 0.5 % of the pass's mean ([how](../compare.md)).", "",
        "| stage | what | " + " | ".join(NAMES.values()) + " |", "|---|---|" + "---|" * len(NAMES),
    ]
    for name, by_door in found.items():
        cells = [_state(by_door[door]) if door in by_door else "—" for door in NAMES]
        lines.append(f"| [{name}](#{name}) | {facts[name]['what']} | " + " | ".join(cells) + " |")
    lines += [
        "", "![Cycles, Penumbra, and their differences](../pictures/validation.jpg)", "",
        "*For each stage Combined, Ambient Occlusion and Shadow: Cycles, Penumbra through the add-on, difference × 4 about grey. Where light is",
        "not of lamps alone Cycles has no Shadow.*", "",
        "## Exceptions", "", *_exceptions(found, facts), "",
    ]
    if tables:
        lines += ["## Where it is known what is right", "", "One point of a floor, by both engines through Blender, beside a closed form or an integral in double precision;",
                  "figures that are off by more than 1 % are bold ([how](../../tests/cycles/closed_forms.py)).", "", *_closed_forms(tables)]
    lines += ["## The stages", "", "Bias of the whole picture in percent of the pass's mean, with its standard error; *same* is bit for bit; bold is what differs.", ""]
    for name, by_door in found.items():
        lines += [f"### {name}", "", "| pass | " + " | ".join(NAMES[door] for door in by_door) + " |", "|---|" + "---|" * len(by_door)]
        passes = list(dict.fromkeys(it["pass"] for list_ in by_door.values() for it in list_ if it["verdict"] != "not judged"))
        for which in passes:
            cells = [_cell(next((it for it in by_door[door] if it["pass"] == which), None)) for door in by_door]
            # A pass that is black in both needs no line.
            if set(cells) - {"same", "—"} or which in SHOWN:
                lines.append(f"| {which} | " + " | ".join(cells) + " |")
        lines.append("")
        open_ = [f"- {NAMES[door]}, {it['pass']}: {it['why']}. Open." for door, list_ in by_door.items() for it in list_ if it["verdict"] == "differs" and not it["known"]]
        lines += [*open_, ""] if open_ else []
    path.write_text("\n".join(lines).rstrip() + "\n")
    pictures(path.parent.parent / "pictures" / "validation.jpg", out, found)


def _read(path, name):
    file, number = oiio.ImageInput.open(str(path)), 0
    while file.seek_subimage(number, 0):
        spec = file.spec()
        for part in {channel.rpartition(".")[0] for channel in spec.channelnames}:
            if part.partition(".")[2] == name:
                order = [spec.channelnames.index(f"{part}.{c}") for c in "RGB"]
                return file.read_image(number, 0, 0, spec.nchannels, "float")[..., order].astype(float)
        number += 1
    return None


def _mean(folder, who, name):
    both = [_read(folder / f"{who}-{seed}.exr", name) for seed in (1, 2)]
    return None if both[0] is None or both[1] is None else 0.5 * (both[0] + both[1])


def _title(text, width, height=20):
    """A band with these words; without them where no font is found."""
    band = oiio.ImageBuf(oiio.ImageSpec(width, height, 3, "float"))
    oiio.ImageBufAlgo.render_text(band, 4, height - 6, text.replace("_", " "), 15, "", (0.6, 0.6, 0.6))
    return band.get_pixels(oiio.FLOAT).reshape(height, width, 3).astype(float)


def pictures(path, out, found):
    """Two stages to a row, nine pictures each: three passes by Cycles, by Penumbra, and their difference."""
    strips = []
    for name in found:
        strip = []
        for which in SHOWN:
            pair = [_mean(out / name, who, which) for who in ("cycles", "blender")]
            if pair[0] is None or pair[1] is None:
                size = _mean(out / name, "cycles", "Combined").shape
                strip += [np.full(size, 0.02)] * 3
                continue
            scale = 1.0 if which != "Combined" else 0.8 / max(np.percentile(pair[0], 98), 1e-6)
            strip += [scale * it for it in pair] + [0.2140 + 4.0 * scale * (pair[1] - pair[0])]
        strip = np.concatenate(strip, axis=1)
        strips.append(np.concatenate([_title(name, strip.shape[1]), strip], axis=0))
    if len(strips) % 2:
        strips.append(np.full_like(strips[0], 0.02))
    sheet = np.concatenate([np.concatenate(strips[i : i + 2], axis=1) for i in range(0, len(strips), 2)], axis=0)
    sheet = np.clip(sheet, 0.0, 1.0)
    encoded = np.where(sheet <= 0.0031308, 12.92 * sheet, 1.055 * np.maximum(sheet, 1e-9) ** (1 / 2.4) - 0.055)
    spec = oiio.ImageSpec(sheet.shape[1], sheet.shape[0], 3, "uint8")
    spec.attribute("CompressionQuality", 85)
    file = oiio.ImageOutput.create(str(path))
    assert file.open(str(path), spec) and file.write_image(encoded.astype(np.float32)), file.geterror()
    file.close()
