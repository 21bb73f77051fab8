//! From triangles and the values of a shape to a `MeshDesc`.

use std::sync::Arc;

use openusd_schemas::geom::Interpolation;
use rayon::prelude::*;

use super::Wants;
use super::polygons::{PASS, Triangles, cross};
use super::primvar::{Channel, Counts, Primvars};
use crate::desc::{Attribute, MeshDesc, Motion, NamedAttribute};
use crate::error::{Place, Warnings};
use crate::import::tangents;
use crate::math::{DVec3, Vec3};

/// The values of a shape that are wanted and that fit it.
#[derive(Default)]
pub(super) struct Channels {
    pub normals: Option<Channel<3>>,
    pub uvs: Vec<(Arc<str>, Channel<2>)>,
    pub color: Option<Channel<3>>,
    pub opacity: Option<Channel<1>>,
    /// What graphs ask for by name.
    pub named: Vec<(Arc<str>, Channel<4>)>,
}

/// A shape whose triangles are made.
pub(super) struct Surface {
    pub points: Vec<[f32; 3]>,
    pub triangles: Triangles,
    pub channels: Channels,
    /// Material slot of each face.
    pub slots: Option<Vec<u16>>,
    pub motion: Vec<Motion<Vec<[f32; 3]>>>,
}

impl Channels {
    /// Those of `primvars` that are wanted.
    pub fn new(primvars: Primvars, counts: &Counts, wants: &Wants, place: &Place, warnings: &mut Warnings) -> Self {
        let Primvars { uvs, color, opacity, normals, named, .. } = primvars;
        let mut fitting = Vec::new();
        for data in uvs.into_iter().filter(|data| wants.uv_sets.contains(&data.name)) {
            let name = data.name.clone();
            fitting.extend(data.fit(counts, place, warnings).map(|channel| (name, channel)));
        }
        let named = named.into_iter().filter_map(|data| {
            let name = data.name.clone();
            data.fit(counts, place, warnings).map(|channel| (name, channel))
        });
        Self {
            named: named.collect(),
            normals: normals.and_then(|data| data.fit(counts, place, warnings)),
            uvs: fitting,
            color: color.filter(|_| wants.display_color).and_then(|data| data.fit(counts, place, warnings)),
            opacity: opacity.filter(|_| wants.display_color).and_then(|data| data.fit(counts, place, warnings)),
        }
    }
}

impl Channels {
    /// Keeps the first value of each for the whole shape; true where that loses something.
    pub fn make_constant(&mut self) -> bool {
        fn first<const N: usize>(channel: &mut Channel<N>) -> bool {
            let value = channel.at(0);
            let loses =
                channel.interpolation != Interpolation::Constant && channel.values.iter().any(|other| *other != value);
            *channel = Channel { interpolation: Interpolation::Constant, values: vec![value], indices: None };
            loses
        }
        self.normals = None;
        let uvs = self.uvs.iter_mut().fold(false, |loses, (_, channel)| first(channel) | loses);
        let color = self.color.as_mut().is_some_and(first);
        let opacity = self.opacity.as_mut().is_some_and(first);
        let named = self.named.iter_mut().fold(false, |loses, (_, channel)| first(channel) | loses);
        uvs | color | opacity | named
    }
}

impl Wants {
    /// True where some triangle, by the `slots` of all, shows the colours of the mesh.
    fn shows_colors(&self, slots: Option<&[u16]>) -> bool {
        let shows = |slot: &u16| self.colored_slots.get(usize::from(*slot)).copied().unwrap_or(true);
        self.display_color && slots.map_or_else(|| shows(&0), |slots| slots.iter().any(shows))
    }
}

impl Surface {
    /// The mesh; `None`, with a warning, where nothing has area.
    pub fn finish(self, wants: &Wants, place: &Place, warnings: &mut Warnings) -> Option<MeshDesc> {
        let Self { points, mut triangles, channels, slots, motion } = self;
        triangles.drop_flat(&points);
        if triangles.points.is_empty() {
            warnings.push(place, "nothing of it has area; it is left out");
            return None;
        }
        let spread = Spread { triangles: &triangles, points: points.len() };
        let Channels { normals, uvs, color, opacity, named } = channels;
        let mut normals = normals.map(|channel| spread.attribute(channel));
        if let Some(normals) = &mut normals {
            mend_normals(normals, &points, &triangles, place, warnings);
        }
        let tangents_by = wants.tangents.and_then(|set| wants.uv_sets.get(set as usize));
        let lost = tangents_by.filter(|name| !uvs.iter().any(|(known, _)| known == *name));
        if let Some(name) = lost {
            let what = format!("its material bends or stretches light along primvar {name}, which is absent");
            warnings.note(place, format!("{what}: the direction is any of the surface"));
        }
        let sets = uv_sets(uvs, wants, place, warnings, |channel| match channel {
            Some(channel) => {
                let mut set = spread.attribute(channel);
                let (Attribute::Point(values) | Attribute::Corner(values)) = &mut set;
                values.par_iter_mut().with_min_len(PASS).for_each(|uv| *uv = upside_down(*uv));
                set
            }
            None => Attribute::Point(vec![[0.0, 1.0]; points.len()]),
        });
        let material_slots: Option<Vec<u16>> = slots.map(|slots| match &triangles.faces {
            Some(faces) => faces.iter().map(|&face| slots[face as usize]).collect(),
            None => slots,
        });
        let colors = if wants.shows_colors(material_slots.as_deref()) {
            // What has no displayColor has that of its instance, or is grey, as in usdview.
            let is_grey = !(wants.instance_color && opacity.is_none());
            let grey = || is_grey.then(|| Attribute::Point(vec![UNCOLORED; points.len()]));
            let color = color.map(|c| spread.attribute(c)).or_else(grey);
            colors(color, opacity.map(|o| spread.attribute(o)), &triangles)
        } else {
            None
        };
        let of_name = |(name, channel)| NamedAttribute { name, values: spread.attribute(channel) };
        let attributes = named.into_iter().map(of_name).collect();
        let tangents = wants.tangents.and_then(|set| {
            let uvs = sets.get(set as usize)?;
            let tangents = tangents::generate(&points, normals.as_ref(), uvs, &triangles.points);
            if tangents.is_none() {
                warnings.push(place, "no tangents can be made for the material's normal map or anisotropy");
            }
            tangents
        });
        Some(MeshDesc {
            name: name(place),
            place: place.clone(),
            triangles: triangles.points,
            points,
            normals,
            uvs: sets,
            tangents,
            colors,
            attributes,
            generated: None,
            material_slots,
            motion,
        })
    }
}

/// The last name of the path of `place`.
pub(super) fn name(place: &Place) -> Arc<str> {
    let path = place.node.as_deref().unwrap_or_default();
    path.rsplit('/').next().unwrap_or_default().into()
}

/// The UV sets that are wanted, each laid out by `lay`, which is given none for a set that is absent; no sets at all
/// where none is there that anything looks up.
pub(super) fn uv_sets<T>(
    mut uvs: Vec<(Arc<str>, Channel<2>)>,
    wants: &Wants,
    place: &Place,
    warnings: &mut Warnings,
    lay: impl Fn(Option<Channel<2>>) -> T,
) -> Vec<T> {
    let mut sets = Vec::with_capacity(wants.uv_sets.len());
    let mut any = false;
    for name in &wants.uv_sets {
        let found = uvs.iter().position(|(known, _)| known == name).map(|i| uvs.swap_remove(i).1);
        let spare = name.is_empty() || (wants.spare_first_set && sets.is_empty());
        if found.is_none() && !spare {
            let what = format!("its material looks textures up by primvar {name}, which is absent; (0, 0) is used");
            warnings.push(place, what);
        }
        any |= found.is_some() || !spare;
        sets.push(lay(found));
    }
    if any { sets } else { Vec::new() }
}

/// Colour of shapes that are to show theirs and have none (UsdImaging's fallback).
pub(super) const UNCOLORED: [f32; 3] = [0.5; 3];

/// Lays values over triangles.
struct Spread<'a> {
    triangles: &'a Triangles,
    points: usize,
}

impl Spread<'_> {
    fn attribute<const N: usize>(&self, channel: Channel<N>) -> Attribute<[f32; N]> {
        match channel.interpolation {
            Interpolation::Constant => Attribute::Point(vec![channel.at(0); self.points]),
            Interpolation::Varying | Interpolation::Vertex => Attribute::Point(channel.flat()),
            Interpolation::Uniform => {
                let face = |t: usize| self.triangles.faces.as_ref().map_or(t, |faces| faces[t] as usize);
                Attribute::Corner((0..self.triangles.points.len()).flat_map(|t| [channel.at(face(t)); 3]).collect())
            }
            Interpolation::FaceVarying => Attribute::Corner(match &self.triangles.corners {
                Some(corners) => corners.as_flattened().iter().map(|&c| channel.at(c as usize)).collect(),
                None => channel.flat(),
            }),
        }
    }
}

/// USD's st grows upwards, ours downwards.
pub(super) fn upside_down([u, v]: [f32; 2]) -> [f32; 2] {
    [if u.is_finite() { u } else { 0.0 }, if v.is_finite() { 1.0 - v } else { 1.0 }]
}

/// Colour and opacity in one.
pub(super) fn rgba(color: [f32; 3], opacity: [f32; 1]) -> [f32; 4] {
    let [r, g, b] = color.map(|v| if v.is_finite() { v.max(0.0) } else { 1.0 });
    [r, g, b, if opacity[0].is_finite() { opacity[0].clamp(0.0, 1.0) } else { 1.0 }]
}

/// Colours and opacities in one.
fn colors(
    color: Option<Attribute<[f32; 3]>>,
    opacity: Option<Attribute<[f32; 1]>>,
    triangles: &Triangles,
) -> Option<Attribute<[f32; 4]>> {
    let mix = |color: &[f32; 3], opacity: &[f32; 1]| rgba(*color, *opacity);
    let at_corners = |values: &Attribute<[f32; 3]>| -> Vec<[f32; 3]> { corners(values, triangles) };
    Some(match (color?, opacity) {
        (Attribute::Point(color), None) => Attribute::Point(color.iter().map(|c| mix(c, &[1.0])).collect()),
        (Attribute::Corner(color), None) => Attribute::Corner(color.iter().map(|c| mix(c, &[1.0])).collect()),
        (Attribute::Point(color), Some(Attribute::Point(opacity))) => {
            Attribute::Point(color.iter().zip(&opacity).map(|(c, o)| mix(c, o)).collect())
        }
        (color, Some(opacity)) => {
            let opacity = corners(&opacity, triangles);
            Attribute::Corner(at_corners(&color).iter().zip(&opacity).map(|(c, o)| mix(c, o)).collect())
        }
    })
}

/// One value for each corner.
fn corners<T: Copy>(values: &Attribute<T>, triangles: &Triangles) -> Vec<T> {
    match values {
        Attribute::Point(values) => triangles.points.as_flattened().iter().map(|&p| values[p as usize]).collect(),
        Attribute::Corner(values) => values.clone(),
    }
}

/// Makes normals unit length; one without direction becomes that of a triangle at its place.
fn mend_normals(
    normals: &mut Attribute<[f32; 3]>,
    points: &[[f32; 3]],
    triangles: &Triangles,
    place: &Place,
    warnings: &mut Warnings,
) {
    let mut broken = Vec::new();
    let (Attribute::Point(values) | Attribute::Corner(values)) = &mut *normals;
    let is_unit = |n: &[f32; 3]| (n[0] * n[0] + n[1] * n[1] + n[2] * n[2] - 1.0).abs() <= 1e-6;
    // Most files hold unit vectors.
    if values.par_iter().with_min_len(PASS).all(is_unit) {
        return;
    }
    for (i, normal) in values.iter_mut().enumerate().filter(|(_, normal)| !is_unit(normal)) {
        match Vec3::from(*normal).try_normalize() {
            Some(unit) => *normal = unit.into(),
            None => broken.push(i),
        }
    }
    if broken.is_empty() {
        return;
    }
    let mut is_broken = vec![false; values.len()];
    broken.iter().for_each(|&i| is_broken[i] = true);
    broken.iter().for_each(|&i| values[i] = [0.0, 0.0, 1.0]);
    let is_at_points = matches!(normals, Attribute::Point(_));
    let (Attribute::Point(values) | Attribute::Corner(values)) = normals;
    let mut used = 0;
    for (t, &triangle) in triangles.points.iter().enumerate() {
        for (k, point) in triangle.into_iter().enumerate() {
            let i = if is_at_points { point as usize } else { 3 * t + k };
            if std::mem::take(&mut is_broken[i]) {
                let [a, b, c] = triangle.map(|p| points[p as usize].map(f64::from));
                values[i] = DVec3::from(cross(a, b, c)).normalize_or(DVec3::Z).as_vec3().into();
                used += 1;
            }
        }
    }
    if used > 0 {
        warnings.push(place, format!("{used} normals have no direction; those of triangles are used there"));
    }
}
