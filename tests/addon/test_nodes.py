"""Function nodes beside Cycles, pixel by pixel."""

import numpy as np

from test_addon import read


def test_every_function_node_is_that_of_cycles(blender, tmp_path):
    (names, columns, size, paths), output = blender.run("node_wall", tmp_path)
    pictures = []
    for path in paths:
        layers = read(path)
        pictures.append(np.dstack([layers[f"ViewLayer.Combined.{c}"] for c in "RGB"])[::-1])
    wrong = {}
    for number, name in enumerate(names):
        row, column = divmod(number, columns)
        tiles = [picture[size * row : size * (row + 1), size * column : size * (column + 1)] for picture in pictures]
        difference = np.abs(tiles[0] - tiles[1])
        # Samples lie elsewhere within the pixels, so that steps and slopes differ a little; nothing else does.
        if np.mean(difference > 0.04) > 0.15 or abs(tiles[0].mean() - tiles[1].mean()) > 0.01:
            wrong[name] = [float(difference.max()), float(tiles[0].mean()), float(tiles[1].mean())]
    assert not wrong, "\n".join(f"{name}: {what}" for name, what in wrong.items())
    told = [line for line in output.splitlines() if "Warning" in line]
    assert not told, told
