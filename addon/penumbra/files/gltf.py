"""glTF: stamps are an extension that the exporter's hooks add to nodes and the scene.

The exporter finds the hooks by the class of the add-on's module; they do nothing but in our own exports.
"""

import math
import os
from contextlib import contextmanager

import bpy

from .options import supported
from .stamps import Stamps

_NAME = "PENUMBRA_blender"
_ADDON = __package__.rpartition(".")[0]
_running = None


class _Export:
    """An export that runs: stamps by name, and what went wrong in the hooks, which keep it to themselves."""

    def __init__(self, stamps):
        self.stamps, self.errors, self.called = stamps, [], False


class glTF2ExportUserExtension:  # noqa: N801 (the exporter's name)
    """The exporter's hooks."""

    def __init__(self):
        from io_scene_gltf2.io.com.gltf2_io_extensions import Extension

        self._extension = Extension

    def gather_node_hook(self, node, obj, _settings):
        """A node was made of `obj`."""
        if obj is not None and _running is not None and getattr(obj, "type", None) in {"LIGHT", "CAMERA"}:
            self._add(node, obj.original.name_full)

    def gather_scene_hook(self, scene, _blender_scene, _settings):
        """The scene was made."""
        if _running is not None:
            _running.called = True
            self._add(scene, None)

    def _add(self, element, name):
        stamp = _running.stamps.get(name)
        if stamp is None:
            return
        try:
            if element.extensions is None:
                element.extensions = {}
            element.extensions[_NAME] = self._extension(name=_NAME, extension=stamp, required=False)
        except Exception as error:  # noqa: BLE001
            _running.errors.append(f"{name or 'world'}: {error}")


def write(context, path, selected, animation, instancing):
    """Exports to `path`; returns what is to be told."""
    global _running
    exporter = bpy.ops.export_scene.gltf
    stamps = Stamps(context, path, 1.0, animation)
    deformed = any(getattr(obj.data, "shape_keys", None) for obj in context.scene.objects)
    if deformed and any(obj.modifiers for obj in context.scene.objects):
        stamps.warnings.append("there are shape keys, which glTF can't have together with applied modifiers: "
                               "modifiers other than armatures are left out")
    options = supported(
        exporter,
        filepath=path,
        check_existing=False,
        export_format="GLB" if os.path.splitext(path)[1].lower() == ".glb" else "GLTF_SEPARATE",
        use_selection=selected,
        use_renderable=True,
        use_active_scene=True,
        export_animations=animation,
        export_gpu_instances=instancing,
        export_gn_mesh=True,
        export_apply=not deformed,
        export_lights=True,
        export_cameras=True,
        export_extras=True,
        export_yup=True,
        export_import_convert_lighting_mode="SPEC",
        gltf_export_id="penumbra",
    )
    _running = _Export({name: stamps.plain(stamp) for name, stamp in stamps.all().items()})
    try:
        with _enabled(), _mended_lamps():
            if "FINISHED" not in exporter(**options):
                raise RuntimeError(f"Blender's glTF exporter did not write {path}")
        if not _running.called:
            raise RuntimeError("Blender's glTF exporter did not ask Penumbra: area lamps, the world and more are missing")
        if _running.errors:
            raise RuntimeError(f"can't stamp {'; '.join(_running.errors)}")
    finally:
        _running = None
    return stamps.warnings


@contextmanager
def _enabled():
    """The exporter asks add-ons of the preferences; one that a script enabled need not be there."""
    addons = bpy.context.preferences.addons
    if _ADDON in addons:
        yield
        return
    entry = addons.new()
    entry.module = _ADDON
    try:
        yield
    finally:
        addons.remove(entry)


@contextmanager
def _mended_lamps():
    """Blender 5.0 can't export lamps with a temperature or that are not normalized: a copy that is alike in
    glTF stands for them."""
    try:
        from io_scene_gltf2.blender.exp import lights as lamps

        original = lamps.gather_lights_punctual
    except (ImportError, AttributeError):
        original = None
    if bpy.app.version < (5, 0, 0) or original is None:
        yield
        return
    copies = []

    def gather(lamp, matrix, settings):
        if lamp.normalize and not lamp.use_temperature:
            return original(lamp, matrix, settings)
        copy = lamp.copy()
        copies.append(copy)
        light = original(_alike(copy), matrix, settings)
        return light if light is None else {**light, "name": lamp.name}

    lamps.gather_lights_punctual = gather
    try:
        yield
    finally:
        lamps.gather_lights_punctual = original
        for copy in copies:
            bpy.data.lights.remove(copy)


def _alike(lamp):
    """Makes `lamp` the same light in what the exporter can read (see src/import/blender/light.rs)."""
    if lamp.use_temperature:
        lamp.color = [a * b for a, b in zip(lamp.color, lamp.temperature_color)]
        lamp.use_temperature = False
    if not lamp.normalize:
        radius = lamp.shadow_soft_size if lamp.type in {"POINT", "SPOT"} else 0.0
        if lamp.type == "SUN":
            lamp.energy *= math.pi * math.sin(0.5 * lamp.angle) ** 2 if lamp.angle > 0.0 else 1.0
        else:
            lamp.energy *= 4.0 * math.pi * radius**2 if radius > 0.0 else 4.0
        lamp.normalize = True
    return lamp
