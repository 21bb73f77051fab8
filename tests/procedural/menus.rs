//! Blender's names of what is picked from menus.

use penumbra::texture::procedural::*;
use penumbra::texture::sky::Scattering;

pub fn dimensions(name: &str) -> Dimensions {
    match name {
        "1D" => Dimensions::One,
        "2D" => Dimensions::Two,
        "3D" => Dimensions::Three,
        "4D" => Dimensions::Four,
        _ => panic!("{name}"),
    }
}

pub fn noise_kind(name: &str) -> NoiseKind {
    match name {
        "FBM" => NoiseKind::Fbm,
        "MULTIFRACTAL" => NoiseKind::Multifractal,
        "HYBRID_MULTIFRACTAL" => NoiseKind::HybridMultifractal,
        "RIDGED_MULTIFRACTAL" => NoiseKind::RidgedMultifractal,
        "HETERO_TERRAIN" => NoiseKind::HeteroTerrain,
        _ => panic!("{name}"),
    }
}

pub fn voronoi_feature(name: &str) -> VoronoiFeature {
    match name {
        "F1" => VoronoiFeature::F1,
        "F2" => VoronoiFeature::F2,
        "SMOOTH_F1" => VoronoiFeature::SmoothF1,
        "DISTANCE_TO_EDGE" => VoronoiFeature::DistanceToEdge,
        "N_SPHERE_RADIUS" => VoronoiFeature::NSphereRadius,
        _ => panic!("{name}"),
    }
}

pub fn voronoi_metric(name: &str) -> VoronoiMetric {
    match name {
        "EUCLIDEAN" => VoronoiMetric::Euclidean,
        "MANHATTAN" => VoronoiMetric::Manhattan,
        "CHEBYCHEV" => VoronoiMetric::Chebychev,
        "MINKOWSKI" => VoronoiMetric::Minkowski,
        _ => panic!("{name}"),
    }
}

pub fn wave_direction(kind: &str, direction: &str) -> WaveDirection {
    match (kind, direction) {
        ("BANDS", "X") => WaveDirection::BandsX,
        ("BANDS", "Y") => WaveDirection::BandsY,
        ("BANDS", "Z") => WaveDirection::BandsZ,
        ("BANDS", "DIAGONAL") => WaveDirection::BandsDiagonal,
        ("RINGS", "X") => WaveDirection::RingsX,
        ("RINGS", "Y") => WaveDirection::RingsY,
        ("RINGS", "Z") => WaveDirection::RingsZ,
        ("RINGS", "SPHERICAL") => WaveDirection::RingsSpherical,
        _ => panic!("{kind} {direction}"),
    }
}

pub fn wave_profile(name: &str) -> WaveProfile {
    match name {
        "SIN" => WaveProfile::Sine,
        "SAW" => WaveProfile::Saw,
        "TRI" => WaveProfile::Triangle,
        _ => panic!("{name}"),
    }
}

pub fn gradient(name: &str) -> Gradient {
    match name {
        "LINEAR" => Gradient::Linear,
        "QUADRATIC" => Gradient::Quadratic,
        "EASING" => Gradient::Easing,
        "DIAGONAL" => Gradient::Diagonal,
        "RADIAL" => Gradient::Radial,
        "QUADRATIC_SPHERE" => Gradient::QuadraticSphere,
        "SPHERICAL" => Gradient::Spherical,
        _ => panic!("{name}"),
    }
}

pub fn scattering(name: &str) -> Scattering {
    match name {
        "NISHITA" => Scattering::Nishita,
        "SINGLE_SCATTERING" => Scattering::Single,
        "MULTIPLE_SCATTERING" => Scattering::Multiple,
        _ => panic!("{name}"),
    }
}
