//! UsdSkel: shapes that are moved by the joints of a skeleton and by blend shapes.
//!
//! ```text
//! binding: who follows which skeleton ─► skeleton, animation: its joints at a time ─┐
//!                                        blend shapes: offsets of points ───────────┤
//!   deformer: points and normals as they are shown ◄── skinning ◄── influences ─────┘
//! ```
//!
//! Where all of a prim follows the same joints, its transform is changed instead of its points. The skeleton
//! itself is drawn as a guide by usdview, and not at all here. The rules are those of OpenUSD's
//! UsdSkelSkeletonQuery, UsdSkelSkinningQuery, UsdSkelBlendShapeQuery and UsdSkelBakeSkinning
//! (<https://openusd.org/release/api/_usd_skel__intro.html>); what is wrong is told and stands as modelled.

mod animation;
mod binding;
mod blend_shape;
mod deformer;
mod influences;
mod rigid;
mod skeleton;
mod skinning;
mod space;

pub(super) use binding::{Bound, Inherited, is_of_binding};
pub(super) use deformer::Deformer;
pub(super) use rigid::place;
pub(super) use skeleton::Skeletons;

/// The schema without which properties of skeletons do nothing.
const API: &str = "SkelBindingAPI";
