"""Scenes for the tests of Export for Penumbra: every lamp with everything that a format may lose."""

import math

import bpy
import scenes


def lamps():
    """All kinds of lamps, each with more than the formats hold."""
    scenes.room()
    scenes.world(0.4, (0.2, 0.5, 1.0))
    has = bpy.types.Light.bl_rna.properties
    turned = (0.3, 0.4, 0.1)
    add = scenes.lamp
    add("POINT", (1.2, -0.8, 2.0), energy=100.0, shadow_soft_size=0.4).scale = (2.0, 2.0, 2.0)
    add("POINT", (1.4, -0.8, 2.0), energy=70.0, shadow_soft_size=0.3, use_soft_falloff=False, use_shadow=False)
    add("POINT", (1.6, -0.8, 2.0), energy=50.0, shadow_soft_size=0.0, color=(1.0, 0.5, 0.25))
    add("SPOT", (1.2, -0.8, 2.5), turned, energy=300.0, shadow_soft_size=0.2, spot_size=1.2, spot_blend=0.4)
    add("SUN", rotation=turned, energy=3.0, angle=0.2, color=(1.0, 0.8, 0.6))
    add("AREA", (1.2, -0.8, 2.5), turned, energy=100.0, size=0.5)
    add("AREA", (0.2, -0.8, 2.5), turned, energy=80.0, shape="RECTANGLE", size=1.0, size_y=2.0, spread=math.radians(60))
    ellipse = add("AREA", (1.2, 0.8, 2.5), turned, energy=60.0, shape="ELLIPSE", size=1.0, size_y=0.5, use_shadow=False)
    ellipse.scale = (1.5, 0.8, 1.0)
    ellipse.visible_camera = True
    add("AREA", (2.2, -0.8, 2.5), turned, energy=40.0, shape="DISK", size=0.7).scale = (1.0, 1.0, -1.0)
    if "exposure" in has:
        add("POINT", (0.0, 1.0, 3.0), energy=10.0, shadow_soft_size=0.2, exposure=1.5)
        add("POINT", (0.0, 2.0, 3.0), energy=10.0, shadow_soft_size=0.2, normalize=False)
        add("SUN", rotation=turned, energy=2.0, angle=0.3, normalize=False)
        add("AREA", (0.0, 2.0, 3.0), energy=10.0, size=0.8, normalize=False)
    if "use_temperature" in has:
        add("POINT", (0.0, 3.0, 3.0), energy=10.0, shadow_soft_size=0.2, use_temperature=True, temperature=3000.0)
        add("POINT", (0.0, 4.0, 3.0), energy=10.0, shadow_soft_size=0.2, temperature=3000.0)


def orthographic():
    """A camera that USD's exporter leaves out."""
    camera = scenes.room()
    camera.data.type, camera.data.ortho_scale = "ORTHO", 5.0
    scenes.lamp("POINT", (1.2, -0.8, 2.0), energy=100.0, shadow_soft_size=0.4)


def moving():
    """A lamp whose spread and energy change, and a camera that keeps an object in focus."""
    camera = scenes.room()
    lamp = scenes.lamp("AREA", (0.0, 0.0, 3.0), energy=100.0, size=1.0)
    camera.data.dof.use_dof = True
    camera.data.dof.focus_object = lamp
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, 6
    for frame, energy, spread in ((1, 100.0, 3.0), (5, 200.0, 1.0), (6, 100.0, 3.0)):
        scene.frame_set(frame)
        lamp.data.energy, lamp.data.spread = energy, spread
        lamp.location.x = frame
        for holder, path in ((lamp.data, "energy"), (lamp.data, "spread"), (lamp, "location")):
            holder.keyframe_insert(path)
    scene.frame_set(1)


def blurred():
    moving()
    render = bpy.context.scene.render
    render.use_motion_blur, render.motion_blur_shutter, render.motion_blur_position = True, 0.6, "START"


def instances():
    """Geometry nodes that instance what is no object's, and two instances of a collection that holds a lamp."""
    scenes.room()
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=2, radius=0.1)
    ball = bpy.context.object
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=3, y_subdivisions=3, size=2)
    grid = bpy.context.object
    tree = bpy.data.node_groups.new("Instances", "GeometryNodeTree")
    for way in ("INPUT", "OUTPUT"):
        tree.interface.new_socket("Geometry", in_out=way, socket_type="NodeSocketGeometry")
    new, link = tree.nodes.new, tree.links.new
    source, target = new("NodeGroupInput"), new("NodeGroupOutput")
    instance, shape = new("GeometryNodeInstanceOnPoints"), new("GeometryNodeObjectInfo")
    shape.inputs["Object"].default_value = ball
    link(source.outputs[0], instance.inputs["Points"])
    link(shape.outputs["Geometry"], instance.inputs["Instance"])
    link(instance.outputs[0], target.inputs[0])
    grid.modifiers.new("Instances", "NODES").node_group = tree
    collection = bpy.data.collections.new("Lamps")
    light = bpy.data.lights.new("Inside", "AREA")
    light.spread = 1.0
    collection.objects.link(bpy.data.objects.new("Inside", light))
    for x in (1.0, 2.0):
        scenes.add(f"Lamps{x}", None, location=(x, 0.0, 3.0), instance_type="COLLECTION", instance_collection=collection)
