"""What moves while the shutter is open, or from frame to frame: the frame is set to each time at which something has a
key, as in Cycles."""

import math

import numpy as np

from . import camera, mesh, particles

# Where in the shutter the frame is.
_AT_FRAME = {"START": 0.0, "CENTER": 0.5, "END": 1.0}
# The property's own end: 128 pieces of the shutter.
_MOST_STEPS = 7


def is_on(scene, view_layer):
    """True where pictures of the view layer have motion blur."""
    return scene.render.use_motion_blur and view_layer.use_motion_blur and scene.render.motion_blur_shutter > 0.0


class Motion:
    """Gathers for one render with motion blur where things are at other times of the shutter.

    `frame_set` takes a frame and a part of one; `stopped` says whether the artist wants no picture any more. Times are
    in shares of the shutter until they are handed over, in frames after the frame.
    """

    def __init__(self, scene, frame_set, stopped):
        render = scene.render
        self._scene, self._frame_set, self._stopped = scene, frame_set, stopped
        self._frame, self._subframe = scene.frame_current, scene.frame_subframe
        self._length, self._at_frame = render.motion_blur_shutter, _AT_FRAME[render.motion_blur_position]
        self._per_second = render.fps / render.fps_base
        # Of each thing that moves: indices of its instances, its matrix at the frame, and its times.
        self._placed = {}
        # Of each shape that may change: the thing that has it, the modifier whose hair it is, and its times.
        self._shapes = {}
        # Points by the key of their shape: [(frames after the frame, array)].
        self._points = {}
        # What is placed at other times: [(frames after the frame, indices, matrices)].
        self._moved = []
        # How the camera projects where it zooms: [[frames after the frame, names and values]].
        self.zoom = []
        self.warnings = set()

    @property
    def shutter(self):
        """When it opens and closes, frames after the frame."""
        return [self._after(0.0), self._after(1.0)]

    def exposure(self):
        """What the document says of how the picture is exposed while the shutter is open."""
        result = {"shutter": self.shutter}
        curve = _opening(self._scene.render.motion_blur_shutter_curve)
        if max(curve) != min(curve):
            result["shutter_curve"] = curve
        cycles = getattr(self._scene, "cycles", None)
        if getattr(cycles, "rolling_shutter_type", "NONE") != "NONE":
            result["rolling_shutter"] = cycles.rolling_shutter_duration
        return result

    def _times(self, obj, parent):
        """Times of an object's keys."""
        return _times(obj, parent)

    def _deforms(self, obj, parent):
        """True where the shape of an object may be another at those times."""
        return _setting("use_deform_motion", obj, parent)

    def _after(self, share):
        return (share - self._at_frame) * self._length

    def note(self, instance, indices, matrix, shapes):
        """An instance of the frame: indices of what is placed with it, and their shapes as (key, modifier of the hair)."""
        obj = instance.object
        parent = instance.parent if instance.is_instance else None
        times = self._times(obj, parent)
        if not indices or not times:
            return
        identity = identity_of(instance)
        self._placed[identity] = (indices, matrix, times)
        for key, modifier in shapes:
            if key in self._shapes or key in self._points or not self._deforms(obj, parent):
                continue
            flowing = None if modifier else self._flowing(obj)
            if flowing is not None:
                self._points[key] = flowing
            # Of a mesh that geometry nodes instance it is those nodes that are asked; that of a curve or text is not a mesh's.
            elif modifier or obj.original.type != "MESH" or obj.original.is_deform_modified(self._scene, "RENDER"):
                self._shapes[key] = (identity, modifier, times)

    def _flowing(self, obj):
        """Points that have velocities (metres a second) go along them, whatever their number at other times."""
        velocity = getattr(obj.data, "attributes", {}).get("velocity") if obj.type in mesh.WITH_ATTRIBUTES else None
        if velocity is None or (velocity.domain, velocity.data_type) != ("POINT", "FLOAT_VECTOR"):
            return None
        points, speed = mesh.positions(obj.data), np.empty(len(velocity.data) * 3, np.float32)
        velocity.data.foreach_get("vector", speed)
        if points.shape != speed.shape:
            return None
        ends = [time for time in (self._after(0.0), self._after(1.0)) if time != 0.0]
        return [(time, points + np.float32(time / self._per_second) * speed) for time in ends]

    def gather(self, depsgraph, camera_object, lamps):
        """Goes through all times and back to the frame; returns the camera's motion as [[time, matrix]].

        `lamps` are the records of lamps by identity: they stand still where they are in the middle of the shutter, as
        in Cycles.
        """
        of_camera = []
        has_camera = camera_object is not None
        camera_times = self._times(camera_object, None) if has_camera else frozenset()
        lens = camera.projection(camera_object.evaluated_get(depsgraph)) if has_camera else None
        times = set(camera_times).union(*(thing[-1] for thing in (*self._placed.values(), *self._shapes.values())))
        if lamps:
            times.add(0.5)
        times.discard(self._at_frame)
        try:
            for share in sorted(times):
                if self._stopped():
                    break
                self._go_to(self._after(share))
                self._moved.append((self._after(share), *self._placed_at(depsgraph, share, lamps)))
                if share in camera_times:
                    now = camera_object.original.evaluated_get(depsgraph)
                    of_camera.append([self._after(share), [list(map(float, row)) for row in now.matrix_world]])
                    if camera.projection(now) != lens:
                        self._note_zoom(self._after(share), now)
        finally:
            self._frame_set(self._frame, self._subframe)
        return of_camera

    def _note_zoom(self, after, camera_object):
        """The camera has another lens at a time. Cycles blurs that in perspective."""
        kind = camera.kind(camera_object)
        if kind == "PERSP":
            self.zoom.append([after, {"type": kind, **camera.projection(camera_object)}])

    def _go_to(self, after):
        time = self._frame + self._subframe + after
        self._frame_set(math.floor(time), time - math.floor(time))

    def _placed_at(self, depsgraph, share, lamps):
        """Indices and matrices of what is placed, now that the frame is set to `share`; takes in points and lamps."""
        found, matrices, shapes = [], [], {}
        for key, (identity, modifier, times) in self._shapes.items():
            if share in times:
                shapes.setdefault(identity, []).append((key, modifier))
        missing = {identity for identity, thing in self._placed.items() if share in thing[-1]}
        for instance in depsgraph.object_instances:
            identity = identity_of(instance)
            if share == 0.5 and identity in lamps:
                lamps[identity]["matrix"] = [list(map(float, row)) for row in instance.matrix_world]
            if identity not in missing:
                continue
            missing.discard(identity)
            indices = self._placed[identity][0]
            found += indices
            matrices += [x for row in instance.matrix_world for x in row] * len(indices)
            for key, modifier in shapes.get(identity, ()):
                points = _points(instance, modifier, depsgraph.mode == "RENDER")
                self._points.setdefault(key, []).append((self._after(share), points))
        for identity in missing:
            # What is not there at this time is where it is at the frame.
            indices, matrix, _ = self._placed[identity]
            found += indices
            matrices += matrix * len(indices)
        return found, matrices

    def hand_over(self, scene):
        """Gives what was gathered to the engine's scene, which has the shapes and instances of the frame."""
        for key, moved in self._points.items():
            scene.set_shape_motion(key, moved)
        for time, indices, matrices in self._moved:
            if indices:
                scene.add_instance_motion(time, np.asarray(indices, np.uint32), np.asarray(matrices, np.float32))


class Vectors(Motion):
    """Gathers for the vector pass where things are at the frames before and after: all of them, whatever their settings
    of motion blur.
    """

    def __init__(self, scene, frame_set, stopped):
        super().__init__(scene, frame_set, stopped)
        self._length, self._at_frame = 2.0, 0.5

    def exposure(self):
        """The shutter is open for an instant."""
        return {}

    def _note_zoom(self, after, camera_object):
        kind = camera.kind(camera_object)
        if kind != "PANO":
            self.zoom.append([after, {"type": kind, **camera.projection(camera_object)}])

    def _times(self, obj, parent):
        return _FRAMES

    def _deforms(self, obj, parent):
        return True


# The frames before and after as shares of the time between them.
_FRAMES = frozenset((0.0, 1.0))


def identity_of(instance):
    """What an instance is known by at any frame."""
    obj = instance.object
    if not instance.is_instance:
        return obj.name_full
    return (instance.parent.name_full, obj.name_full, *instance.persistent_id)


def _setting(name, obj, parent):
    """True where neither the object nor that which instances it is kept from being blurred."""
    return all(getattr(getattr(one, "cycles", None), name, True) for one in (obj, parent) if one is not None)


def _times(obj, parent):
    """Times of an object's keys: twice as many pieces of the shutter with each step, those of others being among them."""
    if not _setting("use_motion_blur", obj, parent):
        return frozenset()
    steps = max(getattr(getattr(one, "cycles", None), "motion_steps", 1) for one in (obj, parent) if one is not None)
    pieces = 2 ** min(max(steps, 1), _MOST_STEPS)
    return frozenset(i / pieces for i in range(pieces + 1))


def _points(instance, modifier, render):
    """Points of what is instanced, at the frame that is set."""
    obj = instance.object
    if modifier:
        obj = instance.instance_object if instance.is_instance else obj
        return particles.points(obj, obj.modifiers[modifier], render).astype(np.float32).reshape(-1)
    return mesh.positions(obj.data)


# Cycles looks a shutter's curve up at so many times.
_LOOKUPS = 256


def _opening(mapping):
    """How far a shutter is open, from its opening to its closing at even steps."""
    mapping.update()
    curve = mapping.curves[0]
    return [mapping.evaluate(curve, i / (_LOOKUPS - 1)) for i in range(_LOOKUPS)]
