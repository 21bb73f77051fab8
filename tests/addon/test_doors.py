"""One scene, three doors: F12, and Export for Penumbra to USD and to glTF with the command line. The pictures agree
but for their noise. Needs the program, built for debugging or named by PENUMBRA."""

import subprocess
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("OpenImageIO")
from test_addon import read  # noqa: E402
from test_export import EXE  # noqa: E402

# Pixels along the side of a block.
BLOCK = 8


def combined(path):
    layers = read(path)
    return np.dstack([layers[f"ViewLayer.Combined.{c}"] for c in "RGBA"]).astype(float)


def blocks(picture):
    """Means and variances of the means of all blocks, by channel."""
    rows, columns, channels = picture.shape
    cut = picture.reshape(rows // BLOCK, BLOCK, columns // BLOCK, BLOCK, channels).swapaxes(1, 2)
    cut = cut.reshape(-1, BLOCK * BLOCK, channels)
    return cut.mean(axis=1), cut.var(axis=1, ddof=1) / BLOCK**2


@pytest.mark.by_turns
@pytest.mark.parametrize("name", ["point_soft", "spot", "sun", "area_ellipse", "area_spread", "world_image", "principled",
                                  "textured", "see_through", "mesh_light", "depth_of_field", "panorama", "shifted"])
def test_pictures_are_the_same(blender, tmp_path, name):
    (picture, files), _ = blender.run("through_the_doors", name, tmp_path)
    inside = combined(picture)
    for seed, path in enumerate(map(Path, files), 1):
        out = tmp_path / f"{name}-{seed}.exr"
        command = [EXE, "render", path, "-o", out, "--spp", "128", "--max-bounces", "4", "--filter", "box:0.5",
                   "--passes", "combined", "--seed", str(seed), "--progress", "none"]
        done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        outside = combined(out)
        assert outside.shape == inside.shape
        # Noise of two renders with other seeds; rounding of what a file keeps beside it.
        difference, variance = blocks(outside - inside)
        z = difference / np.sqrt(variance + (1e-4 * np.abs(inside).mean()) ** 2)
        assert np.abs(z).max() < 5.0, (name, path, np.abs(z).max())
        # All blocks together tell a smaller difference.
        z = difference.mean(axis=0) / np.sqrt(variance.mean(axis=0) / len(variance) + (1e-4 * np.abs(inside).mean()) ** 2)
        assert np.abs(z).max() < 4.0, (name, path, z)
