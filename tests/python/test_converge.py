"""`penumbra converge` on a small scene: what it says of noise, bias and what things cost, and its page."""

import importlib.util
import json
import os
import re
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PENUMBRA = ROOT / os.environ.get("PENUMBRA", "target/debug/penumbra")
SCENE = ROOT / "scenes" / "interior.glb"
BASE = ["--environment", ROOT / "scenes" / "sky.hdr", "--size", "48x32", "--spp", "32", "--max-bounces", "4"]


def with_denoiser():
    """An environment in which Open Image Denoise is found: Blender's Python package brings it."""
    folder = Path(importlib.util.find_spec("bpy").origin).resolve().parent / "lib"
    library = next(folder / name for name in ("libOpenImageDenoise.so.2", "libOpenImageDenoise.dylib") if (folder / name).exists())
    return {**os.environ, "PENUMBRA_OIDN": str(library), "LD_LIBRARY_PATH": str(folder)}


def converge(*arguments, code=0):
    command = [str(part) for part in (PENUMBRA, "converge", SCENE, *BASE, *arguments)]
    done = subprocess.run(command, capture_output=True, text=True, env=with_denoiser())
    assert done.returncode == code, done.stderr
    return done


@pytest.fixture(scope="module")
def measured(tmp_path_factory):
    folder = tmp_path_factory.mktemp("converge")
    ways = ["max-bounces=0", "sampler=independent", "motion-blur=off", "clamp-indirect=10", "without pass ao", "denoised"]
    done = converge("--passes", "combined,ao", "--samplers", "independent", "--only", ",".join(ways), "--seeds", "3", "--json", "--html", folder)
    return json.loads(done.stdout), folder


def test_noise_falls_and_bias_is_told(measured):
    report, _ = measured
    ways = {way["name"]: way for way in report["configurations"]}
    base = ways["base"]
    assert [point["spp"] for point in base["points"]] == [4, 8, 16, 32]
    variances = [point["variance"] for point in base["points"]]
    assert all(later < earlier for earlier, later in zip(variances, variances[1:]))
    # The base against itself has no bias; without bounces most of a room's light is missing.
    assert base["points"][-1]["bias"] == 0.0
    dark = ways["max-bounces=0"]["points"][-1]
    assert dark["bias"] > 0.3 * report["reference"]["mean"] and dark["rmse"] >= dark["bias"]
    assert ways["max-bounces=0"]["seconds_to"][-1] is None and ways["max-bounces=0"]["error_share"] > 0.1
    # Independent points are noisier, and as right.
    independent = ways["sampler=independent"]["points"][-1]
    assert independent["variance"] > base["points"][-1]["variance"] and independent["bias"] == 0.0
    assert ways["motion-blur=off"]["same_as_base"] and not ways["sampler=independent"]["same_as_base"]
    assert report["cheapest"][0]["seconds"] > 0.0


def test_denoising_is_measured_with_its_bias(measured):
    ways = {way["name"]: way for way in measured[0]["configurations"]}
    clean, base = ways["denoised"]["points"], ways["base"]["points"]
    assert clean[0]["variance"] < 0.5 * base[0]["variance"]
    assert clean[0]["rmse"] < base[0]["rmse"]
    assert clean[-1]["bias"] > 0.0


def test_the_page_has_the_plot_the_table_and_pictures(measured):
    _, folder = measured
    assert sorted(it.name for it in folder.iterdir()) == ["error.svg", "index.html"]
    page = (folder / "index.html").read_text()
    assert page.count("<svg") == 1 and page.count('src="data:image/png;base64,') >= 5
    assert not re.search(r"""(src|href)\s*=\s*["'](?!data:)|@import|url\(""", page)
    assert "changes nothing here" in page and "At equal time" in page


def test_what_cannot_be_measured_is_said(tmp_path):
    assert "--only nothing: not one of base" in converge("--only", "nothing", code=1).stderr
    assert "there is no setting 'bounces'" in converge("--try", "bounces=2", code=1).stderr
    assert "expected NAME=VALUE" in converge("--try", "bounces", code=1).stderr
    assert "--samplers magic: must be one of" in converge("--samplers", "magic", code=1).stderr
    assert "samples grow up to --spp" in converge("--error", "0.01", code=1).stderr
    assert "nowhere.exr" in converge("--reference", tmp_path / "nowhere.exr", code=1).stderr


def test_denoised_is_a_layer_beside_what_was_rendered(tmp_path):
    import numpy as np
    import OpenImageIO as oiio

    out = tmp_path / "out.exr"
    command = [PENUMBRA, "render", SCENE, "-o", out, "--environment", ROOT / "scenes" / "sky.hdr", "--size", "64x43", "--spp", "16",
               "--progress", "none", "--denoise"]
    command = [str(part) for part in command]
    done = subprocess.run(command, capture_output=True, text=True, env=with_denoiser())
    assert done.returncode == 0, done.stderr
    file, layers, part = oiio.ImageInput.open(str(out)), {}, 0
    while file.seek_subimage(part, 0):
        spec = file.spec()
        layers[spec.getattribute("oiio:subimagename").partition(".")[2]] = file.read_image(part, 0, 0, spec.nchannels, "float")
        part += 1
    assert {"Combined", "Denoised", "Denoising Albedo", "Denoising Normal"} <= set(layers)
    noisy, clean = layers["Combined"], layers["Denoised"]
    # Neighbours differ less, and the picture is as bright.
    roughness = lambda picture: np.abs(np.diff(picture[..., :3], axis=1)).mean()
    assert roughness(clean) < 0.7 * roughness(noisy)
    assert abs(clean[..., :3].mean() / noisy[..., :3].mean() - 1.0) < 0.05
    assert np.array_equal(clean[..., 3], noisy[..., 3])
    # Without the library nothing is rendered in vain.
    gone = subprocess.run(command, capture_output=True, text=True, env={**os.environ, "PENUMBRA_OIDN": "/nowhere/libOpenImageDenoise.so"})
    assert gone.returncode == 1 and "--denoise: Open Image Denoise 2 is not there (/nowhere" in gone.stderr
