"""The rendered viewport: a picture that begins coarse, refines, and starts again at every edit."""

import json

import bpy
import gpu
import penumbra
from bpy_extras.view3d_utils import location_3d_to_region_2d
from gpu_extras.presets import draw_texture_2d

from . import loaded, properties
from .export import Exporter, camera

# Seconds between two looks for a new picture.
_POLL = 1.0 / 60.0


class Viewport:
    """What a 3D viewport shows; it lives as long as its engine."""

    def __init__(self, engine):
        self.engine = engine
        self.exporter = Exporter(penumbra.Scene())
        self.render = penumbra.Viewport()
        self.texture = None
        self.place = (0, 0, 1, 1)
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
        """The scene was edited: hands over what changed."""
        loaded.check()
        size = (max(context.region.width, 1), max(context.region.height, 1))
        self.exporter.update(depsgraph, size, context.space_data)
        self.stale = True

    def draw(self, context, depsgraph):
        """Draws the newest picture, and starts another where the view is not the one that it shows."""
        scene = depsgraph.scene
        view = _view(context, depsgraph)
        if self.stale or view != self.view:
            settings = properties.settings(scene, context.view_layer)
            settings.update(passes=["combined"], spp=scene.penumbra.viewport_spp, time=None, error=None, adaptive=False)
            changed, self.stale, self.view = self.stale, False, view
            self.render.show(self.exporter.scene, json.dumps(view), changed, **settings)
        self._tell()
        picture = self.render.picture()
        if picture is not None:
            width, height, pixels, spp = picture
            data = gpu.types.Buffer("FLOAT", width * height * 4, pixels)
            self.texture = gpu.types.GPUTexture((width, height), format="RGBA16F", data=data)
            self.place = _place(view)
            self.engine.update_stats("", f"Sample {spp:.0f}/{scene.penumbra.viewport_spp}")
        if self.texture is not None:
            left, lower, width, height = self.place
            gpu.state.blend_set("ALPHA_PREMULT")
            self.engine.bind_display_space_shader(scene)
            draw_texture_2d(self.texture, (left, lower), width, height)
            self.engine.unbind_display_space_shader()
            gpu.state.blend_set("NONE")

    def _tell(self):
        for warning in [*self.exporter.warnings, *self.render.warnings()]:
            if warning not in self.told:
                self.told.add(warning)
                self.engine.report({"WARNING"}, warning)

    def _poll(self):
        """Runs on Blender's thread; asks for a redraw where there is something new to show."""
        try:
            if self.alive and self.render.has_news():
                self.engine.tag_redraw()
        except ReferenceError:
            # Blender has freed the engine.
            self.free()
        return _POLL if self.alive else None


def _view(context, depsgraph):
    """The view as plain data: matrices and size, and border, lens and panorama of a camera's."""
    region, data, space = context.region, context.region_data, context.space_data
    rows = lambda matrix: [list(row) for row in matrix]
    view = {
        "size": [max(region.width, 1), max(region.height, 1)],
        "matrix": rows(data.view_matrix.inverted()),
        "window": rows(data.window_matrix),
        "orthographic": not data.is_perspective,
        "clip_start": space.clip_start,
        "clip_end": space.clip_end,
    }
    scene = depsgraph.scene
    through = scene.camera if data.view_perspective == "CAMERA" else None
    if view["orthographic"] and through is None:
        # It begins at the point that it turns about, and shows as much before as behind.
        view["clip_end"] *= 0.5
        view["clip_start"] = -view["clip_end"]
    if through is not None and through.type == "CAMERA":
        own = camera.camera(through.evaluated_get(depsgraph))
        frame = _frame(context, through, scene)
        if "panorama" in own and frame is not None:
            view["panorama"] = [own["panorama"], frame]
            # Around it is nothing.
            view["border"] = _rectangle(view["size"], frame)
        view["orthographic"] = own["type"] == "ORTHO"
        view["clip_start"], view["clip_end"] = own["clip_start"], own["clip_end"]
        if "dof" in own:
            view["dof"] = [own["dof"], own["lens"]]
        if scene.render.use_border:
            view["border"] = _camera_border(context, frame, scene.render)
    elif space.use_render_border:
        edges = (space.render_border_min_x, space.render_border_min_y, space.render_border_max_x,
                 space.render_border_max_y)
        view["border"] = _rectangle(view["size"], [edge * view["size"][i % 2] for i, edge in enumerate(edges)])
    if view.get("border", 0) is None:
        del view["border"]
    return view


def _frame(context, obj, scene):
    """Left, lower, right and upper edge of the camera's frame in pixels of the region; None for one that is behind."""
    frame = [obj.matrix_world @ corner for corner in obj.data.view_frame(scene=scene)]
    corners = [location_3d_to_region_2d(context.region, context.region_data, corner) for corner in frame]
    if any(corner is None for corner in corners):
        return None
    return [end(corner[i] for corner in corners) for end in (min, max) for i in (0, 1)]


def _camera_border(context, frame, render):
    """The border within the camera's frame."""
    if frame is None:
        return None
    low, high = frame[:2], frame[2:]
    edges = (render.border_min_x, render.border_min_y, render.border_max_x, render.border_max_y)
    size = (context.region.width, context.region.height)
    return _rectangle(size, [low[i % 2] + edge * (high[i % 2] - low[i % 2]) for i, edge in enumerate(edges)])


def _rectangle(size, edges):
    """Left, top, width and height in whole pixels of what lies within the picture; None for nothing."""
    left, lower, right, upper = (min(max(int(edge), 0), size[i % 2]) for i, edge in enumerate(edges))
    if right <= left or upper <= lower:
        return None
    return [left, size[1] - upper, right - left, upper - lower]


def _place(view):
    """Where the picture of a view is drawn: left, lower edge, width and height."""
    width, height = view["size"]
    if "border" not in view:
        return (0, 0, width, height)
    left, top, w, h = view["border"]
    return (left, height - top - h, w, h)
