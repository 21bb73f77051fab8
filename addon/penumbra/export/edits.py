"""Which edits of a scene that was handed over are small: what they change is handed over without a look at the rest."""

from dataclasses import dataclass, field

import bpy


@dataclass
class Handed:
    """What there is to know of a scene that was handed over."""

    # Indices of the instances of each object, and of each lamp among the lamps, by name.
    instances: dict = field(default_factory=dict)
    lamps: dict = field(default_factory=dict)
    # Names of the lamps of each light, by its own.
    lamps_of: dict = field(default_factory=dict)
    # Names of what is instanced and of what instances it.
    crowd: set = field(default_factory=set)
    # Names of the objects of each material, by its key.
    users: dict = field(default_factory=dict)
    # True where nodes go by the place of some object.
    refers: bool = False


@dataclass
class Edits:
    """Evaluated data-blocks that were edited, as far as the picture shows it."""

    moved: list = field(default_factory=list)
    # Names of lamps.
    lamps: set = field(default_factory=set)
    materials: list = field(default_factory=list)
    world: bool = False


def small(updates, handed):
    """The edits behind a depsgraph's `updates` where they are small; None where all has to be looked at."""
    found, shaded = Edits(), set()
    for update in updates:
        edited = update.id
        if isinstance(edited, bpy.types.Object):
            name = edited.name_full
            is_more = update.is_updated_transform and (handed.refers or name in handed.crowd)
            # Sizes of a lamp are its geometry.
            if is_more or (update.is_updated_geometry and name not in handed.lamps):
                return None
            if name in handed.lamps:
                found.lamps.add(name)
                continue
            if update.is_updated_transform and name in handed.instances:
                found.moved.append(edited)
            if update.is_updated_shading:
                shaded.add(name)
        elif isinstance(edited, bpy.types.Material):
            found.materials.append(edited)
        elif isinstance(edited, bpy.types.Light):
            found.lamps |= handed.lamps_of.get(edited.name_full, set())
        elif isinstance(edited, bpy.types.World):
            found.world = True
        elif isinstance(edited, bpy.types.NodeTree):
            if not edited.is_embedded_data:
                return None
        elif update.is_updated_geometry or not isinstance(edited, (bpy.types.Camera, bpy.types.Mesh)):
            # A viewport has a view instead of cameras, and meshes are told to look different with their materials.
            return None
    # Blender says of each object with an edited material that it looks different.
    for material in found.materials:
        shaded -= handed.users.get(material.original.session_uid, set())
    if found.lamps & handed.crowd:
        return None
    is_any = found.moved or found.lamps or found.materials or found.world
    return found if is_any and not shaded else None
