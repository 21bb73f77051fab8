"""Runs in a headless Blender (the bpy package): the extension enabled, a job done, the answer as JSON.

    python harness.py JOB ANSWER.json [ARGUMENT...]
    python harness.py serve

JOB is a function of jobs.py, motion_jobs.py, pass_jobs.py or ui_jobs.py. The extension is expected in BLENDER_USER_RESOURCES, where
install.py put it. With `serve` jobs come line by line, as JSON lists [LOG, JOB, ANSWER.json, ARGUMENT...], each in a Blender
as new; what it prints goes to LOG, and a line says that it is done.
"""

import json
import os
import sys
import traceback

import bpy  # isort: skip (what follows is found through it)
import addon_utils

EXTENSION = "bl_ext.user_default.penumbra"


def do(job, target, *arguments):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    addon_utils.enable(EXTENSION)
    import jobs
    import motion_jobs
    import pass_jobs
    import ui_jobs

    answer = {}
    try:
        module = next(module for module in (jobs, motion_jobs, pass_jobs, ui_jobs) if hasattr(module, job))
        answer["result"] = getattr(module, job)(*arguments)
    except Exception as error:
        answer["error"] = f"{type(error).__name__}: {error}"
        answer["traceback"] = traceback.format_exc()
    with open(target, "w") as file:
        json.dump(answer, file)


def serve():
    """Until the input ends."""
    answers = os.fdopen(os.dup(1), "w")
    for line in sys.stdin:
        log, *job = json.loads(line)
        with open(log, "w") as file:
            os.dup2(file.fileno(), 1)
            os.dup2(file.fileno(), 2)
            do(*job)
            sys.stdout.flush()
            sys.stderr.flush()
        answers.write("done\n")
        answers.flush()
    os._exit(0)


def main():
    if sys.argv[1] == "serve":
        serve()
    do(*sys.argv[1:])
    # Blender 4.x does not survive an engine that is registered at exit.
    addon_utils.disable(EXTENSION)
    if bpy.app.version < (4, 3):
        # It crashes at exit once it has exported glTF, with or without the extension.
        sys.stdout.flush()
        os._exit(0)


main()
