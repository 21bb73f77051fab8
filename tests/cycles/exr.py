"""Files of many parts, one for each pass."""

import numpy as np
import OpenImageIO as oiio


def parts(path):
    """Name to (channel names, pixels)."""
    file, found, index = oiio.ImageInput.open(str(path)), {}, 0
    while file.seek_subimage(index, 0):
        spec = file.spec()
        found[spec.getattribute("oiio:subimagename")] = (spec.channelnames, file.read_image(index, 0, 0, spec.nchannels, "float"))
        index += 1
    file.close()
    return found


def save(path, found, half=()):
    """Writes parts; those whose name is in `half` as half floats."""
    specs = []
    for name, (channels, pixels) in found.items():
        spec = oiio.ImageSpec(pixels.shape[1], pixels.shape[0], len(channels), "half" if name in half else "float")
        spec.channelnames = channels
        spec.attribute("compression", "zip:9")
        spec.attribute("oiio:subimagename", name)
        specs.append(spec)
    out = oiio.ImageOutput.create(str(path))
    assert out.open(str(path), tuple(specs)), out.geterror()
    for index, (spec, (_, pixels)) in enumerate(zip(specs, found.values())):
        if index:
            assert out.open(str(path), spec, "AppendSubimage"), out.geterror()
        assert out.write_image(np.ascontiguousarray(pixels, np.float32)), out.geterror()
    out.close()


def with_light(path, to, first=None, names=("Glossy", "Transmission")):
    """Writes the file again, with color × direct and color × indirect of these: the light itself.

    Each engine divides light by what it takes for the color; the product holds however it does so. Parts that the file
    lacks are those of `first`.
    """
    found = {**(parts(first) if first else {}), **parts(path)}
    layers = {part.partition(".")[0] for part in found if "." in part}
    for layer in layers:
        for name in names:
            color = found.get(f"{layer}.{name} Color")
            for kind in ("Direct", "Indirect"):
                light = found.get(f"{layer}.{name} {kind}")
                if color and light:
                    part = f"{layer}.{name} Light {kind}"
                    found[part] = (tuple(f"{part}.{c}" for c in "RGB"), color[1] * light[1])
    save(to, found)
    return to


def pack(files, to):
    """Writes two pictures of one scene small: as half floats, and of the second what is not the same in the first."""
    first, second = ({part: it for part, it in parts(file).items() if "Noisy" not in part and "Debug" not in part} for file in files)
    second = {part: it for part, it in second.items() if not np.array_equal(it[1], first[part][1])}
    # Ids are bits, and distances reach beyond half floats.
    half = {part for part in first if not any(word in part for word in ("Crypto", "Depth", "Index"))}
    save(to[0], first, half)
    save(to[1], second, half)
