"""Panels: Penumbra's own, and those of Blender and Cycles that hold for it, too."""

import bpy

_ENGINE = "PENUMBRA"
# Panels of Blender's own engines that mean nothing here.
_EXCLUDED = {
    "RENDER_PT_simplify", "RENDER_PT_simplify_viewport", "RENDER_PT_simplify_render", "RENDER_PT_simplify_greasepencil",
    "VIEWLAYER_PT_filter", "VIEWLAYER_PT_layer_passes",
}
# Panels that show for Penumbra, too, and the set of engines that each had by itself.
_LENT = {}


class _Panel:
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    COMPAT_ENGINES = {_ENGINE}

    @classmethod
    def poll(cls, context):
        return context.engine in cls.COMPAT_ENGINES

    def _split(self):
        """The layout, names to the left as Blender's own panels have them."""
        self.layout.use_property_split = True
        self.layout.use_property_decorate = False
        return self.layout


class PENUMBRA_PT_sampling(_Panel, bpy.types.Panel):
    bl_label = "Sampling"
    bl_context = "render"

    def draw(self, context):
        layout, own = self._split(), context.scene.penumbra
        column = layout.column(align=True)
        column.prop(own, "spp", text="Samples")
        column.prop(own, "time", text="Time Limit")
        layout.prop(own, "viewport_spp")
        layout.prop(own, "seed")


class PENUMBRA_PT_sampling_advanced(_Panel, bpy.types.Panel):
    bl_label = "Advanced"
    bl_context = "render"
    bl_parent_id = "PENUMBRA_PT_sampling"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout, own = self._split(), context.scene.penumbra
        for name in ("sampler", "light_samples", "light_selection", "effects"):
            layout.prop(own, name)


class PENUMBRA_PT_light_paths(_Panel, bpy.types.Panel):
    bl_label = "Light Paths"
    bl_context = "render"

    def draw(self, context):
        layout, own = self._split(), context.scene.penumbra
        layout.prop(own, "integrator")
        layout.prop(own, "max_bounces")


class PENUMBRA_PT_ambient_occlusion(_Panel, bpy.types.Panel):
    bl_label = "Ambient Occlusion"
    bl_context = "render"

    def draw(self, context):
        layout, scene = self._split(), context.scene
        layout.prop(scene.penumbra, "ao_samples", text="Samples")
        if scene.world is not None:
            layout.prop(scene.world.light_settings, "distance")


class PENUMBRA_PT_film(_Panel, bpy.types.Panel):
    bl_label = "Film"
    bl_context = "render"

    def draw(self, context):
        layout, scene = self._split(), context.scene
        cycles = getattr(scene, "cycles", None)
        if cycles is not None:
            layout.prop(cycles, "film_exposure")
            layout.prop(cycles, "pixel_filter_type")
            if cycles.pixel_filter_type != "BOX":
                layout.prop(cycles, "filter_width")
        layout.prop(scene.render, "film_transparent", text="Transparent")


class PENUMBRA_PT_passes(_Panel, bpy.types.Panel):
    bl_label = "Passes"
    bl_context = "view_layer"

    def draw(self, context):
        layout, layer = self._split(), context.view_layer
        own = layer.penumbra
        for title, names in (
            ("Shadow and Occlusion", ("ambient_occlusion",)),
            ("Data", ("z", "mist", "position", "normal", "vector", "uv", "object_index", "material_index")),
            ("Light", ("diffuse_direct", "diffuse_indirect", "diffuse_color", "glossy_direct", "glossy_indirect",
                       "glossy_color", "transmission_direct", "transmission_indirect", "transmission_color",
                       "emit", "environment")),
            ("Cryptomatte", ("cryptomatte_object", "cryptomatte_material", "cryptomatte_asset")),
        ):
            column = layout.column(heading=title, align=True)
            for name in names:
                if hasattr(layer, f"use_pass_{name}"):
                    column.prop(layer, f"use_pass_{name}")
            if title.startswith("Shadow"):
                for name in ("use_pass_shadow", "use_pass_unshadowed"):
                    column.prop(own, name)
        column = layout.column(heading="Penumbra", align=True)
        for name in own.__annotations__:
            if name not in {"use_pass_shadow", "use_pass_unshadowed"}:
                column.prop(own, name)


PANELS = (
    PENUMBRA_PT_sampling,
    PENUMBRA_PT_sampling_advanced,
    PENUMBRA_PT_light_paths,
    PENUMBRA_PT_ambient_occlusion,
    PENUMBRA_PT_film,
    PENUMBRA_PT_passes,
)


def _shared():
    """Panels of Blender's own and of Cycles that show what holds for Penumbra, too."""
    for panel in bpy.types.Panel.__subclasses__():
        engines = getattr(panel, "COMPAT_ENGINES", None)
        if engines is None or panel in PANELS:
            continue
        of_blender = "BLENDER_RENDER" in engines and panel.__name__ not in _EXCLUDED
        of_cycles = engines == {"CYCLES"} and panel.__name__.startswith(
            ("CYCLES_LIGHT_PT", "CYCLES_WORLD_PT", "CYCLES_MATERIAL_PT", "CYCLES_OBJECT_PT_lightgroup",
             "CYCLES_OBJECT_PT_light_linking", "CYCLES_OBJECT_PT_shadow_linking", "CYCLES_OBJECT_PT_visibility",
             "CYCLES_CAMERA_PT_dof", "CYCLES_VIEW_LAYER_PT_light_groups"))
        if of_blender or of_cycles:
            yield panel


def register():
    for panel in PANELS:
        bpy.utils.register_class(panel)
    for panel in list(_shared()):
        # A set of its own: Cycles' panels all have one and the same.
        _LENT[panel] = panel.__dict__.get("COMPAT_ENGINES")
        panel.COMPAT_ENGINES = {*panel.COMPAT_ENGINES, _ENGINE}


def unregister():
    for panel, engines in _LENT.items():
        if engines is None:
            del panel.COMPAT_ENGINES
        else:
            panel.COMPAT_ENGINES = engines
    _LENT.clear()
    for panel in reversed(PANELS):
        bpy.utils.unregister_class(panel)
