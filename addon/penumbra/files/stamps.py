"""Stamps: what the add-on says of a lamp, a camera or the world for a render, to be kept in a file.

They are parts of the document that a render gets (export/), read by the same code in the engine.
"""

import json
import os
import re
from types import SimpleNamespace

import bpy
import numpy as np

from ..export import camera, lights
from ..export.scene import Exporter

# What the engine reads; src/import/blender/stamp.rs has the same.
VERSION = 1


class Stamps(Exporter):
    """Makes the stamps of a file at `path`; images that are in no file are saved beside it."""

    def __init__(self, context, path, unit, animation):
        super().__init__(self)
        self._context, self._scene = context, context.scene
        self._folder = os.path.dirname(os.path.abspath(path))
        self._unit = unit
        self._frames = range(self._scene.frame_start, self._scene.frame_end + 1) if animation else ()
        self._saved = {}

    def all(self):
        """Stamps by the names of their objects, the world's under None."""
        objects = [obj for obj in bpy.data.objects if obj.type in {"LIGHT", "CAMERA"} and obj.data is not None]
        stamps = {obj.name_full: self._stamp(self._of_object, obj) for obj in objects}
        linked = sorted(obj.name for obj in self._scene.objects if _is_linked(obj))
        if linked:
            self.warnings.append(f"light linking is not exported: {', '.join(linked)}")
        if self._scene.world is not None:
            stamps[None] = self._stamp(self._of_world, self._scene.world)
        moving = {obj.name_full: (self._of_object, obj) for obj in objects if _is_animated(obj)}
        if self._scene.world is not None and _is_animated(self._scene.world):
            moving[None] = (self._of_world, self._scene.world)
        if moving and self._frames:
            self._animate(stamps, moving)
        return stamps

    def text(self, stamp):
        """A stamp as text."""
        return self._json(stamp)

    def plain(self, stamp):
        """A stamp as dicts and lists of finite numbers."""
        return json.loads(self._json(stamp))

    def _stamp(self, read, source):
        self.images = {}
        stamp = {"version": VERSION, "blender": list(bpy.app.version), "fps": _fps(self._scene), "unit": self._unit}
        stamp.update(read(source))
        if self.images:
            stamp["images"] = self.images
        return stamp

    def _animate(self, stamps, moving):
        """Adds to `stamps` what differs at each frame."""
        now, part = self._scene.frame_current, self._scene.frame_subframe
        try:
            for frame in self._frames:
                self._scene.frame_set(frame)
                for name, (read, source) in moving.items():
                    changes = _difference(stamps[name], self._stamp(read, source))
                    frames = stamps[name].setdefault("frames", [])
                    # What was so at the frame before needs no word.
                    if (frames[-1]["changes"] if frames else {}) != changes:
                        frames.append({"frame": frame, "changes": changes})
        finally:
            self._scene.frame_set(now, subframe=part)

    def _of_object(self, obj):
        evaluated = obj.evaluated_get(self._context.evaluated_depsgraph_get())
        if obj.type == "LIGHT":
            return {"light": lights.lamp(SimpleNamespace(object=evaluated, matrix_world=evaluated.matrix_world), self)}
        render = self._scene.render
        scale = render.resolution_percentage / 100.0
        size = [max(int(n * scale), 1) for n in (render.resolution_x, render.resolution_y)]
        return {
            "camera": camera.camera(evaluated),
            "render": camera.render(self._scene, size, self._context.view_layer),
            "active": obj == self._scene.camera,
        }

    def _of_world(self, world):
        return {"world": lights.world(world.evaluated_get(self._context.evaluated_depsgraph_get()), self)}

    # Images, for `Exporter`.

    def image(self, image, user):
        """Takes in an image; returns the name that nodes know it by."""
        name = super().image(image, user)
        record = self.images[name]
        if record["in_memory"]:
            record.update(path=self._saved.get(name, ""), in_memory=False)
        if os.path.isabs(record["path"]):
            record["path"] = self._relative(record["path"])
        return name

    def set_image_bytes(self, name, data, tile=None):
        """Saves a packed file, or a tile's."""
        extension = os.path.splitext(self.images[name]["path"])[1] or _extension(data)
        path = self._file(name, extension if tile is None else f".<UDIM>{extension}")
        with open(path.replace("<UDIM>", str(tile)), "wb") as file:
            file.write(data)

    def set_image_pixels(self, name, width, height, pixels, is_float):
        """Saves what was made or painted in Blender."""
        path = self._file(name, ".exr" if is_float else ".png")
        copy = bpy.data.images.new("penumbra", width, height, alpha=True, float_buffer=is_float)
        try:
            # Floats are linear whatever the image says, and are saved as they are.
            copy.colorspace_settings.name = "Non-Color" if is_float else self.images[name]["colorspace"]
            copy.alpha_mode = self.images[name]["alpha_mode"]
            copy.pixels.foreach_set(np.ascontiguousarray(pixels, np.float32))
            copy.file_format = "OPEN_EXR" if is_float else "PNG"
            copy.filepath_raw = path
            copy.save()
        finally:
            bpy.data.images.remove(copy)

    def _file(self, name, extension):
        """Path of a new file in textures/."""
        folder = os.path.join(self._folder, "textures")
        os.makedirs(folder, exist_ok=True)
        plain = re.sub(r"[^\w.-]+", "_", os.path.splitext(name)[0]) or "image"
        taken = {path for known, path in self._saved.items() if known != name}
        path, count = os.path.join(folder, plain + extension), 1
        while path in taken:
            path, count = os.path.join(folder, f"{plain}_{count}{extension}"), count + 1
        self._saved[name] = path
        return path

    def _relative(self, path):
        """`path` from the file's folder, where there is a way."""
        try:
            return os.path.relpath(path, self._folder).replace(os.sep, "/")
        except ValueError:
            # Another drive of Windows.
            return path


def _is_linked(obj):
    linking = getattr(obj, "light_linking", None)
    return linking is not None and (linking.receiver_collection or linking.blocker_collection) is not None


def _fps(scene):
    return scene.render.fps / scene.render.fps_base


def _extension(data):
    """Of a file without a name, by its first bytes."""
    known = ((b"\x89PNG", ".png"), (b"\xff\xd8", ".jpg"), (b"v/1\x01", ".exr"), (b"#?", ".hdr"), (b"II*", ".tif"))
    return next((extension for start, extension in known if bytes(data[:4]).startswith(start)), ".png")


def _is_animated(source):
    """True where what a stamp says may change from frame to frame; where an object stands is not of it."""
    data = source.data if isinstance(source, bpy.types.Object) else source
    dof = getattr(data, "dof", None)
    if dof is not None and dof.use_dof and dof.focus_object is not None:
        return True
    holders = [data, getattr(data, "node_tree", None)]
    holders += [node.node_tree for node in getattr(holders[1], "nodes", ()) if getattr(node, "node_tree", None)]
    return any(getattr(holder, "animation_data", None) is not None for holder in holders)


def _difference(before, after):
    """What of `after` is not in `before`: dicts key by key, anything else as a whole."""
    changes = {}
    for key, value in after.items():
        old = before.get(key)
        if key == "matrix" or old == value:
            continue
        both = isinstance(value, dict) and isinstance(old, dict)
        changes[key] = _difference(old, value) if both else value
    return {key: value for key, value in changes.items() if value != {}}
