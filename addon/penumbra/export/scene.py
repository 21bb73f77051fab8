"""The depsgraph, walked once."""

import json
import os

import bpy
import numpy as np

from . import camera, lights, mesh, nodes, rounds

# Types of objects that evaluate to a mesh.
_MESHES = {"MESH", "CURVE", "SURFACE", "FONT", "META"}
# Hair curves and point clouds, which are strands and balls.
_ROUNDS = {"CURVES", "POINTCLOUD"}
_RAYS = ("camera", "diffuse", "glossy", "transmission", "shadow")


class Exporter:
    """Fills an engine's Scene from a depsgraph. One lives as long as its render."""

    def __init__(self, scene):
        self.scene = scene
        self.images = {}
        self.warnings = []
        self._meshes = set()

    def update(self, depsgraph, size, space):
        """Hands over what changed since the last time, for a viewport of `space`."""
        for update in depsgraph.updates:
            if update.is_updated_geometry:
                data = update.id.data if isinstance(update.id, bpy.types.Object) else update.id
                if isinstance(data, (bpy.types.Mesh, bpy.types.Curves, bpy.types.PointCloud)):
                    self._meshes.discard(_key(data))
        self.export(depsgraph, size, space=space)
        for key in self._meshes - self._used:
            self.scene.remove_shape(key)
        self._meshes &= self._used

    def export(self, depsgraph, size, camera_object=None, space=None):
        """Hands over everything of `depsgraph` for a picture of `size` pixels; of `space`, what it shows."""
        self._layer = depsgraph.view_layer
        self._materials, self._material_index = [], {}
        self._objects, self._object_index = [], {}
        self._lights = []
        self._links = []
        self._used = set()
        of_instance, matrices, random_ids = [], [], []
        for instance in depsgraph.object_instances:
            obj = instance.object
            if not instance.show_self or not _shown(instance, space):
                continue
            if obj.type == "LIGHT":
                self._lights.append(lights.lamp(instance, self))
                self._links.append((self._lights[-1], obj))
            elif obj.type in _MESHES or obj.type in _ROUNDS:
                index = self._object(obj, instance)
                if index is not None:
                    of_instance.append(index)
                    matrices.append([x for row in instance.matrix_world for x in row])
                    random_ids.append(instance.random_id & 0xFFFFFFFF if instance.is_instance else 0)
        for data, obj in self._links:
            self._link(data, obj)
        scene = depsgraph.scene_eval
        document = {
            "file": bpy.data.filepath,
            "version": list(bpy.app.version),
            "render": camera.render(scene, size, depsgraph.view_layer_eval),
            "camera": camera.camera(camera_object or scene.camera, scene),
            "world": lights.world(scene.world, self),
            "lights": self._lights,
            "materials": self._materials,
            "images": self.images,
            "objects": self._objects,
        }
        self.scene.set_document(self._json(document))
        matrices = np.asarray(matrices, np.float32).reshape(-1)
        self.scene.set_instances(np.asarray(of_instance, np.uint32), matrices, np.asarray(random_ids, np.uint32))

    def _json(self, document):
        """The document as JSON, which has no NaN and no infinity."""
        try:
            return json.dumps(document, allow_nan=False)
        except ValueError:
            self.warnings.append("some properties are not finite numbers; 0 is used for them")
            return json.dumps(_finite(document))

    def _object(self, obj, instance):
        """Index of the object's record; None for one without a shape."""
        # Not by the object's address: curves, texts and metaballs come as meshes of one passing object.
        key = (obj.name_full, obj.data.as_pointer())
        if key in self._object_index:
            return self._object_index[key]
        shape = self._shape(obj)
        index = None
        if shape is not None:
            top = obj
            while top.parent is not None:
                top = top.parent
            index = len(self._objects)
            self._objects.append({
                "name": obj.name,
                "asset": top.name,
                "mesh": shape,
                "materials": [self._material(slot.material) for slot in obj.material_slots],
                "pass_index": obj.pass_index,
                "color": list(obj.color),
                "visibility": {**self.visibility(obj), **self._seen_by_camera(obj)},
                "holdout": self._layer_says("holdout_get", obj),
                "shadow_catcher": obj.is_shadow_catcher,
                "lightgroup": obj.lightgroup,
            })
            self._links.append((self._objects[-1], obj))
        self._object_index[key] = index
        return index

    def _shape(self, obj):
        """Hands over the object's mesh once; returns its key, or None where there is nothing to see."""
        own = obj.type == "MESH" or obj.type in _ROUNDS
        key = _key(obj.data)
        self._used.add(key)
        if key in self._meshes:
            return key
        data = obj.data if own else obj.to_mesh()
        try:
            if obj.type in _ROUNDS:
                if not rounds.hand_over(self.scene, key, data):
                    return None
            elif data is None or not data.polygons:
                return None
            else:
                mesh.hand_over(self.scene, key, data)
        except ValueError as error:
            self.warnings.append(f"{obj.name}: {error}; it is left out")
            return None
        finally:
            if not own:
                obj.to_mesh_clear()
        self._meshes.add(key)
        return key

    def _material(self, material):
        if material is None:
            return None
        key = material.as_pointer()
        if key not in self._material_index:
            data = {
                "name": material.name,
                "pass_index": material.pass_index,
                "diffuse_color": list(material.diffuse_color),
            }
            if material.node_tree is not None and material.use_nodes:
                data["nodes"] = nodes.dump(material.node_tree, self)
            self._material_index[key] = len(self._materials)
            self._materials.append(data)
        return self._material_index[key]

    def visibility(self, obj):
        """Which rays see an object."""
        return {ray: getattr(obj, f"visible_{ray}") for ray in _RAYS}

    def _seen_by_camera(self, obj):
        """Objects of collections that only light others are not."""
        return {"camera": False} if self._layer_says("indirect_only_get", obj) else {}

    def _layer_says(self, question, obj):
        """What the view layer says of an object: by itself or by its collections."""
        ask = getattr(obj.original, question, None)
        return bool(ask(view_layer=self._layer)) if ask is not None else False

    def _link(self, data, obj):
        """Light and shadow linking, as indices of objects."""
        linking = getattr(obj, "light_linking", None)
        for name, collection in (
            ("receivers", getattr(linking, "receiver_collection", None)),
            ("blockers", getattr(linking, "blocker_collection", None)),
        ):
            if collection is not None:
                data[name] = self._link_set(collection)

    def _link_set(self, collection):
        names = {data["name"]: i for i, data in enumerate(self._objects)}
        included, excluded = set(), set()

        def add(objects, state):
            found = {names[obj.name] for obj in objects if obj.name in names}
            (included if state == "INCLUDE" else excluded).update(found)

        for item, obj in zip(collection.collection_objects, collection.objects):
            add([obj], item.light_linking.link_state)
        for item, child in zip(collection.collection_children, collection.children):
            add(child.all_objects, item.light_linking.link_state)
        if included:
            return {"objects": sorted(included - excluded), "exclude": False}
        return {"objects": sorted(excluded), "exclude": True}

    def image(self, image, user):
        """Takes in an image; returns the name that nodes know it by."""
        path = ""
        if image.source in {"FILE", "SEQUENCE", "MOVIE", "TILED"}:
            raw = image.filepath_from_user(image_user=user) if image.source == "SEQUENCE" and user else image.filepath_raw
            path = os.path.normpath(bpy.path.abspath(raw, library=image.library)) if raw else ""
        name = f"{image.name_full} {path}" if image.source == "SEQUENCE" else image.name_full
        if name in self.images:
            return name
        in_memory = image.packed_file is not None or image.source == "GENERATED" or image.is_dirty
        self.images[name] = {
            "path": path,
            "colorspace": image.colorspace_settings.name,
            "alpha_mode": image.alpha_mode,
            "tiles": [tile.number for tile in image.tiles] if image.source == "TILED" else [],
            "in_memory": in_memory,
        }
        if image.packed_file is not None and not image.is_dirty:
            self.scene.set_image_bytes(name, image.packed_file.data)
        elif in_memory:
            width, height = image.size
            pixels = np.empty(width * height * 4, np.float32)
            if image.channels == 4:
                image.pixels.foreach_get(pixels)
            else:
                raw = np.empty(width * height * image.channels, np.float32)
                image.pixels.foreach_get(raw)
                raw = raw.reshape(-1, image.channels)
                pixels = pixels.reshape(-1, 4)
                pixels[:] = 1.0
                pixels[:, :3] = raw[:, :3] if image.channels >= 3 else raw[:, :1]
            self.scene.set_image_pixels(name, width, height, pixels.reshape(-1), image.is_float)
        return name


def _key(data):
    """A number for a data-block: its address, which may be that of another one before, and what it holds."""
    counts = (len(data.vertices), len(data.loops)) if isinstance(data, bpy.types.Mesh) else ()
    if isinstance(data, (bpy.types.Curves, bpy.types.PointCloud)):
        counts = (len(data.points),)
    return hash((data.as_pointer(), data.name_full, *counts)) & 0x7FFF_FFFF_FFFF_FFFF


def _shown(instance, space):
    """False for what a viewport in local view, or with collections of its own, does not show."""
    if space is None:
        return True
    obj = instance.parent if instance.is_instance else instance.object
    return obj.original.visible_in_viewport_get(space)


def _finite(value):
    """`value` with 0 for every number that is not finite."""
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_finite(item) for item in value]
    if isinstance(value, float) and not np.isfinite(value):
        return 0.0
    return value
