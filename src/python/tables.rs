//! The tables of passes and settings, for user interfaces.

use pyo3::prelude::*;
use pyo3::types::PyDict;

use penumbra::film::PASSES;
use penumbra::settings::{Kind, SETTINGS};

/// Every pass, in the order of a file: dicts of name, layer, channels and help. Names that end in
/// "<group>" stand for one pass per light group, "aov:<name>" for the scene's AOVs.
#[pyfunction]
pub fn passes(py: Python<'_>) -> PyResult<Vec<Bound<'_, PyDict>>> {
    let row = |pass: &penumbra::film::Pass| {
        let row = PyDict::new(py);
        row.set_item("name", pass.name)?;
        row.set_item("layer", pass.layer)?;
        row.set_item("channels", pass.channels)?;
        row.set_item("help", pass.help)?;
        Ok(row)
    };
    PASSES.iter().map(row).collect()
}

/// Every setting: dicts of name, kind ("int", "float", "bool", "choice" or "text"), default (as text),
/// help, and min and max or choices where the kind has them.
#[pyfunction]
pub fn settings(py: Python<'_>) -> PyResult<Vec<Bound<'_, PyDict>>> {
    let row = |def: &penumbra::settings::SettingDef| {
        let row = PyDict::new(py);
        row.set_item("name", def.name)?;
        row.set_item("default", def.default)?;
        row.set_item("help", def.help)?;
        match def.kind {
            Kind::Int { min, max } => {
                row.set_item("kind", "int")?;
                row.set_item("min", min)?;
                row.set_item("max", max)?;
            }
            Kind::Float { min, max } => {
                row.set_item("kind", "float")?;
                row.set_item("min", min)?;
                row.set_item("max", max)?;
            }
            Kind::Choice(choices) => {
                row.set_item("kind", "choice")?;
                row.set_item("choices", choices.to_vec())?;
            }
            Kind::Bool => row.set_item("kind", "bool")?,
            Kind::Text => row.set_item("kind", "text")?,
        }
        Ok(row)
    };
    SETTINGS.iter().map(row).collect()
}
