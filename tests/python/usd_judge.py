"""What OpenUSD says of a stage, in the space and units of `penumbra info --json --values`: y up, metres.

Matrices are those of USD, for row vectors: the rows are the images of the axes and of the origin.
"""

import math
import os

import numpy as np
from pxr import Gf, Usd, UsdGeom, UsdLux, UsdShade, UsdSkel, Vt
from usd_looks import corner_values

Z_UP_TO_Y_UP = np.array([[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]], dtype=float)
LIGHTS = (
    "SphereLight",
    "DiskLight",
    "RectLight",
    "CylinderLight",
    "DistantLight",
    "DomeLight",
    "DomeLight_1",
    "PortalLight",
)


BASES = {
    "linear": [[1, 0], [-1, 1]],
    "bezier": [[1, 0, 0, 0], [-3, 3, 0, 0], [3, -6, 3, 0], [-1, 3, -3, 1]],
    "bspline": np.array([[1, 4, 1, 0], [-3, 0, 3, 0], [3, -6, 3, 0], [-1, 3, -3, 1]]) / 6,
    "catmullRom": np.array([[0, 2, 0, 0], [-1, 0, 1, 0], [2, -5, 4, -1], [-1, 3, -3, 1]]) / 2,
}


def along_piece(values, basis, wrap, k, t):
    """Piece `k` of a curve at `t`, by the matrix of its basis (rows for 1, t, t², t³)."""
    matrix, n = np.array(BASES[basis], float), len(values)
    first = 3 * k if basis == "bezier" else k - (basis not in ("linear", "bezier") and wrap != "nonperiodic")

    def at(i):
        if wrap == "pinned" and not 0 <= i < n:
            return 2 * values[0] - values[1] if i < 0 else 2 * values[-1] - values[-2]
        return values[i % n]

    points = np.array([at(first + i) for i in range(len(matrix))])
    return np.vander(t, len(matrix), increasing=True) @ matrix @ points


def candela(path):
    """The largest candela of an IES profile (LM-63), and their mean over the sphere, or over the half that they are
    in, by the trapezoid rule along the angles from the axis. Only of profiles that are the same all around."""
    text = open(path).read()
    numbers = text[text.index("TILT=NONE") + len("TILT=NONE") :].replace(",", " ").split()
    factor, rows, columns, ballast = float(numbers[2]), int(numbers[3]), int(numbers[4]), float(numbers[10])
    assert columns == 1, f"{path} is not the same all around"
    values = np.array(numbers[13:], float)
    angles, candela = np.radians(values[:rows]), values[rows + 1 : 2 * rows + 1] * factor * ballast
    sine = candela * np.sin(angles)
    flux = 2 * math.pi * ((sine[1:] + sine[:-1]) / 2 * np.diff(angles)).sum()
    return candela.max(), flux / (2 * math.pi * (np.cos(angles[0]) - np.cos(angles[-1])))


class Stage:
    """A stage at the time at which Penumbra reads it."""

    def __init__(self, path, frame=None, interpolation=None):
        self.stage = Usd.Stage.Open(str(path))
        if interpolation == "held":
            self.stage.SetInterpolationType(Usd.InterpolationTypeHeld)
        ranged = self.stage.HasAuthoredTimeCodeRange()
        if frame is not None:
            self.time = Usd.TimeCode(frame)
        else:
            self.time = Usd.TimeCode(self.stage.GetStartTimeCode()) if ranged else Usd.TimeCode.EarliestTime()
        meters = UsdGeom.GetStageMetersPerUnit(self.stage)
        self.meters = meters if 0 < meters < math.inf else 0.01
        self.z_up = UsdGeom.GetStageUpAxis(self.stage) == "Z"
        self.to_world = np.diag([self.meters] * 3 + [1.0]) @ (Z_UP_TO_Y_UP if self.z_up else np.eye(4))
        self.bake()
        self.xforms = UsdGeom.XformCache(self.time)
        self.blender = self.stage.GetRootLayer().documentation.startswith("Blender v")

    def bake(self):
        """Points, normals and transforms as joints and blend shapes have them, in the session layer."""
        self.stage.SetEditTarget(self.stage.GetSessionLayer())
        everywhere = lambda kind: [
            prim for prim in Usd.PrimRange.Stage(self.stage, Usd.TraverseInstanceProxies()) if prim.IsA(kind)
        ]
        # Instances can't be baked.
        while roots := [prim for prim in everywhere(UsdSkel.Root) if prim.IsInstance() or prim.IsInstanceProxy()]:
            instance = roots[0]
            while not instance.IsInstance():
                instance = instance.GetParent()
            instance.SetInstanceable(False)
        time = self.time.GetValue() if self.time != Usd.TimeCode.EarliestTime() else 0.0
        # Only what has a sample at the time is baked there.
        for animation in everywhere(UsdSkel.Animation):
            for name in ("translations", "rotations", "scales", "blendShapeWeights"):
                attribute = animation.GetAttribute(name)
                if attribute.GetNumTimeSamples() > 1:
                    attribute.Set(attribute.Get(time), time)
        for root in everywhere(UsdSkel.Root):
            UsdSkel.BakeSkinning(UsdSkel.Root(root), Gf.Interval(time, time))

    def world(self, prim):
        return np.array(self.xforms.GetLocalToWorldTransform(prim)) @ self.to_world

    def world_at(self, prim, frames):
        """The same as many frames later."""
        time = Usd.TimeCode(self.time.GetValue() + frames)
        return np.array(UsdGeom.XformCache(time).GetLocalToWorldTransform(prim)) @ self.to_world

    def visible(self, prim):
        imageable = UsdGeom.Imageable(prim)
        if not imageable:
            return False
        invisible = imageable.ComputeVisibility(self.time) == UsdGeom.Tokens.invisible
        return not invisible and imageable.ComputePurpose() not in (UsdGeom.Tokens.proxy, UsdGeom.Tokens.guide)

    def prims(self):
        """All that can be seen; what is in a point instancer is seen through it alone, and what a draw mode
        replaces is not."""
        walk = iter(Usd.PrimRange.Stage(self.stage, Usd.TraverseInstanceProxies()))
        for prim in walk:
            if prim.IsA(UsdGeom.PointInstancer) or self.draw_mode(prim):
                walk.PruneChildren()
            yield prim

    # Draw modes

    def draw_mode(self, prim):
        """How a model is drawn instead of itself; `None` where it is drawn itself."""
        if prim.IsPseudoRoot() or not prim.IsModel():
            return None
        api = UsdGeom.ModelAPI(prim)
        mode, apply = api.ComputeModelDrawMode(), api.GetModelApplyDrawModeAttr()
        applies = apply.Get() if apply and apply.HasAuthoredValue() else prim.IsComponent()
        return mode if applies and mode in ("bounds", "origin", "cards") else None

    def stand_ins(self):
        return [prim for prim in self.prims() if self.draw_mode(prim) and self.visible(prim)]

    def bounds(self, prim):
        """Smallest and largest corner in the space of `prim`."""
        tokens = UsdGeom.Tokens
        cache = UsdGeom.BBoxCache(self.time, [tokens.default_, tokens.render, tokens.proxy], True)
        box = cache.ComputeUntransformedBound(prim).ComputeAlignedRange()
        return np.array([box.GetMin(), box.GetMax()])

    def of_type(self, *types):
        return [prim for prim in self.prims() if prim.GetTypeName() in types]

    def gprims(self):
        shown = lambda prim: prim.IsA(UsdGeom.Gprim) and self.visible(prim) and not self.draw_mode(prim)
        return [prim for prim in self.prims() if shown(prim)]

    def bound(self, prim):
        """The material that is bound to `prim`, if it has a surface."""
        material = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial(UsdShade.Tokens.full)[0]
        return material.GetPrim() if material and self.has_surface(material) else None

    def has_surface(self, material):
        material = UsdShade.Material(material)
        return bool(material) and any(material.ComputeSurfaceSource(context)[0] for context in ("mtlx", ""))

    # Meshes

    def faces(self, prim):
        """Points, and for each face that is there its number and the indices of its corners; `None` where
        the counts don't fit."""
        mesh = UsdGeom.Mesh(prim)
        get = lambda attribute, dtype: np.array(attribute.Get(self.time) or [], dtype=dtype)
        points = self.points(mesh)
        if points is not None and not isinstance(points, Vt.Vec3fArray):
            return None
        points = np.array(points or [], np.float32).reshape(-1, 3)
        counts, indices = get(mesh.GetFaceVertexCountsAttr(), int), get(mesh.GetFaceVertexIndicesAttr(), int)
        if counts.sum() != len(indices) or (len(indices) and not (0 <= indices.min() and indices.max() < len(points))):
            return None
        # Hydra leaves them out of meshes that are not subdivided as well.
        holes = set(get(mesh.GetHoleIndicesAttr(), int))
        ends = np.cumsum(counts)
        kept = [(i, indices[ends[i] - n : ends[i]]) for i, n in enumerate(counts) if n >= 3 and i not in holes]
        return points, kept

    def points(self, schema):
        """Points where velocities have carried them."""
        if schema.GetVelocitiesAttr().HasAuthoredValue():
            return schema.ComputePointsAtTime(self.time, self.time)
        return schema.GetPointsAttr().Get(self.time)

    def has_skeleton(self, prim):
        """True for what joints move, which is baked for the frame alone."""
        return bool(UsdSkel.BindingAPI(prim).GetInheritedSkeleton())

    def points_at(self, prim, frames):
        """The points of `prim` as many frames later; those of a skeleton are not known then."""
        schema, time = UsdGeom.PointBased(prim), Usd.TimeCode(self.time.GetValue() + frames)
        if schema.GetVelocitiesAttr().HasAuthoredValue():
            return np.array(schema.ComputePointsAtTime(time, self.time), np.float32)
        return np.array(schema.GetPointsAttr().Get(time), np.float32)

    def corners(self, prim, faces, name, width):
        """The primvar `name`, of `width` numbers, of every corner of `faces`; `None` where there is none that fits."""
        primvar = UsdGeom.PrimvarsAPI(prim).FindPrimvarWithInheritance(name)
        values = primvar.ComputeFlattened(self.time) if primvar else None
        return self.spread(prim, faces, primvar.GetInterpolation(), values, width) if values else None

    def normal_corners(self, prim, faces):
        """The normal of every corner, of unit length; `None` for surfaces that are smooth, or without any."""
        mesh = UsdGeom.Mesh(prim)
        if mesh.GetSubdivisionSchemeAttr().Get(self.time) != "none":
            return None
        normals = self.corners(prim, faces, "normals", 3)
        values = mesh.GetNormalsAttr().Get(self.time)
        # The primvar comes before the attribute.
        if normals is None and values and not UsdGeom.PrimvarsAPI(prim).HasPrimvar("normals"):
            normals = self.spread(prim, faces, mesh.GetNormalsInterpolation(), values, 3)
        lengths = np.linalg.norm(normals, axis=1, keepdims=True) if normals is not None else np.zeros(1)
        return normals / lengths if (lengths > 0).all() else None

    def spread(self, prim, faces, interpolation, values, width):
        values = np.array(values, dtype=np.float32)
        values = values.reshape(len(values), -1)
        if values.shape[1] != width:
            return None
        return corner_values(self, prim, faces, interpolation, values)

    def materials(self, prim, faces):
        """The materials that the faces of a mesh have."""
        left = {face for face, _ in faces}
        found = set()
        for subset in UsdShade.MaterialBindingAPI(prim).GetMaterialBindSubsets():
            inside = left & set(subset.GetIndicesAttr().Get(self.time) or [])
            left -= inside
            if inside:
                found.add(self.bound(subset.GetPrim()) or self.bound(prim))
        if left:
            found.add(self.bound(prim))
        return {material for material in found if material}

    # Curves and points

    def widths(self, prim, schema):
        """Their interpolation and values; the primvar comes before the attribute."""
        primvar = UsdGeom.PrimvarsAPI(prim).FindPrimvarWithInheritance("widths")
        if primvar and primvar.HasValue():
            return primvar.GetInterpolation(), np.array(primvar.ComputeFlattened(self.time), float)
        values = schema.GetWidthsAttr().Get(self.time)
        return (schema.GetWidthsInterpolation(), np.array(values, float)) if values else ("constant", np.ones(1))

    def balls(self, prim):
        """Centres and radii of the points that have both, in rows."""
        points = UsdGeom.Points(prim)
        centers = np.array(self.points(points) or [], float).reshape(-1, 3)
        interpolation, widths = self.widths(prim, points)
        radii = (widths[:1].repeat(len(centers)) if interpolation == "constant" else widths[: len(centers)]) / 2
        balls = np.column_stack([centers, radii])
        return balls[np.isfinite(balls).all(axis=-1) & (radii > 0)]

    def strands(self, prim):
        """Of each curve many points with their radii, in rows, and whether it is closed; `None` for ribbons."""
        curves = UsdGeom.BasisCurves(prim)
        primvar = UsdGeom.PrimvarsAPI(prim).FindPrimvarWithInheritance("normals")
        if curves.GetNormalsAttr().Get(self.time) or (primvar and primvar.HasValue()):
            return None
        centers = np.array(curves.GetPointsAttr().Get(self.time), float).reshape(-1, 3)
        basis = "linear" if curves.GetTypeAttr().Get(self.time) == "linear" else curves.GetBasisAttr().Get(self.time)
        wrap = curves.GetWrapAttr().Get(self.time)
        interpolation, widths = self.widths(prim, curves)
        strands, start, joint = [], 0, 0
        t = np.linspace(0, 1, 129)
        for i, count in enumerate(curves.GetCurveVertexCountsAttr().Get(self.time)):
            own = slice(start, start + count)
            pieces = curves.ComputeSegmentCounts(self.time)[i]
            joints = pieces if wrap == "periodic" else pieces + 1
            line = []
            for k in range(pieces):
                points = along_piece(centers[own], basis, wrap, k, t)
                if interpolation == "vertex":
                    width = along_piece(widths[own], basis, wrap, k, t)
                elif interpolation == "varying":
                    width = (1 - t) * widths[joint + k] + t * widths[joint + (k + 1) % joints]
                else:
                    width = widths[0 if interpolation == "constant" else i].repeat(len(t))
                line.append(np.column_stack([points, width / 2]))
            strands.append((np.concatenate(line), wrap == "periodic"))
            start, joint = start + count, joint + joints
        return strands

    # Point instancers

    def instanced(self):
        """The world matrix of every gprim or stand-in that point instancers show, and the color that its
        instance has, 0 where its material or the prototype has its own; `None` where they are nested."""
        matrices = []
        for prim in self.of_type("PointInstancer"):
            if not self.visible(prim):
                continue
            instancer = UsdGeom.PointInstancer(prim)
            count = len(instancer.GetProtoIndicesAttr().Get(self.time) or [])
            places = instancer.ComputeInstanceTransformsAtTime(
                self.time, self.time, UsdGeom.PointInstancer.IncludeProtoXform, UsdGeom.PointInstancer.IgnoreMask
            )
            if len(places) != count:
                continue
            mask = instancer.ComputeMaskAtTime(self.time) or [True] * count
            prototypes = [self.stage.GetPrimAtPath(path) for path in instancer.GetPrototypesRel().GetForwardedTargets()]
            colors = self.instance_colors(prim, count)
            indices = instancer.GetProtoIndicesAttr().Get(self.time)
            for index, place, shown, color in zip(indices, places, mask, colors):
                if not shown or not 0 <= index < len(prototypes) or not prototypes[index]:
                    continue
                root = prototypes[index]
                from_root = np.linalg.inv(np.array(self.xforms.GetLocalToWorldTransform(root)))
                walk = iter(Usd.PrimRange(root, Usd.TraverseInstanceProxies(Usd.PrimIsActive)))
                for inner in walk:
                    if inner.IsA(UsdGeom.PointInstancer):
                        return None
                    mode = self.draw_mode(inner)
                    if mode:
                        walk.PruneChildren()
                    if (mode or inner.IsA(UsdGeom.Gprim)) and self.visible(inner):
                        local = np.array(self.xforms.GetLocalToWorldTransform(inner)) @ from_root
                        matrix = local @ np.array(place) @ self.world(prim)
                        own = mode or self.bound(inner) or self.has_color(inner, root)
                        matrices.append((matrix, np.zeros(4) if own else color))
        return matrices

    def instance_colors(self, prim, count):
        """displayColor and displayOpacity of each instance: primvars as those of a cloud of points, else
        what is inherited."""
        api = UsdGeom.PrimvarsAPI(prim)
        values = []
        for name, fallback in (("displayColor", [0.5] * 3), ("displayOpacity", [1.0])):
            primvar = api.FindPrimvarWithInheritance(name)
            found = primvar.ComputeFlattened(self.time) if primvar else None
            if not found:
                values.append(None)
                continue
            found = np.array(found, dtype=float).reshape(len(found), -1)
            of_all = primvar.GetInterpolation() in ("constant", "uniform")
            values.append(np.repeat(found[:1], count, axis=0) if of_all else found)
        if values[0] is None and values[1] is None:
            return [np.zeros(4)] * count
        color = values[0] if values[0] is not None else np.full((count, 3), 0.5)
        opacity = values[1] if values[1] is not None else np.ones((count, 1))
        return list(np.hstack([color[:count], opacity[:count]]))

    def has_color(self, prim, root):
        """True where `prim` or one above it up to `root` has colors."""
        while prim and prim.GetPath().HasPrefix(root.GetPath()):
            api = UsdGeom.PrimvarsAPI(prim)
            if any(api.GetPrimvar(name).HasAuthoredValue() for name in ("displayColor", "displayOpacity")):
                return True
            prim = prim.GetParent()
        return False

    # Lights

    def given(self, prim, name):
        """An input of `prim`: its own value, or that of the input that it is connected to."""
        attribute = prim.GetAttribute(name)
        found = UsdShade.Input(attribute).GetValueProducingAttributes() if attribute.HasAuthoredConnections() else []
        value = found[0].Get(self.time) if found and found[0].GetName().startswith("inputs:") else None
        return attribute.Get(self.time) if value is None else value

    def emission(self, prim):
        """Intensity, exposure, color and temperature."""
        get = lambda name: self.given(prim, name)
        emission = np.array(get("inputs:color"), dtype=float)
        emission *= get("inputs:intensity") * 2.0 ** get("inputs:exposure")
        kelvin = get("inputs:colorTemperature")
        if get("inputs:enableColorTemperature") and not (self.blender and kelvin == 6500):
            emission *= np.array(UsdLux.BlackbodyTemperatureAsRgb(kelvin))
        return emission

    def light(self, prim):
        """Kind, sizes and emission by the formulas of UsdLux's documentation; without its transform."""
        get = lambda name: self.given(prim, name)
        emission, kind = self.emission(prim), prim.GetTypeName()
        if kind not in ("DistantLight", "DomeLight", "DomeLight_1"):
            emission *= (self.ies(prim) or (None, None, 1.0))[2]
        normalize = get("inputs:normalize")
        if kind == "PortalLight":
            # Its sizes are no part of the schema.
            sizes = [get(f"inputs:{name}") for name in ("width", "height") if prim.HasAttribute(f"inputs:{name}")]
            x, y = (np.linalg.norm(self.world(prim)[i, :3]) for i in range(2))
            width, height = sizes if len(sizes) == 2 else (1.0, 1.0)
            return {"kind": "portal", "width": width * x, "height": height * y}
        if kind in ("DomeLight", "DomeLight_1"):
            return {"kind": "dome", "radiance": emission}
        if kind == "DistantLight":
            half = min(max(math.radians(get("inputs:angle")) / 2, 0), math.pi)
            if self.blender:
                half, emission = 2 * half, 4 * emission
            size = math.pi * math.sin(half) ** 2 if half else 1.0
            return {"kind": "distant", "irradiance": emission * (1.0 if normalize else size), "angle": 2 * half}
        matrix = self.world(prim)
        x, y, z = (np.linalg.norm(matrix[i, :3]) for i in range(3))
        unit = 1.0 if self.blender else self.meters
        found, area = {}, 0.0
        if kind == "SphereLight":
            # Its object's scale is no scale of Blender's lamp.
            root = np.array(self.xforms.GetLocalToWorldTransform(self.root(prim)))
            scale = np.linalg.norm(root[0, :3]) * self.meters if self.blender else (x * y * z) ** (1 / 3)
            radius = get("inputs:radius") * scale
            area = 4 * math.pi * radius**2
            if get("treatAsPoint") or radius == 0:
                factor = unit**2 / 4 if normalize else math.pi * radius**2
                if self.blender and radius == 0 and not normalize:
                    factor = 1.0
                return {"kind": "point", "intensity": emission * factor}
            found = {"kind": "sphere", "radius": radius}
        elif kind == "DiskLight":
            width, height = 2 * get("inputs:radius") * x, 2 * get("inputs:radius") * y
            area = math.pi / 4 * width * height
            found = {"kind": "disk", "width": width, "height": height}
        elif kind == "RectLight":
            width, height = get("inputs:width") * x, get("inputs:height") * y
            area = width * height
            found = {"kind": "rect", "width": width, "height": height}
        elif kind == "CylinderLight":
            radius, length = get("inputs:radius") * math.sqrt(y * z), get("inputs:length") * x
            area = 2 * math.pi * radius * length
            found = {"kind": "cylinder", "radius": radius, "length": length}
        found["radiance"] = emission * (unit**2 / area if normalize else 1.0)
        return found

    def root(self, prim):
        return self.stage.GetPrimAtPath(prim.GetPath().GetPrefixes()[0])

    def dome_directions(self, prim):
        """Where the image's centre, left quarter and top are in the world (OpenEXR's lat-long maps)."""
        center, left, top = np.eye(3)[[2, 0, 1]]
        pole = prim.GetAttribute("poleAxis").Get() if prim.GetTypeName() == "DomeLight_1" else "Y"
        if pole == "Z" or (pole == "scene" and self.z_up):
            center, top = -np.eye(3)[1], np.eye(3)[2]
        local = np.array(UsdGeom.Xformable(prim).GetLocalTransformation(self.time))
        if self.blender and np.allclose(local, np.eye(4)):
            # Blender 5.0 leaves out the rotation that 4.5 writes: (90, 0, 90).
            center, left, top = np.eye(3)[[0, 1, 2]]
        directions = np.array([center, left, top]) @ self.world(prim)[:3, :3]
        return directions / np.linalg.norm(directions, axis=1, keepdims=True)

    def shaping(self, prim):
        """Cone angle and softness, focus and its tint; `None` where ShapingAPI is not applied."""
        if not prim.HasAPI(UsdLux.ShapingAPI):
            return None
        get = lambda name: self.given(prim, f"inputs:shaping:{name}")
        return get("cone:angle"), get("cone:softness"), get("focus"), np.array(get("focusTint"), float)

    def ies(self, prim):
        """File, angleScale, and what the profile multiplies emission by; `None` without one."""
        if not prim.HasAPI(UsdLux.ShapingAPI):
            return None
        api = UsdLux.ShapingAPI(prim)
        file = api.GetShapingIesFileAttr().Get(self.time)
        if not file or not os.path.isfile(file.resolvedPath):
            return None
        peak, mean = candela(file.resolvedPath)
        normalized = api.GetShapingIesNormalizeAttr().Get(self.time)
        scale = api.GetShapingIesAngleScaleAttr().Get(self.time)
        return os.path.basename(file.path), scale, peak / mean if normalized else peak

    def shadow(self, prim):
        """Whether the light casts shadows and how they look: color, distance, falloff and its gamma, in metres."""
        without = [0.0, 0.0, 0.0], math.inf, 0.0, 1.0
        if not prim.HasAPI(UsdLux.ShadowAPI):
            return True, without
        get = lambda name: self.given(prim, f"inputs:shadow:{name}")
        distance, falloff = get("distance"), get("falloff")
        if distance < 0:
            # Shadows that end nowhere do not fall off.
            return get("enable"), (np.array(get("color"), float), *without[1:])
        falloff = falloff * self.meters if falloff >= 0 else 0.0
        return get("enable"), (np.array(get("color"), float), distance * self.meters, falloff, get("falloffGamma"))

    def shining(self):
        """The shapes that are lights: their path, the light, and whether it is of the shape itself."""
        found = {}
        for prim in self.prims():
            if prim.IsA(UsdGeom.Gprim) and prim.HasAPI(UsdLux.LightAPI) and not prim.HasAPI(UsdLux.VolumeLightAPI):
                found[prim.GetPath()] = (prim, True)
        for prim in self.of_type("GeometryLight"):
            targets = prim.GetRelationship("geometry").GetForwardedTargets()
            if targets and self.visible(prim):
                found[targets[0]] = (prim, False)
        return found

    def glow(self, light, shape, own):
        """What a shape that is a light emits, and whether it has nothing of its material; `None` where that is not
        said. The area is that of a mesh alone."""
        emission = self.emission(light) * (self.ies(light) or (None, None, 1.0))[2]
        if self.given(light, "inputs:normalize"):
            if shape.GetTypeName() != "Mesh" or not (faces := self.faces(shape)):
                return None
            emission = emission / self.area(shape, faces)
        mode = light.GetAttribute("light:materialSyncMode").Get() if own else "noMaterialResponse"
        bound = self.bound(shape)
        if mode == "noMaterialResponse" or bound is None:
            return emission, True
        if mode == "independent":
            return emission, False
        surface = UsdShade.Material(bound).ComputeSurfaceSource("")[0]
        glow = surface.GetInput("emissiveColor") if surface else None
        glow = glow.GetValueProducingAttributes() if glow else []
        if not glow or not glow[0].GetName().startswith("inputs:") or not any(glow[0].Get(self.time)):
            return None
        return emission * np.array(glow[0].Get(self.time), float), False

    def area(self, shape, faces):
        """Of the faces of a mesh in the world, in square units of the stage; faces are flat."""
        points, kept = faces
        world = np.array(self.xforms.GetLocalToWorldTransform(shape))
        at = points.astype(float) @ world[:3, :3]
        area = 0.0
        for _, corners in kept:
            fan = at[corners[1:]] - at[corners[0]]
            area += 0.5 * np.linalg.norm(np.cross(fan[:-1], fan[1:]).sum(axis=0))
        return area

    # Cameras

    def camera(self, prim):
        camera = UsdGeom.Camera(prim)
        gf = camera.GetCamera(self.time)
        tenth = 0.1 * self.meters
        found = {
            "clip_near": gf.clippingRange.min * self.meters,
            "clip_far": gf.clippingRange.max * self.meters,
            "shift": [
                gf.horizontalApertureOffset / gf.horizontalAperture,
                gf.verticalApertureOffset / gf.verticalAperture,
            ],
            "shutter": [camera.GetShutterOpenAttr().Get(self.time), camera.GetShutterCloseAttr().Get(self.time)],
            "exposure": camera.ComputeLinearExposureScale(self.time),
        }
        if gf.projection == Gf.Camera.Perspective:
            found["projection"] = {
                "fov_y": math.radians(gf.GetFieldOfView(Gf.Camera.FOVVertical)),
                "aspect": gf.aspectRatio,
            }
        else:
            found["projection"] = {
                "half_width": 0.5 * gf.horizontalAperture * tenth,
                "half_height": 0.5 * gf.verticalAperture * tenth,
            }
        found["lens"] = None
        if gf.fStop > 0 and gf.focusDistance > 0:
            found["lens"] = {
                "aperture_radius": 0.5 * gf.focalLength * tenth / gf.fStop,
                "focus_distance": gf.focusDistance * self.meters,
            }
        return found
