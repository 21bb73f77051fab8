"""Stages of several layers whose arcs go one through the other, against OpenUSD itself (usd-core)."""

import textwrap

import pytest

pytest.importorskip("pxr", reason="usd-core is not installed")
from pxr import Usd  # noqa: E402
from test_usd_core import judge, read  # noqa: E402
from usd_random import TRIANGLE, Layers  # noqa: E402

HEAD = '#usda 1.0\n(defaultPrim = "A"\nmetersPerUnit = 1\nupAxis = "Y")\n'
MESH = TRIANGLE.format(name="T")
MOVES = """double3 xformOp:translate.timeSamples = { 0: (0, 0, 0), 100: (100, 0, 0) }
    uniform token[] xformOpOrder = ["xformOp:translate"]
"""


def put(folder, **layers):
    for name, text in layers.items():
        (folder / f"{name}.usda").write_text(HEAD + textwrap.dedent(text))
    return folder / "root.usda"


# OpenUSD itself never ends on it.
ENDLESS = {32}


@pytest.mark.parametrize("first", range(0, 60, 10))
def test_random_layers_are_composed_as_openusd_composes_them(tmp_path, first):
    judged = 0
    for seed in set(range(first, first + 10)) - ENDLESS:
        folder = tmp_path / str(seed)
        folder.mkdir()
        path = Layers(seed).write(folder)
        stage = Usd.Stage.Open(str(path))
        # What OpenUSD leaves out depends on what it meets first.
        if stage.GetCompositionErrors():
            continue
        judged += 1
        found = judge(path, "--frame", 3, frame=3)
        assert not found, f"seed {seed}: " + "\n".join(found)
    assert judged >= 5


@pytest.mark.parametrize("arc", ["inherits", "specializes"])
@pytest.mark.parametrize("rate", [24, 48])
def test_classes_keep_the_time_of_the_layer_in_which_they_are_implied(tmp_path, arc, rate):
    path = put(
        tmp_path,
        root=f'class "_c" {{ {MOVES} }}\ndef "R" (references = @middle.usda@ (offset = 10)) {{}}',
        middle='def Xform "A" (references = @leaf.usda@ (offset = 4; scale = 2)) {}',
        leaf=f'class "_c" {{}}\ndef Xform "A" ({arc} = </_c>) {{ {MESH} def Xform "B" {{ {MOVES} {MESH} }}\n }}',
    )
    leaf = tmp_path / "leaf.usda"
    leaf.write_text(leaf.read_text().replace("metersPerUnit", f"timeCodesPerSecond = {rate}\nmetersPerUnit", 1))
    assert not judge(path, "--frame", 50, frame=50)


CYCLES = {
    "a class whose prim inherits it in another layer": {
        "root": f'def "R" (references = @middle.usda@) {{ {MESH} }}',
        "middle": f"""
            def Xform "A" (inherits = </_c>) {{ {MESH} }}
            class "_c" {{ double3 xformOp:translate = (3, 0, 0)
                uniform token[] xformOpOrder = ["xformOp:translate"]
                def Xform "B" (references = @leaf.usda@) {{}}
            }}""",
        "leaf": f'class "_c" {{ {MESH} }}\ndef Xform "A" (inherits = </_c>) {{ {MOVES} }}',
    },
    "two classes that hold each other's heirs": {
        "root": f'def "R" (references = @middle.usda@) {{ {MESH} }}',
        "middle": """
            def Xform "A" (inherits = </_c>) {}
            class "_c" { def Xform "B" (references = @leaf.usda@) {}
            }
            class "_d" { def Xform "C" (references = @leaf.usda@</D>) {}
            }""",
        "leaf": f"""
            class "_c" {{}}
            class "_d" {{ {MESH} }}
            def Xform "A" (inherits = </_d>) {{ {MOVES} }}
            def Xform "D" (inherits = </_c>) {{ {MESH} }}""",
    },
}


@pytest.mark.parametrize("name", CYCLES)
def test_cycles_through_implied_classes_are_left_out(tmp_path, name):
    path = put(tmp_path, **CYCLES[name])
    assert Usd.Stage.Open(str(path)).GetCompositionErrors()
    assert not judge(path, "--frame", 50, frame=50)


def test_the_arc_that_closes_a_cycle_is_told(tmp_path):
    path = put(tmp_path, **CYCLES["two classes that hold each other's heirs"])
    told = [warning for warning in read(path)["warnings"] if "is composed of itself by way of" in warning]
    assert told and all("leaf.usda, /" in warning for warning in told)


def test_names_of_properties_may_have_any_letters(tmp_path):
    mesh = MESH.replace("point3f[]", """texCoord2f[] primvars:größe = [(0, 0), (1, 0), (0, 1)] (interpolation = "vertex")
        rel über:日本 = </A>
        point3f[]""", 1)
    path = put(tmp_path, root=f'def Xform "A" {{ {mesh} }}')
    assert not judge(path)
    assert not read(path)["warnings"]
