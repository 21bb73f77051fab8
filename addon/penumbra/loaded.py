"""Which engine is loaded: a module of Rust stays in memory until Blender ends, whatever is installed in its place."""

from importlib import metadata

import penumbra


def note():
    """Remembers what was installed when the engine was loaded."""
    if not hasattr(penumbra, "installed_as"):
        penumbra.installed_as = _installed()


def check():
    """Raises ValueError where another engine was installed since."""
    if getattr(penumbra, "installed_as", None) != _installed():
        raise ValueError("Penumbra was installed anew: restart Blender, which still has the engine of before")


def _installed():
    """The version of the engine on disk, with the stamp of what is in it; "" for one that nothing tells of."""
    try:
        return metadata.version("penumbra")
    except metadata.PackageNotFoundError:
        return ""
