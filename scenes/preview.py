"""Renders a scene file with Cycles as a reader finds it: `python scenes/preview.py SCENE.glb OUT.png [HDR] [WIDTH] [SPP]`."""
import math
import sys

import bpy


def main(scene_file, out, hdr=None, width="640", spp="64"):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=scene_file)
    scene = bpy.context.scene
    for thing in scene.objects:
        if thing.type == "CAMERA":
            scene.camera = thing
        if thing.type == "LIGHT" and thing.data.type == "SUN":
            thing.data.angle = thing.get("angle", math.radians(0.53))
    world = bpy.data.worlds.new("World")
    scene.world = world
    world.use_nodes = True
    back = world.node_tree.nodes["Background"]
    back.inputs["Color"].default_value = (0, 0, 0, 1)
    if hdr:
        node = world.node_tree.nodes.new("ShaderNodeTexEnvironment")
        node.image = bpy.data.images.load(hdr)
        world.node_tree.links.new(node.outputs["Color"], back.inputs["Color"])
    scene.render.engine = "CYCLES"
    scene.cycles.samples = int(spp)
    scene.cycles.use_denoising = True
    scene.cycles.use_adaptive_sampling = False
    scene.render.resolution_x, scene.render.resolution_y = int(width), int(width) * 9 // 16
    scene.render.resolution_percentage = 100
    scene.view_settings.view_transform = "Standard"
    scene.render.image_settings.file_format = "PNG"
    scene.render.filepath = out
    bpy.ops.render.render(write_still=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
