//! The choice among lights: the odds that are told are those that are drawn by, and nothing that can
//! light a point is left out.

use std::sync::Arc;

use penumbra::light::{
    Cone, Cylinder, Decay, Disk, Distant, Dome, Emitter, Falloff, Flat, Light, LightBounds, LightSet, LightTree, Point,
    Profile, Receiver, Rect, Rules, Shaping, Sphere, Spread, Strategy,
};
use penumbra::math::{Bounds, DMat3, Rgb, Vec3};

use crate::random::{Random, range};

const SCENE: Bounds = Bounds { min: Vec3::splat(-10.0), max: Vec3::splat(10.0) };

/// A point of `light` and a normal there that send light to `at`, chosen at random; `None` where the
/// random ones do not.
fn sends(random: &mut Random, light: &LightBounds, at: &Receiver) -> Option<Vec3> {
    let [x, y, z] = [random.unit(), random.unit(), random.unit()];
    let p = light.bounds.min + light.bounds.extent() * Vec3::new(x, y, z);
    let axis = if light.two_sided && random.index(2) == 0 { -light.axis } else { light.axis };
    let normal =
        if light.cos_normals <= -1.0 { random.direction() } else { random.in_cone(axis, light.cos_normals.acos()) };
    let leaves = (at.p - p).as_dvec3().normalize();
    // Not at the very edge of what is lit, where rounding here decides.
    let emits = leaves.dot(normal.as_dvec3()) > f64::from(light.cos_emission) + 1e-7;
    let receives = at.n.is_none_or(|n| (p - at.p).as_dvec3().dot(n.as_dvec3()) > 0.0);
    (emits && receives).then_some(p)
}

#[test]
fn importance_is_zero_only_where_nothing_arrives() {
    let mut random = Random::new(1);
    let (mut dark, mut lit) = (0, 0);
    for _ in 0..20_000 {
        // Boxes from points to such as hold the receiver.
        let scale = 10.0_f32.powf(random.range(-3.0, 1.0));
        let mut light = random.light(scale);
        let grow = random.in_box(scale).abs() * random.unit();
        light.bounds = Bounds { min: light.bounds.min - grow, max: light.bounds.max + grow };
        let at = random.receiver(1.0);
        let importance = light.importance(&at);
        assert!(importance.is_finite() && importance >= 0.0, "{light:?} {at:?}");
        let arrives = (0..100).find_map(|_| sends(&mut random, &light, &at));
        assert!(arrives.is_none() || importance > 0.0, "{light:?} {at:?}: from {arrives:?}");
        dark += u32::from(importance == 0.0);
        lit += u32::from(arrives.is_some());
    }
    assert!(dark > 2000 && lit > 5000, "{dark} dark, {lit} lit");
}

#[test]
fn a_light_behind_the_plane_or_off_its_cone_has_none() {
    let bounds = Bounds { min: Vec3::new(-1.0, -2.0, -1.0), max: Vec3::new(1.0, -1e-3, 1.0) };
    let light =
        LightBounds { bounds, axis: Vec3::Y, cos_normals: 1.0, cos_emission: 0.9, intensity: 1.0, two_sided: false };
    let at = |p: Vec3, n: Vec3| Receiver { n: Some(n), ..Receiver::everywhere(p) };
    assert_eq!(light.importance(&at(Vec3::ZERO, Vec3::Y)), 0.0);
    assert!(light.importance(&at(Vec3::ZERO, Vec3::new(0.1, 1.0, 0.0).normalize())) > 0.0);
    assert!(light.importance(&at(Vec3::new(0.0, 5.0, 0.0), Vec3::NEG_Y)) > 0.0);
    assert_eq!(light.importance(&at(Vec3::new(9.0, 5.0, 0.0), Vec3::NEG_Y)), 0.0);
    let two_sided = LightBounds { two_sided: true, ..light };
    assert_eq!(light.importance(&at(Vec3::new(0.0, -9.0, 0.0), Vec3::Y)), 0.0);
    assert!(two_sided.importance(&at(Vec3::new(0.0, -9.0, 0.0), Vec3::Y)) > 0.0);
}

/// Irradiance at `at` of small surfaces, points and beams, which are what the bounds say.
fn irradiance(light: &LightBounds, at: &Receiver) -> f64 {
    let d = (light.bounds.center() - at.p).as_dvec3();
    let wi = d.normalize();
    let received = at.n.map_or(1.0, |n| wi.dot(n.as_dvec3()).max(0.0));
    let along = -wi.dot(light.axis.as_dvec3());
    let cos = if light.two_sided { along.abs() } else { along.max(0.0) };
    let emitted = if light.cos_normals <= -1.0 { 1.0 } else { cos };
    f64::from(light.intensity) * received * emitted / d.length_squared()
}

#[test]
fn the_importance_of_a_tree_is_about_the_irradiance() {
    let mut random = Random::new(2);
    let (mut ratios, mut dim, mut logs) = (Vec::new(), Vec::new(), 0.0);
    for _ in 0..2000 {
        let facing = random.direction();
        let spread = random.range(0.0, 3.1);
        let lights: Vec<LightBounds> = (0..50)
            .map(|_| LightBounds {
                axis: random.in_cone(facing, spread),
                cos_normals: 1.0,
                cos_emission: 0.0,
                ..random.light(1.0)
            })
            .map(|light| LightBounds { bounds: Bounds { min: light.bounds.min, max: light.bounds.min }, ..light })
            .collect();
        let tree = LightTree::new(&lights).unwrap();
        let p = random.direction() * random.range(2.0, 20.0);
        let at = Receiver { n: Some(random.direction()), ..Receiver::everywhere(p) };
        let exact: f64 = lights.iter().map(|light| irradiance(light, &at)).sum();
        let most: f64 = lights.iter().map(|light| f64::from(light.intensity)).sum::<f64>() / p.length_squared() as f64;
        let ratio = f64::from(tree.importance(&at)) / exact;
        // Where nearly all of the lights face away, an importance that is too high costs little.
        if exact > 0.2 * most {
            ratios.push(ratio);
            logs += ratio.ln().abs();
        } else if exact > 0.02 * most {
            dim.push(ratio);
        }
    }
    let ((low, high), (low_dim, high_dim)) = (range(ratios.iter().copied()), range(dim.iter().copied()));
    let mean = (logs / ratios.len() as f64).exp();
    println!("{}: {low} to {high}, mean factor {mean}; {}: {low_dim} to {high_dim}", ratios.len(), dim.len());
    assert!(ratios.len() > 200 && low > 0.7 && high < 5.0 && mean < 1.5, "{low} to {high}, mean factor {mean}");
    assert!(dim.len() > 200 && low_dim > 0.5 && high_dim < 20.0, "{low_dim} to {high_dim}");
}

/// Odds of all items and of choosing none: a box may promise light that none of the boxes in it has.
#[test]
fn the_tree_draws_by_the_odds_that_it_tells() {
    let mut random = Random::new(3);
    let (mut certain, mut total) = (0, 0);
    for count in [1, 2, 8, 9, 65, 700] {
        let lights: Vec<LightBounds> = (0..count).map(|_| random.light(1.0)).collect();
        let tree = LightTree::new(&lights).unwrap();
        for _ in 0..8 {
            let at = random.receiver(1.5);
            let pmfs: Vec<f64> = (0..count).map(|i| f64::from(tree.pmf(&at, i))).collect();
            let sum: f64 = pmfs.iter().sum();
            let n = 1 << 16;
            let mut seen = vec![0_u32; count as usize];
            let (mut rest, mut none) = (0.0, 0_u32);
            for i in 0..n {
                let Some(chosen) = tree.sample(&at, (i as f32 + 0.5) / n as f32) else {
                    none += 1;
                    continue;
                };
                assert_eq!(chosen.pmf, tree.pmf(&at, chosen.item));
                assert!(chosen.pmf > 0.0 && (0.0..1.0).contains(&chosen.u));
                seen[chosen.item as usize] += 1;
                rest += f64::from(chosen.u);
            }
            // Each light has an interval of the random number of its own: off by two points at most.
            for (i, (&seen, pmf)) in seen.iter().zip(&pmfs).enumerate() {
                assert!((f64::from(seen) - pmf * f64::from(n)).abs() <= 2.0 + 1e-4 * f64::from(n), "{count}, {i}");
            }
            let none = f64::from(none) / f64::from(n);
            assert!((sum + none - 1.0).abs() < 1e-3, "{count}: {sum} and {none}");
            assert!(none == 1.0 || (rest / f64::from(n) / (1.0 - none) - 0.5).abs() < 0.05, "{count}: {rest}");
            total += 1;
            certain += u32::from(sum > 0.98 || sum == 0.0);
        }
    }
    assert!(certain > total * 9 / 10, "{certain} of {total}");
}

#[test]
fn nothing_that_can_light_a_point_is_left_out_of_the_tree() {
    let mut random = Random::new(4);
    let mut found = 0;
    for _ in 0..60 {
        let scale = 10.0_f32.powf(random.range(-4.0, 4.0));
        let lights: Vec<LightBounds> = (0..200).map(|_| random.light(scale)).collect();
        let tree = LightTree::new(&lights).unwrap();
        for _ in 0..20 {
            let at = random.receiver(1.5 * scale);
            for (i, light) in lights.iter().enumerate() {
                if (0..4).any(|_| sends(&mut random, light, &at).is_some()) {
                    found += 1;
                    assert!(tree.pmf(&at, i as u32) > 0.0, "{light:?} {at:?}");
                }
            }
        }
    }
    assert!(found > 50_000, "{found}");
}

#[test]
fn odds_keep_their_size_over_all_orders_of_magnitude() {
    let mut random = Random::new(5);
    let mut lights: Vec<LightBounds> = (0..3000).map(|_| random.light(1.0)).collect();
    for light in &mut lights {
        light.intensity = 10.0_f32.powf(random.range(-30.0, 30.0));
    }
    let tree = LightTree::new(&lights).unwrap();
    for _ in 0..50 {
        let at = Receiver::everywhere(random.in_box(2.0));
        for u in [0.0, 0.5, 1.0 - f32::EPSILON / 2.0] {
            let chosen = tree.sample(&at, u).unwrap();
            assert!(chosen.pmf > 0.0 && chosen.pmf == tree.pmf(&at, chosen.item));
        }
        let sum: f64 = (0..3000).map(|i| f64::from(tree.pmf(&at, i))).sum();
        assert!(sum > 0.9 && sum < 1.0 + 1e-4, "{sum}");
    }
}

#[test]
fn dark_and_coincident_lights_make_a_tree() {
    let light = LightBounds {
        bounds: Bounds { min: Vec3::ONE, max: Vec3::ONE },
        axis: Vec3::Y,
        cos_normals: -1.0,
        cos_emission: 0.0,
        intensity: 1.0,
        two_sided: false,
    };
    let dark = LightBounds { intensity: 0.0, ..light };
    assert!(LightTree::new(&[]).is_none() && LightTree::new(&[dark; 20]).is_none());
    let lights = [vec![light; 5000], vec![dark; 3]].concat();
    let tree = LightTree::new(&lights).unwrap();
    let at = Receiver::everywhere(Vec3::ZERO);
    assert_eq!(tree.pmf(&at, 5001), 0.0);
    let (low, high) = range((0..5000).map(|i| f64::from(tree.pmf(&at, i))));
    assert!(low > 0.5 / 5000.0 && high < 2.0 / 5000.0, "{low} {high}");
}

#[test]
fn rays_meet_the_boxes_that_they_meet_one_by_one() {
    let mut random = Random::new(6);
    let lights: Vec<LightBounds> = (0..2000).map(|_| random.light(1.0)).collect();
    let tree = LightTree::new(&lights).unwrap();
    let mut met = 0;
    for i in 0..2000 {
        let (p, t_max) = (random.in_box(2.0), random.range(0.1, 4.0));
        // Along an axis, too, where the reciprocal of the direction is infinite.
        let wi = if i % 10 == 0 { Vec3::AXES[i / 10 % 3] } else { random.direction() };
        let mut seen = vec![false; lights.len()];
        tree.along(p, wi, t_max, |item| assert!(!std::mem::replace(&mut seen[item as usize], true)));
        for (light, seen) in lights.iter().zip(&seen) {
            // A point of the ray within the middle of the box.
            let inner = Bounds {
                min: light.bounds.center() - 0.49 * light.bounds.extent(),
                max: light.bounds.center() + 0.49 * light.bounds.extent(),
            };
            let hits = (0..3).try_fold((0.0_f32, t_max), |(near, far), axis| {
                let (a, b) = ((inner.min[axis] - p[axis]) / wi[axis], (inner.max[axis] - p[axis]) / wi[axis]);
                let (a, b) = if wi[axis] == 0.0 { (near, far) } else { (a.min(b), a.max(b)) };
                let inside = wi[axis] != 0.0 || (inner.min[axis]..=inner.max[axis]).contains(&p[axis]);
                (inside && a.max(near) <= b.min(far)).then_some((a.max(near), b.min(far)))
            });
            met += u32::from(hits.is_some());
            assert!(hits.is_none() || *seen, "{light:?} {p} {wi}");
        }
    }
    assert!(met > 200, "{met}");
    // Few boxes are visited in vain.
    let mut visited = 0;
    for _ in 0..1000 {
        tree.along(random.in_box(2.0), random.direction(), f32::INFINITY, |_| visited += 1);
    }
    assert!(visited < 20 * 1000, "{visited}");
}

fn point(p: Vec3, intensity: f32) -> Point {
    Point { p, intensity: Rgb::splat(intensity), profile: None }
}

fn points(random: &mut Random, count: usize) -> Vec<Light> {
    (0..count)
        .map(|i| {
            let intensity = if i % 7 == 3 { 0.0 } else { 0.1 + random.unit() };
            Light::from(point(random.in_box(3.0), intensity))
        })
        .collect()
}

/// The odds of `set` at `at` sum to 1, and draws follow them.
fn holds(what: &str, set: &LightSet, at: &Receiver) {
    let pmfs: Vec<f64> = (0..set.len()).map(|i| f64::from(set.pmf(at, i as u32))).collect();
    let sum: f64 = pmfs.iter().sum();
    assert!((sum - 1.0).abs() < 1e-4, "{what}: sum {sum}");
    let n = 1 << 16;
    let mut seen = vec![0_u32; set.len()];
    for i in 0..n {
        let choice = set.choose(at, (i as f32 + 0.5) / n as f32).unwrap();
        assert!((f64::from(choice.pmf) / pmfs[choice.light as usize] - 1.0).abs() < 1e-5, "{what}");
        assert!((0.0..1.0).contains(&choice.u), "{what}");
        seen[choice.light as usize] += 1;
    }
    for (i, (&seen, pmf)) in seen.iter().zip(&pmfs).enumerate() {
        // An alias table has up to as many intervals for a light as there are lights.
        let slack = 2.0 + 1e-4 * f64::from(n) + if set.len() > 40 { 2.0 * (pmf * set.len() as f64 + 1.0) } else { 0.0 };
        assert!((f64::from(seen) - pmf * f64::from(n)).abs() <= slack, "{what}, light {i}: {seen} of {n}, pmf {pmf}");
    }
}

#[test]
fn the_choice_among_lights_has_the_odds_that_it_tells() {
    let mut random = Random::new(7);
    for strategy in [Strategy::Tree, Strategy::Power, Strategy::Uniform] {
        for count in [1, 3, 32, 33, 500] {
            for far in [false, true] {
                let mut lights = points(&mut random, count);
                if far {
                    lights.insert(0, Distant::new(Vec3::Y, 0.0, Rgb::splat(0.1)).into());
                    lights.push(Distant::new(Vec3::X, 0.1, Rgb::splat(0.2)).into());
                    lights.push(Dome::new(Rgb::splat(0.05), None).into());
                }
                let set = LightSet::chosen_by(strategy, lights, SCENE, 1, &[]);
                for _ in 0..3 {
                    let at = Receiver::everywhere(random.in_box(3.0));
                    holds(&format!("{strategy:?}, {count} lights, far: {far}"), &set, &at);
                }
            }
        }
    }
}

#[test]
fn each_class_of_receivers_has_the_lights_that_reach_it() {
    let mut random = Random::new(8);
    for count in [6, 20, 200] {
        let mut lights = points(&mut random, count);
        lights.push(Dome::new(Rgb::splat(0.05), None).into());
        for (i, light) in lights.iter_mut().enumerate() {
            // Class 0 has all, class 1 every other, class 2 none, class 3 one.
            light.rules = Rules { receivers: Some(Arc::from([true, i % 2 == 0, false, i == 1])), ..Rules::NONE };
        }
        let set = LightSet::new(lights, SCENE, 4);
        for class in 0..4 {
            let at = Receiver { class, ..Receiver::everywhere(random.in_box(3.0)) };
            for i in 0..set.len() as u32 {
                let reaches = set.get(i).rules.lights(class);
                let shines = set.get(i).emitter.importance(&at) > 0.0;
                assert_eq!(set.pmf(&at, i) > 0.0, reaches && shines, "{count} lights, class {class}, light {i}");
            }
            if class == 2 {
                assert_eq!(set.choose(&at, 0.5), None);
            } else {
                holds(&format!("{count} lights, class {class}"), &set, &at);
            }
        }
    }
}

#[test]
fn nothing_is_chosen_where_nothing_arrives() {
    let below = |count| (0..count).map(|i| Light::from(point(Vec3::new(i as f32, -1.0, 0.0), 1.0))).collect();
    let up = Receiver { n: Some(Vec3::Y), ..Receiver::everywhere(Vec3::ZERO) };
    let down = Receiver { n: Some(Vec3::NEG_Y), ..up };
    for count in [0, 1, 5, 50] {
        let set = LightSet::new(below(count), SCENE, 1);
        assert_eq!(set.choose(&up, 0.3), None, "{count}");
        assert_eq!(set.choose(&down, 0.3).is_some(), count > 0);
        assert!((0..count as u32).all(|i| set.pmf(&up, i) == 0.0));
        // A class that no light was sorted for has none.
        assert_eq!(set.choose(&Receiver { class: 7, ..down }, 0.3), None);
    }
    let one = LightSet::new(below(1), SCENE, 1);
    assert_eq!((one.pmf(&up, 0), one.pmf(&down, 0)), (0.0, 1.0));
}

/// Axes with z along a random direction.
fn axes(random: &mut Random) -> DMat3 {
    let z = random.direction().as_dvec3().normalize();
    let x = z.any_orthonormal_vector();
    DMat3::from_cols(x, z.cross(x), z)
}

/// One of each kind of lamp, anywhere and of any strength.
fn lamp(random: &mut Random, i: usize) -> Light {
    let (p, size) = (random.in_box(2.0), random.range(0.01, 0.5));
    let radiance = Rgb::splat(10.0_f32.powf(random.range(-20.0, 10.0)));
    let half = f64::from(random.range(0.01, 1.5));
    let cone = Shaping { cone: Some(Cone::blend(half, 0.5)), ..Shaping::default() };
    let falloff = [Falloff::Quadratic, Falloff::Linear, Falloff::Constant][i / 3 % 3];
    let range = Decay { range: 2.0, falloff, ..Decay::PHYSICAL };
    let profile = match i % 3 {
        0 => Some(Arc::new(Profile::new(axes(random), cone, Decay::PHYSICAL))),
        1 => Some(Arc::new(Profile::new(axes(random), Shaping::default(), range))),
        _ => None,
    };
    let flat = Flat {
        two_sided: i.is_multiple_of(2),
        spread: if i.is_multiple_of(4) { Spread::new(half) } else { Spread::FULL },
        profile: profile.clone(),
        ..Flat::new(p.as_dvec3(), axes(random), radiance)
    };
    let size = f64::from(size);
    match random.index(5) {
        0 => Point { p, intensity: radiance, profile }.into(),
        1 => Sphere { center: p, radius: size as f32, radiance, facing: i.is_multiple_of(2), profile }.into(),
        2 => Rect::new(flat, [size, 0.3 * size]).into(),
        3 => Disk::new(flat, [size, 0.5 * size]).into(),
        _ => {
            let (axis, size) = (random.direction(), size as f32);
            Cylinder::new(p, axis, 0.2 * size, size, radiance, profile).into()
        }
    }
}

#[test]
fn rays_meet_the_lamps_that_they_meet_one_by_one() {
    let mut random = Random::new(10);
    for count in [3, 60, 1000] {
        let set = LightSet::new((0..count).map(|i| lamp(&mut random, i)).collect(), SCENE, 1);
        let mut met = 0;
        for _ in 0..3000 {
            let (p, wi) = (random.in_box(2.5), random.direction());
            let range = [random.range(0.0, 1.0), random.range(1.0, 5.0)];
            let mut along = Vec::new();
            set.lamps_along(p, wi, range, |i, _, hit| along.push((i, *hit)));
            along.sort_by_key(|&(i, _)| i);
            let one_by_one: Vec<_> = (0..count as u32)
                .filter_map(|i| Some((i, set.get(i).emitter.hit(p, wi)?)))
                .filter(|(_, hit)| hit.dist >= range[0] && hit.dist < range[1])
                .collect();
            assert_eq!(along, one_by_one);
            met += along.len();
        }
        assert!(met > count, "{met}");
    }
}

#[test]
fn a_light_that_sends_something_is_chosen_in_any_scene() {
    let mut random = Random::new(9);
    let mut arrived = 0;
    for count in [4, 31, 34, 300] {
        for strategy in [Strategy::Tree, Strategy::Power, Strategy::Uniform] {
            let mut lights: Vec<Light> = (0..count).map(|i| lamp(&mut random, i)).collect();
            lights.push(Distant::new(random.direction(), 0.0, Rgb::splat(1e-3)).into());
            let set = LightSet::chosen_by(strategy, lights, SCENE, 1, &[]);
            for _ in 0..100 {
                let at = random.receiver(2.0);
                for (i, light) in set.iter().enumerate() {
                    let u = [random.unit(), random.unit()];
                    let Some(sample) = light.emitter.sample_li(&at, 0.5, u) else { continue };
                    if at.n.is_none_or(|n| n.dot(sample.wi) > 0.0) && !sample.li.is_black() {
                        arrived += 1;
                        let light = &light.emitter;
                        assert!(set.pmf(&at, i as u32) > 0.0, "{strategy:?}, {count}: {light:?}, {at:?}, {sample:?}");
                    }
                }
            }
        }
    }
    assert!(arrived > 10_000, "{arrived}");
}

fn decaying(p: Vec3, intensity: f32, decay: Decay) -> Light {
    let profile = Profile::new(DMat3::IDENTITY, Shaping::default(), decay);
    Point { profile: Some(Arc::new(profile)), ..point(p, intensity) }.into()
}

/// Decays that lights take in turn: each law alone, all of them, and different ranges.
fn decays() -> Vec<(&'static str, Vec<Decay>)> {
    let law = |falloff| Decay { falloff, ..Decay::PHYSICAL };
    let polynomial = |kc, kl, kq| law(Falloff::Polynomial { kc, kl, kq });
    let laws = [
        ("quadratic", law(Falloff::Quadratic)),
        ("linear", law(Falloff::Linear)),
        ("none", law(Falloff::Constant)),
        ("polynomial", polynomial(1.0, 0.5, 0.1)),
        ("nearly none", polynomial(1.0, 1e-3, 1e-5)),
        ("smooth", Decay { smooth: 4.0, ..Decay::PHYSICAL }),
        ("smooth, none", Decay { smooth: 4.0, ..law(Falloff::Constant) }),
        ("range", Decay { range: 60.0, ..Decay::PHYSICAL }),
        ("range, none", Decay { range: 60.0, ..law(Falloff::Constant) }),
    ];
    let ranges = (0..13).map(|k| Decay { range: 1.5_f64.powi(k * 7 % 13), ..Decay::PHYSICAL });
    let mut decays: Vec<_> = laws.into_iter().map(|(name, decay)| (name, vec![decay])).collect();
    decays.push(("mixed", laws.map(|(_, decay)| decay).to_vec()));
    decays.push(("ranges", ranges.collect()));
    decays
}

/// Variance of one choice among points in units of the square of their irradiance at `at`, exact; by
/// the odds of `set`, uniform, and by the odds of a scan over all.
fn variances(set: &LightSet, at: &Receiver) -> [f64; 3] {
    let lights: Vec<(f64, f64, f64)> = (0..set.len() as u32)
        .filter_map(|i| {
            let light = &set.get(i).emitter;
            let sample = light.sample_li(at, 0.5, [0.5; 2])?;
            let e = f64::from(sample.li.luminance() * at.n.map_or(1.0, |n| n.dot(sample.wi).max(0.0)));
            (e > 0.0).then(|| (e, f64::from(set.pmf(at, i)), f64::from(light.importance(at))))
        })
        .collect();
    let sum = |f: &dyn Fn(&(f64, f64, f64)) -> f64| lights.iter().map(f).sum::<f64>();
    let (total, importance) = (sum(&|l| l.0), sum(&|l| l.2));
    let squares = [
        sum(&|&(e, pmf, _)| e * e / pmf),
        sum(&|&(e, ..)| e * e * set.len() as f64),
        sum(&|&(e, _, weight)| e * e * importance / weight),
    ];
    squares.map(|squares| squares / (total * total) - 1.0)
}

#[test]
fn near_and_far_lights_of_any_decay_are_chosen_well() {
    let mut random = Random::new(11);
    for (name, decays) in decays() {
        for count in [34, 1000] {
            // Half of the lights at half a metre, half at 50 m.
            let lights = (0..count).map(|i| {
                let dist = if i % 2 == 0 { 0.5 } else { 50.0 };
                decaying(random.direction() * dist, 1.0, decays[i % decays.len()])
            });
            let set = LightSet::new(lights.collect(), SCENE, 1);
            let at = Receiver::everywhere(random.in_box(0.02));
            let [tree, uniform, scan] = variances(&set, &at);
            // The scan knows these lights exactly. A tree of quadratic ones has 0.36 here.
            assert!(scan < 1e-3 && tree < 0.65, "{name}, {count}: {tree}, scan {scan}");
            assert!(tree < uniform + 0.02, "{name}, {count}: {tree}, uniform {uniform}");
            if !name.starts_with("range") {
                holds(&format!("{name}, {count} lights"), &set, &at);
            }
        }
    }
}

#[test]
fn ten_thousand_lights_of_any_decay_are_chosen_well() {
    let mut random = Random::new(12);
    for (name, decays) in decays() {
        let lights = (0..10_000).map(|i| decaying(random.in_box(10.0), 0.1 + random.unit(), decays[i % decays.len()]));
        let set = LightSet::new(lights.collect(), SCENE, 1);
        let mut sums = [0.0; 3];
        for _ in 0..20 {
            let at = Receiver { n: Some(random.direction()), ..Receiver::everywhere(random.in_box(10.0)) };
            sums.iter_mut().zip(variances(&set, &at)).for_each(|(sum, v)| *sum += v / 20.0);
        }
        // 0.23 for quadratic ones; those out of their range are told from others by single boxes only.
        let [tree, uniform, scan] = sums;
        let most = if name.starts_with("range") { 1.0 } else { 0.5 };
        assert!(tree < most && tree < 0.05 * uniform, "{name}: {tree}, uniform {uniform}, scan {scan}");
    }
}

#[test]
fn the_tree_tells_near_lights_from_far_ones() {
    let lights = (0..400).map(|i| Light::from(point(Vec3::new((i % 20) as f32, 1.0, (i / 20) as f32), 1.0))).collect();
    let set = LightSet::new(lights, SCENE, 1);
    let at = Receiver { n: Some(Vec3::Y), ..Receiver::everywhere(Vec3::new(3.0, 0.5, 5.0)) };
    let near = set.pmf(&at, 5 * 20 + 3);
    let exact: f64 = (0..400)
        .map(|i| {
            let d = Vec3::new((i % 20) as f32, 1.0, (i / 20) as f32) - at.p;
            f64::from(d.y / d.length().powi(3))
        })
        .sum();
    let share = 4.0 / exact;
    println!("share {share}, pmf {near}");
    assert!(f64::from(near) > 0.3 * share, "{near} {share}");
}
