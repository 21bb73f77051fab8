"""Looks of stages as Penumbra reads them, against OpenUSD itself (usd-core): inputs of UsdPreviewSurface and their
textures, UV sets, displayColor, normals, faces of subsets, links of lights, the settings of the render."""

import struct
import zlib

import numpy as np
import pytest

pytest.importorskip("pxr", reason="usd-core is not installed")
import test_usd_core  # noqa: E402
import usd_looks  # noqa: E402
import usd_shading  # noqa: E402
from pxr import Tf, UsdLux, UsdShade  # noqa: E402
from test_usd_core import ASSETS, NOT_JUDGED, STAGES, Answer, Differences, near, read, rows  # noqa: E402
from usd_judge import Stage  # noqa: E402


def judge(path, info=None):
    """All differences in looks between Penumbra, which said `info`, and OpenUSD at the stage `path`."""
    stage, info, found = Stage(path), info or read(path), Differences()
    answer, values = Answer(info), info["values"]
    materials = {material["place"]: material for material in values["materials"]}
    for prim in stage.gprims():
        instances = answer.instances.get(str(prim.GetPath()), [])
        if len(instances) == 1 and prim.GetTypeName() == "Mesh":
            judge_mesh(stage, prim, instances[0], materials, answer, found)
    for path, material in materials.items():
        prim = stage.stage.GetPrimAtPath(path) if path and "." not in path else None
        if prim and prim.IsA(UsdShade.Material):
            judge_material(stage, prim, material, answer, found)
    judge_links(stage, values, answer, found)
    judge_render(stage, values["render"], answer, found)
    return found


def judge_material(stage, prim, material, answer, found):
    shader = usd_looks.preview_surface(stage, prim)
    # What was told of one of its nodes may have changed any input.
    if shader and not any(f", {prim.GetPath()}" in warning for warning in answer.warnings):
        check = lambda ok, what: found.check(ok, str(prim.GetPath()), what)
        usd_shading.judge(stage, shader, material, test_usd_core.near, check)


def judge_mesh(stage, prim, instance, materials, answer, found):
    path, mesh, faces = str(prim.GetPath()), answer.meshes[instance["mesh"]], stage.faces(prim)
    if faces is None or answer.warned(path):
        return
    points, kept = faces
    if not kept:
        return
    theirs = points[np.concatenate([corners for _, corners in kept])].astype(float)
    triangles = np.array(mesh["triangles"], dtype=int).reshape(-1, 3)
    ours = np.array(mesh["points"], dtype=float).reshape(-1, 3)[triangles.ravel()]

    def same(attribute, expected, what):
        """Points with a value, by the corners of triangles and by those of faces."""
        values = np.array(attribute["values"], dtype=float)
        values = values[triangles.ravel()] if attribute["per"] == "point" else values
        values = values[:, : expected.shape[1]]
        equal = near(rows(np.hstack([ours, values]), 4), rows(np.hstack([theirs, expected]), 4), 3e-4)
        found.check(equal, path, f"has other {what}")

    bound = {material.GetPath() for material in stage.materials(prim, kept)}
    if not bound and not prim.HasAPI(UsdLux.LightAPI) and mesh["colors"]:
        color = usd_looks.primvar_corners(stage, prim, kept, "displayColor")
        opacity = usd_looks.primvar_corners(stage, prim, kept, "displayOpacity")
        if color is not None and color.shape[1] == 3:
            opacity = np.ones((len(color), 1)) if opacity is None else opacity
            same(mesh["colors"], np.hstack([np.maximum(color, 0), np.clip(opacity, 0, 1)]), "colours")
    normals = usd_looks.normal_corners(stage, prim, kept)
    if normals is not None:
        found.check(mesh["normals"] is not None, path, "has no normals")
        if mesh["normals"]:
            same(mesh["normals"], normals, "normals")
    for material in bound:
        shader, desc = usd_looks.preview_surface(stage, stage.stage.GetPrimAtPath(material)), materials.get(str(material))
        texture = desc and desc["base_color"]["texture"]
        expected = shader and usd_looks.value_or_texture(stage, shader, "diffuseColor", (0.18,) * 3)
        if not texture or not expected or expected[0] != "texture":
            continue
        uvs = usd_looks.primvar_corners(stage, prim, kept, expected[2])
        if uvs is not None and uvs.shape[1] == 2:
            same(mesh["uvs"][texture["uv_set"]], np.stack([uvs[:, 0], 1 - uvs[:, 1]], axis=1), f"UVs {expected[2]}")
    judge_subsets(stage, prim, kept, instance, mesh, found)


def judge_subsets(stage, prim, kept, instance, mesh, found):
    """How many triangles each material has."""
    if mesh["material_slots"] is None or prim.HasAPI(UsdLux.LightAPI):
        return
    sizes = {face: len(corners) - 2 for face, corners in kept}
    expected, left = {}, set(sizes)
    for subset in UsdShade.MaterialBindingAPI(prim).GetMaterialBindSubsets():
        inside = left & set(subset.GetIndicesAttr().Get(stage.time) or [])
        left -= inside
        material = stage.bound(subset.GetPrim()) or stage.bound(prim)
        name = material.GetName() if material else None
        expected[name] = expected.get(name, 0) + sum(sizes[face] for face in inside)
    material = stage.bound(prim)
    name = material.GetName() if material else None
    expected[name] = expected.get(name, 0) + sum(sizes[face] for face in left)
    expected = {name: count for name, count in expected.items() if count}
    ours = {}
    for slot in mesh["material_slots"]:
        material = instance["materials"][slot]
        name = material["name"] if material and material["place"] else None
        ours[name] = ours.get(name, 0) + 1
    found.check(ours == expected, str(prim.GetPath()), f"has triangles {ours}, not {expected}")


def judge_links(stage, values, answer, found):
    places = {instance["place"] for instance in values["instances"]}
    described = {light["place"]: light for light in values["lights"]}
    described.update({place: answer.instances[place][0] for place in places})
    for prim in usd_looks.lights(stage):
        path = str(prim.GetPath())
        light = described.get(path)
        if light is None:
            continue
        for ours, name in (("receivers", "lightLink"), ("blockers", "shadowLink")):
            expected, said = usd_looks.linked(prim, name, places), light["links"][ours]
            if expected is None:
                continue
            mine = places if said is None else set(said.get("include", places - set(said.get("exclude", []))))
            found.check(mine == expected, path, f"{name} has {sorted(mine)[:5]}, not {sorted(expected)[:5]}")
        response = [prim.GetAttribute(f"inputs:{name}").Get(stage.time) for name in ("diffuse", "specular")]
        found.check(near(light["links"]["response"], response), path, f"has the factors {light['links']['response']}")


def judge_render(stage, render, answer, found):
    def judge_framing(expected, framing, name):
        for key, value in (expected or {}).items():
            ours = framing[key]
            numbers = isinstance(value, (list, float)) and ours is not None
            found.check(near(ours, value) if numbers else ours == value, name, f"{key} is {ours}, not {value}")

    judge_framing(usd_looks.render(stage), render, "render")
    pictures = usd_looks.pictures(stage)
    for product in render["products"]:
        judge_framing(pictures[product["name"]], product, product["name"])


@pytest.mark.skipif(not ASSETS.is_dir(), reason=f"{ASSETS} is not there")
@pytest.mark.parametrize("path", STAGES, ids=lambda path: "/".join(path.parts[-3:]))
def test_looks_are_those_of_openusd(path):
    if path.name in NOT_JUDGED:
        pytest.skip(NOT_JUDGED[path.name])
    try:
        Stage(path)
    except Tf.ErrorException as error:
        pytest.skip(f"usd-core does not open it: {str(error).splitlines()[0]}")
    found = judge(path)
    assert not found, "\n".join(found[:20])


STAGE = """#usda 1.0
( renderSettingsPrimPath = "/Render/Main" )
def Scope "Render" {
    def RenderSettings "Main" {
        rel camera = </Cam>
        rel products = [</Render/One>, </Render/Two>]
        uniform int2 resolution = (64, 32)
        uniform token aspectRatioConformPolicy = "adjustApertureHeight"
        uniform float pixelAspectRatio = 2
    }
    def RenderProduct "One" {
        token productName = "one.exr"
        uniform float4 dataWindowNDC = (0.25, 0, 0.75, 0.5)
    }
    def RenderProduct "Two" {
        rel camera = </Other>
        token productName = "two.exr"
        uniform int2 resolution = (32, 32)
        uniform float pixelAspectRatio = 1
        uniform token aspectRatioConformPolicy = "cropAperture"
        uniform float4 dataWindowNDC = (-0.125, -0.25, 1.125, 1.25)
    }
}
def Camera "Cam" {}
def Camera "Other" {}
def Scope "Looks" {
    def Material "Other" {
        token outputs:surface.connect = </Looks/Other/S.outputs:surface>
        def Shader "S" {
            uniform token info:id = "UsdPreviewSurface"
            color3f inputs:emissiveColor = (1, 2, 3)
            token outputs:surface
        }
    }
    def Material "Paint" {
        token outputs:surface.connect = </Looks/Paint/S.outputs:surface>
        color3f inputs:tint = (0.25, 0.5, 0.75)
        def Shader "S" {
            uniform token info:id = "UsdPreviewSurface"
            color3f inputs:diffuseColor.connect = </Looks/Paint.inputs:tint>
            float inputs:roughness = 0.125
            float inputs:metallic = 0.5
            token outputs:surface
        }
    }
}
def Mesh "Bound" (prepend apiSchemas = ["MaterialBindingAPI"]) {
    rel material:binding = </Looks/Paint>
    int[] faceVertexCounts = [4, 3]
    int[] faceVertexIndices = [0, 1, 2, 3, 1, 4, 2]
    point3f[] points = [(0, 0, 0), (1, 0, 0), (1, 1, 0.5), (0, 1, 0), (2, 0, 1)]
    normal3f[] normals = [(0, 0, 2), (0, 1, 1), (0, 0, 1), (1, 0, 1), (0, 0, 1)] (interpolation = "vertex")
    uniform token subdivisionScheme = "none"
}
def Mesh "Parts" (prepend apiSchemas = ["MaterialBindingAPI"]) {
    rel material:binding = </Looks/Paint>
    int[] faceVertexCounts = [4, 3]
    int[] faceVertexIndices = [0, 1, 2, 3, 1, 4, 2]
    point3f[] points = [(0, 0, 0), (1, 0, 0), (1, 1, 0.5), (0, 1, 0), (2, 0, 1)]
    uniform token subdivisionScheme = "none"
    def GeomSubset "Some" (prepend apiSchemas = ["MaterialBindingAPI"]) {
        uniform token elementType = "face"
        uniform token familyName = "materialBind"
        int[] indices = [1]
        rel material:binding = </Looks/Other>
    }
}
def Mesh "Free" {
    int[] faceVertexCounts = [4, 3]
    int[] faceVertexIndices = [0, 1, 2, 3, 1, 4, 2]
    point3f[] points = [(0, 0, 0), (1, 0, 0), (1, 1, 0.5), (0, 1, 0), (2, 0, 1)]
    color3f[] primvars:displayColor = [(1, 0, 0), (0, 0.5, 1)] (interpolation = "uniform")
    float[] primvars:displayOpacity = [0.1, 0.2, 0.3, 0.4, 0.5] (interpolation = "vertex")
    uniform token subdivisionScheme = "none"
}
def SphereLight "Key" {
    float inputs:diffuse = 0.25
    float inputs:specular = 3
    bool collection:lightLink:includeRoot = 0
    rel collection:lightLink:includes = </Bound>
    rel collection:shadowLink:excludes = </Free>
}
"""


def test_every_kind_of_look(tmp_path):
    path = tmp_path / "looks.usda"
    path.write_text(STAGE)
    found = judge(path)
    assert not found, "\n".join(found)
    # What is compared can differ.
    described = read(path)["values"]
    assert described["render"]["window"] == [0.25, 0.5, 0.75, 1.0]
    assert [product["camera"] for product in described["render"]["products"]] == ["/Cam", "/Other"]
    stage = Stage(path)
    paint = usd_looks.preview_surface(stage, stage.stage.GetPrimAtPath("/Looks/Paint"))
    kind, tint = usd_looks.value_or_texture(stage, paint, "diffuseColor", (0.18,) * 3)
    parts = next(i for i in described["instances"] if i["place"] == "/Parts")
    assert described["meshes"][parts["mesh"]]["material_slots"] == [0, 0, 1]
    assert (kind, tint.tolist()) == ("value", [0.25, 0.5, 0.75])


SHADES = """#usda 1.0
def Material "Metal" {
    token outputs:surface.connect = </Metal/S.outputs:surface>
    token inputs:wrap = "mirror"
    def Shader "S" {
        uniform token info:id = "UsdPreviewSurface"
        float inputs:ior = 1.75
        float inputs:clearcoat = 0.5
        float inputs:clearcoatRoughness = 0.25
        float inputs:opacity.connect = </Metal/Map.outputs:a>
        float inputs:opacityThreshold = 0.125
        float inputs:occlusion.connect = </Metal/Map.outputs:r>
        color3f inputs:diffuseColor.connect = </Metal/Map.outputs:rgb>
        float inputs:roughness.connect = </Metal/Scaled.outputs:g>
        normal3f inputs:normal.connect = </Metal/Bump.outputs:rgb>
        token outputs:surface
    }
    def Shader "Map" {
        uniform token info:id = "UsdUVTexture"
        asset inputs:file = @./map.png@
        token inputs:wrapS = "clamp"
        token inputs:wrapT.connect = </Metal.inputs:wrap>
        token inputs:sourceColorSpace = "raw"
        float2 inputs:st.connect = </Metal/Turn.outputs:result>
        float3 outputs:rgb
        float outputs:r
        float outputs:a
    }
    def Shader "Scaled" {
        uniform token info:id = "UsdUVTexture"
        asset inputs:file = @./map.png@
        token inputs:wrapS = "black"
        token inputs:wrapT = "repeat"
        token inputs:sourceColorSpace = "sRGB"
        float4 inputs:scale = (0.5, 0.25, 1, 1)
        float4 inputs:bias = (0, 0.5, 0, 0)
        float2 inputs:st.connect = </Metal/Read.outputs:result>
        float outputs:g
    }
    def Shader "Bump" {
        uniform token info:id = "UsdUVTexture"
        asset inputs:file = @./map.png@
        token inputs:sourceColorSpace = "raw"
        float4 inputs:scale = (1.5, 1.5, 2, 1)
        float4 inputs:bias = (-0.75, -0.75, -1, 0)
        float2 inputs:st.connect = </Metal/Read.outputs:result>
        float3 outputs:rgb
    }
    def Shader "Turn" {
        uniform token info:id = "UsdTransform2d"
        float2 inputs:in.connect = </Metal/Read.outputs:result>
        float inputs:rotation = 30
        float2 inputs:scale = (2, 3)
        float2 inputs:translation = (0.25, 0.75)
        float2 outputs:result
    }
    def Shader "Read" {
        uniform token info:id = "UsdPrimvarReader_float2"
        string inputs:varname = "st"
        float2 outputs:result
    }
}
def Material "Specular" {
    token outputs:surface.connect = </Specular/S.outputs:surface>
    def Shader "S" {
        uniform token info:id = "UsdPreviewSurface"
        int inputs:useSpecularWorkflow = 1
        color3f inputs:specularColor = (0.25, 0.02, 0.5)
        float inputs:metallic = 1
        float inputs:opacity = 0.625
        token outputs:surface
    }
}
def Material "Faded" {
    token outputs:surface.connect = </Faded/S.outputs:surface>
    def Shader "S" {
        uniform token info:id = "UsdPreviewSurface"
        float inputs:opacity = 0.375
        token inputs:opacityMode = "presence"
        color3f inputs:emissiveColor = (1, 2, 3)
        float inputs:metallic = 0.75
        token outputs:surface
    }
}
def Xform "Shown" {
    def Mesh "A" (prepend apiSchemas = ["MaterialBindingAPI"]) {
        rel material:binding = </Metal>
        MESH
    }
    def Mesh "B" (prepend apiSchemas = ["MaterialBindingAPI"]) {
        rel material:binding = </Specular>
        MESH
    }
    def Mesh "C" (prepend apiSchemas = ["MaterialBindingAPI"]) {
        rel material:binding = </Faded>
        MESH
    }
}
""".replace(
    "MESH",
    """int[] faceVertexCounts = [3]
        int[] faceVertexIndices = [0, 1, 2]
        point3f[] points = [(0, 0, 0), (1, 0, 0), (1, 1, 0)]
        texCoord2f[] primvars:st = [(0, 0), (1, 0), (1, 1)] (interpolation = "vertex")
        uniform token subdivisionScheme = "none\"""",
)

# Each of these is another look.
CHANGES = [
    ("ior = 1.75", "ior = 1.5"),
    ("clearcoat = 0.5", "clearcoat = 0.25"),
    ("clearcoatRoughness = 0.25", "clearcoatRoughness = 0.5"),
    ("opacityThreshold = 0.125", "opacityThreshold = 0.5"),
    ("float inputs:occlusion.connect = </Metal/Map.outputs:r>", ""),
    ("occlusion.connect = </Metal/Map.outputs:r>", "occlusion.connect = </Metal/Map.outputs:a>"),
    ("diffuseColor.connect = </Metal/Map.outputs:rgb>", "diffuseColor = (1, 0, 0)"),
    ("normal3f inputs:normal.connect = </Metal/Bump.outputs:rgb>", ""),
    ("bias = (-0.75, -0.75, -1, 0)", "bias = (-0.75, -0.5, -1, 0)"),
    ("bias = (0, 0.5, 0, 0)", "bias = (0, 0.25, 0, 0)"),
    ("scale = (0.5, 0.25, 1, 1)", "scale = (0.5, 0.5, 1, 1)"),
    ('wrapS = "clamp"', 'wrapS = "repeat"'),
    ('inputs:wrap = "mirror"', 'inputs:wrap = "black"'),
    ('wrapS = "black"', 'wrapS = "clamp"'),
    ('"sRGB"', '"raw"'),
    ("rotation = 30", "rotation = 31"),
    ("scale = (2, 3)", "scale = (2, 2)"),
    ("translation = (0.25, 0.75)", "translation = (0.25, 0.5)"),
    ("specularColor = (0.25, 0.02, 0.5)", "specularColor = (0.25, 0.02, 0.25)"),
    ("useSpecularWorkflow = 1", "useSpecularWorkflow = 0"),
    ("opacity = 0.625", "opacity = 0.5"),
    ("opacity = 0.625", "opacity = 1"),
    ("opacity = 0.375", "opacity = 0.5"),
    ('"presence"', '"transparent"'),
    ("emissiveColor = (1, 2, 3)", "emissiveColor = (1, 2, 4)"),
    ("metallic = 0.75", "metallic = 0.5"),
]


@pytest.fixture(scope="module")
def shades(tmp_path_factory):
    """The stage of `SHADES`, and what Penumbra says of it."""
    folder = tmp_path_factory.mktemp("shades")
    chunk = lambda kind, data: struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    head, line = struct.pack(">IIBBBBB", 1, 1, 8, 6, 0, 0, 0), bytes([0, 51, 102, 153, 204])
    png = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(line)) + chunk(b"IEND", b"")
    (folder / "map.png").write_bytes(png)
    (folder / "shades.usda").write_text(SHADES)
    return folder, read(folder / "shades.usda")


def test_every_input_of_usd_preview_surface(shades):
    folder, info = shades
    assert not info["warnings"]
    found = judge(folder / "shades.usda", info)
    assert not found, "\n".join(found)


@pytest.mark.parametrize("change", CHANGES, ids=lambda change: change[0])
def test_another_input_of_usd_preview_surface_is_a_difference(shades, change):
    folder, info = shades
    assert change[0] in SHADES
    (folder / "changed.usda").write_text(SHADES.replace(*change, 1))
    assert judge(folder / "changed.usda", info)
