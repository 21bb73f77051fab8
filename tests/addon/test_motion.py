"""Motion blur: what the add-on says of a frame is what Blender has at each time of the shutter."""

import numpy as np
import pytest

STEPS = {"Slider": 2, "Waver": 1, "Child": 1}


@pytest.mark.parametrize(("position", "shutter"), [("START", [0.0, 0.5]), ("CENTER", [-0.25, 0.25]), ("END", [-0.5, 0.0])])
def test_keys_are_where_blender_has_things(blender, position, shutter):
    answer, _ = blender.run("gathered", position)
    assert answer["shutter"] == pytest.approx(shutter)
    assert answer["back"] == [4, 0.0] and answer["warnings"] == []
    times = {steps: [time for time in np.linspace(*shutter, 2**steps + 1).tolist() if time != 0.0] for steps in (1, 2)}
    for name, steps in STEPS.items():
        keys = answer["motion"][name]
        of_time = {}
        for time, matrix in keys:
            of_time.setdefault(time, []).append(matrix)
        assert sorted(of_time) == pytest.approx(times[steps]), name
        for time, matrices in of_time.items():
            expected = answer["truth"][str(time)][0][name]
            # In the order of instances: the child itself, and one for each vertex of its parent.
            assert len(matrices) == len(expected) == (4 if name == "Child" else 1)
            np.testing.assert_allclose(matrices, expected, atol=1e-6)
    # What moves does move.
    slid = [matrix[3] for _, matrix in answer["motion"]["Slider"]]
    assert slid == sorted(slid) and slid[-1] - slid[0] > 0.3
    assert "Still" not in answer["motion"]
    # Points of what deforms, of nothing else.
    assert list(answer["points"]) == ["Waver"]
    for time, points in answer["points"]["Waver"]:
        np.testing.assert_allclose(points, answer["truth"][str(time)][1], atol=1e-6)
    assert [time for time, _ in answer["points"]["Waver"]] == pytest.approx(times[1])
    for time, matrix in answer["camera"]:
        np.testing.assert_allclose(matrix, answer["truth"][str(time)][0]["Camera"][0], atol=1e-6)
    assert [time for time, _ in answer["camera"]] == pytest.approx(times[1])
    # Lamps stand still in the middle of the shutter.
    middle = answer["truth"][str(sum(shutter) / 2.0)][0]["Lamp"][0]
    np.testing.assert_allclose(answer["lamp"], middle, atol=1e-6)


def test_nothing_is_done_without_motion_blur(blender):
    assert blender.run("off")[0] == [False, False, [], [], []]


def test_what_is_not_blurred_is_told(blender):
    frame, output = blender.run("changing_count")
    assert frame == [4, 0.0]
    assert 'the points of "Grower" change in number while the shutter is open' in output, output[-2000:]
    assert "zoom" not in output
    assert "Traceback" not in output


def test_a_stopped_gathering_returns_to_the_frame(blender):
    seen, *frame = blender.run("stopped")[0]
    assert frame == [4, 0.25] and seen[-1] == 4.25 and len(seen) == 2


def test_points_of_every_kind_of_shape_move(blender):
    changes, warnings = blender.run("shapes")[0]
    assert warnings == []
    found = {name: {time: np.reshape(change, (-1, 3)) for time, change in moved} for name, moved in changes.items()}
    assert set(found) == {"PointCloud", "Curves", "Text", "Flow", "Lawn", "Lawn, Grass"}
    for name, moved in found.items():
        assert sorted(moved) == pytest.approx([-0.5, 0.5]), name
    for name, count in (("PointCloud", 3), ("Curves", 5)):
        for time, change in found[name].items():
            np.testing.assert_allclose(change, [[0.0, 0.0, 0.1 * time]] * count, atol=1e-5, err_msg=name)
    # Metres a second at ten frames a second, whatever is keyed.
    for time, change in found["Flow"].items():
        np.testing.assert_allclose(change, time / 10.0 * np.arange(9).reshape(3, 3), atol=1e-5)
    for name in ("Text", "Lawn", "Lawn, Grass"):
        before, after = (found[name][time] for time in sorted(found[name]))
        assert np.abs(after - before).max() > 0.05, name
    lawn = [change[:, 2] for _, change in sorted(found["Lawn"].items())]
    assert np.ptp(lawn[0]) < 1e-5 and lawn[0][0] < -0.05 and lawn[1][0] > 0.05
    # Hair goes with what it grows on.
    for time, change in found["Lawn, Grass"].items():
        np.testing.assert_allclose(change[:, 2], found["Lawn"][time][0, 2], atol=1e-4)
