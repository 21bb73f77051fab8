"""The add-on inside Blender, as an artist uses it: installed from its zip, F12, cancelled, misused."""

import zipfile

import numpy as np
import pytest

oiio = pytest.importorskip("OpenImageIO")


def read(path):
    """Layers of a multi-layer EXR, channels by full name: {"ViewLayer.Combined.R": rows from the top}."""
    layers = {}
    source = oiio.ImageInput.open(str(path))
    index = 0
    while source.seek_subimage(index, 0):
        spec = source.spec()
        pixels = source.read_image(index, 0, 0, spec.nchannels, "float")
        for channel, name in enumerate(spec.channelnames):
            layers[name] = pixels[:, :, channel]
        index += 1
    source.close()
    return layers


def test_the_zip_is_an_extension(extension):
    names = zipfile.ZipFile(extension).namelist()
    assert "blender_manifest.toml" in names and "__init__.py" in names
    assert any(name.startswith("wheels/penumbra-") and name.endswith(".whl") for name in names)
    assert not any("__pycache__" in name for name in names)


def test_f12_fills_every_pass(blender, tmp_path):
    path, _ = blender.run("f12", tmp_path)
    layers = read(path)
    combined = np.dstack([layers[f"ViewLayer.Combined.{c}"] for c in "RGBA"])
    assert np.isfinite(combined).all() and combined[..., :3].mean() > 0.01
    for name in ("Shadow.R", "Diffuse Direct Unshadowed.R", "Ambient Occlusion.R", "Depth.Z", "Normal.X", "Position.X"):
        assert f"ViewLayer.{name}" in layers, sorted(layers)
    # Diffuse Direct is the shadow times what would be without.
    direct = layers["ViewLayer.Diffuse Direct.R"]
    product = layers["ViewLayer.Shadow.R"] * layers["ViewLayer.Diffuse Direct Unshadowed.R"]
    assert np.abs(direct - product).max() < 1e-3 * direct.max()
    occlusion = layers["ViewLayer.Ambient Occlusion.R"]
    assert 0.2 < occlusion.max() <= 1.001 and occlusion.min() >= 0.0
