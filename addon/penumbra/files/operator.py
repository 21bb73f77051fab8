"""The operator in File > Export, and the same from the command line."""

import argparse
import os
import traceback
from contextlib import nullcontext

import bpy
from bpy_extras.io_utils import ExportHelper

from . import gltf, usd

WRITERS = {".usdc": usd.write, ".usda": usd.write, ".usd": usd.write, ".usdz": usd.write, ".glb": gltf.write,
           ".gltf": gltf.write}


def export(context, path, selected=False, animation=False, instancing=False):
    """Exports the scene to `path`, in the format of its extension; returns what is to be told.

    Raises ValueError for another extension, OSError and RuntimeError where nothing was written.
    """
    extension = os.path.splitext(path)[1].lower()
    if extension not in WRITERS:
        raise ValueError(f'the name "{path}" tells no format: it may end with {", ".join(WRITERS)}')
    folder = os.path.dirname(os.path.abspath(path))
    if not os.path.isdir(folder):
        raise OSError(f"there is no folder {folder}")
    return WRITERS[extension](context, path, selected, animation, instancing)


class PENUMBRA_OT_export(bpy.types.Operator, ExportHelper):
    """Write a USD or glTF file that holds all of the lamps, the cameras and the world"""

    bl_idname = "penumbra.export"
    bl_label = "Export for Penumbra"
    bl_options = {"PRESET"}

    filename_ext = ".usdc"
    filter_glob: bpy.props.StringProperty(default=";".join(f"*{name}" for name in WRITERS), options={"HIDDEN"})
    selected: bpy.props.BoolProperty(name="Selection Only", description="Export selected objects only")
    animation: bpy.props.BoolProperty(name="Animation", description="Export all frames of the scene")
    instancing: bpy.props.BoolProperty(
        name="Instancing", description="Write instances as such, where the format has them, instead of copies"
    )

    def check(self, _context):
        """Gives names without a known extension the first one."""
        if os.path.splitext(self.filepath)[1].lower() in WRITERS or not os.path.basename(self.filepath):
            return False
        self.filepath += self.filename_ext
        return True

    def execute(self, context):
        """Exports; whatever goes wrong is reported, nothing raised."""
        path = bpy.path.abspath(self.filepath)
        try:
            told = export(context, path, self.selected, self.animation, self.instancing)
        except (ValueError, OSError, RuntimeError) as error:
            self.report({"ERROR"}, _plain(error))
            return {"CANCELLED"}
        except Exception as error:  # noqa: BLE001
            traceback.print_exc()
            self.report({"ERROR"}, f"Penumbra can't export, which is a bug in it: {error}")
            return {"CANCELLED"}
        for warning in told:
            self.report({"WARNING"}, warning)
        self.report({"INFO"}, f"Exported {path}")
        return {"FINISHED"}


def command(arguments):
    """`blender -b FILE.blend --command penumbra_export OUT.usdc`; returns the exit code."""
    parser = argparse.ArgumentParser(
        prog=f"{os.path.basename(bpy.app.binary_path or 'blender')} --command penumbra_export",
        description="Export the scene to USD or glTF with all that Penumbra renders.",
    )
    parser.add_argument("file", help=f"what to write: {', '.join(WRITERS)}")
    parser.add_argument("--selected", action="store_true", help="selected objects only")
    parser.add_argument("--animation", action="store_true", help="all frames of the scene")
    parser.add_argument("--instancing", action="store_true", help="instances instead of copies")
    options = parser.parse_args(arguments)
    windows = bpy.context.window_manager.windows
    try:
        # A command runs outside of any window, and glTF's exporter asks for what only they know.
        with bpy.context.temp_override(window=windows[0]) if windows else nullcontext():
            told = export(bpy.context, options.file, options.selected, options.animation, options.instancing)
    except (ValueError, OSError, RuntimeError) as error:
        print(f"error: {_plain(error)}")
        return 1
    for warning in told:
        print(f"warning: {warning}")
    return 0


def _plain(error):
    """Without the word that errors of Blender's operators begin with."""
    return str(error).strip().removeprefix("Error: ")


def _menu(self, _context):
    self.layout.operator(PENUMBRA_OT_export.bl_idname, text="Penumbra (.usdc/.usda/.usdz/.glb/.gltf)")


_commands = []


def register():
    """Adds the operator, its place in the menu and the command."""
    bpy.utils.register_class(PENUMBRA_OT_export)
    bpy.types.TOPBAR_MT_file_export.append(_menu)
    _commands.append(bpy.utils.register_cli_command("penumbra_export", command))


def unregister():
    """Takes them away."""
    while _commands:
        bpy.utils.unregister_cli_command(_commands.pop())
    bpy.types.TOPBAR_MT_file_export.remove(_menu)
    bpy.utils.unregister_class(PENUMBRA_OT_export)
