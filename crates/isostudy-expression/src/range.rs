//! The range of a formula in a box: its graph, evaluated with intervals.

use std::collections::HashMap;

use fidget_core::Context;
use fidget_core::context::{BinaryOpcode, Node, Op, UnaryOpcode};
use fidget_core::var::Var;
use glam::DVec3;
use isostudy_field::Fractal;
use isostudy_mesh::Bounds;

use crate::interval::{Interval, Known};
use crate::noise_call::NoiseCall;

/// The operations of a graph in an order in which each comes after its arguments, which are given by their places.
#[derive(Debug, Clone)]
pub(crate) struct RangeTape {
    steps: Vec<Step>,
    noises: Vec<Fractal>,
}

#[derive(Debug, Clone, Copy)]
enum Step {
    /// x, y or z.
    Axis(usize),
    Constant(f32),
    Unary(UnaryOpcode, usize),
    Binary(BinaryOpcode, usize, usize),
    /// Which noise, and its arguments.
    Noise(usize, [usize; 3]),
    /// Something of which nothing is known.
    Unknown,
}

impl RangeTape {
    pub(crate) fn new(context: &Context, root: Node, calls: &[NoiseCall]) -> Self {
        let mut steps = Vec::new();
        let mut places = HashMap::new();
        // Without recursion, since a sum of many terms is as deep as it is long.
        let mut waiting = vec![root];
        let numbers: HashMap<Var, usize> =
            calls.iter().enumerate().map(|(number, call)| (call.variable, number)).collect();
        while let Some(&node) = waiting.last() {
            let place = |node: Node| places.get(&node).copied();
            let step = match context.get_op(node).copied() {
                _ if place(node).is_some() => None,
                Some(Op::Const(value)) => Some(Step::Constant(value.0)),
                Some(Op::Input(Var::X)) => Some(Step::Axis(0)),
                Some(Op::Input(Var::Y)) => Some(Step::Axis(1)),
                Some(Op::Input(Var::Z)) => Some(Step::Axis(2)),
                Some(Op::Input(variable)) => match numbers.get(&variable) {
                    Some(&number) => {
                        let arguments = calls[number].arguments;
                        let missing = arguments.into_iter().filter(|&node| place(node).is_none());
                        let before = waiting.len();
                        waiting.extend(missing);
                        if waiting.len() > before {
                            continue;
                        }
                        Some(Step::Noise(number, arguments.map(|node| places[&node])))
                    }
                    None => Some(Step::Unknown),
                },
                Some(Op::Unary(op, a)) => match place(a) {
                    Some(at) => Some(Step::Unary(op, at)),
                    None => {
                        waiting.push(a);
                        continue;
                    }
                },
                Some(Op::Binary(op, a, b)) => match (place(a), place(b)) {
                    (Some(a), Some(b)) => Some(Step::Binary(op, a, b)),
                    (a_place, b_place) => {
                        waiting.extend(
                            [(a, a_place), (b, b_place)].iter().filter(|n| n.1.is_none()).map(|n| n.0),
                        );
                        continue;
                    }
                },
                _ => Some(Step::Unknown),
            };
            waiting.pop();
            if let Some(step) = step {
                places.insert(node, steps.len());
                steps.push(step);
            }
        }
        Self { steps, noises: calls.iter().map(|call| call.noise).collect() }
    }

    pub(crate) fn of(&self, bounds: Bounds) -> Option<(f32, f32)> {
        let mut values: Vec<Known> = Vec::with_capacity(self.steps.len());
        for step in &self.steps {
            let value = match *step {
                Step::Axis(axis) => {
                    let (low, high) = (f64::from(bounds.min[axis]), f64::from(bounds.max[axis]));
                    (low <= high).then(|| Interval::new(low, high))
                }
                Step::Constant(value) => (!value.is_nan()).then(|| Interval::new(value.into(), value.into())),
                Step::Unary(op, a) => values[a].and_then(|a| unary(op, a)),
                Step::Binary(op, a, b) => values[a].zip(values[b]).and_then(|(a, b)| binary(op, a, b)),
                Step::Noise(number, arguments) => {
                    let [x, y, z] = arguments.map(|at| values[at]);
                    x.zip(y).zip(z).and_then(|((x, y), z)| noise(&self.noises[number], [x, y, z]))
                }
                Step::Unknown => None,
            };
            values.push(value);
        }
        let Interval { low, high } = values.pop()??;
        // To the nearest is inward by at most half of what was added last, but for the axes themselves, which are exact.
        Some((low as f32, high as f32))
    }
}

/// At infinity noise is no number.
fn noise(noise: &Fractal, arguments: [Interval; 3]) -> Known {
    if !arguments.iter().all(|argument| argument.is_finite()) {
        return None;
    }
    let low = DVec3::from(arguments.map(|argument| argument.low));
    let (low, high) = noise.range(low, DVec3::from(arguments.map(|argument| argument.high)));
    Interval::rounded(low, high)
}

fn unary(op: UnaryOpcode, a: Interval) -> Known {
    match op {
        UnaryOpcode::Neg => a.neg(),
        UnaryOpcode::Abs => Some(a.abs()),
        UnaryOpcode::Recip => Interval::new(1.0, 1.0).div(a),
        UnaryOpcode::Sqrt => a.sqrt(),
        UnaryOpcode::Square => a.square(),
        UnaryOpcode::Floor => a.stepped(f64::floor),
        UnaryOpcode::Ceil => a.stepped(f64::ceil),
        UnaryOpcode::Round => a.stepped(f64::round),
        UnaryOpcode::Sin => a.sin(),
        UnaryOpcode::Cos => a.cos(),
        UnaryOpcode::Tan => a.tan(),
        UnaryOpcode::Asin => a.asin(),
        UnaryOpcode::Acos => a.acos(),
        UnaryOpcode::Atan => a.atan(),
        UnaryOpcode::Exp => a.exp(),
        UnaryOpcode::Ln => a.ln(),
        UnaryOpcode::Not | UnaryOpcode::Rand => None,
    }
}

fn binary(op: BinaryOpcode, a: Interval, b: Interval) -> Known {
    match op {
        BinaryOpcode::Add => a.add(b),
        BinaryOpcode::Sub => a.add(b.neg()?),
        BinaryOpcode::Mul => a.mul(b),
        BinaryOpcode::Div => a.div(b),
        BinaryOpcode::Atan => a.atan2(b),
        BinaryOpcode::Min => Some(a.min(b)),
        BinaryOpcode::Max => Some(a.max(b)),
        BinaryOpcode::Compare => a.compare(b),
        BinaryOpcode::Mod => a.modulo(b),
        BinaryOpcode::And | BinaryOpcode::Or | BinaryOpcode::Mix => None,
    }
}
