//! What graphs can know of the path that a ray is part of.

use crate::desc::graph::PathInfo;

/// How a ray came about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RayKind {
    /// From the camera.
    Camera,
    /// To a light, or to see what is near.
    Shadow,
    /// From a diffuse lobe.
    Diffuse,
    /// Reflected by a glossy lobe.
    Glossy,
    /// Refracted, or passed through a thin wall.
    Transmission,
}

/// The path up to a hit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathState {
    /// The ray that has met the surface.
    pub kind: RayKind,
    /// True where it comes from a perfect mirror or lens.
    pub singular: bool,
    /// Scatterings by diffuse lobes.
    pub diffuse: u16,
    /// Reflections by glossy lobes.
    pub glossy: u16,
    /// Refractions.
    pub transmission: u16,
    /// Surfaces passed unscattered.
    pub transparent: u16,
    /// How far the ray came from where it was scattered last.
    pub length: f32,
}

impl PathState {
    /// A ray from the camera, at its start.
    pub const CAMERA: Self = Self {
        kind: RayKind::Camera,
        singular: false,
        diffuse: 0,
        glossy: 0,
        transmission: 0,
        transparent: 0,
        length: 0.0,
    };

    /// A shadow ray.
    pub const SHADOW: Self = Self { kind: RayKind::Shadow, ..Self::CAMERA };

    /// After a scattering that has made a ray of `kind`.
    pub fn scattered(self, kind: RayKind, singular: bool) -> Self {
        let count = |n: u16, of: RayKind| n.saturating_add(u16::from(of == kind));
        Self {
            kind,
            singular,
            diffuse: count(self.diffuse, RayKind::Diffuse),
            glossy: count(self.glossy, RayKind::Glossy),
            transmission: count(self.transmission, RayKind::Transmission),
            ..self
        }
    }

    /// What a graph asks.
    pub fn get(&self, info: PathInfo) -> f64 {
        let yes = |yes: bool| f64::from(u8::from(yes));
        let is = |kinds: &[RayKind]| yes(kinds.contains(&self.kind));
        match info {
            PathInfo::IsCamera => is(&[RayKind::Camera]),
            PathInfo::IsShadow => is(&[RayKind::Shadow]),
            PathInfo::IsDiffuse => is(&[RayKind::Diffuse]),
            PathInfo::IsGlossy => is(&[RayKind::Glossy, RayKind::Transmission]),
            PathInfo::IsSingular => yes(self.singular),
            PathInfo::IsReflection => is(&[RayKind::Diffuse, RayKind::Glossy]),
            PathInfo::IsTransmission => is(&[RayKind::Transmission]),
            PathInfo::Length => f64::from(self.length),
            PathInfo::Depth => f64::from(self.diffuse) + f64::from(self.glossy) + f64::from(self.transmission),
            PathInfo::DiffuseDepth => f64::from(self.diffuse),
            PathInfo::GlossyDepth => f64::from(self.glossy),
            PathInfo::TransmissionDepth => f64::from(self.transmission),
            PathInfo::TransparentDepth => f64::from(self.transparent),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_counted_by_what_scatters() {
        let path = PathState::CAMERA.scattered(RayKind::Diffuse, false).scattered(RayKind::Transmission, true);
        let is = |info: PathInfo| path.get(info);
        assert_eq!((is(PathInfo::Depth), is(PathInfo::DiffuseDepth), is(PathInfo::TransmissionDepth)), (2.0, 1.0, 1.0));
        assert_eq!((is(PathInfo::IsGlossy), is(PathInfo::IsSingular), is(PathInfo::IsCamera)), (1.0, 1.0, 0.0));
        assert_eq!((is(PathInfo::IsTransmission), is(PathInfo::IsReflection)), (1.0, 0.0));
        assert_eq!(PathState::SHADOW.get(PathInfo::IsShadow), 1.0);
        assert_eq!(PathState::CAMERA.get(PathInfo::IsCamera), 1.0);
    }
}
