"""Panels of Blender and of Cycles that hold for Penumbra, too: what an artist sets there is what is rendered."""

import sys

import bpy

_ENGINE = "PENUMBRA"

# Panels of Blender's own engines that mean nothing here.
_EXCLUDED = {
    "RENDER_PT_simplify", "RENDER_PT_simplify_viewport", "RENDER_PT_simplify_render", "RENDER_PT_simplify_greasepencil",
    "VIEWLAYER_PT_layer_passes",
}
# Those in whose place Cycles has one with more.
_REPLACED = {
    "DATA_PT_camera_dof", "DATA_PT_falloff_curve", "DATA_PT_light", "DATA_PT_preview", "DATA_PT_spot",
    "MATERIAL_PT_context_material", "MATERIAL_PT_preview", "NODE_DATA_PT_light", "NODE_DATA_PT_spot",
    "OBJECT_PT_visibility", "VIEWLAYER_PT_filter",
}
# Panels of Cycles, whatever of them a version of Blender has.
_OF_CYCLES = {
    "CYCLES_PT_context_material", "CYCLES_MATERIAL_PT_preview", "CYCLES_MATERIAL_PT_surface", "CYCLES_MATERIAL_PT_volume",
    "CYCLES_MATERIAL_PT_settings",
    "CYCLES_LIGHT_PT_preview", "CYCLES_LIGHT_PT_light", "CYCLES_LIGHT_PT_settings", "CYCLES_LIGHT_PT_nodes",
    "CYCLES_LIGHT_PT_beam_shape",
    "CYCLES_WORLD_PT_preview", "CYCLES_WORLD_PT_surface", "CYCLES_WORLD_PT_mist", "CYCLES_WORLD_PT_ray_visibility", "CYCLES_WORLD_PT_settings",
    "CYCLES_WORLD_PT_settings_light_group",
    "OBJECT_PT_shadow_terminator", "CYCLES_OBJECT_PT_shading_shadow_terminator",
    "CYCLES_OBJECT_PT_motion_blur", "CYCLES_OBJECT_PT_shading", "CYCLES_OBJECT_PT_lightgroup", "CYCLES_OBJECT_PT_light_linking",
    "CYCLES_OBJECT_PT_shadow_linking", "CYCLES_OBJECT_PT_visibility", "CYCLES_OBJECT_PT_visibility_ray_visibility",
    "CYCLES_RENDER_PT_filter", "CYCLES_RENDER_PT_override", "VIEWLAYER_PT_override",
    "CYCLES_CAMERA_PT_dof", "CYCLES_CAMERA_PT_dof_aperture", "CYCLES_CAMERA_PT_lens_custom_parameters",
}
# What each panel had by itself, under the names that a loan changes.
_LENT = {}
_NAMES = ("COMPAT_ENGINES", "poll")


def _panels(cls=bpy.types.Panel):
    """All registered panels, those of add-ons' own base classes as well."""
    for panel in cls.__subclasses__():
        yield from _panels(panel)
        if getattr(bpy.types, panel.__name__, None) is panel:
            yield panel


def _is_lendable(panel, replaced):
    engines = getattr(panel, "COMPAT_ENGINES", None)
    if engines is None or _ENGINE in engines:
        return False
    return panel.__name__ in _OF_CYCLES or (
        "BLENDER_RENDER" in engines and panel.__name__ not in _EXCLUDED and not (replaced and panel.__name__ in _REPLACED)
    )


def _poll_for_us(panel):
    """A `poll` that answers for Penumbra as for Cycles, whose panels ask a class that they have in common; None for
    panels that ask for themselves."""
    common = getattr(sys.modules[panel.__module__], "CyclesButtonsPanel", None)
    if common is None or "poll" not in panel.__dict__:
        return None
    own = panel.poll

    def poll(_cls, context):
        if context.engine != _ENGINE:
            return own(context)
        engines = common.COMPAT_ENGINES
        common.COMPAT_ENGINES = {*engines, _ENGINE}
        try:
            return own(context)
        finally:
            common.COMPAT_ENGINES = engines

    return classmethod(poll)


def register():
    has_cycles = hasattr(bpy.types, "CYCLES_LIGHT_PT_light")
    # A panel of two base classes is found twice.
    for panel in dict.fromkeys(panel for panel in _panels() if _is_lendable(panel, has_cycles)):
        _LENT[panel] = {name: panel.__dict__[name] for name in _NAMES if name in panel.__dict__}
        poll = _poll_for_us(panel)
        if poll is not None:
            panel.poll = poll
        # A set of its own: Cycles' panels all have one and the same.
        panel.COMPAT_ENGINES = {*panel.COMPAT_ENGINES, _ENGINE}


def unregister():
    for panel, own in _LENT.items():
        for name in _NAMES:
            if name in own:
                setattr(panel, name, own[name])
            elif name in panel.__dict__:
                delattr(panel, name)
    _LENT.clear()
