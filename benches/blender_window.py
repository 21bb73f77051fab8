"""How long the rendered viewport takes to show something, in a real window of Blender.

    blender --python benches/blender_window.py [-- FILE.zip]

Installs the extension if its zip is given. Milliseconds from what was done until Penumbra had the first picture after
it, an eighth of the size across, and until Blender had drawn the window with one: the switch to the rendered viewport,
moves of the view, moves of an object and changes of a material, for Blender's default scene and beside a mesh of a
million triangles. Ends Blender.
"""

import statistics
import sys
import time
import traceback

import bpy
from mathutils import Quaternion

# How often each thing is done, and seconds of rest before it.
ROUNDS = 9
REST = 0.4


def quit_blender():
    """Ends Blender from a timer."""
    with bpy.context.temp_override(window=bpy.context.window_manager.windows[0]):
        bpy.ops.wm.quit_blender()


class Bench:
    def __init__(self):
        self.steps = self.all_steps()
        self.waiting = None
        self.started = self.rest_until = 0.0
        self.times = {}

    def run(self):
        """A timer's work: starts the next thing once the last one was seen."""
        try:
            if self.waiting is not None or time.perf_counter() < self.rest_until:
                if self.waiting is not None and time.perf_counter() - self.started > 120.0:
                    raise TimeoutError(f"nothing was drawn for {self.waiting}")
                return 0.005
            step = next(self.steps, None)
            if step is None:
                self.report()
                return quit_blender()
            name, work = step
            self.started = time.perf_counter()
            self.waiting = name
            work()
            return 0.005
        except Exception:
            traceback.print_exc()
            return quit_blender()

    def now(self):
        """Milliseconds since the thing was done."""
        return 1000.0 * (time.perf_counter() - self.started)

    def drawn(self, ready):
        """A new picture is on the screen, the first of which was ready so many milliseconds after the thing was done."""
        self.times.setdefault(self.waiting, []).append((ready, self.now()))
        self.waiting = None
        # The next thing happens to a viewport that refines.
        self.rest_until = time.perf_counter() + REST

    def report(self):
        print(f"{'median (least to largest), ms':<48}{'ready':>24}{'drawn':>24}")
        for name, times in self.times.items():
            columns = [f"{statistics.median(t):.0f} ({min(t):.0f} to {max(t):.0f})" for t in zip(*times)]
            print(f"{name:<48}{columns[0]:>24}{columns[1]:>24}", flush=True)

    def all_steps(self):
        window = bpy.context.window_manager.windows[0]
        area = next(area for area in window.screen.areas if area.type == "VIEW_3D")
        space = area.spaces.active
        cube = bpy.data.objects["Cube"]
        material = cube.active_material or bpy.data.materials.new("Bench")
        cube.active_material = material
        material.use_nodes = True
        shader = next(node for node in material.node_tree.nodes if node.type == "BSDF_PRINCIPLED")

        space.overlay.show_overlays = space.show_gizmo = False

        def render():
            space.shading.type = "RENDERED"

        def look():
            view = space.region_3d
            view.view_rotation = Quaternion((0.0, 0.0, 1.0), 0.05) @ view.view_rotation
            area.tag_redraw()

        def move():
            cube.location.x += 0.02

        def color():
            shader.inputs["Roughness"].default_value = 0.3 + 0.4 * (shader.inputs["Roughness"].default_value < 0.5)

        for scene in ("default scene", "a mesh of 1.0 M triangles"):
            if scene != "default scene":
                space.shading.type = "SOLID"
                bpy.ops.mesh.primitive_grid_add(x_subdivisions=708, y_subdivisions=708, size=6, location=(0.0, 0.0, -1.0))
            yield f"{scene}: to the first picture", render
            for name, work in (("the view moves", look), ("an object moves", move), ("a material changes", color)):
                for _ in range(ROUNDS):
                    yield f"{scene}: {name}", work


def watch(bench):
    """Tells `bench` of the first picture after each thing that it does."""
    from bl_ext.user_default.penumbra.viewport import Viewport

    draw = Viewport.draw
    ready = []

    def watched(self, context, depsgraph):
        before = self.texture
        draw(self, context, depsgraph)
        if bench.waiting is None:
            return
        if not ready:
            # Before Blender draws all else.
            while not self.render.has_news() and bench.now() < 60000.0:
                time.sleep(0.0005)
            ready.append(bench.now())
        elif self.texture is not before:
            bench.drawn(ready.pop())

    Viewport.draw = watched


def main():
    if "--" in sys.argv:
        bpy.ops.extensions.package_install_files(
            filepath=sys.argv[sys.argv.index("--") + 1], repo="user_default", enable_on_install=True
        )
    bpy.context.scene.render.engine = "PENUMBRA"
    bench = Bench()
    watch(bench)
    bpy.app.timers.register(bench.run, first_interval=3.0)


main()
