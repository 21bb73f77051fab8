"""What the tests let Blender do; each job returns plain data."""

import json
import os
import time
import types

import bpy
import numpy as np


def _scene(size=(64, 48), spp=4):
    """An empty scene with a camera that looks down at the origin."""
    scene = bpy.context.scene
    scene.render.engine = "PENUMBRA"
    scene.render.resolution_x, scene.render.resolution_y = size
    scene.render.resolution_percentage = 100
    scene.penumbra.spp = spp
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location = (0, -6, 3)
    camera.rotation_euler = (1.107, 0, 0)
    scene.collection.objects.link(camera)
    scene.camera = camera
    if scene.world is None:
        scene.world = bpy.data.worlds.new("World")
    return scene


def _add(name, data, **properties):
    obj = bpy.data.objects.new(name, data)
    for key, value in properties.items():
        setattr(obj, key, value)
    bpy.context.scene.collection.objects.link(obj)
    return obj


def _lamp(name, kind, **properties):
    light = bpy.data.lights.new(name, kind)
    for key, value in properties.items():
        setattr(light, key, value)
    return light


def _room():
    """A floor, a cube and a lamp."""
    bpy.ops.mesh.primitive_plane_add(size=10)
    bpy.ops.mesh.primitive_cube_add(size=1, location=(0, 0, 0.5))
    _add("Area", _lamp("Area", "AREA", energy=200.0, size=1.0), location=(1.5, -1.0, 3.0))


def _render(path, view_layer_passes=()):
    """Renders to a multi-layer EXR."""
    scene = bpy.context.scene
    for name in view_layer_passes:
        setattr(scene.view_layers[0], name, True)
    settings = scene.render.image_settings
    if hasattr(settings, "media_type"):
        settings.media_type = "MULTI_LAYER_IMAGE"
    settings.file_format = "OPEN_EXR_MULTILAYER"
    settings.color_depth = "32"
    if hasattr(settings, "use_exr_interleave"):
        # Blender 5.0.1 can't write parts of pixels that are not square.
        settings.use_exr_interleave = scene.render.pixel_aspect_x != scene.render.pixel_aspect_y
    scene.render.filepath = path
    bpy.ops.render.render(write_still=True)


def _all_kinds():
    """What there has to be for every pass to have something: things that glow, refract, mirror, move and catch shadows, of
    numbers and light groups of their own, and an AOV."""
    import scenes

    scene, layer = bpy.context.scene, bpy.context.view_layer
    scenes.world(0.3)
    glass = scenes.material("Glass", "ShaderNodeBsdfGlass", Roughness=0.3)
    metal = scenes.material("Metal", "ShaderNodeBsdfGlossy", Color=(0.9, 0.6, 0.3, 1.0), Roughness=0.3)
    glow = scenes.material("Glow", "ShaderNodeEmission", Strength=3.0)
    for i, (material, x) in enumerate(((glass, -1.6), (metal, 1.6), (glow, 2.6))):
        material.pass_index = i + 2
        bpy.ops.mesh.primitive_uv_sphere_add(radius=0.5, location=(x, -0.5, 0.5))
        bpy.context.object.pass_index = i + 5
        bpy.context.object.data.materials.append(material)
    # A pane before the lamp: light comes straight through.
    bpy.ops.mesh.primitive_plane_add(size=0.8, location=(-1.0, -2.5, 0.6), rotation=(1.4, 0.0, 0.0))
    bpy.context.object.data.materials.append(glass)
    bpy.context.object.pass_index = 5
    cube = bpy.data.objects["Cube"]
    for frame, x in ((0, -0.5), (2, 0.5)):
        cube.location.x = x
        cube.keyframe_insert("location", frame=frame)
    bpy.ops.mesh.primitive_plane_add(size=1.5, location=(0.0, -2.0, 0.05))
    bpy.context.object.is_shadow_catcher = True
    bpy.ops.mesh.primitive_cube_add(size=0.3, location=(0.1, -2.2, 0.5))
    own = scenes.material("Own", "ShaderNodeBsdfDiffuse")
    bpy.context.object.data.materials.append(own)
    output = own.node_tree.nodes.new("ShaderNodeOutputAOV")
    output.aov_name, output.inputs["Color"].default_value = "Place", (0.2, 0.4, 0.6, 1.0)
    aov = layer.aovs.add()
    aov.name, aov.type = "Place", "COLOR"
    for group, holder in (("key", bpy.data.objects["Area"]), ("fill", scene.world)):
        layer.lightgroups.add(name=group)
        holder.lightgroup = group
    layer.cycles.use_pass_shadow_catcher = True


def f12(folder):
    """One picture with every pass; returns the path, and the table of passes."""
    import penumbra

    _scene((96, 72), spp=32)
    _room()
    _all_kinds()
    layer = bpy.context.view_layer
    for name in dir(layer):
        if name.startswith("use_pass_") and isinstance(getattr(layer, name), bool):
            setattr(layer, name, True)
    for name in layer.penumbra.__annotations__:
        setattr(layer.penumbra, name, True)
    path = os.path.join(folder, "f12.exr")
    _render(path)
    return [path, penumbra.passes()]


def effects(folder):
    """What the panel says before and after a render of a scene with glass and an ao pass."""
    from bl_ext.user_default.penumbra import panels

    class Layout:
        def __init__(self, texts):
            self.texts = texts

        def label(self, text, icon="NONE"):
            self.texts.append(text)

        def column(self, align=False):
            return self

        def split(self, factor):
            return self

    def drawn():
        panel = types.SimpleNamespace(layout=Layout([]))
        panels.PENUMBRA_PT_effects.draw(panel, bpy.context)
        return panel.layout.texts

    _scene(spp=4)
    _room()
    glass = bpy.data.materials.new("Pane")
    glass.use_nodes = True
    glass.node_tree.nodes["Principled BSDF"].inputs["Transmission Weight"].default_value = 1.0
    next(obj for obj in bpy.data.objects if obj.type == "MESH").data.materials.append(glass)
    bpy.context.view_layer.use_pass_ambient_occlusion = True
    before = drawn()
    _render(os.path.join(folder, "effects.exr"))
    return [before, drawn()]


def mesh_time(count):
    """Seconds that a mesh of about a million triangles takes to cross, and its triangles."""
    import penumbra
    from bl_ext.user_default.penumbra.export import mesh

    n = int(count)
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=n, y_subdivisions=n, size=2)
    obj = bpy.context.object
    obj.data.polygons.foreach_set("use_smooth", np.ones(len(obj.data.polygons), bool))
    obj.data.update()
    evaluated = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    scene = penumbra.Scene()
    times = []
    for _ in range(3):
        start = time.perf_counter()
        mesh.hand_over(scene, 1, evaluated.data, frozenset())
        times.append(time.perf_counter() - start)
    return [min(times), len(evaluated.data.loop_triangles)]


def side_by_side(name, folder, spp=256, size=64):
    """The scene `name` by both engines: paths of the two EXR files."""
    _scene_of(name)
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = int(size) * 4 // 3, int(size)
    scene.render.resolution_percentage = 100
    scene.render.filter_size = 1.5
    for layer in scene.view_layers:
        for box in ("use_pass_z", "use_pass_normal", "use_pass_position", "use_pass_diffuse_direct",
                    "use_pass_diffuse_color", "use_pass_ambient_occlusion", "use_pass_environment"):
            setattr(layer, box, True)
        layer.penumbra.use_pass_shadow = True
    cycles = scene.cycles
    cycles.samples, cycles.use_adaptive_sampling, cycles.use_denoising = int(spp), False, False
    cycles.sample_clamp_indirect, cycles.blur_glossy = 0.0, 0.0
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = cycles.transmission_bounces = 4
    cycles.pixel_filter_type = "BOX"
    # What a scene says of light paths itself counts.
    for key, value in scene.get("cycles_settings", {}).items():
        setattr(cycles, key, value)
    scene.penumbra.spp, scene.penumbra.max_bounces = int(spp), 4
    paths = []
    for engine in ("CYCLES", "PENUMBRA"):
        scene.render.engine = engine
        paths.append(os.path.join(folder, f"{name}-{engine.lower()}.exr"))
        _render(paths[-1])
    return paths


def _left():
    """What an export left of itself in the scene."""
    marks = [f"{obj.name}: {key}" for obj in bpy.data.objects for key in obj.keys() if "penumbra" in key]
    marks += [data.name for group in (bpy.data.objects, bpy.data.images) for data in group if "penumbra" in data.name]
    return marks + [light.name for light in bpy.data.lights if not light.users]


def _scene_of(name):
    import export_scenes
    import material_scenes
    import scenes

    next(getattr(module, name) for module in (export_scenes, material_scenes, scenes) if hasattr(module, name))()


class _Listener:
    """Stands in for the engine: keeps the document that a render would get."""

    def set_document(self, text):
        self.document = json.loads(text)

    def __getattr__(self, _name):
        return lambda *_arguments, **_named: None


def export(name, path, *options):
    """The scene `name` exported; what F12 would render, and what is left behind."""
    from bl_ext.user_default.penumbra.export import Exporter

    _scene_of(name)
    render, listener = bpy.context.scene.render, _Listener()
    Exporter(listener).export(bpy.context.evaluated_depsgraph_get(), [render.resolution_x, render.resolution_y])
    bpy.ops.penumbra.export(filepath=path, **{option: True for option in options})
    return [listener.document, _left()]


def _as_principled(tree):
    """Diffuse BSDFs as what files can hold: Blender's glTF exporter knows none."""
    for plain in [node for node in tree.nodes if node.type == "BSDF_DIFFUSE"]:
        shader = tree.nodes.new("ShaderNodeBsdfPrincipled")
        # Specular levels are lost in USD files of 4.2.
        shader.inputs["Roughness"].default_value = 1.0
        color = plain.inputs["Color"]
        shader.inputs["Base Color"].default_value = color.default_value
        if color.is_linked:
            tree.links.new(color.links[0].from_socket, shader.inputs["Base Color"])
        tree.links.new(shader.outputs[0], plain.outputs[0].links[0].to_socket)
        # 4.2's USD exporter takes the first shader that there is, used or not.
        tree.nodes.remove(plain)


def through_the_doors(name, folder):
    """The scene `name` rendered, and exported to USD and glTF: paths of the picture and of the files."""
    _scene_of(name)
    for material in bpy.data.materials:
        _as_principled(material.node_tree)
    scene = bpy.context.scene
    scene.render.engine = "PENUMBRA"
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 64, 48, 100
    # Files have no place for Cycles' light paths.
    scene.cycles.pixel_filter_type, scene.cycles.blur_glossy, scene.cycles.sample_clamp_indirect = "BOX", 0.0, 0.0
    scene.penumbra.spp, scene.penumbra.max_bounces = 128, 4
    picture = os.path.join(folder, "f12.exr")
    _render(picture)
    files = [os.path.join(folder, f"scene.{ending}") for ending in ("usdc", "glb")]
    for path in files:
        bpy.ops.penumbra.export(filepath=path)
    return [picture, files]


def export_fails(folder):
    """Exports that are refused."""
    _scene_of("point_soft")
    refused = []
    os.mkdir(os.path.join(folder, "folder.usdc"))
    for name in ("file.obj", "missing/file.usdc", "folder.usdc"):
        try:
            bpy.ops.penumbra.export(filepath=os.path.join(folder, name))
        except RuntimeError as error:
            print(error)
            refused.append(name)
    return {"refused": refused, "left": _left()}


def export_command(path):
    """What `blender --command penumbra_export` does."""
    from bl_ext.user_default.penumbra.files import operator

    _scene_of("point_soft")
    return operator.command([path])


def cancel(folder):
    """F12 that is stopped: seconds from the wish to the end, and whether a picture was left."""
    from bl_ext.user_default.penumbra import engine

    _scene((320, 240), spp=100_000)
    _room()
    kind = engine.PenumbraRenderEngine
    asked = {}
    observe = kind._observe

    def impatient(self, progress):
        observe(self, progress)
        if progress is not None and progress["spp"] >= 2 and "at" not in asked:
            asked["at"] = time.perf_counter()
        return "at" in asked

    kind._observe = impatient
    path = os.path.join(folder, "cancelled.exr")
    try:
        _render(path)
    finally:
        kind._observe = observe
    return [time.perf_counter() - asked["at"], path]


def noise_target(folder):
    """A picture that ends at a noise target, with noisy pixels sampled more; what was told on the way, and its path."""
    from bl_ext.user_default.penumbra import engine

    scene = _scene((64, 48), spp=4096)
    _room()
    scene.penumbra.error, scene.penumbra.adaptive = 0.01, True
    layer = bpy.context.view_layer
    layer.penumbra.use_pass_error = layer.penumbra.use_pass_sample_count = True
    kind = engine.PenumbraRenderEngine
    told, observe = [], kind._observe

    def listen(self, progress):
        if progress is not None:
            told.append(engine._noise(progress))
        return observe(self, progress)

    kind._observe = listen
    path = os.path.join(folder, "noise.exr")
    try:
        _render(path)
    finally:
        kind._observe = observe
    return [told, path]


def animation(folder):
    """Three frames of a cube that moves."""
    scene = _scene(spp=4)
    _room()
    cube = bpy.data.objects["Cube"]
    for frame, x in ((1, -1.0), (3, 1.0)):
        cube.location.x = x
        cube.keyframe_insert("location", frame=frame)
    scene.frame_start, scene.frame_end = 1, 3
    scene.render.image_settings.file_format = "PNG"
    scene.render.filepath = os.path.join(folder, "frame-")
    bpy.ops.render.render(animation=True)
    return sorted(name for name in os.listdir(folder) if name.startswith("frame-"))


def _complaint(work):
    """What Blender says where a render fails."""
    try:
        work()
    except RuntimeError as error:
        return str(error)
    return ""


def no_camera(folder):
    """A scene without camera."""
    _scene()
    bpy.context.scene.camera = None
    return _complaint(lambda: _render(os.path.join(folder, "none.exr")))


def empty_border(folder):
    """A border that holds no pixel."""
    scene = _scene()
    scene.render.use_border = True
    scene.render.border_min_x = scene.render.border_max_x = 0.5
    return _complaint(lambda: _render(os.path.join(folder, "none.exr")))


def stereo(folder):
    """A scene of two views."""
    _scene().render.use_multiview = True
    return _complaint(lambda: _render(os.path.join(folder, "none.exr")))


def replaced_engine(folder):
    """An engine that is not the one that was installed last."""
    import penumbra

    _scene()
    penumbra.installed_as += "?"
    return _complaint(lambda: _render(os.path.join(folder, "none.exr")))


def left_out(folder):
    """What a scene may ask for that there is not yet, each told."""
    _scene()
    layer = bpy.context.view_layer
    layer.cycles.use_pass_volume_direct = True
    material = bpy.data.materials.new("Displaced")
    material.use_nodes = True
    tree = material.node_tree
    output = next(node for node in tree.nodes if node.type == "OUTPUT_MATERIAL")
    tree.links.new(tree.nodes.new("ShaderNodeDisplacement").outputs[0], output.inputs["Displacement"])
    material.displacement_method = "BOTH"
    bpy.context.scene.cycles.use_fast_gi = True
    bpy.ops.mesh.primitive_plane_add(size=2)
    bpy.context.object.data.materials.append(material)
    _render(os.path.join(folder, "left_out.exr"))


def empty_scene(folder):
    """Nothing but a camera: the world alone."""
    _scene()
    path = os.path.join(folder, "empty.exr")
    _render(path)
    return path


def _on_the_floor(node_type):
    """A node of the floor's material, and its Principled BSDF."""
    material = bpy.data.materials.new("Wood")
    material.use_nodes = True
    tree = material.node_tree
    bpy.data.objects["Plane"].data.materials.append(material)
    return tree, tree.nodes.new(node_type), next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED")


def _missing_texture(folder):
    tree, texture, shader = _on_the_floor("ShaderNodeTexImage")
    texture.image = bpy.data.images.new("wood", 1, 1)
    texture.image.source = "FILE"
    texture.image.filepath = "/no/such/wood.png"
    tree.links.new(texture.outputs["Color"], shader.inputs["Base Color"])


def _unknown_node(folder):
    tree, bevel, shader = _on_the_floor("ShaderNodeBevel")
    tree.links.new(bevel.outputs["Normal"], shader.inputs["Normal"])


def _mesh_with_nan(folder):
    bpy.data.objects["Cube"].data.vertices[0].co.x = float("nan")


def _empty_slots(folder):
    for _ in range(100):
        bpy.data.objects["Cube"].data.materials.append(None)


def _missing_library(folder):
    here, library = (os.path.join(folder, name) for name in ("here.blend", "library.blend"))
    bpy.ops.wm.save_as_mainfile(filepath=here)
    bpy.data.objects["Cube"].name = "Linked"
    bpy.ops.wm.save_as_mainfile(filepath=library)
    bpy.ops.wm.open_mainfile(filepath=here)
    with bpy.data.libraries.load(library, link=True) as (_, wanted):
        wanted.objects = ["Linked"]
    bpy.context.scene.collection.objects.link(wanted.objects[0])
    bpy.ops.wm.save_as_mainfile(filepath=here)
    os.remove(library)
    bpy.ops.wm.open_mainfile(filepath=here)


def bad_input(kind, folder):
    """A scene of which something is wrong: path of its picture."""
    _scene(spp=2)
    _room()
    globals()[f"_{kind}"](folder)
    path = os.path.join(folder, "bad.exr")
    _render(path)
    return path


def raises(folder):
    """An exception inside render()."""
    from bl_ext.user_default.penumbra import engine

    _scene()
    kind = engine.PenumbraRenderEngine
    render = kind._render
    kind._render = lambda self, depsgraph: 1 / 0
    try:
        return _complaint(lambda: _render(os.path.join(folder, "none.exr")))
    finally:
        kind._render = render


class _Recorder:
    """Stands in front of the engine's scene: notes what is handed over, and hands it over."""

    def __init__(self, scene):
        self._scene, self.calls = scene, []

    def __getattr__(self, name):
        def call(*arguments, **named):
            self.calls.append([name, str(arguments[1]) if name in {"set_mesh", "set_rounds"} else ""])
            return getattr(self._scene, name)(*arguments, **named)

        return call


class _Viewport:
    """A viewport without a window: what crosses at each edit, and the picture after it."""

    def __init__(self, size=(64, 48)):
        import penumbra
        from bl_ext.user_default.penumbra.export import Exporter

        self._size = size
        self._scene = penumbra.Scene()
        self.recorder = _Recorder(self._scene)
        self._exporter = Exporter(self.recorder)
        self.render = penumbra.Viewport()

    def show(self, edit=None):
        """Makes an edit; returns what crossed for it and the mean of the finished picture."""
        self.recorder.calls.clear()
        if edit is None:
            self._update(bpy.context.evaluated_depsgraph_get())
        else:
            # Blender says what was edited while it calls this.
            handler = lambda _scene, depsgraph: self._update(depsgraph)
            bpy.app.handlers.depsgraph_update_post.append(handler)
            try:
                edit()
                bpy.context.view_layer.update()
            finally:
                bpy.app.handlers.depsgraph_update_post.remove(handler)
        return [list(self.recorder.calls), self._picture()]

    def _update(self, depsgraph):
        self._exporter.update(depsgraph, self._size, None)

    def look(self, **view):
        """The picture of a view for which nothing crosses."""
        self.recorder.calls.clear()
        return [list(self.recorder.calls), self._picture(False, **view)]

    def _picture(self, changed=True, **changes):
        camera = bpy.context.scene.camera
        depsgraph = bpy.context.evaluated_depsgraph_get()
        rows = lambda matrix: [list(row) for row in matrix]
        window = camera.calc_matrix_camera(depsgraph, x=self._size[0], y=self._size[1])
        view = {"size": self._size, "matrix": rows(camera.matrix_world), "window": rows(window), "orthographic": False,
                "clip_start": 0.1, "clip_end": 100.0, **changes}
        self.render.show(self._scene, json.dumps(view), changed, passes=["combined"], spp=4)
        picture, until = None, time.monotonic() + 60.0
        while (picture is None or picture[3] < 4 or picture[0] < self._size[0]) and time.monotonic() < until:
            picture = self.render.picture() or picture
            time.sleep(0.002)
        return np.asarray(picture[2]).reshape(-1, 4)[:, :3].mean(axis=0).tolist()


def viewport_edits(folder):
    """What crosses for each kind of edit, and how the picture changes."""
    _scene()
    _room()
    for name in ("Plane", "Cube"):
        material = bpy.data.materials.new(name)
        material.use_nodes = True
        bpy.data.objects[name].data.materials.append(material)
    image = bpy.data.images.new("paint", 4, 4)
    tree = bpy.data.materials["Plane"].node_tree
    texture = tree.nodes.new("ShaderNodeTexImage")
    texture.image = image
    tree.links.new(texture.outputs[0], tree.nodes["Principled BSDF"].inputs["Base Color"])
    viewport = _Viewport()
    answer = {"first": viewport.show()}
    cube = bpy.data.objects["Cube"]

    def move():
        cube.location.x = 1.0

    def color():
        bpy.data.materials["Cube"].node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (1, 0, 0, 1)

    def paint():
        image.pixels.foreach_set(np.ones(64, np.float32))
        image.update()
        image.update_tag()

    def reshape():
        cube.data.vertices[0].co.z += 0.5
        cube.data.update()

    def delete():
        bpy.data.objects.remove(cube)

    for edit in (move, color, paint, reshape, delete):
        answer[edit.__name__] = viewport.show(edit)
    viewport.render.stop()
    return answer


def _made_of_others():
    """A curve, a text and a metaball, each before the camera: their objects."""
    curve = bpy.data.curves.new("Curve", "CURVE")
    curve.dimensions, curve.bevel_depth, curve.use_fill_caps = "3D", 0.2, True
    spline = curve.splines.new("POLY")
    spline.points.add(3)
    for i, point in enumerate(spline.points):
        point.co = (i - 1.5, 0.0, 0.0, 1.0)
    text = bpy.data.curves.new("Text", "FONT")
    text.body, text.extrude = "abc", 0.1
    ball = bpy.data.metaballs.new("Ball")
    ball.elements.new().radius = 1.0
    ball.resolution = ball.render_resolution
    return [_add("Curve", curve, location=(0.0, 0.0, 0.8)), _add("Ball", ball, location=(-1.0, 1.0, 1.5)),
            _add("Text", text, location=(0.5, -1.0, 0.5), rotation_euler=(1.5, 0.0, 0.0))]


def glowing(folder):
    """Curve, text and metaball that light a floor, and meshes of the same shape: paths of the pictures."""
    import scenes

    _scene((32, 24), spp=64)
    scenes.world(0.0)
    bpy.ops.mesh.primitive_plane_add(size=10)
    objects, glow = _made_of_others(), scenes.material("Glow", "ShaderNodeEmission", Strength=5.0)
    for obj in objects:
        obj.data.materials.append(glow)
    paths = [os.path.join(folder, f"{name}.exr") for name in ("others", "meshes")]
    _render(paths[0])
    depsgraph = bpy.context.evaluated_depsgraph_get()
    for obj in objects:
        shape = bpy.data.meshes.new_from_object(obj.evaluated_get(depsgraph), depsgraph=depsgraph)
        _add(f"{obj.name} as mesh", shape, matrix_world=obj.matrix_world.copy())
    for obj in objects:
        bpy.data.objects.remove(obj)
    _render(paths[1])
    return paths


def viewport_shapes(folder):
    """Edits of curves, texts, metaballs and what geometry nodes make, again and again: each the mean that the viewport shows
    and that of one which begins afresh."""
    _scene((32, 24))
    _room()
    curve, ball, text = (obj.data for obj in _made_of_others())
    tree = bpy.data.node_groups.new("Grow", "GeometryNodeTree")
    for way in ("INPUT", "OUTPUT"):
        tree.interface.new_socket("Geometry", in_out=way, socket_type="NodeSocketGeometry")
    nodes = [tree.nodes.new(name) for name in ("NodeGroupInput", "GeometryNodeInstanceOnPoints", "NodeGroupOutput")]
    box = tree.nodes.new("GeometryNodeMeshCube")
    for first, second in zip(nodes, nodes[1:]):
        tree.links.new(first.outputs[0], second.inputs[0])
    tree.links.new(box.outputs[0], nodes[1].inputs["Instance"])
    box.inputs["Size"].default_value = (0.2, 0.2, 0.2)
    bpy.data.objects["Cube"].modifiers.new("Grow", "NODES").node_group = tree

    def bend(step):
        curve.splines[0].points[1].co.z = 0.2 * (step + 1)

    def swell(step):
        ball.elements[0].radius = 1.0 + 0.1 * (step + 1)

    def thicken(step):
        text.extrude = 0.1 * (step + 2)

    def grow(step):
        box.inputs["Size"].default_value = [0.2 + 0.1 * (step + 1)] * 3

    viewport, answer = _Viewport((32, 24)), {}
    viewport.show()
    for edit in (bend, swell, thicken, grow):
        answer[edit.__name__] = []
        # Memory that an edit frees is taken again by one of the next.
        for step in range(5):
            shown = viewport.show(lambda: edit(step))[1]
            afresh = _Viewport((32, 24))
            answer[edit.__name__].append([shown, afresh.show()[1]])
            afresh.render.stop()
    viewport.render.stop()
    return answer


def viewport_window(folder):
    """A world that is seen through the window's coordinates, from two sides of a room that has only it for a light."""
    scene = _scene()
    bpy.ops.mesh.primitive_plane_add(size=10)
    scene.world.use_nodes = True
    tree = scene.world.node_tree
    coordinates, parts = tree.nodes.new("ShaderNodeTexCoord"), tree.nodes.new("ShaderNodeSeparateXYZ")
    tree.links.new(coordinates.outputs["Camera"], parts.inputs[0])
    background = next(node for node in tree.nodes if node.type == "BACKGROUND")
    tree.links.new(parts.outputs["X"], background.inputs["Color"])
    viewport = _Viewport()
    first = viewport.show()[1]
    camera = scene.camera
    turned = camera.matrix_world.copy()
    camera.rotation_euler.z = 1.2
    bpy.context.view_layer.update()
    looked = viewport.look()[1]
    viewport.render.stop()
    afresh = _Viewport()
    expected = afresh.show()[1]
    afresh.render.stop()
    assert turned != camera.matrix_world
    return [first, looked, expected]


class _Context:
    """A context of these members and no others."""

    def __init__(self, **members):
        self.__dict__.update(members)

    def __getattr__(self, _name):
        return None


def panels_of(engine):
    """Names of the panels that show in the Properties editor for a mesh with a material, a lamp and the world."""
    _scene()
    _room()
    cube, lamp, scene = bpy.data.objects["Cube"], bpy.data.objects["Area"], bpy.context.scene
    material = bpy.data.materials.new("Wood")
    cube.data.materials.append(material)
    scene.render.engine = engine
    base = {"engine": engine, "scene": scene, "view_layer": bpy.context.view_layer, "world": scene.world,
            "space_data": _Context(), "preferences": bpy.context.preferences}
    shown = {}
    others = {"material", "object", "world", "render", "view_layer"}
    for kind, obj, light, stuff, tabs in (("mesh", cube, None, material, others), ("lamp", lamp, lamp.data, None, {"data"})):
        context = _Context(**base, object=obj, active_object=obj, light=light, material=stuff)
        names = []
        for name in dir(bpy.types):
            panel = getattr(bpy.types, name)
            if not name.startswith(("CYCLES_", "PENUMBRA_", "DATA_PT", "MATERIAL_PT", "OBJECT_PT_vis")) or "_PT_" not in name:
                continue
            poll = getattr(panel, "poll", None)
            engines = getattr(panel, "COMPAT_ENGINES", None)
            place = getattr(panel, "bl_space_type", ""), getattr(panel, "bl_context", "")
            if place[0] != "PROPERTIES" or place[1] not in tabs or engines is None or poll is None:
                continue
            if poll(context):
                names.append(name)
        shown[kind] = names
    return shown


def freestyle(folder):
    """The same cube with red lines by both engines: paths of the two files; none where Blender has no Freestyle."""
    if not bpy.app.build_options.freestyle:
        return []
    scene = _scene(spp=16)
    _room()
    scene.render.use_freestyle = scene.view_layers[0].use_freestyle = True
    settings = scene.view_layers[0].freestyle_settings
    lines = settings.linesets[0] if settings.linesets else settings.linesets.new("Lines")
    lines.linestyle = lines.linestyle or bpy.data.linestyles.new("Lines")
    lines.linestyle.color, lines.linestyle.thickness = (1.0, 0.0, 0.0), 4.0
    scene.cycles.samples, scene.cycles.use_denoising, scene.cycles.use_adaptive_sampling = 16, False, False
    paths = []
    for engine in ("CYCLES", "PENUMBRA"):
        scene.render.engine = engine
        paths.append(os.path.join(folder, f"lines-{engine.lower()}.exr"))
        _render(paths[-1])
    return paths


def border(folder):
    """A part of the picture, in place and cropped to: paths of both and of the whole."""
    scene = _scene((64, 48), spp=4)
    _room()
    paths = []
    for name, use, crop in (("whole", False, False), ("part", True, False), ("crop", True, True)):
        render = scene.render
        render.use_border, render.use_crop_to_border = use, crop
        render.border_min_x, render.border_max_x = 0.25, 0.75
        render.border_min_y, render.border_max_y = 0.5, 1.0
        paths.append(os.path.join(folder, f"{name}.exr"))
        _render(paths[-1])
    return paths


def _wall(folder, tile, names, columns, rows, spp=256):
    """A wall of glowing tiles by both engines: names of the tiles, how many in a row, their size and the two pictures."""
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = columns * tile, rows * tile
    scene.render.resolution_percentage = 100
    cycles = scene.cycles
    cycles.samples, cycles.use_adaptive_sampling, cycles.use_denoising = spp, False, False
    cycles.pixel_filter_type, cycles.max_bounces = "BOX", 0
    scene.penumbra.spp, scene.penumbra.max_bounces = spp, 0
    paths = []
    for engine in ("CYCLES", "PENUMBRA"):
        scene.render.engine = engine
        paths.append(os.path.join(folder, f"{engine.lower()}.exr"))
        _render(paths[-1])
    return [names, columns, tile, paths]


def node_wall(folder):
    """All function nodes."""
    import node_lab

    return _wall(folder, node_lab.TILE, *node_lab.wall())


def image_wall(folder):
    """All ways to look images up."""
    import image_lab

    return _wall(folder, image_lab.TILE, *image_lab.wall(folder), spp=64)
