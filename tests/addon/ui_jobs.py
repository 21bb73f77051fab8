"""What an artist sees beside pictures: panels, the progress line, messages, and what an edit or Esc takes."""

import os
import time

import bpy

from jobs import _add, _lamp, _render, _room, _scene, _Viewport


class _Layout:
    """Stands in for a panel's layout: notes what is in it."""

    def __init__(self, rows=None):
        self.__dict__["rows"] = [] if rows is None else rows

    def label(self, text, icon="NONE"):
        self.rows.append(text)

    def prop(self, holder, name, text=""):
        assert holder.bl_rna.properties.get(name) is not None, (holder, name)
        self.rows.append(f"{text or name}: {getattr(holder, name)}")

    def operator(self, name):
        self.rows.append(name)

    def operator_menu_enum(self, name, prop, text):
        self.rows.append(f"{name} {prop}: {text}")
        return self

    def column(self, heading="", align=False):
        return self

    row = split = lambda self, **_options: self

    def __setattr__(self, _name, _value):
        pass


def _drawn(panel):
    """What a panel shows now."""
    plain = type("Drawn", (panel.__mro__[1],), {"draw": panel.draw, "_row": getattr(panel, "_row", None)})()
    plain.layout = _Layout()
    plain.draw(bpy.context)
    return plain.layout.rows


def shadow_and_decay(folder):
    """The panels of a scene with lamps, and the light on a plane two metres below a lamp of each decay."""
    import scenes
    from bl_ext.user_default.penumbra import lamps

    scene = _scene((8, 6), spp=16)
    bpy.ops.mesh.primitive_plane_add(size=0.2)
    scene.camera.location, scene.camera.rotation_euler = (0.0, 0.0, 0.2), (0.0, 0.0, 0.0)
    lamp = _lamp("Bulb", "POINT", energy=100.0, shadow_soft_size=0.0)
    _add("Bulb", lamp, location=(0.0, 0.0, 2.0))
    sun = _lamp("Sun", "SUN", energy=0.0)
    _add("Sun", sun)
    scenes.world(0.0)
    answer = {"panels": {panel.__name__: _drawn(panel) for panel in lamps.PANELS}, "light": [], "decay": []}
    for decay, _, _ in lamps.DECAYS:
        assert bpy.ops.penumbra.light_decay(light="Bulb", decay=decay) == {"FINISHED"}
        answer["decay"].append(_drawn(lamps.PENUMBRA_PT_decay))
        answer["light"].append(os.path.join(folder, f"{decay}.exr"))
        _render(answer["light"][-1])
    try:
        bpy.ops.penumbra.light_decay(light="Sun", decay="LINEAR")
    except RuntimeError as error:
        answer["sun"] = str(error)
    first, second = bpy.data.objects["Plane"], _add("Other", bpy.data.objects["Plane"].data)
    holder = lambda obj: obj if hasattr(obj, "shadow_terminator_geometry_offset") else obj.cycles
    holder(first).shadow_terminator_geometry_offset = 0.25
    second.select_set(True)
    with bpy.context.temp_override(object=first, selected_objects=[first, second]):
        bpy.ops.penumbra.terminator_to_selected()
    answer["copied"] = holder(second).shadow_terminator_geometry_offset
    return answer


def progress(show):
    """What the status line tells on the way."""
    from bl_ext.user_default.penumbra import engine

    scene = _scene((32, 24), spp=64)
    _room()
    scene.penumbra.use_noise_estimate = show == "noise"
    kind = engine.PenumbraRenderEngine
    told, observe = [], kind._observe

    class Line:
        update_progress = staticmethod(lambda _done: None)
        update_stats = staticmethod(lambda _stats, text: told.append(text))
        _stopped = staticmethod(lambda: False)

    kind._observe = lambda self, news: observe(Line, news)
    try:
        bpy.ops.render.render()
    finally:
        kind._observe = observe
    return told


def viewport_fails(kind):
    """What is told where an update of the viewport fails again and again, and then in another way."""
    from bl_ext.user_default.penumbra import engine

    told = []

    class Engine:
        as_pointer = staticmethod(lambda: 1)
        update_stats = staticmethod(lambda _stats, text: told.append(["line", text]))
        report = staticmethod(lambda level, text: told.append([*level, text]))

    def fail(error):
        raise error

    errors = {"input": ValueError("the render border holds no pixel"), "bug": ZeroDivisionError("division by zero")}
    for error in (errors[kind], errors[kind], OSError("no space left on device")):
        engine.PenumbraRenderEngine._in_viewport(Engine, lambda: fail(error))
    return told


def escape(when):
    """Seconds from Esc to the end of F12, and how many objects were read by then."""
    from bl_ext.user_default.penumbra import engine
    from bl_ext.user_default.penumbra.export import scene as export

    scene = _scene((32, 24), spp=4)
    shape = bpy.data.meshes.new("shape")
    shape.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [], [(0, 1, 2)])
    for i in range(2000):
        _add(f"o{i}", shape, location=(0.02 * (i % 50), 0.02 * (i // 50), 0.0))
    kind = engine.PenumbraRenderEngine
    own = {name: getattr(kind, name) for name in ("_stopped", "_observe")}
    describe = export.Exporter._object
    read, asked = [], {}

    def note(self, *arguments):
        read.append(None)
        return describe(self, *arguments)

    def wish(_self):
        if (len(read) >= 100 and when == "reading") or "preparing" in asked:
            asked.setdefault("at", time.perf_counter())
        return "at" in asked

    def observe(self, _progress):
        if when == "preparing":
            asked["preparing"] = True
        return self._stopped()

    export.Exporter._object = note
    kind._stopped, kind._observe = wish, observe
    try:
        bpy.ops.render.render()
        end = time.perf_counter()
    finally:
        export.Exporter._object = describe
        for name, value in own.items():
            setattr(kind, name, value)
    return [end - asked["at"], len(read)]


def small_edits(count):
    """What crosses for edits of a scene of many objects, and the picture after each beside that of a viewport that begins
    afresh."""
    scene = _scene((32, 24))
    _room()
    material = bpy.data.materials.new("Wood")
    material.use_nodes = True
    shader = material.node_tree.nodes["Principled BSDF"]
    bpy.data.objects["Plane"].data.materials.append(material)
    cube, lamp = bpy.data.objects["Cube"], bpy.data.objects["Area"]
    for i in range(int(count)):
        _add(f"o{i}", cube.data, location=(0.1 * i - 2.0, 2.0, 0.0), scale=(0.1, 0.1, 0.1))
    holder = _add("Holder", None)
    cube.parent = holder
    scene.world.use_nodes = True
    background = next(node for node in scene.world.node_tree.nodes if node.type == "BACKGROUND")

    def color():
        shader.inputs["Base Color"].default_value = (1.0, 0.2, 0.1, 1.0)

    def move():
        bpy.data.objects["o1"].location.z = 1.5

    def move_parent():
        holder.location.x = 0.7

    def move_lamp():
        lamp.location.x = -1.5

    def dim():
        lamp.data.energy = 120.0

    def sky():
        background.inputs["Color"].default_value = (0.1, 0.2, 0.6, 1.0)

    def both():
        shader.inputs["Base Color"].default_value = (0.1, 0.9, 0.1, 1.0)
        cube.location.z = 1.0

    def hide():
        cube.hide_viewport = True

    def shadowless():
        bpy.data.objects["o1"].visible_camera = False

    def refer():
        coordinates = material.node_tree.nodes.new("ShaderNodeTexCoord")
        coordinates.object = lamp
        material.node_tree.links.new(coordinates.outputs["Object"], shader.inputs["Base Color"])

    def move_referred():
        lamp.location.y = 1.0

    viewport, answer = _Viewport((32, 24)), {}
    viewport.show()
    for edit in (color, move, move_parent, move_lamp, dim, sky, both, hide, shadowless, refer, move_referred):
        calls, shown = viewport.show(edit)
        afresh = _Viewport((32, 24))
        answer[edit.__name__] = [[name for name, _ in calls], shown, afresh.show()[1]]
        afresh.render.stop()
    viewport.render.stop()
    return answer


def cryptomatte(folder):
    """Cryptomatte by both engines, and the cube as the compositor's node picks it: paths of the three files."""
    scene = _scene((32, 24), spp=8)
    _room()
    layer = bpy.context.view_layer
    for kind in ("object", "material", "asset"):
        setattr(layer, f"use_pass_cryptomatte_{kind}", True)
    scene.cycles.samples, scene.cycles.use_denoising = 1, False
    paths = []
    for engine in ("CYCLES", "PENUMBRA"):
        scene.render.engine = engine
        paths.append(os.path.join(folder, f"{engine.lower()}.exr"))
        _render(paths[-1])
    if bpy.app.version >= (5, 0):
        tree = scene.compositing_node_group = bpy.data.node_groups.new("Matte", "CompositorNodeTree")
        tree.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
        output = tree.nodes.new("NodeGroupOutput")
    else:
        scene.use_nodes = True
        tree = scene.node_tree
        tree.nodes.clear()
        output = tree.nodes.new("CompositorNodeComposite")
    picker = tree.nodes.new("CompositorNodeCryptomatteV2")
    picker.source, picker.scene = "RENDER", scene
    picker.layer_name = f"{layer.name}.CryptoObject"
    picker.matte_id = "Cube"
    tree.links.new(picker.outputs["Matte"], output.inputs[0])
    settings = scene.render.image_settings
    if hasattr(settings, "media_type"):
        settings.media_type = "IMAGE"
    settings.file_format, settings.color_mode, settings.color_depth = "OPEN_EXR", "RGB", "32"
    scene.render.filepath = os.path.join(folder, "matte.exr")
    bpy.ops.render.render(write_still=True)
    return [*paths, scene.render.filepath]


def packed_tiles(folder):
    """A wall of nine squares, each of which looks one tile of an image up, from files and then packed: paths of the pictures by
    both engines. Of the tiles 1001, 1002, 1011 and 1012 the last has neither file nor bytes."""
    import numpy as np
    import scenes

    scene = _scene((24, 24), spp=16)
    scenes.world(0.0)
    scene.cycles.samples, scene.cycles.use_denoising, scene.cycles.pixel_filter_type = 16, False, "BOX"
    scene.camera.data.type, scene.camera.data.ortho_scale = "ORTHO", 3.0
    scene.camera.location, scene.camera.rotation_euler = (0.0, 0.0, 5.0), (0.0, 0.0, 0.0)
    files = {}
    for tile, color in ((1001, (1, 0, 0, 1)), (1002, (0, 1, 0, 1)), (1011, (0, 0, 1, 1))):
        image = bpy.data.images.new(str(tile), 4, 4)
        image.pixels.foreach_set(np.tile(np.asarray(color, np.float32), 16))
        files[tile] = image.filepath_raw = os.path.join(folder, f"tile.{tile}.png")
        image.file_format = "PNG"
        image.save()
    images = []
    for packed in (False, True):
        tiles = bpy.data.images.load(files[1001])
        tiles.source, tiles.filepath_raw = "TILED", os.path.join(folder, "tile.<UDIM>.png")
        for tile in (1002, 1011):
            if tile not in [known.number for known in tiles.tiles]:
                tiles.tiles.new(tile)
        if packed:
            tiles.pack()
            tiles.tiles.new(1012)
        images.append(tiles)
    # From -1 to 2 across and up.
    glow = scenes.material("Glow", "ShaderNodeEmission")
    tree = glow.node_tree
    mapping, texture = tree.nodes.new("ShaderNodeMapping"), tree.nodes.new("ShaderNodeTexImage")
    texture.interpolation = "Closest"
    mapping.inputs["Scale"].default_value, mapping.inputs["Location"].default_value = (3, 3, 1), (-1, -1, 0)
    tree.links.new(tree.nodes.new("ShaderNodeTexCoord").outputs["UV"], mapping.inputs["Vector"])
    tree.links.new(mapping.outputs[0], texture.inputs["Vector"])
    emission = next(node for node in tree.nodes if node.type == "EMISSION")
    tree.links.new(texture.outputs["Color"], emission.inputs["Color"])
    bpy.ops.mesh.primitive_plane_add(size=3.0)
    bpy.context.object.data.materials.append(glow)
    paths = []
    for packed, texture.image in enumerate(images):
        for engine in ("CYCLES", "PENUMBRA"):
            scene.render.engine = engine
            paths.append(os.path.join(folder, f"{engine.lower()}-{packed}.exr"))
            _render(paths[-1])
    return paths
