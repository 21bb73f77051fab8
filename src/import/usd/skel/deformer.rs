//! The points and normals of a shape as its joints and blend shapes have them.

use std::rc::Rc;

use openusd::gf::Matrix4d;
use openusd::tf::Token;
use openusd::usd::{Attribute, Prim, TimeCode};
use openusd_schemas::geom::Interpolation;
use rayon::prelude::*;

use super::super::retime;
use super::super::shape::primvar::Data;
use super::super::stage::Reading;
use super::super::xform::{Xform, affine};
use super::Bound;
use super::blend_shape::BlendShapes;
use super::influences::Influences;
use super::skeleton::{Skeleton, mapped};
use super::skinning::{Method, Skin, cofactor};
use super::space::Between;
use crate::math::{DAffine3, DVec3};

/// What deforms a shape.
pub(in super::super) struct Deformer<'a> {
    reading: &'a Reading<'a>,
    skeleton: Rc<Skeleton>,
    count: usize,
    bones: Option<(Follows, Influences)>,
    shapes: Option<BlendShapes>,
}

/// How a prim follows the joints of a skeleton.
pub(super) struct Follows {
    method: Method,
    bind: DAffine3,
    /// Where its joints are among those of the skeleton; `None` where they are the same.
    joints: Option<Vec<Option<usize>>>,
    between: Between,
}

impl Follows {
    /// How `prim` follows `skeleton`, and how many joints it may follow; what is wrong as an error.
    pub fn read(
        reading: &Reading<'_>,
        prim: &Prim,
        bound: &Bound,
        skeleton: &Skeleton,
    ) -> Result<(Self, usize), String> {
        let attribute = |path: &Option<_>| path.as_ref().and_then(|path| reading.stage.attribute(path).ok());
        let bind = attribute(&bound.bind)
            .and_then(|bind| reading.value_of::<Matrix4d>(&bind, reading.time))
            .map_or(DAffine3::IDENTITY, |bind| affine(&bind.0));
        let method = attribute(&bound.method).and_then(|method| reading.value_of::<Token>(&method, reading.time));
        let method = match method.as_ref().map_or("classicLinear", Token::as_str) {
            "classicLinear" => Method::Linear,
            "dualQuaternion" => Method::DualQuaternion,
            other => return Err(format!("there is no skinningMethod '{other}'")),
        };
        let joints = attribute(&bound.joints).and_then(|joints| reading.value_of::<Vec<Token>>(&joints, reading.time));
        let joints = joints.map(|joints| {
            let places = mapped(&joints, &skeleton.joints);
            if let Some(unknown) = places.iter().position(Option::is_none) {
                let what = format!(
                    "follows the joint {}, which its skeleton does not have; that one stays where it was bound",
                    joints[unknown]
                );
                reading.warn(prim.path(), what);
            }
            places
        });
        let count = joints.as_ref().map_or(skeleton.joints.len(), Vec::len);
        let between = Between::new(reading, &bound.skeleton, prim.path());
        Ok((Self { method, bind, joints, between }, count))
    }

    /// The joints at `time`, and the skeleton's space to the prim's; `None` where one of them can't be told.
    pub fn at(&self, reading: &Reading<'_>, skeleton: &Skeleton, time: TimeCode) -> Option<(Skin, DAffine3)> {
        let pose = skeleton.pose(reading, time)?;
        let skin = match &self.joints {
            None => Skin::new(self.method, self.bind, &pose),
            Some(joints) => {
                let joint = |joint: &Option<usize>| joint.map_or(DAffine3::IDENTITY, |joint| pose[joint]);
                Skin::new(self.method, self.bind, &joints.iter().map(joint).collect::<Vec<_>>())
            }
        };
        Some((skin, self.between.at(reading, time)?))
    }

    /// The transforms on the way that change with time.
    pub fn varying(&self) -> impl Iterator<Item = &Xform> {
        self.between.varying()
    }
}

impl<'a> Deformer<'a> {
    /// That of `prim`, which has `count` points; `None` for none, or one that is broken, which is told.
    pub fn of(reading: &'a Reading<'a>, prim: &Prim, bound: &Bound, count: usize) -> Option<Self> {
        let skeleton = reading.skeletons.of(reading, &bound.skeleton, bound.animation.as_ref())?;
        let by_points = bound.influences.is_some() && !bound.rigid;
        let bones = by_points.then(|| bones(reading, prim, bound, &skeleton, count)).flatten();
        let shapes =
            bound.shapes.then(|| BlendShapes::read(reading, prim, skeleton.animation.as_ref(), count)).flatten();
        (bones.is_some() || shapes.is_some()).then_some(Self { reading, skeleton, count, bones, shapes })
    }

    /// `points` as modelled to where they are at `time`.
    pub fn points(&self, mut points: Vec<[f32; 3]>, time: TimeCode) -> Vec<[f32; 3]> {
        if let (Some(shapes), Some(animation)) = (&self.shapes, &self.skeleton.animation) {
            let offsets = shapes.offsets(self.reading, animation, time, self.count);
            points.iter_mut().zip(offsets.points).for_each(|(point, by)| *point = add(*point, by));
        }
        if let Some((follows, influences)) = &self.bones
            && let Some((skin, to_prim)) = follows.at(self.reading, &self.skeleton, time)
        {
            points.par_iter_mut().with_min_len(MANY).enumerate().for_each(|(i, point)| {
                let moved = skin.point(influences.of(i), DVec3::from(point.map(f64::from)));
                *point = to_prim.transform_point3(moved).as_vec3().into();
            });
        }
        points
    }

    /// `normals` of a surface turned with it. `corners` are the points of face-varying ones. Those of whole faces
    /// are left out: what the faces themselves then have is right.
    pub fn of_surface(&self, normals: Option<Data<3>>, corners: &[i32]) -> Option<Data<3>> {
        let is_of_points = |how| !matches!(how, Interpolation::Constant | Interpolation::Uniform);
        let mut normals = normals.filter(|normals| is_of_points(normals.interpolation))?;
        self.normals(&mut normals, corners);
        Some(normals)
    }

    /// Turns the normals `data` of points, and of `corners`, with what they stand on; others stay.
    pub fn normals(&self, data: &mut Data<3>, corners: &[i32]) {
        let at_corners = match data.interpolation {
            Interpolation::Vertex | Interpolation::Varying => false,
            Interpolation::FaceVarying => true,
            Interpolation::Constant | Interpolation::Uniform => return,
        };
        if let Some(indices) = data.indices.take() {
            let value =
                |i: &i32| usize::try_from(*i).ok().and_then(|i| data.values.get(i)).copied().unwrap_or_default();
            data.values = indices.iter().map(value).collect();
        }
        let point = |i: usize| if at_corners { usize::try_from(*corners.get(i)?).ok() } else { Some(i) };
        let count = self.count;
        let point = |i: usize| point(i).filter(|&point| point < count);
        let time = self.reading.time;
        let offsets = match (&self.shapes, &self.skeleton.animation) {
            (Some(shapes), Some(animation)) => shapes.offsets(self.reading, animation, time, count).normals,
            _ => None,
        };
        if let Some(offsets) = offsets {
            for (i, normal) in data.values.iter_mut().enumerate() {
                if let Some(point) = point(i) {
                    *normal = add(*normal, offsets[point]);
                }
            }
        }
        let skin = self.bones.as_ref().and_then(|(follows, influences)| {
            let (skin, to_prim) = follows.at(self.reading, &self.skeleton, time)?;
            Some((skin, cofactor(to_prim.matrix3), influences))
        });
        if let Some((skin, to_prim, influences)) = skin {
            data.values.par_iter_mut().with_min_len(MANY).enumerate().for_each(|(i, normal)| {
                let Some(point) = point(i) else { return };
                let turned = to_prim * skin.normal(influences.of(point), DVec3::from(normal.map(f64::from)));
                *normal = turned.normalize_or_zero().as_vec3().into();
            });
        }
    }

    /// Times from `open` to `close` at which the deformation has a sample; `None` where it never changes.
    pub fn samples(&self, open: f64, close: f64) -> Option<Vec<f64>> {
        let animation = self.skeleton.animation.as_ref();
        let attributes: Vec<Attribute> = animation.map(|animation| animation.attributes()).unwrap_or_default();
        let varies = |attribute: &Attribute| attribute.value_might_be_time_varying().unwrap_or(false);
        let xforms = || self.bones.iter().flat_map(|(follows, _)| follows.varying());
        if !attributes.iter().any(varies) && xforms().next().is_none() {
            return None;
        }
        let mut times = retime::samples(self.reading, &attributes, open, close);
        times.extend(xforms().flat_map(|xform| xform.samples(self.reading, open, close)));
        Some(times)
    }
}

/// Points that one thread moves; fewer are not worth a second thread.
const MANY: usize = 1 << 12;

fn add(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    std::array::from_fn(|i| a[i] + b[i])
}

/// How the `count` elements of `prim` follow joints; `None`, with a warning, where that is broken.
pub(super) fn bones(
    reading: &Reading<'_>,
    prim: &Prim,
    bound: &Bound,
    skeleton: &Skeleton,
    count: usize,
) -> Option<(Follows, Influences)> {
    let read = Follows::read(reading, prim, bound, skeleton)
        .and_then(|(follows, joints)| Ok((follows, Influences::read(reading, bound, count, joints)?)));
    match read {
        Ok(bones) => Some(bones),
        Err(what) => {
            reading.warn(prim.path(), format!("{what}; it stands as modelled"));
            None
        }
    }
}
