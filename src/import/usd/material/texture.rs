//! Nodes that look images up, and those that place them.

use super::super::images::{File, Space};
use super::super::udim;
use super::color;
use super::evaluate::Evaluator;
use super::expr::{Id, Lookup, Op, placement};
use super::network::Value;
use crate::desc::graph::{Function, Math, Value as V};
use crate::desc::{Filter, PixelData, TextureDesc, TextureRef, Wrap};
use crate::math::{DMat3, DVec3};

/// A lookup as a node asks for it.
struct Wish<'n> {
    file: Option<&'n File>,
    space: Space,
    uv: Id,
    wrap: [Wrap; 2],
    filter: Filter,
}

/// UsdUVTexture, all four channels.
pub(super) fn usd(e: &mut Evaluator<'_, '_>, node: usize) -> Option<Id> {
    let data = e.node(node);
    let fallback = e.input(node, "fallback", [0.0, 0.0, 0.0, 1.0]);
    let space = match data.text("sourceColorSpace").unwrap_or("auto") {
        "raw" => Space::Raw,
        "sRGB" => Space::Srgb,
        "auto" | "" => Space::Auto,
        other => {
            e.warn(node, format!("sourceColorSpace \"{other}\" isn't known; taken as auto"));
            Space::Auto
        }
    };
    let uv = match e.optional(node, "st") {
        Some(uv) if data.inputs.get("st").is_some_and(|st| st.source.is_some()) => uv,
        _ => {
            if !data.materialx {
                e.warn(node, "its st is not connected; primvars:st is used");
            }
            e.texcoord("st".into())
        }
    };
    let wrap = ["wrapS", "wrapT"].map(|name| match data.text(name) {
        Some("repeat" | "periodic") => Wrap::Repeat,
        Some("clamp") => Wrap::Clamp,
        Some("mirror") => Wrap::Mirror,
        // MaterialX's definition of the node repeats.
        None if data.materialx => Wrap::Repeat,
        // "useMetadata" is black for files without; of what is read here none has any.
        _ => Wrap::Black,
    });
    let wish = Wish { file: file(e, node, "file"), space, uv, wrap, filter: Filter::Linear };
    let texel = match look_up(e, node, &wish) {
        Ok(texel) => texel,
        Err(what) => {
            // In the precision in which it is authored.
            let [r, g, b, a] = e.exprs.known(fallback).unwrap_or_default().map(|x| x as f32);
            e.warn(node, format!("{what}; its fallback ({r}, {g}, {b}, {a}) is used"));
            return Some(fallback);
        }
    };
    let (scale, bias) = (e.input(node, "scale", [1.0; 4]), e.input(node, "bias", [0.0; 4]));
    let scaled = e.exprs.multiply(texel, scale);
    Some(e.exprs.add(scaled, bias))
}

/// MaterialX's image and tiledimage.
pub(super) fn image(e: &mut Evaluator<'_, '_>, node: usize, tiled: bool) -> Option<Id> {
    let mut uv = e.optional(node, "texcoord").unwrap_or_else(|| e.texcoord("st".into()));
    if tiled {
        let tiling = e.input(node, "uvtiling", [1.0; 4]);
        let offset = e.input(node, "uvoffset", [0.0; 4]);
        let (size, tile) =
            (e.input(node, "realworldimagesize", [1.0; 4]), e.input(node, "realworldtilesize", [1.0; 4]));
        let tiled = e.exprs.multiply(uv, tiling);
        let moved = e.exprs.subtract(tiled, offset);
        let sized = e.exprs.math(Math::Divide, &[moved, size]);
        uv = e.exprs.multiply(sized, tile);
    }
    let kind = e.node(node).kind.as_str();
    image_at(e, node, uv, kind)
}

/// The image of a node that has the inputs of `image`, at `uv`, as a value of the type `kind`.
pub(super) fn image_at(e: &mut Evaluator<'_, '_>, node: usize, uv: Id, kind: &str) -> Option<Id> {
    named_image_at(e, node, "file", uv, kind)
}

/// The same of a node with several files, of which the input `name` is one.
pub(super) fn named_image_at(e: &mut Evaluator<'_, '_>, node: usize, name: &str, uv: Id, kind: &str) -> Option<Id> {
    let data = e.node(node);
    let default = e.input(node, "default", [0.0; 4]);
    let named = data.inputs.get(name).and_then(|file| file.color_space.as_deref()).unwrap_or_default();
    let is_color = kind.starts_with("color");
    let (space, rest) = match color::decoding(named) {
        Some(_) if !is_color => (Space::Raw, ""),
        Some(_) if named.is_empty() => (Space::Auto, ""),
        Some(known) => known,
        None => {
            e.warn(node, format!("color space \"{named}\" isn't known; taken by the kind of the file"));
            (Space::Auto, "")
        }
    };
    let wrap = ["uaddressmode", "vaddressmode"].map(|name| match data.text(name) {
        Some("clamp") => Wrap::Clamp,
        Some("mirror") => Wrap::Mirror,
        Some("constant") => Wrap::Black,
        _ => Wrap::Repeat,
    });
    let filter = if data.text("filtertype") == Some("closest") { Filter::Nearest } else { Filter::Linear };
    let wish = Wish { file: file(e, node, name), space, uv, wrap, filter };
    match look_up(e, node, &wish) {
        // A number is the first channel.
        Ok(texel) if kind == "float" => Some(e.exprs.extract(texel, 0)),
        Ok(texel) => Some(color::convert(&mut e.exprs, texel, rest).unwrap_or(texel)),
        Err(what) => {
            e.warn(node, format!("{what}; the node's default is used"));
            Some(default)
        }
    }
}

fn file<'m>(e: &Evaluator<'m, '_>, node: usize, name: &str) -> Option<&'m File> {
    match &e.node(node).inputs.get(name)?.value {
        Some(Value::File(file)) => Some(file),
        _ => None,
    }
}

fn look_up(e: &mut Evaluator<'_, '_>, node: usize, wish: &Wish<'_>) -> Result<Id, String> {
    let mut tiles_of = [1.0; 2];
    let (image, wrap) = match wish.file {
        None => return Err("names no image".to_string()),
        Some(File::Missing(what)) => return Err(what.clone()),
        Some(File::One(file)) => (e.materials.images.get(file, wish.space)?, wish.wrap),
        Some(File::Tiles(tiles)) => {
            let (image, [columns, lines]) = e.materials.udim(tiles, wish.space)?;
            tiles_of = [columns, lines].map(f64::from);
            (image, [Wrap::Black; 2])
        }
    };
    let desc = &e.materials.images.images[image as usize];
    let (channels, unit) = (desc.channels, matches!(desc.pixels, PixelData::U8(_) | PixelData::U16(_)));
    let place = e.node(node).place.clone();
    let texture = TextureDesc { place, image, wrap_u: wrap[0], wrap_v: wrap[1], filter: wish.filter };
    let texture = e.materials.texture(texture);
    let Op::Uv { set, mut rows } = *e.exprs.op(wish.uv) else {
        let tiles = e.exprs.constant([tiles_of[0].recip(), tiles_of[1].recip(), 1.0, 1.0]);
        let uv = e.exprs.multiply(wish.uv, tiles);
        return Ok(e.exprs.push(Op::Image { texture, uv }));
    };
    for (row, tiles) in rows.iter_mut().zip(tiles_of) {
        *row = row.map(|x| x / tiles);
    }
    let texture = TextureRef { texture, uv_set: set, transform: placement(rows) };
    let swizzle = [0, 1, 2, 3];
    Ok(e.exprs.push(Op::Lookup(Lookup { texture, channels, unit, swizzle, factor: [1.0; 4], bias: [0.0; 4] })))
}

/// UsdTransform2d: scaled, then turned counter-clockwise by degrees, then moved.
pub(super) fn transform(e: &mut Evaluator<'_, '_>, node: usize) -> Option<Id> {
    let uv = e.optional(node, "in").unwrap_or_else(|| e.texcoord("st".into()));
    let scale = e.input(node, "scale", [1.0; 4]);
    let (angle, offset) = (e.scalar(node, "rotation", 0.0), e.input(node, "translation", [0.0; 4]));
    let scaled = e.exprs.multiply(uv, scale);
    let turned = rotate_by(e, scaled, angle, 1.0);
    Some(e.exprs.add(turned, offset))
}

/// What is done to an image, hence the inverse to the coordinates.
pub(super) struct Placement {
    pub pivot: Id,
    pub scale: Id,
    /// Degrees, counter-clockwise.
    pub angle: Id,
    pub offset: Id,
    /// True where the coordinates are moved before they are turned and scaled.
    pub offset_first: bool,
}

impl Placement {
    /// `uv` with the inverse done to it.
    pub fn place(&self, e: &mut Evaluator<'_, '_>, uv: Id) -> Id {
        let mut uv = e.exprs.subtract(uv, self.pivot);
        if self.offset_first {
            uv = e.exprs.subtract(uv, self.offset);
            uv = rotate_by(e, uv, self.angle, -1.0);
            uv = e.exprs.math(Math::Divide, &[uv, self.scale]);
        } else {
            uv = e.exprs.math(Math::Divide, &[uv, self.scale]);
            uv = rotate_by(e, uv, self.angle, -1.0);
            uv = e.exprs.subtract(uv, self.offset);
        }
        e.exprs.add(uv, self.pivot)
    }
}

/// MaterialX's place2d.
pub(super) fn place(e: &mut Evaluator<'_, '_>, node: usize) -> Option<Id> {
    let uv = e.optional(node, "texcoord").unwrap_or_else(|| e.texcoord("st".into()));
    let placement = Placement {
        pivot: e.input(node, "pivot", [0.0; 4]),
        scale: e.input(node, "scale", [1.0; 4]),
        angle: e.scalar(node, "rotate", 0.0),
        offset: e.input(node, "offset", [0.0; 4]),
        offset_first: e.uniform(node, "operationorder", 0.0) != 0.0,
    };
    Some(placement.place(e, uv))
}

/// The first two numbers turned counter-clockwise, in radians.
pub(super) fn rotate(e: &mut Evaluator<'_, '_>, uv: Id, angle: f64) -> Id {
    if angle == 0.0 {
        return uv;
    }
    let (sin, cos) = angle.sin_cos();
    if let Op::Uv { set, rows: [u, v] } = *e.exprs.op(uv) {
        let row = |a: f64, b: f64| -> [f64; 3] { std::array::from_fn(|i| a * u[i] + b * v[i]) };
        return e.exprs.push(Op::Uv { set, rows: [row(cos, -sin), row(sin, cos)] });
    }
    let swapped = e.exprs.swizzle(uv, [1, 0, 2, 3]);
    let (straight, across) = (e.exprs.constant([cos, cos, 1.0, 1.0]), e.exprs.constant([-sin, sin, 0.0, 0.0]));
    let (straight, across) = (e.exprs.multiply(uv, straight), e.exprs.multiply(swapped, across));
    e.exprs.add(straight, across)
}

/// The same by an angle in degrees times `sense`, which may vary over the surface.
pub(super) fn rotate_by(e: &mut Evaluator<'_, '_>, uv: Id, degrees: Id, sense: f64) -> Id {
    if let Some([angle, ..]) = e.exprs.known(degrees) {
        return rotate(e, uv, sense * angle.to_radians());
    }
    let x = &mut e.exprs;
    let angle = x.extract(degrees, 0);
    let angle = x.scale(angle, sense.to_radians());
    let (sin, cos) = (x.math(Math::Sine, &[angle]), x.math(Math::Cosine, &[angle]));
    let (u, v, minus) = (x.extract(uv, 0), x.extract(uv, 1), x.scale(sin, -1.0));
    let (uc, vs, us, vc) = (x.multiply(u, cos), x.multiply(v, minus), x.multiply(u, sin), x.multiply(v, cos));
    let (u, v) = (x.add(uc, vs), x.add(us, vc));
    x.apply(Function::Combine, &[u, v])
}

/// rotate3d; around z it is how Blender turns texture coordinates. MaterialX turns clockwise (`v · M`);
/// Blender's exporter writes angles that are meant the other way.
pub(super) fn rotate_around(e: &mut Evaluator<'_, '_>, node: usize) -> Option<Id> {
    let value = e.optional(node, "in")?;
    let angle = e.uniform(node, "amount", 0.0).to_radians();
    let axis: V = match e.node(node).inputs.get("axis").and_then(|axis| axis.value.as_ref()) {
        Some(Value::Numbers(axis, _)) => *axis,
        _ => [0.0, 1.0, 0.0, 0.0],
    };
    if angle == 0.0 {
        return Some(value);
    }
    let clockwise = if e.materials.reading.blender { -1.0 } else { 1.0 };
    if axis[0] == 0.0 && axis[1] == 0.0 && axis[2] != 0.0 {
        return Some(rotate(e, value, -clockwise * axis[2].signum() * angle));
    }
    let Some(axis) = DVec3::new(axis[0], axis[1], axis[2]).try_normalize() else {
        e.warn(node, "turns around an axis without direction; left out");
        return Some(value);
    };
    let m = DMat3::from_axis_angle(axis, -clockwise * angle).transpose();
    let rows = [m.x_axis, m.y_axis, m.z_axis].map(|row| [row.x, row.y, row.z, 0.0]);
    Some(e.exprs.apply(Function::Affine(Box::new(rows)), &[value]))
}

impl super::Materials<'_> {
    /// One image of the tiles of a UDIM set, and its columns and rows.
    fn udim(&mut self, tiles: &[(u32, String)], space: Space) -> Result<(u32, [u32; 2]), String> {
        let key = (tiles.first().map(|tile| tile.1.clone()).unwrap_or_default(), space == Space::Raw);
        if let Some(known) = self.udims.get(&key) {
            return known.clone();
        }
        let made = udim::picture(&mut self.images, tiles, space);
        let made = made.map(|(image, size)| (self.images.push(image), size));
        self.udims.insert(key, made.clone());
        made
    }

    /// Index of a texture, the same for the same one.
    pub(super) fn texture(&mut self, texture: TextureDesc) -> u32 {
        let same = |known: &TextureDesc| {
            let way = |t: &TextureDesc| (t.image, t.wrap_u, t.wrap_v, t.filter);
            way(known) == way(&texture)
        };
        let known = self.textures.iter().position(same);
        known.unwrap_or_else(|| {
            self.textures.push(texture);
            self.textures.len() - 1
        }) as u32
    }
}
