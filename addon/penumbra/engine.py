"""Blender's render engine: F12, animations, background renders."""

import os
import traceback

import bpy
import penumbra

from . import loaded, passes, properties
from .export import Exporter, libraries, motion
from .viewport import Viewport

# Samples per pixel of a preview in the Properties editor, how long it may take, and how often it is shown on the way.
_PREVIEW_SPP = 32
_PREVIEW_SECONDS = 2.0
_PREVIEW_INTERVAL = 0.1

# Viewports by the address of their engine: attributes of an engine are not all kept by Blender.
VIEWPORTS = {}
# What the last render of each scene simulated, by the scene's name.
PLANS = {}
# What went wrong in each viewport, so that it is told once and not at every redraw.
_FAILED = {}
# What an artist can mend; all else is a bug.
_MENDABLE = (ValueError, OSError, NotImplementedError)


def _shortcuts(scene):
    """Cycles' shortcuts in light paths that Penumbra does not take."""
    if getattr(getattr(scene, "cycles", None), "use_fast_gi", False):
        yield "Fast GI Approximation is not used: bounces are all computed"


class PenumbraRenderEngine(bpy.types.RenderEngine):
    """Renders with Penumbra."""

    bl_idname = "PENUMBRA"
    bl_label = "Penumbra"
    bl_use_preview = True
    bl_use_eevee_viewport = True
    bl_use_postprocess = True
    bl_use_shading_nodes_custom = False
    # Strokes of Freestyle are rendered by this engine, which needs no graphics card.
    bl_use_custom_freestyle = True

    def update_render_passes(self, scene=None, renderlayer=None):
        """Tells Blender which passes there will be."""
        for name, channels, kind in passes.layers(renderlayer):
            self.register_pass(scene, renderlayer, name, len(channels), channels, kind)

    def render(self, depsgraph):
        """Renders one view layer. Nothing may be raised from here: it would take Blender down."""
        try:
            self._render(depsgraph)
        except BaseException as error:  # noqa: BLE001  (a panic of the engine is no Exception)
            if isinstance(error, KeyboardInterrupt) and self._stopped():
                return
            message = _message(error)
            self.report({"ERROR"}, message)
            self.error_set(message)

    def _render(self, depsgraph):
        loaded.check()
        scene, view_layer = depsgraph.scene, depsgraph.view_layer
        scale = scene.render.resolution_percentage / 100.0
        size = [max(int(n * scale), 1) for n in (scene.render.resolution_x, scene.render.resolution_y)]
        if scene.camera is None and self.camera_override is None:
            raise ValueError("the scene has no camera: add one, or make one the scene's camera")
        if scene.render.use_multiview:
            raise ValueError(
                "stereo pictures are not rendered: turn Stereoscopy off in the output properties, and render each view by"
                " its own camera"
            )
        self.update_stats("", "Penumbra: reading the scene")
        exporter = Exporter(penumbra.Scene(), self._stopped)
        exporter.export(depsgraph, size, self.camera_override, motion=self._motion(depsgraph))
        clashing = [
            f'the shader AOV "{name}" is left out: another pass has its name' for name in passes.clashing(view_layer)
        ]
        missing = [f"the pass {name} is not rendered yet; it is left out" for name in passes.missing(view_layer)]
        self._tell([*libraries.missing(), *clashing, *missing, *_shortcuts(scene), *exporter.warnings])
        if self._stopped():
            return

        def show(picture):
            self._fill(view_layer, picture)

        picture = penumbra.render(
            exporter.scene,
            observer=self._observe,
            on_picture=None if bpy.app.background else show,
            picture_interval=_PREVIEW_INTERVAL if self.is_preview else 1.0,
            frame=scene.frame_current_final,
            plan=not self.is_preview,
            **self._settings(scene, view_layer),
        )
        self._tell(picture.warnings)
        if not self.is_preview:
            PLANS[scene.name] = picture.plan
        self._fill(view_layer, picture)
        self._stamp(view_layer, picture)

    def _motion(self, depsgraph):
        """What gathers the motion of a picture that is blurred, or has the vector pass; None for others."""
        scene, layer = depsgraph.scene_eval, depsgraph.view_layer_eval
        if self.is_preview:
            return None
        if motion.is_on(scene, layer):
            return motion.Motion(scene, self.frame_set, self._stopped)
        return motion.Vectors(scene, self.frame_set, self._stopped) if layer.use_pass_vector else None

    def _settings(self, scene, view_layer):
        """The engine's keyword arguments: the scene's, or those of the small picture of a material, a light or a world."""
        settings = properties.settings(scene, view_layer)
        if self.is_preview:
            settings.update(spp=_PREVIEW_SPP, time=_PREVIEW_SECONDS, passes=["combined"], error=None, adaptive=False)
        return settings

    def view_update(self, context, depsgraph):
        """The scene was edited while the viewport shows it."""
        self._in_viewport(lambda: self._viewport().update(context, depsgraph))

    def view_draw(self, context, depsgraph):
        """Draws the viewport."""
        self._in_viewport(lambda: self._viewport().draw(context, depsgraph))

    def _viewport(self):
        viewport = VIEWPORTS.get(self.as_pointer())
        if viewport is None:
            viewport = VIEWPORTS[self.as_pointer()] = Viewport(self)
        return viewport

    def _in_viewport(self, work):
        try:
            work()
        except BaseException as error:  # noqa: BLE001  (a panic of the engine is no Exception)
            message, known = _message(error), self.as_pointer()
            self.update_stats("Penumbra", message)
            if _FAILED.get(known) != message:
                _FAILED[known] = message
                self.report({"ERROR"}, message)

    def __del__(self):
        """Blender frees the engine: its viewport ends with it."""
        try:
            _FAILED.pop(self.as_pointer(), None)
            viewport = VIEWPORTS.pop(self.as_pointer(), None)
        except ReferenceError:
            viewport = None
        if viewport is not None:
            viewport.free()
        base = getattr(super(), "__del__", None)
        if base is not None:
            base()

    def _observe(self, progress):
        """Called by the engine, on Blender's thread; a true answer stops the render."""
        if progress is not None:
            self.update_progress(progress["done"])
            target = progress["target_spp"]
            count = f"{progress['spp']:.0f}/{target}" if target else f"{progress['spp']:.0f}"
            text = f"Sample {count}"
            if progress["remaining"] is not None and progress["done"] < 1.0:
                text += f" | {_clock(progress['remaining'])} left"
            if progress["error_target"] is not None or progress["error"] is not None:
                text += f" | {_noise(progress)}"
            self.update_stats("", text)
        return self._stopped()

    def _stopped(self):
        """True once the artist wants no picture any more."""
        return self.test_break()

    def _fill(self, view_layer, picture):
        """Puts a picture into Blender's render result, which with a border has its size."""
        result = self.begin_result(0, 0, picture.width, picture.height, layer=view_layer.name)
        if result is None:
            raise ValueError(f"Blender makes no room for a picture of {picture.width}x{picture.height} pixels")
        try:
            for render_pass in result.layers[0].passes:
                if render_pass.name in picture:
                    values = picture.flat(render_pass.name)
                    if len(values) == len(render_pass.rect) * render_pass.channels:
                        render_pass.rect.foreach_set(values)
            self.update_result(result)
        finally:
            self.end_result(result)

    def _stamp(self, view_layer, picture):
        """Says what Cryptomatte's ids mean, where files and the compositor's node have it from."""
        result = self.get_result()
        for name, value in picture.cryptomatte(view_layer.name):
            result.stamp_data_add_field(name, value)

    def _tell(self, warnings):
        """Each warning in Blender's own reports, once; not at every change of a node for its preview."""
        for warning in [] if self.is_preview else warnings:
            self.report({"WARNING"}, warning)


def _message(error):
    """What to tell of an exception: where it is of a bug in the engine, so that it can be found there, too."""
    message = str(error) or type(error).__name__
    if isinstance(error, _MENDABLE):
        return message
    last = traceback.extract_tb(error.__traceback__)[-1:]
    where = "".join(f" ({os.path.basename(frame.filename)}, line {frame.lineno})" for frame in last)
    return f"Penumbra failed, which is a bug in it: {message}{where}"


def _noise(progress):
    """The noise now, at the end, and when it will be what it is to be, as far as that is known."""
    if progress["error"] is None:
        return "Noise not estimable yet"
    text = f"Noise {progress['error']:.2g}"
    if progress["error_at_end"] is not None:
        text += f", {progress['error_at_end']:.2g} at the end"
    if progress["to_target"] is not None:
        _, soonest, latest = progress["to_target"]
        text += f", {progress['error_target']:.2g} in {_clock(soonest)} to {_clock(latest)}"
    return text


def _clock(seconds):
    minutes, seconds = divmod(int(seconds + 0.5), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02d}:{seconds:02d}" if hours else f"{minutes}:{seconds:02d}"


def register():
    bpy.utils.register_class(PenumbraRenderEngine)


def unregister():
    for viewport in VIEWPORTS.values():
        viewport.free()
    VIEWPORTS.clear()
    bpy.utils.unregister_class(PenumbraRenderEngine)
