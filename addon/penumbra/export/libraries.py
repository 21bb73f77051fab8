"""Libraries whose files are not there."""

import os

import bpy


def missing():
    """A sentence for each library whose data-blocks Blender could not load."""
    sentences = []
    for library in bpy.data.libraries:
        names = sorted(data.name for data in library.users_id if data.is_missing)
        if names:
            path = os.path.normpath(bpy.path.abspath(library.filepath))
            sentences.append(f"the library {path} is not there, or lacks what is linked from it; left out: {', '.join(names)}")
    return sentences
