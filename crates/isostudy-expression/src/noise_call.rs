//! Noise in a formula.
//!
//! fidget's graph takes no functions from outside. A call is a variable of its own there; its three arguments are a graph
//! as well, evaluated before.

use fidget_core::Context;
use fidget_core::context::Node;
use fidget_core::types::Grad;
use fidget_core::var::Var;
use glam::DVec3;
use isostudy_field::{Fractal, MOST_OCTAVES, NoiseShape};

use crate::ExpressionError;

/// Amplitude ratio of an octave to the one before.
const GAIN: f64 = 0.5;
/// How many points are worked on at a time.
const PART: usize = 64;
/// Up to here every whole number is one in single precision.
const MOST_SEED: f32 = 16_777_215.0;

/// Functions of x, y and z, and of octaves but for the first.
pub(crate) const NOISES: [(&str, NoiseShape); 4] = [
    ("noise", NoiseShape::Plain),
    ("fbm", NoiseShape::Plain),
    ("ridged", NoiseShape::Ridged),
    ("billowed", NoiseShape::Billowed),
];

/// One of them with its arguments.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct NoiseCall {
    /// What stands for its value in the graph.
    pub(crate) variable: Var,
    pub(crate) arguments: [Node; 3],
    pub(crate) noise: Fractal,
}

/// The value of a call; it joins `calls` if it is new there. `None` if the number of arguments is wrong.
pub(crate) fn call(
    (name, shape): (&str, NoiseShape),
    arguments: &[(Node, usize)],
    context: &mut Context,
    calls: &mut Vec<NoiseCall>,
) -> Result<Option<Node>, ExpressionError> {
    let settings = usize::from(name != "noise");
    let (&[(x, _), (y, _), (z, _)], rest) = match arguments.split_first_chunk::<3>() {
        Some(split) if (settings..=settings + 1).contains(&split.1.len()) => split,
        _ => return Ok(None),
    };
    let octaves = match rest.first().filter(|_| settings > 0) {
        Some(&argument) => {
            let wanted = ("the number of octaves", "a whole number from 1 to 16");
            whole(argument, 1.0..=MOST_OCTAVES as f32, name, wanted, context)?
        }
        None => 1,
    };
    let seed = match rest.get(settings) {
        Some(&argument) => {
            let wanted = ("the seed", "a whole number from 0 to 16777215");
            whole(argument, 0.0..=MOST_SEED, name, wanted, context)?
        }
        None => 0,
    };
    let noise = Fractal::new(shape, octaves, GAIN, seed);
    let arguments = [x, y, z];
    if let [Ok(x), Ok(y), Ok(z)] = arguments.map(|node| context.get_const(node)) {
        return Ok(Some(context.constant(value(&noise, [x, y, z]))));
    }
    let known = calls.iter().find(|call| call.arguments == arguments && call.noise == noise);
    let variable = known.map_or_else(Var::new, |call| call.variable);
    if known.is_none() {
        calls.push(NoiseCall { variable, arguments, noise });
    }
    Ok(Some(context.var(variable)))
}

/// Noise at a point, as a formula sees it.
pub(crate) fn value(noise: &Fractal, [x, y, z]: [f32; 3]) -> f32 {
    noise.value([x, y, z].map(f64::from).into()) as f32
}

/// The same at many points, in place of what `found` has.
pub(crate) fn values(noise: &Fractal, places: [&[f32]; 3], found: &mut Vec<f32>) {
    found.clear();
    // One point has no neighbour to share work with.
    if let [[x], [y], [z]] = places {
        found.push(value(noise, [*x, *y, *z]));
        return;
    }
    let (mut of_part, mut values) = ([[0.0; PART]; 3], [0.0; PART]);
    for first in (0..places[0].len()).step_by(PART) {
        let count = PART.min(places[0].len() - first);
        for (to, from) in of_part.iter_mut().zip(places) {
            for (to, from) in to.iter_mut().zip(&from[first..first + count]) {
                *to = f64::from(*from);
            }
        }
        noise.values(of_part.each_ref().map(|along| &along[..count]), &mut values[..count]);
        found.extend(values[..count].iter().map(|value| *value as f32));
    }
}

/// The same with its changes along the axes, from those of its arguments.
pub(crate) fn derivative(noise: &Fractal, arguments: [Grad; 3]) -> Grad {
    let (value, gradient) = noise.value_and_gradient(arguments.map(|argument| f64::from(argument.v)).into());
    let along = |part: fn(&Grad) -> f32| {
        gradient.dot(DVec3::from_array([0, 1, 2].map(|axis| f64::from(part(&arguments[axis]))))) as f32
    };
    Grad::new(value as f32, along(|g| g.dx), along(|g| g.dy), along(|g| g.dz))
}

fn whole(
    (node, column): (Node, usize),
    allowed: std::ops::RangeInclusive<f32>,
    name: &str,
    (what, wanted): (&'static str, &'static str),
    context: &Context,
) -> Result<u32, ExpressionError> {
    let found = match context.get_const(node) {
        Ok(value) if value.fract() == 0.0 && allowed.contains(&value) => return Ok(value as u32),
        Ok(value) => value.to_string(),
        Err(_) => "a formula in x, y or z".to_owned(),
    };
    Err(ExpressionError::Setting { column, name: name.to_owned(), what, wanted, found })
}
