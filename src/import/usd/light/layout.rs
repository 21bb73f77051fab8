//! Images of environments that are not lat-long, resampled to that.

use std::f64::consts::{PI, TAU};

use rayon::prelude::*;

use crate::desc::{Blending, ColorSpace, ImageDesc, PixelData};
use crate::math::DVec3;

/// How an image of an environment is laid out. All are seen along −z from +z, up is +y, as any camera of
/// USD looks: UsdLux names them and says no more.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Layout {
    /// The mirror image in a sphere, seen from far away: what is behind the camera (+z) is at its centre.
    MirroredBall,
    /// The same with the angle from +z instead of the mirror's projection along the radius.
    Angular,
    /// Six faces in a cross, three wide and four high, unfolded as seen from the inside: +y, then the row
    /// +x, +z, −x, then −y, then −z upside down.
    VerticalCross,
}

impl Layout {
    /// Where in the image the unit direction `d` is: from the left and from the top, 0 to 1.
    fn lookup(self, d: DVec3) -> [f64; 2] {
        let round = |radius: f64| {
            let length = d.x.hypot(d.y);
            let (x, y) = if length > 0.0 { (d.x / length, d.y / length) } else { (0.0, 0.0) };
            [0.5 * (1.0 + radius * x), 0.5 * (1.0 - radius * y)]
        };
        match self {
            // The mirror's normal is halfway between the direction and the camera.
            Self::MirroredBall => round((0.5 * d.x.hypot(d.y).atan2(d.z)).sin()),
            Self::Angular => round(d.x.hypot(d.y).atan2(d.z) / PI),
            Self::VerticalCross => {
                let a = d.abs();
                // Column and row of the face, and coordinates on it from −1 to 1, right and down.
                let (column, row, x, y) = if a.y >= a.x && a.y >= a.z {
                    if d.y > 0.0 { (1, 0, -d.x / a.y, d.z / a.y) } else { (1, 2, -d.x / a.y, -d.z / a.y) }
                } else if a.x >= a.z {
                    if d.x > 0.0 { (0, 1, d.z / a.x, -d.y / a.x) } else { (2, 1, -d.z / a.x, -d.y / a.x) }
                } else if d.z > 0.0 {
                    (1, 1, -d.x / a.z, -d.y / a.z)
                } else {
                    (1, 3, -d.x / a.z, d.y / a.z)
                };
                [(f64::from(column) + 0.5 * (x + 1.0)) / 3.0, (f64::from(row) + 0.5 * (y + 1.0)) / 4.0]
            }
        }
    }
}

/// `source` as OpenEXR's lat-long: the centre is +z, the left quarter +x, the top +y.
pub(super) fn to_lat_long(source: &ImageDesc, layout: Layout) -> ImageDesc {
    let height = (source.height as usize).clamp(1, 4096);
    let width = 2 * height;
    let row = |j: usize| {
        let latitude = PI * (0.5 - (j as f64 + 0.5) / height as f64);
        (0..width).flat_map(move |i| {
            let longitude = TAU * (0.5 - (i as f64 + 0.5) / width as f64);
            let (sin, cos) = longitude.sin_cos();
            let d = DVec3::new(latitude.cos() * sin, latitude.sin(), latitude.cos() * cos);
            texel(source, layout.lookup(d))
        })
    };
    let pixels: Vec<f32> = (0..height).into_par_iter().flat_map_iter(row).collect();
    ImageDesc {
        name: source.name.clone(),
        place: source.place.clone(),
        width: width as u32,
        height: height as u32,
        channels: 3,
        color_space: ColorSpace::Linear,
        blending: Blending::default(),
        pixels: PixelData::F32(pixels),
    }
}

/// The nearest texel, linear: faces and the rim of a ball have no neighbours to blend with.
fn texel(image: &ImageDesc, [u, v]: [f64; 2]) -> [f32; 3] {
    let at = |x: f64, size: u32| (x * f64::from(size)).clamp(0.0, f64::from(size.max(1) - 1)) as usize;
    let channels = usize::from(image.channels);
    let start = (at(v, image.height) * image.width as usize + at(u, image.width)) * channels;
    std::array::from_fn(|c| {
        let value = image.pixels.get(start + if channels < 3 { 0 } else { c });
        match image.color_space {
            ColorSpace::Srgb if value <= 0.040_45 => value / 12.92,
            ColorSpace::Srgb => ((value + 0.055) / 1.055).powf(2.4),
            ColorSpace::Linear => value,
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Place;

    #[test]
    fn directions_are_where_the_layouts_say() {
        let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
        let near = |found: [f64; 2], expected: [f64; 2]| {
            assert!((0..2).all(|i| (found[i] - expected[i]).abs() < 1e-9), "{found:?} is not {expected:?}");
        };
        let ball = 0.5 * (1.0 + 0.5_f64.sqrt());
        for (d, mirrored, angular, cross) in [
            (z, [0.5, 0.5], [0.5, 0.5], [1.5 / 3.0, 1.5 / 4.0]),
            (x, [ball, 0.5], [0.75, 0.5], [0.5 / 3.0, 1.5 / 4.0]),
            (-x, [1.0 - ball, 0.5], [0.25, 0.5], [2.5 / 3.0, 1.5 / 4.0]),
            (y, [0.5, 1.0 - ball], [0.5, 0.25], [1.5 / 3.0, 0.5 / 4.0]),
            (-y, [0.5, ball], [0.5, 0.75], [1.5 / 3.0, 2.5 / 4.0]),
            (-z, [0.5, 0.5], [0.5, 0.5], [1.5 / 3.0, 3.5 / 4.0]),
        ] {
            if d != -z {
                near(Layout::MirroredBall.lookup(d), mirrored);
                near(Layout::Angular.lookup(d), angular);
            }
            near(Layout::VerticalCross.lookup(d), cross);
        }
        // Faces meet without a break: close to an edge, the same place of the picture.
        for (a, b) in [(z + y, z - x), (z - y, z + x), (-z + y, y), (x + z, z)].map(|(edge, along)| (edge, along)) {
            let lookup = |d: DVec3| Layout::VerticalCross.lookup((d + 0.1 * b.cross(a)).normalize());
            let (one, other) = (lookup(a + 1e-9 * a.cross(b)), lookup(a - 1e-9 * a.cross(b)));
            near(one, other);
        }
    }

    /// What a lat-long image of the same environment would hold.
    #[test]
    fn a_bright_texel_stays_where_it_is() {
        for layout in [Layout::MirroredBall, Layout::Angular, Layout::VerticalCross] {
            let (width, height) = if layout == Layout::VerticalCross { (96, 128) } else { (128, 128) };
            let toward = DVec3::new(0.6, 0.3, 0.5).normalize();
            let [u, v] = layout.lookup(toward);
            let mut pixels = vec![0.0; 3 * width * height];
            let at = (v * height as f64) as usize * width + (u * width as f64) as usize;
            pixels[3 * at + 1] = 1.0;
            let source = ImageDesc {
                name: "sky".into(),
                place: Place::default(),
                width: width as u32,
                height: height as u32,
                channels: 3,
                color_space: ColorSpace::Linear,
                blending: Blending::default(),
                pixels: PixelData::F32(pixels),
            };
            let image = to_lat_long(&source, layout);
            let (width, height) = (image.width as usize, image.height as usize);
            let lit: Vec<usize> = (0..width * height).filter(|&i| image.pixels.get(3 * i + 1) > 0.0).collect();
            assert!(!lit.is_empty(), "{layout:?}");
            for i in lit {
                let u = ((i % width) as f64 + 0.5) / width as f64;
                let v = ((i / width) as f64 + 0.5) / height as f64;
                // facts: lon = atan2(x, z), lat = asin(y); u = 0.5 − lon / 2π, v = 0.5 − lat / π from the top.
                let expected = [0.5 - toward.x.atan2(toward.z) / TAU, 0.5 - toward.y.asin() / PI];
                assert!((u - expected[0]).abs() < 0.02 && (v - expected[1]).abs() < 0.02, "{layout:?}: {u} {v}");
            }
        }
    }
}
