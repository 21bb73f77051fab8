//! Volumes: what of a shader at a material's Volume socket absorbs light.
//!
//! As Cycles has it: `(1 − color) × density` of an absorption, `(1 − color) (1 − √absorption color) × density` of the
//! Principled Volume, both per metre. What scatters and what emits is left out and told.

use super::closure::{self, Part};
use super::flow::{At, Flow};
use crate::desc::graph::ValueId;
use crate::desc::{ScalarInput, VolumeDesc};

/// What is left out.
#[derive(Default)]
struct Lost {
    scattering: bool,
    emission: bool,
    /// Inputs that vary.
    varying: Vec<String>,
}

/// What fills a material of `output`; `None` where nothing is linked to its volume.
pub fn volume<'a>(flow: &mut Flow<'a, '_>, output: At<'a>) -> Option<VolumeDesc> {
    if !flow.is_linked(output, "Volume") {
        return None;
    }
    let parts = closure::parts(flow, output, output.node.input("Volume")?);
    let mut lost = Lost::default();
    let mut sigma = [0.0; 3];
    for Part { weight, at, .. } in parts {
        let weight = match flow.graph.known(weight) {
            Some(weight) => weight[0],
            None => {
                lost.varying.push("how its shaders are mixed".into());
                0.5
            }
        };
        let absorbed = absorption(flow, at, &mut lost);
        sigma = std::array::from_fn(|i| sigma[i] + weight * absorbed[i].max(0.0));
    }
    tell(flow, &lost);
    Some(filled(sigma))
}

/// A volume that absorbs `sigma` per metre.
fn filled(sigma: [f64; 3]) -> VolumeDesc {
    let most = sigma.iter().fold(0.0, |most: f64, &sigma| most.max(sigma));
    VolumeDesc {
        thickness: ScalarInput::constant(1.0),
        // Where 1/e is left of the color that is absorbed most.
        attenuation_distance: if most > 0.0 { 1.0 / most } else { f64::INFINITY },
        attenuation_color: if most > 0.0 { sigma.map(|sigma| (-sigma / most).exp()) } else { [1.0; 3] },
        adds: true,
    }
}

fn absorption<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, lost: &mut Lost) -> [f64; 3] {
    let one = |flow: &mut Flow<'a, '_>, name: &str, lost: &mut Lost| constant(flow, at, name, lost);
    match at.node.r#type.as_str() {
        "ShaderNodeVolumeAbsorption" => {
            let (color, density) = (one(flow, "Color", lost), one(flow, "Density", lost)[0].max(0.0));
            color.map(|color| (1.0 - color) * density)
        }
        "ShaderNodeVolumePrincipled" => {
            let (color, density) = (one(flow, "Color", lost), one(flow, "Density", lost)[0].max(0.0));
            let absorbed = one(flow, "Absorption Color", lost);
            lost.scattering |= density > 0.0 && color != [0.0; 3];
            lost.emission |= ["Emission Strength", "Blackbody Intensity"].iter().any(|name| shows(flow, at, name));
            let absorbed = absorbed.map(|color| (1.0 - color.max(0.0).sqrt()).max(0.0));
            std::array::from_fn(|i| (1.0 - color[i]).max(0.0) * absorbed[i] * density)
        }
        "ShaderNodeVolumeCoefficients" => {
            lost.scattering |= shows(flow, at, "Scatter Coefficients");
            lost.emission |= shows(flow, at, "Emission Coefficients");
            one(flow, "Absorption Coefficients", lost)
        }
        "ShaderNodeVolumeScatter" => {
            lost.scattering |= shows(flow, at, "Density");
            [0.0; 3]
        }
        "ShaderNodeEmission" => {
            lost.emission |= shows(flow, at, "Strength");
            [0.0; 3]
        }
        kind => {
            let name = &at.node.name;
            flow.warn(format!("the shader \"{name}\" ({kind}) is not supported in a volume; it is left out"));
            [0.0; 3]
        }
    }
}

/// True where an input is anything but 0 everywhere.
fn shows<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, name: &str) -> bool {
    let value = flow.input(at, name);
    flow.graph.known(value).is_none_or(|value| value[..3] != [0.0; 3])
}

/// An input that is to be the same everywhere inside; of one that is not, what its socket holds.
fn constant<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, name: &str, lost: &mut Lost) -> [f64; 3] {
    let value: ValueId = flow.input(at, name);
    let [x, y, z, _] = flow.graph.known(value).unwrap_or_else(|| {
        lost.varying.push(format!("the {name} of \"{}\"", at.node.name));
        at.node.input(name).map_or([0.0; 4], |input| at.node.inputs[input].value.places())
    });
    [x, y, z]
}

/// One warning for all that is left out, one for all that varies.
fn tell(flow: &mut Flow<'_, '_>, lost: &Lost) {
    let what = match (lost.scattering, lost.emission) {
        (true, true) => "what its volume scatters and emits",
        (true, false) => "what its volume scatters",
        (false, true) => "what its volume emits",
        (false, false) => "",
    };
    if !what.is_empty() {
        flow.warn(format!("rendered without {what}, which is not supported; the absorption is rendered"));
    }
    if !lost.varying.is_empty() {
        let names = lost.varying.join(", ");
        flow.warn(format!(
            "its volume varies inside ({names}), which is not supported; the values of the sockets are taken"
        ));
    }
}
