//! Sky Texture.

use super::flow::{At, Flow};
use crate::desc::DomeSun;
use crate::desc::graph::{Atmosphere, Leaf, Op, Scattering, Sky, ValueId};

/// Sky Texture. In a world the disk of its sun is a light of its own.
pub fn sky<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, _: &str) -> ValueId {
    let number = |name: &str, otherwise: f64| at.node.number(name).unwrap_or(otherwise);
    let scattering = match at.node.text("sky_type") {
        "NISHITA" => Scattering::Nishita,
        "SINGLE_SCATTERING" => Scattering::Single,
        "MULTIPLE_SCATTERING" => Scattering::Multiple,
        kind => {
            let sun = at.node.vector("sun_direction").unwrap_or([0.0, 0.0, 1.0]);
            let turbidity = number("turbidity", 2.2);
            let sky = match kind {
                "PREETHAM" => Sky::Preetham { sun, turbidity, before_5: flow.version < [5, 0, 0] },
                _ => Sky::Hosek { sun, turbidity, ground_albedo: number("ground_albedo", 0.3) },
            };
            let direction = flow.linked_or(at, "Vector", |flow| flow.graph.leaf(Leaf::Generated));
            return flow.graph.push(Op::Sky { sky, direction });
        }
    };
    let atmosphere = Atmosphere {
        scattering,
        sun_elevation: number("sun_elevation", 0.26),
        sun_rotation: number("sun_rotation", 0.0),
        sun_size: at.node.flag("sun_disc").then(|| number("sun_size", 0.009_512)),
        sun_intensity: number("sun_intensity", 1.0),
        altitude: number("altitude", 100.0),
        air: number("air_density", 1.0),
        aerosol: at.node.number("aerosol_density").or(at.node.number("dust_density")).unwrap_or(1.0),
        ozone: number("ozone_density", 1.0),
    };
    let of = |atmosphere| Sky::Atmosphere(atmosphere);
    if atmosphere.sun_size.is_none() {
        let direction = flow.linked_or(at, "Vector", |flow| flow.graph.leaf(Leaf::Generated));
        return flow.graph.push(Op::Sky { sky: of(atmosphere), direction });
    }
    // Blender then hides the input, and the direction is the world's.
    let direction = flow.graph.leaf(Leaf::Position);
    if !flow.is_world {
        return flow.graph.push(Op::Sky { sky: of(atmosphere), direction });
    }
    let sky = flow.graph.push(Op::Sky { sky: of(Atmosphere { sun_size: None, ..atmosphere }), direction });
    flow.suns.push(DomeSun { sky, atmosphere });
    sky
}
