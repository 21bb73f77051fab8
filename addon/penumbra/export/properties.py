"""Properties of objects, instancers and the view layer that Attribute nodes ask for."""


def values(asked, obj, instancer, layer, scene):
    """Each attribute that is asked for and there: its type and name, and four numbers."""
    found = []
    for kind, name in asked:
        if kind == "VIEW_LAYER":
            holders = (layer, scene, scene.world)
        else:
            # What has no instancer is its own.
            owner = instancer if kind == "INSTANCER" and instancer is not None else obj
            holders = (owner, owner.data)
        value = next((v for v in (_value(holder, name) for holder in holders) if v is not None), None)
        if value is not None:
            found.append([f"{kind} {name}", value])
    return found


def _value(holder, name):
    """Four numbers of a custom property, or of one of Blender's own, of `holder`; None where it has none."""
    if holder is None:
        return None
    value = holder.get(name)
    if value is None:
        try:
            value = holder.path_resolve(name)
        except (ValueError, KeyError, TypeError):
            return None
    if isinstance(value, (bool, int, float)):
        return [float(value)] * 3 + [1.0]
    try:
        numbers = [float(x) for x in value]
    except (TypeError, ValueError):
        return None
    return (numbers + [0.0, 0.0, 0.0])[:3] + [numbers[3] if len(numbers) > 3 else 1.0] if numbers else None
