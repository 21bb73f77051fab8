"""Pictures in the cache: EXR files under target/cycles/."""

import numpy as np
import OpenImageIO as oiio


def path(folder, renderer, spp, seed):
    return folder / f"{renderer}.{spp}spp.{seed}.exr"


def read(file, *passes):
    """Pixels (height × width × 3, float64) of each pass and the attributes of the first part."""
    source = oiio.ImageInput.open(str(file))
    if source is None:
        raise OSError(f"{file}: {oiio.geterror()}")
    channels, attributes, part = {}, {}, 0
    while source.seek_subimage(part, 0):
        spec = source.spec()
        pixels = source.read_image(part, 0, 0, spec.nchannels, oiio.FLOAT)
        channels.update(zip(spec.channelnames, np.moveaxis(pixels, -1, 0)))
        attributes = attributes or {a.name: a.value for a in spec.extra_attribs}
        part += 1
    picture = lambda name: np.stack([channels[f"ViewLayer.{name}.{c}"] for c in "RGB"], -1).astype(float)
    return [picture(name) for name in passes], attributes


def write(file, pixels):
    """Three channels, float for EXR; for PNG values of 0 to 1, sRGB encoded here."""
    if file.suffix == ".png":
        linear = np.clip(pixels, 0, 1)
        pixels = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    height, width, _ = pixels.shape
    out = oiio.ImageOutput.create(str(file))
    out.open(str(file), oiio.ImageSpec(width, height, 3, oiio.UINT8 if file.suffix == ".png" else oiio.FLOAT))
    out.write_image(np.ascontiguousarray(pixels, np.float32))
    out.close()


def write_sky(case, folder):
    """The case's surroundings as a file that both renderers read."""
    file = folder / "sky.exr"
    if not file.exists():
        write(file, case.image)
    return file
