"""The depsgraph, walked once."""

import json
from types import SimpleNamespace

import bpy
import numpy as np

from .. import passes
from . import camera, edits, images, lights, mesh, nodes, particles, properties, rounds
from .motion import identity_of

# Curves, surfaces, texts and metaballs come as meshes of their own beside them, as instances of an object of the same name.
# Hair curves and point clouds, which are strands and balls.
_ROUNDS = {"CURVES", "POINTCLOUD"}
# Keys have 63 bits.
_KEY = 0x7FFF_FFFF_FFFF_FFFF
_RAYS = ("camera", "diffuse", "glossy", "transmission", "shadow")


class Exporter:
    """Fills an engine's Scene from a depsgraph. One lives as long as its render.

    `stopped` says whether the artist wants no picture any more: KeyboardInterrupt, as the engine itself raises.
    """

    def __init__(self, scene, stopped=lambda: False):
        self.scene, self._stopped = scene, stopped
        self.images = {}
        self.warnings = []
        # Keys of the shapes that the engine has, and of those each object has, by its name.
        self._meshes = set()
        self._shapes_of = {}
        # Keys of the materials that the engine has and that nothing but an edit of theirs makes others of.
        self._known_materials = set()
        self._moves = False
        # Names of the attributes that Attribute nodes ask for, and what they ask of objects.
        self._asked, self._properties = frozenset(), []
        self._handed = edits.Handed()

    def update(self, depsgraph, size, space):
        """Hands over what changed since the last time, for a viewport of `space`."""
        for update in depsgraph.updates:
            self._forget(update)
        few = edits.small(depsgraph.updates, self._handed)
        if few is not None and self._knows_all(few, depsgraph.scene_eval):
            self._hand_over_few(few, depsgraph)
            return
        self.export(depsgraph, size, space=space)
        for key in self._meshes - self._used:
            self.scene.remove_shape(key)
        self._meshes &= self._used

    def _forget(self, update):
        """What an edit makes another of is handed over again."""
        edited = update.id
        if update.is_updated_geometry:
            data = edited.data if isinstance(edited, bpy.types.Object) else edited
            if isinstance(data, (bpy.types.Mesh, bpy.types.Curves, bpy.types.PointCloud)):
                self._meshes.discard(_key(data, self._asked))
            if isinstance(edited, bpy.types.Object):
                # What its meshes of before lay at may be where those of now lie.
                self._meshes -= self._shapes_of.pop(edited.name_full, set())
        if isinstance(edited, bpy.types.Material):
            self._known_materials.discard(edited.original.session_uid)
        elif isinstance(edited, bpy.types.Image):
            # Sequences have one name for each of their files.
            own = edited.name_full
            for name in [name for name in self.images if name == own or name.startswith(f"{own} ")]:
                del self.images[name]
            self._known_materials.clear()
        elif isinstance(edited, bpy.types.NodeTree) and not edited.is_embedded_data:
            # A group is part of any number of materials.
            self._known_materials.clear()

    def _knows_all(self, few, scene):
        """True where no material asks for more than was handed over, no object has values that go by its place, and lamps
        are known by their names alone."""
        if not all(name in scene.objects for name in few.lamps):
            return False
        if not few.materials:
            return not self._properties
        return (nodes.attributes_asked(), nodes.properties_asked()) == (self._asked, self._properties) and not (
            self._properties and few.moved
        )

    def _hand_over_few(self, few, depsgraph):
        """Hands over what is edited and nothing else."""
        # Those of before may be gone.
        self._layer, self._scene = depsgraph.view_layer, depsgraph.scene_eval
        if few.moved:
            for obj in few.moved:
                self._matrices[self._handed.instances[obj.name_full]] = [x for row in obj.matrix_world for x in row]
            self._hand_over_placements()
        for material in few.materials:
            key = material.original.session_uid
            if key in self._material_index:
                self._hand_over_material(key, material)
        if few.materials:
            self.scene.set_materials(self._materials)
        for name in few.lamps:
            obj = self._scene.objects[name]
            lamp = lights.lamp(SimpleNamespace(object=obj, matrix_world=obj.matrix_world), self)
            self._link(lamp, obj)
            self._lights[self._handed.lamps[name]] = lamp
        edited = {"images": self.images}
        if few.lamps:
            edited["lights"] = self._lights
        if few.world and self._world(self._scene) is not None:
            edited["world"] = lights.world(self._world(self._scene), self)
        self.scene.edit_document(self._json(edited))

    def export(self, depsgraph, size, camera_object=None, space=None, motion=None):
        """Hands over everything of `depsgraph` for a picture of `size` pixels; of `space`, what it shows.

        `motion` gathers what moves while the shutter is open, or from frame to frame.
        """
        self._motion = motion
        self._layer = depsgraph.view_layer
        override = self._layer.material_override
        self._override = override and override.evaluated_get(depsgraph)
        self._asked = nodes.attributes_asked()
        self._properties = nodes.properties_asked()
        self._by_instancer = any(kind == "INSTANCER" for kind, _ in self._properties)
        self._scene = depsgraph.scene_eval
        self._render = depsgraph.mode == "RENDER"
        self._materials, self._material_index = [], {}
        self._objects, self._object_index = [], {}
        self._lights = []
        self._links = []
        self._used = set()
        # Names of the modifiers whose hair is a shape.
        self._modifiers = {}
        handed = self._handed = edits.Handed()
        of_instance, matrices, random_ids, lamps = [], [], [], {}
        for instance in depsgraph.object_instances:
            if self._stopped():
                raise KeyboardInterrupt("stopped")
            obj = instance.object
            if not _shown(instance, space):
                continue
            found = []
            if instance.is_instance:
                handed.crowd |= {obj.name_full, instance.parent.name_full}
            if instance.show_self and obj.type == "LIGHT":
                handed.lamps[obj.name_full] = len(self._lights)
                handed.lamps_of.setdefault(obj.data.name_full, set()).add(obj.name_full)
                self._lights.append(lights.lamp(instance, self))
                self._links.append((self._lights[-1], obj))
                if motion is not None:
                    lamps[identity_of(instance)] = self._lights[-1]
            elif instance.show_self and self._is_rendered(obj):
                found += self._object(obj, instance.parent if instance.is_instance else None)
            if self._layer.use_strand and instance.show_particles and obj.type == "MESH" and obj.particle_systems:
                found += self._strands(instance.instance_object if instance.is_instance else obj,
                                       instance.parent if instance.is_instance else None)
            matrix = [x for row in instance.matrix_world for x in row] if found else None
            if motion is not None:
                first, shapes = len(of_instance), [self._objects[index]["mesh"] for index in found]
                indices = range(first, first + len(found))
                motion.note(instance, indices, matrix, [(key, self._modifiers.get(key)) for key in shapes])
            if found:
                first = len(of_instance)
                handed.instances[obj.name_full] = slice(first, first + len(found))
            for index in found:
                of_instance.append(index)
                matrices.append(matrix)
                random_ids.append(instance.random_id & 0xFFFFFFFF if instance.is_instance else 0)
        for data, obj in self._links:
            self._link(data, obj)
        scene = depsgraph.scene_eval
        through = camera_object or scene.camera
        document = {
            "file": bpy.data.filepath,
            "version": list(bpy.app.version),
            "render": {
                **camera.render(scene, size, depsgraph.view_layer_eval),
                "aovs": [[aov.name, aov.type] for aov in passes.aovs(depsgraph.view_layer)],
            },
            "camera": camera.camera(through),
            "world": lights.world(self._world(scene), self),
            "lights": self._lights,
            "images": self.images,
            "objects": self._objects,
        }
        if motion is not None:
            document["render"].update(motion.exposure())
            of_camera = motion.gather(depsgraph, through, lamps)
            if document["camera"] is not None:
                document["camera"].update(motion=of_camera, zoom=motion.zoom)
        self.scene.set_document(self._json(document))
        self.scene.set_materials(self._materials)
        self._known_materials &= set(self._materials)
        self._of_instance, self._random_ids = np.asarray(of_instance, np.uint32), np.asarray(random_ids, np.uint32)
        self._matrices = np.asarray(matrices, np.float32).reshape(-1, 16)
        self._hand_over_placements()
        if motion is not None:
            motion.hand_over(self.scene)
            self.warnings += sorted(motion.warnings)

    def _hand_over_placements(self):
        self.scene.set_instances(self._of_instance, self._matrices.reshape(-1), self._random_ids)

    def _is_rendered(self, obj):
        """True for what has a shape that the view layer's filter lets through."""
        if obj.type == "CURVES":
            return self._layer.use_strand
        return (obj.type == "MESH" or obj.type in _ROUNDS) and self._layer.use_solid

    def _world(self, scene):
        """The view layer's own world, the scene's, or none."""
        if not self._layer.use_sky:
            return None
        override = getattr(self._layer, "world_override", None)
        return scene.world if override is None else override

    def _json(self, document):
        """The document as JSON, which has no NaN and no infinity."""
        try:
            return json.dumps(document, allow_nan=False)
        except ValueError:
            found = {}
            finite = _finite(document, (), found)
            self.warnings += [f"{where}: {', '.join(sorted(names))}: not finite; 0 is used" for where, names in found.items()]
            return json.dumps(finite)

    def _instancer(self, parent):
        """What tells apart the records of one object: what instances it, where materials ask for that."""
        return parent.name_full if self._by_instancer and parent is not None else None

    def _object(self, obj, parent):
        """Index of the object's record; nothing for one without a shape."""
        # Not by the object's address: curves, texts and metaballs come as meshes of one passing object.
        key = (obj.name_full, obj.data.as_pointer(), self._instancer(parent))
        if key in self._object_index:
            return self._object_index[key]
        shape = self._shape(obj)
        found = []
        if shape is not None:
            found.append(self._record(obj, shape, [slot.material for slot in obj.material_slots], parent))
        self._object_index[key] = found
        return found

    def _strands(self, obj, parent):
        """Indices of the records of an object's hair, one for each particle system that has some."""
        key = (obj.name_full, "hair", self._instancer(parent))
        if key not in self._object_index:
            found = self._object_index[key] = []
            for modifier, slot in particles.systems(obj, self._render):
                shape = self._hair_of(obj, modifier)
                if shape is not None:
                    self._modifiers[shape] = modifier.name
                    slots = obj.material_slots
                    # A slot that is not there is the last one.
                    material = slots[min(max(slot, 0), len(slots) - 1)].material if slots else None
                    found.append(self._record(obj, shape, [material], parent))
        return self._object_index[key]

    def _hair_of(self, obj, modifier):
        """Hands over the hair of a particle system once; returns its key, or None where there is none."""
        key = hash((obj.name_full, modifier.name, self._render)) & _KEY
        self._used.add(key)
        if key not in self._meshes:
            if not particles.hand_over(self.scene, key, f"{obj.name}, {modifier.name}", obj, modifier, self._render,
                                       self._motion is not None):
                return None
            self._meshes.add(key)
            self._shapes_of.setdefault(obj.name_full, set()).add(key)
        return key

    def _record(self, obj, shape, materials, parent):
        """Says of an object with one of its shapes, instanced by `parent` or not, what it is; returns the record's index."""
        if self._override is not None:
            materials = [self._override] * max(len(materials), 1)
        for material in materials:
            if material is not None:
                self._handed.users.setdefault(material.original.session_uid, set()).add(obj.name_full)
        top = obj
        while top.parent is not None:
            top = top.parent
        self._objects.append({
            "name": obj.name,
            "asset": top.name,
            "mesh": shape,
            "materials": [self._material(material) for material in materials],
            "pass_index": obj.pass_index,
            "color": list(obj.color),
            "visibility": {**self.visibility(obj), **self._seen_by_camera(obj)},
            "holdout": self._layer_says("holdout_get", obj),
            "shadow_catcher": obj.is_shadow_catcher,
            "terminator": _terminator(obj),
            "lightgroup": obj.lightgroup,
            "attributes": properties.values(self._properties, obj, parent, self._layer, self._scene),
        })
        self._links.append((self._objects[-1], obj))
        return len(self._objects) - 1

    def _shape(self, obj):
        """Hands over the object's mesh once; returns its key, or None where there is nothing to see."""
        key, data = _key(obj.data, self._asked), obj.data
        self._used.add(key)
        self._shapes_of.setdefault(obj.name_full, set()).add(key)
        if key in self._meshes:
            return key
        try:
            if obj.type in _ROUNDS:
                if not rounds.hand_over(self.scene, key, data, self._motion is not None, self._asked):
                    return None
            elif not data.polygons:
                return None
            else:
                mesh.hand_over(self.scene, key, data, self._asked)
        except ValueError as error:
            self.warnings.append(f"{obj.name}: {error}; it is left out")
            return None
        self._meshes.add(key)
        return key

    def _material(self, material):
        if material is None:
            return None
        key = material.original.session_uid
        if key not in self._material_index:
            if key not in self._known_materials:
                self._hand_over_material(key, material)
            self._material_index[key] = len(self._materials)
            self._materials.append(key)
        return self._material_index[key]

    def _hand_over_material(self, key, material):
        data = {
            "name": material.name,
            "pass_index": material.pass_index,
            "diffuse_color": list(material.diffuse_color),
            "displacement_method": _displacement(material),
            "bump_correction": getattr(getattr(material, "cycles", None), "use_bump_map_correction", True),
        }
        self._moves = False
        if material.node_tree is not None and material.use_nodes:
            data["nodes"] = nodes.dump(material.node_tree, self)
        self.scene.set_material(key, self._json(data))
        if not self._moves:
            self._known_materials.add(key)

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
        names = {}
        for i, data in enumerate(self._objects):
            names.setdefault(data["name"], []).append(i)
        included, excluded = set(), set()

        def add(objects, state):
            found = {i for obj in objects for i in names.get(obj.name, ())}
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
        path = images.path_of(image, user)
        name = f"{image.name_full} {path}" if image.source == "SEQUENCE" else image.name_full
        self._moves |= image.source in {"SEQUENCE", "MOVIE"}
        if name not in self.images:
            self.images[name] = images.describe(image, path)
            if self.images[name]["in_memory"]:
                images.hand_over(self.scene, name, image)
            if image.source == "TILED" and image.is_dirty:
                self.warnings.append(f"{image.name}: what is painted on its tiles counts once it is saved, or packed again")
        return name

    def object_matrix(self, obj):
        """World matrix of an object that a node refers to."""
        self._moves = self._handed.refers = True
        return [list(map(float, row)) for row in obj.matrix_world]


def _displacement(material):
    """What becomes of a material's displacement: its own property since 4.1, and Cycles' own in some builds."""
    return getattr(material, "displacement_method", None) or material.cycles.displacement_method


def _key(data, asked):
    """A number for a data-block: its address, which may be that of another one before, and what it holds: the
    attributes that are `asked` for, too.
    """
    counts = (len(data.vertices), len(data.loops), *sorted(asked)) if isinstance(data, bpy.types.Mesh) else ()
    if isinstance(data, (bpy.types.Curves, bpy.types.PointCloud)):
        counts = (len(data.points), *sorted(asked))
    return hash((data.as_pointer(), data.name_full, *counts)) & _KEY


def _shown(instance, space):
    """False for what a viewport in local view, or with collections of its own, does not show."""
    if space is None:
        return True
    obj = instance.parent if instance.is_instance else instance.object
    return obj.original.visible_in_viewport_get(space)


def _finite(value, where, found):
    """`value` with 0 for every number that is not finite.

    `where` it stands are names, the last one that of a property; `found` gets the properties by what they belong to.
    """
    if isinstance(value, dict):
        named = (*where[:-1], value["name"]) if isinstance(value.get("name"), str) else where
        return {key: _finite(item, (*named, key), found) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_finite(item, where, found) for item in value]
    if isinstance(value, float) and not np.isfinite(value):
        *holders, name = where
        found.setdefault(" > ".join(holder for holder in holders if holder != "nodes") or "scene", set()).add(name)
        return 0.0
    return value


def _terminator(obj):
    """How the edge of an object's own shadow is softened: its own property since 4.5, Cycles' before."""
    if hasattr(obj, "shadow_terminator_shading_offset"):
        shading, holder = obj.shadow_terminator_shading_offset, obj
    else:
        holder = getattr(obj, "cycles", None)
        shading = getattr(holder, "shadow_terminator_offset", 0.0)
    return {"geometry": getattr(holder, "shadow_terminator_geometry_offset", 0.1), "shading": shading}
