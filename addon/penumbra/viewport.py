"""The rendered viewport: a picture that begins coarse, refines, and starts again at every edit."""

import bpy
import gpu
import penumbra
from gpu_extras.presets import draw_texture_2d

from . import properties
from .export import Exporter

# Seconds between two looks for a new picture.
_POLL = 1.0 / 30.0


class Viewport:
    """What a 3D viewport shows; it lives as long as its engine."""

    def __init__(self, engine):
        self.engine = engine
        self.exporter = Exporter(penumbra.Scene())
        self.render = penumbra.Viewport()
        self.texture = None
        self.view = None
        self.stale = True
        self.alive = True
        self.told = set()
        bpy.app.timers.register(self._poll)

    def free(self):
        """Stops rendering; nothing is drawn any more."""
        self.alive = False
        self.render.stop()

    def update(self, context, depsgraph):
        """The scene was edited."""
        self.exporter.update(depsgraph, local_view=context.space_data if context.space_data.local_view else None)
        self.stale = True

    def draw(self, context, depsgraph):
        """Draws the newest picture, and starts another where the view is not the one that it shows."""
        region, scene = context.region, depsgraph.scene
        view = _view(context)
        if self.stale or view != self.view:
            settings = properties.settings(scene, context.view_layer)
            settings["passes"] = ["combined"]
            settings.pop("time", None)
            settings["spp"] = scene.penumbra.viewport_spp or 1024
            try:
                self.render.show(self.exporter.scene, view, self.stale, **settings)
            except Exception as error:
                self.engine.update_stats("Penumbra", str(error))
                self.stale, self.view = False, view
                return
            self.stale, self.view = False, view
        self._tell()
        picture = self.render.picture()
        if picture is not None:
            width, height, pixels, spp = picture
            buffer = gpu.types.Buffer("FLOAT", width * height * 4, pixels)
            self.texture = gpu.types.GPUTexture((width, height), format="RGBA16F", data=buffer)
            self.engine.update_stats("Penumbra", f"Sample {spp:.0f}/{settings_spp(scene)}")
        if self.texture is not None:
            gpu.state.blend_set("ALPHA_PREMULT")
            draw_texture_2d(self.texture, (0, 0), region.width, region.height)
            gpu.state.blend_set("NONE")

    def _tell(self):
        for warning in [*self.exporter.warnings, *self.render.warnings()]:
            if warning not in self.told:
                self.told.add(warning)
                print(f"Penumbra: {warning}")

    def _poll(self):
        """Runs on Blender's thread; asks for a redraw where there is something new to show."""
        if not self.alive:
            return None
        try:
            if self.render.has_news():
                self.engine.tag_redraw()
        except ReferenceError:
            # Blender has freed the engine.
            self.free()
            return None
        return _POLL


def settings_spp(scene):
    """Samples at which a viewport is done."""
    return scene.penumbra.viewport_spp or 1024


def _view(context):
    """The view as plain data: matrices and size, and the lens where it is a camera's."""
    region, data = context.region, context.region_data
    view = {
        "size": (region.width, region.height),
        "matrix": tuple(tuple(row) for row in data.view_matrix.inverted()),
        "window": tuple(tuple(row) for row in data.window_matrix),
        "orthographic": not data.is_perspective,
        "clip_start": context.space_data.clip_start,
        "clip_end": context.space_data.clip_end,
    }
    return view
