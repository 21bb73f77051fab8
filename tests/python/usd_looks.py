"""What OpenUSD says of the looks of a stage: shading inputs, primvars of corners, links of lights, the settings of
the render."""

import os

import numpy as np
from pxr import Usd, UsdGeom, UsdLux, UsdRender, UsdShade

CONFORM = {
    "expandAperture": "expand",
    "cropAperture": "crop",
    "adjustApertureWidth": "width",
    "adjustApertureHeight": "height",
    "adjustPixelAspectRatio": "pixels",
}


def preview_surface(stage, material):
    """The UsdPreviewSurface that a material shows; `None` where it shows another."""
    material = UsdShade.Material(material)
    # ComputeSurfaceSource would give what has no context for one that is absent.
    output = material.GetSurfaceOutput("mtlx")
    if output and output.HasConnectedSource():
        return None
    shader = material.ComputeSurfaceSource("")[0]
    return shader if shader and shader.GetIdAttr().Get() == "UsdPreviewSurface" else None


def value_or_texture(stage, shader, name, fallback):
    """`("value", numbers)`, `("texture", file name, primvar)`, or `None` for what is neither alone."""
    attribute = shader.GetInput(name)
    found = attribute.GetValueProducingAttributes() if attribute else []
    if not found:
        return "value", np.atleast_1d(fallback)
    producer = found[0]
    if producer.GetName().startswith("inputs:"):
        value = producer.Get(stage.time)
        return ("value", np.atleast_1d(np.array(value, float))) if value is not None else ("value", np.atleast_1d(fallback))
    texture = UsdShade.Shader(producer.GetPrim())
    if texture.GetIdAttr().Get() != "UsdUVTexture" or any(texture.GetInput(n) for n in ("scale", "bias")):
        return None
    file, reader = texture.GetInput("file"), reader_of(texture)
    files = file.GetValueProducingAttributes() if file else []
    path = files[0].Get(stage.time) if files else None
    if path is None or reader is None or not os.path.isfile(path.resolvedPath):
        return None
    return "texture", os.path.basename(path.path), reader


def reader_of(texture):
    """The primvar that a texture is looked up by, past its transform."""
    attribute = texture.GetInput("st")
    for _ in range(8):
        found = attribute.GetValueProducingAttributes() if attribute else []
        if not found or not found[0].GetName().startswith("outputs:"):
            return None
        shader = UsdShade.Shader(found[0].GetPrim())
        if shader.GetIdAttr().Get() == "UsdTransform2d":
            attribute = shader.GetInput("in")
            continue
        name = shader.GetInput("varname")
        names = name.GetValueProducingAttributes() if name else []
        return str(names[0].Get()) if names else None
    return None


def corner_values(stage, prim, faces, interpolation, values):
    """One row for each corner of `faces`; `None` where there are too few values."""
    counts = UsdGeom.Mesh(prim).GetFaceVertexCountsAttr().Get(stage.time)
    starts = np.concatenate([[0], np.cumsum(counts)])
    pick = {
        "constant": lambda face, corners: np.zeros(len(corners), int),
        "uniform": lambda face, corners: np.full(len(corners), face),
        "vertex": lambda face, corners: corners,
        "varying": lambda face, corners: corners,
        "faceVarying": lambda face, corners: np.arange(starts[face], starts[face + 1]),
    }[interpolation]
    picked = np.concatenate([pick(face, corners) for face, corners in faces] or [np.zeros(0, int)])
    values = np.array(values, dtype=float).reshape(len(values), -1)
    return values[picked] if len(picked) == 0 or picked.max() < len(values) else None


def primvar_corners(stage, prim, faces, name):
    primvar = UsdGeom.PrimvarsAPI(prim).FindPrimvarWithInheritance(name)
    values = primvar.ComputeFlattened(stage.time) if primvar else None
    if values is None:
        return None
    return corner_values(stage, prim, faces, primvar.GetInterpolation(), values)


def normal_corners(stage, prim, faces):
    """Unit normals of the corners of a mesh that is not subdivided; `None` where some have no direction."""
    mesh = UsdGeom.Mesh(prim)
    if mesh.GetSubdivisionSchemeAttr().Get() != "none":
        return None
    found = primvar_corners(stage, prim, faces, "normals")
    if found is None:
        values = mesh.GetNormalsAttr().Get(stage.time)
        found = corner_values(stage, prim, faces, mesh.GetNormalsInterpolation(), values) if values else None
    if found is None or found.shape[1:] != (3,):
        return None
    lengths = np.linalg.norm(found, axis=1, keepdims=True)
    return found / lengths if (lengths > 1e-6).all() else None


def linked(prim, name, paths):
    """Which of `paths` a collection of a light has; `None` where it says nothing."""
    query = Usd.CollectionAPI(prim, name).ComputeMembershipQuery()
    return {path for path in paths if query.IsPathIncluded(path)} if query else None


def render(stage):
    """What the settings that the stage names say of the picture, or the first of their products."""
    settings, products = of_render(stage)
    return framing(settings, products[0] if products else None) if settings else None


def pictures(stage):
    """The same of each product, by the name of its picture."""
    settings, products = of_render(stage)
    return {product.GetAttribute("productName").Get(): framing(settings, product) for product in products}


def of_render(stage):
    """The settings that the stage names, `None` where there are none, and their products."""
    path = stage.stage.GetMetadata("renderSettingsPrimPath")
    settings = UsdRender.Settings.Get(stage.stage, path) if path else None
    if not settings:
        return None, []
    products = [stage.stage.GetPrimAtPath(target) for target in settings.GetProductsRel().GetForwardedTargets()]
    return settings, [prim for prim in products if prim and prim.IsA(UsdRender.Product)]


def framing(settings, product):
    """Camera, resolution, shape of pixels, policy and window of `product`, which may be `None`."""

    def get(name):
        authored = product and product.GetAttribute(name).HasAuthoredValue()
        return (product if authored else settings.GetPrim()).GetAttribute(name).Get()

    cameras = [prim.GetRelationship("camera").GetForwardedTargets() for prim in (product, settings.GetPrim()) if prim]
    camera = next((str(found[0]) for found in cameras if found), None)
    left, low, right, high = np.array(get("dataWindowNDC"), float)
    window = None if [left, low, right, high] == [0, 0, 1, 1] else [left, 1 - high, right, 1 - low]
    return {
        "camera": camera,
        "resolution": list(get("resolution")),
        "pixel_aspect": get("pixelAspectRatio"),
        "conform": CONFORM.get(get("aspectRatioConformPolicy"), "expand"),
        "window": window,
    }


def lights(stage):
    return [prim for prim in stage.prims() if prim.HasAPI(UsdLux.LightAPI) and stage.visible(prim)]
