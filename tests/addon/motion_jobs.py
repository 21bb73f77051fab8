"""A scene that moves while the shutter is open, and what crosses for it."""

import json
import math

import bpy
import numpy as np

from jobs import _add, _lamp, _scene


class _Listener:
    """Stands in for the engine's scene: keeps the arrays of shapes, placements and their motion."""

    def __init__(self):
        self.shapes, self.points, self.moved, self.calls = {}, {}, [], []

    def set_document(self, text):
        self.document = json.loads(text)

    def set_mesh(self, key, name, *, positions, **_arrays):
        self.shapes[key] = [name, positions]

    def set_rounds(self, key, name, positions, *_arrays, **named):
        self.shapes[key] = [name, positions]

    def set_instances(self, objects, matrices, _random):
        self.objects, self.matrices = objects, matrices.reshape(-1, 16)

    def set_shape_motion(self, key, moved):
        self.points[key] = moved

    def add_instance_motion(self, time, instances, matrices):
        self.moved.append([time, instances, matrices.reshape(-1, 16)])

    def __getattr__(self, name):
        return lambda *_arguments, **_named: self.calls.append(name)


def _keyed(holder, path, values):
    """Straight lines through the values at frames."""
    for frame, value in values:
        setattr(holder, path, value)
        holder.keyframe_insert(path, frame=frame)


def _mesh(name, points=((0, 0, 0), (1, 0, 0), (0, 1, 0))):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([tuple(p) for p in points], [], [(0, 1, 2)])
    return mesh


def _moving(position, shutter=0.5):
    scene = _scene()
    # Whoever keys turns what stands between the keys into curves: motion has no straight lines here.
    render = scene.render
    render.use_motion_blur, render.motion_blur_shutter, render.motion_blur_position = True, shutter, position
    _keyed(scene.camera, "location", [(1, (0, -6, 3)), (9, (2, -6, 3))])
    slider = _add("Slider", _mesh("Slider"))
    _keyed(slider, "location", [(1, (0, 0, 0)), (9, (8, 0, 4))])
    slider.cycles.motion_steps = 2
    still = _add("Still", _mesh("Still"))
    _keyed(still, "location", [(1, (0, 0, 0)), (9, (8, 0, 0))])
    still.cycles.use_motion_blur = False
    waver = _add("Waver", _mesh("Waver"))
    waver.shape_key_add(name="Basis")
    key = waver.shape_key_add(name="Up")
    key.data[2].co = (0, 1, 5)
    _keyed(key, "value", [(1, 0.0), (9, 1.0)])
    stiff = _add("Stiff", waver.data)
    stiff.cycles.use_deform_motion = False
    empty = _add("Empty", None)
    parent = _add("Parent", _mesh("Parent", ((0, 0, 0), (3, 0, 0), (0, 3, 0))))
    _keyed(parent, "rotation_euler", [(1, (0, 0, 0)), (9, (0, 0, 2.0))])
    parent.instance_type = "VERTS"
    child = _add("Child", _mesh("Child"))
    child.parent = parent
    lamp = _add("Lamp", _lamp("Lamp", "POINT", energy=10.0))
    _keyed(lamp, "location", [(1, (0, 0, 5)), (9, (0, 8, 5))])
    return scene


def _gathered(scene):
    """What F12 hands over at the frame that is set."""
    from bl_ext.user_default.penumbra.export import Exporter, motion

    listener, stops = _Listener(), lambda: False
    depsgraph = bpy.context.evaluated_depsgraph_get()
    scene.view_layers[0].update()

    def frame_set(frame, subframe):
        scene.frame_set(frame, subframe=subframe)

    render = scene.render
    exporter = Exporter(listener)
    moving = motion.Motion(scene, frame_set, stops) if motion.is_on(scene, scene.view_layers[0]) else None
    exporter.export(depsgraph, [render.resolution_x, render.resolution_y], motion=moving)
    return listener, exporter.warnings


def _rows(matrix):
    return [x for row in matrix for x in row]


def gathered(position):
    """The description of a frame with motion, and the same asked of Blender itself at those times."""
    scene = _moving(position)
    frame = 4
    scene.frame_set(frame)
    listener, warnings = _gathered(scene)
    back = [scene.frame_current, scene.frame_subframe]
    names = [listener.document["objects"][index]["name"] for index in listener.objects]
    answer = {"shutter": listener.document["render"]["shutter"], "back": back, "warnings": warnings, "names": names,
              "motion": {}, "points": {}, "lamp": _rows(listener.document["lights"][0]["matrix"])}
    for time, instances, matrices in listener.moved:
        for index, matrix in zip(instances, matrices):
            answer["motion"].setdefault(names[index], []).append([time, matrix.tolist()])
    for key, moved in listener.points.items():
        answer["points"][listener.shapes[key][0]] = [[time, points.tolist()] for time, points in moved]
    answer["camera"] = [[time, _rows(matrix)] for time, matrix in listener.document["camera"]["motion"]]
    times = sorted({time for time, _, _ in listener.moved} | {sum(answer["shutter"]) / 2.0})
    answer["truth"] = {}
    for time in times:
        whole = math.floor(frame + time)
        scene.frame_set(whole, subframe=frame + time - whole)
        depsgraph = bpy.context.evaluated_depsgraph_get()
        found = {}
        for instance in depsgraph.object_instances:
            name = instance.object.name
            found.setdefault(name, []).append(_rows(instance.matrix_world))
        waver = bpy.data.objects["Waver"].evaluated_get(depsgraph).data
        points = np.empty(9, np.float32)
        waver.attributes["position"].data.foreach_get("vector", points)
        answer["truth"][str(time)] = [found, points.tolist()]
    return answer


def off():
    """What crosses of motion, and which frames are set, where motion blur is off in the scene or the view layer."""
    from bl_ext.user_default.penumbra.export import motion

    scene = _moving("CENTER")
    layer, answers = scene.view_layers[0], []
    for switch, holder in (("use_motion_blur", scene.render), ("use_motion_blur", layer)):
        setattr(holder, switch, False)
        assert not motion.is_on(scene, layer)
        setattr(holder, switch, True)
    scene.render.use_motion_blur = False
    listener, warnings = _gathered(scene)
    render, view = listener.document["render"], listener.document["camera"]
    return ["shutter" in render, "motion" in view, listener.moved, list(listener.points), warnings]


def changing_count():
    """A mesh of another number of vertices at each time, which is told, and a zoom, which is not, by F12."""
    scene = _scene(spp=1)
    render = scene.render
    render.use_motion_blur, render.motion_blur_shutter = True, 1.0
    grower = _add("Grower", _mesh("Grower"))
    array = grower.modifiers.new("Array", "ARRAY")
    _keyed(array, "count", [(1, 1), (9, 9)])
    # A constructive modifier moves nothing for Cycles unless it is animated in an object that deforms.
    grower.shape_key_add(name="Basis")
    _keyed(scene.camera.data, "lens", [(1, 30.0), (9, 90.0)])
    scene.frame_set(4)
    bpy.ops.render.render()
    return [scene.frame_current, scene.frame_subframe]


def stopped():
    """A picture that is stopped while motion is gathered: the frame is what it was."""
    from bl_ext.user_default.penumbra.export import Exporter, motion

    scene = _moving("CENTER")
    scene.frame_set(4, subframe=0.25)
    seen = []

    def frame_set(frame, subframe):
        seen.append(frame + subframe)
        scene.frame_set(frame, subframe=subframe)

    moving = motion.Motion(scene, frame_set, lambda: len(seen) >= 1)
    Exporter(_Listener()).export(bpy.context.evaluated_depsgraph_get(), [64, 48], motion=moving)
    return [seen, scene.frame_current, scene.frame_subframe]


def _lifted(group, to_points):
    """Geometry nodes that lift all points by a tenth of the frame's number, as a point cloud if asked to."""
    tree = bpy.data.node_groups.new(group, "GeometryNodeTree")
    for in_out in ("INPUT", "OUTPUT"):
        tree.interface.new_socket("Geometry", in_out=in_out, socket_type="NodeSocketGeometry")
    first, last = tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")
    time, factor = tree.nodes.new("GeometryNodeInputSceneTime"), tree.nodes.new("ShaderNodeMath")
    factor.operation = "MULTIPLY"
    factor.inputs[1].default_value = 0.1
    offset, place = tree.nodes.new("ShaderNodeCombineXYZ"), tree.nodes.new("GeometryNodeSetPosition")
    tree.links.new(time.outputs["Frame"], factor.inputs[0])
    tree.links.new(factor.outputs[0], offset.inputs["Z"])
    tree.links.new(offset.outputs[0], place.inputs["Offset"])
    source = first.outputs[0]
    if to_points:
        node = tree.nodes.new("GeometryNodeMeshToPoints")
        tree.links.new(source, node.inputs["Mesh"])
        source = node.outputs[0]
    tree.links.new(source, place.inputs["Geometry"])
    tree.links.new(place.outputs[0], last.inputs[0])
    return tree


def shapes():
    """Motion of the points of every kind of shape: [time, change of each point] by the name of the shape, and fps."""
    scene = _scene()
    scene.render.use_motion_blur, scene.render.motion_blur_shutter = True, 1.0
    scene.render.fps = 10
    seeds = _add("Seeds", _mesh("Seeds"))
    seeds.modifiers.new("Points", "NODES").node_group = _lifted("ToPoints", True)
    curves = bpy.data.hair_curves.new("Curves")
    curves.add_curves([2, 3])
    for i, point in enumerate(curves.points):
        point.position = (0.1 * i, 0.0, 0.0)
    _add("Curves", curves).modifiers.new("Lift", "NODES").node_group = _lifted("Lift", False)
    text = bpy.data.curves.new("Text", "FONT")
    text.body = "A"
    _add("Text", text)
    _keyed(text, "size", [(1, 1.0), (9, 2.0)])
    flow = _mesh("Flow")
    velocity = flow.attributes.new("velocity", "FLOAT_VECTOR", "POINT")
    velocity.data.foreach_set("vector", np.arange(9, dtype=np.float32))
    _add("Flow", flow)
    lawn = _add("Lawn", _mesh("Lawn", ((0, 0, 0), (3, 0, 0), (0, 3, 0))))
    lawn.shape_key_add(name="Basis")
    key = lawn.shape_key_add(name="Up")
    for point in key.data:
        point.co.z += 2.0
    _keyed(key, "value", [(1, 0.0), (9, 1.0)])
    lawn.modifiers.new("Grass", "PARTICLE_SYSTEM")
    grass = lawn.particle_systems[0].settings
    grass.type, grass.count, grass.hair_length, grass.render_type = "HAIR", 5, 0.5, "PATH"
    scene.frame_set(4)
    listener, warnings = _gathered(scene)
    changes = {}
    for key, moved in listener.points.items():
        name, base = listener.shapes[key]
        changes[name] = [[time, (points - base).tolist()] for time, points in moved]
    return [changes, warnings]
