"""Hair of particle systems as strands: what Cycles makes of them."""

import numpy as np


def systems(obj, render):
    """(modifier, slot of its material) of each hair that shows as strands; `render` for F12, else the viewport."""
    for modifier in obj.modifiers:
        if modifier.type != "PARTICLE_SYSTEM" or not (modifier.show_render if render else modifier.show_viewport):
            continue
        settings = modifier.particle_system.settings
        if settings.type == "HAIR" and settings.render_type == "PATH":
            yield modifier, settings.material - 1


def hand_over(scene, key, name, obj, modifier, render, moving):
    """Gives the strands of a system of the evaluated `obj` to the engine's scene as shape `key`; False for none."""
    strands = points(obj, modifier, render)
    count, steps = strands.shape[:2]
    if count == 0:
        return False
    radii = _radii(modifier.particle_system.settings, strands)
    ends = np.arange(1, count + 1, dtype=np.uint32) * np.uint32(steps)
    scene.set_rounds(key, name, strands.astype(np.float32).reshape(-1), radii.astype(np.float32).reshape(-1), ends, True,
                     _uvs(obj, modifier, *_strands(modifier.particle_system, render)), moving)
    return True


def points(obj, modifier, render):
    """Points of the strands of a system of the evaluated `obj`, in its space: (strands, points of each, 3)."""
    system = modifier.particle_system
    settings = system.settings
    first, last = _strands(system, render)
    steps = 1 + 2 ** (settings.render_step if render else settings.display_step)
    if settings.kink == "SPIRAL":
        steps += settings.kink_extra_steps
    # Blender answers one key at a time; all that follows is arrays.
    ask = system.co_hair
    flat = [x for strand in range(first, last) for step in range(steps)
            for x in ask(obj, particle_no=strand, step=step)]
    world = np.asarray(flat, np.float64).reshape(-1, 3)
    inverse = np.asarray(obj.matrix_world.inverted_safe(), np.float64)
    return (world @ inverse[:3, :3].T + inverse[:3, 3]).reshape(-1, steps, 3)


def _uvs(obj, modifier, first, last):
    """Where on each UV map of the emitter the strands grow, the map to render with first."""
    system = modifier.particle_system
    ask, particles = system.uv_on_emitter, list(system.particles)
    layers = sorted(enumerate(obj.data.uv_layers), key=lambda item: not item[1].active_render)
    result = []
    for number, layer in layers:
        flat = [x for strand in range(first, last)
                for x in ask(modifier, particle=particles[min(strand, len(particles) - 1)], particle_no=strand,
                             uv_no=number)]
        result.append((layer.name, np.asarray(flat, np.float32)))
    return result


def _strands(system, render):
    """Numbers of the first strand that shows and of that behind the last: the children where there are some."""
    settings = system.settings
    parents, children = len(system.particles), len(system.child_particles)
    if not render:
        children = int(children * settings.display_percentage / 100.0)
    first = parents if settings.child_type != "NONE" and children else 0
    return first, parents + children


def _radii(settings, points):
    """Radius of every key (strands, steps): from root to tip by the length of the strand, shaped as set."""
    lengths = np.linalg.norm(np.diff(points, axis=1), axis=2).cumsum(axis=1)
    whole = lengths[:, -1:]
    along = np.zeros(points.shape[:2])
    np.divide(lengths, whole, out=along[:, 1:], where=whole > 0.0)
    left = np.clip(1.0 - along, 0.0, 1.0)
    shape = settings.shape
    if shape < 0.0:
        left = left ** (1.0 + shape)
    elif shape >= 1.0:
        # The limit of what follows: the root's radius at the very root alone.
        left = (left >= 1.0).astype(float)
    else:
        left = left ** (1.0 / (1.0 - shape))
    scale = 0.5 * settings.radius_scale
    root, tip = scale * settings.root_radius, scale * settings.tip_radius
    radii = left * (root - tip) + tip
    if settings.use_close_tip:
        radii[:, -1] = 0.0
    return radii
