//! IES Texture: a measured distribution of a lamp.

use std::f64::consts::PI;
use std::path::Path;
use std::sync::Arc;

use super::flow::{At, Flow};
use crate::desc::IesDesc;
use crate::desc::graph::{Function, IesTable, ValueId};
use crate::error::Result;
use crate::import::ies::{decode_ies, load_ies};

/// Watts of a lamp per candela: 4π over the efficacy of daylight, 177.83 lm/W, as Cycles has it.
const WATTS: f64 = 4.0 * PI / 177.83;

/// What Cycles shows for a file that it can't read.
const MISSING: f64 = 100.0;

/// IES Texture.
pub fn ies<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, _: &str) -> ValueId {
    let strength = flow.input(at, "Strength");
    let value = match read(flow, at) {
        Ok(profile) => {
            let direction = flow.linked_or(at, "Vector", |flow| flow.object_normal());
            let fades = flow.version < [5, 0, 0];
            flow.graph.apply(Function::Ies(Arc::new(table(&profile, fades))), &[direction])
        }
        Err(error) => {
            flow.warn(format!("{error}: it shines evenly instead"));
            flow.graph.number(MISSING)
        }
    };
    flow.graph.multiply(value, strength)
}

/// The profile of the node's text, or of its file.
fn read<'a>(flow: &mut Flow<'a, '_>, at: At<'a>) -> Result<IesDesc> {
    let (place, warnings) = flow.told_at(&at.node.name);
    match at.node.text("mode") {
        "EXTERNAL" => load_ies(Path::new(at.node.text("filepath")), warnings),
        _ => decode_ies(at.node.text("ies").as_bytes(), &at.node.name.as_str().into(), &place, warnings),
    }
}

/// All around the axis, in watts.
fn table(profile: &IesDesc, fades: bool) -> IesTable {
    let rows = profile.horizontal.len();
    let last = profile.horizontal[rows - 1];
    // Each row of the file, by the angles that stand for it: mirrored where a part alone is given.
    let mut order: Vec<(f64, usize)> = profile.horizontal.iter().copied().zip(0..).collect();
    for whole in [90.0, 180.0].into_iter().filter(|&whole| last <= whole && last > 0.0) {
        let mirrored = order.iter().rev().skip(1).map(|&(angle, row)| (2.0 * whole - angle, row));
        order = order.iter().copied().chain(mirrored.collect::<Vec<_>>()).collect();
    }
    if rows == 1 {
        order = vec![(0.0, 0), (360.0, 0)];
    }
    let vertical = profile.vertical.len();
    let row = |&(_, row): &(f64, usize)| &profile.candela[row * vertical..(row + 1) * vertical];
    IesTable {
        horizontal: order.iter().map(|(angle, _)| angle.to_radians()).collect(),
        vertical: profile.vertical.iter().map(|angle| angle.to_radians()).collect(),
        values: order.iter().flat_map(row).map(|candela| candela * WATTS).collect(),
        fades,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Place;

    fn profile(horizontal: &[f64]) -> IesDesc {
        IesDesc {
            name: "a".into(),
            place: Place::default(),
            vertical: vec![0.0, 90.0],
            horizontal: horizontal.to_vec(),
            candela: (0..2 * horizontal.len()).map(|i| i as f64).collect(),
        }
    }

    #[test]
    fn a_part_of_the_circle_is_mirrored_to_the_whole() {
        let angles = |horizontal: &[f64]| {
            let table = table(&profile(horizontal), false);
            let degrees: Vec<f64> = table.horizontal.iter().map(|angle| angle.to_degrees().round()).collect();
            let first: Vec<f64> = table.values.iter().step_by(2).map(|value| (value / WATTS).round()).collect();
            (degrees, first)
        };
        assert_eq!(angles(&[0.0]), (vec![0.0, 360.0], vec![0.0, 0.0]));
        let quarter = (vec![0.0, 90.0, 180.0, 270.0, 360.0], vec![0.0, 2.0, 0.0, 2.0, 0.0]);
        assert_eq!(angles(&[0.0, 90.0]), quarter);
        let half = (vec![0.0, 90.0, 180.0, 270.0, 360.0], vec![0.0, 2.0, 4.0, 2.0, 0.0]);
        assert_eq!(angles(&[0.0, 90.0, 180.0]), half);
        assert_eq!(angles(&[0.0, 120.0, 360.0]), (vec![0.0, 120.0, 360.0], vec![0.0, 2.0, 4.0]));
    }
}
