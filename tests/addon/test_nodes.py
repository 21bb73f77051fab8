"""Function nodes and images beside Cycles, pixel by pixel."""

import numpy as np
import pytest

from test_addon import read


def _tiles(answer):
    """Name and both pictures of each tile of a wall."""
    names, columns, size, paths = answer
    pictures = []
    for path in paths:
        layers = read(path)
        pictures.append(np.dstack([layers[f"ViewLayer.Combined.{c}"] for c in "RGB"])[::-1])
    for number, name in enumerate(names):
        row, column = divmod(number, columns)
        yield name, *(p[size * row : size * (row + 1), size * column : size * (column + 1)] for p in pictures)


def test_every_function_node_is_that_of_cycles(blender, tmp_path):
    answer, output = blender.run("node_wall", tmp_path)
    wrong = {}
    for name, expected, found in _tiles(answer):
        difference = np.abs(found - expected)
        # Samples lie elsewhere within the pixels, so that steps and slopes differ a little; nothing else does.
        if np.mean(difference > 0.04) > 0.15 or abs(found.mean() - expected.mean()) > 0.01:
            wrong[name] = [float(difference.max()), float(expected.mean()), float(found.mean())]
    assert not wrong, "\n".join(f"{name}: {what}" for name, what in wrong.items())
    told = [line for line in output.splitlines() if "Warning" in line]
    assert not told, told


@pytest.mark.by_turns
def test_images_are_looked_up_as_in_cycles(blender, tmp_path):
    """Blended as stored, cubic, multiplied by alpha or not; from near and from afar."""
    answer, output = blender.run("image_wall", tmp_path)
    wrong = {}
    for name, expected, found in _tiles(answer):
        noise = np.std(found - expected) / np.sqrt(expected[..., 0].size)
        # Samples lie elsewhere within the pixels, so that edges differ a little.
        near = np.quantile(np.abs(found - expected), 0.8)
        # Where many texels are in a pixel, those of Cycles are as noisy as the image.
        far = name.startswith(("fine", "thin"))
        if abs(found.mean() - expected.mean()) > 0.002 * expected.mean() + 4.0 * noise or (near > 0.02 and not far):
            wrong[name] = [float(near), float(expected.mean()), float(found.mean() / expected.mean())]
    assert not wrong, "\n".join(f"{name}: {what}" for name, what in wrong.items())
    told = [line for line in output.splitlines() if "Warning" in line]
    assert not told, told
