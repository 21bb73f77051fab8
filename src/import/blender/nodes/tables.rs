//! Color ramps and curves as the add-on samples them.

use serde::Deserialize;

use super::tree::NodeData;
use crate::desc::graph::{Curves, Table, Value};

#[derive(Deserialize)]
struct RampData {
    constant: bool,
    table: Vec<[f64; 4]>,
}

#[derive(Deserialize)]
struct CurvesData {
    range: [f64; 2],
    extend: bool,
    curves: Vec<Vec<f64>>,
}

/// The color ramp of a node, over 0 to 1.
pub fn ramp(node: &NodeData) -> Option<Table> {
    let data: RampData = serde_json::from_value(node.properties.get("color_ramp")?.clone()).ok()?;
    let curves = if data.constant { Curves::Stepped } else { Curves::Clamped };
    (!data.table.is_empty()).then_some(Table { min: 0.0, max: 1.0, rows: data.table, curves })
}

/// Curves of a node, a column each; a single one stands in all places.
pub fn curves(node: &NodeData, which: &[usize]) -> Option<Table> {
    let data: CurvesData = serde_json::from_value(node.properties.get("mapping")?.clone()).ok()?;
    let columns: Vec<&Vec<f64>> = which.iter().map(|i| data.curves.get(*i)).collect::<Option<_>>()?;
    let first = columns.first()?;
    let row = |i: usize| -> Option<Value> {
        let mut row = [0.0; 4];
        for (place, value) in row.iter_mut().enumerate() {
            *value = *columns.get(place).unwrap_or(first).get(i)?;
        }
        Some(row)
    };
    let rows: Vec<Value> = (0..first.len()).map(row).collect::<Option<_>>()?;
    let curves = if data.extend { Curves::Extrapolated } else { Curves::Clamped };
    (!rows.is_empty()).then_some(Table { min: data.range[0], max: data.range[1], rows, curves })
}
