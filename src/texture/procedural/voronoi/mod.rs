//! Voronoi: distances to points scattered one to a cell.
//!
//! Steven Worley: *A Cellular Texture Basis Function*, SIGGRAPH 1996 (F1, F2); Inigo Quilez: *Smooth
//! Voronoi* and *Voronoi Borders*, 2012 and 2014 (smooth F1, distance to the edge between cells).

mod cells;
mod features;
mod metric;
mod near;
mod octaves;

use crate::math::Vec3;

use super::Dimensions;
use super::round::{saturate, within};
use cells::Cells;
use metric::Metric;
use octaves::Octaves;

/// Which distance is taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VoronoiFeature {
    /// To the closest point.
    F1,
    /// To the second closest point.
    F2,
    /// To the closest point, edges smoothed away.
    SmoothF1,
    /// To the edge between cells; Euclidean.
    DistanceToEdge,
    /// Radius of the sphere around the closest point that touches the sphere around its own closest
    /// point; Euclidean.
    NSphereRadius,
}

/// How distance is measured; one dimension has but one way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VoronoiMetric {
    /// Length.
    Euclidean,
    /// Sum of the axes' distances.
    Manhattan,
    /// The largest of the axes' distances.
    Chebychev,
    /// Root of the sum of powers, by the exponent.
    Minkowski,
}

/// How cells place and colour their points in two to four dimensions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scatter {
    /// Hashes of the coordinates' bits by lookup3: Blender up to 4.5.
    Jenkins,
    /// Hashes of whole numbers by PCG: Blender from 5.0.
    Pcg,
}

/// What is picked for a Voronoi texture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Voronoi {
    /// Coordinates read.
    pub dimensions: Dimensions,
    /// Which distance is taken.
    pub feature: VoronoiFeature,
    /// How distance is measured.
    pub metric: VoronoiMetric,
    /// Scales distance and colour by the largest that the octaves can reach.
    pub normalize: bool,
    /// How cells place their points.
    pub scatter: Scatter,
}

/// What can be linked to a Voronoi texture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoronoiSockets {
    /// Cells per unit in the first octave, along `w` too.
    pub scale: f32,
    /// Octaves beyond the first, held in 0 to 15.
    pub detail: f32,
    /// Amplitude of an octave relative to the one before, held in 0 to 1.
    pub roughness: f32,
    /// Frequency of an octave relative to the one before.
    pub lacunarity: f32,
    /// Width of smooth F1's blend, held in 0 to 1.
    pub smoothness: f32,
    /// Minkowski's exponent.
    pub exponent: f32,
    /// How far points stray from their cell's corner, held in 0 to 1.
    pub randomness: f32,
}

/// A Voronoi texture at a position. What the feature does not have is 0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct VoronoiValue {
    /// The distance.
    pub distance: f32,
    /// The colour of the point's cell.
    pub color: [f32; 3],
    /// Where the point is.
    pub position: Vec3,
    /// Where it is along `w`.
    pub w: f32,
    /// The sphere's radius.
    pub radius: f32,
}

impl Voronoi {
    /// The distance alone, which saves smooth F1's colours.
    pub fn distance(&self, p: Vec3, w: f32, sockets: &VoronoiSockets) -> f32 {
        self.evaluate::<false>(p, w, sockets).distance
    }

    /// All outputs.
    pub fn value(&self, p: Vec3, w: f32, sockets: &VoronoiSockets) -> VoronoiValue {
        self.evaluate::<true>(p, w, sockets)
    }

    fn evaluate<const COLOR: bool>(&self, p: Vec3, w: f32, sockets: &VoronoiSockets) -> VoronoiValue {
        let (p, w) = (p * sockets.scale, w * sockets.scale);
        match (self.dimensions, self.scatter) {
            (Dimensions::One, _) => self.at::<1, true, COLOR>([w], sockets),
            (Dimensions::Two, Scatter::Jenkins) => self.at::<2, false, COLOR>([p.x, p.y], sockets),
            (Dimensions::Two, Scatter::Pcg) => self.at::<2, true, COLOR>([p.x, p.y], sockets),
            (Dimensions::Three, Scatter::Jenkins) => self.at::<3, false, COLOR>([p.x, p.y, p.z], sockets),
            (Dimensions::Three, Scatter::Pcg) => self.at::<3, true, COLOR>([p.x, p.y, p.z], sockets),
            (Dimensions::Four, Scatter::Jenkins) => self.at::<4, false, COLOR>([p.x, p.y, p.z, w], sockets),
            (Dimensions::Four, Scatter::Pcg) => self.at::<4, true, COLOR>([p.x, p.y, p.z, w], sockets),
        }
    }

    fn at<const N: usize, const PCG: bool, const COLOR: bool>(
        &self,
        p: [f32; N],
        sockets: &VoronoiSockets,
    ) -> VoronoiValue {
        let randomness = saturate(sockets.randomness);
        let octaves = Octaves {
            detail: within(sockets.detail, 0.0, 15.0),
            roughness: saturate(sockets.roughness),
            lacunarity: sockets.lacunarity,
            normalize: self.normalize,
        };
        let metric = Metric::new::<N>(self.metric, sockets.exponent);
        // No point is further than the far corner of half a cell.
        let reach = 0.5 + 0.5 * randomness;
        let farthest = metric.distance([0.0; N], [reach; N]);
        let cells = |p| Cells::<N, PCG>::new(p, randomness);
        let point = match self.feature {
            VoronoiFeature::DistanceToEdge => {
                let distance = octaves.edge(p, reach, |p| features::distance_to_edge(&cells(p)));
                return VoronoiValue { distance, ..VoronoiValue::default() };
            }
            VoronoiFeature::NSphereRadius => {
                return VoronoiValue { radius: features::n_sphere_radius(&cells(p)), ..VoronoiValue::default() };
            }
            VoronoiFeature::F2 => {
                octaves.points(p, farthest * 2.0, |p| features::f2::<N, PCG, COLOR>(&cells(p), metric))
            }
            VoronoiFeature::SmoothF1 if sockets.smoothness > 0.0 => {
                let smoothness = within(sockets.smoothness / 2.0, 0.0, 0.5);
                octaves.points(p, farthest, |p| features::smooth_f1::<N, PCG, COLOR>(&cells(p), metric, smoothness))
            }
            VoronoiFeature::F1 | VoronoiFeature::SmoothF1 => {
                octaves.points(p, farthest, |p| features::f1::<N, PCG, COLOR>(&cells(p), metric))
            }
        };
        let unscaled = |x: f32| if sockets.scale == 0.0 { 0.0 } else { x / sockets.scale };
        let at = point.position.map(unscaled);
        let axis = |axis: usize| if axis < N { at[axis] } else { 0.0 };
        let (position, w) = if N == 1 { (Vec3::ZERO, at[0]) } else { (Vec3::new(axis(0), axis(1), axis(2)), axis(3)) };
        VoronoiValue { distance: point.distance, color: point.color, position, w, radius: 0.0 }
    }
}
