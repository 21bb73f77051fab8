"""Export for Penumbra: what comes back from a file is what F12 renders. Needs the program, built for debugging
or named by PENUMBRA."""

import json
import os
import pathlib
import subprocess

import numpy as np
import pytest
from lamps_of_cycles import TO_Y_UP, close, differences, place

ROOT = pathlib.Path(__file__).resolve().parents[2]
EXE = ROOT / os.environ.get("PENUMBRA", "target/debug/penumbra")


def read(path, *options):
    """What the engine makes of a file, and what it says of it."""
    done = subprocess.run([EXE, "info", "--json", "--values", path, *options], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    info = json.loads(done.stdout)
    return info["values"], info["warnings"]


def plain(name):
    """A name as USD has it."""
    return "".join(c if c.isalnum() else "_" for c in name)


def lights(values):
    return {plain(light["name"]): light for light in values["lights"] if light["kind"]["kind"] != "dome"}


@pytest.mark.parametrize("ending", ["usdc", "usda", "usdz", "glb", "gltf"])
def test_every_lamp_comes_back(blender, tmp_path, ending):
    path = tmp_path / f"lamps.{ending}"
    (document, left), _ = blender.run("export", "lamps", path)
    values, warnings = read(path)
    assert warnings == []
    found = lights(values)
    assert len(found) == len(document["lights"]) >= 9
    wrong = {lamp["name"]: differences(lamp, found[plain(lamp["name"])]) for lamp in document["lights"]}
    assert not any(wrong.values()), wrong
    (dome,) = [light for light in values["lights"] if light["kind"]["kind"] == "dome"]
    assert close(dome["kind"]["radiance"], [0.08, 0.2, 0.4])
    assert left == []


@pytest.mark.parametrize("ending", ["usdc", "glb"])
@pytest.mark.parametrize("scene", ["shifted", "depth_of_field", "panorama", "orthographic"])
def test_every_camera_comes_back(blender, tmp_path, ending, scene):
    path = tmp_path / f"{scene}.{ending}"
    (document, _), _ = blender.run("export", scene, path)
    values, warnings = read(path)
    assert warnings == []
    data, (camera,) = document["camera"], values["cameras"]
    assert values["render"]["camera"] == camera["place"]
    assert values["render"]["resolution"] == document["render"]["size"]
    matrix = np.array(data["matrix"])
    where, axis = place(camera)
    assert close(where, TO_Y_UP @ matrix[:3, 3]) and close(axis, TO_Y_UP @ -matrix[:3, 2])
    assert close([camera["clip_near"], camera["clip_far"]], [data["clip_start"], data["clip_end"]])
    aspect = document["render"]["size"][0] * document["render"]["pixel_aspect"][0] / document["render"]["size"][1]
    projection = camera["projection"]
    if scene == "orthographic":
        assert close(projection["half_width"], 0.5 * data["ortho_scale"])
        assert close(projection["half_height"], 0.5 * data["ortho_scale"] / aspect)
    elif scene == "panorama":
        assert projection["kind"] == "equirectangular"
    elif scene == "shifted":
        # The vertical side is the one that fits; shifts are in sizes of it.
        assert close(2.0 * np.tan(0.5 * projection["fov_y"]), data["sensor_height"] / data["lens"])
        assert close(projection["aspect"], aspect)
        assert close(camera["shift"], [data["shift_x"] / aspect, data["shift_y"]])
    else:
        assert close(2.0 * np.tan(0.5 * projection["fov_y"]) * aspect, data["sensor_width"] / data["lens"])
        lens = camera["lens"]
        assert close(lens["focus_distance"], 7.0)
        assert close(lens["aperture_radius"], 1e-3 * data["lens"] / (2.0 * data["dof"]["fstop"]))


@pytest.mark.parametrize("ending", ["usdc", "glb"])
def test_the_world_lies_as_in_cycles(blender, tmp_path, ending):
    path = tmp_path / f"world.{ending}"
    blender.run("export", "world_image", path)
    values, warnings = read(path)
    assert warnings == []
    (dome,) = values["lights"]
    assert (tmp_path / "textures" / dome["kind"]["image"]).exists()
    assert close(dome["kind"]["radiance"], [1.0, 1.0, 1.0])
    # Mapping turns the direction that is looked up: the image's centre, +x, is seen where that takes it.
    x, y, z = 0.2, 0.1, 0.7
    turn_x = np.array([[1, 0, 0], [0, np.cos(x), -np.sin(x)], [0, np.sin(x), np.cos(x)]])
    turn_y = np.array([[np.cos(y), 0, np.sin(y)], [0, 1, 0], [-np.sin(y), 0, np.cos(y)]])
    turn_z = np.array([[np.cos(z), -np.sin(z), 0], [np.sin(z), np.cos(z), 0], [0, 0, 1]])
    back = (turn_z @ turn_y @ turn_x).T
    matrix = np.array(dome["matrix"]).reshape(4, 4)
    for local, direction in ((matrix[0, :3], [1, 0, 0]), (matrix[1, :3], [0, 0, 1])):
        assert close(local, TO_Y_UP @ back @ direction), matrix


@pytest.mark.parametrize("ending", ["usdc", "glb"])
def test_what_moves_is_there_at_each_frame(blender, tmp_path, ending):
    path = tmp_path / f"moving.{ending}"
    (_, left), _ = blender.run("export", "moving", path, "animation")
    for frame, energy, spread in ((1, 100.0, 3.0), (3, 150.0, 2.0), (5, 200.0, 1.0), (6, 100.0, 3.0)):
        values, _ = read(path, "--frame", str(frame))
        (light,) = values["lights"]
        assert close(light["kind"]["radiance"], [energy / np.pi] * 3, 1e-5)
        assert close(light["kind"]["spread"], spread, 1e-5)
        # Between its keys at 1 and 5 the curve starts flat: 2.25 is Blender's own value.
        assert close(light["matrix"][12], 2.25 if frame == 3 else frame, 1e-5)
    assert left == []


@pytest.mark.parametrize("ending", ["usdc", "usdz"])
def test_the_shutter_is_that_of_the_scene(blender, tmp_path, ending):
    path = tmp_path / f"blurred.{ending}"
    _, output = blender.run("export", "blurred", path, "animation")
    (camera,) = read(path, "--frame", "3")[0]["cameras"]
    if "the shutter of the cameras is not exported" in output:
        # The package bpy comes without pxr, which Blender has.
        assert ending == "usdz" or "this Blender has no pxr" in output
    else:
        assert ending == "usdc" and close(camera["shutter"], [0.0, 0.6], 1e-6)


@pytest.mark.parametrize("options", [(), ("instancing",)])
@pytest.mark.parametrize("ending", ["usdc", "glb"])
def test_lamps_in_instances_shine_where_they_stand(blender, tmp_path, ending, options):
    path = tmp_path / f"instances.{ending}"
    _, output = blender.run("export", "instances", path, *options)
    values, _ = read(path)
    assert sorted(light["matrix"][12] for light in values["lights"]) == [1.0, 2.0]
    assert all(close(light["kind"]["spread"], 1.0) for light in values["lights"])
    # Blender's USD exporter leaves these instances empty, which is told.
    assert ("Realize Instances" in output) == (ending == "usdc")
    assert len(values["instances"]) == (3 if ending == "usdc" else 3 + 16)


def test_nothing_is_left_behind_where_it_fails(blender, tmp_path):
    answer, output = blender.run("export_fails", tmp_path)
    assert answer["refused"] == ["file.obj", "missing/file.usdc", "folder.usdc"]
    assert answer["left"] == []
    assert "tells no format" in output and "there is no folder" in output


def test_the_command_line_exports(blender, tmp_path):
    assert blender.run("export_command", tmp_path / "out.glb")[0] == 0
    values, _ = read(tmp_path / "out.glb")
    assert len(values["lights"]) == 1
