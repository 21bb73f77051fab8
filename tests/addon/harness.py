"""Runs in a headless Blender (the bpy package): the extension enabled, a job done, the answer as JSON.

    python harness.py JOB ANSWER.json [ARGUMENT...]

JOB is a function of jobs.py, motion_jobs.py or pass_jobs.py. The extension is expected in BLENDER_USER_RESOURCES, where install.py put it.
"""

import json
import os
import sys
import traceback

import bpy  # isort: skip (what follows is found through it)
import addon_utils

EXTENSION = "bl_ext.user_default.penumbra"


def main():
    job, target, *arguments = sys.argv[1:]
    bpy.ops.wm.read_factory_settings(use_empty=True)
    addon_utils.enable(EXTENSION)
    import jobs
    import motion_jobs
    import pass_jobs

    answer = {}
    try:
        module = next(module for module in (jobs, motion_jobs, pass_jobs) if hasattr(module, job))
        answer["result"] = getattr(module, job)(*arguments)
    except Exception as error:
        answer["error"] = f"{type(error).__name__}: {error}"
        answer["traceback"] = traceback.format_exc()
    with open(target, "w") as file:
        json.dump(answer, file)
    # Blender 4.x does not survive an engine that is registered at exit.
    addon_utils.disable(EXTENSION)
    if bpy.app.version < (4, 3):
        # It crashes at exit once it has exported glTF, with or without the extension.
        sys.stdout.flush()
        os._exit(0)


main()
