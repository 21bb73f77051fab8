"""The program on a shipped scene, judged by OpenImageIO."""

import json
import os
import subprocess
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest

ROOT = Path(__file__).resolve().parents[2]
PENUMBRA = ROOT / os.environ.get("PENUMBRA", "target/debug/penumbra")


def render(folder, scene, *args):
    out = folder / "out.exr"
    command = [PENUMBRA, "render", ROOT / "scenes" / scene, "-o", out, "--preview", folder / "out.png", *args]
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return parts(out)


def parts(path):
    """Part name to (pixels, attributes)."""
    file, found, index = oiio.ImageInput.open(str(path)), {}, 0
    while file.seek_subimage(index, 0):
        spec = file.spec()
        attributes = {a.name: a.value for a in spec.extra_attribs}
        pixels = file.read_image(index, 0, 0, spec.nchannels, oiio.FLOAT)
        found[attributes["oiio:subimagename"].partition(".")[2]] = (pixels, attributes)
        index += 1
    return found


# The last number is the least openness: a room is closed but for its window.
@pytest.mark.parametrize(
    "scene, sky, least", [("still_life.glb", None, 0.3), ("interior.glb", "sky.hdr", 0.02), ("field.glb", "evening.hdr", 0.3)]
)
def test_shipped_scenes_give_every_pass(tmp_path, scene, sky, least):
    sky = ["--environment", ROOT / "scenes" / sky] if sky else []
    found = render(tmp_path, scene, "--size", "96x54", "--spp", "4", "--passes", "all", *sky)
    pixels = {name: value for name, (value, _) in found.items()}
    assert all(np.isfinite(value).all() for value in pixels.values())
    combined = sum(
        pixels[f"{lobe} Color"] * (pixels[f"{lobe} Direct"] + pixels[f"{lobe} Indirect"])
        for lobe in ["Diffuse", "Glossy", "Transmission"]
    ) + pixels["Emission"] + pixels["Environment"]
    assert np.allclose(combined, pixels["Combined"][..., :3], rtol=1e-4, atol=1e-5)
    product = pixels["Shadow"] * pixels["Diffuse Direct Unshadowed"]
    assert np.allclose(product, pixels["Diffuse Direct"], rtol=1e-4, atol=1e-6)
    ao = pixels["Ambient Occlusion"]
    assert least < ao.mean() < 1.0 and ao.min() >= 0.0
    assert (pixels["Debug Sample Count"] == 4).all()
    # Every object that Cryptomatte shows has a name.
    ids, attributes = found["CryptoObject00"][0], found["Combined"][1]
    manifest = next(json.loads(v) for k, v in attributes.items() if k.startswith("cryptomatte/") and k.endswith("manifest"))
    names = {int(value, 16) for value in manifest.values()} | {0}
    first = np.unique(ids[..., 0].copy().view(np.uint32)) if ids.shape[-1] == 4 else []
    alphabetical = np.unique(ids[..., -1].copy().view(np.uint32))
    assert set(first.tolist()) <= names or set(alphabetical.tolist()) <= names
    assert attributes["penumbra/samples"] == "4" and attributes["Camera"]
    assert (tmp_path / "out.png").read_bytes().startswith(b"\x89PNG")
