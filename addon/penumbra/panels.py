"""Penumbra's own panels; those of Blender and Cycles that hold for it, too, are in lent.py."""

import bpy

from . import engine, lamps, passes
from .ui import Panel


class PENUMBRA_PT_sampling(Panel, bpy.types.Panel):
    bl_label = "Sampling"
    bl_context = "render"

    def draw(self, context):
        pass


class PENUMBRA_PT_sampling_viewport(Panel, bpy.types.Panel):
    bl_label = "Viewport"
    bl_context = "render"
    bl_parent_id = "PENUMBRA_PT_sampling"

    def draw(self, context):
        self._split().prop(context.scene.penumbra, "viewport_spp", text="Samples")


class PENUMBRA_PT_sampling_render(Panel, bpy.types.Panel):
    bl_label = "Render"
    bl_context = "render"
    bl_parent_id = "PENUMBRA_PT_sampling"

    def draw(self, context):
        layout, own = self._split(), context.scene.penumbra
        column = layout.column(align=True)
        column.prop(own, "error", text="Noise Target")
        column.prop(own, "spp", text="Max Samples" if own.error > 0.0 else "Samples")
        column.prop(own, "time", text="Time Limit")
        layout.prop(own, "adaptive", text="Adaptive")
        known = layout.column()
        known.active = not (own.error > 0.0 or own.adaptive)
        known.prop(own, "use_noise_estimate", text="Show Noise")


class PENUMBRA_PT_sampling_lights(Panel, bpy.types.Panel):
    bl_label = "Lights"
    bl_context = "render"
    bl_parent_id = "PENUMBRA_PT_sampling"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout, own = self._split(), context.scene.penumbra
        layout.prop(own, "light_samples", text="Samples")
        layout.prop(own, "light_selection", text="Selection")


class PENUMBRA_PT_sampling_advanced(Panel, bpy.types.Panel):
    bl_label = "Advanced"
    bl_context = "render"
    bl_parent_id = "PENUMBRA_PT_sampling"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout, own = self._split(), context.scene.penumbra
        row = layout.row(align=True)
        row.prop(own, "seed")
        row.prop(own, "use_animated_seed", text="", icon="TIME")
        layout.prop(own, "sampler", text="Pattern")
        layout.prop(own, "specular_aa", text="Specular Anti-Aliasing")
        layout.prop(own, "effects")


class PENUMBRA_PT_light_paths(Panel, bpy.types.Panel):
    bl_label = "Light Paths"
    bl_context = "render"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout, own = self._split(), context.scene.penumbra
        layout.prop(own, "integrator")
        column = layout.column()
        column.active = own.integrator == "path"
        column.prop(own, "max_bounces")


class _LightPathsPanel(Panel):
    """Settings of light paths that are Cycles' own."""

    bl_context = "render"
    bl_parent_id = "PENUMBRA_PT_light_paths"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        return super().poll(context) and hasattr(context.scene, "cycles")

    def draw(self, context):
        layout, cycles = self._split(), context.scene.cycles
        layout.active = context.scene.penumbra.integrator == "path"
        column = layout.column(align=True)
        for name, text in self.ROWS:
            column.prop(cycles, name, text=text)


class PENUMBRA_PT_light_paths_bounces(_LightPathsPanel, bpy.types.Panel):
    bl_label = "Of One Kind"
    ROWS = (("diffuse_bounces", "Diffuse"), ("glossy_bounces", "Glossy"), ("transmission_bounces", "Transmission"),
            ("transparent_max_bounces", "Transparent"))


class PENUMBRA_PT_light_paths_clamping(_LightPathsPanel, bpy.types.Panel):
    bl_label = "Clamping"
    ROWS = (("sample_clamp_direct", "Direct Light"), ("sample_clamp_indirect", "Indirect Light"))


class PENUMBRA_PT_light_paths_caustics(_LightPathsPanel, bpy.types.Panel):
    bl_label = "Caustics"
    ROWS = (("blur_glossy", "Filter Glossy"), ("caustics_reflective", "Reflective"),
            ("caustics_refractive", "Refractive"))


class PENUMBRA_PT_ambient_occlusion(Panel, bpy.types.Panel):
    bl_label = "Ambient Occlusion"
    bl_context = "render"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout, scene = self._split(), context.scene
        layout.prop(scene.penumbra, "ao_samples", text="Samples")
        if scene.world is not None:
            layout.prop(scene.world.light_settings, "distance")


class PENUMBRA_PT_motion_blur(Panel, bpy.types.Panel):
    bl_label = "Motion Blur"
    bl_context = "render"
    bl_options = {"DEFAULT_CLOSED"}

    def draw_header(self, context):
        self.layout.prop(context.scene.render, "use_motion_blur", text="")

    def draw(self, context):
        layout, render = self._split(), context.scene.render
        layout.active = render.use_motion_blur
        column = layout.column()
        column.prop(render, "motion_blur_position", text="Position")
        column.prop(render, "motion_blur_shutter")
        cycles = getattr(context.scene, "cycles", None)
        if cycles is not None:
            column.separator()
            column.prop(cycles, "rolling_shutter_type", text="Rolling Shutter")
            duration = column.column()
            duration.active = cycles.rolling_shutter_type != "NONE"
            duration.prop(cycles, "rolling_shutter_duration")


class PENUMBRA_PT_motion_blur_curve(Panel, bpy.types.Panel):
    bl_label = "Shutter Curve"
    bl_context = "render"
    bl_parent_id = "PENUMBRA_PT_motion_blur"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout, render = self.layout, context.scene.render
        layout.active = render.use_motion_blur
        layout.template_curve_mapping(render, "motion_blur_shutter_curve")
        row = layout.row(align=True)
        for shape, icon in (("SMOOTH", "SMOOTHCURVE"), ("ROUND", "SPHERECURVE"), ("ROOT", "ROOTCURVE"),
                            ("SHARP", "SHARPCURVE"), ("LINE", "LINCURVE"), ("MAX", "NOCURVE")):
            row.operator("render.shutter_curve_preset", icon=icon, text="").shape = shape


class PENUMBRA_PT_film(Panel, bpy.types.Panel):
    bl_label = "Film"
    bl_context = "render"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout, scene = self._split(), context.scene
        cycles = getattr(scene, "cycles", None)
        if cycles is not None:
            layout.prop(cycles, "film_exposure")
            layout.prop(cycles, "pixel_filter_type")
            if cycles.pixel_filter_type != "BOX":
                layout.prop(cycles, "filter_width")
        layout.prop(scene.render, "film_transparent", text="Transparent")


class PENUMBRA_PT_performance(Panel, bpy.types.Panel):
    bl_label = "Performance"
    bl_context = "render"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout, render = self._split(), context.scene.render
        column = layout.column()
        column.prop(render, "threads_mode")
        count = column.column(align=True)
        count.enabled = render.threads_mode == "FIXED"
        count.prop(render, "threads")


class PENUMBRA_PT_effects(Panel, bpy.types.Panel):
    """What the last render simulated, and because of what."""

    bl_label = "Effects"
    bl_context = "render"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        rows = engine.PLANS.get(context.scene.name)
        if not rows:
            self.layout.label(text="Render to see which effects the scene calls for", icon="INFO")
            return
        column = self.layout.column(align=True)
        for row in rows:
            if row["on"]:
                line = column.split(factor=0.4)
                line.label(text=row["effect"].capitalize())
                line.label(text=row["because"])
        off = [row for row in rows if not row["on"]]
        column = self.layout.column(align=True)
        column.active = False
        column.label(text="Not there:")
        for row in off:
            line = column.split(factor=0.4)
            line.label(text=row["effect"].capitalize())
            line.label(text=row["because"])


class PENUMBRA_PT_passes(Panel, bpy.types.Panel):
    bl_label = "Passes"
    bl_context = "view_layer"

    def draw(self, context):
        pass


class _Passes(Panel):
    """Check boxes of passes: (heading, [(name of the property, text)]); Penumbra's own where Blender has none."""

    bl_context = "view_layer"
    bl_parent_id = "PENUMBRA_PT_passes"
    BOXES = ()

    def draw(self, context):
        layout, layer = self._split(), context.view_layer
        for heading, boxes in self.BOXES:
            column = layout.column(heading=heading, align=True)
            for name, text in boxes:
                if hasattr(layer.penumbra, f"use_pass_{name}"):
                    column.prop(layer.penumbra, f"use_pass_{name}", text=text)
                elif passes.is_known(f"use_pass_{name}"):
                    column.prop(layer, f"use_pass_{name}", text=text)
                elif passes.has_box_of_cycles(name, layer):
                    column.prop(layer.cycles, f"use_pass_{name}", text=text)


class PENUMBRA_PT_passes_shadow(_Passes, bpy.types.Panel):
    bl_label = "Shadow and Occlusion"
    BOXES = (("Include", (("shadow", "Shadow"), ("unshadowed", "Diffuse Direct Unshadowed"),
                          ("ambient_occlusion", "Ambient Occlusion"), ("shadow_catcher", "Shadow Catcher"))),)


class PENUMBRA_PT_passes_data(_Passes, bpy.types.Panel):
    bl_label = "Data"
    BOXES = (
        ("Include", (("z", "Z"), ("mist", "Mist"), ("position", "Position"), ("normal", "Normal"), ("vector", "Vector"),
                     ("uv", "UV"))),
        ("Denoising", (("denoising_normal", "Normal"), ("denoising_albedo", "Albedo"), ("denoising_depth", "Depth"))),
        ("Indexes", (("object_index", "Object Index"), ("material_index", "Material Index"))),
        ("Debug", (("sample_count", "Sample Count"),)),
        ("Error", (("error", "Combined"), ("error_ao", "Ambient Occlusion"), ("error_shadow", "Shadow"),
                   ("error_trust", "Trust"))),
    )

    def draw(self, context):
        super().draw(context)
        self.layout.prop(context.view_layer, "pass_alpha_threshold")


class PENUMBRA_PT_passes_light(_Passes, bpy.types.Panel):
    bl_label = "Light"
    BOXES = (
        *((lobe.capitalize(), tuple((f"{lobe}_{part}", part.replace("_", " ").title())
                                    for part in ("direct", "indirect", "color", "light", "light_direct",
                                                 "light_indirect")))
          for lobe in ("diffuse", "glossy", "transmission")),
        ("Other", (("emit", "Emission"), ("environment", "Environment"))),
    )


class PENUMBRA_PT_passes_cryptomatte(Panel, bpy.types.Panel):
    bl_label = "Cryptomatte"
    bl_context = "view_layer"
    bl_parent_id = "PENUMBRA_PT_passes"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        bpy.types.VIEWLAYER_PT_layer_passes_cryptomatte.draw(self, context)


class PENUMBRA_PT_passes_light_groups(Panel, bpy.types.Panel):
    bl_label = "Light Groups"
    bl_context = "view_layer"
    bl_parent_id = "PENUMBRA_PT_passes"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        bpy.types.VIEWLAYER_PT_layer_passes_lightgroups.draw(self, context)


class PENUMBRA_PT_passes_aov(Panel, bpy.types.Panel):
    bl_label = "Shader AOV"
    bl_context = "view_layer"
    bl_parent_id = "PENUMBRA_PT_passes"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        bpy.types.VIEWLAYER_PT_layer_passes_aov.draw(self, context)


PANELS = (
    PENUMBRA_PT_sampling,
    PENUMBRA_PT_sampling_viewport,
    PENUMBRA_PT_sampling_render,
    PENUMBRA_PT_sampling_lights,
    PENUMBRA_PT_sampling_advanced,
    PENUMBRA_PT_light_paths,
    PENUMBRA_PT_light_paths_bounces,
    PENUMBRA_PT_light_paths_clamping,
    PENUMBRA_PT_light_paths_caustics,
    PENUMBRA_PT_ambient_occlusion,
    *lamps.PANELS,
    PENUMBRA_PT_motion_blur,
    PENUMBRA_PT_motion_blur_curve,
    PENUMBRA_PT_film,
    PENUMBRA_PT_performance,
    PENUMBRA_PT_effects,
    PENUMBRA_PT_passes,
    PENUMBRA_PT_passes_shadow,
    PENUMBRA_PT_passes_data,
    PENUMBRA_PT_passes_light,
    PENUMBRA_PT_passes_cryptomatte,
    PENUMBRA_PT_passes_aov,
    PENUMBRA_PT_passes_light_groups,
)


def register():
    for panel in PANELS:
        bpy.utils.register_class(panel)


def unregister():
    for panel in reversed(PANELS):
        bpy.utils.unregister_class(panel)
