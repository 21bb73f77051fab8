//! The openings through which the light of domes comes.

use std::sync::Arc;

use super::lamp;
use super::mend::Mended;
use crate::desc::{LightKind, SceneDesc};
use crate::error::Warnings;
use crate::light::{Portal, Portals};
use crate::math::DVec3;

/// All portals of the scene; `None` where there are none, or no dome that they would guide.
pub fn prepare(desc: &SceneDesc, origin: DVec3, warnings: &mut Warnings) -> Option<Arc<Portals>> {
    let mut portals = Vec::new();
    for light in &desc.lights {
        let LightKind::Portal { width, height } = light.kind else { continue };
        let mut mended = Mended::default();
        let sizes = [mended.size("width", width), mended.size("height", height)];
        let axes = lamp::axes(light, &mut mended);
        let center = light.transform.translation - origin;
        let portal = match sizes {
            [Some(width), Some(height)] if center.is_finite() => {
                Some(Portal { center, axes, half: [0.5 * f64::from(width), 0.5 * f64::from(height)] })
            }
            _ => None,
        };
        mended.tell(light, portal.is_none(), warnings);
        portals.extend(portal);
    }
    let guided = !portals.is_empty() && desc.lights.iter().any(|light| light.kind.is_dome());
    guided.then(|| Arc::new(Portals::new(portals)))
}
