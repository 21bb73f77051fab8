"""Direct light of Penumbra and of Cycles, case by case: means that agree, and the variance at equal samples.

    tests/run                                        # once: the Python environment with bpy and OpenImageIO
    cargo build --release --ignore-rust-version
    target/test-venv/bin/python benches/cycles/compare.py

prints a table; `--cases sphere,dome` takes some of them, `--json FILE` writes every figure, `--help` lists the rest.
Cycles' pictures are kept under target/cycles/ and rendered once; Penumbra's are rendered each time. Side-by-side
pictures stand beside them. Exits with 1 if a mean differs by more than 3 standard errors and 0.3 %.

The variance of a pixel is that of its value over independent seeds at the same samples per pixel, averaged over
pixels and channels; the ratio is Penumbra's to Cycles', below 1 where Penumbra is better. Everything is lit directly
and nothing else, so Combined is the direct light as it stands in the picture; it decides. Diffuse Direct is the same
divided by the albedo, coverage included: a pixel that a surface touches in one of its samples counts there as much as
a whole one, and two such pixels on a horizon outweigh all others (S1). "picture" is the RMS
difference of the two mean pictures beyond their noise, relative to the mean. Times are CPU seconds of one render
without loading, the median over seeds, and want a quiet machine. Cycles' seeds are not quite independent where its
noise is that of edges alone (its error against a converged picture is up to 6 % above this variance): that is to its
advantage.
"""

import argparse
import json
import subprocess
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

import numpy as np

import images
import penumbra
import scenes

ROOT = Path(__file__).resolve().parents[2]
PASSES = {"diffuse": "Diffuse Direct", "combined": "Combined"}
SIGMAS, SHARE = 3.0, 0.003
"""A mean that differs by more than both is wrong."""


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", default=",".join(scenes.CASES), help="names separated by commas; all unless set")
    parser.add_argument("--spp", type=int, default=64)
    parser.add_argument("--seeds", type=int, default=8, help="independent renders, 8 or more for a figure to report")
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--pattern", default="AUTOMATIC", help="of Cycles: AUTOMATIC or TABULATED_SOBOL")
    parser.add_argument("--penumbra", type=Path, default=ROOT / "target/release/penumbra", metavar="FILE")
    parser.add_argument("--only", choices=("cycles", "penumbra"), help="one half, without comparison")
    parser.add_argument("--json", type=Path, metavar="FILE")
    return parser.parse_args()


class Half:
    """What one renderer made of one case."""

    def __init__(self, folder, renderer, spp, seeds):
        files = [images.path(folder, renderer, spp, seed) for seed in range(seeds)]
        read = [images.read(file, *PASSES.values()) for file in files]
        self.seconds = float(np.median([seconds(file, attributes) for file, (_, attributes) in zip(files, read)]))
        self.passes = {name: Figures([pictures[i] for pictures, _ in read]) for i, name in enumerate(PASSES)}

    def figures(self):
        return {"seconds": self.seconds, **{name: it.figures() for name, it in self.passes.items()}}


def seconds(file, attributes):
    """CPU time of rendering: of Cycles' process, or Penumbra's own clock times its threads."""
    if "penumbra/seconds" in attributes:
        return float(attributes["penumbra/seconds"]) * float(attributes["penumbra/settings/threads"])
    return json.loads(file.with_suffix(".json").read_text())["cpu"]


class Figures:
    """Statistics of one pass over independent seeds."""

    def __init__(self, pictures):
        stack = np.array(pictures)
        self.seeds = len(stack)
        self.picture = stack.mean(0)
        means = stack.mean((1, 2, 3))
        self.mean, self.mean_error = means.mean(), means.std(ddof=1) / np.sqrt(self.seeds)
        self.variances = stack.var(0, ddof=1).mean(-1)
        self.variance = self.variances.mean()

    def figures(self):
        return {k: float(getattr(self, k)) for k in ("mean", "mean_error", "variance")}


def compared(ours, theirs):
    """The figures of one pass, Penumbra's against Cycles'."""
    difference = ours.mean / theirs.mean - 1
    error = np.hypot(ours.mean_error / ours.mean, theirs.mean_error / theirs.mean)
    ratio = ours.variance / theirs.variance
    # Of a ratio of means over the same pixels, which are taken for independent.
    scatter = (ours.variances - ratio * theirs.variances).std(ddof=1) / np.sqrt(ours.variances.size)
    noise = ours.variance / ours.seeds + theirs.variance / theirs.seeds
    beyond = max(np.mean((ours.picture - theirs.picture) ** 2) - noise, 0.0)
    return {
        "difference": float(difference),
        "difference_error": float(error),
        "agrees": bool(abs(difference) <= max(SIGMAS * error, SHARE)),
        "ratio": float(ratio),
        "ratio_error": float(scatter / theirs.variance),
        "picture": float(np.sqrt(beyond) / theirs.mean),
    }


def side_by_side(file, *halves):
    """Mean pictures of Combined, exposed alike: Penumbra's on the left."""
    pictures = [half.passes["combined"].picture for half in halves]
    images.write(file, np.concatenate(pictures, axis=1) * (0.6 / np.percentile(pictures[0], 90)))


def render_cycles(case, folder, options):
    command = [Path(__file__).parent / "reference.py", case.name, folder, options.spp, options.seeds, options.threads]
    done = subprocess.run(
        [sys.executable, *(str(part) for part in command), options.pattern], capture_output=True, text=True
    )
    if done.returncode:
        raise RuntimeError(f"{case.name}: {done.stderr.strip()}")


def measure(name, options):
    case = scenes.CASES[name]()
    folder = ROOT / "target" / "cycles" / f"{name}-{case.digest()}"
    folder.mkdir(parents=True, exist_ok=True)
    ours = theirs = None
    if options.only != "penumbra":
        render_cycles(case, folder, options)
        theirs = Half(folder, f"cycles-{options.pattern.lower()}", options.spp, options.seeds)
    if options.only != "cycles":
        penumbra.render(case, folder, options.spp, options.seeds, options.threads, options.penumbra)
        ours = Half(folder, "penumbra", options.spp, options.seeds)
    halves = {k: half for k, half in (("penumbra", ours), ("cycles", theirs)) if half}
    side_by_side(folder / "side_by_side.png", *halves.values())
    result = {k: half.figures() for k, half in halves.items()}
    if ours and theirs:
        result["compared"] = {k: compared(ours.passes[k], theirs.passes[k]) for k in PASSES}
    return result


COLUMNS = [
    "case", "mean of Diffuse Direct: Penumbra", "Cycles", "difference, %", "picture, %",
    "variance of Combined: Penumbra", "Cycles", "ratio", "ratio of Diffuse Direct", "seconds: Penumbra", "Cycles",
]


def row(name, result):
    cell = lambda half, *keys, form="{:.5g}": form.format(value(result, half, *keys)) if half in result else "—"
    columns = [name, cell("penumbra", "diffuse", "mean"), cell("cycles", "diffuse", "mean")]
    if "compared" in result:
        diffuse, combined = (result["compared"][k] for k in PASSES)
        mark = "" if diffuse["agrees"] and combined["agrees"] else " **differs**"
        columns += [f"{100 * diffuse['difference']:+.3f} ± {100 * diffuse['difference_error']:.3f}{mark}"]
        columns += [f"{100 * diffuse['picture']:.2f}"]
    else:
        columns += ["—", "—"]
    columns += [cell(half, "combined", "variance", form="{:.3g}") for half in ("penumbra", "cycles")]
    if "compared" in result:
        columns += [f"{it['ratio']:.2f} ± {it['ratio_error']:.2f}" for it in (combined, diffuse)]
    else:
        columns += ["—", "—"]
    columns += [cell(half, "seconds", form="{:.2f}") for half in ("penumbra", "cycles")]
    return "| " + " | ".join(columns) + " |"


def value(result, *keys):
    for key in keys:
        result = result[key]
    return result


def main():
    options = arguments()
    print(f"{scenes.SIZE}×{scenes.SIZE}, {options.spp} samples per pixel, {options.seeds} seeds, "
          f"{options.threads} thread(s), Cycles' pattern {options.pattern}\n")
    print(f"| {' | '.join(COLUMNS)} |\n|{'---|' * len(COLUMNS)}", flush=True)
    results = {}
    for name in options.cases.split(","):
        results[name] = measure(name, options)
        print(row(name, results[name]), flush=True)
    if options.json:
        settings = {"spp": options.spp, "seeds": options.seeds, "pattern": options.pattern, "size": scenes.SIZE}
        options.json.write_text(json.dumps({"settings": settings, "cases": results}, indent=1))
    both = [it["compared"][k] for it in results.values() if "compared" in it for k in PASSES]
    if both:
        print(f"\n{sum(it['agrees'] for it in both)} of {len(both)} means agree")
        combined = {name: it["compared"]["combined"] for name, it in results.items() if "compared" in it}
        excess = {name: (it["ratio"] - 1) / it["ratio_error"] for name, it in combined.items() if it["ratio"] > 1}
        clearly, barely = ([name for name, x in excess.items() if (x > 2) == far] for far in (True, False))
        print(f"more variance than Cycles: {', '.join(clearly) or 'none'}")
        print(f"more, but by less than two standard errors: {', '.join(barely) or 'none'}")
    return 0 if all(it["agrees"] for it in both) else 1


if __name__ == "__main__":
    sys.exit(main())
