"""What other programs see in Penumbra's EXR files: OpenImageIO and Blender (image loader, compositor, Cryptomatte).

`cargo test --ignore-rust-version --test output` leaves readers.exr and readers_half.exr in target/tmp.
"""

import json
import tempfile
from pathlib import Path

import bpy
import numpy as np
import OpenImageIO as oiio

FOLDER = Path(__file__).resolve().parents[2] / "target" / "tmp"
WIDTH, HEIGHT = 64, 48
U, V = np.meshgrid(np.arange(WIDTH, dtype=np.float32) / WIDTH, np.arange(HEIGHT, dtype=np.float32) / HEIGHT)
COLOR = np.stack([U, V, np.float32(0.25) + np.float32(0.5) * U * V], axis=-1)


def parts(path):
    """Part name to (channel names, channel formats, pixels, attributes), as OpenImageIO reads them."""
    result = {}
    file = oiio.ImageInput.open(str(path))
    index = 0
    while file.seek_subimage(index, 0):
        spec = file.spec()
        formats = [str(f) for f in spec.channelformats] or [str(spec.format)] * spec.nchannels
        pixels = file.read_image(index, 0, 0, spec.nchannels, oiio.FLOAT)
        attributes = {a.name: a.value for a in spec.extra_attribs}
        result[attributes["oiio:subimagename"]] = (spec.channelnames, formats, pixels, attributes)
        index += 1
    return result


def test_openimageio_reads_every_part(folder=FOLDER):
    float_parts, half_parts = parts(folder / "readers.exr"), parts(folder / "readers_half.exr")
    assert list(float_parts) == list(half_parts) and len(float_parts) == 46, list(float_parts)
    for name, (channels, formats, pixels, attributes) in float_parts.items():
        assert all(channel.rpartition(".")[0] == name for channel in channels), (name, channels)
        assert set(formats) == {"float"} and np.isfinite(pixels).all(), name
        color = attributes["colorInteropID"] == "lin_rec709_scene"
        assert color or attributes["colorInteropID"] == "data", name
        assert set(half_parts[name][1]) == {"half" if color else "float"}, name
        limit = np.clip(pixels, -65504, 65504) if color else pixels
        bound = np.abs(limit) / 2048 + 3e-8 if color else np.zeros_like(pixels)
        assert (np.abs(half_parts[name][2] - limit) <= bound).all(), name
    channels, _, combined, attributes = float_parts["ViewLayer.Combined"]
    assert [c[-1] for c in channels] == list("RGBA"), channels
    assert np.array_equal(combined[..., :3], COLOR * np.float32(3)), "Combined differs"
    assert list(float_parts["ViewLayer.Normal"][0])[0].endswith(".X")
    crypto = float_parts["ViewLayer.CryptoObject00"]
    assert sorted(c.rpartition(".")[2] for c in crypto[0]) == list("abgr"), crypto[0]
    assert attributes["software"].startswith("Penumbra") and attributes["Copyright"] == "Studio"
    assert attributes["Camera"] == "Camera" and attributes["RenderTime"] == "00:03.25"
    assert np.allclose(attributes["chromaticities"], [0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329])
    manifest = json.loads(attributes["cryptomatte/542cafa/manifest"])
    assert set(manifest) == {"Cube", "Kugel ö"}, manifest
    order = {c.rpartition(".")[2]: i for i, c in enumerate(crypto[0])}
    ids = crypto[2][..., order["r"]].copy().view(np.uint32)
    assert ids[0, 0] == int(manifest["Cube"], 16) and ids[0, -1] == int(manifest["Kugel ö"], 16)
    print("OpenImageIO: ok,", len(float_parts), "parts")


def composite(tree_for, folder):
    """Runs a compositor tree over an empty scene of the picture's size and returns RGBA, top row first."""
    scene = bpy.data.scenes.new("composite")
    bpy.context.window.scene = scene if bpy.context.window else scene
    scene.render.resolution_x, scene.render.resolution_y = WIDTH, HEIGHT
    scene.render.resolution_percentage = 100
    scene.view_settings.view_transform = "Raw"
    scene.camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    scene.collection.objects.link(scene.camera)
    tree = bpy.data.node_groups.new("compositor", "CompositorNodeTree")
    tree.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
    output = tree.nodes.new("NodeGroupOutput")
    tree.links.new(tree_for(tree), output.inputs[0])
    scene.compositing_node_group = tree
    scene.render.use_compositing = True
    settings = scene.render.image_settings
    settings.file_format, settings.color_depth = "OPEN_EXR", "32"
    path = Path(folder) / "composite.exr"
    scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True, scene=scene.name)
    file = oiio.ImageInput.open(str(path))
    return file.read_image(0, 0, 0, file.spec().nchannels, oiio.FLOAT)


def test_blender_composites_every_pass(folder=FOLDER):
    image = bpy.data.images.load(str(folder / "readers.exr"))
    _ = tuple(image.size)  # Blender looks at the file now and not before.
    assert image.type == "MULTILAYER", image.type
    parts_of_file = parts(folder / "readers.exr")
    color = lambda name: parts_of_file["ViewLayer." + name][2]

    def image_node(tree):
        node = tree.nodes.new("CompositorNodeImage")
        node.image = image
        return node

    def all_sockets(tree):
        sockets.extend(socket.name for socket in image_node(tree).outputs if socket.enabled)
        return image_node(tree).outputs["Combined"]

    sockets = []
    with tempfile.TemporaryDirectory() as scratch:
        result = composite(all_sockets, scratch)
        assert np.allclose(result[..., :3], color("Combined")[..., :3], rtol=1e-6), "Combined through the compositor"
        expected = {name.partition(".")[2] for name in parts_of_file}
        missing = expected - set(sockets)
        assert not missing, f"Blender's image node lacks {missing}; it has {sockets}"
        for name in ["Ambient Occlusion", "Shadow", "Diffuse Direct Unshadowed", "Diffuse Direct"]:
            result = composite(lambda tree: image_node(tree).outputs[name], scratch)
            assert np.allclose(result[..., :3], color(name), rtol=1e-6), name

        def matte(tree):
            node = tree.nodes.new("CompositorNodeCryptomatteV2")
            node.source, node.image = "IMAGE", image
            names = [item.identifier for item in node.bl_rna.properties["layer_name"].enum_items]
            node.layer_name = "ViewLayer.CryptoObject"
            node.matte_id = "Cube"
            layer_names.extend(names)
            return node.outputs["Matte"]

        layer_names = []
        result = composite(matte, scratch)
        left = np.arange(WIDTH) * 2 < WIDTH
        mask = result[..., 0] if result.ndim == 3 else result
        assert (mask[:, left] == 1).all() and (mask[:, ~left] == 0).all(), "the matte of Cube"
