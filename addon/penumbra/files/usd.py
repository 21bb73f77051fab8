"""USD: stamps are custom properties of objects while Blender's exporter runs."""

from contextlib import contextmanager

import bpy

from ..export.motion import Motion
from .options import supported
from .stamps import Stamps

# The exporter writes names that hold a colon as they are.
_LIGHT = "userProperties:penumbra:light"
_CAMERA = "userProperties:penumbra:camera"
_WORLD = "userProperties:penumbra:world"
# The world has no prim of its own: that of an empty, which shows nothing.
_EMPTY = "penumbra_world"


def write(context, path, selected, animation, instancing):
    """Exports to `path`; returns what is to be told."""
    exporter = bpy.ops.wm.usd_export
    options = supported(
        exporter,
        filepath=path,
        check_existing=False,
        selected_objects_only=selected,
        export_animation=animation,
        use_instancing=instancing,
        export_custom_properties=True,
        author_blender_name=True,
        export_lights=True,
        export_cameras=True,
        convert_world_material=True,
        export_hair=True,
        export_materials=True,
        generate_preview_surface=True,
        generate_materialx_network=True,
        evaluation_mode="RENDER",
    )
    # Blender 4.2 takes its own unit for the file's, as long as that may be.
    unit = 1.0 if supported(exporter, meters_per_unit=1.0) else context.scene.unit_settings.scale_length
    stamps = Stamps(context, path, unit, animation)
    stamps.warnings += _lost(context, instancing)
    with _stamped(context, stamps):
        if "FINISHED" not in exporter(**options):
            raise RuntimeError(f"Blender's USD exporter did not write {path}")
    if animation and context.scene.render.use_motion_blur and context.scene.render.motion_blur_shutter > 0.0:
        stamps.warnings += _add_shutter(path, Motion(context.scene, None, None).shutter)
    return stamps.warnings


def _add_shutter(path, times):
    """Gives all cameras the shutter, which Blender's exporter leaves out, and has no place for among custom properties."""
    if path.lower().endswith(".usdz"):
        return ["the shutter of the cameras is not exported to .usdz: nothing is blurred there"]
    try:
        from pxr import Usd, UsdGeom
    except ImportError:
        return ["this Blender has no pxr, without which the shutter of the cameras is not exported: nothing is blurred there"]
    stage = Usd.Stage.Open(path)
    for prim in stage.Traverse():
        if prim.IsA(UsdGeom.Camera):
            camera = UsdGeom.Camera(prim)
            camera.CreateShutterOpenAttr(times[0])
            camera.CreateShutterCloseAttr(times[1])
    stage.Save()
    return []


def _lost(context, instancing):
    """What Blender's exporter does to instances of geometry nodes, which nothing here can mend."""
    by_nodes, own = set(), set()
    for instance in context.evaluated_depsgraph_get().object_instances:
        parent = instance.parent if instance.is_instance else None
        if parent is not None and any(modifier.type == "NODES" for modifier in parent.modifiers):
            is_own = instance.instance_object is None or instance.instance_object.name == parent.name
            (own if is_own else by_nodes).add(parent.name)
    if own:
        yield (f"{', '.join(sorted(own))}: instances of geometry that is no object's are empty in USD files of Blender; "
               "use Realize Instances or the As Instance of Object Info, or export glTF")
    if instancing and by_nodes and bpy.app.version >= (4, 3):
        yield (f"{', '.join(sorted(by_nodes))}: with Instancing, Blender writes instances of geometry nodes twice; "
               "export without it")


@contextmanager
def _stamped(context, stamps):
    """Stamps on all lamps, cameras and the world; nothing is left of them afterwards."""
    marked, empty = [], None
    try:
        for name, stamp in stamps.all().items():
            if name is None:
                empty = bpy.data.objects.new(_EMPTY, None)
                context.scene.collection.objects.link(empty)
                empty.select_set(True)
                empty[_WORLD] = stamps.text(stamp)
                continue
            obj = _object(name)
            key = _LIGHT if "light" in stamp else _CAMERA
            marked.append((obj, key, obj.get(key)))
            obj[key] = stamps.text(stamp)
        yield
    finally:
        for obj, key, before in marked:
            if before is None:
                obj.pop(key, None)
            else:
                obj[key] = before
        if empty is not None:
            bpy.data.objects.remove(empty)


def _object(full_name):
    return next(obj for obj in bpy.data.objects if obj.name_full == full_name)
