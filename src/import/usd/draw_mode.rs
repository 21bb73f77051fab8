//! Draw modes: a model that is not drawn itself, but by its bounds, its origin or cards
//! (UsdGeomModelAPI). What stands in for it is what UsdImaging makes of it, but that lines are bars of
//! some thickness and that both sides of a card are seen.

use std::rc::Rc;

use openusd::gf::Vec3f;
use openusd::sdf::AssetPath;
use openusd::tf::Token;
use openusd::usd::Prim;

use super::cards::{self, Picture};
use super::inherit::{Context, Pose};
use super::kinds::{Kind, Role};
use super::per_instance::Each;
use super::shape::{self, Built, Quad, StandIn};
use super::stage::Reading;
use super::walk::{Leaf, Shown, Walk};
use crate::error::Warnings;
use crate::math::{DAffine3, DVec3};

/// How a model is drawn that is not drawn itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum DrawMode {
    Bounds,
    Origin,
    Cards,
}

impl DrawMode {
    /// What `prim`, which authors model:drawMode, hands down to its children; its parent hands down `above`
    /// (UsdGeomModelAPI::ComputeModelDrawMode). `None` for what is drawn itself.
    pub fn of(reading: &Reading<'_>, prim: &Prim, above: Option<Self>) -> Option<Self> {
        if !prim.is_model().unwrap_or(false) {
            return above;
        }
        match reading.value::<Token>(prim, "model:drawMode").as_ref().map(Token::as_str) {
            Some("bounds") => Some(Self::Bounds),
            Some("origin") => Some(Self::Origin),
            Some("cards") => Some(Self::Cards),
            Some("default") => None,
            Some("inherited") | None => above,
            Some(other) => {
                reading.warn(prim.path(), format!("draw mode '{other}' is not known; taken for default"));
                None
            }
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::Bounds => "bounds",
            Self::Origin => "origin",
            Self::Cards => "cards",
        }
    }
}

/// Shows what stands in for `prim` if its draw mode says so; false where it is drawn itself. Its children
/// take `context` from it, `outer` is that of its parent.
pub(super) fn replace(
    walk: &mut Walk<'_, '_>,
    prim: &Prim,
    kind: &Kind,
    names: &[Token],
    [outer, context]: [&Context; 2],
    shown: &mut Vec<Shown>,
) -> bool {
    let reading = walk.reading;
    let mode = context.draw_mode.filter(|_| !walk.measuring && applies(reading, prim, names));
    let Some(mode) = mode else { return false };
    if context.hidden(reading) {
        return true;
    }
    let color = reading.value::<[f32; 3]>(prim, "model:drawModeColor").unwrap_or([0.18; 3]);
    let pictures = if mode == DrawMode::Cards { cards::pictures(reading, prim, names) } else { Vec::new() };
    let Some(shape) = shape_of(walk, prim, kind, mode, &pictures, [outer, context]) else {
        let what = format!("has nothing whose bounds could be drawn as {}; it is left out", mode.name());
        reading.warn(prim.path(), what);
        return true;
    };
    // Instances of an asset mostly look the same.
    let files: Vec<&AssetPath> = pictures.iter().map(|picture| &picture.asset).collect();
    let key = format!("{color:?} {shape:?} {files:?}");
    let textures = pictures.into_iter().map(|picture| picture.attribute).collect();
    let leaf = walk.stand_ins.entry(key).or_insert_with(|| {
        Rc::new(Leaf {
            prim: prim.clone(),
            kind: Kind {
                type_name: mode.name().into(),
                name: mode.name().into(),
                role: Role::Leaf,
                imageable: true,
                xformable: true,
            },
            names: Rc::default(),
            primvars: Rc::default(),
            bindings: None,
            visible: true,
            linked: false,
            stand_in: Some(StandIn { shape, color, textures }),
            skin: None,
        })
    });
    let (leaf, path, asset) = (leaf.clone(), prim.path().clone(), context.asset.clone());
    walk.show(
        Shown { leaf, path, pose: context.pose.clone(), asset, scope: None, color: None, each: Each::default() },
        shown,
    );
    true
}

/// True for models that a draw mode replaces; others hand it down to those below.
fn applies(reading: &Reading<'_>, prim: &Prim, names: &[Token]) -> bool {
    if !prim.is_model().unwrap_or(false) {
        return false;
    }
    let authored = names.iter().any(|name| name.as_str() == "model:applyDrawMode");
    let applied = if authored { reading.value::<bool>(prim, "model:applyDrawMode") } else { None };
    applied.unwrap_or_else(|| prim.is_component().unwrap_or(false))
}

/// What is drawn; `None` where that depends on bounds and there are none.
fn shape_of(
    walk: &mut Walk<'_, '_>,
    prim: &Prim,
    kind: &Kind,
    mode: DrawMode,
    pictures: &[Picture],
    contexts: [&Context; 2],
) -> Option<shape::StandInShape> {
    let reading = walk.reading;
    if mode == DrawMode::Origin {
        return Some(shape::StandInShape::Origin);
    }
    let geometry = reading.value::<Token>(prim, "model:cardGeometry");
    let quads: Vec<Quad> = match geometry.as_ref().map(Token::as_str).filter(|_| mode == DrawMode::Cards) {
        Some("fromTexture") => cards::from_textures(reading, pictures),
        _ => {
            let bounds = hint(reading, prim).or_else(|| computed(walk, prim, kind, contexts))?;
            match mode {
                DrawMode::Cards => cards::around(bounds, geometry.is_some_and(|kind| kind == "box"), pictures),
                _ => return Some(shape::StandInShape::Bounds(bounds)),
            }
        }
    };
    Some(shape::StandInShape::Cards(quads))
}

/// A box by its smallest and largest corner.
type Range = [[f32; 3]; 2];

/// extentsHint for all purposes but guide: pairs in the order default, render, proxy, guide.
fn hint(reading: &Reading<'_>, prim: &Prim) -> Option<Range> {
    let hint: Vec<Vec3f> = reading.value(prim, "extentsHint")?;
    let corners: Vec<[f32; 3]> = hint.iter().map(|corner| [corner.x, corner.y, corner.z]).collect();
    let pairs = corners.as_chunks::<2>().0.iter().take(3);
    // Of a purpose without geometry the corners trade places.
    let full = pairs.filter(|[low, high]| low.iter().zip(high).all(|(low, high)| low <= high && high.is_finite()));
    around(full.flatten().map(|corner| DVec3::from(corner.map(f64::from))))
}

/// The bounds of all that is in `prim`, in its own space; models in it are taken as they are.
fn computed(walk: &mut Walk<'_, '_>, prim: &Prim, kind: &Kind, [outer, context]: [&Context; 2]) -> Option<Range> {
    let reading = walk.reading;
    let mut inside = Vec::new();
    let within = Context { pose: Pose::still(DAffine3::IDENTITY), ..context.clone() };
    // What is below an instance is wanted here and now, and is of no use for drawing.
    let (later, prototypes) = (walk.later.take(), std::mem::take(&mut walk.prototypes));
    walk.measuring = true;
    if kind.role == Role::Leaf {
        walk.leaf(prim, kind, outer, &within, &Rc::default(), &mut inside);
    }
    walk.below(prim, within, false, &mut inside);
    walk.measuring = false;
    (walk.later, walk.prototypes) = (later, prototypes);
    let from_world = context.pose.world.inverse();
    let mut corners = Vec::new();
    for one in inside {
        let Some([low, high]) = extent(reading, &one.leaf) else { continue };
        let pose = if one.pose.absolute { from_world * one.pose.world } else { one.pose.world };
        let corner = |i: usize| std::array::from_fn(|axis| f64::from([low, high][i >> axis & 1][axis]));
        corners.extend((0..8).map(|i| pose.transform_point3(DVec3::from_array(corner(i)))));
    }
    around(corners)
}

/// The bounds of one shape: as authored, else of its points, else of what is made of it.
fn extent(reading: &Reading<'_>, leaf: &Leaf) -> Option<Range> {
    let of_points = |points: &[[f32; 3]]| around(points.iter().map(|p| DVec3::from(p.map(f64::from))));
    let authored = |name: &str| {
        let is_there = leaf.prim.attribute(name).has_authored_value().unwrap_or(false);
        let points = is_there.then(|| reading.value::<Vec<Vec3f>>(&leaf.prim, name)).flatten()?;
        of_points(&points.iter().map(|p| [p.x, p.y, p.z]).collect::<Vec<_>>())
    };
    authored("extent").or_else(|| authored("points")).or_else(|| {
        let source = shape::read(reading, &leaf.prim, &[], leaf.skin.as_deref())?;
        let place = reading.place_of(leaf.prim.path());
        match shape::build(source, &shape::Wants::default(), 0, &place, &mut Warnings::new())? {
            Built::Mesh(mesh) => of_points(&mesh.points),
            Built::Rounds(rounds) => {
                let corners = |(p, r): (&[f32; 3], &f32)| [-1.0, 1.0].map(|s| p.map(|x| x + s * r));
                of_points(&rounds.points.iter().zip(&rounds.radii).flat_map(corners).collect::<Vec<_>>())
            }
        }
    })
}

/// Larger bounds have no diagonal in single precision.
const LARGEST: f32 = 1e18;

/// The smallest box around `points`; `None` where there are none, or one that is out of range.
fn around(points: impl IntoIterator<Item = DVec3>) -> Option<Range> {
    let (low, high) = points.into_iter().map(|p| (p, p)).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))?;
    let both = [low, high].map(|corner| corner.as_vec3().to_array());
    both.as_flattened().iter().all(|x| x.abs() < LARGEST).then_some(both)
}
