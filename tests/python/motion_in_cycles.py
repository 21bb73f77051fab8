"""Scenes that move, as Cycles renders them and as a stage for Penumbra: `motion_in_cycles.py SCENE SPP OUT`.

Writes OUT.exr (Cycles) and OUT.usda with time samples at the times at which Cycles looks.
"""

import math
import sys

import bpy
from mathutils import Matrix

FRAME = 10
SHUTTER = 0.8
SIZE = 48


def material(name, emission, diffuse):
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    nodes, links = made.node_tree.nodes, made.node_tree.links
    nodes.clear()
    out = nodes.new("ShaderNodeOutputMaterial")
    kind, value = ("ShaderNodeEmission", emission) if emission else ("ShaderNodeBsdfDiffuse", diffuse)
    shader = nodes.new(kind)
    shader.inputs["Color"].default_value = (value, value, value, 1.0)
    links.new(shader.outputs[0], out.inputs["Surface"])
    made["emission"], made["diffuse"] = emission, diffuse
    return made


def add(name, points, faces, look, smooth=False):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(points, [], faces)
    mesh.materials.append(look)
    if smooth:
        mesh.shade_smooth()
    thing = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(thing)
    return thing


def box(name, half, look):
    points = [(x, y, z) for x in (-half[0], half[0]) for y in (-half[1], half[1]) for z in (-half[2], half[2])]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return add(name, points, faces, look)


def grid(name, count, look):
    step = 1.6 / count
    points = [(step * i - 0.8, step * j - 0.8, 0.0) for j in range(count + 1) for i in range(count + 1)]
    at = lambda i, j: j * (count + 1) + i
    faces = [(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)) for j in range(count) for i in range(count)]
    return add(name, points, faces, look, smooth=True)


def straight(holder):
    """Key frames that are linear."""
    action = holder.animation_data.action
    curves = action.fcurves if hasattr(action, "fcurves") else [
        curve for layer in action.layers for strip in layer.strips for bag in strip.channelbags for curve in bag.fcurves
    ]
    for curve in curves:
        for key in curve.keyframe_points:
            key.interpolation = "LINEAR"


def animate(thing, path, before, after):
    """From one frame before the frame to one after it."""
    for frame, value in ((FRAME - 1, before), (FRAME + 1, after)):
        setattr(thing, path, value)
        thing.keyframe_insert(path, frame=frame)
    straight(thing)


def camera(perspective):
    data = bpy.data.cameras.new("Camera")
    data.type = "PERSP" if perspective else "ORTHO"
    data.ortho_scale = 2.0
    data.sensor_width, data.lens = 36.0, 50.0
    thing = bpy.data.objects.new("Camera", data)
    thing.location = (0.0, 0.0, 5.0)
    bpy.context.scene.collection.objects.link(thing)
    bpy.context.scene.camera = thing
    return thing


def lamp():
    """A glowing panel, which shines alike in both."""
    panel = add("Panel", [(-3, -1, 2), (-3, 1, 2), (-2, 1, 4), (-2, -1, 4)], [(0, 1, 2, 3)], material("Panel", 6.0, 0.0))
    panel.visible_camera = False


def cube():
    camera(False)
    animate(box("Box", (0.3, 0.3, 0.3), material("Glow", 1.0, 0.0)), "location", (-0.9, 0.1, 0.0), (0.9, -0.1, 0.0))


def wheel():
    camera(False)
    bar = box("Bar", (0.7, 0.08, 0.1), material("Glow", 1.0, 0.0))
    bar.location = (0.15, 0.0, 0.0)
    bar.scale = (1.0, 1.5, 1.0)
    bar.cycles.motion_steps = 3
    animate(bar, "rotation_euler", (0.0, 0.0, -1.6), (0.0, 0.0, 1.6))


def pan():
    looks = camera(True)
    looks.rotation_mode = "QUATERNION"
    looks.cycles.motion_steps = 2
    for frame, turn, x in ((FRAME - 1, -0.25, -0.3), (FRAME + 1, 0.25, 0.4)):
        looks.rotation_quaternion = Matrix.Rotation(turn, 4, "Y").to_quaternion()
        looks.location.x = x
        looks.keyframe_insert("rotation_quaternion", frame=frame)
        looks.keyframe_insert("location", frame=frame)
    straight(looks)
    for i in range(5):
        box(f"Post {i}", (0.1, 0.5, 0.1), material(f"Glow {i}", 1.0, 0.0)).location = (0.8 * i - 1.6, 0.0, -0.4 * i)


def sheet():
    """Shape keys bend a lit, smooth sheet."""
    camera(False)
    lamp()
    thing = grid("Sheet", 12, material("White", 0.0, 0.8))
    thing.shape_key_add(name="Basis")
    bent = thing.shape_key_add(name="Bent")
    for point in bent.data:
        x, y, z = point.co
        point.co = (0.8 * x, y, 0.6 * math.sin(3.0 * x))
    thing.cycles.use_deform_motion = True
    thing.cycles.motion_steps = 2
    for frame, value in ((FRAME - 1, -0.5), (FRAME + 1, 1.5)):
        bent.slider_min, bent.slider_max = -1.0, 2.0
        bent.value = value
        bent.keyframe_insert("value", frame=frame)
    straight(thing.data.shape_keys)


def shade():
    """A blocker and its shadow: camera rays and light see the same time."""
    camera(False)
    lamp()
    add("Floor", [(-2, -2, -0.5), (2, -2, -0.5), (2, 2, -0.5), (-2, 2, -0.5)], [(0, 1, 2, 3)], material("Floor", 0.0, 0.8))
    block = box("Block", (0.2, 0.2, 0.05), material("Block", 0.0, 0.4))
    block.cycles.motion_steps = 2
    animate(block, "location", (-0.7, 0.0, 0.2), (0.9, 0.3, 0.2))


def times():
    """Offsets from the frame at which Cycles looks at what has most motion steps."""
    return [SHUTTER * (i / 16 - 0.5) for i in range(17)]


def numbers(values):
    return ", ".join(f"{value:.9g}" for value in values)


def triples(values):
    return ", ".join(f"({numbers(value)})" for value in values)


def samples(scene, value):
    """Time samples of what `value` says at each time."""
    rows = []
    for offset in times():
        whole = math.floor(FRAME + offset)
        scene.frame_set(whole, subframe=FRAME + offset - whole)
        rows.append(f"{FRAME + offset:.9g}: {value(bpy.context.evaluated_depsgraph_get())}")
    scene.frame_set(FRAME)
    return "{ " + ", ".join(rows) + " }"


def transform(scene, thing):
    def value(depsgraph):
        return f"({triples(thing.evaluated_get(depsgraph).matrix_world.transposed())})"

    return (f"matrix4d xformOp:transform.timeSamples = {samples(scene, value)}\n"
            'uniform token[] xformOpOrder = ["xformOp:transform"]\n')


def prim(scene, thing):
    if thing.type == "CAMERA":
        data = thing.data
        width = data.ortho_scale * 10.0 if data.type == "ORTHO" else data.sensor_width
        kind = "orthographic" if data.type == "ORTHO" else "perspective"
        return (f'def Camera "Camera" {{ token projection = "{kind}"\nfloat horizontalAperture = {width}\n'
                f"float verticalAperture = {width}\nfloat focalLength = {data.lens}\nfloat2 clippingRange = (0.1, 100)\n"
                f"double shutter:open = {-0.5 * SHUTTER}\ndouble shutter:close = {0.5 * SHUTTER}\n"
                f"{transform(scene, thing)} }}\n")
    name = thing.name.replace(" ", "_")
    mesh = thing.data
    counts = ", ".join(str(len(face.vertices)) for face in mesh.polygons)
    indices = ", ".join(str(i) for face in mesh.polygons for i in face.vertices)
    points = lambda depsgraph: f"[{triples(v.co for v in thing.evaluated_get(depsgraph).data.vertices)}]"
    text = (f'def Mesh "{name}" {{ uniform token subdivisionScheme = "none"\nint[] faceVertexCounts = [{counts}]\n'
            f"int[] faceVertexIndices = [{indices}]\npoint3f[] points.timeSamples = {samples(scene, points)}\n")
    if mesh.polygons[0].use_smooth:
        shaped = thing.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
        flat = [vertex.normal for vertex in shaped.vertices]
        text += f'normal3f[] normals = [{triples(flat)}] ( interpolation = "vertex" )\n'
    if not thing.visible_camera:
        text += "bool primvars:visibility:camera = false\n"
    look = mesh.materials[0].name.replace(" ", "_")
    return text + f"rel material:binding = </Looks/{look}>\n{transform(scene, thing)} }}\n"


def looks():
    text = 'def Scope "Looks" {\n'
    for made in bpy.data.materials:
        name = made.name.replace(" ", "_")
        e, d = made["emission"], made["diffuse"]
        text += (f'def Material "{name}" {{ token outputs:surface.connect = </Looks/{name}/S.outputs:surface>\n'
                 'def Shader "S" { uniform token info:id = "UsdPreviewSurface"\n'
                 f"color3f inputs:emissiveColor = ({e}, {e}, {e})\ncolor3f inputs:diffuseColor = ({d}, {d}, {d})\n"
                 "int inputs:useSpecularWorkflow = 1\ncolor3f inputs:specularColor = (0, 0, 0)\n"
                 "float inputs:roughness = 1\ntoken outputs:surface } }\n")
    return text + "}\n"


def main(name, spp, out):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    globals()[name]()
    scene.frame_set(FRAME)
    with open(out + ".usda", "w") as file:
        file.write('#usda 1.0\n( upAxis = "Z"\nmetersPerUnit = 1\n)\n')
        file.writelines(prim(scene, thing) for thing in scene.objects)
        file.write(looks())
    render = scene.render
    render.engine = "CYCLES"
    render.use_motion_blur, render.motion_blur_shutter = True, SHUTTER
    if hasattr(render, "motion_blur_position"):
        render.motion_blur_position = "CENTER"
    else:
        scene.cycles.motion_blur_position = "CENTER"
    scene.cycles.samples, scene.cycles.use_adaptive_sampling, scene.cycles.use_denoising = int(spp), False, False
    scene.cycles.pixel_filter_type = "BOX"
    scene.cycles.max_bounces = 12
    render.resolution_x = render.resolution_y = SIZE
    render.resolution_percentage, render.film_transparent = 100, False
    render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR", "32"
    render.filepath = out + ".exr"
    bpy.ops.render.render(write_still=True)


main(*sys.argv[1:])
