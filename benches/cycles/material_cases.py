"""Which materials are held to those of Cycles: shader nodes with their inputs."""

PRINCIPLED = "ShaderNodeBsdfPrincipled"


class Case:
    """A node type, its properties (lower case) and its inputs, by their names with _ for a blank.

    `links` are of inputs that other nodes are linked to: by the input's name a case for the node, and its output.
    """

    def __init__(self, name, node=PRINCIPLED, properties=None, links=None, **inputs):
        self.name, self.node, self.properties, self.inputs = name, node, properties or {}, inputs
        self.links = links or {}


def gray(value):
    return (value, value, value, 1.0)


WHITE, BLACK = gray(1.0), gray(0.0)
MULTI, SINGLE = {"distribution": "MULTI_GGX"}, {"distribution": "GGX"}
GOLD = {"IOR": (0.183, 0.422, 1.373), "Extinction": (3.424, 2.346, 1.770)}


def _lobes():
    for roughness in (0.0, 0.5, 1.0):
        yield Case(f"Diffuse .8, roughness {roughness}", "ShaderNodeBsdfDiffuse", Color=gray(0.8), Roughness=roughness)
    yield Case("Diffuse 1, roughness 1", "ShaderNodeBsdfDiffuse", Color=WHITE, Roughness=1.0)
    yield Case("Translucent .8", "ShaderNodeBsdfTranslucent", Color=gray(0.8))
    yield Case("Transparent .8", "ShaderNodeBsdfTransparent", Color=gray(0.8))
    for kind, properties in (("one bounce", SINGLE), ("all bounces", MULTI)):
        for roughness in (0.0, 0.25, 0.5, 1.0):
            yield Case(f"Glossy .8, {kind}, roughness {roughness}", "ShaderNodeBsdfAnisotropic", properties,
                       Color=gray(0.8), Roughness=roughness)
    for anisotropy in (0.5, -0.5, 0.9):
        yield Case(f"Glossy 1, roughness .5, anisotropy {anisotropy}", "ShaderNodeBsdfAnisotropic", SINGLE,
                   Color=WHITE, Roughness=0.5, Anisotropy=anisotropy)
    for kind, properties in (("one bounce", SINGLE), ("all bounces", MULTI)):
        for roughness in (0.0, 0.25, 0.5, 1.0):
            yield Case(f"Glass 1, {kind}, roughness {roughness}", "ShaderNodeBsdfGlass", properties, Color=WHITE,
                       Roughness=roughness, IOR=1.5)
    for ior in (0.7, 1.0, 1.1, 2.4):
        yield Case(f"Glass 1, IOR {ior}, roughness .3", "ShaderNodeBsdfGlass", MULTI, Color=WHITE, Roughness=0.3, IOR=ior)
    for ior in (1.5, 1.0 / 1.5):
        for roughness in (0.25, 0.5, 1.0):
            yield Case(f"Glass .25, IOR {ior:.2f}, roughness {roughness}", "ShaderNodeBsdfGlass", MULTI, Color=gray(0.25),
                       Roughness=roughness, IOR=ior)
    for thickness in (150.0, 400.0, 900.0):
        yield Case(f"Glass 1, roughness 0, film {thickness:.0f} nm", "ShaderNodeBsdfGlass", MULTI, Color=WHITE,
                   Roughness=0.0, IOR=1.5, Thin_Film_Thickness=thickness, Thin_Film_IOR=1.8)
    for roughness in (0.0, 0.25, 0.5, 1.0):
        yield Case(f"Refraction 1, roughness {roughness}", "ShaderNodeBsdfRefraction", SINGLE, Color=WHITE,
                   Roughness=roughness, IOR=1.5)
    for roughness in (0.1, 0.3, 0.5, 1.0):
        yield Case(f"Sheen 1, roughness {roughness}", "ShaderNodeBsdfSheen", {"distribution": "MICROFIBER"}, Color=WHITE,
                   Roughness=roughness)
    for roughness in (0.0, 0.3, 1.0):
        yield Case(f"Gold by its index, roughness {roughness}", "ShaderNodeBsdfMetallic",
                   {**MULTI, "fresnel_type": "PHYSICAL_CONDUCTOR"}, Roughness=roughness, **GOLD)
        yield Case(f"Metal by two colours, roughness {roughness}", "ShaderNodeBsdfMetallic",
                   {**MULTI, "fresnel_type": "F82"}, Base_Color=(0.9, 0.6, 0.3, 1.0), Edge_Tint=(0.7, 0.8, 1.0, 1.0),
                   Roughness=roughness)
    for component in ("DIFFUSE", "GLOSSY"):
        yield Case(f"Toon, {component.lower()}", "ShaderNodeBsdfToon", {"component": component}, Color=WHITE, Size=0.5,
                   Smooth=0.2)


def _principled():
    for metallic in (0.0, 0.5, 1.0):
        for roughness in (0.0, 0.1, 0.25, 0.5, 0.75, 1.0):
            yield Case(f"metallic {metallic}, roughness {roughness}", Base_Color=WHITE, Metallic=metallic,
                       Roughness=roughness)
    for roughness in (0.0, 0.25, 0.5, 1.0):
        yield Case(f"black, roughness {roughness}", Base_Color=BLACK, Roughness=roughness)
        yield Case(f"one bounce, roughness {roughness}", PRINCIPLED, SINGLE, Base_Color=WHITE, Metallic=1.0,
                   Roughness=roughness)
    for transmission in (0.5, 1.0):
        for roughness in (0.0, 0.25, 0.5, 1.0):
            yield Case(f"transmission {transmission}, roughness {roughness}", Base_Color=WHITE,
                       Transmission_Weight=transmission, Roughness=roughness)
    for roughness in (0.25, 0.5, 1.0):
        yield Case(f"one bounce, base .8, roughness {roughness}", PRINCIPLED, SINGLE, Base_Color=gray(0.8),
                   Roughness=roughness)
        yield Case(f"transmission 1, base .25, roughness {roughness}", Base_Color=gray(0.25), Transmission_Weight=1.0,
                   Roughness=roughness)
        yield Case(f"film 300 nm, base .8, roughness {roughness}", Base_Color=gray(0.8), Roughness=roughness,
                   Thin_Film_Thickness=300.0)
    yield Case("IOR 0.7, base .5, roughness .5", Base_Color=gray(0.5), Roughness=0.5, IOR=0.7)
    yield Case("transmission 1, base .25", Base_Color=gray(0.25), Transmission_Weight=1.0, Roughness=0.0)
    for ior in (1.0, 1.1, 1.33, 2.0, 3.0):
        yield Case(f"IOR {ior}, black, roughness 0", Base_Color=BLACK, Roughness=0.0, IOR=ior)
        yield Case(f"IOR {ior}, roughness .5", Base_Color=gray(0.5), Roughness=0.5, IOR=ior)
    for level in (0.0, 0.25, 1.0):
        yield Case(f"Specular IOR Level {level}", Base_Color=gray(0.5), Roughness=0.3, Specular_IOR_Level=level)
    yield Case("Specular Tint", Base_Color=gray(0.5), Roughness=0.3, Specular_Tint=(1.0, 0.5, 0.1, 1.0))
    yield Case("Specular Tint of metal", Base_Color=gray(0.5), Metallic=1.0, Roughness=0.0, Specular_Tint=gray(0.5))
    for roughness in (0.5, 1.0):
        yield Case(f"Diffuse Roughness {roughness}", Base_Color=gray(0.8), Diffuse_Roughness=roughness)
    for anisotropic in (0.3, 0.8):
        yield Case(f"Anisotropic {anisotropic}, metal", Base_Color=WHITE, Metallic=1.0, Roughness=0.5,
                   Anisotropic=anisotropic)
    # Squares are tilted towards x.
    tilt = {"Tangent": (Case("tilt", "ShaderNodeCombineXYZ", X=1.0), "Vector")}
    for anisotropic in (0.5, 0.9):
        for which, rotation in (("along", 0.0), ("across", 0.25)):
            yield Case(f"Anisotropic {anisotropic}, metal, stretched {which}", links=tilt, Base_Color=WHITE, Metallic=1.0,
                       Roughness=0.5, Anisotropic=anisotropic, Anisotropic_Rotation=rotation)
    for roughness in (0.0, 0.03, 0.5, 1.0):
        yield Case(f"coat, roughness {roughness}", Base_Color=WHITE, Coat_Weight=1.0, Coat_Roughness=roughness)
        yield Case(f"coat on black, roughness {roughness}", Base_Color=BLACK, Specular_IOR_Level=0.0, Coat_Weight=1.0,
                   Coat_Roughness=roughness)
    for ior in (1.2, 2.0):
        yield Case(f"coat of IOR {ior}", Base_Color=WHITE, Coat_Weight=0.5, Coat_IOR=ior)
    yield Case("coat of tint .5", Base_Color=WHITE, Specular_IOR_Level=0.0, Coat_Weight=1.0, Coat_Tint=gray(0.5))
    for roughness in (0.1, 0.25, 0.5, 1.0):
        yield Case(f"sheen, roughness {roughness}", Base_Color=gray(0.5), Sheen_Weight=1.0, Sheen_Roughness=roughness)
    yield Case("sheen .5 of tint", Base_Color=gray(0.5), Sheen_Weight=0.5, Sheen_Tint=(0.2, 0.5, 0.9, 1.0))
    for thickness in (100.0, 300.0, 600.0):
        yield Case(f"film {thickness:.0f} nm on a dielectric", Base_Color=BLACK, Roughness=0.0, Thin_Film_Thickness=thickness)
        yield Case(f"film {thickness:.0f} nm on metal", Base_Color=gray(0.7), Metallic=1.0, Roughness=0.2,
                   Thin_Film_Thickness=thickness, Thin_Film_IOR=1.6)
    emits = {"Base_Color": BLACK, "Specular_IOR_Level": 0.0, "Emission_Strength": 0.5}
    for roughness in (0.0, 0.5, 1.0):
        yield Case(f"emission .5 below a coat, roughness {roughness}", **emits, Coat_Weight=1.0, Coat_Roughness=roughness)
        yield Case(f"emission .5 below sheen, roughness {max(roughness, 0.2)}", **emits, Sheen_Weight=1.0,
                   Sheen_Roughness=max(roughness, 0.2))
    yield Case("emission .5 below a coat of tint .5", **emits, Coat_Weight=0.7, Coat_Tint=gray(0.5))
    yield Case("emission .5 below both", **emits, Coat_Weight=0.7, Coat_Roughness=0.4, Sheen_Weight=0.6,
               Sheen_Tint=(0.2, 0.5, 0.9, 1.0))
    yield Case("alpha .5", Base_Color=gray(0.5), Alpha=0.5)
    yield Case("all layers", Base_Color=(0.8, 0.4, 0.2, 1.0), Metallic=0.3, Roughness=0.4, Transmission_Weight=0.4,
               Coat_Weight=0.5, Sheen_Weight=0.4, Anisotropic=0.5, Specular_Tint=(1.0, 0.8, 0.6, 1.0))


def furnace():
    """Sections of the table of the white furnace: title and cases."""
    return [("Single shaders", list(_lobes())), ("Principled BSDF", list(_principled()))]


_SATIN = {"Base_Color": (0.7, 0.3, 0.15, 1.0), "Roughness": 0.35}
_STEPS = (0.0, 0.25, 0.5, 0.75, 1.0)


def rows():
    """Rows of spheres: the parameter that grows along each, and the spheres."""
    def row(name, values, properties=None, **others):
        cases = [Case(f"{name} {value:g}", properties=properties, **{**_SATIN, **others, name.replace(" ", "_"): value})
                 for value in values]
        return name, cases

    def tints(name, **others):
        cases = [Case(f"{name} {value:g}", **{**_SATIN, **others, name.replace(" ", "_"): (1.0, value, value**2, 1.0)})
                 for value in _STEPS]
        return name, cases

    def bent(name, **others):
        """A normal map, tilted all over, by its strength."""
        def case(value):
            tilted = Case("tilted", "ShaderNodeNormalMap", Color=(0.8, 0.4, 0.85, 1.0), Strength=value)
            return Case(f"{name} {value:g}", links={name.replace(" ", "_"): (tilted, "Normal")}, **_SATIN, **others)
        return name, [case(value) for value in _STEPS]

    def tangents(name, **others):
        """Along circles around each axis, along the texture coordinates, along the geometry's own."""
        around = [(axis, Case(axis, "ShaderNodeTangent", {"direction_type": "RADIAL", "axis": axis})) for axis in "XYZ"]
        nodes = [*around, ("UV", Case("UV", "ShaderNodeTangent", {"direction_type": "UV_MAP"})),
                 ("Geometry", Case("Geometry", "ShaderNodeNewGeometry"))]
        return name, [Case(f"{name} {value}", links={name: (node, "Tangent")}, **_SATIN, **others) for value, node in nodes]

    def radii(name, **others):
        cases = [Case(f"{name} {value:g}", **{**_SATIN, **others, name.replace(" ", "_"): (1.0, value, value**2)})
                 for value in _STEPS]
        return name, cases

    def rename(name, named):
        return name, named[1]

    coated, glows = {"Coat_Weight": 1.0}, {"Emission_Color": (0.9, 0.6, 0.3, 1.0), "Emission_Strength": 0.5}
    skin = {"properties": {"subsurface_method": "RANDOM_WALK_SKIN"}, "Subsurface_Weight": 1.0, "Subsurface_Scale": 0.2}
    return [
        tints("Base Color"),
        row("Roughness", _STEPS),
        row("Metallic", _STEPS),
        row("IOR", (1.0, 1.2, 1.5, 2.0, 3.0)),
        row("Specular IOR Level", _STEPS),
        tints("Specular Tint"),
        row("Diffuse Roughness", _STEPS),
        row("Subsurface Weight", _STEPS, Subsurface_Scale=0.2),
        row("Subsurface Anisotropy", (0.0, 0.2, 0.4, 0.6, 0.8), Subsurface_Weight=1.0, Subsurface_Scale=0.2),
        row("Subsurface Scale", (0.01, 0.05, 0.2, 0.5, 1.0), Subsurface_Weight=1.0),
        radii("Subsurface Radius", Subsurface_Weight=1.0, Subsurface_Scale=0.2),
        rename("Subsurface Weight of skin", row("Subsurface Weight", _STEPS, **skin)),
        rename("Subsurface IOR of skin", row("Subsurface IOR", (1.01, 1.2, 1.4, 2.0, 3.0), **skin)),
        row("Transmission Weight", _STEPS),
        rename("Roughness of glass", row("Roughness", _STEPS, Transmission_Weight=1.0, Base_Color=gray(0.8))),
        row("Coat Weight", _STEPS),
        row("Coat Roughness", _STEPS, **coated),
        row("Coat IOR", (1.0, 1.25, 1.5, 2.0, 3.0), **coated),
        tints("Coat Tint", **coated),
        row("Sheen Weight", _STEPS),
        row("Sheen Roughness", (0.1, 0.3, 0.5, 0.75, 1.0), Sheen_Weight=1.0),
        tints("Sheen Tint", Sheen_Weight=1.0),
        row("Anisotropic", _STEPS, Metallic=1.0),
        row("Anisotropic Rotation", _STEPS, Metallic=1.0, Anisotropic=0.8),
        tangents("Tangent", Metallic=1.0, Anisotropic=0.8),
        bent("Normal"),
        bent("Coat Normal", **coated, Coat_Roughness=0.2),
        row("Thin Film Thickness", (0.0, 150.0, 300.0, 500.0, 900.0), Metallic=1.0, Base_Color=gray(0.7)),
        rename("Roughness below a film", row("Roughness", _STEPS, Thin_Film_Thickness=400.0)),
        row("Thin Film IOR", (1.0, 1.2, 1.5, 2.0, 2.5), Metallic=1.0, Base_Color=gray(0.7), Thin_Film_Thickness=400.0),
        row("Alpha", _STEPS),
        row("Emission Strength", (0.0, 0.1, 0.3, 0.6, 1.0)),
        tints("Emission Color", Emission_Strength=0.5),
        rename("Emission below a coat, by its weight", row("Coat Weight", _STEPS, **glows, Coat_Roughness=0.3)),
        rename("Emission below sheen, by its weight", row("Sheen Weight", _STEPS, **glows)),
    ]
