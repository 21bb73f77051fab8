"""`penumbra compare` judged by others: OpenImageIO's figures, NVIDIA's FLIP, files that Blender and OpenImageIO wrote,
and its page in a browser."""

import json
import os
import re
import shutil
import subprocess
from pathlib import Path

import flip_evaluator
import numpy as np
import OpenImageIO as oiio
import pytest

ROOT = Path(__file__).resolve().parents[2]
PENUMBRA = ROOT / os.environ.get("PENUMBRA", "target/debug/penumbra")
BROWSER = shutil.which("chromium") or shutil.which("google-chrome")
SIZE = (72, 96)
"""Rows, columns."""


def write(path, parts, form="float", tile=0, single=False):
    """Parts as name to (channels, pixels); `single`: all of them in one part, by full names."""
    path = str(path)
    out = oiio.ImageOutput.create(path)
    if single:
        names = [f"{name}.{c}" for name, (channels, _) in parts.items() for c in channels]
        pixels = np.concatenate([pixels for _, pixels in parts.values()], axis=-1)
        parts = {"": (names, pixels)}
    specs = []
    for name, (channels, pixels) in parts.items():
        spec = oiio.ImageSpec(pixels.shape[1], pixels.shape[0], len(channels), form)
        spec.channelnames = tuple(channels)
        spec.attribute("compression", "zip")
        if tile:
            spec.tile_width = spec.tile_height = tile
        if name:
            spec.attribute("oiio:subimagename", name)
        specs.append(spec)
    assert out.open(path, tuple(specs)) if len(specs) > 1 else out.open(path, specs[0]), out.geterror()
    for index, (spec, (_, pixels)) in enumerate(zip(specs, parts.values())):
        if index:
            assert out.open(path, spec, "AppendSubimage"), out.geterror()
        assert out.write_image(np.ascontiguousarray(pixels, np.float32)), out.geterror()
    out.close()
    return path


def run(*arguments, code=0):
    done = subprocess.run([str(part) for part in (PENUMBRA, "compare", *arguments)], capture_output=True, text=True)
    assert done.returncode == code, done.stdout + done.stderr
    return done


def compared(*arguments):
    """Passes by name."""
    return {it["pass"]: it for it in json.loads(run(*arguments, "--json").stdout)["passes"]}


def picture(seed=0, largest=1.0):
    """Something with edges, gradients and noise."""
    rng = np.random.default_rng(7)
    y, x = np.mgrid[0 : SIZE[0], 0 : SIZE[1]]
    base = np.stack([0.2 + 0.6 * x / SIZE[1], 0.5 + 0.4 * np.sin(y / 5.0), 0.3 + 0.0 * x], axis=-1)
    base[20:40, 30:60] = (0.9, 0.1, 0.2)
    base *= np.exp(np.log(largest) * x / SIZE[1])[..., None]
    noise = np.random.default_rng(seed + 1).normal(0.0, 0.05, base.shape) if seed else rng.normal(0.0, 0.02, base.shape)
    return np.maximum(base * (1.0 + noise), 0.0).astype(np.float32)


def test_figures_are_those_of_openimageio(tmp_path):
    a, b = picture(0, 8.0), picture(1, 8.0)
    files = [write(tmp_path / name, {"ViewLayer.Combined": ("RGB", it)}) for name, it in (("a.exr", a), ("b.exr", b))]
    ours = compared(*files)["Combined"]
    theirs = oiio.ImageBufAlgo.compare(oiio.ImageBuf(files[0]), oiio.ImageBuf(files[1]), 0.0, 0.0)
    assert ours["rmse"] == pytest.approx(theirs.rms_error, rel=1e-5)
    assert ours["psnr_db"] == pytest.approx(theirs.PSNR, abs=1e-4)
    worst = ours["max"]
    assert (worst["x"], worst["y"]) == (theirs.maxx, theirs.maxy)
    assert abs(worst["a"] - worst["b"]) == pytest.approx(theirs.maxerror, rel=1e-5)
    difference = b.astype(float) - a
    assert ours["bias"] == pytest.approx(difference.mean(), rel=1e-6)
    assert ours["rel_mse"] == pytest.approx((difference**2 / (a.astype(float) ** 2 + 1e-2)).mean(), rel=1e-6)


@pytest.mark.parametrize("largest", [0.8, 30.0, 4000.0])
def test_flip_is_nvidias(tmp_path, largest):
    a, b = picture(0, largest), picture(3, largest)
    passes = {"ViewLayer.Combined": "HDR", "ViewLayer.Ambient Occlusion": "LDR"}
    files = [write(tmp_path / name, dict.fromkeys(passes, ("RGB", it))) for name, it in (("a.exr", a), ("b.exr", b))]
    ours = compared(*files)
    for name, dynamic in passes.items():
        # Its low range takes sRGB unless told that values are linear.
        clipped = [np.clip(it, 0.0, 1.0) if dynamic == "LDR" else it for it in (a, b)]
        _, theirs, _ = flip_evaluator.evaluate(*clipped, dynamic, inputsRGB=False, applyMagma=False)
        assert ours[name.partition(".")[2]]["flip"] == pytest.approx(theirs, abs=2e-4), name
    assert "flip" in ours["Combined"] and compared(*files, "--no-flip")["Combined"]["flip"] is None


@pytest.mark.parametrize("form", ["half", "float"])
def test_any_way_to_write_a_file_is_the_same(tmp_path, form):
    """One part or many, short names or long, tiles or lines: what is compared is the same."""
    color, depth = picture(), np.full((*SIZE, 1), 4.0, np.float32)
    depth[:10] = 1e10
    long = {"View.Combined": ("RGB", color), "View.Ambient Occlusion": ("RGB", color), "View.Depth": ("Z", depth)}
    short = {"Layer.Combined": ("RGB", color), "Layer.AO": ("RGB", color), "Layer.Z": ("Z", depth)}
    reference = write(tmp_path / "a.exr", long)
    others = [
        write(tmp_path / "many.exr", short, form if form == "float" else "float"),
        write(tmp_path / "single.exr", short, "float", single=True),
        write(tmp_path / "tiled.exr", long, "float", tile=16),
    ]
    for other in others:
        result = compared(reference, other)
        assert {name: it["verdict"] for name, it in result.items()} == dict.fromkeys(("Combined", "Ambient Occlusion", "Depth"), "same")
    halved = write(tmp_path / "half.exr", {name: it for name, it in long.items() if "Depth" not in name}, form)
    result = json.loads(run(reference, halved, "--json").stdout)
    assert result["only_a"] == ["Depth"] and result["agrees"]
    assert {it["verdict"] for it in result["passes"]} == {"agrees" if form == "half" else "same"}


def test_noise_of_seeds_is_found_and_bias_behind_it(tmp_path):
    def noisy(name, seed, gain=1.0):
        rng = np.random.default_rng(seed)
        pixels = gain * (1.0 + rng.normal(0.0, 0.3, (*SIZE, 3)))
        return write(tmp_path / name, {"V.Combined": ("RGB", pixels)})

    a = [noisy(f"a{i}.exr", i) for i in range(3)]
    b = [noisy(f"b{i}.exr", 10 + i) for i in range(3)]
    biased = [noisy(f"c{i}.exr", 20 + i, 1.03) for i in range(3)]
    more = lambda flag, files: [part for file in files for part in (flag, file)]
    result = compared(a[0], b[0], *more("--more-a", a[1:]), *more("--more-b", b[1:]))["Combined"]
    assert result["verdict"] == "agrees" and result["noise"] == {"a": "seeds", "b": "seeds"}
    expected = 0.3 * np.sqrt(2.0 / 3.0)
    assert result["noise_rmse"] == pytest.approx(expected, rel=0.03) and result["rmse"] == pytest.approx(expected, rel=0.03)
    # Channels are taken to go together, which is the most that it can be.
    assert result["standard_error"] == pytest.approx(expected / np.sqrt(SIZE[0] * SIZE[1]), rel=0.03)
    arguments = (a[0], biased[0], *more("--more-a", a[1:]), *more("--more-b", biased[1:]))
    assert compared(*arguments)["Combined"]["verdict"] == "differs"
    assert "Combined: more than noise" in run(*arguments, "--strict", code=1).stderr


def test_what_cannot_be_compared_is_said(tmp_path):
    a = write(tmp_path / "a.exr", {"V.Combined": ("RGB", picture())})
    small = write(tmp_path / "small.exr", {"V.Combined": ("RGB", picture()[:8, :8])})
    assert re.search(r"a\.exr and .*small\.exr: the pictures have different sizes: 96 x 72 and 8 x 8", run(a, small, code=1).stderr)
    other = write(tmp_path / "other.exr", {"V.Shadow": ("RGB", picture())})
    assert "have no pass in common: A has Combined; B has Shadow" in run(a, other, code=1).stderr
    assert "neither has a pass 'ao'" in run(a, a, "--passes", "combined,ao", code=1).stderr
    assert "nowhere.exr: can't read" in run(a, tmp_path / "nowhere.exr", code=1).stderr
    holes = picture()
    holes[3, 4, 1], holes[5, 6, 0] = np.nan, np.inf
    broken = write(tmp_path / "broken.exr", {"V.Combined": ("RGB", holes)})
    result = compared(a, broken)["Combined"]
    assert result["not_finite"] == {"a": 0, "b": 2} and result["rmse"] == 0.0
    assert "2 values of B are not finite" in run(a, broken).stdout
    assert "not finite" in run(a, broken, "--strict", code=1).stderr
    (tmp_path / "torn.exr").write_bytes(Path(a).read_bytes()[:400])
    assert "torn.exr: not a sound EXR file" in run(a, tmp_path / "torn.exr", code=1).stderr


def browse(page, fragment, shot=None):
    """The page's elements once it has drawn, and a screenshot."""
    command = [BROWSER, "--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--window-size=1600,1200",
               "--virtual-time-budget=8000", *([f"--screenshot={shot}"] if shot else ["--dump-dom"]), f"file://{page}#{fragment}"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr[-2000:]
    return done.stdout


@pytest.mark.skipif(BROWSER is None, reason="no Chromium, which tests/run installs for root alone")
def test_the_page_shows_both_pictures_and_where_they_differ(tmp_path):
    a, b = picture(0, 4.0), picture(0, 4.0)
    b[50:60, 70:80] *= 1.5
    files = [write(tmp_path / n, {"V.Combined": ("RGB", it), "V.Depth": ("Z", it[..., :1])}) for n, it in (("a.exr", a), ("b.exr", b))]
    run(*files, "--html", tmp_path / "page")
    page = tmp_path / "page" / "index.html"
    text = page.read_text()
    # One file, with nothing to load.
    assert [it.name for it in page.parent.iterdir()] == ["index.html"]
    assert not re.search(r"""(src|href)\s*=|https?://|@import|url\(""", text)
    dom = browse(page, "pass=Combined&mode=difference")
    assert 'data-shown="Combined difference"' in dom and "differ by more than noise (Combined, Depth)" in dom
    # The square is wider than worst pixels stand apart, and they are shown by their places.
    assert dom.count("<figcaption>") >= 2, dom[-2000:]

    def screen(mode, exposure=0.0):
        """What the canvas shows, in the order of rows."""
        shot = tmp_path / "shot.png"
        browse(page, f"pass=Combined&mode={mode}&exposure={exposure}&x=75&y=55&zoom=8", shot)
        return oiio.ImageBuf(str(shot)).get_pixels(oiio.UINT8)[..., :3]

    srgb = lambda v: 255.0 * np.where(v <= 0.0031308, 12.92 * v, 1.055 * np.maximum(v, 1e-9) ** (1 / 2.4) - 0.055)
    shots = {mode: screen(mode, exposure) for mode, exposure in (("a", -1.0), ("b", -1.0), ("difference", 0.0), ("map", 0.0))}
    # The square that differs stands in the middle of the canvas, which is found by where two shots differ.
    changed = np.abs(shots["a"].astype(int) - shots["b"]).max(axis=-1) > 8
    rows, columns = np.nonzero(changed[: changed.shape[0] * 3 // 4])
    centre = int(np.median(rows)), int(np.median(columns))
    for mode, values in (("a", a), ("b", b)):
        shown = shots[mode][centre].astype(float)
        around = srgb(np.clip(0.5 * values[50:60, 70:80].reshape(-1, 3), 0.0, 1.0))
        assert np.abs(around - shown).sum(axis=-1).min() < 6.0, (mode, shown)
    # B is more there: red; elsewhere black.
    red = shots["difference"][centre]
    assert red[0] > 100 and red[2] < 20, red
    assert shots["map"][centre].max() > 30
    if keep := os.environ.get("PENUMBRA_SHOTS"):
        shutil.copy(page, keep)
