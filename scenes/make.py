"""Builds the shipped scenes: `python scenes/make.py [still_life|interior|field|lamps|wheel|all]` (Python 3.11, bpy 5.0, numpy)."""
import importlib
import pathlib
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
SCENES = ("still_life", "interior", "field", "lamps", "wheel")


def main(args):
    sys.path.insert(0, str(HERE))
    wanted = args or ["all"]
    for name in wanted:
        if name not in (*SCENES, "all"):
            sys.exit(f"unknown scene {name!r}: one of {', '.join(SCENES)}, all")
    for name in SCENES if "all" in wanted else wanted:
        with tempfile.TemporaryDirectory() as folder:
            importlib.import_module(f"src.{name}").build(HERE, pathlib.Path(folder))
        file = next(HERE.glob(f"{name}.[gu]*"))
        print(f"{file.name}: {file.stat().st_size} bytes")


if __name__ == "__main__":
    main(sys.argv[1:])
