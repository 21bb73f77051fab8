"""Data passes, pixel by pixel as Cycles has them."""

import numpy as np
import pytest

pytest.importorskip("OpenImageIO")

from test_addon import read  # noqa: E402  (it needs OpenImageIO)


def _layer(path, name, channels):
    layers = read(path)
    return np.dstack([layers[f"ViewLayer.{name}.{c}"] for c in channels])


def _both(blender, folder, scene, boxes, spp, layer, channels, *arguments):
    """(Cycles', Penumbra's) pixels of a layer, and what Blender printed."""
    paths, output = blender.run("passes_of_both", scene, folder, boxes, spp, *arguments)
    return [_layer(path, layer, channels) for path in paths], output


def _assert_alike(expected, found, tolerance, most_off, what):
    """All pixels are within `tolerance` but for a share `most_off`: those at edges, which are noise of few samples."""
    off = np.abs(found - expected).max(axis=2) > tolerance
    assert off.mean() <= most_off, (what, off.mean(), np.argwhere(off)[:5].tolist())


@pytest.mark.parametrize(
    ("falloff", "camera"),
    [("LINEAR", "PERSP"), ("QUADRATIC", "PERSP"), ("INVERSE_QUADRATIC", "PERSP"), ("LINEAR", "ORTHO")],
)
def test_mist_is_that_of_cycles(blender, tmp_path, falloff, camera):
    (expected, found), output = _both(blender, tmp_path, "fog", "Mist", 64, "Mist", "Z", falloff, camera)
    assert "is not rendered" not in output
    assert np.ptp(expected) > 0.5
    _assert_alike(expected, found, 0.02, 0.06, falloff)
    assert abs(found.mean() - expected.mean()) < 0.002


@pytest.mark.parametrize("camera", ["PERSP", "ORTHO", "PANO"])
def test_vectors_are_those_of_cycles(blender, tmp_path, camera):
    (expected, found), output = _both(blender, tmp_path, "march", "Vector", 32, "Vector", "XYZW", camera)
    assert "is not rendered" not in output and "Traceback" not in output
    most = np.abs(expected).max()
    assert most > 0.5
    _assert_alike(expected, found, 0.02 * most, 0.06, camera)


def test_vectors_of_hair_are_those_of_cycles(blender, tmp_path):
    (expected, found), _ = _both(blender, tmp_path, "lawn", "Vector", 32, "Vector", "XYZW")
    assert np.abs(expected).max() > 1.0
    _assert_alike(expected, found, 0.1, 0.1, "hair")


@pytest.mark.by_turns
@pytest.mark.parametrize("transparent", ["on", "off"])
def test_shadow_catchers_have_the_pass_of_cycles(blender, tmp_path, transparent):
    (expected, found), _ = _both(blender, tmp_path, "catcher", "Shadow Catcher", 256, "Shadow Catcher", "RGB", transparent)
    assert expected.min() < 0.5
    noise = np.std(found - expected) / np.sqrt(expected[..., 0].size)
    assert abs(found.mean() - expected.mean()) < 0.002 + 4.0 * noise
    _assert_alike(expected, found, 0.15, 0.06, transparent)


@pytest.mark.parametrize(("layer", "channels"), [("Normal", "XYZ"), ("Albedo", "RGB"), ("Depth", "Z")])
def test_a_denoiser_is_told_what_cycles_tells(blender, tmp_path, layer, channels):
    (expected, found), _ = _both(blender, tmp_path, "mirrors", "Denoising", 128, f"Denoising {layer}", channels)
    scale = np.abs(expected).max()
    noise = np.std(found - expected, axis=(0, 1)) / np.sqrt(expected[..., 0].size)
    assert (np.abs(found - expected).mean(axis=(0, 1)) < 0.02 * scale).all()
    assert (np.abs((found - expected).mean(axis=(0, 1))) <= 0.002 * scale + 4.0 * noise).all()


@pytest.mark.parametrize(("curve", "rolling"), [("off", "off"), ("on", "off"), ("off", "0.0"), ("off", "0.4"), ("on", "0.4")])
def test_shutters_expose_as_those_of_cycles(blender, tmp_path, curve, rolling):
    (expected, found), output = _both(blender, tmp_path, "sweeping", "Mist", 512, "Combined", "R", curve, rolling)
    assert "not rendered" not in output
    assert 0.1 < expected.max() <= 1.0 and np.ptp(expected) > 0.5
    _assert_alike(expected, found, 0.06, 0.02, (curve, rolling))
    assert abs(found.mean() - expected.mean()) < 0.003


def test_with_motion_blur_there_are_no_vectors(blender, tmp_path):
    paths, output = blender.run("passes_of_both", "march_blurred", tmp_path, "Vector", 4)
    for path in paths:
        layers = read(path)
        assert all(np.abs(layers.get(f"ViewLayer.Vector.{c}", np.zeros(1))).max() == 0.0 for c in "XYZW")
    assert "the vector pass is of pictures without motion blur" in output


def test_what_is_not_finite_is_named(blender, tmp_path):
    _, output = blender.run("not_finite", tmp_path)
    assert "Area: energy: not finite; 0 is used" in output, output[-2000:]
    assert "Wood > Shader Nodetree > Mapping > Location: value: not finite; 0 is used" in output, output[-2000:]


def test_what_has_no_material_is_named_as_by_cycles(blender, tmp_path):
    paths, _ = blender.run("passes_of_both", "bare", tmp_path, "Cryptomatte", 16)
    cycles, ours = [read(path)["ViewLayer.CryptoMaterial00.r"] for path in paths]
    assert len(np.unique(cycles)) > 2
    assert np.mean(cycles == ours) > 0.95


@pytest.mark.parametrize("kind", ["SPOT", "POINT", "MESH"])
def test_anything_can_be_looked_through_as_in_cycles(blender, tmp_path, kind):
    (expected, found), output = _both(blender, tmp_path, "through", "Mist", 64, "Combined", "RGB", kind)
    assert "no camera" not in output
    assert expected.mean() > 0.05
    _assert_alike(expected, found, 0.1 * expected.max(), 0.08, kind)


def test_faces_at_a_vertex_far_off_are_left_out_and_the_rest_is_there(blender, tmp_path):
    paths, output = blender.run("far_vertex", tmp_path)
    far, without = [_layer(path, "Depth", "Z") for path in paths]
    assert (without < 1e9).mean() > 0.02
    assert (np.abs(far - without) < 1e-3).mean() > 0.995
    assert 'the mesh "Cube" has 1 vertices that are not finite or too far away; ' in output, output[-2000:]
