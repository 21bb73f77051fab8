//! The irradiance of every emitter from a ten-thousandth of its radius to a million radii away, in
//! scenes of a tenth of a millimetre to a hundred kilometres: facing, tilted, and with the receiver's
//! horizon through the light.

use std::f64::consts::PI;
use std::sync::Arc;

use penumbra::light::{Cylinder, Disk, MeshEmitters, MeshLight, Rect, Sphere};
use penumbra::math::{Affine3A, DQuat, DVec3, Rgb, Vec3};
use penumbra::shape::Mesh;

use crate::laws::{Case, irradiance_holds};
use crate::mesh::Constant;
use crate::plane::{Pose, irradiance};
use crate::quadrature::{Tube, cap};

/// Where the light is: `d` is its distance from the receiver in radii, `scale` the radius in metres.
struct Stage {
    d: f64,
    scale: f64,
    turn: DQuat,
    /// The receiver and its normal.
    p: Vec3,
    n: Vec3,
}

impl Stage {
    /// From the receiver to a point of the world, where the light is along y; in radii.
    fn to(&self, way: DVec3) -> DVec3 {
        self.p.as_dvec3() + self.turn * way * self.scale
    }

    /// That the light faces, its middle a little aside.
    fn pose(&self) -> Pose {
        Pose::turned(self.to(DVec3::new(0.1237, self.d, 0.0412)), self.turn)
    }

    fn half(&self) -> [f64; 2] {
        [self.scale, 0.7 * self.scale]
    }

    /// Irradiance from the cone of directions of `half` radians about `axis`.
    fn cap(&self, half: f64, axis: DVec3) -> f64 {
        let n = self.n.as_dvec3();
        let tilt = axis.cross(n).length().atan2(axis.dot(n));
        if half + tilt <= 0.5 * PI { PI * half.sin().powi(2) * tilt.cos() } else { cap(half, tilt) }
    }
}

/// Every distance at one scale, every scale at three distances.
fn hold(case: impl Fn(&Stage) -> (penumbra::light::AnyEmitter, f64)) {
    let all = (-4..=6).map(|k| (10.0_f64.powi(k), 1.0));
    let scaled = [1e-4, 1e5].into_iter().flat_map(|scale| [1e-4, 1.0, 1e6].map(|d| (d, scale)));
    let mut cases = Vec::new();
    for (d, scale) in all.chain(scaled) {
        // Seen along an axis of the world, and along none.
        for turn in [DQuat::IDENTITY, DQuat::from_axis_angle(DVec3::new(0.48, 0.6, 0.64), 0.7)] {
            let turned = turn != DQuat::IDENTITY;
            // The horizon passes the middle by a third of the light.
            let horizon = 0.3 * (1.0 / d).min(1.0);
            for (what, n) in [
                ("facing", DVec3::Y),
                ("tilted", DVec3::new(0.6, 0.8, 0.0)),
                ("on the horizon", DVec3::new(1.0, horizon, 0.0)),
                ("below the horizon but for a part", DVec3::new(-0.6, -horizon, 0.8)),
            ] {
                // Along no axis the `f32` of a direction has 16 steps across a light so far away: of what
                // is above the horizon that alone makes 0.06 % more, whatever is sampled.
                if turned && d > 1e5 && n.y.abs() < 1e-5 {
                    continue;
                }
                let p = if !turned { Vec3::ZERO } else { Vec3::new(0.3, -0.2, 0.1) * scale as f32 };
                let name = format!("{d:e} radii away, scale {scale:e}, {what}, at {p}");
                let n = (turn * n).normalize().as_vec3();
                let stage = Stage { d, scale, turn, p, n };
                let (light, irradiance) = case(&stage);
                cases.push(Case::new(name, light, p, n, irradiance));
            }
        }
    }
    irradiance_holds(&cases);
}

#[test]
fn rectangles() {
    hold(|stage| {
        let pose = stage.pose();
        let corners = pose.corners(stage.half());
        (Rect::new(pose.flat(1.0), stage.half()).into(), irradiance(&corners, stage.p, stage.n))
    });
}

#[test]
fn disks() {
    hold(|stage| {
        let pose = stage.pose();
        let rim = pose.ellipse(stage.half(), 20_000);
        (Disk::new(pose.flat(1.0), stage.half()).into(), irradiance(&rim, stage.p, stage.n))
    });
}

#[test]
fn meshes() {
    hold(|stage| {
        let points: Vec<Vec3> = stage.pose().corners(stage.half()).iter().map(|corner| corner.as_vec3()).collect();
        let mesh = Mesh { points, triangles: vec![[0, 1, 2], [0, 2, 3]], ..Mesh::default() };
        let emitters = MeshEmitters::new(Arc::new(mesh), Arc::new(Constant(Rgb::WHITE))).unwrap();
        let light = MeshLight::new(Arc::new(emitters), Affine3A::IDENTITY).unwrap();
        let exact = [0, 1].map(|i| irradiance(&light.corners(i).map(|p| p.as_dvec3()), stage.p, stage.n));
        (light.into(), exact.iter().sum())
    });
}

fn sphere(stage: &Stage, facing: bool) -> Sphere {
    let d = if facing { stage.d } else { 1.0 + stage.d };
    let center = stage.to(DVec3::Y * d).as_vec3();
    Sphere { center, radius: stage.scale as f32, radiance: Rgb::WHITE, facing, profile: None }
}

#[test]
fn spheres() {
    hold(|stage| {
        let light = sphere(stage, false);
        let (to_center, r) = (light.center.as_dvec3() - stage.p.as_dvec3(), f64::from(light.radius));
        let d = to_center.length();
        let half = r.atan2(((d - r) * (d + r)).sqrt());
        (light.into(), stage.cap(half, to_center / d))
    });
}

/// Cycles' soft falloff.
#[test]
fn facing_spheres() {
    hold(|stage| {
        let light = sphere(stage, true);
        let (to_center, r) = (light.center.as_dvec3() - stage.p.as_dvec3(), f64::from(light.radius));
        let d = to_center.length();
        (light.into(), stage.cap(r.atan2(d), to_center / d))
    });
}

#[test]
fn cylinders() {
    hold(|stage| {
        let center = stage.to(DVec3::new(0.2, 1.0 + stage.d, 0.0)).as_vec3();
        let axis = (stage.turn * DVec3::X).as_vec3();
        let (radius, length) = (stage.scale as f32, 3.0 * stage.scale as f32);
        let light = Cylinder::new(center, axis, radius, length, Rgb::WHITE, None);
        let tube = Tube {
            center: center.as_dvec3(),
            axis: axis.as_dvec3().normalize(),
            radius: radius.into(),
            length: length.into(),
        };
        (light.into(), tube.irradiance(stage.p.as_dvec3(), stage.n.as_dvec3()))
    });
}
