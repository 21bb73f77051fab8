"""A wagon wheel that rolls over planks, and a camera that goes along. From frame to frame it turns by two degrees less
than the angle between its spokes: without motion blur it seems to turn backwards."""
import math

SPOKES = 12
RADIUS = 0.6
# Degrees per frame.
TURN = 360.0 / SPOKES - 2.0
FRAMES = 48
STEP = math.radians(TURN) * RADIUS


def material(name, color, roughness, metallic=0.0):
    red, green, blue = color
    return f"""    def Material "{name}"
    {{
        token outputs:surface.connect = </Looks/{name}/Surface.outputs:surface>
        def Shader "Surface"
        {{
            uniform token info:id = "UsdPreviewSurface"
            color3f inputs:diffuseColor = ({red}, {green}, {blue})
            float inputs:roughness = {roughness}
            float inputs:metallic = {metallic}
            token outputs:surface
        }}
    }}
"""


def moving(start, way):
    """A transform that goes along x by `way` in all."""
    x, y, z = start
    return f"double3 xformOp:translate.timeSamples = {{ 0: ({x}, {y}, {z}), {FRAMES}: ({x + way:.6f}, {y}, {z}) }}"


def cylinder(name, radius, height, look, ops="", order=""):
    return f"""        def Cylinder "{name}"
        {{
            double radius = {radius}
            double height = {height}
            token axis = "Z"
            rel material:binding = </Looks/{look}>
            {ops}
            uniform token[] xformOpOrder = [{order}]
        }}
"""


def wheel():
    ring = ", ".join(
        f"({RADIUS * math.cos(a):.5f}, {RADIUS * math.sin(a):.5f}, 0)" for a in (math.tau * i / 96 for i in range(96))
    )
    spokes = "".join(
        cylinder(
            f"Spoke{i}", 0.022, RADIUS, "Oak",
            f"double xformOp:rotateZ = {360.0 * i / SPOKES}\n            double xformOp:rotateX = 90\n"
            f"            double3 xformOp:translate = (0, 0, {RADIUS / 2})",
            '"xformOp:rotateZ", "xformOp:rotateX", "xformOp:translate"',
        )
        for i in range(SPOKES)
    )
    return f"""def Xform "Wheel"
{{
    {moving((0.0, RADIUS + 0.05, 0.0), STEP * FRAMES)}
    uniform token[] xformOpOrder = ["xformOp:translate"]
    def Xform "Turning"
    {{
        double xformOp:rotateZ.timeSamples = {{ 0: 0, {FRAMES}: {-TURN * FRAMES} }}
        uniform token[] xformOpOrder = ["xformOp:rotateZ"]
{spokes}        def BasisCurves "Rim"
        {{
            uniform token type = "linear"
            uniform token wrap = "periodic"
            int[] curveVertexCounts = [96]
            point3f[] points = [{ring}]
            float[] widths = [0.1] ( interpolation = "constant" )
            rel material:binding = </Looks/Iron>
        }}
{cylinder("Hub", 0.1, 0.2, "Iron")}    }}
}}
"""


def plank(i):
    dark = 0.75 + 0.25 * math.sin(12.9 * i)
    shade = ", ".join(f"{dark * c:.4f}" for c in (0.42, 0.3, 0.2))
    return f"""    def Cube "Plank{i}"
    {{
        double size = 1
        color3f[] primvars:displayColor = [({shade})]
        double3 xformOp:translate = ({0.3 * i - 6.0:.2f}, -0.05, 0)
        float3 xformOp:scale = (0.28, 0.1, 2.4)
        uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:scale"]
    }}
"""


def build(folder, _):
    looks = material("Oak", (0.55, 0.36, 0.18), 0.5) + material("Iron", (0.5, 0.5, 0.52), 0.35, 1.0)
    planks = "".join(plank(i) for i in range(100))
    (folder / "wheel.usda").write_text(f"""#usda 1.0
(
    doc = "A wagon wheel and a camera that goes along. Made by scenes/make.py. Licence: CC0 1.0"
    upAxis = "Y"
    metersPerUnit = 1
    startTimeCode = 1
    endTimeCode = {FRAMES - 1}
    timeCodesPerSecond = 24
    framesPerSecond = 24
)

def Camera "Camera"
{{
    float focalLength = 50
    float horizontalAperture = 36
    float verticalAperture = 27
    float2 clippingRange = (0.1, 1000)
    double shutter:open = -0.25
    double shutter:close = 0.25
    {moving((0.0, 0.65, 2.6), STEP * FRAMES)}
    uniform token[] xformOpOrder = ["xformOp:translate"]
}}

{wheel()}
def Scope "Road"
{{
{planks}}}

def DomeLight "Sky"
{{
    color3f inputs:color = (0.5, 0.65, 0.9)
    float inputs:intensity = 0.6
}}

def DistantLight "Sun"
{{
    float inputs:intensity = 2.5
    bool inputs:normalize = 1
    float inputs:angle = 1
    color3f inputs:color = (1, 0.9, 0.75)
    double xformOp:rotateY = 30
    double xformOp:rotateX = -50
    uniform token[] xformOpOrder = ["xformOp:rotateY", "xformOp:rotateX"]
}}

def Scope "Looks"
{{
{looks}}}
""")
