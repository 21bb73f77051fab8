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


# Of what share of the pixels a pass has something, where that is neither all nor unknown: what it shows is a part of the picture.
_SHARES = {
    "Emission": (0.002, 0.1), "Vector": (0.005, 0.5), "Place": (0.002, 0.1), "Object Index": (0.01, 0.3),
    "Material Index": (0.01, 0.3), "Transmission Color": (0.005, 0.3), "Transmission Direct": (0.0005, 0.2),
    "Transmission Indirect": (0.002, 0.3), "Glossy Color": (0.01, 1.0), "Environment": (0.01, 0.9),
}


def test_f12_fills_every_pass(blender, tmp_path):
    (path, passes), _ = blender.run("f12", tmp_path)
    layers = read(path)
    for row in passes:
        names = [row["layer"].replace("<group>", group).replace("<name>", "Place") for group in ("key", "fill")]
        if row["name"].startswith("crypto_"):
            names = [f"{row['layer']}{level:02d}" for level in range(3)]
        for name in dict.fromkeys(names):
            channels = [layers[f"ViewLayer.{name}.{c}"] for c in row["channels"]]
            assert np.isfinite(channels).all(), name
            least, most = _SHARES.get(name, (0.0 if name.endswith(("01", "02")) else 0.0005, 1.0))
            share = np.mean(np.abs(channels).max(axis=0) > 0.0)
            assert least <= share <= most, (name, share)
    assert set(np.unique(layers["ViewLayer.Object Index.X"])) == {0.0, 5.0, 6.0, 7.0}
    assert set(np.unique(layers["ViewLayer.Material Index.X"])) == {0.0, 2.0, 3.0, 4.0}
    assert (layers["ViewLayer.Debug Sample Count.X"] == 32.0).all()
    for name in ("Shadow", "Shadow_key", "Shadow_fill", "Shadow Catcher"):
        assert layers[f"ViewLayer.{name}.R"].min() < 0.7 and layers[f"ViewLayer.{name}.R"].max() >= 0.99, name
    combined = np.dstack([layers[f"ViewLayer.Combined.{c}"] for c in "RGBA"])
    assert np.isfinite(combined).all() and combined[..., :3].mean() > 0.01
    # Diffuse Direct is the shadow times what would be without.
    direct = layers["ViewLayer.Diffuse Direct.R"]
    product = layers["ViewLayer.Shadow.R"] * layers["ViewLayer.Diffuse Direct Unshadowed.R"]
    assert np.abs(direct - product).max() < 1e-3 * direct.max()
    occlusion = layers["ViewLayer.Ambient Occlusion.R"]
    assert 0.2 < occlusion.max() <= 1.001 and occlusion.min() >= 0.0


def test_the_panel_says_what_was_simulated_and_why(blender, tmp_path):
    (before, after), _ = blender.run("effects", tmp_path)
    assert before == ["Render to see which effects the scene calls for"]
    rows = dict(zip(after, after[1:]))
    there = after[: after.index("Not there:")]
    assert "Pane" in rows["Refraction"] and "Refraction" in there
    assert rows["Ambient occlusion"] == "--passes ao" and "Ambient occlusion" in there
    assert "Motion blur" not in there and rows["Motion blur"] == "the shutter does not open"


def _unlike(expected, found, blocks=4):
    """Where one channel of a picture is not the other's: in its mean, and in those of `blocks`² parts of it.

    The noise of a mean is that of differences between pixels, which edges make no smaller. A part may differ by 0.5 %, of
    a fifth of the whole's mean at least.
    """
    whole = np.abs(expected).mean()
    parts = [("all", expected, found, 0.002 * whole, 4.0)]
    for row, bands in enumerate(zip(np.array_split(expected, blocks), np.array_split(found, blocks))):
        for column, (a, b) in enumerate(zip(*(np.array_split(band, blocks, axis=1) for band in bands))):
            parts.append(((row, column), a, b, 0.005 * max(abs(a.mean()), 0.2 * whole), 5.0))
    for where, a, b, share, sigmas in parts:
        noise = np.std(b - a, ddof=1) / np.sqrt(a.size)
        if abs(b.mean() - a.mean()) > share + sigmas * noise:
            yield where, float(a.mean()), float(b.mean()), float(noise)


@pytest.mark.by_turns
@pytest.mark.parametrize(
    "name", ["point_soft", "spot", "sun", "area_ellipse", "area_spread", "falloff_linear", "world_image", "mesh_light",
             "principled", "see_through", "depth_of_field", "bokeh", "panorama", "instances", "curve_and_text", "textured", "points",
             "world_gradient", "world_clouds", "world_camera_ray", "world_mixed", "sky_single", "sky_multiple",
             "sky_preetham", "holdout", "thin", "rough_diffuse", "glossy", "stretched", "coated", "cloth", "glowing_lacquer",
             "glowing_velvet", "mixed_shaders",
             "leaf", "red_film", "glow", "filter_glossy", "no_caustics",
             "no_refractive_caustics", "clamped", "few_diffuse_bounces", "few_glossy_bounces", "few_transmission_bounces",
             "panes", "wax", "skin", "burley", "candle", "coarse", "bumpy",
             "uncorrected", "attributes", "overridden", "filtered", "murky", "submerged", "tinted_glass", "brushed_by_map", "varying_index", "zoomed",
             "relief", "relief_of_world", "relief_of_vectors", "relief_of_tangents", "relief_of_color", "colors_as_shaders",
             "bright_colors", "light_taken", "gobo_point", "gobo_of_directions", "gobo_spot", "gobo_of_normals", "gobo_area",
             "lamp_by_distance", "lamp_of_ies", "few_bounces_of_lamps", "no_bounces_of_a_wide_lamp", "islands", "tangents", "pointed", "attributes_of_hair",
             "catcher", "hair", "hair_curves_bent", "particle_fur", "particle_instances"]
)
def test_pictures_are_those_of_cycles(blender, tmp_path, name):
    paths, _ = blender.run("side_by_side", name, tmp_path, 64, 48)
    cycles, ours = [read(path) for path in paths]
    for layer in ("Combined", "Diffuse Direct", "Diffuse Color", "Ambient Occlusion"):
        names = [f"ViewLayer.{layer}.{c}" for c in "RGB"]
        short = {"Diffuse Direct": "DiffDir", "Diffuse Color": "DiffCol", "Ambient Occlusion": "AO"}.get(layer, layer)
        theirs = [cycles.get(n, cycles.get(f"ViewLayer.{short}.{n[-1]}")) for n in names]
        expected, found = np.dstack(theirs), np.dstack([ours[n] for n in names])
        if layer == "Combined":
            expected = np.dstack([expected, cycles["ViewLayer.Combined.A"]])
            found = np.dstack([found, ours["ViewLayer.Combined.A"]])
        for channel in range(expected.shape[2]):
            wrong = list(_unlike(expected[..., channel].astype(float), found[..., channel].astype(float)))
            assert not wrong, (name, layer, "RGBA"[channel], wrong)


def test_a_transparent_film_is_seen_through_glass(blender, tmp_path):
    """The picture and its alpha; in Cycles data passes show what is behind the glass as well."""
    paths, _ = blender.run("side_by_side", "film_through_glass", tmp_path, 256, 48)
    expected, found = (np.dstack([read(path)[f"ViewLayer.Combined.{c}"] for c in "RGBA"]) for path in paths)
    for c in range(4):
        noise = np.std(found[..., c] - expected[..., c]) / np.sqrt(expected[..., c].size)
        assert abs(found[..., c].mean() - expected[..., c].mean()) <= 0.002 * expected[..., c].mean() + 4.0 * noise, c
    assert np.mean(np.abs(found[..., 3] - expected[..., 3]) > 0.1) < 0.02


def test_bumps_on_mirrors_leave_no_black(blender, tmp_path):
    paths, _ = blender.run("side_by_side", "bumpy_mirror", tmp_path, 64, 16)
    for path in paths:
        assert min(read(path)[f"ViewLayer.Combined.{c}"].min() for c in "RGB") > 0.99


def test_bumps_shine_as_in_cycles(blender, tmp_path):
    """In sum: where a steep bump turns away from the viewer Cycles leaves diffuse light as it is (docs/blender.md)."""
    paths, _ = blender.run("side_by_side", "bumpy_shine", tmp_path, 64, 48)
    expected, found = (np.dstack([read(path)[f"ViewLayer.Combined.{c}"] for c in "RGB"]) for path in paths)
    noise = np.std(found - expected) / np.sqrt(expected[..., 0].size)
    assert abs(found.mean() - expected.mean()) <= 0.002 * expected.mean() + 4.0 * noise


def test_the_sky_of_hosek_and_wilkie_is_that_of_cycles_by_another_fit(blender, tmp_path):
    """Cycles fits XYZ, the crate red, green and blue: 4 % between the means of the two fits of its authors."""
    paths, _ = blender.run("side_by_side", "sky_hosek", tmp_path, 32, 48)
    cycles, ours = [read(path) for path in paths]
    for c in "RGB":
        expected, found = cycles[f"ViewLayer.Combined.{c}"].mean(), ours[f"ViewLayer.Combined.{c}"].mean()
        assert expected > 0.0 and abs(found / expected - 1.0) < 0.04, c


@pytest.mark.by_turns
def test_particle_hair_has_the_shape_of_cycles(blender, tmp_path):
    """Taper, shape, closed tips, curls and children: where the hair is, whatever light falls on it."""
    paths, _ = blender.run("side_by_side", "particle_hair", tmp_path, 64, 96)
    cycles, ours = [read(path) for path in paths]
    for layer, short, channels in (("Diffuse Color", "DiffCol", "RGB"), ("Depth", "Depth", "Z")):
        for c in channels:
            expected = cycles.get(f"ViewLayer.{layer}.{c}", cycles.get(f"ViewLayer.{short}.{c}"))
            found = ours[f"ViewLayer.{layer}.{c}"]
            # The straight pieces of a bend lie up to a twentieth of the radius inside of it.
            noise = np.std(found - expected) / np.sqrt(expected.size)
            assert abs(found.mean() - expected.mean()) <= 0.0005 * expected.mean() + 4.0 * noise, (layer, c)
            # Pixel by pixel, too: within the noise of edges nearly everywhere.
            assert np.mean(np.abs(found - expected) > 0.1 * expected.max()) < 0.05, (layer, c)


def test_shader_aovs_are_those_of_cycles(blender, tmp_path):
    paths, output = blender.run("side_by_side", "shader_aovs", tmp_path, 128, 48)
    cycles, ours = [read(path) for path in paths]
    names = [f"ViewLayer.{name}" for name in ("Place.R", "Place.G", "Place.B", "Place.A", "Mark.X", "Muted.X")]
    for name in names:
        expected, found = cycles[name], ours[name]
        noise = np.std(found - expected) / np.sqrt(expected.size)
        assert abs(found.mean() - expected.mean()) <= 0.0005 * np.abs(expected).mean() + 4.0 * noise, name
        # Pixel by pixel, too: edges and what is behind a pane are the only noise.
        assert np.mean(np.abs(found - expected) > 0.1 * np.abs(expected).max()) < 0.02, name
    assert np.abs(ours["ViewLayer.Mark.X"]).max() > 20.0
    # Names that Blender's and Penumbra's own passes have.
    for name in ("Combined", "Shadow"):
        assert f"ViewLayer.{name}.R" in ours and f"ViewLayer.{name}.X" not in ours
        assert f'the shader AOV "{name}" is left out: another pass has its name' in output


def test_a_stopped_render_keeps_its_picture(blender, tmp_path):
    (_, path), _ = blender.run("cancel", tmp_path)
    layers = read(path)
    assert layers["ViewLayer.Combined.R"].mean() > 0.01


def test_a_noise_target_ends_a_render(blender, tmp_path):
    (told, path), output = blender.run("noise_target", tmp_path)
    layers = read(path)
    counts = layers["ViewLayer.Debug Sample Count.X"]
    assert 16 <= counts.min() < counts.max() and counts.mean() < 4096
    combined = np.dstack([layers[f"ViewLayer.Combined.{c}"] for c in "RGB"])
    error = np.dstack([layers[f"ViewLayer.Error.{c}"] for c in "RGB"])
    assert (error > 0).any() and error.mean() < 0.05 * combined.mean()
    assert told[-1].startswith("Noise 0.00") and " 0.01 in " in told[-1], told
    assert "was not reached" not in output


def test_what_is_left_out_is_told(blender, tmp_path):
    _, output = blender.run("left_out", tmp_path)
    for words in ("the pass Volume Direct is not rendered",
                  "vertices are not displaced yet", "Fast GI Approximation is not used"):
        assert words in output, words


def test_an_animation_has_its_frames(blender, tmp_path):
    frames, _ = blender.run("animation", tmp_path)
    assert frames == ["frame-0001.png", "frame-0002.png", "frame-0003.png"]
    pictures = [oiio.ImageBuf(str(tmp_path / name)).get_pixels(oiio.FLOAT) for name in frames]
    assert np.abs(pictures[0] - pictures[2]).max() > 0.1


@pytest.mark.parametrize(
    ("job", "words"),
    [("no_camera", "no camera"), ("empty_border", "too small"), ("raises", "division by zero"),
     ("stereo", "stereo pictures are not rendered"), ("replaced_engine", "restart Blender")],
)
def test_what_is_wrong_is_said_in_blender(blender, tmp_path, job, words):
    said, output = blender.run(job, tmp_path)
    assert words in said + output
    if job != "raises":
        assert "Traceback" not in output


def test_an_empty_scene_is_its_world(blender, tmp_path):
    path, _ = blender.run("empty_scene", tmp_path)
    combined = read(path)["ViewLayer.Combined.R"]
    assert np.ptp(combined) < 1e-6 and combined.mean() > 0.0


@pytest.mark.parametrize(
    ("kind", "words"),
    [
        ("missing_texture", "/no/such/wood.png"),
        ("missing_library", "library.blend is not there, or lacks what is linked from it; left out: Linked"),
        ("unknown_node", "ShaderNodeBevel"),
        ("mesh_with_nan", "not finite"),
        ("empty_slots", ""),
    ],
)
def test_bad_input_is_told_and_the_rest_is_rendered(blender, tmp_path, kind, words):
    path, output = blender.run("bad_input", kind, tmp_path)
    assert read(path)["ViewLayer.Combined.R"].mean() > 0.01
    assert words in output and "Traceback" not in output, output[-2000:]
    assert ("Warning" in output) == bool(words), output[-2000:]


def test_only_what_changed_crosses_for_the_viewport(blender, tmp_path):
    """Placements and the small document always cross; meshes, materials and images only where they changed."""
    answer, _ = blender.run("viewport_edits", tmp_path)
    heavy = {name: [call for call in calls if call[0] in {"set_mesh", "set_rounds", "set_material", "set_image_pixels"}]
             for name, (calls, _) in answer.items()}
    assert sorted(call[0] for call in heavy["first"]) == ["set_image_pixels"] + ["set_material"] * 2 + ["set_mesh"] * 2
    assert heavy["move"] == []
    assert [call[0] for call in heavy["color"]] == ["set_material"]
    assert "set_image_pixels" in [call[0] for call in heavy["paint"]]
    assert not any(call[0] == "set_mesh" for call in heavy["color"] + heavy["paint"])
    assert heavy["reshape"] == [["set_mesh", "Cube"]]
    assert heavy["delete"] == [] and any(call[0] == "remove_shape" for call in answer["delete"][0])
    means = [picture for _, picture in answer.values()]
    for before, after in zip(means, means[1:]):
        assert np.abs(np.subtract(after, before)).max() > 1e-3, means
    red, green, _ = np.subtract(means[2], means[1])
    assert red > green


def test_curves_texts_and_metaballs_are_there_once(blender, tmp_path):
    """What glows is as bright as a mesh of its shape: placed twice, half of its own light would be in its way."""
    paths, _ = blender.run("glowing", tmp_path)
    found, expected = (np.dstack([read(path)[f"ViewLayer.Combined.{c}"] for c in "RGB"]) for path in paths)
    assert expected.mean() > 0.1
    noise = np.std(found - expected) / np.sqrt(expected[..., 0].size)
    assert abs(found.mean() - expected.mean()) <= 0.002 * expected.mean() + 4.0 * noise


def test_edits_of_curves_texts_metaballs_and_geometry_nodes_are_shown(blender, tmp_path):
    answer, _ = blender.run("viewport_shapes", tmp_path)
    for name, steps in answer.items():
        for shown, afresh in steps:
            assert np.allclose(shown, afresh, rtol=1e-5), (name, steps)
        assert np.ptp([shown[0] for shown, _ in steps]) > 1e-4, (name, steps)


def test_a_world_by_the_camera_is_that_of_each_view(blender, tmp_path):
    first, looked, expected = blender.run("viewport_window", tmp_path)[0]
    assert np.allclose(looked, expected, rtol=1e-5)
    assert np.abs(np.subtract(first, looked)).max() > 0.01


def test_panels_are_those_of_cycles_where_they_hold(blender):
    ours = blender.run("panels_of", "PENUMBRA")[0]
    assert {"CYCLES_MATERIAL_PT_surface", "CYCLES_PT_context_material", "CYCLES_MATERIAL_PT_preview", "CYCLES_WORLD_PT_surface",
            "PENUMBRA_PT_sampling_render", "PENUMBRA_PT_passes_shadow", "CYCLES_OBJECT_PT_visibility"} <= set(ours["mesh"])
    # Up to 4.5 this material has no nodes, of which volumes are.
    assert ("CYCLES_MATERIAL_PT_volume" in ours["mesh"]) == (blender.version >= "5.0")
    assert {"CYCLES_LIGHT_PT_light", "CYCLES_LIGHT_PT_nodes", "CYCLES_LIGHT_PT_preview"} <= set(ours["lamp"])
    # Nothing twice, and nothing that means nothing here.
    for shown in ours.values():
        assert not {"DATA_PT_light", "MATERIAL_PT_preview", "CYCLES_RENDER_PT_sampling", "CYCLES_WORLD_PT_volume"} & set(shown)
    # For Cycles all is as it was.
    theirs = blender.run("panels_of", "CYCLES")[0]
    assert "CYCLES_RENDER_PT_sampling_render" in theirs["mesh"] and "CYCLES_LIGHT_PT_light" in theirs["lamp"]
    assert not any(name.startswith("PENUMBRA_") for shown in theirs.values() for name in shown)


def test_lines_of_freestyle_are_drawn_without_a_graphics_card(blender, tmp_path):
    paths, _ = blender.run("freestyle", tmp_path)
    if not paths:
        pytest.skip("this Blender has no Freestyle")
    red = []
    for path in paths:
        layers = read(path)
        r, g, b = (layers[f"ViewLayer.Combined.{c}"] for c in "RGB")
        red.append((r > 0.5) & (g < 0.3 * r) & (b < 0.3 * r))
    assert red[0].sum() > 50
    # The strokes' edges are antialiased by other samples.
    assert (red[0] != red[1]).sum() < 0.1 * red[0].sum(), [mask.sum() for mask in red]


def test_a_border_is_a_part_of_the_picture(blender, tmp_path):
    paths, _ = blender.run("border", tmp_path)
    whole, part, crop = [read(path)["ViewLayer.Combined.R"] for path in paths]
    assert whole.shape == part.shape == (48, 64) and crop.shape == (24, 32)
    # The border is the upper half's middle; rows come from the top.
    assert np.array_equal(part[:24, 16:48], crop)
    assert np.abs(part[24:]).max() == 0.0
    assert abs(crop.mean() / whole[:24, 16:48].mean() - 1.0) < 0.02
