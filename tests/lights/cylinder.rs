//! Tubes against quadrature in f64, from a ten-thousandth of the radius to a million radii.

use std::f64::consts::PI;
use std::sync::Arc;

use penumbra::light::{Cone, Cylinder, Decay, Emitter, Profile, Receiver, Shaping};
use penumbra::math::{Bounds, DMat3, DVec3, Rgb, Vec3};

use crate::laws::{Case, hold, irradiance_holds};
use crate::quadrature::{Tube, midpoints};

const L: f64 = 3.0;

/// A tube, `p` in units of the radius, relative to its centre: along its axis, then across.
struct Setup {
    name: String,
    center: Vec3,
    axis: Vec3,
    radius: f32,
    length: f32,
    p: Vec3,
    n: Vec3,
}

impl Setup {
    fn new(name: impl Into<String>, length: f32, along: f32, across: f32, n: Vec3) -> Self {
        let p = Vec3::new(along, across, 0.0);
        Self { name: name.into(), center: Vec3::ZERO, axis: Vec3::X, radius: 1.0, length, p, n: n.normalize() }
    }

    /// The same, turned, moved and scaled.
    fn moved(self, axes: DMat3, center: Vec3, scale: f32) -> Self {
        let turn = |v: Vec3| (axes * v.as_dvec3()).as_vec3();
        Self {
            name: format!("{}, scale {scale}, moved", self.name),
            center,
            axis: turn(self.axis),
            radius: self.radius * scale,
            length: self.length * scale,
            p: center + turn(self.p) * scale,
            n: turn(self.n).normalize(),
        }
    }

    fn tube(&self) -> Tube {
        Tube {
            center: self.center.as_dvec3(),
            axis: self.axis.as_dvec3().normalize(),
            radius: self.radius.into(),
            length: self.length.into(),
        }
    }

    fn light(&self, profile: Option<Arc<Profile>>) -> Cylinder {
        Cylinder::new(self.center, self.axis, self.radius, self.length, Rgb::splat(L as f32), profile)
    }

    fn case(&self) -> Case {
        let irradiance = L * self.tube().irradiance(self.p.as_dvec3(), self.n.as_dvec3());
        Case::new(self.name.clone(), self.light(None), self.p, self.n, irradiance)
    }

    /// A cone around the whole tube, where the point is outside of its bounding sphere.
    fn bounded(&self) -> Case {
        let to_center = self.center.as_dvec3() - self.p.as_dvec3();
        let radius = f64::from(self.radius).hypot(0.5 * f64::from(self.length));
        let ratio = radius / to_center.length();
        let case = self.case();
        if ratio < 1.0 { case.within(to_center.normalize().as_vec3(), ratio.asin()) } else { case }
    }
}

fn turned() -> DMat3 {
    DMat3::from_rotation_y(0.7) * DMat3::from_rotation_x(1.9) * DMat3::from_rotation_z(-0.4)
}

#[test]
fn tubes_hold() {
    let down = Vec3::NEG_Y;
    let mut setups = vec![
        Setup::new("beside", 4.0, 0.3, 3.0, down),
        Setup::new("tilted", 4.0, 0.3, 3.0, Vec3::new(0.6, -0.5, 0.4)),
        Setup::new("half below the horizon", 4.0, 0.3, 2.0, Vec3::new(0.9, 0.1, 0.2)),
        Setup::new("beyond the end", 4.0, 5.0, 2.0, Vec3::new(-0.9, -0.3, 0.0)),
        Setup::new("hoop", 0.1, 0.2, 1.5, down),
        Setup::new("needle", 30.0, 4.0, 6.0, down),
        Setup::new("near", 4.0, -0.5, 1.05, down),
    ];
    setups.push(Setup::new("moved", 4.0, 0.3, 3.0, Vec3::new(0.6, -0.5, 0.4)).moved(
        turned(),
        Vec3::new(3.0, -2.0, 5.0),
        0.2,
    ));
    hold(&setups.iter().map(Setup::bounded).collect::<Vec<_>>());
}

#[test]
fn no_distance_is_too_small_or_too_large() {
    let mut cases = Vec::new();
    for height in [1e-4, 1e-3, 1e-2, 0.1, 1.0, 10.0, 1e3, 1e6] {
        for length in [1e-2, 1.0, 100.0] {
            for along in [0.0, 0.4, 0.6, 3.0] {
                let name = format!("{height} above, {along} of length {length}");
                let n = Vec3::new(if along > 0.5 { -0.6 } else { 0.3 }, -0.8, 0.1);
                cases.push(Setup::new(name, length, along * length, 1.0 + height, n).case());
            }
        }
    }
    irradiance_holds(&cases);
}

#[test]
fn scale_and_place_do_not_matter() {
    let mut cases = Vec::new();
    for scale in [1e-4, 1e-2, 1.0, 1e2, 1e5] {
        for (along, across, n) in
            [(0.3, 1.2, Vec3::new(0.1, -0.9, 0.3)), (3.0, 1.7, Vec3::new(-0.9, -0.2, 0.1)), (0.0, 40.0, Vec3::NEG_Y)]
        {
            let setup = Setup::new(format!("{along} {across}"), 4.0, along, across, n);
            cases.push(setup.moved(turned(), Vec3::new(1.0, -2.0, 0.5) * scale, scale).case());
        }
    }
    irradiance_holds(&cases);
}

#[test]
fn inside_and_through_the_ends_there_is_nothing() {
    let light = Setup::new("", 4.0, 0.0, 3.0, Vec3::Y).light(None);
    for p in [Vec3::ZERO, Vec3::new(1.0, 0.5, 0.0), Vec3::new(5.0, 0.5, 0.0), Vec3::new(-7.0, 0.0, 1.0)] {
        let at = Receiver::everywhere(p);
        assert!(light.sample_li(&at, 0.0, [0.3, 0.6]).is_none(), "{p}");
        for wi in [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::new(-0.8, 0.6, 0.0), Vec3::new(0.8, -0.6, 0.0)] {
            assert!(light.hit(p, wi).is_none(), "{p} {wi}");
        }
    }
    // From beyond the end, past the rim, the far wall's inside is in view, and black.
    let through = Vec3::new(-0.96, -0.28, 0.0);
    assert!(light.hit(Vec3::new(4.0, 1.2, 0.0), through).is_none());
    let hit = light.hit(Vec3::new(0.5, 3.0, 0.0), Vec3::NEG_Y).unwrap();
    assert!((hit.dist - 2.0).abs() < 1e-6 && (hit.ng - Vec3::Y).length() < 1e-6);
    assert!(light.hit(Vec3::new(0.5, 3.0, 0.0), Vec3::Y).is_none());
    assert!(light.hit(Vec3::new(2.1, 3.0, 0.0), Vec3::NEG_Y).is_none());
}

/// A spot along the local −z, which is across the tube.
#[test]
fn profiles_act_where_light_leaves() {
    let half = 0.9_f64;
    let setup = Setup::new("spot", 4.0, 0.7, 3.0, Vec3::new(0.3, -0.8, 0.2));
    // −z of the light is towards +y here.
    let axes = DMat3::from_cols(DVec3::X, DVec3::Z, DVec3::NEG_Y);
    let decay = Decay { range: 6.0, ..Decay::PHYSICAL };
    let shaping = Shaping { cone: Some(Cone::soft(half, 0.8)), focus: 2.0, ..Shaping::default() };
    let profile = Arc::new(Profile::new(axes, shaping, decay));
    let factor = |w: DVec3| {
        let t = ((half - w.y.acos()) / (half * 0.8)).clamp(0.0, 1.0);
        t * t * (3.0 - 2.0 * t) * w.y.max(0.0).powi(2)
    };
    let p = setup.p.as_dvec3();
    let le = |on: DVec3| factor((p - on).normalize()) * decay.factor((p - on).length());
    let irradiance = L * setup.tube().irradiance_of(p, setup.n.as_dvec3(), le);
    let light = setup.light(Some(profile));
    let bounded = setup.bounded();
    hold(&[Case { irradiance, light: light.clone().into(), ..bounded }]);

    // Power: what the tube shows in each direction, L 2 r l sin, times the factor.
    let scene = Bounds { min: Vec3::splat(-1.0), max: Vec3::splat(1.0) };
    let power = midpoints(0.0, half, 500, |theta| {
        theta.sin()
            * midpoints(0.0, 2.0 * PI, 500, |phi| {
                let w = DVec3::new(theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin());
                L * 2.0 * 4.0 * (1.0 - w.x * w.x).sqrt() * factor(w)
            })
    });
    assert!((f64::from(light.power(scene)) / power - 1.0).abs() < 1e-4, "{} {power}", light.power(scene));
    let plain = f64::from(setup.light(None).power(scene));
    assert!((plain / (2.0 * PI * 4.0 * PI * L) - 1.0).abs() < 1e-6);
}
