"""Images as the engine takes them: a path, the bytes of a packed file, or pixels."""

import os

import bpy
import numpy as np


def path_of(image, user):
    """Absolute path of the image, at the frame of `user` for a sequence; "" for one of no file."""
    if image.source not in {"FILE", "SEQUENCE", "MOVIE", "TILED"}:
        return ""
    raw = image.filepath_from_user(image_user=user) if image.source == "SEQUENCE" and user else image.filepath_raw
    return os.path.normpath(bpy.path.abspath(raw, library=image.library)) if raw else ""


def describe(image, path):
    """What the document says of an image."""
    tiled = image.source == "TILED"
    # Pixels of tiles are not to be had but from files.
    painted = image.is_dirty and not tiled
    return {
        "path": path,
        "colorspace": image.colorspace_settings.name,
        "alpha_mode": image.alpha_mode,
        "tiles": [tile.number for tile in image.tiles] if tiled else [],
        "in_memory": bool(image.packed_files) or image.source == "GENERATED" or painted,
    }


def hand_over(scene, name, image):
    """Gives an image that is in memory to the engine's scene."""
    if image.source == "TILED":
        for file in image.packed_files:
            scene.set_image_bytes(name, file.packed_file.data, tile=file.tile_number)
        return
    if image.packed_file is not None and not image.is_dirty:
        scene.set_image_bytes(name, image.packed_file.data)
        return
    width, height = image.size
    pixels = np.empty(width * height * 4, np.float32)
    if image.channels == 4:
        image.pixels.foreach_get(pixels)
    else:
        raw = np.empty(width * height * image.channels, np.float32)
        image.pixels.foreach_get(raw)
        raw = raw.reshape(-1, image.channels)
        pixels = pixels.reshape(-1, 4)
        pixels[:] = 1.0
        pixels[:, :3] = raw[:, :3] if image.channels >= 3 else raw[:, :1]
    scene.set_image_pixels(name, width, height, pixels.reshape(-1), image.is_float)
