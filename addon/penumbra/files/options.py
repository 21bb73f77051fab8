"""Options of Blender's exporters, which differ from version to version."""


def supported(exporter, **options):
    """Those of `options` that this Blender's `exporter` has."""
    known = exporter.get_rna_type().properties
    return {name: value for name, value in options.items() if name in known}
