"""Penumbra, a production render engine.

    import penumbra
    picture = penumbra.render("shot.usda", passes=["combined", "ao", "shadow"], spp=64)
    picture["Ambient Occlusion"]      # numpy, float32, (height, width, 3), rows from the top
    picture.save("shot.exr")

`penumbra.settings()` and `penumbra.passes()` are the tables of what can be set and asked for.
"""

import os
import tempfile

from . import _engine
from ._engine import Picture, Scene, Viewport, __version__, passes, settings

__all__ = ["Picture", "Scene", "Viewport", "__version__", "passes", "render", "settings"]


def render(scene, **keywords):
    """Renders a scene and returns its Picture.

    `scene` is the path of a USD or glTF file, a `Scene`, or a live `pxr.Usd.Stage`, whose edits need
    not be saved. Keywords:

    camera : name or prim path; the scene's own or first unless given
    size : (width, height) in pixels
    frame : time code of USD, frame of glTF
    passes : names of passes, a list or one text with commas
    spp, error, time, seed, max_bounces, ... : every row of `settings()`
    subdivision, variants : as on the command line
    observer : called with a dict (done, spp, target_spp, elapsed, remaining; error, error_at_end,
        error_target, to_target where an error is asked for, else None) or None at least 20 times
        a second; a true answer stops the render, and the picture so far is returned, or, where
        nothing was rendered yet, KeyboardInterrupt raised
    plan : True for a list of effects, with what called for them, in the picture's `plan`
    on_picture, picture_interval : called with the Picture so far every so many seconds

    Raises ValueError for broken input, OSError for files that can't be read, NotImplementedError
    for what is not supported, TypeError for unknown keywords.
    """
    if hasattr(scene, "GetRootLayer") and hasattr(scene, "Flatten"):
        # Flattened, so that edits that exist in memory alone, and its muted and masked parts, count.
        with tempfile.TemporaryDirectory(prefix="penumbra-") as folder:
            path = os.path.join(folder, "stage.usdc")
            if not scene.Flatten().Export(path):
                raise OSError(f"the stage {scene.GetRootLayer().identifier} can't be flattened to {path}")
            return _engine.render(path, **keywords)
    return _engine.render(scene, **keywords)
