//! The shapes of lights, near and far: sizes in the world, radiance with `normalize`.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use super::super::images::Images;
use super::{Light, blender, color};
use crate::desc::{ColorSpace, LightKind};

/// Axes whose lengths differ by less have the same scale.
const EVEN: f64 = 1e-4;

/// Radius of a line that has none, by its length.
const LINE: f64 = 1e-3;

/// What the light is; `None`, with a warning, for a kind that is not read.
pub(super) fn read(light: &Light<'_>, images: &mut Images) -> Option<LightKind> {
    let emission = color::emission(&light.values);
    match &*light.kind {
        "SphereLight" => Some(sphere(light, emission)),
        "DiskLight" => Some(disk(light, emission)),
        "RectLight" => Some(rect(light, emission, images)),
        "CylinderLight" => Some(cylinder(light, emission)),
        "DistantLight" => Some(distant(light, emission)),
        "PortalLight" => Some(portal(light)),
        kind => {
            light.values.warn(format!("{kind} is no light that is known: it is left out"));
            None
        }
    }
}

/// `kind` with `factor` times the emission.
pub(super) fn scaled(mut kind: LightKind, factor: f64) -> LightKind {
    match &mut kind {
        LightKind::Point { intensity: color }
        | LightKind::Distant { irradiance: color, .. }
        | LightKind::Sphere { radiance: color, .. }
        | LightKind::Rect { radiance: color, .. }
        | LightKind::Disk { radiance: color, .. }
        | LightKind::Cylinder { radiance: color, .. }
        | LightKind::Dome { radiance: color, .. } => *color = times(*color, factor),
        // USD makes none.
        LightKind::ShadedDome { .. } => {}
        LightKind::Portal { .. } => {}
    }
    kind
}

fn times(color: [f64; 3], factor: f64) -> [f64; 3] {
    color.map(|c| c * factor)
}

impl Light<'_> {
    fn size(&self, name: &str, otherwise: f64) -> f64 {
        let size = self.values.number(name).unwrap_or(otherwise);
        if size < 0.0 {
            self.values.warn(format!("its {name} is negative; taken without the sign"));
        }
        size.abs()
    }

    fn normalized(&self) -> bool {
        self.values.flag("inputs:normalize").unwrap_or(false)
    }

    /// Metres of the world per unit along the local axes.
    fn scale(&self) -> [f64; 3] {
        let m = self.world.matrix3;
        let skew = [m.x_axis.dot(m.y_axis), m.y_axis.dot(m.z_axis), m.z_axis.dot(m.x_axis)];
        let scale = [m.x_axis, m.y_axis, m.z_axis].map(|axis| axis.length());
        let product = [scale[0] * scale[1], scale[1] * scale[2], scale[2] * scale[0]];
        if (0..3).any(|i| skew[i].abs() > EVEN * product[i]) {
            self.values.warn("its transform is skewed: the light has the sizes of the axes, not the skew");
        }
        scale
    }

    /// The one scale of axes that a round light can't scale apart.
    fn round(&self, axes: &[f64], shape: &str) -> f64 {
        let (least, most) = axes.iter().fold((f64::INFINITY, 0.0_f64), |(l, m), &s| (l.min(s), m.max(s)));
        let mean = axes.iter().product::<f64>().powf(1.0 / axes.len() as f64);
        if most - least > EVEN * most {
            self.values.warn(format!("its scale makes {shape} of it: rendered round, with the mean radius"));
            return mean;
        }
        most
    }

    /// Metres of the unit in which areas are measured by `normalize`: that of the stage.
    fn unit(&self) -> f64 {
        let reading = self.values.reading;
        // Blender computes in its own unit, before its exporter scales.
        if reading.blender { blender::meters_per_unit(reading, &self.path) } else { reading.meters }
    }

    /// What the emission is multiplied by, given the area in square metres.
    fn per_area(&self, area: f64) -> f64 {
        // Without area it emits nothing, which is told of where the scene is prepared.
        if self.normalized() && area > 0.0 { self.unit() * self.unit() / area } else { 1.0 }
    }
}

/// The rectangle of a portal; one unit in older files, whose schema has no sizes.
fn portal(light: &Light<'_>) -> LightKind {
    let [x, y, _] = light.scale();
    LightKind::Portal { width: light.size("inputs:width", 1.0) * x, height: light.size("inputs:height", 1.0) * y }
}

fn sphere(light: &Light<'_>, emission: [f64; 3]) -> LightKind {
    let reading = light.values.reading;
    let scale = if reading.blender {
        blender::meters_per_unit(reading, &light.path)
    } else {
        light.round(&light.scale(), "an ellipsoid")
    };
    let radius = light.size("inputs:radius", 0.5) * scale;
    if light.values.flag("treatAsPoint").unwrap_or(false) || radius == 0.0 {
        // The limit of small spheres: L π r², where L is emission / (4 π r²) if it is normalised.
        let factor = match light.normalized() {
            true => 0.25 * light.unit() * light.unit(),
            false if reading.blender && radius == 0.0 => 1.0,
            false => PI * radius * radius,
        };
        if factor == 0.0 {
            light
                .values
                .warn("a sphere of radius 0 has no surface to shine with, unless inputs:normalize is set: it is dark");
        }
        return LightKind::Point { intensity: times(emission, factor) };
    }
    // Lamps of Blender have it from the start.
    let facing = blender::property(&light.values, "use_soft_falloff").map_or(reading.blender, |soft| soft != 0.0);
    let radiance = times(emission, light.per_area(4.0 * PI * radius * radius));
    LightKind::Sphere { radius, radiance, facing }
}

/// Full angle into which each point of a flat light emits.
fn spread(light: &Light<'_>) -> f64 {
    blender::property(&light.values, "spread").map_or(PI, |spread| spread.clamp(0.0, PI))
}

fn disk(light: &Light<'_>, emission: [f64; 3]) -> LightKind {
    let [x, y, _] = light.scale();
    let diameter = 2.0 * light.size("inputs:radius", 0.5);
    let (width, height) = (diameter * x, diameter * y);
    let radiance = times(emission, light.per_area(FRAC_PI_4 * width * height));
    LightKind::Disk { width, height, radiance, spread: spread(light), two_sided: false }
}

fn rect(light: &Light<'_>, emission: [f64; 3], images: &mut Images) -> LightKind {
    let [x, y, _] = light.scale();
    let (width, height) = (light.size("inputs:width", 1.0) * x, light.size("inputs:height", 1.0) * y);
    let radiance = times(emission, light.per_area(width * height));
    let file = light.values.asset("inputs:texture:file");
    // The first texel stands at (+x, +y): upright as seen from where the light shines.
    let image = file.and_then(|file| images.load(light.values.reading, &light.path, &file, ColorSpace::Srgb));
    LightKind::Rect { width, height, radiance, spread: spread(light), two_sided: false, image }
}

fn cylinder(light: &Light<'_>, emission: [f64; 3]) -> LightKind {
    let [x, y, z] = light.scale();
    let mut radius = light.size("inputs:radius", 0.5) * light.round(&[y, z], "an elliptic cylinder");
    let length = light.size("inputs:length", 1.0) * x;
    if light.values.flag("treatAsLine").unwrap_or(false) {
        // What a normalised one emits in all does not depend on the radius.
        let is_thin = radius == 0.0 && light.normalized();
        radius = if is_thin { LINE * length } else { radius };
        let how = if is_thin { "a thousandth of its length in radius" } else { "of its radius" };
        light.values.note(format!("treatAsLine: it is rendered as a cylinder {how}"));
    }
    let radiance = times(emission, light.per_area(2.0 * PI * radius * length));
    LightKind::Cylinder { radius, length, radiance }
}

/// UsdLux' `sizeFactor` of a distant light, its half angle in radians.
fn distant_size(half: f64) -> f64 {
    let squared = half.sin() * half.sin();
    match half {
        0.0 => 1.0,
        half if half <= FRAC_PI_2 => PI * squared,
        _ => PI * (2.0 - squared),
    }
}

fn distant(light: &Light<'_>, emission: [f64; 3]) -> LightKind {
    let values = &light.values;
    let (strength, diameters) = if values.reading.blender { (4.0, 2.0) } else { (1.0, 1.0) };
    let angle = values.number("inputs:angle").unwrap_or(0.53).to_radians() * diameters;
    let half = (0.5 * angle).clamp(0.0, PI);
    let seen = half.min(FRAC_PI_2);
    if half > seen {
        values.warn("wider than 180 degrees: only the half of the sky that it comes from shines");
    }
    // Radiance times the projected solid angle of the disk; that of a direction is its irradiance.
    let mut factor = strength * distant_size(seen);
    if light.normalized() {
        factor /= distant_size(half);
    }
    LightKind::Distant { irradiance: times(emission, factor), angle: 2.0 * seen }
}

#[cfg(test)]
mod tests {
    use super::super::testing::Stage;
    use super::*;
    use crate::desc::{ConeDesc, LightDesc};

    fn near(found: f64, expected: f64) {
        assert!((found / expected - 1.0).abs() < 1e-6, "{found} is not {expected}");
    }

    fn stage(unit: &str, prims: &str) -> (Stage, impl Fn(&Stage, &str) -> LightDesc) {
        (Stage::new(unit, prims), |stage: &Stage, path: &str| stage.light(path).unwrap())
    }

    /// Centimetres, z up; a rectangle of 40 by 25 after scale.
    #[test]
    fn sizes_are_those_of_the_world_and_areas_those_of_the_stage() {
        let (stage, light) = stage(
            "metersPerUnit = 0.01\nupAxis = \"Z\"",
            r#"def Xform "Set" {
                float3 xformOp:scale = (2, 2, 2)
                uniform token[] xformOpOrder = ["xformOp:scale"]
                def SphereLight "Sphere" { float inputs:radius = 10; float inputs:intensity = 7 }
                def SphereLight "SphereN" (references = </Set/Sphere>) { bool inputs:normalize = 1 }
                def RectLight "Rect" {
                    float inputs:width = 20
                    float inputs:height = 5
                    double3 xformOp:scale = (1, 2.5, 9)
                    uniform token[] xformOpOrder = ["xformOp:scale"]
                }
                def RectLight "RectN" (references = </Set/Rect>) { bool inputs:normalize = 1 }
                def DiskLight "Disk" { bool inputs:normalize = 1; float inputs:radius = 3 }
                def CylinderLight "Tube" { bool inputs:normalize = 1; float inputs:radius = 3; float inputs:length = 50 }
            }"#,
        );
        let LightKind::Sphere { radius, radiance, .. } = light(&stage, "/Set/Sphere").kind else { panic!() };
        near(radius, 0.2);
        near(radiance[2], 7.0);
        near(light(&stage, "/Set/SphereN").kind.color()[0], 7.0 / (4.0 * PI * 400.0));
        let LightKind::Rect { width, height, radiance, .. } = light(&stage, "/Set/Rect").kind else { panic!() };
        near(width, 0.4);
        near(height, 0.25);
        near(radiance[0], 1.0);
        near(light(&stage, "/Set/RectN").kind.color()[0], 1.0 / 1000.0);
        let LightKind::Disk { width, height, radiance, .. } = light(&stage, "/Set/Disk").kind else { panic!() };
        near(width, 0.12);
        near(height, 0.12);
        near(radiance[0], 1.0 / (PI * 36.0));
        let LightKind::Cylinder { radius, length, radiance } = light(&stage, "/Set/Tube").kind else { panic!() };
        near(radius, 0.06);
        near(length, 1.0);
        near(radiance[0], 1.0 / (2.0 * PI * 6.0 * 100.0));
        assert_eq!(stage.said(), "");
    }

    /// UsdLux' defaults, as `pxr` has them: radius, width, height and length 0.5, 1, 1, 1.
    #[test]
    fn what_is_not_authored_has_the_fallback() {
        let (stage, light) = stage(
            "",
            r#"def SphereLight "Sphere" {} def RectLight "Rect" {} def DiskLight "Disk" {}
            def CylinderLight "Tube" {} def DistantLight "Sun" {}"#,
        );
        assert!(matches!(light(&stage, "/Sphere").kind, LightKind::Sphere { radius: 0.5, radiance: [1.0, ..], .. }));
        assert!(matches!(light(&stage, "/Rect").kind, LightKind::Rect { width: 1.0, height: 1.0, image: None, .. }));
        assert!(matches!(light(&stage, "/Disk").kind, LightKind::Disk { width: 1.0, height: 1.0, .. }));
        assert!(matches!(light(&stage, "/Tube").kind, LightKind::Cylinder { radius: 0.5, length: 1.0, .. }));
        let LightKind::Distant { irradiance, angle } = light(&stage, "/Sun").kind else { panic!() };
        near(angle, 0.53_f64.to_radians());
        near(irradiance[0], 50_000.0 * PI * (0.265_f64.to_radians()).sin().powi(2));
        assert_eq!(light(&stage, "/Sun").shaping.cone, None);
    }

    /// E = L π sin²θ of a disk of half angle θ; `normalize` makes it the intensity.
    #[test]
    fn suns_are_divided_by_their_size_factor() {
        let sun = |angle: f64, normalize: u8| {
            let prim = format!(
                r#"def DistantLight "A" {{
                    float inputs:intensity = 2; float inputs:angle = {angle}; bool inputs:normalize = {normalize}
                }}"#
            );
            let stage = Stage::new("", &prim);
            let LightKind::Distant { irradiance, angle } = stage.light("/A").unwrap().kind else { panic!() };
            (irradiance[0], angle, stage.said())
        };
        assert_eq!(sun(0.0, 0), (2.0, 0.0, String::new()));
        assert_eq!(sun(0.0, 1), (2.0, 0.0, String::new()));
        for degrees in [10.0_f64, 90.0, 180.0] {
            let half = (0.5 * degrees).to_radians();
            let (irradiance, angle, said) = sun(degrees, 0);
            near(irradiance, 2.0 * PI * half.sin().powi(2));
            near(angle, 2.0 * half);
            assert_eq!(said, "");
            near(sun(degrees, 1).0, 2.0);
        }
        // All of the sky: (2 − 0) π; the half of it that is rendered has L π.
        let (irradiance, angle, said) = sun(360.0, 1);
        near(irradiance, 1.0);
        near(angle, PI);
        assert!(said.contains("wider than 180 degrees"));
        near(distant_size(0.75 * PI), PI * 1.5);
    }

    /// The limit of a small sphere: I = L π r², with L = intensity / (4 π r²) where it is normalised.
    #[test]
    fn points_are_small_spheres() {
        let (stage, light) = stage(
            "metersPerUnit = 0.1",
            r#"def SphereLight "Point" { bool treatAsPoint = 1; float inputs:radius = 2; float inputs:intensity = 8 }
            def SphereLight "PointN" (references = </Point>) { bool inputs:normalize = 1 }
            def SphereLight "Zero" { float inputs:radius = 0; bool inputs:normalize = 1; float inputs:intensity = 8 }
            def SphereLight "Nothing" { float inputs:radius = 0 }"#,
        );
        let intensity = |path: &str| match light(&stage, path).kind {
            LightKind::Point { intensity } => intensity[0],
            kind => panic!("{kind:?}"),
        };
        near(intensity("/Point"), 8.0 * PI * 0.04);
        near(intensity("/PointN"), 2.0 * 0.01);
        near(intensity("/Zero"), 2.0 * 0.01);
        assert_eq!(intensity("/Nothing"), 0.0);
    }

    /// Normalised, a cylinder emits as much however thin it is.
    #[test]
    fn lines_are_thin_cylinders_of_the_same_power() {
        let (stage, light) = stage(
            "metersPerUnit = 0.1",
            r#"def CylinderLight "Thick" { float inputs:length = 20; float inputs:radius = 2; bool inputs:normalize = 1 }
            def CylinderLight "Line" (references = </Thick>) { float inputs:radius = 0; bool treatAsLine = 1 }
            def CylinderLight "Hint" (references = </Thick>) { bool treatAsLine = 1 }"#,
        );
        let cylinder = |path: &str| match light(&stage, path).kind {
            LightKind::Cylinder { radius, length, radiance } => (radius, length * radius * radiance[0]),
            kind => panic!("{kind:?}"),
        };
        let [thick, line, hint] = ["/Thick", "/Line", "/Hint"].map(cylinder);
        near(line.0, 0.002);
        near(line.1, thick.1);
        assert_eq!(hint, thick);
    }

    #[test]
    fn what_is_not_rendered_is_told() {
        let (stage, _) = stage(
            "",
            r#"def SphereLight "Egg" {
                float3 xformOp:scale = (1, 1, 8)
                uniform token[] xformOpOrder = ["xformOp:scale"]
                float inputs:diffuse = 0
                float inputs:specular = 0.5
            }
            def CylinderLight "Line" { bool treatAsLine = 1 }
            def PluginLight "Plug" {}
            def PortalLight "Door" { float inputs:width = 3 }
            def RectLight "Odd" (prepend apiSchemas = ["ShadowAPI"]) {
                bool inputs:shadow:enable = 0
                rel light:filters = </Line>
                float inputs:radius.connect = </Line.inputs:radius>
                float inputs:intensity.connect = </Line.inputs:intensity>
            }"#,
        );
        let egg = stage.light("/Egg").unwrap();
        assert!(matches!(egg.kind, LightKind::Sphere { radius, .. } if (radius - 1.0).abs() < 1e-9));
        assert!(!egg.visibility.diffuse && egg.visibility.glossy);
        assert_eq!(egg.links.response, [0.0, 0.5]);
        assert!(stage.light("/Line").is_some());
        assert_eq!(stage.light("/Plug"), None);
        assert_eq!(stage.light("/Door").unwrap().kind, LightKind::Portal { width: 3.0, height: 1.0 });
        assert!(!stage.light("/Odd").unwrap().links.cast_shadow);
        let said = stage.said();
        for what in [
            "/Egg: its scale makes an ellipsoid",
            "/Line: treatAsLine",
            "/Plug: lights that need a plugin",
            "/Odd: light filters",
            "/Odd: inputs:intensity is connected",
        ] {
            assert!(said.contains(what), "{what} is not in\n{said}");
        }
    }

    #[test]
    fn shaping_is_read_where_the_schema_is_applied() {
        let (stage, light) = stage(
            "",
            r#"def SphereLight "None" {}
            def SphereLight "Half" (prepend apiSchemas = ["ShapingAPI"]) {}
            def RectLight "Flat" (prepend apiSchemas = ["ShapingAPI"]) {}
            def SphereLight "Spot" (prepend apiSchemas = ["ShapingAPI"]) {
                float inputs:shaping:cone:angle = 30
                float inputs:shaping:cone:softness = 0.25
                float inputs:shaping:focus = 3
                color3f inputs:shaping:focusTint = (0.5, 0, 0)
            }
            def SphereLight "Wide" (prepend apiSchemas = ["ShapingAPI"]) {
                float inputs:shaping:cone:angle = 180
                float inputs:shaping:focus = -3
            }
            def DistantLight "Sun" (prepend apiSchemas = ["ShapingAPI"]) {}"#,
        );
        assert_eq!(light(&stage, "/None").shaping, Default::default());
        // The fallback is a cone of 90 degrees: the half of a sphere.
        let cone = |path: &str| light(&stage, path).shaping.cone;
        assert_eq!(cone("/Half"), Some(ConeDesc::Soft { angle: FRAC_PI_2, softness: 0.0 }));
        assert_eq!((cone("/Flat"), cone("/Wide")), (None, None));
        assert_eq!(light(&stage, "/Wide").shaping.focus, 0.0);
        let spot = light(&stage, "/Spot").shaping;
        assert_eq!(spot.cone, Some(ConeDesc::Soft { angle: 30.0_f64.to_radians(), softness: 0.25 }));
        assert_eq!((spot.focus, spot.focus_tint), (3.0, [0.5, 0.0, 0.0]));
        assert_eq!(stage.said(), "");
        assert_eq!(cone("/Sun"), None);
        assert!(stage.said().contains("/Sun: ShapingAPI"));
    }
}
