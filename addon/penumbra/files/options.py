"""Options of Blender's exporters, which differ from version to version."""


def supported(exporter, **options):
    """Those of `options` that this Blender's `exporter` has.

    Raises RuntimeError where it has no such exporter: some are built without USD, and add-ons can be disabled.
    """
    try:
        known = exporter.get_rna_type().properties
    except KeyError:
        raise RuntimeError(f"this Blender has no exporter {exporter.idname_py()}") from None
    return {name: value for name, value in options.items() if name in known}
