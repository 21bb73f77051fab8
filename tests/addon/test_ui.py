"""Panels, the progress line, messages, Esc, and what small edits take."""

import json

import numpy as np
import pytest

oiio = pytest.importorskip("OpenImageIO")

from test_addon import read  # noqa: E402  (it needs OpenImageIO)


def test_shadow_and_decay_have_panels(blender, tmp_path):
    answer, _ = blender.run("shadow_and_decay", tmp_path)
    shown = answer["panels"]
    assert "Shadow: False" in shown["PENUMBRA_PT_shadow"] and "Samples: 1" in shown["PENUMBRA_PT_shadow"]
    assert shown["PENUMBRA_PT_shadow_lamps"][:3] == ["Bulb", "use_shadow: True", "Size: 0.0"]
    assert shown["PENUMBRA_PT_decay"] == ["Bulb", "penumbra.light_decay decay: Quadratic", "Sun", "None, as far as it is"]
    assert [rows[1].split(": ")[1] for rows in answer["decay"]] == ["Quadratic", "Linear", "Constant"]
    # Two metres from the lamp: a quarter, a half, and all of what there is at one.
    light = [read(path)["ViewLayer.Combined.R"].mean() for path in answer["light"]]
    assert np.allclose(np.divide(light, light[0]), [1.0, 2.0, 4.0], rtol=0.01), light
    assert "is a sun" in answer["sun"]
    assert answer["copied"] == pytest.approx(0.25)


def test_noise_is_in_the_progress_line_where_it_is_asked_for(blender):
    told, _ = blender.run("progress", "plain")
    assert told and all(line.startswith("Sample ") and "Noise" not in line for line in told)
    told, _ = blender.run("progress", "noise")
    assert "Noise 0.0" in told[-1], told


@pytest.mark.parametrize("kind", ["input", "bug"])
def test_what_fails_in_the_viewport_is_told_once(blender, kind):
    told, output = blender.run("viewport_fails", kind)
    assert "Traceback" not in output
    reports = [text for level, text in told if level == "ERROR"]
    expected = {"input": "the render border holds no pixel",
                "bug": "Penumbra failed, which is a bug in it: division by zero (ui_jobs.py, line "}[kind]
    assert len(reports) == 2 and reports[0].startswith(expected) and reports[1] == "no space left on device"
    assert [level for level, _ in told].count("line") == 3


@pytest.mark.parametrize("when", ["reading", "preparing"])
def test_esc_is_heard_before_there_is_a_picture(blender, when):
    (seconds, read_by_then), output = blender.run("escape", when)
    # 0.02 s where nothing else runs.
    assert seconds < 1.0
    assert "Error" not in output and "Traceback" not in output
    assert read_by_then == (100 if when == "reading" else 2000)


def test_small_edits_cross_alone(blender):
    answer, _ = blender.run("small_edits", 20)
    calls = {name: crossed for name, (crossed, _, _) in answer.items()}
    assert calls["color"] == ["set_material", "set_materials", "edit_document"]
    assert calls["move"] == calls["move_parent"] == ["set_instances", "edit_document"]
    assert calls["move_lamp"] == calls["dim"] == calls["sky"] == ["edit_document"]
    assert calls["both"] == ["set_instances", "set_material", "set_materials", "edit_document"]
    for name in ("hide", "shadowless", "refer", "move_referred"):
        assert "set_document" in calls[name], (name, calls[name])
    for name, (_, shown, afresh) in answer.items():
        assert np.allclose(shown, afresh, rtol=1e-5), (name, shown, afresh)


def _attributes(path):
    source = oiio.ImageInput.open(str(path))
    found = {attribute.name: attribute.value for attribute in source.spec().extra_attribs}
    source.close()
    return found


def test_cryptomatte_says_what_its_ids_mean(blender, tmp_path):
    """In the file as in Cycles', and for the compositor's node, which picks by it."""
    (cycles, ours, matte), _ = blender.run("cryptomatte", tmp_path)
    theirs, found = _attributes(cycles), _attributes(ours)
    names = [name for name in theirs if name.startswith("cryptomatte/")]
    assert len(names) == 12
    for name in names:
        if name.endswith("/manifest"):
            ids, known = json.loads(found[name]), json.loads(theirs[name])
            assert ids and {key: known.get(key, value) for key, value in ids.items()} == ids
        else:
            assert found[name] == theirs[name]
    objects = next(name[:-5] for name in names if found[name] == "ViewLayer.CryptoObject")
    ids = json.loads(found[f"{objects}/manifest"])
    assert {"Cube", "Plane"} <= set(ids)
    # Coverage of the cube by its id, and by its name.
    layers, cube = read(ours), np.frombuffer(bytes.fromhex(ids["Cube"])[::-1], np.float32)[0]
    expected = sum(np.where(layers[f"ViewLayer.CryptoObject{level:02d}.{key}"] == cube,
                            layers[f"ViewLayer.CryptoObject{level:02d}.{value}"], 0.0)
                   for level in range(3) for key, value in ("rg", "ba"))
    picked = oiio.ImageBuf(str(matte)).get_pixels(oiio.FLOAT)[..., 0]
    assert 0.02 < expected.mean() < 0.5
    assert np.abs(picked - expected).max() < 1e-3


def test_tiles_of_an_image_are_looked_up_in_files_and_packed(blender, tmp_path):
    paths, output = blender.run("packed_tiles", tmp_path)
    for cycles, ours in (paths[:2], paths[2:]):
        expected, found = (np.dstack([read(path)[f"ViewLayer.Combined.{c}"] for c in "RGB"]) for path in (cycles, ours))
        assert np.abs(found - expected).max() < 1e-3
        # Rows from the top: blue, red and green tiles, magenta where none is. Left of and below 0 the first ones go on.
        wall = found[4::8, 4::8]
        assert np.allclose(wall[0], [[0, 0, 1], [0, 0, 1], [1, 0, 1]], atol=1e-3)
        assert np.allclose(wall[1:], [[[1, 0, 0], [1, 0, 0], [0, 1, 0]]] * 2, atol=1e-3)
    assert "Traceback" not in output
