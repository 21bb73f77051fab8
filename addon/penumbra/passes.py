"""Which passes a view layer asks for, and what they are called in Blender.

The engine's table of passes is the source: a pass's layer is its name in Blender. Here stands only
which check box of Blender's asks for it.
"""

import penumbra

# Check boxes of ViewLayer, by pass.
_BOXES = {
    "depth": "use_pass_z",
    "mist": "use_pass_mist",
    "position": "use_pass_position",
    "normal": "use_pass_normal",
    "vector": "use_pass_vector",
    "uv": "use_pass_uv",
    "object_index": "use_pass_object_index",
    "material_index": "use_pass_material_index",
    "emission": "use_pass_emit",
    "environment": "use_pass_environment",
    "ao": "use_pass_ambient_occlusion",
    "crypto_object": "use_pass_cryptomatte_object",
    "crypto_material": "use_pass_cryptomatte_material",
    "crypto_asset": "use_pass_cryptomatte_asset",
}
for _lobe in ("diffuse", "glossy", "transmission"):
    for _part in ("direct", "indirect", "color"):
        _BOXES[f"{_lobe}_{_part}"] = f"use_pass_{_lobe}_{_part}"

# Check boxes of Cycles' own settings of the view layer, by pass.
_BOXES_OF_CYCLES = {"shadow_catcher": "use_pass_shadow_catcher"}

# Those of them that there is no pass for, by name, as far as a version of Blender has them.
_MISSING = {
    "Volume Direct": "use_pass_volume_direct",
    "Volume Indirect": "use_pass_volume_indirect",
    "Volume Scatter": "use_pass_volume_scatter",
    "Volume Transmit": "use_pass_volume_transmit",
    "Volume Majorant": "use_pass_volume_majorant",
    "Render Time": "pass_render_time",
}

_TYPES = {"X": "VALUE", "Z": "VALUE", "XYZ": "VECTOR", "XYZW": "VECTOR", "UVA": "VECTOR"}


def chosen(view_layer):
    """Names of the engine's passes that the view layer asks for, Combined first."""
    return _of_engine(view_layer) + (["aov:*"] if aovs(view_layer) else [])


def _of_engine(view_layer):
    """The same without what the view layer declares itself."""
    own = view_layer.penumbra
    names = ["combined"]
    for row in penumbra.passes():
        name = row["name"]
        if name == "combined" or name == "aov:<name>":
            continue
        if "<group>" in name:
            if view_layer.lightgroups and (name.startswith("combined") or own.use_pass_shadow):
                names.append(name.replace("<group>", "*"))
        elif name in _BOXES:
            if getattr(view_layer, _BOXES[name], False):
                names.append(name)
        elif name in _BOXES_OF_CYCLES:
            if getattr(getattr(view_layer, "cycles", None), _BOXES_OF_CYCLES[name], False):
                names.append(name)
        elif getattr(own, f"use_pass_{name}", False):
            names.append(name)
    return names


def layers(view_layer):
    """(name, channels, type) of every layer that a render of the view layer has."""
    channels = {"VALUE": "X", "COLOR": "RGBA"}
    own = [(aov.name, channels[aov.type], aov.type) for aov in aovs(view_layer)]
    return _layers_of_engine(view_layer) + own


def aovs(view_layer):
    """The view layer's shader AOVs that can be told from all other passes."""
    names = {name for name, _, _ in _layers_of_engine(view_layer)} if view_layer.aovs else set()
    return [aov for aov in view_layer.aovs if aov.is_valid and aov.name and aov.name not in names]


def clashing(view_layer):
    """Names of those that can't."""
    usable = {aov.name for aov in aovs(view_layer)}
    return [aov.name for aov in view_layer.aovs if aov.name not in usable]


def missing(view_layer):
    """Names of the passes of Blender and Cycles that the view layer asks for and the engine does not have."""
    cycles = getattr(view_layer, "cycles", None)
    return [name for name, box in _MISSING.items() if getattr(cycles, box, False)]


def _layers_of_engine(view_layer):
    rows = {row["name"]: row for row in penumbra.passes()}
    groups = [group.name for group in view_layer.lightgroups]
    result = []
    for name in _of_engine(view_layer):
        row = rows[name.replace("*", "<group>")]
        channels = row["channels"]
        kind = _TYPES.get(channels, "COLOR")
        if name.startswith("crypto_"):
            for level in range((view_layer.pass_cryptomatte_depth + 1) // 2):
                result.append((f"{row['layer']}{level:02d}", channels, kind))
        elif name.endswith("*"):
            result += [(row["layer"].replace("<group>", group), channels, kind) for group in groups]
        else:
            result.append((row["layer"], channels, kind))
    return result


def is_known(box):
    """True for a check box of ViewLayer's that asks for a pass which the engine has."""
    return any(_BOXES.get(row["name"]) == box for row in penumbra.passes())


def has_box_of_cycles(name, view_layer):
    """True for a pass which a check box of Cycles' own asks for, where the view layer has that."""
    return hasattr(getattr(view_layer, "cycles", None), _BOXES_OF_CYCLES.get(name, ""))


def own_boxes():
    """Passes that Blender has no check box for: (name, layer, help)."""
    return [
        (row["name"], row["layer"], row["help"])
        for row in penumbra.passes()
        if row["name"] not in {*_BOXES, *_BOXES_OF_CYCLES, "combined"} and "<" not in row["name"]
    ]
