"""What Cycles makes of lamps and cameras, by the formulas of facts/cycles.md (measured), for comparison.

Everything is in Blender's space, z up; `values` are what `penumbra info --json --values` says, y up.
"""

import math

import numpy as np

# From Blender's space to the engine's: (x, y, z) to (x, z, -y).
TO_Y_UP = np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]], float)


def watts(lamp):
    """P = energy x 2^exposure x color x temperature."""
    power = lamp["energy"] * 2.0 ** lamp.get("exposure", 0.0)
    return power * np.array(lamp["color"]) * np.array(lamp.get("temperature_color", [1.0, 1.0, 1.0]))


def kind(lamp):
    """Kind, sizes, and radiance (intensity of points, irradiance of suns) of a lamp."""
    power, normalize = watts(lamp), lamp.get("normalize", True)
    pi = math.pi
    if lamp["type"] in {"POINT", "SPOT"}:
        radius = lamp["radius"]
        if radius == 0.0:
            return {"kind": "point", "intensity": power / (4 * pi) if normalize else power / pi}
        radiance = power / (4 * pi**2 * radius**2) if normalize else power / pi
        return {"kind": "sphere", "radius": radius, "radiance": radiance, "facing": lamp["use_soft_falloff"]}
    if lamp["type"] == "SUN":
        cap = pi * math.sin(0.5 * lamp["angle"]) ** 2
        return {"kind": "distant", "irradiance": power * (1.0 if normalize else cap), "angle": lamp["angle"]}
    matrix = np.array(lamp["matrix"])
    width = lamp["size"] * np.linalg.norm(matrix[:3, 0])
    second = lamp["size"] if lamp["shape"] in {"SQUARE", "DISK"} else lamp["size_y"]
    height = second * np.linalg.norm(matrix[:3, 1])
    is_round = lamp["shape"] in {"DISK", "ELLIPSE"}
    area = width * height * (0.25 * pi if is_round else 1.0)
    radiance = power / (pi * area) if normalize else power / pi
    return {"kind": "disk" if is_round else "rect", "width": width, "height": height, "radiance": radiance,
            "spread": lamp["spread"], "two_sided": False}


def shines(lamp):
    """Where a lamp stands and the direction in which it shines, in the engine's space."""
    matrix = np.array(lamp["matrix"])
    axis = -matrix[:3, 2] / np.linalg.norm(matrix[:3, 2])
    return TO_Y_UP @ matrix[:3, 3], TO_Y_UP @ axis


def place(values):
    """The same of the engine's light or camera."""
    matrix = np.array(values["matrix"]).reshape(4, 4)
    axis = -matrix[2, :3] / np.linalg.norm(matrix[2, :3])
    return matrix[3, :3], axis


def close(found, expected, tolerance=2e-6):
    """Numbers and arrays to the precision of the floats that files hold."""
    found, expected = np.asarray(found, float), np.asarray(expected, float)
    return bool(np.all(np.abs(found - expected) <= tolerance * np.maximum(1.0, np.abs(expected))))


def differences(lamp, light):
    """What of a light is not as the lamp says; empty where it is the same."""
    wrong = []
    expected = kind(lamp)
    for key, value in expected.items():
        found = light["kind"].get(key)
        same = found == value if isinstance(value, (str, bool)) else found is not None and close(found, value)
        if not same:
            wrong.append(f"{key}: {found} is not {value}")
    for what, found, value in zip(("stands at", "shines to"), place(light), shines(lamp)):
        if not close(found, value):
            wrong.append(f"{what} {found}, not {value}")
    if lamp["type"] == "SPOT":
        cone = light["shaping"]["cone"] or {}
        if cone.get("kind") != "blend" or not close([cone["angle"], cone["blend"]],
                                                    [0.5 * lamp["spot_size"], lamp["spot_blend"]]):
            wrong.append(f"cone: {cone}")
    elif light["shaping"]["cone"] is not None:
        wrong.append(f"cone: {light['shaping']['cone']}")
    if light["links"]["cast_shadow"] != lamp["use_shadow"]:
        wrong.append("shadow")
    seen = {ray: light["visibility"][ray] for ray in lamp["visibility"]}
    if seen != lamp["visibility"]:
        wrong.append(f"visibility: {seen} is not {lamp['visibility']}")
    return wrong
