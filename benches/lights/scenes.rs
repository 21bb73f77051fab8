//! Sets of lights and receivers, each hard for the choice in its own way.

use penumbra::light::{LightBounds, Receiver};
use penumbra::math::{Bounds, Vec3};

/// SplitMix64.
pub struct Random(pub u64);

impl Random {
    pub fn unit(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let x = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((x ^ (x >> 31)) >> 40) as f32 / (1 << 24) as f32
    }

    pub fn range(&mut self, from: f32, to: f32) -> f32 {
        from + (to - from) * self.unit()
    }

    pub fn direction(&mut self) -> Vec3 {
        penumbra::sampling::warp::sample_uniform_sphere([self.unit(), self.unit()])
    }
}

/// Small lights, and points that they light.
pub struct Lights {
    pub name: &'static str,
    pub lights: Vec<LightBounds>,
    pub receivers: Vec<Receiver>,
}

fn light(p: Vec3, size: f32, axis: Option<Vec3>, intensity: f32, two_sided: bool) -> LightBounds {
    LightBounds {
        bounds: Bounds { min: p - size, max: p + size },
        axis: axis.unwrap_or(Vec3::Z),
        cos_normals: if axis.is_some() { 1.0 } else { -1.0 },
        cos_emission: 0.0,
        intensity,
        two_sided,
    }
}

/// `count` lights in each of several arrangements, `receivers` points each.
pub fn all(count: usize, receivers: usize) -> Vec<Lights> {
    let mut random = Random(1);
    let mut floor = |half: f32| -> Vec<Receiver> {
        (0..receivers)
            .map(|_| {
                let p = Vec3::new(random.range(-half, half), 0.0, random.range(-half, half));
                Receiver { n: Some(Vec3::Y), ..Receiver::everywhere(p) }
            })
            .collect()
    };
    let floors = [floor(10.0), floor(10.0), floor(10.0), floor(10.0), floor(10.0), floor(3.0)];
    let [f0, f1, f2, f3, f4, f5] = floors;
    let mut random = Random(2);
    let cloud = (0..count).map(|_| {
        let p = Vec3::new(random.range(-10.0, 10.0), random.range(0.2, 5.0), random.range(-10.0, 10.0));
        light(p, 0.0, None, 1.0, false)
    });
    let cloud: Vec<_> = cloud.collect();
    let uneven = cloud.iter().map(|l| LightBounds { intensity: (4.0 * random.range(-1.0, 1.0)).exp(), ..*l }).collect();
    let shreds = cloud.iter().map(|l| light(l.bounds.min, 0.005, Some(random.direction()), 1.0, true));
    let shreds: Vec<_> = shreds.collect();
    let side = (count as f32).sqrt().ceil() as usize;
    let grid = |i: usize| {
        let at = |i: usize| 20.0 * (i as f32 + 0.5) / side as f32 - 10.0;
        (at(i % side), at(i / side))
    };
    let street = (0..count).map(|i| {
        let (x, z) = grid(i);
        light(Vec3::new(x, 0.5, z), 0.01, Some(Vec3::NEG_Y), 1.0, false)
    });
    let spots = (0..count).map(|i| {
        let (x, z) = grid(i);
        let spot = light(Vec3::new(x, 1.0, z), 0.0, Some(Vec3::NEG_Y), 1.0, false);
        LightBounds { cos_emission: 0.9, ..spot }
    });
    let ball = (0..count).map(|i| {
        // Fibonacci's points on a sphere above the floor.
        let y = 1.0 - 2.0 * (i as f32 + 0.5) / count as f32;
        let phi = 2.399_963_2 * i as f32;
        let n = Vec3::new((1.0 - y * y).sqrt() * phi.cos(), y, (1.0 - y * y).sqrt() * phi.sin());
        light(n + Vec3::new(0.0, 1.5, 0.0), 0.01, Some(n), 1.0, false)
    });
    vec![
        Lights { name: "points, uneven", lights: uneven, receivers: f1 },
        Lights { name: "street lamps", lights: street.collect(), receivers: f3 },
        Lights { name: "narrow spots", lights: spots.collect(), receivers: f4 },
        Lights { name: "a ball of triangles", lights: ball.collect(), receivers: f5 },
        Lights { name: "shreds, two-sided", lights: shreds, receivers: f2 },
        Lights { name: "points", lights: cloud, receivers: f0 },
    ]
}

/// Irradiance at `at` of a light that is small.
pub fn irradiance(light: &LightBounds, at: &Receiver) -> f64 {
    let d = (light.bounds.center() - at.p).as_dvec3();
    let wi = d.normalize();
    let received = at.n.map_or(1.0, |n| wi.dot(n.as_dvec3()).max(0.0));
    let along = -wi.dot(light.axis.as_dvec3());
    let cos = if light.two_sided { along.abs() } else { along.max(0.0) };
    let emitted = match () {
        () if light.cos_normals <= -1.0 => 1.0,
        () if cos <= f64::from(light.cos_emission) => 0.0,
        () => cos,
    };
    f64::from(light.intensity) * received * emitted / d.length_squared()
}
