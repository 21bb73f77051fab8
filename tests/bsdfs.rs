//! Laws of scattering: one list of surfaces, each line held to all of them.

#[path = "support/chi2.rs"]
mod chi2;

use std::f64::consts::{PI, TAU};
use std::fmt::Debug;

use penumbra::bsdf::{
    Bsdf, BsdfSample, Builder, Closure, Coat, Conductor, Inside, Lobe, Method, Microfacets, Sheen, Stretched,
    Subsurface, Surface, ThinFilm, Widening, f0_from_eta, fresnel_dielectric,
};
use penumbra::math::{Frame, Rgb, Vec3};
use penumbra::sampling::{Dimension, Pattern, Sampler};

const WHITE: Surface = Surface {
    base_color: Rgb::WHITE,
    gains: false,
    metallic: 0.0,
    metal_edge: Rgb::WHITE,
    diffuse_roughness: 0.0,
    roughness: 0.5,
    stretched: None,
    multiscatter: true,
    ior: 1.5,
    specular: 1.0,
    specular_color: Rgb::WHITE,
    specular_level: 1.0,
    transmission: 0.0,
    thin: false,
    translucent: 0.0,
    translucent_color: Rgb::WHITE,
    subsurface: None,
    coat: None,
    sheen: None,
    film: None,
};
const COAT: Coat = Coat { weight: 1.0, roughness: 0.1, ior: 1.5, tint: Rgb::WHITE, frame: None };
const FILM: ThinFilm = ThinFilm { thickness: 400.0, ior: 1.8, weight: 1.0, on_metal: true };
const BARE: ThinFilm = ThinFilm { on_metal: false, ..FILM };
const FACETS: Microfacets = Microfacets { roughness: 0.3, stretched: None, multiscatter: true };
const SMOOTH: Microfacets = Microfacets { roughness: 0.0, ..FACETS };
const MATT: Microfacets = Microfacets { roughness: 1.0, ..FACETS };
/// Turned by 30 degrees.
const TURNED: Frame = Frame { s: Vec3::new(0.866_025_4, 0.5, 0.0), t: Vec3::new(-0.5, 0.866_025_4, 0.0), n: Vec3::Z };
/// Tilted by 20 degrees.
const TILTED: Frame =
    Frame { s: Vec3::new(0.939_692_6, 0.0, -0.342_020_1), t: Vec3::Y, n: Vec3::new(0.342_020_1, 0.0, 0.939_692_6) };
const STRETCHED: Stretched = Stretched { alpha: [0.5, 0.1], frame: TURNED };
const METAL: Surface = Surface { metallic: 1.0, ..WHITE };
const GLASS: Surface = Surface { transmission: 1.0, ..WHITE };
/// What is let in is what the lobe answers for: here all of it.
const WAX: Subsurface = Subsurface {
    weight: 1.0,
    color: Rgb::WHITE,
    radius: Rgb::new(0.1, 0.05, 0.02),
    anisotropy: 0.3,
    ior: 1.4,
    method: Method::Walk,
    shallow: false,
};
const TEAL: Rgb = Rgb::new(0.1, 0.6, 0.5);

struct Case {
    name: &'static str,
    closure: Closure,
    /// True where nothing is absorbed: the white furnace must give 1.
    lossless: bool,
    /// False for a view from within.
    entering: bool,
    /// What its microfacets are widened by.
    widening: Widening,
}

const PLAIN: Widening = Widening { variance: 0.0, least: 0.0 };

/// Blurred as Filter Glossy does it, which loses what scatters more than once between wider facets.
const fn blurred(case: Case) -> Case {
    Case { widening: Widening { least: 0.4, ..PLAIN }, lossless: false, ..case }
}

/// With normals that vary within a pixel.
const fn uneven(case: Case) -> Case {
    Case { widening: Widening { variance: 0.1, ..PLAIN }, ..case }
}

const fn outside(name: &'static str, surface: Surface, lossless: bool) -> Case {
    Case { name, closure: Closure::Layered(surface), lossless, entering: true, widening: PLAIN }
}

const fn inside(name: &'static str, surface: Surface, lossless: bool) -> Case {
    Case { name, closure: Closure::Layered(surface), lossless, entering: false, widening: PLAIN }
}

const fn single_inside(name: &'static str, closure: Closure, lossless: bool) -> Case {
    Case { name, closure, lossless, entering: false, widening: PLAIN }
}

const fn single(name: &'static str, closure: Closure, lossless: bool) -> Case {
    Case { name, closure, lossless, entering: true, widening: PLAIN }
}

const CASES: &[Case] = &[
    outside("Lambert", Surface { ior: 1.0, ..WHITE }, true),
    outside("Lambert, no specular", Surface { specular: 0.0, base_color: TEAL, ..WHITE }, false),
    outside("plastic, smooth", Surface { roughness: 0.0, ..WHITE }, true),
    outside("plastic, polished", Surface { roughness: 0.15, ..WHITE }, true),
    outside("plastic", Surface { base_color: TEAL, ..WHITE }, false),
    outside("plastic, white", WHITE, true),
    outside("plastic, matt", Surface { roughness: 1.0, ..WHITE }, true),
    outside("plastic, gold reflection", Surface { specular_color: Rgb::new(9.0, 4.0, 1.0), ..WHITE }, false),
    outside("plastic, infinite index", Surface { ior: 0.0, ..WHITE }, true),
    outside("plastic, dense", Surface { ior: 2.4, roughness: 0.3, ..WHITE }, true),
    outside("plastic, thinner than its outside", Surface { ior: 0.7, ..WHITE }, true),
    inside("plastic, back", WHITE, true),
    outside("metal, smooth", Surface { roughness: 0.0, base_color: TEAL, ..METAL }, false),
    outside("metal, polished", Surface { roughness: 0.15, base_color: TEAL, ..METAL }, false),
    outside("metal, white", METAL, true),
    outside("metal, white and matt", Surface { roughness: 1.0, ..METAL }, true),
    outside("glass, smooth", Surface { roughness: 0.0, ..GLASS }, true),
    inside("glass, smooth, inside", Surface { roughness: 0.0, ..GLASS }, true),
    outside("glass, frosted lightly", Surface { roughness: 0.15, ..GLASS }, true),
    inside("glass, frosted lightly, inside", Surface { roughness: 0.15, ..GLASS }, true),
    outside("glass, frosted", GLASS, true),
    inside("glass, frosted, inside", GLASS, true),
    outside("glass, matt", Surface { roughness: 1.0, ..GLASS }, true),
    inside("glass, matt, inside", Surface { roughness: 1.0, ..GLASS }, true),
    outside("glass, tinted", Surface { base_color: TEAL, specular_color: Rgb::new(3.0, 1.0, 0.0), ..GLASS }, false),
    inside("glass, no reflection weight, inside", Surface { specular: 0.0, ..GLASS }, true),
    outside("glass, bubble", Surface { ior: 0.7, ..GLASS }, true),
    outside("glass, index matched", Surface { ior: 1.0, ..GLASS }, true),
    outside("sheet, smooth", Surface { roughness: 0.0, thin: true, ..GLASS }, true),
    outside("sheet, frosted", Surface { thin: true, ..GLASS }, true),
    inside("sheet, frosted and tinted", Surface { thin: true, base_color: TEAL, ..GLASS }, false),
    outside("half glass", Surface { transmission: 0.5, ..WHITE }, true),
    outside("all layers", Surface { metallic: 0.3, transmission: 0.5, base_color: TEAL, ..WHITE }, false),
    inside("all layers, inside", Surface { metallic: 0.3, transmission: 0.5, roughness: 0.3, ..WHITE }, true),
    outside("all layers, smooth", Surface { metallic: 0.3, transmission: 0.5, roughness: 0.0, ..WHITE }, true),
    outside("plastic, rough beneath", Surface { diffuse_roughness: 0.7, ..WHITE }, true),
    outside("plastic, reflects more", Surface { specular_level: 2.0, ..WHITE }, true),
    outside("plastic, stretched", Surface { stretched: Some(STRETCHED), ..WHITE }, false),
    outside("plastic, film", Surface { film: Some(FILM), base_color: TEAL, ..WHITE }, false),
    outside("metal, tinted edge", Surface { metal_edge: TEAL, ..METAL }, false),
    outside("metal, stretched", Surface { stretched: Some(STRETCHED), base_color: TEAL, ..METAL }, false),
    outside("metal, film", Surface { film: Some(FILM), base_color: TEAL, ..METAL }, false),
    outside("metal, no film on it", Surface { film: Some(BARE), roughness: 1.0, ..METAL }, true),
    outside("metal, single scattering", Surface { multiscatter: false, roughness: 1.0, ..METAL }, false),
    outside("glass, film", Surface { film: Some(FILM), ..GLASS }, false),
    inside("glass, film, inside", Surface { film: Some(FILM), ..GLASS }, false),
    outside("glass, smooth, film", Surface { film: Some(FILM), roughness: 0.0, ..GLASS }, true),
    outside("paper", Surface { translucent: 0.5, ior: 1.0, ..WHITE }, true),
    outside("coat", Surface { coat: Some(COAT), ..WHITE }, true),
    outside("coat, smooth", Surface { coat: Some(Coat { roughness: 0.0, ..COAT }), ..WHITE }, true),
    outside("coat, tinted", Surface { coat: Some(Coat { tint: TEAL, ..COAT }), ..WHITE }, false),
    outside("coat, half", Surface { coat: Some(Coat { weight: 0.5, ..COAT }), ..WHITE }, true),
    outside("coat, own normal", Surface { coat: Some(Coat { frame: Some(TILTED), ..COAT }), ..METAL }, false),
    outside("sheen", Surface { sheen: Some(Sheen { color: Rgb::WHITE, roughness: 0.5 }), ..WHITE }, true),
    outside("sheen, matt", Surface { sheen: Some(Sheen { color: TEAL, roughness: 1.0 }), ..WHITE }, false),
    single("rough diffuse", Closure::Diffuse { color: Rgb::WHITE, roughness: 1.0, multiscatter: true }, true),
    single("rough diffuse, teal", Closure::Diffuse { color: TEAL, roughness: 0.5, multiscatter: true }, false),
    single("rough diffuse, once", Closure::Diffuse { color: TEAL, roughness: 0.8, multiscatter: false }, false),
    single("translucent", Closure::Translucent { color: Rgb::WHITE }, true),
    single("beneath", Closure::Beneath { subsurface: WAX, alpha: 0.3 }, true),
    single("beneath, smooth", Closure::Beneath { subsurface: WAX, alpha: 0.0 }, true),
    single("beneath, matt", Closure::Beneath { subsurface: WAX, alpha: 1.0 }, true),
    single(
        "beneath, skin",
        Closure::Beneath { subsurface: Subsurface { color: TEAL, method: Method::Skin, ..WAX }, alpha: 0.3 },
        false,
    ),
    single(
        "beneath, free paths",
        Closure::Beneath { subsurface: Subsurface { anisotropy: -0.5, method: Method::FreePath, ..WAX }, alpha: 0.3 },
        true,
    ),
    single(
        "beneath, profile",
        Closure::Beneath { subsurface: Subsurface { method: Method::Profile, shallow: true, ..WAX }, alpha: 0.3 },
        true,
    ),
    single(
        "beneath, in two channels",
        Closure::Beneath { subsurface: Subsurface { radius: Rgb::new(0.1, 0.0, 0.02), ..WAX }, alpha: 0.3 },
        true,
    ),
    outside("wax", Surface { subsurface: Some(WAX), ..WHITE }, true),
    outside("wax, half", Surface { subsurface: Some(Subsurface { weight: 0.5, ..WAX }), ..WHITE }, true),
    outside("wax, coated", Surface { subsurface: Some(WAX), coat: Some(COAT), ..WHITE }, true),
    inside("wax, back", Surface { subsurface: Some(WAX), base_color: TEAL, roughness: 0.0, ..WHITE }, false),
    single("glossy", Closure::Glossy { color: Rgb::WHITE, facets: FACETS }, true),
    single("glossy, smooth", Closure::Glossy { color: TEAL, facets: Microfacets { roughness: 0.0, ..FACETS } }, false),
    single(
        "glossy, stretched",
        Closure::Glossy { color: Rgb::WHITE, facets: Microfacets { stretched: Some(STRETCHED), ..FACETS } },
        false,
    ),
    single("gold", Closure::Conductor { index: GOLD, facets: FACETS, film: None }, false),
    single("gold, film", Closure::Conductor { index: GOLD, facets: FACETS, film: Some(FILM) }, false),
    single("metal of two values", Closure::Metal { base: TEAL, edge: TEAL, facets: FACETS, film: None }, false),
    single("glass node", Closure::Glass { color: Rgb::WHITE, ior: 1.5, facets: FACETS, film: None }, true),
    single("refraction", Closure::Refraction { color: Rgb::WHITE, ior: 1.5, facets: FACETS }, false),
    single(
        "metal of two values, film",
        Closure::Metal { base: TEAL, edge: TEAL, facets: FACETS, film: Some(FILM) },
        false,
    ),
    single(
        "metal of two values, matt",
        Closure::Metal { base: Rgb::WHITE, edge: Rgb::WHITE, facets: MATT, film: None },
        true,
    ),
    single("gold, smooth", Closure::Conductor { index: GOLD, facets: SMOOTH, film: None }, false),
    single("gold, matt", Closure::Conductor { index: GOLD, facets: MATT, film: None }, false),
    single(
        "gold, stretched",
        Closure::Conductor { index: GOLD, facets: Microfacets { stretched: Some(STRETCHED), ..FACETS }, film: None },
        false,
    ),
    single("glass node, smooth", Closure::Glass { color: Rgb::WHITE, ior: 1.5, facets: SMOOTH, film: None }, true),
    single("glass node, matt", Closure::Glass { color: Rgb::WHITE, ior: 1.5, facets: MATT, film: None }, true),
    single("glass node, film", Closure::Glass { color: Rgb::WHITE, ior: 1.5, facets: FACETS, film: Some(FILM) }, false),
    single_inside(
        "glass node, inside",
        Closure::Glass { color: Rgb::WHITE, ior: 1.5, facets: FACETS, film: None },
        true,
    ),
    single_inside(
        "glass node, smooth, inside",
        Closure::Glass { color: Rgb::WHITE, ior: 1.5, facets: SMOOTH, film: None },
        true,
    ),
    single_inside(
        "glass node, matt, inside",
        Closure::Glass { color: Rgb::WHITE, ior: 1.5, facets: MATT, film: None },
        true,
    ),
    single_inside(
        "glass node, film, inside",
        Closure::Glass { color: Rgb::WHITE, ior: 1.5, facets: FACETS, film: Some(FILM) },
        false,
    ),
    single("refraction, smooth", Closure::Refraction { color: Rgb::WHITE, ior: 1.5, facets: SMOOTH }, false),
    single("refraction, matt", Closure::Refraction { color: Rgb::WHITE, ior: 1.5, facets: MATT }, false),
    single_inside("refraction, inside", Closure::Refraction { color: TEAL, ior: 1.5, facets: FACETS }, false),
    single_inside("refraction, smooth, inside", Closure::Refraction { color: TEAL, ior: 1.5, facets: SMOOTH }, false),
    single_inside("refraction, matt, inside", Closure::Refraction { color: TEAL, ior: 1.5, facets: MATT }, false),
    single_inside(
        "metal, film, back",
        Closure::Metal { base: TEAL, edge: TEAL, facets: FACETS, film: Some(FILM) },
        false,
    ),
    single_inside("gold, back", Closure::Conductor { index: GOLD, facets: FACETS, film: None }, false),
    single("glossy, matt", Closure::Glossy { color: Rgb::WHITE, facets: MATT }, true),
    single("sheen node, matt", Closure::Sheen(Sheen { color: Rgb::WHITE, roughness: 1.0 }), false),
    single("sheen node, smooth", Closure::Sheen(Sheen { color: Rgb::WHITE, roughness: 0.0 }), false),
    single("sheen node", Closure::Sheen(Sheen { color: Rgb::WHITE, roughness: 0.3 }), false),
    single("toon", Closure::Toon { color: Rgb::WHITE, size: [0.5, 0.2], glossy: false }, false),
    blurred(outside("plastic, smooth, blurred", Surface { roughness: 0.0, ..WHITE }, true)),
    blurred(outside("metal, polished, blurred", Surface { roughness: 0.15, base_color: TEAL, ..METAL }, false)),
    blurred(outside("metal, matt, blurred", Surface { roughness: 1.0, ..METAL }, true)),
    blurred(outside("metal, stretched, blurred", Surface { stretched: Some(STRETCHED), ..METAL }, false)),
    blurred(outside("glass, smooth, blurred", Surface { roughness: 0.0, ..GLASS }, true)),
    blurred(inside("glass, smooth, inside, blurred", Surface { roughness: 0.0, ..GLASS }, true)),
    blurred(outside("sheet, smooth, blurred", Surface { roughness: 0.0, thin: true, ..GLASS }, true)),
    blurred(outside("glass, index matched, blurred", Surface { ior: 1.0, roughness: 0.0, ..GLASS }, true)),
    blurred(outside("coat, blurred", Surface { coat: Some(COAT), ..WHITE }, true)),
    uneven(outside("plastic, smooth, uneven", Surface { roughness: 0.0, ..WHITE }, true)),
    uneven(outside("metal, polished, uneven", Surface { roughness: 0.15, ..METAL }, true)),
    uneven(outside("metal, stretched, uneven", Surface { stretched: Some(STRETCHED), ..METAL }, false)),
    uneven(outside("glass, smooth, uneven", Surface { roughness: 0.0, ..GLASS }, true)),
    uneven(outside("coat, smooth, uneven", Surface { coat: Some(Coat { roughness: 0.0, ..COAT }), ..WHITE }, true)),
    single("toon, glossy", Closure::Toon { color: Rgb::WHITE, size: [0.2, 0.0], glossy: true }, false),
];

const GOLD: Conductor = Conductor { eta: Rgb::new(0.183, 0.422, 1.373), k: Rgb::new(3.424, 2.346, 1.770) };

impl Case {
    fn bsdf(&self, wo: Vec3) -> Bsdf {
        seen(&self.closure, wo, self.entering, self.widening)
    }

    fn is_stretched(&self) -> bool {
        match &self.closure {
            Closure::Layered(surface) => surface.stretched.is_some(),
            Closure::Glossy { facets, .. } | Closure::Metal { facets, .. } | Closure::Conductor { facets, .. } => {
                facets.stretched.is_some()
            }
            _ => false,
        }
    }

    /// True where light meets a film.
    fn has_film(&self) -> bool {
        match &self.closure {
            Closure::Layered(surface) => surface.film.is_some_and(|film| film.on_metal || surface.metallic < 1.0),
            Closure::Metal { film, .. } | Closure::Conductor { film, .. } | Closure::Glass { film, .. } => {
                film.is_some()
            }
            _ => false,
        }
    }

    /// True where there are no tables for its albedo, only estimates.
    fn is_estimated(&self) -> bool {
        // What blurring loses is in no table, as in Cycles.
        if self.widening.least > 0.0 {
            return true;
        }
        match &self.closure {
            Closure::Conductor { .. } | Closure::Toon { .. } => true,
            _ => self.has_film() || self.is_stretched(),
        }
    }

    fn layered(&self) -> Option<Surface> {
        match self.closure {
            Closure::Layered(surface) => Some(surface),
            _ => None,
        }
    }

    /// True where light comes from the denser side of glass.
    fn has_critical_angle(&self) -> bool {
        match &self.closure {
            Closure::Layered(s) => s.transmission > 0.0 && (!self.entering || s.ior < 1.0),
            Closure::Glass { ior, .. } | Closure::Refraction { ior, .. } => !self.entering || *ior < 1.0,
            _ => false,
        }
    }
}

/// `closure` alone, seen from `wo`.
fn seen(closure: &Closure, wo: Vec3, entering: bool, widening: Widening) -> Bsdf {
    let mut bsdf = Bsdf::none();
    let mut builder = Builder::new(&mut bsdf, wo, if wo.z < 0.0 { -Vec3::Z } else { Vec3::Z }, entering);
    builder.set_widening(widening);
    builder.add(Rgb::WHITE, closure);
    builder.finish();
    bsdf
}

/// A view at an angle to the normal, on either side of it.
fn view(degrees: f32, azimuth: f32, above: bool) -> Vec3 {
    let (sin, cos) = degrees.to_radians().sin_cos();
    Vec3::new(sin * azimuth.cos(), sin * azimuth.sin(), if above { cos } else { -cos })
}

fn samples(bsdf: &Bsdf, pattern: Pattern, n: u64) -> impl Iterator<Item = Option<BsdfSample>> {
    let sampler = Sampler::new(pattern, 11);
    (0..n).map(move |i| {
        let s = sampler.for_sample(0, 0, i);
        bsdf.sample(s.get_1d(Dimension::FREE), s.get_2d(Dimension::LENS))
    })
}

/// What a white surrounding sees: the mean of `n` weights, per class.
fn furnace(bsdf: &Bsdf, n: u64) -> [Rgb; 3] {
    let mut sums = [[0.0_f64; 3]; 3];
    for s in samples(bsdf, Pattern::Sobol, n).flatten() {
        for (sum, part) in sums.iter_mut().zip([s.weight.diffuse, s.weight.glossy, s.weight.transmission]) {
            for (sum, channel) in sum.iter_mut().zip(part.to_array()) {
                *sum += f64::from(channel);
            }
        }
    }
    sums.map(|sum| Rgb::from(sum.map(|channel| channel / n as f64)))
}

fn total(parts: [Rgb; 3]) -> Rgb {
    parts.into_iter().sum()
}

#[test]
fn samples_agree_with_eval() {
    for case in CASES {
        for (degrees, above) in [(0.0, true), (30.0, true), (70.0, false), (89.0, true)] {
            let wo = view(degrees, 0.7, above);
            let bsdf = case.bsdf(wo);
            for s in samples(&bsdf, Pattern::Independent, 2000).flatten() {
                let name = case.name;
                assert!((s.wi.length() - 1.0).abs() < 1e-5 && s.pdf > 0.0, "{name}: {s:?}");
                assert!(
                    s.lobe == Lobe::Diffuse || (s.lobe == Lobe::Transmission) == (s.wi.z * wo.z < 0.0),
                    "{name}: {s:?}"
                );
                let eval = bsdf.eval(s.wi);
                if s.delta {
                    assert!(s.pdf <= 1.0 + 1e-6);
                } else {
                    assert!((eval.pdf / s.pdf - 1.0).abs() < 1e-3, "{name} {wo}: {s:?} {eval:?}");
                    for (w, f) in [
                        (s.weight.diffuse, eval.f_cos.diffuse),
                        (s.weight.glossy, eval.f_cos.glossy),
                        (s.weight.transmission, eval.f_cos.transmission),
                    ] {
                        let d = w * s.pdf - f;
                        assert!(d.to_array().iter().all(|d| d.abs() < 1e-3 * s.pdf), "{name}: {s:?} {eval:?}");
                    }
                }
                if bsdf.is_delta_only() {
                    assert!(s.delta && eval.pdf == 0.0 && eval.f_cos.sum().is_black());
                }
                let (ior, thin) = match case.closure {
                    Closure::Layered(surface) => (surface.ior, surface.thin),
                    Closure::Glass { ior, .. } | Closure::Refraction { ior, .. } => (ior, false),
                    _ => continue,
                };
                let crosses = s.lobe == Lobe::Transmission && !thin && ior != 1.0;
                let eta = if case.entering { ior } else { 1.0 / ior };
                assert_eq!(s.eta, if crosses { eta } else { 1.0 }, "{name}");
            }
        }
    }
}

/// Counts of sampled directions against the density, and those of deltas and failures together against what
/// the density leaves; that each delta has its probability is held by the furnace per class.
#[test]
fn directions_follow_the_density() {
    let views = [(5.0, true), (60.0, true), (80.0, false)];
    let grid = chi2::Grid { nx: 26, ny: 18 };
    let n = 40_000;
    let direction = |x: f64, y: f64| {
        let z = 2.0 * x - 1.0;
        let (sin, cos) = (TAU * y).sin_cos();
        let r = (1.0 - z * z).sqrt();
        Vec3::new((r * cos) as f32, (r * sin) as f32, z as f32)
    };
    for case in CASES {
        for (degrees, above) in views {
            let wo = view(degrees, 0.7, above);
            let bsdf = case.bsdf(wo);
            let density = |x, y| f64::from(bsdf.eval(direction(x, y)).pdf) * 4.0 * PI;
            let mass = grid.integrals(&density, 2e-6);
            let scattered: f64 = mass.iter().sum();
            assert!(scattered < 1.0 + 2e-3, "{} {degrees}: density integrates to {scattered}", case.name);

            let mut observed = vec![0.0; mass.len()];
            // Directions that the density doesn't know: deltas and failures.
            let mut others = 0.0;
            for s in samples(&bsdf, Pattern::Independent, n) {
                match s {
                    Some(s) if s.delta => others += 1.0,
                    Some(s) => {
                        let azimuth = f64::from(s.wi.y).atan2(f64::from(s.wi.x)).rem_euclid(TAU) / TAU;
                        observed[grid.cell([0.5 + 0.5 * f64::from(s.wi.z), azimuth])] += 1.0;
                    }
                    None => others += 1.0,
                }
            }
            let mut expected: Vec<f64> = mass.iter().map(|m| m * n as f64).collect();
            observed.push(others);
            expected.push((1.0 - scattered).max(0.0) * n as f64);
            chi2::check(&observed, &expected, CASES.len() * views.len())
                .unwrap_or_else(|e| panic!("{} {degrees}: {e}; density {scattered}, others {others}", case.name));
        }
    }
}

/// Ways beneath: the density of the microfacets through which they go, that of the refraction lobe, or half of it and
/// half the cosine's; and what each of them leads to.
#[test]
fn ways_beneath_follow_the_microfacets() {
    let grid = chi2::Grid { nx: 26, ny: 18 };
    let n = 40_000;
    let cases = [(Method::Walk, 0.3_f32), (Method::Walk, 1.0), (Method::FreePath, 0.1), (Method::Skin, 0.3)];
    for (method, alpha) in cases {
        let subsurface = Subsurface { method, ..WAX };
        for (degrees, above) in [(5.0, true), (60.0, true), (80.0, false)] {
            let wo = view(degrees, 0.7, above);
            let skin = method == Method::Skin;
            let facets =
                Microfacets { roughness: if skin { 1.0 } else { alpha.sqrt() }, stretched: None, multiscatter: false };
            let refraction =
                seen(&Closure::Refraction { color: Rgb::WHITE, ior: subsurface.ior, facets }, wo, true, PLAIN);
            let bsdf = seen(&Closure::Beneath { subsurface, alpha }, wo, true, PLAIN);
            let density = |x: f64, y: f64| {
                let z = 2.0 * x - 1.0;
                let (sin, cos) = (TAU * y).sin_cos();
                let r = (1.0 - z * z).sqrt();
                let refracted = refraction.eval(Vec3::new((r * cos) as f32, (r * sin) as f32, z as f32)).pdf;
                let into = if above { -z } else { z };
                let diffuse = into.max(0.0) / PI;
                4.0 * PI * if skin { 0.5 * (f64::from(refracted) + diffuse) } else { f64::from(refracted) }
            };
            let mass = grid.integrals(&density, 2e-6);
            let mut observed = vec![0.0; mass.len()];
            let mut lost = 0.0;
            for s in samples(&bsdf, Pattern::Independent, n) {
                let Some(s) = s else {
                    lost += 1.0;
                    continue;
                };
                assert!(s.delta && s.lobe == Lobe::Diffuse && s.wi.z * wo.z < 0.0, "{method:?} {alpha}: {s:?}");
                assert!((s.weight.sum().g - 1.0).abs() < 1e-6 && s.eta == 1.0, "{method:?} {alpha}: {s:?}");
                let beneath = s.beneath.and_then(|index| bsdf.beneath(index));
                assert!(matches!(beneath.unwrap().inside, Inside::Medium(_)));
                let azimuth = f64::from(s.wi.y).atan2(f64::from(s.wi.x)).rem_euclid(TAU) / TAU;
                observed[grid.cell([0.5 + 0.5 * f64::from(s.wi.z), azimuth])] += 1.0;
            }
            let mut expected: Vec<f64> = mass.iter().map(|m| m * n as f64).collect();
            observed.push(lost);
            expected.push((1.0 - mass.iter().sum::<f64>()).max(0.0) * n as f64);
            chi2::check(&observed, &expected, 3 * cases.len())
                .unwrap_or_else(|e| panic!("{method:?}, {alpha}, {degrees}: {e}"));
        }
    }
}

#[test]
fn energy_is_kept_and_never_made() {
    for case in CASES {
        // Once more with a lobe so narrow that the tables change fastest.
        let narrow = case.layered().map(|surface| Closure::Layered(Surface { roughness: 0.03, ..surface }));
        for closure in [Some(case.closure), narrow].into_iter().flatten() {
            for degrees in [0.0, 20.0, 45.0, 60.0, 70.0, 80.0, 85.0, 88.0, 89.5] {
                for above in [true, false] {
                    check_energy(
                        case,
                        &seen(&closure, view(degrees, 0.3, above), case.entering, case.widening),
                        degrees,
                    );
                }
            }
        }
    }
}

fn check_energy(case: &Case, bsdf: &Bsdf, degrees: f32) {
    // The tables are less exact where the view grazes, and where there is a critical angle.
    let tolerance = match degrees {
        // Round microfacets stand for stretched ones.
        _ if case.is_stretched() => 3.5e-2,
        86.0.. => 2e-2,
        _ if case.has_critical_angle() && case.is_estimated() => 1.5e-2,
        _ if case.has_critical_angle() => 1e-2,
        _ => 5e-3,
    };
    for c in total(furnace(bsdf, 1 << 15)).to_array() {
        // The tables are made so that nothing is gained; what is left is the noise of the furnace. Films have none, and
        // for stretched microfacets stand round ones.
        let most = if case.has_film() {
            1.015
        } else if case.is_stretched() {
            1.035
        } else {
            1.003
        };
        assert!(c <= most, "{} {degrees}: {c}", case.name);
        assert!(!case.lossless || c >= 1.0 - tolerance, "{} {degrees}: {c}", case.name);
    }
}

/// There are no tables for films: on metal they gain nothing, on rough glass at most what the few microfacets that stand
/// for all are off.
#[test]
fn films_gain_next_to_nothing() {
    let films = [1.2, 2.4].into_iter().flat_map(|ior| [150.0, 300.0, 1000.0].map(|thickness| (ior, thickness)));
    for (ior, thickness) in films {
        for (roughness, degrees) in [0.25, 0.5, 1.0].into_iter().flat_map(|r| [0.0, 70.0, 88.0].map(|d| (r, d))) {
            let film = Some(ThinFilm { thickness, ior, weight: 1.0, on_metal: true });
            for (base, most) in [(METAL, 1.002), (GLASS, 1.015)] {
                for entering in [true, false] {
                    let surface = Surface { film, roughness, ..base };
                    let bsdf = Bsdf::new(&surface, view(degrees, 0.0, true), entering);
                    let seen = total(furnace(&bsdf, 1 << 14)).max_component();
                    println!("{ior} {thickness} {roughness} {degrees} {entering}: {seen:.4}");
                    assert!(seen < most, "{ior} {thickness} {roughness} {degrees} {entering}: {seen}");
                }
            }
        }
    }
}

/// The albedos by which lobes are chosen: what each class contributes in a white surrounding.
#[test]
fn albedo_is_the_furnace_per_class() {
    for case in CASES {
        for degrees in [0.0, 45.0, 60.0, 75.0, 85.0] {
            let bsdf = case.bsdf(view(degrees, 0.3, true));
            let albedo = bsdf.albedo();
            let parts = furnace(&bsdf, 1 << 14);
            // A critical angle is a step that the tables smear between reflection and passage.
            for (seen, told) in parts.into_iter().zip([albedo.diffuse, albedo.glossy, albedo.transmission]) {
                let d = seen - told;
                let tolerance = if case.has_critical_angle() { 0.3 } else { 0.012 };
                assert!(seen.is_black() || told.max_component() > 0.0, "{} {degrees}", case.name);
                if case.is_estimated() {
                    continue;
                }
                assert!(d.to_array().iter().all(|d| d.abs() < tolerance), "{} {degrees}: {seen:?} {told:?}", case.name);
            }
            let d = total(parts) - albedo.sum();
            assert!(
                case.is_estimated() || d.to_array().iter().all(|d| d.abs() < 0.02),
                "{} {degrees}: {parts:?} {albedo:?}",
                case.name
            );
        }
    }
}

/// A white surface below a coat: all that the coat lets down comes back, whatever its microfacets lose among themselves.
#[test]
fn white_coats_keep_all_light_and_no_more() {
    for ior in [1.2, 1.5, 2.0] {
        for (roughness, specular) in [(0.03, 0.0), (0.25, 0.0), (0.5, 0.0), (0.5, 1.0), (0.75, 1.0), (1.0, 1.0)] {
            for degrees in [0.0, 45.0, 60.0, 75.0, 85.0] {
                let coat = Coat { weight: 1.0, roughness, ior, tint: Rgb::WHITE, frame: None };
                let surface = Surface { coat: Some(coat), specular, ..WHITE };
                let bsdf = Bsdf::new(&surface, view(degrees, 0.0, true), true);
                let seen = total(furnace(&bsdf, 1 << 17)).g;
                let case = format!("IOR {ior}, roughness {roughness}, specular {specular}, {degrees} degrees");
                println!("{case}: {:+.5}", seen - 1.0);
                assert!(seen > 1.0 - 2.5e-3 && seen < 1.0 + 5e-4, "{case}: {seen}");
            }
        }
    }
}

/// Cycles 5.0.1, white furnace over an infinite plane, MULTI_GGX, measured at 1024 samples; where docs/validation/materials.md
/// has them, of tilted squares at 512. Means of the channels.
#[test]
fn furnace_of_cycles() {
    let gray = |v| Rgb::splat(v);
    let lacquer = Coat { roughness: 0.03, ..COAT };
    let black = Surface { base_color: Rgb::BLACK, specular_level: 0.0, ..WHITE };
    let oil = ThinFilm { thickness: 300.0, ior: 1.33, ..FILM };
    // Anisotropic of Blender's Principled node, by a tangent towards which the view is tilted, and one across.
    let along = Frame { s: Vec3::X, t: Vec3::Y, n: Vec3::Z };
    let across = Frame { s: Vec3::Y, t: -Vec3::X, n: Vec3::Z };
    let stretched = |anisotropic: f32, frame| {
        let aspect = (1.0 - 0.9 * anisotropic).sqrt();
        Surface { stretched: Some(Stretched { alpha: [0.25 / aspect, 0.25 * aspect], frame }), ..METAL }
    };
    let table: &[(&str, Surface, [f32; 5])] = &[
        ("metal 1, r .5", METAL, [1.0005, 1.0004, 1.0, 0.9999, 0.9994]),
        ("metal 1, r 1", Surface { roughness: 1.0, ..METAL }, [1.0001, 1.0001, 0.9998, 0.9999, 0.9985]),
        ("metal .5, r .5", Surface { base_color: gray(0.5), ..METAL }, [0.4788, 0.4735, 0.4759, 0.5019, 0.5514]),
        (
            "metal .5, r 1",
            Surface { base_color: gray(0.5), roughness: 1.0, ..METAL },
            [0.2611, 0.2858, 0.3126, 0.3651, 0.4379],
        ),
        (
            "dielectric 0, r 0",
            Surface { base_color: gray(0.0), roughness: 0.0, ..WHITE },
            [0.0400, 0.0502, 0.0892, 0.2531, 0.6128],
        ),
        ("dielectric 0, r .5", Surface { base_color: gray(0.0), ..WHITE }, [0.0373, 0.0467, 0.0678, 0.1181, 0.1791]),
        ("dielectric 1, r .5", WHITE, [0.9999, 0.9994, 0.9986, 0.9946, 0.9900]),
        ("glass 1, r 1", Surface { roughness: 1.0, ..GLASS }, [1.0002, 1.0004, 1.0001, 0.9996, 0.9926]),
        (
            "glass .25, r 0",
            Surface { base_color: gray(0.25), roughness: 0.0, ..GLASS },
            [0.5200, 0.5251, 0.5446, 0.6265, 0.8064],
        ),
        (
            "rough diffuse .8, r .5",
            Surface { base_color: gray(0.8), diffuse_roughness: 0.5, specular_level: 0.0, ..WHITE },
            [0.7625, 0.7692, 0.7774, 0.7884, 0.7962],
        ),
        (
            "rough diffuse .4, r 1",
            Surface { base_color: gray(0.4), diffuse_roughness: 1.0, specular_level: 0.0, ..WHITE },
            [0.3234, 0.3371, 0.3538, 0.3763, 0.3923],
        ),
        (
            "metal .5, r 0, edge .5",
            Surface { metal_edge: gray(0.5), base_color: gray(0.5), roughness: 0.0, ..METAL },
            [0.5000, 0.4982, 0.4652, 0.3349, 0.4914],
        ),
        ("coat on black", Surface { coat: Some(lacquer), ..black }, [0.0400, 0.0502, 0.0892, 0.2530, 0.6126]),
        (
            "coat of tint .5",
            Surface { coat: Some(Coat { tint: gray(0.5), ..lacquer }), base_color: Rgb::WHITE, ..black },
            [0.5200, 0.4829, 0.4786, 0.5549, 0.7635],
        ),
        (
            "coat of IOR 2, half",
            Surface { coat: Some(Coat { weight: 0.5, ior: 2.0, ..lacquer }), ..WHITE },
            [1.0004, 0.9989, 0.9977, 0.9965, 0.9914],
        ),
        (
            "sheen, r .5",
            Surface { sheen: Some(Sheen { color: Rgb::WHITE, roughness: 0.5 }), ..black },
            [0.0186, 0.0672, 0.1539, 0.3577, 0.5698],
        ),
        (
            "sheen, r 1",
            Surface { sheen: Some(Sheen { color: Rgb::WHITE, roughness: 1.0 }), ..black },
            [0.3419, 0.4209, 0.4988, 0.6151, 0.7047],
        ),
        (
            "film on a dielectric",
            Surface { film: Some(oil), roughness: 0.0, base_color: Rgb::BLACK, ..WHITE },
            [0.0185, 0.0312, 0.0732, 0.2395, 0.6041],
        ),
        (
            "film on metal",
            Surface { film: Some(ThinFilm { ior: 1.6, ..oil }), roughness: 0.2, base_color: gray(0.7), ..METAL },
            [0.6002, 0.5553, 0.5510, 0.6320, 0.7552],
        ),
        ("stretched .5, along", stretched(0.5, along), [0.9808, 0.9744, 0.9829, 1.0137, 1.0208]),
        ("stretched .5, across", stretched(0.5, across), [0.9807, 0.9909, 0.9943, 0.9725, 0.9566]),
        ("stretched .9, along", stretched(0.9, along), [0.8424, 0.8665, 0.9145, 0.9973, 1.0179]),
        ("stretched .9, across", stretched(0.9, across), [0.8427, 0.8659, 0.8836, 0.8670, 0.8167]),
    ];
    let glass = |roughness, ior, color| {
        let facets = Microfacets { roughness, ..FACETS };
        Closure::Glass { color: gray(color), ior, facets, film: None }
    };
    let singles = [
        ("glass, IOR 1.1", glass(0.3, 1.1, 1.0), [1.0000, 1.0003, 0.9999, 1.0004, 0.9969]),
        ("glass, IOR 2.4", glass(0.3, 2.4, 1.0), [1.0001, 1.0004, 1.0004, 1.0008, 0.9935]),
        ("glass .25, r .5", glass(0.5, 1.5, 0.25), [0.2483, 0.2462, 0.2423, 0.2354, 0.2345]),
        ("glass .25, r 1", glass(1.0, 1.5, 0.25), [0.2289, 0.2108, 0.1988, 0.1910, 0.2004]),
        ("glass .25, r .25, IOR .67", glass(0.25, 1.0 / 1.5, 0.25), [0.2492, 0.2476, 0.2474, 0.2424, 0.2266]),
        (
            "gold, r .3",
            Closure::Conductor { index: GOLD, facets: FACETS, film: None },
            [0.6970, 0.6986, 0.7068, 0.7398, 0.7816],
        ),
    ];
    let layers = table.iter().map(|(name, surface, expected)| (*name, Closure::Layered(*surface), *expected));
    for (name, closure, expected) in layers.chain(singles.iter().copied()) {
        for (degrees, expected) in [0.0, 45.0, 60.0, 75.0, 85.0].into_iter().zip(expected) {
            let seen = total(furnace(&seen(&closure, view(degrees, 0.0, true), true, PLAIN), 1 << 17)).mean();
            println!("{name:22} {degrees:4} {seen:.4} {expected:.4}");
            // Cycles itself strays from 1 by as much at 85 degrees, where white plastic is exact here.
            assert!((seen / expected - 1.0).abs() < 0.0105, "{name}, {degrees}: {seen} {expected}");
        }
    }
}

/// The color passes of Cycles 5.0.1 for base color (.8, .4, .2) at 0, 60 and 80 degrees; those of rough
/// glass are coarse estimates there (they sum to 0.72 of the furnace's 0.90 at 80 degrees), so only at 0.
#[test]
fn color_passes_of_cycles() {
    type Passes = [[f32; 3]; 3];
    const NONE: [f32; 3] = [0.0; 3];
    let base = Surface { base_color: Rgb::new(0.8, 0.4, 0.2), ..WHITE };
    let glass = Surface { transmission: 1.0, ..base };
    let metal = Surface { metallic: 1.0, ..base };
    let table: &[(&str, Surface, f32, Passes)] = &[
        ("metal", metal, 0.0, [NONE, [0.7857, 0.3796, 0.1868], NONE]),
        ("metal", metal, 60.0, [NONE, [0.7819, 0.3825, 0.1994], NONE]),
        ("metal", metal, 80.0, [NONE, [0.8031, 0.4427, 0.2776], NONE]),
        ("metal, matt", Surface { roughness: 1.0, ..metal }, 60.0, [NONE, [0.6409, 0.2347, 0.1059], NONE]),
        ("metal, smooth", Surface { roughness: 0.0, ..metal }, 80.0, [NONE, [0.8783, 0.6348, 0.5130], NONE]),
        ("plastic", base, 0.0, [[0.7701, 0.3850, 0.1925], [0.0374; 3], NONE]),
        ("plastic", base, 60.0, [[0.7446, 0.3723, 0.1862], [0.0692; 3], NONE]),
        ("plastic", base, 80.0, [[0.6773, 0.3387, 0.1693], [0.1534; 3], NONE]),
        ("plastic, smooth", Surface { roughness: 0.0, ..base }, 80.0, [[0.4863, 0.2431, 0.1216], [0.3922; 3], NONE]),
        ("glass", glass, 0.0, [NONE, [0.0405, 0.0404, 0.0404], [0.8579, 0.6053, 0.4273]]),
        ("glass, smooth", Surface { roughness: 0.0, ..glass }, 60.0, [NONE, [0.0898; 3], [0.8147, 0.5760, 0.4073]]),
        (
            "all layers",
            Surface { metallic: 0.3, transmission: 0.5, ..base },
            0.0,
            [[0.2695, 0.1348, 0.0674], [0.2630, 0.1411, 0.0832], [0.3003, 0.2118, 0.1496]],
        ),
    ];
    for (name, surface, degrees, [diffuse, glossy, transmission]) in table {
        let albedo = Bsdf::new(surface, view(*degrees, 0.0, true), true).color();
        for (ours, theirs) in [(albedo.diffuse, diffuse), (albedo.glossy, glossy), (albedo.transmission, transmission)]
        {
            println!("{name:15} {degrees:4} {ours:.4?} {theirs:.4?}");
            for (a, b) in ours.to_array().into_iter().zip(theirs) {
                let tolerance = if *degrees > 70.0 { 0.012 } else { 0.006 };
                assert!((a - b).abs() < tolerance, "{name}, {degrees}: {ours:?} {theirs:?}");
            }
        }
    }
}

/// Normals that would mirror the view into the surface lean until they do not, whatever kind of interface they are of.
#[test]
fn bent_interfaces_mirror_what_is_above() {
    let smooth = Microfacets { roughness: 0.0, ..FACETS };
    let mirrors = [
        Closure::Layered(Surface { roughness: 0.0, ..METAL }),
        Closure::Glossy { color: Rgb::WHITE, facets: smooth },
        Closure::Layered(Surface { coat: Some(Coat { roughness: 0.0, ..COAT }), base_color: Rgb::BLACK, ..METAL }),
        Closure::Glass { color: Rgb::WHITE, ior: 1.5, facets: smooth, film: None },
    ];
    for closure in mirrors {
        for tilt in [5.0_f32, 20.0, 40.0, 60.0] {
            for degrees in [0.0, 30.0, 60.0, 85.0] {
                let (ng, wo) = (view(tilt, 0.0, true), view(degrees, 0.4, true));
                if wo.dot(ng) <= 0.01 {
                    continue;
                }
                let mut bsdf = Bsdf::none();
                let mut builder = Builder::new(&mut bsdf, wo, ng, true);
                builder.set_upright();
                builder.add(Rgb::WHITE, &closure);
                builder.finish();
                // The reflection is what is drawn last or first of what there is.
                let drawn = [0.0, 1.0 - 1e-6].map(|uc| bsdf.sample(uc, [0.5; 2]));
                let up = drawn.into_iter().flatten().find(|s| s.wi.dot(ng) > 0.0 && s.wi.dot(wo) > -0.999);
                let up = up.unwrap_or_else(|| panic!("{closure:?} {tilt} {degrees}: {drawn:?}"));
                assert!(up.weight.is_finite() && !up.weight.sum().is_black(), "{closure:?} {tilt} {degrees}: {up:?}");
                if matches!(closure, Closure::Glossy { .. }) {
                    assert!((up.weight.sum().g - 1.0).abs() < 1e-4, "{tilt} {degrees}: {up:?}");
                }
            }
        }
    }
}

/// Of the lobes that keep reciprocity: those that are not scaled by what a view loses.
#[test]
fn reciprocity_where_it_holds() {
    let once = |facets: Microfacets| Microfacets { multiscatter: false, ..facets };
    let stretched = Microfacets { stretched: Some(STRETCHED), ..FACETS };
    let mut list = vec![
        Closure::Diffuse { color: TEAL, roughness: 0.0, multiscatter: true },
        Closure::Diffuse { color: TEAL, roughness: 0.8, multiscatter: false },
        Closure::Diffuse { color: TEAL, roughness: 0.8, multiscatter: true },
        Closure::Translucent { color: TEAL },
    ];
    for facets in [FACETS, stretched].map(once) {
        list.push(Closure::Glossy { color: TEAL, facets });
        list.push(Closure::Metal { base: TEAL, edge: TEAL, facets, film: Some(FILM) });
        list.push(Closure::Conductor { index: GOLD, facets, film: None });
    }
    for closure in list {
        let f = |wo, wi: Vec3| seen(&closure, wo, true, PLAIN).eval(wi).f_cos.sum() * (1.0 / wi.z.abs());
        for (i, degrees) in [5.0, 20.0, 40.0, 60.0, 75.0, 85.0].into_iter().enumerate() {
            for azimuth in [0.1, 1.0, 2.0, 3.0, 4.5] {
                let below = matches!(closure, Closure::Translucent { .. });
                let (a, b) = (view(degrees, 0.3, true), view(80.0 - 10.0 * i as f32, 0.3 + azimuth, !below));
                let (there, back) = (f(a, b), f(b, a));
                let d = (there - back).to_array();
                let most = there.max_component().max(1e-6);
                assert!(d.iter().all(|d| d.abs() < 1e-3 * most), "{closure:?} {a} {b}: {there:?} {back:?}");
            }
        }
    }
    let lambert = Closure::Diffuse { color: Rgb::WHITE, roughness: 0.0, multiscatter: true };
    let f = seen(&lambert, view(20.0, 0.1, true), true, PLAIN).eval(Vec3::Z).f_cos.sum().g;
    assert!((f - 1.0 / std::f32::consts::PI).abs() < 1e-6);
}

/// Nothing but finite answers, whatever the parameters and however grazing the directions.
#[test]
fn extremes_stay_finite() {
    let last = 1.0 - 2.0_f32.powi(-24);
    let us = [[0.0, 0.0], [last, last], [0.0, last], [last, 0.0], [0.5, 0.5], [0.3, 0.9]];
    let directions: Vec<Vec3> = [0.0, 1e-30, 1e-7, 1e-3, 0.5, 1.0]
        .into_iter()
        .flat_map(|z: f32| [z, -z])
        .map(|z| Vec3::new(0.6 * (1.0 - z * z).sqrt(), 0.8 * (1.0 - z * z).sqrt(), z))
        .collect();
    for roughness in [0.0, 1e-7, 0.00999, 0.0101, 0.05, 1.0, f32::NAN, 7.0] {
        for ior in [0.0, 0.5, 1.0 - 1e-6, 1.0, 1.0 + 1e-6, 1.001, 1.5, 3.0, 1e9, f32::INFINITY, f32::NAN] {
            for (metallic, transmission) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (0.3, 0.5)] {
                for (thin, entering) in [(false, true), (false, false), (true, true)] {
                    let surface = Surface { roughness, ior, metallic, transmission, thin, ..WHITE };
                    check_finite(&surface, &|wo| Bsdf::new(&surface, wo, entering), &directions, &us);
                }
            }
        }
    }
    for case in CASES {
        check_finite(&case.name, &|wo| case.bsdf(wo), &directions, &us);
    }
    for method in [Method::Walk, Method::Skin, Method::FreePath, Method::Profile] {
        for radius in [0.0, 1e-9, 1e-8, 1.0, 1e30, f32::INFINITY, f32::NAN, -1.0] {
            for (color, anisotropy, ior) in
                [(1.0, 2.0, 0.0), (0.0, -2.0, f32::NAN), (f32::NAN, f32::NAN, 1e9), (7.0, 0.99, 1.0), (1e-6, 0.0, 1.4)]
            {
                let (color, radius) = (Rgb::splat(color), Rgb::new(radius, 0.1, 0.0));
                let subsurface = Subsurface { color, radius, anisotropy, ior, method, ..WAX };
                let closure = Closure::Beneath { subsurface, alpha: ior };
                check_finite(&closure, &|wo| seen(&closure, wo, true, PLAIN), &directions, &us);
                for s in samples(&seen(&closure, Vec3::Z, true, PLAIN), Pattern::Sobol, 64).flatten() {
                    check_inside(&closure, &s);
                }
            }
        }
    }
    let black = Surface { base_color: Rgb::BLACK, specular: 0.0, ..WHITE };
    assert!(Bsdf::new(&black, Vec3::Z, true).sample(0.5, [0.5, 0.5]).is_none());
}

/// What a way beneath leads to can be walked in.
fn check_inside(closure: &Closure, sample: &BsdfSample) {
    let Some(index) = sample.beneath else { return };
    let bsdf = seen(closure, Vec3::Z, true, PLAIN);
    let good = match bsdf.beneath(index).unwrap().inside {
        Inside::Medium(medium) => {
            let within = |x: f32, [low, high]: [f32; 2]| x >= low && x <= high;
            medium.sigma_t.is_finite()
                && medium.scale.is_finite()
                && medium.sigma_t.to_array().iter().all(|&sigma| sigma >= 0.0)
                && medium.albedo.to_array().iter().all(|&albedo| within(albedo, [0.2, 0.999_999]))
                && within(medium.anisotropy, [-0.99, 0.99])
        }
        Inside::Profile(profile) => {
            profile.sample(0.5).iter().all(|x| !x.is_nan()) && profile.eval(0.1).to_array().iter().all(|x| *x >= 0.0)
        }
    };
    assert!(good, "{closure:?}: {:?}", bsdf.beneath(index));
}

fn check_finite(surface: &dyn Debug, seen: &dyn Fn(Vec3) -> Bsdf, directions: &[Vec3], us: &[[f32; 2]]) {
    for &wo in directions {
        let bsdf = seen(wo);
        let albedo = bsdf.albedo();
        assert!(albedo.is_finite() && albedo.sum().max_component() < 1.05, "{surface:?} {wo}: {albedo:?}");
        for &u in us {
            for uc in [0.0, 0.2, 0.5, 0.9, 1.0 - 2.0_f32.powi(-24)] {
                let Some(s) = bsdf.sample(uc, u) else { continue };
                let good = s.weight.is_finite() && s.pdf.is_finite() && s.pdf > 0.0 && s.wi.is_finite();
                let color = s.weight.sum().to_array();
                assert!(good && color.iter().all(|&c| c >= 0.0), "{surface:?} {wo} {uc} {u:?}: {s:?}");
            }
        }
        for &wi in directions {
            for wi in [wi, -wi, Vec3::new(-wo.x, -wo.y, wo.z), -wo] {
                let e = bsdf.eval(wi);
                assert!(e.f_cos.is_finite() && e.pdf.is_finite() && e.pdf >= 0.0, "{surface:?} {wo} {wi}: {e:?}");
            }
        }
    }
}

#[test]
fn smooth_glass_obeys_fresnel_and_snell() {
    for (entering, degrees) in [(true, 0.0), (true, 60.0), (true, 89.0), (false, 30.0), (false, 41.0), (false, 60.0)] {
        let eta: f32 = if entering { 1.5 } else { 1.0 / 1.5 };
        let wo = view(degrees, 0.0, true);
        let bsdf = Bsdf::new(&Surface { roughness: 0.0, ..GLASS }, wo, entering);
        let f = fresnel_dielectric(wo.z, eta);
        for s in samples(&bsdf, Pattern::Sobol, 64).flatten() {
            assert!(s.delta && (s.weight.sum().g - 1.0).abs() < 1e-5);
            if s.lobe == Lobe::Glossy {
                assert!((s.pdf - f).abs() < 1e-5 && (s.wi - Vec3::new(-wo.x, -wo.y, wo.z)).length() < 1e-6);
            } else {
                assert!((s.pdf - (1.0 - f)).abs() < 1e-5 && (s.wi.x * eta + wo.x).abs() < 1e-6 && s.wi.z < 0.0);
            }
        }
        if !entering && degrees > 41.9 {
            assert_eq!(f, 1.0);
        }
    }
    assert!((f0_from_eta(1.5) - 0.04).abs() < 1e-7);
}

/// A lobe just above the threshold of smoothness answers as a mirror does.
#[test]
fn polish_meets_the_mirror() {
    for surface in [METAL, GLASS, Surface { base_color: TEAL, ..WHITE }] {
        for degrees in [0.0, 50.0, 80.0] {
            let wo = view(degrees, 0.4, true);
            let seen = |roughness| total(furnace(&Bsdf::new(&Surface { roughness, ..surface }, wo, true), 1 << 14));
            let d = seen(0.0099) - seen(0.0101);
            assert!(d.to_array().iter().all(|d| d.abs() < 2e-3), "{surface:?} {degrees}: {d:?}");
        }
    }
}
