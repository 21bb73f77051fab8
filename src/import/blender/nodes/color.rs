//! Nodes that compute colors.

use std::sync::Arc;

use super::flow::{At, Flow};
use super::math::place;
use super::tables;
use crate::desc::graph::{Function, ValueId};

/// Mix of older files.
pub fn mix<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, _: &str) -> ValueId {
    let args = ["Fac", "Color1", "Color2"].map(|name| flow.input(at, name));
    let function = Function::Mix { blend: flow.blend(at), clamp_factor: true, clamp_result: at.node.flag("use_clamp") };
    flow.graph.apply(function, &args)
}

/// Color Ramp.
pub fn ramp<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, output: &str) -> ValueId {
    let factor = flow.input(at, "Fac");
    let color = match tables::ramp(at.node) {
        Some(table) => flow.graph.apply(Function::Table(Arc::new(table)), &[factor]),
        None => factor,
    };
    if output == "Alpha" { flow.graph.place(color, 3) } else { color }
}

/// RGB Curves: the curve of all, then that of each channel.
pub fn curves<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, _: &str) -> ValueId {
    let (factor, color) = (flow.input(at, "Fac"), flow.input(at, "Color"));
    let (Some(all), Some(each)) = (tables::curves(at.node, &[3]), tables::curves(at.node, &[0, 1, 2])) else {
        return color;
    };
    let combined = flow.graph.apply(Function::Curves(Arc::new(all)), &[color]);
    let separate = flow.graph.apply(Function::Curves(Arc::new(each)), &[combined]);
    flow.graph.mix(color, separate, factor)
}

/// Combine Color.
pub fn combine<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, _: &str) -> ValueId {
    let [a, b, c] = ["Red", "Green", "Blue"].map(|name| flow.input(at, name));
    let value = flow.graph.combine(a, b, c);
    match at.node.text("mode") {
        "HSV" => flow.graph.apply(Function::HsvToRgb, &[value]),
        "HSL" => flow.graph.apply(Function::HslToRgb, &[value]),
        _ => value,
    }
}

/// Separate Color.
pub fn separate<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, output: &str) -> ValueId {
    let color = flow.input(at, "Color");
    let value = match at.node.text("mode") {
        "HSV" => flow.graph.apply(Function::RgbToHsv, &[color]),
        "HSL" => flow.graph.apply(Function::RgbToHsl, &[color]),
        _ => color,
    };
    flow.graph.place(value, place(output, ["Red", "Green", "Blue"]))
}

/// Hue/Saturation/Value.
pub fn hue_saturation<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, _: &str) -> ValueId {
    let args = ["Hue", "Saturation", "Value", "Fac", "Color"].map(|name| flow.input(at, name));
    flow.graph.apply(Function::HueSaturationValue, &args)
}

/// Brightness/Contrast.
pub fn bright_contrast<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, _: &str) -> ValueId {
    let args = ["Color", "Bright", "Contrast"].map(|name| flow.input(at, name));
    flow.graph.apply(Function::BrightContrast, &args)
}

/// Gamma.
pub fn gamma<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, _: &str) -> ValueId {
    let args = ["Color", "Gamma"].map(|name| flow.input(at, name));
    flow.graph.apply(Function::Gamma, &args)
}

/// Invert Color.
pub fn invert<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, _: &str) -> ValueId {
    let args = ["Fac", "Color"].map(|name| flow.input(at, name));
    flow.graph.apply(Function::Invert, &args)
}

/// RGB to BW.
pub fn to_bw<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, _: &str) -> ValueId {
    let color = flow.input(at, "Color");
    flow.graph.luminance(color)
}

/// Blackbody.
pub fn blackbody<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, _: &str) -> ValueId {
    let kelvin = flow.input(at, "Temperature");
    flow.graph.apply(Function::Blackbody, &[kelvin])
}

/// Wavelength.
pub fn wavelength<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, _: &str) -> ValueId {
    let nanometres = flow.input(at, "Wavelength");
    flow.graph.apply(Function::Wavelength, &[nanometres])
}
