"""Motion blur beside Cycles': the same scenes, the same shutter, profiles over columns and means."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
PENUMBRA = ROOT / os.environ.get("PENUMBRA", "target/debug/penumbra")
SPP = 256


def rgb(path):
    file = oiio.ImageInput.open(str(path))
    spec = file.spec()
    pixels = file.read_image(0, 0, 0, spec.nchannels, oiio.FLOAT)
    names = [name.rpartition(".")[2] for name in spec.channelnames]
    return pixels[..., [names.index(c) for c in "RGB"]].astype(float)


def penumbra(stage, out, *args):
    command = [PENUMBRA, "render", stage, "-o", out, "--size", "48x48", "--frame", "10", "--filter", "box", *args]
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return rgb(out)


# By how much profiles may be apart, and how much nearer the blurred picture must be than the sharp one. Glowing things
# are sharp but for what moves, lit ones have noise in both pictures.
@pytest.mark.parametrize(
    "scene, apart, nearer",
    [("cube", 0.006, 5.0), ("wheel", 0.006, 5.0), ("pan", 0.006, 5.0), ("sheet", 0.006, 3.0), ("shade", 0.006, 3.0)],
)
def test_pictures_are_blurred_as_by_cycles(tmp_path, scene, apart, nearer):
    out = tmp_path / scene
    command = [sys.executable, HERE / "motion_in_cycles.py", scene, str(SPP), out]
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
    assert Path(f"{out}.exr").exists(), done.stdout + done.stderr
    theirs = rgb(f"{out}.exr")
    ours = penumbra(f"{out}.usda", tmp_path / "ours.exr", "--spp", str(SPP))
    sharp = penumbra(f"{out}.usda", tmp_path / "sharp.exr", "--spp", "16", "--motion-blur", "off")
    for axis in (0, 1):
        profile = np.abs(ours.mean(axis) - theirs.mean(axis)).max()
        blur = np.abs(sharp.mean(axis) - theirs.mean(axis)).max()
        print(f"{scene}, axis {axis}: profiles differ by {profile:.4f}, without blur by {blur:.4f}")
        assert profile < apart
    assert abs(ours.mean() / theirs.mean() - 1.0) < 0.01
    assert np.abs(sharp - theirs).mean() > nearer * np.abs(ours - theirs).mean()


def around_the_hub(picture):
    """The spokes of scenes/wheel.usda by angle, one value a quarter of a degree, counter-clockwise."""
    height, width = picture.shape[:2]
    # The hub is in the middle of the picture, and the frame 36 mm of 50 mm across at 2.6 m.
    radius = 0.4 / 2.6 * 50.0 / 36.0 * width
    angles = np.radians(np.arange(0, 360, 0.25))
    x, y = width / 2 - 0.5 + radius * np.cos(angles), height / 2 - 0.5 - radius * np.sin(angles)
    column, row = np.floor(x).astype(int), np.floor(y).astype(int)
    fx, fy = (x - column)[:, None], (y - row)[:, None]
    upper = picture[row, column] * (1 - fx) + picture[row, column + 1] * fx
    lower = picture[row + 1, column] * (1 - fx) + picture[row + 1, column + 1] * fx
    return (upper * (1 - fy) + lower * fy).mean(axis=1)


def test_a_wagon_wheel_seems_to_turn_backwards_unless_it_is_blurred(tmp_path):
    def frames(*args):
        out = tmp_path / "wheel.####.exr"
        command = [PENUMBRA, "render", ROOT / "scenes/wheel.usda", "-o", out, "--frames", "3-4", "--size", "192x144", "--spp", "64", *args]
        done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        return [around_the_hub(rgb(tmp_path / f"wheel.{frame:04}.exr")) for frame in (3, 4)]

    def spokes(ring):
        """How strongly twelve spokes stand out, and where: degrees counter-clockwise."""
        wave = np.fft.rfft(ring)[12] / len(ring)
        return np.abs(wave) / ring.mean(), np.degrees(np.angle(wave)) / -12.0

    (strong, first), (_, then) = map(spokes, frames("--motion-blur", "off"))
    # It rolls clockwise by 28 degrees; the eye sees the shorter way, 2 degrees counter-clockwise.
    assert (then - first + 15.0) % 30.0 - 15.0 == pytest.approx(2.0, abs=0.2)
    blurred = [spokes(ring)[0] for ring in frames()]
    # Half of a frame is 14 degrees: what is left of a wave of 30 is sin(x) / x of 14 * 180 / 30.
    left = np.sinc(14.0 / 30.0)
    assert max(blurred) / strong == pytest.approx(left, abs=0.08)
