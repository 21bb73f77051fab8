//! Laws of scattering.

use penumbra::bsdf::{Bsdf, Surface};
use penumbra::math::{Rgb, Vec3};
use penumbra::sampling::{Dimension, Pattern, Sampler};

fn wo(degrees: f32) -> Vec3 {
    let t = degrees.to_radians();
    Vec3::new(t.sin(), 0.0, t.cos())
}

fn furnace(s: &Surface, entering: bool, wo: Vec3) -> f64 {
    let bsdf = Bsdf::new(s, entering);
    let n = 1 << 16;
    let sampler = Sampler::new(Pattern::Sobol, 1);
    let mut sum = 0.0;
    for i in 0..n {
        let s = sampler.for_sample(0, 0, i);
        if let Some(b) = bsdf.sample(wo, s.get_1d(Dimension::FREE), s.get_2d(Dimension::LENS)) {
            sum += f64::from(b.weight.sum().mean());
        }
    }
    sum / n as f64
}

#[test]
fn against_cycles() {
    let w = Rgb::WHITE;
    let d = Surface { base_color: w, ..Surface::default() };
    let list: &[(&str, Surface, [f64; 5])] = &[
        ("metal 1 r .5", Surface { metallic: 1.0, roughness: 0.5, ..d }, [1.0; 5]),
        ("metal 1 r 1", Surface { metallic: 1.0, roughness: 1.0, ..d }, [1.0; 5]),
        (
            "metal .5 r .5",
            Surface { base_color: w * 0.5, metallic: 1.0, roughness: 0.5, ..d },
            [0.4788, 0.4735, 0.4759, 0.5019, 0.5514],
        ),
        (
            "metal .5 r 1",
            Surface { base_color: w * 0.5, metallic: 1.0, roughness: 1.0, ..d },
            [0.2611, 0.2858, 0.3126, 0.3651, 0.4379],
        ),
        (
            "dielectric 0 r 0",
            Surface { base_color: w * 0.0, roughness: 0.0, ..d },
            [0.04, 0.0502, 0.0892, 0.2531, 0.6128],
        ),
        (
            "dielectric 0 r .5",
            Surface { base_color: w * 0.0, roughness: 0.5, ..d },
            [0.0373, 0.0467, 0.0678, 0.1181, 0.1791],
        ),
        ("dielectric 1 r .5", Surface { roughness: 0.5, ..d }, [0.9999, 0.9994, 0.9986, 0.9946, 0.9900]),
        (
            "transmission 1 r 1",
            Surface { transmission: 1.0, roughness: 1.0, ..d },
            [1.0002, 1.0004, 1.0001, 0.9996, 0.9926],
        ),
        (
            "transmission .25 r 0",
            Surface { base_color: w * 0.25, transmission: 1.0, roughness: 0.0, ..d },
            [0.52, 0.5251, 0.5446, 0.6265, 0.8064],
        ),
        ("thin 1 r .5", Surface { transmission: 1.0, roughness: 0.5, thin: true, ..d }, [1.0; 5]),
    ];
    for (name, s, expected) in list {
        let got: Vec<f64> = [0.0, 45.0, 60.0, 75.0, 85.0].iter().map(|&a| furnace(s, true, wo(a))).collect();
        println!("{name:24} {got:.4?}\n{:24} {expected:.4?}", "");
    }
}
