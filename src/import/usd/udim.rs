//! UDIM sets: images in tiles of the UV plane, numbered `1001 + u + 10 v`.

use super::images::{Images, Space};
use crate::desc::{ImageDesc, PixelData};

/// What stands for a tile's number in a path.
pub(super) const MARK: &str = "<UDIM>";

/// A picture of a set is made smaller until it has at most this many texels.
const LARGEST: u64 = 1 << 28;

/// The tiles that are there. As in UsdShadeUdimUtils, tiles 1001 to 1100 are looked for.
pub(super) fn tiles(authored: &str, resolve: impl Fn(&str) -> Option<String>) -> Vec<(u32, String)> {
    (1001..=1100).filter_map(|tile| Some((tile, resolve(&authored.replace(MARK, &tile.to_string()))?))).collect()
}

/// One image of all tiles, and how many columns and rows of tiles it has. Tiles that are not there are
/// black; each has the size of the first.
///
/// # Errors
/// What is wrong where no tile can be read or they differ in their kind of texel.
pub(super) fn picture(
    images: &mut Images,
    tiles: &[(u32, String)],
    space: Space,
) -> Result<(ImageDesc, [u32; 2]), String> {
    let place = |tile: u32| [(tile - 1001) % 10, (tile - 1001) / 10];
    let size = |axis: usize| tiles.iter().map(|&(tile, _)| place(tile)[axis] + 1).max().unwrap_or(1);
    let [columns, rows] = [size(0), size(1)];
    let mut read = Vec::new();
    for (tile, file) in tiles {
        read.push((place(*tile), images.get(file, space)?));
    }
    let Some(&(_, first)) = read.first() else { return Err("the UDIM set has no tiles".to_string()) };
    let first = &images.images[first as usize];
    let (mut width, mut height) = (first.width, first.height);
    while u64::from(width) * u64::from(height) * u64::from(columns * rows) > LARGEST && width.min(height) > 1 {
        (width, height) = (width / 2, height / 2);
    }
    let mut picture = ImageDesc {
        width: width * columns,
        height: height * rows,
        pixels: empty(&first.pixels, u64::from(width) * u64::from(height) * u64::from(columns * rows), first.channels),
        ..ImageDesc::clone(first)
    };
    for ([column, row], index) in read {
        let tile = &images.images[index as usize];
        if tile.channels != picture.channels || tile.color_space != picture.color_space {
            return Err(format!("tile {} has other channels than {}", tile.name, picture.name));
        }
        for y in 0..height {
            // v grows upwards, rows of texels downwards.
            let to = ((rows - 1 - row) * height + y) as usize * picture.width as usize + (column * width) as usize;
            let from_y = (u64::from(y) * u64::from(tile.height) / u64::from(height)) as usize;
            for x in 0..width as usize {
                let from_x = x * tile.width as usize / width as usize;
                let n = usize::from(tile.channels);
                let from = (from_y * tile.width as usize + from_x) * n;
                if !copy(&mut picture.pixels, (to + x) * n, &tile.pixels, from, n) {
                    return Err(format!("tile {} has other texels than {}", tile.name, picture.name));
                }
            }
        }
    }
    Ok((picture, [columns, rows]))
}

fn empty(like: &PixelData, texels: u64, channels: u8) -> PixelData {
    let n = texels as usize * usize::from(channels);
    match like {
        PixelData::U8(_) => PixelData::U8(vec![0; n]),
        PixelData::U16(_) => PixelData::U16(vec![0; n]),
        PixelData::F16(_) => PixelData::F16(vec![half::f16::ZERO; n]),
        PixelData::F32(_) => PixelData::F32(vec![0.0; n]),
    }
}

/// Copies one texel; false where the two are stored differently.
fn copy(to: &mut PixelData, at: usize, from: &PixelData, start: usize, n: usize) -> bool {
    match (to, from) {
        (PixelData::U8(to), PixelData::U8(from)) => to[at..at + n].copy_from_slice(&from[start..start + n]),
        (PixelData::U16(to), PixelData::U16(from)) => to[at..at + n].copy_from_slice(&from[start..start + n]),
        (PixelData::F16(to), PixelData::F16(from)) => to[at..at + n].copy_from_slice(&from[start..start + n]),
        (PixelData::F32(to), PixelData::F32(from)) => to[at..at + n].copy_from_slice(&from[start..start + n]),
        _ => return false,
    }
    true
}

#[cfg(test)]
mod tests {
    use super::super::images::File;
    use super::super::images::tests::png;
    use super::*;
    use openusd::sdf::AssetPath;

    #[test]
    fn tiles_stand_where_their_numbers_say() {
        let folder = tempfile::tempdir().unwrap();
        png(folder.path(), "t.1001.png", 1, &[[10, 0, 0]]);
        png(folder.path(), "t.1002.png", 2, &[[20, 0, 0]; 4]);
        png(folder.path(), "t.1011.png", 1, &[[30, 0, 0]]);
        let layer = folder.path().join("s.usda").to_string_lossy().into_owned();
        let File::Tiles(tiles) = File::find(&AssetPath::new("./t.<UDIM>.png"), Some(&layer)) else { panic!() };
        assert_eq!(tiles.iter().map(|t| t.0).collect::<Vec<_>>(), [1001, 1002, 1011]);
        let (picture, size) = picture(&mut Images::default(), &tiles, Space::Raw).unwrap();
        assert_eq!((size, picture.width, picture.height), ([2, 2], 2, 2));
        // Top row: tile 1011 and none; bottom row: 1001 and 1002.
        assert_eq!(picture.pixels, PixelData::U8(vec![30, 0, 0, 0, 0, 0, 10, 0, 0, 20, 0, 0]));
    }
}
