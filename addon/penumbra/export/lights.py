"""Lamps and the world."""

from . import nodes


def lamp(instance, context):
    """A placed lamp; its links are filled in once all objects are known."""
    obj = instance.object
    light = obj.data
    data = {
        "name": obj.name,
        "matrix": [list(map(float, row)) for row in instance.matrix_world],
        "type": light.type,
        "energy": light.energy,
        "color": list(light.color),
        "use_shadow": light.use_shadow,
        "lightgroup": obj.lightgroup,
        "visibility": context.visibility(obj),
    }
    bounces = getattr(getattr(light, "cycles", None), "max_bounces", None)
    if bounces is not None:
        data["max_bounces"] = bounces
    for name in ("exposure", "normalize"):
        if hasattr(light, name):
            data[name] = getattr(light, name)
    if getattr(light, "use_temperature", False):
        data["temperature_color"] = list(light.temperature_color)
    if light.type in {"POINT", "SPOT"}:
        data["radius"] = light.shadow_soft_size
        data["use_soft_falloff"] = light.use_soft_falloff
    if light.type == "SPOT":
        data["spot_size"] = light.spot_size
        data["spot_blend"] = light.spot_blend
    elif light.type == "SUN":
        data["angle"] = light.angle
    elif light.type == "AREA":
        data.update(shape=light.shape, size=light.size, size_y=light.size_y)
        data["spread"] = light.spread
        data["is_portal"] = bool(getattr(getattr(light, "cycles", None), "is_portal", False))
    if light.node_tree is not None and light.use_nodes:
        data["nodes"] = nodes.dump(light.node_tree, context)
    return data


def world(world, context):
    """The world, or None where the scene has none."""
    if world is None:
        return None
    data = {"name": world.name, "color": list(world.color), "lightgroup": world.lightgroup}
    seen = getattr(world, "cycles_visibility", None)
    if seen is not None:
        names = ("camera", "diffuse", "glossy", "transmission")
        data["visibility"] = {name: bool(getattr(seen, name, True)) for name in names}
    if world.node_tree is not None and world.use_nodes:
        data["nodes"] = nodes.dump(world.node_tree, context)
    return data
