//! Scalar fields from formulas in x, y and z, such as `sqrt(x^2+y^2+z^2) - 1`.
//!
//! ```
//! use expression::Expression;
//! use extract::{Arrangement, Execution, ExtractSettings, Lattice, extract};
//! use field::Negated;
//! use mesh::{Bounds, glam::Vec3};
//!
//! // Negative inside, as distances mostly are: turned round, with the isovalue.
//! let ball = Negated("sqrt(x^2 + y^2 + z^2) - 1".parse::<Expression>()?);
//! let bounds = Bounds { min: Vec3::splat(-1.2), max: Vec3::splat(1.2) };
//! let lattice = Lattice::try_new(Arrangement::BodyCentred, bounds, 0.1)?;
//! let surface = extract(&ball, &lattice, &ExtractSettings::default(), &Execution::default())?.mesh;
//! assert!((surface.volume() - 4.18879).abs() < 0.03);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # What may be written
//!
//! | | |
//! |---|---|
//! | variables, constants | `x` `y` `z`, numbers (`2`, `.5`, `1e-3`), `pi`, `tau`, `e` |
//! | operators, the loosest first | `+ -`, `* / %`, `-a`, `a^b` (from the right, so `-x^2` is `-(x^2)`) |
//! | one argument | `sqrt cbrt abs exp ln sin cos tan asin acos atan floor ceil round sign square` |
//! | two | `atan2(y, x)`, `mod(a, b)`, `pow(a, b)` |
//! | three | `clamp(v, low, high)`, `mix(a, b, t)` |
//! | one or more | `min max length` |
//!
//! `mod` and `%` have the sign of a positive divisor. `a^b` with a whole number for `b` up to 64 is a product; otherwise
//! it is `exp(b ln(a))`, which is no number for a negative `a`.
//!
//! # Guaranteed
//!
//! - Text that cannot be read is an [`ExpressionError`] with its column. Nothing panics, and no nesting overflows the
//!   stack: 200 levels are the limit.
//! - Values are computed in single precision by fidget's evaluator. Division by zero, roots and logarithms of negative
//!   numbers mean what IEEE 754 says: infinity, or `NaN`, which an extraction takes for outside. So do parts of a formula
//!   that have no variable: `0/0` is no number, and neither is a sum, difference, product or quotient with it.
//! - Interval arithmetic bounds the values in a box, rounding included, so that blocks without surface are never sampled.
//!   Where a formula is not a number in a box, nothing is known there, and all samples are taken.
//!
//! # Not guaranteed
//!
//! - fidget simplifies what has variables: 0 times anything and 0 divided by anything is 0, `0 * (1/x)` and `0 / x` even
//!   where x is 0; `0 + v`, `v - 0`, `1 * v` and `v / 1` are `v`. `x/x` and `x - x` are not simplified.
//! - `sin`, `cos`, `tan`, their inverses, `exp` and `ln` are those of the platform, so the last bit, and with it the
//!   mesh's, may differ from machine to machine; not from thread to thread.

mod error;
mod interval;
mod parser;
mod range;
mod token;

use std::cell::RefCell;
use std::fmt;
use std::str::FromStr;

use fidget_core::Context;
use fidget_core::eval::{BulkEvaluator, Function, MathFunction, Tape};
use fidget_core::var::Var;
use fidget_core::vm::{GenericVmTape, VmFloatSliceEval, VmFunction};
use field::ScalarField;
use glam::Vec3;
use mesh::Bounds;

pub use error::ExpressionError;

use crate::range::RangeTape;

/// A formula in x, y and z, ready to be evaluated. Made by [`str::parse`]; the front page says what may be written.
#[derive(Clone)]
pub struct Expression {
    text: String,
    tape: GenericVmTape<255>,
    /// Which coordinate each of the tape's inputs is.
    inputs: Vec<usize>,
    range: RangeTape,
}

impl FromStr for Expression {
    type Err = ExpressionError;

    fn from_str(text: &str) -> Result<Self, ExpressionError> {
        let mut context = Context::new();
        let root = parser::parse(text, &mut context)?;
        if let Ok(value) = context.get_const(root) {
            return Err(ExpressionError::Constant { value });
        }
        let function = VmFunction::new(&context, &[root]).map_err(|_| ExpressionError::TooComplex)?;
        let tape = function.float_slice_tape(Default::default());
        let mut inputs = vec![0; tape.vars().len()];
        for (axis, variable) in [Var::X, Var::Y, Var::Z].iter().enumerate() {
            if let Some(input) = tape.vars().get(variable) {
                inputs[input] = axis;
            }
        }
        let range = RangeTape::new(&context, root);
        Ok(Self { text: text.to_owned(), tape, inputs, range })
    }
}

impl fmt::Debug for Expression {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Expression").field(&self.text).finish()
    }
}

impl fmt::Display for Expression {
    /// As it was written.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

/// What a thread evaluates with, so that no sample allocates.
#[derive(Default)]
struct Workspace {
    evaluator: VmFloatSliceEval<255>,
    coordinates: [Vec<f32>; 3],
}

thread_local! {
    static WORKSPACE: RefCell<Workspace> = RefCell::default();
}

impl ScalarField for Expression {
    fn sample(&self, p: Vec3) -> f32 {
        let mut value = [0.0];
        self.sample_row(&[p.x], p.y, p.z, &mut value);
        value[0]
    }

    fn sample_row(&self, x: &[f32], y: f32, z: f32, values: &mut [f32]) {
        WORKSPACE.with_borrow_mut(|Workspace { evaluator, coordinates }| {
            coordinates[0].clear();
            coordinates[0].extend_from_slice(x);
            for (axis, value) in [(1, y), (2, z)] {
                coordinates[axis].clear();
                coordinates[axis].resize(x.len(), value);
            }
            let inputs: [&[f32]; 3] =
                std::array::from_fn(|k| self.inputs.get(k).map_or(&[][..], |&axis| &coordinates[axis][..]));
            let found = evaluator.eval(&self.tape, &inputs[..self.inputs.len()]);
            values.copy_from_slice(&found.expect("one value a variable and point")[0]);
        });
    }

    /// By interval arithmetic.
    fn range(&self, bounds: Bounds, _value: f32) -> Option<(f32, f32)> {
        self.range.of(bounds)
    }
}
