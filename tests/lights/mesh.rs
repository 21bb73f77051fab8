//! Emissive meshes against Lambert's formula for polygons, `E = L/2 Σ θᵢ (γᵢ · n)`, in f64.

use std::f64::consts::PI;
use std::sync::Arc;

use penumbra::light::{AnyEmitter, Emission, Emitter, EmitterHit, MeshEmitters, MeshLight, Receiver};
use penumbra::math::{Affine3A, Bounds, DVec3, Mat3, Rgb, Vec3};
use penumbra::shape::{Attribute, Mesh};

use crate::laws::{Case, hold, irradiance_holds};
use crate::plane::irradiance;
use crate::random::Random;

const L: f64 = 4.0;

/// The same radiance all over.
#[derive(Debug)]
pub struct Constant(pub Rgb);

impl Emission for Constant {
    fn radiance(&self, _triangle: u32, _uv: [f32; 2]) -> Rgb {
        self.0
    }
    fn mean(&self, _triangle: u32) -> Rgb {
        self.0
    }
}

fn emitters(points: Vec<Vec3>, triangles: Vec<[u32; 3]>, emission: impl Emission + 'static) -> MeshEmitters {
    let mesh = Mesh { points, triangles, ..Mesh::default() };
    MeshEmitters::new(Arc::new(mesh), Arc::new(emission)).unwrap()
}

fn light(points: &[[f32; 3]], triangles: &[[u32; 3]]) -> MeshLight {
    let points = points.iter().map(|&p| Vec3::from(p)).collect();
    let emitters = emitters(points, triangles.to_vec(), Constant(Rgb::splat(L as f32)));
    MeshLight::new(Arc::new(emitters), Affine3A::IDENTITY).unwrap()
}

fn lambert_of(light: &MeshLight, p: Vec3, n: Vec3) -> f64 {
    let count = light.emitters().mesh().triangles.len() as u32;
    let corners = (0..count).map(|i| light.corners(i).map(|p| p.as_dvec3()));
    corners.map(|corners| irradiance(&corners, p, n)).sum()
}

/// Where a ray from `p` along `wi` meets triangle `index`, by f64.
fn meets(light: &MeshLight, index: u32, p: Vec3, wi: Vec3) -> Option<EmitterHit> {
    let [a, b, c] = light.corners(index).map(|corner| corner.as_dvec3() - p.as_dvec3());
    let wi = wi.as_dvec3();
    let volumes = [wi.dot(b.cross(c)), wi.dot(c.cross(a)), wi.dot(a.cross(b))];
    let cross = (b - a).cross(c - a);
    let dist = a.dot(cross) / wi.dot(cross);
    let sum: f64 = volumes.iter().sum();
    let uv = [volumes[1] / sum, volumes[2] / sum].map(|v| v as f32);
    let inside = volumes.iter().all(|v| v * sum >= 0.0) && dist > 0.0 && dist.is_finite();
    inside.then_some(EmitterHit { dist: dist as f32, ng: cross.normalize().as_vec3(), triangle: index, uv })
}

fn mesh(case: &Case) -> &MeshLight {
    match &case.light {
        AnyEmitter::MeshLight(light) => light,
        _ => panic!("a mesh"),
    }
}

/// The nearest triangle along a ray; the meshes here have no two behind each other.
fn hit(case: &Case, wi: Vec3) -> Option<EmitterHit> {
    let light = mesh(case);
    let count = light.emitters().mesh().triangles.len() as u32;
    (0..count).filter_map(|i| meets(light, i, case.p, wi)).min_by(|a, b| a.dist.total_cmp(&b.dist))
}

fn radiance(case: &Case, _wi: Vec3, hit: &EmitterHit) -> Rgb {
    mesh(case).emitters().emission().radiance(hit.triangle, hit.uv)
}

/// A case of constant radiance.
fn case(name: impl Into<String>, light: MeshLight, p: Vec3, n: Vec3) -> Case {
    let n = n.normalize();
    let irradiance = L * lambert_of(&light, p, n);
    Case { hit: Some(hit), radiance: Some(radiance), ..Case::new(name, light, p, n, irradiance) }
}

/// Axis and half angle of a cone around all corners.
fn around(case: Case) -> Case {
    let light = mesh(&case);
    let count = light.emitters().mesh().triangles.len() as u32;
    let to = |corner: Vec3| (corner.as_dvec3() - case.p.as_dvec3()).normalize();
    let directions: Vec<DVec3> = (0..count).flat_map(|i| light.corners(i)).map(to).collect();
    let axis = directions.iter().sum::<DVec3>().normalize();
    let half = directions.iter().map(|d| d.cross(axis).length().atan2(d.dot(axis))).fold(0.0, f64::max);
    case.within(axis.as_vec3(), (1.02 * half).min(PI))
}

const SQUARE: [[f32; 3]; 4] = [[-0.5, 0.0, -0.5], [0.5, 0.0, -0.5], [0.5, 0.0, 0.5], [-0.5, 0.0, 0.5]];

/// A unit square above the origin, as two triangles.
fn square(height: f32) -> MeshLight {
    light(&SQUARE.map(|[x, _, z]| [x, height, z]), &[[0, 1, 2], [0, 2, 3]])
}

/// A grid over the unit square with hills.
fn hills(n: u32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let at = |i: u32| i as f32 / n as f32 - 0.5;
    let point = |i: u32, j: u32| Vec3::new(at(i), 0.1 * (7.0 * at(i)).sin() * (5.0 * at(j)).cos(), at(j));
    let points = (0..=n).flat_map(|j| (0..=n).map(move |i| point(i, j))).collect();
    let index = |i: u32, j: u32| j * (n + 1) + i;
    let triangles = (0..n).flat_map(|j| (0..n).map(move |i| (i, j))).flat_map(|(i, j)| {
        [[index(i, j), index(i + 1, j), index(i + 1, j + 1)], [index(i, j), index(i + 1, j + 1), index(i, j + 1)]]
    });
    (points, triangles.collect())
}

#[test]
fn meshes_hold() {
    let tilted = Vec3::new(0.5, 0.7, -0.3);
    let one = light(&[[-0.4, 1.0, -0.3], [0.5, 1.1, -0.2], [0.1, 0.9, 0.6]], &[[0, 1, 2]]);
    hold(&[
        around(case("square", square(0.5), Vec3::ZERO, Vec3::Y)),
        around(case("square, tilted", square(0.5), Vec3::new(0.2, 0.0, -0.1), tilted)),
        case("square, near", square(0.1), Vec3::new(0.2, 0.0, 0.1), Vec3::Y),
        case("square, contact", square(1e-3), Vec3::new(0.1237, 0.0, 0.0412), Vec3::Y),
        case("square, half below the horizon", square(0.3), Vec3::new(0.1, 0.0, 0.0), Vec3::X),
        around(case("square from behind", square(-0.7), Vec3::new(0.1, 0.0, 0.3), Vec3::NEG_Y)),
        around(case("triangle", one.clone(), Vec3::ZERO, Vec3::Y)),
        around(case("triangle, aslant", one.clone(), Vec3::new(0.3, 0.0, 0.2), Vec3::new(1.0, 0.4, 0.2))),
        around(case("triangle, far", one, Vec3::new(3.0, -40.0, 1.0), tilted)),
    ]);
}

/// Rays through the hills meet one triangle of those that light sampling may choose from.
#[test]
fn a_mesh_of_many_triangles_holds_wherever_it_is_placed() {
    let (points, triangles) = hills(4);
    let shared = Arc::new(emitters(points, triangles, Constant(Rgb::splat(L as f32))));
    let turn = Mat3::from_euler(glam::EulerRot::XYZ, 0.2, 0.4, -0.3);
    let at = |m: Mat3| {
        let to_render = Affine3A::from_mat3_translation(m, Vec3::new(0.2, 2.0, 0.1));
        MeshLight::new(shared.clone(), to_render).unwrap()
    };
    let tilted = Vec3::new(0.5, 0.7, -0.3);
    hold(&[
        around(case("as it is", at(Mat3::IDENTITY), Vec3::ZERO, Vec3::Y)),
        around(case("turned and large", at(turn * 1.7), Vec3::ZERO, tilted)),
        around(case("mirrored", at(turn * Mat3::from_diagonal(Vec3::new(-1.0, 1.0, 1.0))), Vec3::ZERO, tilted)),
        around(case("stretched", at(turn * Mat3::from_diagonal(Vec3::new(3.0, 0.5, 0.4))), Vec3::ZERO, Vec3::Y)),
        around(case("sheared", at(Mat3::from_cols(Vec3::X, Vec3::new(0.4, 0.7, 0.3), Vec3::Z)), Vec3::ZERO, Vec3::Y)),
    ]);
}

/// 0.1², 1e-2², 1e-3², 1 × 1e-3 and 1 × 1e-4 metres at distances of 1 to 1000.
#[test]
fn tiny_and_thin_triangles_have_their_irradiance() {
    let mut cases = Vec::new();
    for (width, height) in [(0.1, 0.1), (1e-2, 1e-2), (1e-3, 1e-3), (1.0, 1e-3), (1.0, 1e-4)] {
        for d in [1.0_f32, 3.0, 10.0, 100.0, 1000.0] {
            for (facing, tilt) in [("straight on", 0.0_f32), ("aslant", 1.2)] {
                let (sin, cos) = tilt.sin_cos();
                // Off the axis by half of its width, tilted about the x axis.
                let corner = |x: f32, y: f32| [x * width - 0.3 * width, d + y * height * sin, y * height * cos];
                let light = light(&[corner(0.0, 0.0), corner(1.0, 0.0), corner(0.0, 1.0)], &[[0, 1, 2]]);
                let name = format!("{width} x {height} at {d}, {facing}");
                cases.push(case(name, light, Vec3::ZERO, Vec3::new(0.1, 1.0, 0.2)));
            }
        }
    }
    irradiance_holds(&cases);
}

/// Thin ones so near that their ends are far apart.
#[test]
fn thin_triangles_nearby_have_their_irradiance() {
    let mut cases = Vec::new();
    for height in [1e-2, 1e-3, 1e-4, 1e-5] {
        for d in [0.01, 0.1, 0.5] {
            let points = [[-0.3, d, 0.0], [0.7, d, 0.0], [0.1, d, height]];
            let turned = [1, 2, 0].map(|i: usize| points[i]);
            for (name, points) in [("", points), (", turned", turned)] {
                let name = format!("1 x {height} at {d}{name}");
                cases.push(case(name, light(&points, &[[0, 1, 2]]), Vec3::ZERO, Vec3::new(0.3, 1.0, 0.2)));
            }
        }
    }
    irradiance_holds(&cases);
}

/// A panel that nearly touches is all there is to be seen: Cycles' rectangle fails here by 92 % and more.
#[test]
fn panels_in_contact_fill_the_hemisphere() {
    let p = Vec3::new(0.1237, 0.0, 0.0412);
    let cases: Vec<Case> = [1e-1, 1e-2, 1e-3, 5e-4, 1e-4, 1e-5]
        .into_iter()
        .map(|d| case(format!("at {d}"), square(d), p, Vec3::Y))
        .collect();
    let last = cases.last().unwrap();
    assert!((last.irradiance / (PI * L) - 1.0).abs() < 1e-4);
    irradiance_holds(&cases);
}

/// Brighter to one side, and in the middle of each triangle.
#[derive(Debug)]
struct Uneven;

impl Emission for Uneven {
    fn radiance(&self, triangle: u32, [u, v]: [f32; 2]) -> Rgb {
        Rgb::splat((1 + triangle % 3) as f32 + 9.0 * u * v)
    }
    fn mean(&self, triangle: u32) -> Rgb {
        // ∫ u v over a triangle is 1/12 of its area.
        Rgb::splat((1 + triangle % 3) as f32 + 0.75)
    }
}

/// Irradiance by f64 quadrature over the triangles, their emission at the barycentrics.
fn by_area(light: &MeshLight, p: Vec3, n: Vec3) -> f64 {
    let count = light.emitters().mesh().triangles.len() as u32;
    let steps = 64;
    let mut sum = 0.0;
    for index in 0..count {
        let [a, b, c] = light.corners(index).map(|p| p.as_dvec3());
        let cross = (b - a).cross(c - a);
        // Midpoints of the triangles of a regular subdivision.
        for i in 0..steps {
            for j in 0..steps - i {
                for (s, inside) in [(1.0 / 3.0, true), (2.0 / 3.0, i + j + 1 < steps)] {
                    if !inside {
                        continue;
                    }
                    let (u, v) = ((f64::from(i) + s) / f64::from(steps), (f64::from(j) + s) / f64::from(steps));
                    let d = a + (b - a) * u + (c - a) * v - p.as_dvec3();
                    let cos = n.as_dvec3().dot(d).max(0.0) / d.length();
                    let le = light.emitters().emission().radiance(index, [u as f32, v as f32]).luminance();
                    let area = 0.5 / f64::from(steps * steps);
                    sum += f64::from(le) * cos * cross.dot(d).abs() / d.length().powi(3) * area;
                }
            }
        }
    }
    sum
}

#[test]
fn emission_that_varies_is_looked_up_where_the_point_is() {
    let (points, triangles) = hills(4);
    let light = MeshLight::new(
        Arc::new(emitters(points, triangles, Uneven)),
        Affine3A::from_mat3_translation(Mat3::from_diagonal(Vec3::new(1.0, 1.0, 2.0)), Vec3::Y),
    );
    let light = light.unwrap();
    let at = |p: Vec3, n: Vec3| {
        let n = n.normalize();
        let irradiance = by_area(&light, p, n);
        Case { hit: Some(hit), radiance: Some(radiance), ..Case::new("uneven", light.clone(), p, n, irradiance) }
    };
    hold(&[around(at(Vec3::ZERO, Vec3::Y)), around(at(Vec3::new(0.2, -3.0, 0.4), Vec3::new(0.3, 1.0, 0.1)))]);
}

/// Light in some triangles only.
#[derive(Debug)]
struct Some3(Vec<u32>);

impl Emission for Some3 {
    fn radiance(&self, triangle: u32, _uv: [f32; 2]) -> Rgb {
        if self.0.contains(&triangle) { Rgb::splat(L as f32) } else { Rgb::BLACK }
    }
    fn mean(&self, triangle: u32) -> Rgb {
        self.radiance(triangle, [0.0; 2])
    }
}

#[test]
fn triangles_that_do_not_emit_are_left_out() {
    let (points, triangles) = hills(3);
    let lit = vec![3, 8, 9, 14];
    let light = MeshLight::new(Arc::new(emitters(points, triangles, Some3(lit.clone()))), Affine3A::IDENTITY).unwrap();
    let (p, n) = (Vec3::new(0.1, -0.6, 0.2), Vec3::Y);
    let irradiance =
        L * lit.iter().map(|&i| irradiance(&light.corners(i).map(|p| p.as_dvec3()), p, Vec3::Y)).sum::<f64>();
    hold(&[around(Case {
        hit: Some(hit),
        radiance: Some(radiance),
        ..Case::new("four of 18", light.clone(), p, n, irradiance)
    })]);
    let at = Receiver { n: Some(n), ..Receiver::everywhere(p) };
    let dark = EmitterHit { dist: 1.0, ng: Vec3::Y, triangle: 4, uv: [0.3; 2] };
    assert_eq!(light.pdf_li(&at, Vec3::Y, Some(&dark)), 0.0);
}

#[test]
fn a_dark_or_flat_mesh_is_no_light() {
    let mesh = |points: Vec<Vec3>| Arc::new(Mesh { points, triangles: vec![[0, 1, 2]], ..Mesh::default() });
    let triangle = mesh(vec![Vec3::ZERO, Vec3::X, Vec3::Y]);
    assert!(MeshEmitters::new(triangle.clone(), Arc::new(Constant(Rgb::BLACK))).is_none());
    assert!(MeshEmitters::new(triangle.clone(), Arc::new(Constant(Rgb::splat(f32::NAN)))).is_none());
    let flat = mesh(vec![Vec3::ZERO, Vec3::X, Vec3::X * 2.0]);
    assert!(MeshEmitters::new(flat, Arc::new(Constant(Rgb::WHITE))).is_none());
    let emitters = Arc::new(MeshEmitters::new(triangle, Arc::new(Constant(Rgb::WHITE))).unwrap());
    let singular = Affine3A::from_scale(Vec3::new(1.0, 0.0, 1.0));
    assert!(MeshLight::new(emitters, singular).is_none());
}

#[test]
fn power_is_the_integral_of_what_leaves() {
    let scene = Bounds { min: Vec3::ZERO, max: Vec3::ONE };
    assert!((f64::from(square(0.5).power(scene)) / (2.0 * PI * L) - 1.0).abs() < 1e-6);
    let (points, triangles) = hills(6);
    let shared = Arc::new(emitters(points, triangles, Constant(Rgb::splat(L as f32))));
    let light = MeshLight::new(shared, Affine3A::from_scale(Vec3::new(2.0, 3.0, 0.5))).unwrap();
    let area: f64 = (0..72)
        .map(|i| light.corners(i).map(|p| p.as_dvec3()))
        .map(|[a, b, c]| 0.5 * (b - a).cross(c - a).length())
        .sum();
    assert!((f64::from(light.power(scene)) / (2.0 * PI * L * area) - 1.0).abs() < 1e-6);
}

/// Bounds of a placed mesh hold its light: brute force over triangles, transforms and receivers.
#[test]
fn a_placed_mesh_has_importance_wherever_one_of_its_triangles_lights() {
    let mut random = Random::new(11);
    let mut lit = 0;
    for round in 0..200 {
        // From flat to crumpled.
        let relief = 10.0_f32.powf(random.range(-6.0, 1.0));
        let (points, triangles) = hills(4);
        let points = points.into_iter().map(|p| p * Vec3::new(1.0, relief, 1.0)).collect();
        let shared = Arc::new(emitters(points, triangles, Constant(Rgb::WHITE)));
        let scale =
            if round % 2 == 0 { Vec3::ONE } else { Vec3::new(random.range(0.1, 3.0), 1.0, random.range(-3.0, -0.1)) };
        let shear = if round % 3 == 0 { random.range(-2.0, 2.0) } else { 0.0 };
        let turn = Mat3::from_quat(glam::Quat::from_axis_angle(random.direction(), random.range(0.0, 3.0)));
        let m = turn * Mat3::from_cols(Vec3::X, Vec3::new(shear, 1.0, 0.0), Vec3::Z) * Mat3::from_diagonal(scale);
        let light = MeshLight::new(shared, Affine3A::from_mat3_translation(m, random.in_box(1.0))).unwrap();
        let bounds = light.bounds().unwrap();
        for _ in 0..100 {
            let at = random.receiver(3.0);
            let n = at.n.unwrap_or(Vec3::Y);
            let reaches = |i: u32| {
                let corners = light.corners(i).map(|p| p.as_dvec3());
                let all = irradiance(&corners, at.p, n);
                let below = irradiance(&corners, at.p, -n);
                (if at.n.is_some() { all } else { all + below }) > 1e-9
            };
            if (0..32).any(reaches) {
                lit += 1;
                assert!(light.importance(&at) > 0.0 && bounds.importance(&at) > 0.0, "{m}, {at:?}, {bounds:?}");
            }
        }
    }
    assert!(lit > 5000, "{lit}");
}

/// Instances share everything but their place.
#[test]
fn instances_share_the_triangles() {
    let mut random = Random::new(12);
    let (points, triangles) = hills(70);
    let count = triangles.len();
    let shared = Arc::new(emitters(points, triangles, Constant(Rgb::WHITE)));
    assert!(shared.bytes() < 130 * count, "{} bytes a triangle", shared.bytes() / count);
    let lights: Vec<MeshLight> = (0..1000)
        .map(|_| MeshLight::new(shared.clone(), Affine3A::from_translation(random.in_box(50.0))).unwrap())
        .collect();
    assert_eq!(Arc::strong_count(&shared), 1001);
    assert!(lights.iter().all(|light| Arc::ptr_eq(light.emitters(), &shared)));
    assert!(std::mem::size_of::<MeshLight>() <= 16);
}

/// Attributes play no role; a mesh that has them emits as one that hasn't.
#[test]
fn attributes_do_not_matter() {
    let plain = square(0.5);
    let mesh = Mesh { normals: Some(Attribute::Point(vec![Vec3::X; 4])), ..plain.emitters().mesh().clone() };
    let emitters = MeshEmitters::new(Arc::new(mesh), Arc::new(Constant(Rgb::splat(L as f32)))).unwrap();
    let other = MeshLight::new(Arc::new(emitters), Affine3A::IDENTITY).unwrap();
    let at = Receiver { n: Some(Vec3::Y), ..Receiver::everywhere(Vec3::ZERO) };
    for i in 0..100 {
        let u = [0.01 * i as f32, (0.37 * i as f32).fract()];
        assert_eq!(plain.sample_li(&at, u[1], u), other.sample_li(&at, u[1], u));
    }
}
