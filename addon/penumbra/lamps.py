"""Shadow and decay of a scene's lamps: panels, and what they call.

Lamps shine with the inverse square of the distance. Other decays are nodes of the lamp, as in Cycles: its Light Falloff.
"""

import bpy

from .ui import Panel

DECAYS = (
    ("QUADRATIC", "Quadratic", "With the inverse square of the distance, as light does"),
    ("LINEAR", "Linear", "With the inverse distance; as bright as with Quadratic at one metre"),
    ("CONSTANT", "Constant", "As bright at any distance as with Quadratic at one metre"),
)
_NAMES = {"NONE": "None, as far as it is", "NODES": "By nodes", **{key: name for key, name, _ in DECAYS}}
# More lamps than that are no list to read.
_ROWS = 32
# How large a lamp is, which is how soft its shadow.
_SIZES = {"POINT": "shadow_soft_size", "SPOT": "shadow_soft_size", "SUN": "angle", "AREA": "size"}


def decay_of(light):
    """One of DECAYS; NONE for suns, NODES where the lamp's nodes go by the distance in a way of their own."""
    if light.type == "SUN":
        return "NONE"
    tree = light.node_tree if light.use_nodes else None
    if tree is None:
        return "QUADRATIC"
    strength = _strength(tree)
    source = strength.links[0] if strength is not None and strength.is_linked else None
    if source is not None and source.from_node.type == "LIGHT_FALLOFF":
        return source.from_socket.identifier.upper()
    return "NODES" if _goes_by_distance(tree) else "QUADRATIC"


def set_decay(light, decay):
    """Makes it one of DECAYS; ValueError for a lamp whose light is no Emission node's."""
    if light.type == "SUN":
        raise ValueError(f"{light.name} is a sun: its light is the same at any distance")
    light.use_nodes = True
    tree = light.node_tree
    strength = _strength(tree)
    if strength is None:
        raise ValueError(f"the light of {light.name} is not that of one Emission node: set the decay in its nodes")
    source = strength.links[0] if strength.is_linked else None
    if source is not None and source.from_node.type == "LIGHT_FALLOFF":
        falloff = source.from_node
    else:
        falloff = tree.nodes.new("ShaderNodeLightFalloff")
        emission = strength.node
        falloff.location = (emission.location.x - 200.0, emission.location.y - 100.0)
        falloff.inputs["Strength"].default_value = strength.default_value
        if source is not None:
            tree.links.new(source.from_socket, falloff.inputs["Strength"])
    tree.links.new(falloff.outputs[decay.capitalize()], strength)


def _strength(tree):
    """The socket of the Emission node that is all of the lamp's light; None where there is no such node."""
    output = next((node for node in tree.nodes if node.type == "OUTPUT_LIGHT" and node.is_active_output), None)
    link = output.inputs["Surface"].links[0] if output is not None and output.inputs["Surface"].is_linked else None
    return link.from_node.inputs["Strength"] if link is not None and link.from_node.type == "EMISSION" else None


def _goes_by_distance(tree):
    for node in tree.nodes:
        inner = getattr(node, "node_tree", None)
        if node.type == "LIGHT_FALLOFF" or (inner is not None and _goes_by_distance(inner)):
            return True
        if node.type == "LIGHT_PATH" and node.outputs["Ray Length"].is_linked:
            return True
    return False


def _of_scene(scene):
    """The lights of a scene's lamps, each once, by name."""
    return sorted({obj.data for obj in scene.objects if obj.type == "LIGHT"}, key=lambda light: light.name_full)


class PENUMBRA_OT_light_decay(bpy.types.Operator):
    """How the light of a lamp grows weaker with the distance"""

    bl_idname = "penumbra.light_decay"
    bl_label = "Set Decay"
    bl_options = {"REGISTER", "UNDO"}

    light: bpy.props.StringProperty(name="Light", options={"HIDDEN"})
    decay: bpy.props.EnumProperty(name="Decay", items=DECAYS)

    def execute(self, _context):
        light = bpy.data.lights.get(self.light)
        if light is None or not light.is_editable:
            self.report({"ERROR"}, f"no light \"{self.light}\" that can be edited")
            return {"CANCELLED"}
        try:
            set_decay(light, self.decay)
        except ValueError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return {"FINISHED"}


class PENUMBRA_OT_terminator_to_selected(bpy.types.Operator):
    """Give the active object's shadow terminator to all selected objects"""

    bl_idname = "penumbra.terminator_to_selected"
    bl_label = "Copy to Selected"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return context.object is not None and bool(_terminator(context.object))

    def execute(self, context):
        for obj in context.selected_objects:
            for (holder, name), (own, _) in zip(_terminator(obj), _terminator(context.object)):
                setattr(holder, name, getattr(own, name))
        return {"FINISHED"}


def _terminator(obj):
    """Holders and names of the object's two values: its own properties since 4.5, Cycles' before."""
    names = ("shadow_terminator_geometry_offset", "shadow_terminator_shading_offset")
    if all(hasattr(obj, name) for name in names):
        return [(obj, name) for name in names]
    old = getattr(obj, "cycles", None)
    names = ("shadow_terminator_geometry_offset", "shadow_terminator_offset")
    return [(old, name) for name in names] if all(hasattr(old, name) for name in names) else []


class PENUMBRA_PT_shadow(Panel, bpy.types.Panel):
    bl_label = "Shadow"
    bl_context = "render"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout, layer = self._split(), context.view_layer.penumbra
        layout.prop(context.scene.penumbra, "light_samples", text="Samples")
        column = layout.column(heading="Passes", align=True)
        column.prop(layer, "use_pass_shadow", text="Shadow")
        column.prop(layer, "use_pass_unshadowed", text="Diffuse Direct Unshadowed")
        column.prop(layer, "use_pass_error_shadow", text="Error of Shadow")


class _Lamps(Panel):
    """A row for each lamp of the scene."""

    def draw(self, context):
        column, lights = self.layout.column(align=True), _of_scene(context.scene)
        for light in lights[:_ROWS]:
            line = column.split(factor=0.4, align=True)
            line.label(text=light.name, icon=f"LIGHT_{light.type}")
            line = line.row(align=True)
            line.enabled = light.is_editable
            self._row(line, light)
        if len(lights) > _ROWS:
            column.label(text=f"and {len(lights) - _ROWS} more")
        if not lights:
            column.label(text="The scene has no lamps", icon="INFO")


class PENUMBRA_PT_shadow_lamps(_Lamps, bpy.types.Panel):
    bl_label = "Lamps"
    bl_context = "render"
    bl_parent_id = "PENUMBRA_PT_shadow"

    def _row(self, line, light):
        line.prop(light, "use_shadow", text="")
        line.prop(light, _SIZES[light.type], text="Angle" if light.type == "SUN" else "Size")


class PENUMBRA_PT_shadow_terminator(Panel, bpy.types.Panel):
    bl_label = "Terminator"
    bl_context = "render"
    bl_parent_id = "PENUMBRA_PT_shadow"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout, obj = self._split(), context.object
        rows = _terminator(obj) if obj is not None and obj.type != "LIGHT" else []
        if not rows:
            layout.label(text="Of the active object, which is none", icon="INFO")
            return
        layout.label(text=obj.name, icon="OBJECT_DATA")
        column = layout.column(align=True)
        for (holder, name), text in zip(rows, ("Geometry Offset", "Shading Offset")):
            column.prop(holder, name, text=text)
        layout.operator("penumbra.terminator_to_selected")


class PENUMBRA_PT_decay(_Lamps, bpy.types.Panel):
    bl_label = "Decay"
    bl_context = "render"
    bl_options = {"DEFAULT_CLOSED"}

    def _row(self, line, light):
        decay = decay_of(light)
        if decay == "NONE":
            line.label(text=_NAMES[decay])
        else:
            line.operator_menu_enum("penumbra.light_decay", "decay", text=_NAMES[decay]).light = light.name


PANELS = (PENUMBRA_PT_shadow, PENUMBRA_PT_shadow_lamps, PENUMBRA_PT_shadow_terminator, PENUMBRA_PT_decay)
OPERATORS = (PENUMBRA_OT_light_decay, PENUMBRA_OT_terminator_to_selected)


def register():
    for operator in OPERATORS:
        bpy.utils.register_class(operator)


def unregister():
    for operator in reversed(OPERATORS):
        bpy.utils.unregister_class(operator)
