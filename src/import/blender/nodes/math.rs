//! Nodes that compute numbers and vectors.

use std::sync::Arc;

use super::flow::{At, Flow};
use super::tables;
use crate::desc::graph::{Blend, Function, Math, Range, ValueId};

/// The functions of the Math node that take numbers as they are.
#[rustfmt::skip]
const MATH: &[(&str, Math)] = &[
    ("ADD", Math::Add), ("SUBTRACT", Math::Subtract), ("MULTIPLY", Math::Multiply), ("DIVIDE", Math::Divide),
    ("MULTIPLY_ADD", Math::MultiplyAdd), ("POWER", Math::Power), ("LOGARITHM", Math::Logarithm),
    ("SQRT", Math::Sqrt), ("INVERSE_SQRT", Math::InverseSqrt), ("ABSOLUTE", Math::Absolute),
    ("EXPONENT", Math::Exponent), ("MINIMUM", Math::Minimum), ("MAXIMUM", Math::Maximum),
    ("LESS_THAN", Math::LessThan), ("GREATER_THAN", Math::GreaterThan), ("SIGN", Math::Sign),
    ("COMPARE", Math::Compare), ("SMOOTH_MIN", Math::SmoothMinimum), ("SMOOTH_MAX", Math::SmoothMaximum),
    ("ROUND", Math::Round), ("FLOOR", Math::Floor), ("CEIL", Math::Ceil), ("TRUNC", Math::Truncate),
    ("FRACT", Math::Fraction), ("MODULO", Math::Modulo), ("FLOORED_MODULO", Math::FlooredModulo),
    ("WRAP", Math::Wrap), ("SNAP", Math::Snap), ("PINGPONG", Math::PingPong), ("SINE", Math::Sine),
    ("COSINE", Math::Cosine), ("TANGENT", Math::Tangent), ("ARCSINE", Math::Arcsine),
    ("ARCCOSINE", Math::Arccosine), ("ARCTANGENT", Math::Arctangent), ("ARCTAN2", Math::Arctangent2),
    ("SINH", Math::Sinh), ("COSH", Math::Cosh), ("TANH", Math::Tanh), ("RADIANS", Math::Radians),
    ("DEGREES", Math::Degrees),
];

/// Those of the Vector Math node that work place by place.
const VECTOR: &[(&str, Math)] = &[
    ("ADD", Math::Add),
    ("SUBTRACT", Math::Subtract),
    ("MULTIPLY", Math::Multiply),
    ("DIVIDE", Math::Divide),
    ("MULTIPLY_ADD", Math::MultiplyAdd),
    ("ABSOLUTE", Math::Absolute),
    ("POWER", Math::Power),
    ("SIGN", Math::Sign),
    ("MINIMUM", Math::Minimum),
    ("MAXIMUM", Math::Maximum),
    ("FLOOR", Math::Floor),
    ("CEIL", Math::Ceil),
    ("FRACTION", Math::Fraction),
    ("MODULO", Math::Modulo),
    ("WRAP", Math::Wrap),
    ("SNAP", Math::Snap),
    ("SINE", Math::Sine),
    ("COSINE", Math::Cosine),
    ("TANGENT", Math::Tangent),
];

fn find(table: &[(&str, Math)], name: &str) -> Option<Math> {
    table.iter().find(|(known, _)| *known == name).map(|(_, math)| *math)
}

/// Math.
pub fn math<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, _: &str) -> ValueId {
    let args: Vec<ValueId> = (0..at.node.inputs.len().min(3)).map(|i| flow.input_at(at, i)).collect();
    let operation = at.node.text("operation");
    let Some(math) = find(MATH, operation) else {
        flow.warn(format!(
            "the operation {operation} of the Math node \"{}\" is not supported; 0 is taken",
            at.node.name
        ));
        return flow.graph.number(0.0);
    };
    let value = flow.graph.math(math, &args);
    if at.node.flag("use_clamp") { flow.clamped(value) } else { value }
}

/// Vector Math.
pub fn vector_math<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, _: &str) -> ValueId {
    let a = flow.input(at, "Vector");
    let b = flow.input(at, "Vector_001");
    let c = flow.input(at, "Vector_002");
    let scale = flow.input(at, "Scale");
    let operation = at.node.text("operation");
    if let Some(math) = find(VECTOR, operation) {
        return flow.graph.math(math, &[a, b, c]);
    }
    let function = match operation {
        "CROSS_PRODUCT" => Function::Cross,
        "PROJECT" => Function::Project,
        "REFLECT" => Function::Reflect,
        "REFRACT" => return flow.graph.apply(Function::Refract, &[a, b, scale]),
        "FACEFORWARD" => Function::FaceForward,
        "DOT_PRODUCT" => Function::Dot(3),
        "DISTANCE" => Function::Distance,
        "LENGTH" => Function::Length(3),
        "SCALE" => return flow.graph.multiply(a, scale),
        "NORMALIZE" => Function::Normalize(3),
        _ => {
            let name = &at.node.name;
            flow.warn(format!(
                "the operation {operation} of the Vector Math node \"{name}\" is not supported; 0 is taken"
            ));
            return flow.graph.number(0.0);
        }
    };
    flow.graph.apply(function, &[a, b, c])
}

/// Map Range.
pub fn map_range<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, _: &str) -> ValueId {
    let vector = at.node.text("data_type") == "FLOAT_VECTOR";
    let names = if vector {
        ["Vector", "From_Min_FLOAT3", "From_Max_FLOAT3", "To_Min_FLOAT3", "To_Max_FLOAT3", "Steps_FLOAT3"]
    } else {
        ["Value", "From Min", "From Max", "To Min", "To Max", "Steps"]
    };
    let args = names.map(|name| flow.input(at, name));
    let range = match at.node.text("interpolation_type") {
        "STEPPED" => Range::Stepped,
        "SMOOTHSTEP" => Range::Smooth,
        "SMOOTHERSTEP" => Range::Smoother,
        _ => Range::Linear,
    };
    flow.graph.apply(Function::MapRange { range, clamp: at.node.flag("clamp"), vector }, &args)
}

/// Clamp.
pub fn clamp<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, _: &str) -> ValueId {
    let args = ["Value", "Min", "Max"].map(|name| flow.input(at, name));
    let math = if at.node.text("clamp_type") == "RANGE" { Math::ClampRange } else { Math::Clamp };
    flow.graph.math(math, &args)
}

/// Mix, of numbers, vectors and colors.
pub fn mix<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, _: &str) -> ValueId {
    let clamp_factor = at.node.flag("clamp_factor");
    let plain = Function::Mix { blend: Blend::Mix, clamp_factor, clamp_result: false };
    match at.node.text("data_type") {
        "RGBA" => {
            let args = ["Factor_Float", "A_Color", "B_Color"].map(|name| flow.input(at, name));
            let blend = flow.blend(at);
            let clamp_result = at.node.flag("clamp_result");
            flow.graph.apply(Function::Mix { blend, clamp_factor, clamp_result }, &args)
        }
        "VECTOR" => {
            let factor = if at.node.text("factor_mode") == "NON_UNIFORM" { "Factor_Vector" } else { "Factor_Float" };
            let args = [factor, "A_Vector", "B_Vector"].map(|name| flow.input(at, name));
            flow.graph.apply(plain, &args)
        }
        _ => {
            let args = ["Factor_Float", "A_Float", "B_Float"].map(|name| flow.input(at, name));
            flow.graph.apply(plain, &args)
        }
    }
}

/// Float Curve.
pub fn float_curve<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, _: &str) -> ValueId {
    let (factor, value) = (flow.input(at, "Factor"), flow.input(at, "Value"));
    let Some(table) = tables::curves(at.node, &[0]) else { return value };
    let looked_up = flow.graph.apply(Function::Table(Arc::new(table)), &[value]);
    flow.graph.mix(value, looked_up, factor)
}

/// Squeeze: a logistic curve.
pub fn squeeze<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, _: &str) -> ValueId {
    let [value, width, center] = ["Value", "Width", "Center"].map(|name| flow.input(at, name));
    let from_center = flow.graph.subtract(value, center);
    let scaled = flow.graph.multiply(from_center, width);
    let back = flow.graph.scale(scaled, -1.0);
    let power = flow.graph.math(Math::Exponent, &[back]);
    let one = flow.graph.number(1.0);
    let below = flow.graph.add(power, one);
    flow.graph.math(Math::Divide, &[one, below])
}

/// Combine XYZ.
pub fn combine_xyz<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, _: &str) -> ValueId {
    let [x, y, z] = ["X", "Y", "Z"].map(|name| flow.input(at, name));
    flow.graph.combine(x, y, z)
}

/// Separate XYZ.
pub fn separate_xyz<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, output: &str) -> ValueId {
    let vector = flow.input(at, "Vector");
    flow.graph.place(vector, place(output, ["X", "Y", "Z"]))
}

/// Which of three an output is.
pub fn place(output: &str, names: [&str; 3]) -> u8 {
    names.iter().position(|name| *name == output).unwrap_or(0) as u8
}

impl<'a> Flow<'a, '_> {
    /// A value within 0 to 1.
    pub fn clamped(&mut self, value: ValueId) -> ValueId {
        let (zero, one) = (self.graph.number(0.0), self.graph.number(1.0));
        self.graph.math(Math::Clamp, &[value, zero, one])
    }

    /// How a mix node puts its colors together.
    pub fn blend(&mut self, at: At<'a>) -> Blend {
        match at.node.text("blend_type") {
            "MIX" | "" => Blend::Mix,
            "DARKEN" => Blend::Darken,
            "MULTIPLY" => Blend::Multiply,
            "BURN" => Blend::Burn,
            "LIGHTEN" => Blend::Lighten,
            "SCREEN" => Blend::Screen,
            "DODGE" => Blend::Dodge,
            "ADD" => Blend::Add,
            "OVERLAY" => Blend::Overlay,
            "SOFT_LIGHT" => Blend::SoftLight,
            "LINEAR_LIGHT" => Blend::LinearLight,
            "DIFFERENCE" => Blend::Difference,
            "EXCLUSION" => Blend::Exclusion,
            "SUBTRACT" => Blend::Subtract,
            "DIVIDE" => Blend::Divide,
            "HUE" => Blend::Hue,
            "SATURATION" => Blend::Saturation,
            "COLOR" => Blend::Color,
            "VALUE" => Blend::Value,
            other => {
                self.warn(format!("the blend mode {other} is not supported; a plain mix is taken"));
                Blend::Mix
            }
        }
    }
}
