//! The suns of skies in a dome: each is a light of its own, since a dome's samples would hardly ever find it.

use super::mend::Mended;
use crate::desc::graph::{Leaf, Op, Sky, Value};
use crate::desc::{DomeShader, LightDesc};
use crate::error::Warnings;
use crate::light::Distant;
use crate::math::Rgb;
use crate::texture::graph as texture;

/// The lights that the suns of `shader` are.
pub fn prepare(shader: &DomeShader, light: &LightDesc, warnings: &mut Warnings) -> Vec<Distant> {
    let mut suns = Vec::new();
    for sun in &shader.suns {
        let Some(disk) = texture::sun_disk(&sun.atmosphere) else { continue };
        let [x, y, z] = disk.direction.to_array().map(f64::from);
        let direction = [x, y, z, 0.0];
        let background = Sky::Atmosphere(crate::desc::graph::Atmosphere { sun_size: None, ..sun.atmosphere });
        let around = texture::Sky::new(&background).radiance(direction);
        // What the nodes after the sky make of it, with the disk and without.
        let mut graph = shader.graph.clone();
        let mut emitted = |sky: Rgb| {
            let value = graph.replaced(shader.radiance, |id, op| match op {
                _ if id == sun.sky => Some([f64::from(sky.r), f64::from(sky.g), f64::from(sky.b), 1.0]),
                Op::Leaf(leaf) => known(leaf, direction),
                _ => None,
            });
            graph.known(value)
        };
        let with = if disk.covers { disk.radiance } else { around + disk.radiance };
        let (Some(with), Some(without)) = (emitted(with), emitted(around)) else {
            warnings.push(&light.place, "the sun of a sky that is mixed with textures is left out; the sky is there");
            continue;
        };
        let solid_angle = std::f64::consts::PI * (0.5 * f64::from(disk.diameter)).sin().powi(2);
        let irradiance = std::array::from_fn(|i| (with[i].max(0.0) - without[i].max(0.0)).max(0.0) * solid_angle);
        let mut mended = Mended::default();
        let irradiance = mended.color("the sun's light", irradiance);
        if !irradiance.is_black() {
            suns.push(Distant::new(disk.direction, disk.diameter, irradiance));
        }
        mended.tell(light, irradiance.is_black(), warnings);
    }
    suns
}

/// What a dome's graph knows in a direction.
fn known(leaf: &Leaf, [x, y, z, _]: Value) -> Option<Value> {
    match leaf {
        Leaf::Position | Leaf::ObjectPosition | Leaf::Generated => Some([x, y, z, 0.0]),
        Leaf::Normal | Leaf::TrueNormal | Leaf::ObjectNormal | Leaf::SmoothNormal | Leaf::Incoming => {
            Some([-x, -y, -z, 0.0])
        }
        _ => None,
    }
}
