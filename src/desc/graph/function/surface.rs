//! Functions of how a surface is seen, and normals from maps.

use super::Value;
use super::vector::{add, cross, dot, length, normalize, scale, sub};

/// Nothing is divided by less.
const LEAST: f64 = 1e-5;

/// Reflectance of a dielectric of index `ior`, seen from inside where it is seen from behind.
pub(super) fn fresnel(ior: f64, normal: Value, incoming: Value, backfacing: f64) -> f64 {
    let eta = ior.max(LEAST);
    dielectric(dot(incoming, normal, 3), if backfacing > 0.5 { eta.recip() } else { eta })
}

/// The same of the index `1 / (1 − blend)`.
pub(super) fn layer_fresnel(blend: f64, normal: Value, incoming: Value, backfacing: f64) -> f64 {
    let eta = (1.0 - blend).max(LEAST);
    dielectric(dot(incoming, normal, 3), if backfacing > 0.5 { eta } else { eta.recip() })
}

/// `1 − |cos|^k`, k twice the blend up to 0.5 and then growing without end.
pub(super) fn layer_facing(blend: f64, normal: Value, incoming: Value) -> f64 {
    let cos = dot(incoming, normal, 3).abs();
    let blend = blend.clamp(0.0, 1.0 - LEAST);
    let power = if blend < 0.5 { 2.0 * blend } else { 0.5 / (1.0 - blend) };
    1.0 - cos.powf(power)
}

/// Fresnel's equations for unpolarized light (R. Cook, K. Torrance: *A Reflectance Model for Computer
/// Graphics*, 1982, equation 1).
fn dielectric(cos: f64, eta: f64) -> f64 {
    let c = cos.abs();
    let g = eta * eta - 1.0 + c * c;
    if g <= 0.0 {
        return 1.0;
    }
    let g = g.sqrt();
    let a = (g - c) / (g + c);
    let b = (c * (g + c) - 1.0) / (c * (g - c) + 1.0);
    0.5 * a * a * (1.0 + b * b)
}

/// The normal of a tangent-space map: its x and y times the strength, its z towards 1 where that is below
/// 1. Neither the normal nor the tangent need be unit (MikkTSpace).
pub(super) fn normal_map(color: Value, strength: f64, normal: Value, tangent: Value) -> Value {
    if length(tangent) == 0.0 {
        return normalize(normal, 3);
    }
    let [x, y, z] = [0, 1, 2].map(|i| 2.0 * color[i] - 1.0);
    let z = 1.0 + strength.clamp(0.0, 1.0) * (z - 1.0);
    let bitangent = scale(cross(normal, tangent), tangent[3]);
    let bent = add(scale(tangent, x * strength), add(scale(bitangent, y * strength), scale(normal, z)));
    or_normal(normalize(bent, 3), normal)
}

/// `mapped` as far as the strength says, and the normal where nothing is left.
pub(super) fn normal_strength(strength: f64, mapped: Value, normal: Value) -> Value {
    let mapped = normalize(mapped, 3);
    let bent = add(normal, scale(sub(mapped, normal), strength.max(0.0)));
    or_normal(if length(mapped) == 0.0 { mapped } else { normalize(bent, 3) }, normal)
}

fn or_normal(bent: Value, normal: Value) -> Value {
    if length(bent) == 0.0 { normalize(normal, 3) } else { bent }
}

#[cfg(test)]
mod tests {
    use super::super::Function;
    use super::*;

    #[test]
    fn reflectance_has_its_closed_forms() {
        let n = [0.0, 0.0, 1.0, 0.0];
        let at = |degrees: f64| {
            let (sin, cos) = degrees.to_radians().sin_cos();
            [sin, 0.0, cos, 0.0]
        };
        let fresnel = |ior: f64, w: Value, back: f64| Function::Fresnel.eval(&[[ior; 4], n, w, [back; 4]])[0];
        assert!((fresnel(1.5, at(0.0), 0.0) - 0.04).abs() < 1e-12);
        assert!((fresnel(1.5, at(0.0), 1.0) - 0.04).abs() < 1e-12);
        // At Brewster's angle half of what is square to the plane is all there is: ((1 − n²) / (1 + n²))² / 2.
        let brewster = 1.5_f64.atan().to_degrees();
        assert!((fresnel(1.5, at(brewster), 0.0) - 0.5 * (1.25_f64 / 3.25).powi(2)).abs() < 1e-12);
        assert_eq!(fresnel(1.5, at(60.0), 1.0), 1.0);
        assert_eq!(fresnel(0.0, at(60.0), 0.0), 1.0);
        let layer = Function::LayerFresnel.eval(&[[1.0 / 3.0; 4], n, at(0.0), [0.0; 4]])[0];
        assert!((layer - 0.04).abs() < 1e-12);
        let facing = |blend: f64, w: Value| Function::LayerFacing.eval(&[[blend; 4], n, w])[0];
        assert!((facing(0.5, at(60.0)) - 0.5).abs() < 1e-12);
        assert!((facing(0.25, at(60.0)) - (1.0 - 0.5_f64.sqrt())).abs() < 1e-12);
        assert!((facing(0.75, at(60.0)) - 0.75).abs() < 1e-12);
        assert!((facing(0.0, at(60.0))).abs() < 1e-12);
    }

    #[test]
    fn maps_tilt_normals() {
        let (n, t) = ([0.0, 0.0, 1.0, 0.0], [1.0, 0.0, 0.0, -1.0]);
        let map =
            |color: Value, strength: f64, tangent: Value| Function::NormalMap.eval(&[color, [strength; 4], n, tangent]);
        let flat = [0.5, 0.5, 1.0, 1.0];
        assert_eq!(map(flat, 1.0, t), [0.0, 0.0, 1.0, 0.0]);
        // 45° along the tangent; the bitangent is turned round.
        let tilted = map([1.0, 0.5, 1.0, 1.0], 1.0, t);
        assert!((tilted[0] - 0.5_f64.sqrt()).abs() < 1e-12 && (tilted[2] - 0.5_f64.sqrt()).abs() < 1e-12);
        assert!(map([0.5, 1.0, 1.0, 1.0], 1.0, t)[1] < -0.7);
        assert_eq!(map([1.0, 0.5, 1.0, 1.0], 0.0, t), [0.0, 0.0, 1.0, 0.0]);
        assert_eq!(map([1.0, 0.5, 1.0, 1.0], 1.0, [0.0; 4]), [0.0, 0.0, 1.0, 0.0]);
        assert_eq!(map([0.5, 0.5, 0.5, 1.0], 1.0, t), [0.0, 0.0, 1.0, 0.0]);
        let half = Function::NormalStrength.eval(&[[0.5; 4], [1.0, 0.0, 0.0, 0.0], n]);
        assert!((half[0] - 0.5_f64.sqrt()).abs() < 1e-12 && (half[2] - 0.5_f64.sqrt()).abs() < 1e-12);
        assert_eq!(Function::NormalStrength.eval(&[[1.0; 4], [0.0; 4], n]), n);
    }
}
