"""Inputs of UsdPreviewSurface: what OpenUSD says that they are, fallbacks by its registry of shaders, and what
Penumbra's materials are at the same place with the same texels."""

import ast
import os
import re
from collections import namedtuple

import numpy as np
from pxr import Sdf, Sdr, UsdShade

# What every image holds, and where it is asked for in st.
TEXEL = np.array([0.2, 0.45, 0.7, 0.6])
PLACE = np.array([0.3, 0.8])
WRAPS = {"repeat": "repeat", "mirror": "mirror", "clamp": "clamp", "black": "black", "useMetadata": "black"}
SPACES = {"raw": "linear", "sRGB": "srgb"}

# An image as it is looked up: its name, where (v from the top), how it goes on, its decoding.
Picture = namedtuple("Picture", "file at wrap space")


class Unknown(Exception):
    """A value that is not compared here."""


def fallback(node, name):
    return Sdr.Registry().GetShaderNodeByIdentifier(node).GetShaderInput(name).GetDefaultValue()


def texel(path):
    """What the image holds: without a channel for it, alpha is 1."""
    if path.lower().endswith((".jpg", ".jpeg")):
        return np.append(TEXEL[:3], 1)
    if path.lower().endswith(".png"):
        with open(path, "rb") as file:
            head = file.read(26)
        return np.append(TEXEL[:3], 1) if head[25] in (0, 2) else TEXEL
    return TEXEL


def numbers(value):
    return np.atleast_1d(np.array(value, dtype=float))


class Wanted:
    """The inputs of `shader` by OpenUSD."""

    def __init__(self, stage, shader):
        self.stage, self.shader = stage, shader

    def producer(self, shader, name):
        attribute = shader.GetInput(name)
        found = attribute.GetValueProducingAttributes() if attribute else []
        return found[0] if found else None

    def constant(self, shader, name, node=None):
        """A value that no node makes; the fallback of the node where there is none."""
        producer = self.producer(shader, name)
        if producer is None:
            return fallback(node or shader.GetIdAttr().Get(), name)
        if not producer.GetName().startswith("inputs:"):
            raise Unknown(f"{name} is made by a node")
        value = producer.Get(self.stage.time)
        return fallback(node or shader.GetIdAttr().Get(), name) if value is None else value

    def input(self, name):
        """The numbers of an input at `PLACE` where images hold `TEXEL`, and the image that it is made of, if any."""
        producer = self.producer(self.shader, name)
        if producer is None or producer.GetName().startswith("inputs:"):
            return numbers(self.constant(self.shader, name)), None
        texture = UsdShade.Shader(producer.GetPrim())
        if texture.GetIdAttr().Get() != "UsdUVTexture":
            raise Unknown(f"{name} is made by {texture.GetIdAttr().Get()}")
        places = {"rgb": [0, 1, 2], "rgba": [0, 1, 2, 3], "r": [0], "g": [1], "b": [2], "a": [3]}
        places = places[producer.GetName().removeprefix("outputs:")]
        path = self.constant(texture, "file")
        if not isinstance(path, Sdf.AssetPath) or "<UDIM>" in path.path:
            raise Unknown("tiles")
        if not path.resolvedPath or not os.path.isfile(path.resolvedPath.split("[")[0]):
            return numbers(self.constant(texture, "fallback"))[places], None
        scale, bias = (numbers(self.constant(texture, key)) for key in ("scale", "bias"))
        at = self.coordinates(texture, "st")
        wrap = [WRAPS[self.constant(texture, key)] for key in ("wrapS", "wrapT")]
        space = SPACES.get(self.constant(texture, "sourceColorSpace"))
        picture = Picture(os.path.basename(path.path), [at[0], 1 - at[1]], wrap, space)
        return (scale * texel(path.resolvedPath) + bias)[places], picture

    def coordinates(self, shader, name, depth=0):
        """Where an input of coordinates is; which primvar they are of is seen at meshes."""
        producer = self.producer(shader, name)
        if producer is None or producer.GetName().startswith("inputs:") or depth > 8:
            raise Unknown("coordinates without primvar")
        node = UsdShade.Shader(producer.GetPrim())
        if node.GetIdAttr().Get() == "UsdPrimvarReader_float2":
            return PLACE
        if node.GetIdAttr().Get() != "UsdTransform2d":
            raise Unknown("coordinates by another node")
        at = self.coordinates(node, "in", depth + 1)
        turn = np.radians(float(self.constant(node, "rotation")))
        x, y = at * numbers(self.constant(node, "scale"))
        turned = np.array([np.cos(turn) * x - np.sin(turn) * y, np.sin(turn) * x + np.cos(turn) * y])
        return turned + numbers(self.constant(node, "translation"))


class Ours:
    """A material as Penumbra describes it, at `PLACE` of every UV set and where images hold `TEXEL`."""

    def __init__(self, material):
        self.material = material
        self.pictures = []

    def value(self, described, width):
        """The numbers of an input; the images that it is made of are kept."""
        value = numbers(described["factor"])
        texture = described["texture"]
        if texture:
            uv = np.array([PLACE[0], 1 - PLACE[1], 1.0])
            self.keep(texture, np.array(texture["transform"]) @ uv)
            channel = texture.get("channel")
            value = value * (TEXEL["rgba".index(channel)] if channel else TEXEL[:3])
        if described["graph"] is not None:
            value = value * self.graph(described["graph"])[: len(value)]
        return np.broadcast_to(value, (width,)) if len(value) == 1 else value[:width]

    def keep(self, texture, at):
        image = os.path.basename(texture["image"].rstrip("]").replace("[", "/"))
        self.pictures.append(Picture(image, list(at), texture["wrap"], texture["space"]))

    def graph(self, index):
        """A value of the graph, four numbers."""
        op = self.material["graph"][index]
        kind, args = op["op"], op.get("args", [])
        if kind == "constant":
            return np.array(op["value"])
        if kind == "leaf" and re.fullmatch(r"Uv\(\d+\)", op["what"]):
            return np.array([PLACE[0], 1 - PLACE[1], 0, 1])
        if kind == "image":
            self.keep(op["texture"], self.graph(args[0])[:2])
            return TEXEL
        if kind != "apply":
            raise Unknown(op["what"])
        return self.function(op["what"], [self.graph(arg) for arg in args])

    @staticmethod
    def function(what, args):
        name, _, rest = what.partition("(")
        if name == "Math":
            make = {
                "Add": lambda a, b: a + b,
                "Subtract": lambda a, b: a - b,
                "Multiply": lambda a, b: a * b,
                "Divide": lambda a, b: np.divide(a, b, out=np.zeros(4), where=b != 0),
                "MultiplyAdd": lambda a, b, c: a * b + c,
                "Clamp": lambda a, low, high: np.clip(a, low, high),
                "Maximum": np.maximum,
            }.get(rest.rstrip(")"))
            if make:
                return make(*args)
        if name == "Swizzle":
            return args[0][ast.literal_eval(rest[:-1])]
        if name == "Affine":
            rows = np.array(ast.literal_eval(rest[:-1]))
            return np.append(rows @ np.append(args[0][:3], 1), args[0][3])
        if name == "NormalMap":
            # In tangent space.
            return 2 * args[0] - 1
        raise Unknown(what)


def judge(stage, shader, material, near, check):
    """Tells `check(same, what)` of every input of the UsdPreviewSurface `shader`."""
    wanted = Wanted(stage, shader)

    def compare(name, described, width, change=lambda value: value, path=()):
        """Our input against `name` of OpenUSD, of which ours is `change`."""
        try:
            expected, picture = wanted.input(name)
            ours = Ours(material)
            value = ours.value(described, width)
        except Unknown:
            return
        check(near(value, change(expected)[:width]), f"{name} is {value}, not {change(expected)[:width]}")
        judge_pictures(name, ours.pictures, picture)

    def judge_pictures(name, ours, picture):
        found = [one for one in ours if picture and one.file == picture.file]
        if picture is None:
            return
        # Alpha of a picture that has none is no lookup.
        if not ours and name == "opacity":
            return
        check(bool(found), f"{name} is of {[one.file for one in ours]}, not of {picture.file}")
        for one in found[:1]:
            check(near(one.at, picture.at, 1e-5), f"{name} is looked up at {one.at}, not {picture.at}")
            check(one.wrap == picture.wrap, f"{name} goes on as {one.wrap}, not {picture.wrap}")
            same = picture.space in (None, one.space)
            check(same, f"{name} is decoded as {one.space}, not {picture.space}")

    try:
        specular = int(wanted.constant(shader, "useSpecularWorkflow")) != 0
        threshold = float(wanted.constant(shader, "opacityThreshold"))
        # Interfaces alone are allowed here, so that there is always a value.
        mode = "presence" if stage.blender else "transparent"
        mode = wanted.constant(shader, "opacityMode") if wanted.producer(shader, "opacityMode") else mode
    except Unknown:
        return
    plain = lambda value: value
    clear, opacity = threshold <= 0 and mode == "transparent", None
    try:
        opacity = np.clip(wanted.input("opacity")[0][0], 0, 1)
        metallic = 0.0 if specular else wanted.input("metallic")[0][0]
    except Unknown:
        clear = None
    if clear is not None:
        fades = clear and metallic == 0.0
        compare("diffuseColor", material["base_color"], 3, (lambda value: value * opacity) if fades else plain)
    passes = material["transparency"]["factor"] != [0, 0, 0]
    if clear:
        alone = material["alpha"] == {"factor": 1.0, "texture": None, "graph": None}
        check(alone and material["alpha_mode"] == "opaque", f"alpha is {material['alpha']}, beside what passes")
        # An image without alpha is opaque, which is not known here.
        check(passes or opacity == 1 or wanted.input("opacity")[1], f"nothing passes at an opacity of {opacity}")
        check(not passes or opacity != 1, "light passes what is opaque")
    elif clear is False:
        compare("opacity", material["alpha"], 1)
        check(not passes, "light passes beside its alpha")
    if threshold > 0:
        cutoff = material["alpha_mode"]["mask"] if isinstance(material["alpha_mode"], dict) else None
        check(cutoff is not None and near(cutoff, threshold), f"the threshold is {cutoff}, not {threshold}")
    else:
        check(not isinstance(material["alpha_mode"], dict), f"has the threshold {material['alpha_mode']}, not 0")
    if specular:
        # The color is F0, which at the index 1.5 is 0.04 of ours.
        compare("specularColor", material["specular_color"], 3, lambda value: value / 0.04)
        check(near(material["ior"]["factor"], 1.5), f"ior is {material['ior']}, in the specular workflow")
        check(material["metallic"]["factor"] == 0, "is metal in the specular workflow")
    else:
        compare("metallic", material["metallic"], 1)
        compare("ior", material["ior"], 1)
        check(material["specular_color"]["factor"] == [1, 1, 1], "its reflection is tinted in the metallic workflow")
    compare("roughness", material["roughness"], 1)
    compare("emissiveColor", material["emission"], 3)
    judge_coat(wanted, material["coat"], compare, check)
    judge_occlusion(wanted, material["occlusion"], compare, check)
    judge_normal(wanted, material, near, check, judge_pictures)


def judge_coat(wanted, coat, compare, check):
    try:
        weight, picture = wanted.input("clearcoat")
    except Unknown:
        return
    if weight[0] == 0 and not picture:
        check(coat is None, "has a coat")
    elif coat is None:
        check(False, "has no coat")
    else:
        compare("clearcoat", coat["weight"], 1)
        compare("clearcoatRoughness", coat["roughness"], 1)
        compare("ior", coat["ior"], 1)


def judge_occlusion(wanted, occlusion, compare, check):
    try:
        _, picture = wanted.input("occlusion")
    except Unknown:
        return
    # What is the same everywhere says nothing of where light comes.
    check((occlusion is None) == (picture is None), f"occlusion is {occlusion}, not of {picture}")
    if occlusion and picture:
        compare("occlusion", occlusion, 1)


def judge_normal(wanted, material, near, check, judge_pictures):
    described = material["normal"]
    try:
        expected, picture = wanted.input("normal")
        if picture is None:
            flat = near(expected[:2], [0, 0])
            check(not flat or described is None, f"has the normals {described}")
            return
        ours = Ours(material)
        check(described is not None, "has no normals")
        if described is None:
            return
        if described["graph"] is not None:
            value = ours.graph(described["graph"])[:3]
        else:
            value = 2 * ours.value({**described, "factor": 1.0}, 3) - 1
            value[:2] *= described["scale"]
    except Unknown:
        return
    check(near(value, expected[:3]), f"its normal is {value}, not {expected[:3]}")
    judge_pictures("normal", ours.pictures, picture)
