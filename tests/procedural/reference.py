"""Values of procedural textures as Cycles computes them, for tests/procedural.

    PYTHON_WITH_BPY tests/procedural/reference.py OUT_DIR [TEXTURE ..]

One face of a grid is one evaluation and fills one pixel. Position and sockets reach the node as face
attributes, which Cycles does not interpolate, so they are exact; what is picked from menus is a material.
Outputs leave through AOVs, which keep what is negative or above 1. A line of a table is

    menu choices | position and sockets | outputs
"""

import itertools
import os
import sys
import tempfile

import bpy
import mathutils
import numpy as np
import OpenImageIO as oiio

WIDTH = 64


class Texture:
    """A node: its menus, its sockets with values worth trying, its outputs."""

    def __init__(self, node, menus, sockets, outputs, rows, extent=6.0, inputs=None):
        self.node, self.menus, self.sockets, self.outputs = node, menus, sockets, outputs
        self.rows, self.extent = rows, extent
        self.inputs = inputs


POSITION = {"Vector": 3}
PLACE = {"Vector": 3, "W": 1}
DIMENSIONS = ["1D", "2D", "3D", "4D"]


def menus(**choices):
    return [dict(zip(choices, values)) for values in itertools.product(*choices.values())]


def voronoi_menus():
    features = ["F1", "F2", "SMOOTH_F1"]
    metrics = ["EUCLIDEAN", "MANHATTAN", "CHEBYCHEV", "MINKOWSKI"]
    chosen = menus(voronoi_dimensions=DIMENSIONS, feature=features, distance=metrics, normalize=[False, True])
    chosen += menus(voronoi_dimensions=DIMENSIONS, feature=["DISTANCE_TO_EDGE"], distance=["EUCLIDEAN"], normalize=[False, True])
    return chosen + menus(
        voronoi_dimensions=DIMENSIONS, feature=["N_SPHERE_RADIUS"], distance=["EUCLIDEAN"], normalize=[False]
    )


def brick_menus():
    return [
        dict(zip(["offset", "offset_frequency", "squash", "squash_frequency"], values))
        for values in [(0.5, 2, 1.0, 2), (0.3, 3, 0.6, 2), (0.0, 1, 1.7, 4), (1.0, 4, 99.0, 1), (0.75, 99, 0.0, 3)]
    ]


def wave_menus():
    bands = menus(wave_type=["BANDS"], bands_direction=["X", "Y", "Z", "DIAGONAL"], wave_profile=["SIN", "SAW", "TRI"])
    rings = menus(wave_type=["RINGS"], rings_direction=["X", "Y", "Z", "SPHERICAL"], wave_profile=["SIN", "SAW", "TRI"])
    return bands + rings


def atmospheres(disc):
    """Skies by name of the menu entry; sun elevation, rotation, size, intensity, altitude, densities."""
    names = ["sun_elevation", "sun_rotation", "sun_size", "sun_intensity", "altitude"]
    names += ["air_density", DUST, "ozone_density"]
    values = [
        (0.2617994, 0.0, 0.3, 1.0, 100.0, 1.0, 1.0, 1.0),
        (0.9, 2.3, 0.8, 0.3, 0.0, 1.0, 1.0, 1.0),
        (0.05, -4.0, 0.25, 2.0, 3000.0, 2.5, 0.0, 3.0),
        (1.9, 1.0, 0.2, 1.0, 20.0, 0.3, 4.0, 0.0),
        (-0.1, 0.7, 0.4, 1.0, 55000.0, 1.0, 6.0, 1.0),
        (-1.2, 9.0, 0.4, 1.0, 500.0, 1.0, 1.0, 1.0),
    ]
    kinds = ["SINGLE_SCATTERING", "MULTIPLE_SCATTERING"] if bpy.app.version >= (5, 0, 0) else ["NISHITA"]
    return [dict(sky_type=kind, sun_disc=disc, **dict(zip(names, v))) for kind in kinds for v in values]


def preethams():
    suns = [(0.0, 0.0, 1.0, 2.2), (0.6, -0.64, 0.48, 1.0), (-0.8, 0.6, 0.0, 5.0), (0.36, 0.48, -0.8, 10.0)]
    return [dict(sky_type="PREETHAM", sun_direction=sun[:3], turbidity=sun[3]) for sun in suns]


def directions(texture, count):
    rows = np.random.default_rng(20).normal(size=(count, 3))
    return {"Vector": (rows / np.linalg.norm(rows, axis=1, keepdims=True)).astype(np.float32)}


DUST = "aerosol_density" if bpy.app.version >= (5, 0, 0) else "dust_density"

TEXTURES = {
    "sky": Texture("ShaderNodeTexSky", atmospheres(disc=False), {"Vector": 3}, {"Color": 3}, rows=6, inputs=directions),
    "preetham": Texture("ShaderNodeTexSky", preethams(), {"Vector": 3}, {"Color": 3}, rows=12, inputs=directions),
    "noise": Texture(
        "ShaderNodeTexNoise",
        menus(
            noise_dimensions=DIMENSIONS,
            noise_type=["FBM", "MULTIFRACTAL", "HYBRID_MULTIFRACTAL", "RIDGED_MULTIFRACTAL", "HETERO_TERRAIN"],
            normalize=[False, True],
        ),
        {
            **PLACE,
            "Scale": [1.0, 5.0, -3.7, 0.35, 123.4],
            "Detail": [0.0, 2.0, 3.3, 7.75, 15.0, 0.5, -1.0, 20.0],
            "Roughness": [0.0, 0.5, 1.0, 0.72, -0.3, 1.2],
            "Lacunarity": [2.0, 1.0, 0.0, 3.17, -2.0, 0.5],
            "Offset": [0.0, 1.0, -0.4, 0.7],
            "Gain": [1.0, 0.0, 2.5, 0.3],
            "Distortion": [0.0, 0.0, 0.5, 3.0, -1.2],
        },
        {"Color": 3},
        rows=7,
    ),
    "voronoi": Texture(
        "ShaderNodeTexVoronoi",
        voronoi_menus(),
        {
            **PLACE,
            "Scale": [1.0, 5.0, -3.7, 0.35],
            "Detail": [0.0, 0.0, 1.0, 2.6, 4.0, 0.5, -1.0],
            "Roughness": [0.5, 0.0, 1.0, 0.72, -0.3, 1.6],
            "Lacunarity": [2.0, 1.0, 3.17, 0.6],
            "Smoothness": [1.0, 0.0, 0.25, 0.8, 2.0],
            "Exponent": [0.5, 2.0, 1.0, 6.5],
            "Randomness": [1.0, 0.0, 0.6, 1.5],
        },
        {"Distance": 1, "Color": 3, "Position": 3, "W": 1, "Radius": 1},
        rows=3 if bpy.app.version >= (5, 0, 0) else 2,
    ),
    "wave": Texture(
        "ShaderNodeTexWave",
        wave_menus(),
        {
            **POSITION,
            "Scale": [1.0, 5.0, -3.7, 0.0],
            "Distortion": [0.0, 1.0, -4.0, 0.3],
            "Detail": [2.0, 0.0, 3.3, 15.0],
            "Detail Scale": [1.0, 0.0, -2.5, 8.0],
            "Detail Roughness": [0.5, 0.0, 1.0, 0.8],
            "Phase Offset": [0.0, 1.0, -40.0],
        },
        {"Factor": 1},
        rows=6,
    ),
    "checker": Texture(
        "ShaderNodeTexChecker", [{}], {**POSITION, "Scale": [1.0, 5.0, -3.7, 0.0, 1e6]}, {"Factor": 1}, rows=120
    ),
    "brick": Texture(
        "ShaderNodeTexBrick",
        brick_menus(),
        {
            **POSITION,
            "Color1": 3,
            "Color2": 3,
            "Mortar": 3,
            "Scale": [1.0, 5.0, -3.7],
            "Mortar Size": [0.02, 0.0, 0.125, 0.4],
            "Mortar Smooth": [0.1, 0.0, 1.0, 2.0],
            "Bias": [0.0, -0.6, 0.4, -1.0],
            "Brick Width": [0.5, 1.3, 0.01],
            "Row Height": [0.25, 0.9, 0.01],
        },
        {"Color": 3, "Factor": 1},
        rows=15,
    ),
    "gradient": Texture(
        "ShaderNodeTexGradient",
        menus(
            gradient_type=["LINEAR", "QUADRATIC", "EASING", "DIAGONAL", "SPHERICAL", "QUADRATIC_SPHERE", "RADIAL"]
        ),
        {**POSITION},
        {"Factor": 1},
        rows=12,
        extent=1.2,
    ),
    "magic": Texture(
        "ShaderNodeTexMagic",
        menus(turbulence_depth=list(range(11))),
        {**POSITION, "Scale": [5.0, 1.0, -3.7, 0.0], "Distortion": [1.0, 0.0, -0.7, 3.0]},
        {"Color": 3, "Factor": 1},
        rows=10,
    ),
    "white_noise": Texture(
        "ShaderNodeTexWhiteNoise", menus(noise_dimensions=DIMENSIONS), {**PLACE}, {"Value": 1, "Color": 3}, rows=24
    ),
    "gabor": Texture(
        "ShaderNodeTexGabor",
        menus(gabor_type=["2D", "3D"]),
        {
            **POSITION,
            "Scale": [1.0, 5.0, -3.7],
            "Frequency": [2.0, 0.5, 7.3, 0.0],
            "Anisotropy": [1.0, 0.0, 0.4, 1.5],
            "Orientation 2D": [0.785, 0.0, -2.0, 9.0],
            "Orientation 3D": 3,
        },
        {"Value": 1, "Phase": 1, "Intensity": 1},
        rows=40,
    ),
}


def socket(sockets, name):
    """A socket by its name or, where two share one, its identifier; 4.x calls a factor Fac."""
    for candidate in sockets:
        if name in (candidate.name, candidate.identifier) or (name, candidate.name) == ("Factor", "Fac"):
            return candidate
    raise KeyError(name)


def make_inputs(texture, count):
    """Short decimals, so that the table is small and exact."""
    rng = np.random.default_rng(20)
    inputs = {}
    for name, values in texture.sockets.items():
        if isinstance(values, int):
            spread = 1.0 if name in ("Color1", "Color2", "Mortar", "Orientation 3D") else texture.extent
            low = -spread if name in ("Vector", "W", "Orientation 3D") else 0.0
            numbers = rng.uniform(low, spread, (count, values)).round(3)
            if name in ("Vector", "W"):
                whole = rng.random(count) < 0.1
                numbers[whole] = numbers[whole].round()
                far = rng.random(count) < 0.05
                numbers[far] = (numbers[far] * 1e4).round()
        else:
            numbers = rng.choice(values, (count, 1))
        inputs[name] = numbers.astype(np.float32)
    return inputs


def make_material(texture, chosen):
    material = bpy.data.materials.new("m")
    if bpy.app.version < (5, 0, 0):
        material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    node = tree.nodes.new(texture.node)
    for name, value in chosen.items():
        setattr(node, name, value)
    for name, values in texture.sockets.items():
        target = socket(node.inputs, name)
        if not target.enabled:
            continue
        attribute = tree.nodes.new("ShaderNodeAttribute")
        attribute.attribute_name = "in " + name
        tree.links.new(attribute.outputs["Vector" if values == 3 else 2], target)
    for name, channels in texture.outputs.items():
        source = socket(node.outputs, name)
        if source.enabled:
            aov = tree.nodes.new("ShaderNodeOutputAOV")
            aov.aov_name = "out " + name
            tree.links.new(source, aov.inputs["Color" if channels == 3 else "Value"])
    emission = tree.nodes.new("ShaderNodeEmission")
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(emission.outputs[0], output.inputs["Surface"])
    return material


def make_grid(texture, inputs, count):
    height = max(4, -(-count // WIDTH))  # Blender renders no less than 4 rows.
    column, row = np.arange(count) % WIDTH, np.arange(count) // WIDTH
    corners = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    vertices = (np.stack([column, row, 0 * row], 1)[:, None] + corners).reshape(-1, 3)
    mesh = bpy.data.meshes.new("grid")
    mesh.from_pydata(vertices.tolist(), [], np.arange(4 * count).reshape(-1, 4).tolist())
    for name, numbers in inputs.items():
        vector = numbers.shape[1] == 3
        attribute = mesh.attributes.new("in " + name, "FLOAT_VECTOR" if vector else "FLOAT", "FACE")
        attribute.data.foreach_set("vector" if vector else "value", numbers.ravel())
    for chosen in texture.menus:
        mesh.materials.append(make_material(texture, chosen))
    mesh.polygons.foreach_set("material_index", np.arange(count) // texture.rows)
    scene = bpy.context.scene
    scene.collection.objects.link(bpy.data.objects.new("grid", mesh))
    camera = bpy.data.cameras.new("camera")
    camera.type, camera.ortho_scale = "ORTHO", max(WIDTH, height)
    scene.camera = bpy.data.objects.new("camera", camera)
    scene.camera.location = (WIDTH / 2, height / 2, 1)
    scene.collection.objects.link(scene.camera)
    scene.render.resolution_x, scene.render.resolution_y = WIDTH, height
    return row * WIDTH + column


def render_planes():
    """One sample a pixel: channels by name, rows from the bottom."""
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.resolution_percentage = 100
    scene.cycles.samples = 1
    scene.cycles.use_adaptive_sampling = scene.cycles.use_denoising = False
    scene.cycles.pixel_filter_type = "BOX"
    image = scene.render.image_settings
    if hasattr(image, "media_type"):
        image.media_type = "MULTI_LAYER_IMAGE"
    image.file_format, image.color_depth = "OPEN_EXR_MULTILAYER", "32"
    with tempfile.TemporaryDirectory() as folder:
        scene.render.filepath = os.path.join(folder, "picture.exr")
        bpy.ops.render.render(write_still=True)
        opened = oiio.ImageInput.open(scene.render.filepath)
        planes, part = {}, 0
        while opened.seek_subimage(part, 0):
            pixels = opened.read_image(part, 0, 0, opened.spec().nchannels, "float")
            for i, name in enumerate(opened.spec().channelnames):
                planes[name] = pixels[::-1, :, i].ravel()
            part += 1
        opened.close()
    return planes


def render(texture):
    for name, channels in texture.outputs.items():
        aov = bpy.context.view_layer.aovs.add()
        aov.name, aov.type = "out " + name, "COLOR" if channels == 3 else "VALUE"
    planes = render_planes()
    columns = []
    for name, channels in texture.outputs.items():
        columns += [planes[f"ViewLayer.out {name}.{c}"] for c in ("RGB" if channels == 3 else "X")]
    return np.stack(columns, 1)


def write(path, texture, inputs, outputs):
    def text(numbers):
        return " ".join(np.format_float_positional(np.float32(n), trim="-") for n in numbers)

    with open(path, "w") as file:
        file.write(f"# {', '.join(texture.menus[0])} | {', '.join(texture.sockets)} | {', '.join(texture.outputs)}\n")
        for i, values in enumerate(outputs):
            chosen = texture.menus[i // texture.rows]
            numbers = np.concatenate([numbers[i] for numbers in inputs.values()])
            file.write(f"{' '.join(str(c).strip('()').replace(',', '') for c in chosen.values())} | {text(numbers)} | {text(values)}\n")


def render_world(chosen, picture):
    """A look at the sun, of the sky or of the directions themselves."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.world = bpy.data.worlds.new("world")
    if bpy.app.version < (5, 0, 0):
        scene.world.use_nodes = True
    tree = scene.world.node_tree
    tree.nodes.clear()
    if picture == "sky":
        source = tree.nodes.new("ShaderNodeTexSky")
        for name, value in chosen.items():
            setattr(source, name, value)
        color = source.outputs[0]
    else:
        source = tree.nodes.new("ShaderNodeVectorMath")
        source.operation = "MULTIPLY_ADD"
        source.inputs[1].default_value = source.inputs[2].default_value = (0.5, 0.5, 0.5)
        tree.links.new(tree.nodes.new("ShaderNodeTexCoord").outputs["Generated"], source.inputs[0])
        color = source.outputs[0]
    background, output = tree.nodes.new("ShaderNodeBackground"), tree.nodes.new("ShaderNodeOutputWorld")
    tree.links.new(color, background.inputs["Color"])
    tree.links.new(background.outputs[0], output.inputs["Surface"])
    up, turn = chosen["sun_elevation"], chosen["sun_rotation"]
    sun = mathutils.Vector((np.cos(up) * np.sin(turn), np.cos(up) * np.cos(turn), np.sin(up)))
    camera = bpy.data.cameras.new("camera")
    camera.angle = 1.2 * chosen["sun_size"]
    scene.camera = bpy.data.objects.new("camera", camera)
    scene.camera.rotation_euler = sun.to_track_quat("-Z", "Y").to_euler()
    scene.collection.objects.link(scene.camera)
    scene.render.resolution_x = scene.render.resolution_y = 4
    planes = render_planes()
    return np.stack([planes[f"ViewLayer.Combined.{c}"] for c in "RGB"], 1)


def write_suns(folder):
    """The sun's disc, which only a world shows."""
    menus = atmospheres(disc=True)
    texture = Texture("ShaderNodeTexSky", menus, {"Vector": 3}, {"Color": 3}, rows=4)
    both = [[render_world(chosen, picture)[1::4] for chosen in menus] for picture in ("directions", "sky")]
    seen, colors = (np.concatenate(pictures) for pictures in both)
    name = "sun" if bpy.app.version >= (5, 0, 0) else "sun_4"
    write(os.path.join(folder, f"{name}.txt"), texture, {"Vector": seen * 2 - 1}, colors)


def main(folder, names):
    if not names or "sun" in names:
        write_suns(folder)
    for name in names or TEXTURES:
        if name == "sun":
            continue
        texture = TEXTURES[name]
        if not hasattr(bpy.types, texture.node):
            continue
        bpy.ops.wm.read_factory_settings(use_empty=True)
        count = len(texture.menus) * texture.rows
        inputs = (texture.inputs or make_inputs)(texture, count)
        pixels = make_grid(texture, inputs, count)
        # Skies, their colours and the scatter of cells changed with 5.0; all else is the same in 4.2, 4.5 and 5.0.
        table = f"{name}_4" if name in ("preetham", "sky", "voronoi") and bpy.app.version < (5, 0, 0) else name
        write(os.path.join(folder, f"{table}.txt"), texture, inputs, render(texture)[pixels])


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2:])
