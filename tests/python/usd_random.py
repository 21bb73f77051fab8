"""Random stages of several layers: sublayers, references, payloads, variants, classes and offsets one through the
other. What is known to differ from OpenUSD (docs/usd.md) and native instances, which have tests of their own, are
not among it."""

import random

LAYERS = 4
PRIMS = ["A", "B", "C"]
CLASSES = ["_c0", "_c1"]
TRIANGLE = """def Mesh "{name}" {{
    int[] faceVertexCounts = [3]
    int[] faceVertexIndices = [0, 1, 2]
    uniform token subdivisionScheme = "none"
    point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
}}
"""
ORDER = 'uniform token[] xformOpOrder = ["xformOp:translate"]\n'


class Layers:
    """The layers of one stage; arcs lead to later ones, so that no reference closes a cycle."""

    def __init__(self, seed):
        self.random = random.Random(seed)

    def maybe(self, chance, make):
        return make() if self.random.random() < chance else ""

    def offset(self):
        random = self.random
        return self.maybe(0.5, lambda: f" (offset = {random.randint(-5, 5)}; scale = {random.choice([0.5, 1, 2])})")

    def values(self):
        random = self.random
        place = lambda: f"({random.randint(1, 99)}, {random.randint(1, 9)}, 0)"
        return random.choice([
            lambda: "",
            lambda: f"double3 xformOp:translate = {place()}\n" + ORDER,
            lambda: f"double3 xformOp:translate.timeSamples = {{ 0: {place()}, 10: {place()} }}\n" + ORDER,
            lambda: f'token visibility = "{random.choice(["invisible", "inherited"])}"\n',
        ])()

    def arcs(self, layer, classes):
        random = self.random

        def external():
            target = random.choice(["", f"</{random.choice(PRIMS[:2])}>"])
            arc = random.choice(["references", "prepend references", "append references", "payload"])
            return f"{arc} = @./l{random.randint(layer + 1, LAYERS - 1)}.usda@{target}{self.offset()}\n"

        def inner():
            return f"{random.choice(['inherits', 'prepend specializes'])} = </{random.choice(CLASSES)}>\n"

        arcs = self.maybe(0.4, external) if layer + 1 < LAYERS else ""
        return arcs + (self.maybe(0.3, inner) if classes else "") + self.maybe(0.1, lambda: "active = false\n")

    def variants(self, layer, classes):
        def variant(name):
            arcs = self.maybe(0.5, lambda: self.arcs(layer, classes))
            head = f'"{name}" ({arcs})' if arcs else f'"{name}"'
            return f"{head} {{ {self.values()}{self.maybe(0.5, lambda: TRIANGLE.format(name='V' + name))} }}\n"

        return f'variantSet "v" = {{\n{variant("x")}{variant("y")}}}\n'

    def prim(self, layer, name, depth=0, spec="def"):
        # What a class inherits may lead back to it.
        classes = spec != "class"
        head, body = self.arcs(layer, classes), self.values() + self.maybe(0.6, lambda: TRIANGLE.format(name="T"))
        if classes and self.random.random() < 0.3:
            head += f'variants = {{ string v = "{self.random.choice("xy")}" }}\nprepend variantSets = "v"\n'
            body += self.variants(layer, classes)
        if depth < 2 and classes:
            for child in PRIMS:
                child_spec = self.random.choice(["def", "def", "over"])
                body += self.maybe(0.35, lambda: self.prim(layer, child, depth + 1, child_spec))
        return f'{spec} Xform "{name}" ({head}) {{\n{body}}}\n'

    def layer(self, layer):
        rate = self.random.choice([24, 24, 48, 12])
        head = f'defaultPrim = "A"\nmetersPerUnit = 1\nupAxis = "Y"\ntimeCodesPerSecond = {rate}\n'
        if layer + 1 < LAYERS:
            below = lambda: f"subLayers = [@./l{self.random.randint(layer + 1, LAYERS - 1)}.usda@{self.offset()}]\n"
            head += self.maybe(0.5, below)
        prims = "".join(self.prim(layer, name) for name in PRIMS[:2])
        return f"#usda 1.0\n({head})\n{prims}" + "".join(self.prim(layer, name, spec="class") for name in CLASSES)

    def write(self, folder):
        """The path of the root layer."""
        for layer in range(LAYERS):
            (folder / f"l{layer}.usda").write_text(self.layer(layer))
        return folder / "l0.usda"
