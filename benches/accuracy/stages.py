"""Small stages for the calibration of errors, each hard in its own way, as USD text."""

_HEADER = """#usda 1.0
(
    defaultPrim = "World"
    metersPerUnit = 1
    upAxis = "Y"
)
def Xform "World"
{
"""

_CAMERA = """    def Camera "Camera"
    {
        float focalLength = 35
        float horizontalAperture = 36
        float verticalAperture = 24.3
        float2 clippingRange = (0.01, 1000)
        float fStop = %(fstop)s
        float focusDistance = 4
        double3 xformOp:translate = (0, 1.6, 4.6)
        float3 xformOp:rotateXYZ = (-14, 0, 0)
        uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:rotateXYZ"]
    }
"""


def material(name, **inputs):
    """A UsdPreviewSurface for what is bound to `name`."""
    lines = []
    for key, value in inputs.items():
        kind = "color3f" if isinstance(value, tuple) else "int" if key.startswith("use") else "float"
        lines.append(f"            {kind} inputs:{key} = {value}")
    body = "\n".join(lines)
    return f"""    def Material "{name}Look"
    {{
        token outputs:surface.connect = </World/{name}Look/Surface.outputs:surface>
        def Shader "Surface"
        {{
            uniform token info:id = "UsdPreviewSurface"
{body}
            token outputs:surface
        }}
    }}
"""


def _bound(look):
    return f"        rel material:binding = </World/{look}Look>\n"


_API = '(prepend apiSchemas = ["MaterialBindingAPI"])'


def quad(name, points, look):
    """A parallelogram of four corners."""
    corners = ", ".join(str(tuple(p)) for p in points)
    return f"""    def Mesh "{name}" {_API}
    {{
        point3f[] points = [{corners}]
        int[] faceVertexCounts = [4]
        int[] faceVertexIndices = [0, 1, 2, 3]
        uniform token subdivisionScheme = "none"
        uniform bool doubleSided = 1
{_bound(look)}    }}
"""


def ball(name, at, radius, look):
    return f"""    def Sphere "{name}" {_API}
    {{
        double radius = {radius}
        double3 xformOp:translate = {at}
        uniform token[] xformOpOrder = ["xformOp:translate"]
{_bound(look)}    }}
"""


def cube(name, at, size, look, turn=20):
    return f"""    def Cube "{name}" {_API}
    {{
        double size = {size}
        double3 xformOp:translate = {at}
        float3 xformOp:rotateXYZ = (0, {turn}, 0)
        uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:rotateXYZ"]
{_bound(look)}    }}
"""


def light(kind, name, at=(0, 0, 0), turn=(-90, 0, 0), **inputs):
    lines = []
    for key, value in inputs.items():
        lines.append(f"        {'color3f' if isinstance(value, tuple) else 'float'} inputs:{key} = {value}")
    body = "\n".join(lines)
    return f"""    def {kind} "{name}"
    {{
{body}
        double3 xformOp:translate = {at}
        float3 xformOp:rotateXYZ = {turn}
        uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:rotateXYZ"]
    }}
"""


_FLOOR = quad("Floor", [(-8, 0, 8), (8, 0, 8), (8, 0, -8), (-8, 0, -8)], "Floor")
_ROOM = "".join((
    quad("Floor", [(-2, 0, 5), (2, 0, 5), (2, 0, -2), (-2, 0, -2)], "Floor"),
    quad("Ceiling", [(-2, 3, 5), (2, 3, 5), (2, 3, -2), (-2, 3, -2)], "Floor"),
    quad("Back", [(-2, 0, -2), (2, 0, -2), (2, 3, -2), (-2, 3, -2)], "Floor"),
    quad("Front", [(-2, 0, 5), (2, 0, 5), (2, 3, 5), (-2, 3, 5)], "Floor"),
    quad("Left", [(-2, 0, -2), (-2, 0, 5), (-2, 3, 5), (-2, 3, -2)], "Red"),
))
_RIGHT = quad("Right", [(2, 0, -2), (2, 0, 5), (2, 3, 5), (2, 3, -2)], "Green")
# The right wall with a slit, behind which the light is.
_SLIT = "".join((
    quad("RightNear", [(2, 0, 0.4), (2, 0, 5), (2, 3, 5), (2, 3, 0.4)], "Green"),
    quad("RightFar", [(2, 0, -2), (2, 0, -0.2), (2, 3, -0.2), (2, 3, -2)], "Green"),
))
_THINGS = ball("Ball", (-0.7, 0.7, 0.2), 0.7, "Ball") + cube("Box", (0.9, 0.5, 0), 1, "Box")
_WHITE = material("Floor", diffuseColor=(0.7, 0.7, 0.7), roughness=1)
_COLORS = material("Red", diffuseColor=(0.7, 0.1, 0.1), roughness=1) + material(
    "Green", diffuseColor=(0.1, 0.6, 0.1), roughness=1)
_BOX = material("Box", diffuseColor=(0.2, 0.3, 0.7), roughness=0.6)
_MATTE = material("Ball", diffuseColor=(0.8, 0.5, 0.2), roughness=1)


def _metal(roughness):
    return material("Ball", diffuseColor=(0.9, 0.8, 0.6), metallic=1, roughness=roughness)


def _lamp(size, intensity, at=(1.5, 3.5, 1.5), **more):
    return light("SphereLight", "Lamp", at, radius=size, intensity=intensity, **more)


def _sky(intensity):
    return light("DomeLight", "Sky", turn=(0, 0, 0), intensity=intensity, color=(0.7, 0.85, 1.0))


def _rect(intensity, size=1.5, at=(0, 2.99, 1), **more):
    return light("RectLight", "Panel", at, width=size, height=size, intensity=intensity, **more)


def _many(count):
    lamps = (
        light("SphereLight", f"Lamp{i}", ((i % 5) * 1.2 - 2.4, 0.6 + 0.4 * (i * 7 % 5), (i // 5) * 1.2 - 3),
              radius=0.04, intensity=30 + 40 * (i * 3 % 4), color=(1, 0.4 + 0.12 * (i % 5), 0.3 + 0.17 * (i * 2 % 5)))
        for i in range(count)
    )
    return "".join(lamps)


def stages():
    """Text by name."""
    plain = _FLOOR + _THINGS + _WHITE + _BOX + _MATTE
    room = _ROOM + _RIGHT + _THINGS + _WHITE + _COLORS + _BOX
    shiny = _FLOOR + _THINGS + _BOX + material("Floor", diffuseColor=(0.4, 0.4, 0.4), roughness=0.2)
    glass = material("Ball", diffuseColor=(1, 1, 1), opacity=0.05, ior=1.5, roughness=0.0)
    thin = material("Ball", diffuseColor=(0.9, 0.5, 0.3), opacity=0.5, roughness=0.4, ior=1)
    glow = material("Ball", diffuseColor=(0, 0, 0), emissiveColor=(4, 3, 2))
    open_ = _FLOOR + _THINGS + _WHITE + _BOX
    bodies = {
        "soft_lamp": plain + _lamp(0.6, 12),
        "small_lamp": plain + _lamp(0.02, 9000),
        "sky": plain + _sky(0.8),
        "sun_and_sky": plain + _sky(0.3) + light("DistantLight", "Sun", turn=(-50, 30, 0), angle=0.53, intensity=30000),
        "panel": plain + _rect(6),
        "two_colours": plain + _lamp(0.3, 30, color=(1, 0.2, 0.1)) + light(
            "SphereLight", "Blue", (-2, 2, 1), radius=0.2, intensity=40, color=(0.1, 0.2, 1)),
        "many_lamps": plain + _many(25),
        "glossy_floor": shiny + _MATTE + _rect(6) + _sky(0.1),
        "rough_metal": open_ + _metal(0.3) + _lamp(0.4, 20) + _sky(0.2),
        "polished_metal": open_ + _metal(0.08) + _lamp(0.4, 20) + _sky(0.2),
        "mirror": open_ + _metal(0.0) + _lamp(0.15, 120) + _sky(0.2),
        "glass": open_ + glass + _lamp(0.4, 20) + _sky(0.2),
        "half_open": open_ + thin + _lamp(0.4, 20) + _sky(0.2),
        "glowing_ball": open_ + glow,
        "room": room + _MATTE + _rect(8),
        "room_with_mirror": room + _metal(0.0) + _rect(8),
        "slit": _ROOM + _SLIT + _THINGS + _WHITE + _COLORS + _BOX + _MATTE + light(
            "RectLight", "Window", (3.5, 1.5, 0.1), (0, 90, 0), width=2, height=2, intensity=60),
    }
    result = {name: _HEADER + _CAMERA % {"fstop": 0} + body + "}\n" for name, body in bodies.items()}
    result["out_of_focus"] = _HEADER + _CAMERA % {"fstop": 0.02} + plain + _lamp(0.3, 40) + _sky(0.2) + "}\n"
    return result
