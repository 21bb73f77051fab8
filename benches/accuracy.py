"""How well estimated errors hold: predicted against true ones, over many scenes, sample counts and seeds.

    tests/run                                        # once: the Python environment with OpenImageIO
    cargo build --release --ignore-rust-version
    target/test-venv/bin/python benches/accuracy.py [--penumbra FILE] [--out RESULT.json] [--spp 16,32,64] [NAME ...]
    target/test-venv/bin/python benches/accuracy.py --out RESULT.json --forecast       # those alone, again
    target/test-venv/bin/python benches/accuracy.py --table RESULT.json

The truth is the difference to a picture of 64 times as many samples as the longest render has, with a seed of its
own. For each scene, number of samples and seed: predicted and true RMSE, relMSE and display error. With one more render
each: the variance of the same samples in one sequence (the price of an error that is known), that of samples which
neighbours' noise has dealt out (--adaptive), and the seconds to a target as forecast at a tenth of them.
`--table` prints the tables of docs/accuracy.md.
"""

import argparse
import json
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import OpenImageIO as oiio

sys.path.insert(0, str(Path(__file__).resolve().parent / "accuracy"))
from stages import stages  # noqa: E402

ROOT = Path(__file__).resolve().parents[1]
SCENES = ROOT / "scenes"
SIZE = (64, 43)
SEEDS = (1, 2, 3)
NUMBERS = ("display", "rmse", "rel_mse")
# The target of the forecast is so much below the error after 16 samples.
FALL = 5


def scenes(folder):
    """Arguments of the program by name."""
    result = {}
    for name, text in stages().items():
        path = folder / f"{name}.usda"
        path.write_text(text)
        result[name] = [path]
    result |= {
        "wheel": [SCENES / "wheel.usda"],
        "lamps": [SCENES / "lamps.glb"],
        "field": [SCENES / "field.glb", "--environment", SCENES / "evening.hdr"],
        "interior": [SCENES / "interior.glb", "--environment", SCENES / "sky.hdr"],
        "still_life": [SCENES / "still_life.glb"],
    }
    return {name: [str(arg) for arg in args] for name, args in result.items()}


class Bench:
    def __init__(self, program, folder):
        self.program, self.folder = program, folder

    def render(self, scene, *args):
        """(Combined, attributes, seconds, what it told) of a render."""
        out = self.folder / "out.exr"
        size = "x".join(map(str, SIZE))
        command = [self.program, "render", *scene, "-o", out, "--size", size, *map(str, args)]
        start = time.perf_counter()
        done = subprocess.run(command, capture_output=True, text=True)
        seconds = time.perf_counter() - start
        if done.returncode:
            raise SystemExit(f"{' '.join(map(str, command))}: {done.stderr}")
        image = oiio.ImageInput.open(str(out))
        spec = image.spec()
        pixels = image.read_image(0, 0, 0, 3, "float")
        attributes = {a.name: a.value for a in spec.extra_attribs if a.name.startswith("penumbra/")}
        image.close()
        return pixels.reshape(spec.height, spec.width, 3).astype(np.float64), attributes, seconds, done.stderr


def luminance(picture):
    return picture @ [0.2126, 0.7152, 0.0722]


def around(values):
    """Mean over 3 x 3 pixels, of those that are there at the picture's edge."""
    padded = np.pad(values, 1, constant_values=np.nan)
    height, width = values.shape
    parts = [padded[y:y + height, x:x + width] for y in range(3) for x in range(3)]
    return np.nanmean(parts, axis=0)


def slope(y):
    y = np.maximum(y, 1e-9)
    curve = np.where(y <= 1, 1.055 / 2.4 * y ** (1 / 2.4 - 1), 1.055 / 2.4 / y)
    return np.where(y <= 0.0031308, 12.92, curve)


def truth(picture, reference):
    """The numbers as they are."""
    squares = (picture - reference) ** 2
    scale = slope(around(luminance(reference)))[..., None] ** 2
    return {
        "display": float(np.sqrt((squares * scale).mean())),
        "rmse": float(np.sqrt(squares.mean())),
        "rel_mse": float((squares / (reference**2 + 0.01)).mean()),
    }


def predicted(attributes):
    """Value and interval by number; None where there is none."""
    result = {}
    for name in NUMBERS:
        text = attributes[f"penumbra/error/{name}"]
        result[name] = None if text.startswith("not") else [float(part) for part in text.split()]
    return result


def forecast(bench, scene, first):
    """Seconds of a render to a target, and how far off what was foretold at a tenth of them was."""
    target = first / FALL
    _, attributes, _, told = bench.render(
        scene, "--error", f"{target:.6g}", "--spp", 2048, "--progress", "json", "--seed", 5)
    end = float(attributes["penumbra/seconds"])
    value = attributes["penumbra/error/display"]
    reached = not value.startswith("not") and float(value.split()[0]) <= target
    lines = [json.loads(line) for line in told.splitlines() if line.startswith("{")]
    foretold = [
        [line["elapsed_s"] + seconds for seconds in line["to_target_s"]]
        for line in lines
        if line.get("to_target_s") and line["elapsed_s"] >= 0.1 * end and line["elapsed_s"] < 0.25 * end
    ]
    return {"seconds": end, "reached": reached, "spp": float(attributes["penumbra/samples"]),
            "foretold": foretold[0] if foretold else None}


def measure(bench, scene, counts):
    longest = max(counts)
    reference, _, seconds, _ = bench.render(scene, "--spp", 64 * longest, "--seed", 1000, "--progress", "none")
    result = {"reference_seconds": seconds, "renders": [], "plain": [], "adaptive": []}
    for spp in counts:
        for seed in SEEDS:
            common = ("--spp", spp, "--seed", seed, "--progress", "none")
            picture, attributes, _, _ = bench.render(scene, *common, "--passes", "combined,error")
            result["renders"].append(
                {"spp": spp, "seed": seed, "predicted": predicted(attributes), "true": truth(picture, reference)})
            picture, _, _, _ = bench.render(scene, *common)
            result["plain"].append({"spp": spp, "seed": seed, "true": truth(picture, reference)})
            if spp == longest:
                picture, attributes, _, _ = bench.render(scene, *common, "--adaptive", "on")
                result["adaptive"].append({"spp": float(attributes["penumbra/samples"]), "seed": seed,
                                           "predicted": predicted(attributes), "true": truth(picture, reference)})
    return result


def foretell(bench, scene, result):
    """Adds the forecast to what was measured, where the first error is known."""
    first = min(row["spp"] for row in result["renders"])
    known = [row["predicted"]["display"] for row in result["renders"] if row["spp"] == first]
    known = [figure[0] for figure in known if figure]
    if known:
        result["forecast"] = forecast(bench, scene, statistics.mean(known))


def share(hits):
    hits = list(hits)
    return f"{sum(hits)} of {len(hits)} ({100 * sum(hits) / max(len(hits), 1):.0f} %)"


def cases(results, name, kind="renders"):
    """Predicted and true values of a number wherever it is known."""
    rows = [row for scene in results.values() for row in scene[kind]]
    return [(row["predicted"][name], row["true"][name]) for row in rows if row["predicted"][name]], len(rows)


def table(results):
    print("| number | known | within 10 % | true one in the 95 % interval | mean of predicted / true |")
    print("|---|---|---|---|---|")
    for kind, title in (("renders", ""), ("adaptive", ", `--adaptive`")):
        for name in NUMBERS:
            known, all_ = cases(results, name, kind)
            # A mean of squares is within 21 % where its root is within 10 %.
            near = [0.9 < (p[0] / t) ** (0.5 if name == "rel_mse" else 1) < 1.1 for p, t in known]
            held = [p[1] <= t <= p[2] for p, t in known]
            ratio = statistics.geometric_mean([p[0] / t for p, t in known])
            print(f"| {name}{title} | {len(known)} of {all_} | {share(near)} | {share(held)} | {ratio:.3f} |")
    print()
    print("| scene | display error at 16 spp | known | worst predicted / true | price of replicates | gain of adaptive | forecast / real time |")
    print("|---|---|---|---|---|---|---|")
    for name, scene in sorted(results.items()):
        first = min(row["spp"] for row in scene["renders"])
        last = max(row["spp"] for row in scene["renders"])
        error = statistics.mean(row["true"]["display"] for row in scene["renders"] if row["spp"] == first)
        pairs = [(r["predicted"]["display"][0], r["true"]["display"]) for r in scene["renders"] if r["predicted"]["display"]]
        worst = max((p / t for p, t in pairs), key=lambda ratio: abs(np.log(ratio)), default=None)

        def mse(kind, spp, key="display"):
            return statistics.mean(r["true"][key] ** 2 for r in scene[kind] if spp is None or r["spp"] == spp)

        price = mse("renders", last) / mse("plain", last)
        gain = mse("renders", last) / mse("adaptive", None)
        told = scene.get("forecast")
        time_ = "—"
        if told and told["foretold"] and told["reached"]:
            likely, low, high = told["foretold"]
            time_ = f"{likely / told['seconds']:.2f} ({low / told['seconds']:.2f}–{high / told['seconds']:.2f})"
        worst = "—" if worst is None else f"{worst:.3f}"
        print(f"| {name} | {error:.4f} | {len(pairs)} of {len(scene['renders'])} | {worst} | {price:.2f} | {gain:.2f} | {time_} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--penumbra", default=str(ROOT / "target/release/penumbra"))
    parser.add_argument("--out", type=Path, default=Path("accuracy.json"))
    parser.add_argument("--spp", default="16,32,64")
    parser.add_argument("--table", type=Path)
    parser.add_argument("--forecast", action="store_true")
    parser.add_argument("names", nargs="*")
    args = parser.parse_args()
    if args.table:
        table(json.loads(args.table.read_text()))
        return
    counts = [int(n) for n in args.spp.split(",")]
    results = json.loads(args.out.read_text()) if args.out.exists() else {}
    with tempfile.TemporaryDirectory() as folder:
        bench = Bench(args.penumbra, Path(folder))
        for name, scene in scenes(Path(folder)).items():
            if (name in results) != args.forecast or (args.names and name not in args.names):
                continue
            start = time.perf_counter()
            if not args.forecast:
                results[name] = measure(bench, scene, counts)
            foretell(bench, scene, results[name])
            args.out.write_text(json.dumps(results))
            print(f"{name}: {time.perf_counter() - start:.0f} s", file=sys.stderr)
    table(results)


if __name__ == "__main__":
    main()
