//! Scalar fields from formulas in x, y and z, such as `sqrt(x^2+y^2+z^2) - 1`.
//!
//! ```
//! use isostudy_expression::Expression;
//! use isostudy_extract::by_lattice::{ExtractSettings, Lattice, extract};
//! use isostudy_extract::{Arrangement, Execution};
//! use isostudy_field::Negated;
//! use isostudy_mesh::{Bounds, glam::Vec3};
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
//! | gradient noise | `noise(x, y, z)`, `fbm(x, y, z, octaves)`, `ridged(x, y, z, octaves)`, `billowed(x, y, z, octaves)`; each with a seed as last argument if wanted |
//!
//! `mod` and `%` have the sign of a positive divisor. `a^b` with a whole number for `b` up to 64 is a product; otherwise
//! it is `exp(b ln(a))`, which is no number for a negative `a`.
//!
//! Noise has features of about one unit and is 0 at whole-number points: `noise(x*4, y*4, 0)` has four in a unit, and the same
//! at all heights. The values are those of [`isostudy_field::Fractal`] with gain 0.5, rounded to single precision: `noise` and
//! `fbm` lie in -1 to 1, `ridged` and `billowed` in 0 to 1. `octaves` is a whole number from 1 to 16, the seed one from 0
//! to 16777215, 0 if left out; both are the same everywhere. Noise may stand in the arguments of noise.
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
//! - Noise is the same on every machine, to the bit, and so is a formula of noise, `+ - * /`, `sqrt`, `abs`, `min` and `max`.
//!   The bounds of a box take the noise's own in the box of its arguments.
//!
//! # Not guaranteed
//!
//! - fidget simplifies what has variables: 0 times anything and 0 divided by anything is 0, `0 * (1/x)` and `0 / x` even
//!   where x is 0; `0 + v`, `v - 0`, `1 * v` and `v / 1` are `v`. `x/x` and `x - x` are not simplified.
//! - `sin`, `cos`, `tan`, their inverses, `exp` and `ln` are those of the platform, so the last bit, and with it the
//!   mesh's, may differ from machine to machine; not from thread to thread.

mod error;
mod functions;
mod interval;
mod noise_call;
mod parser;
mod range;
mod stage;
mod token;

use std::cell::RefCell;
use std::fmt;
use std::str::FromStr;

use fidget_core::Context;
use fidget_core::types::Grad;
use fidget_core::var::Var;
use glam::Vec3;
use isostudy_field::{Fractal, StudyField};
use isostudy_mesh::Bounds;

pub use error::ExpressionError;

use crate::range::RangeTape;
use crate::stage::{Evaluator, Stage};

/// A formula in x, y and z, ready to be evaluated. Made by [`str::parse`]; the front page says what may be written.
#[derive(Clone)]
pub struct Expression {
    text: String,
    /// Each with its arguments, inner ones first; `None` where the value does not depend on it.
    noises: Vec<Option<(Stage, Fractal)>>,
    value: Stage,
    range: RangeTape,
}

impl FromStr for Expression {
    type Err = ExpressionError;

    fn from_str(text: &str) -> Result<Self, ExpressionError> {
        let mut context = Context::new();
        let (root, calls) = parser::parse(text, &mut context)?;
        if let Ok(value) = context.get_const(root) {
            return Err(ExpressionError::Constant { value });
        }
        let variables: Vec<Var> =
            [Var::X, Var::Y, Var::Z].into_iter().chain(calls.iter().map(|call| call.variable)).collect();
        let value = Stage::new(&context, &[root], &variables)?;
        let mut noises: Vec<Option<(Stage, Fractal)>> = vec![None; calls.len()];
        for (i, call) in calls.iter().enumerate().rev() {
            let outer = noises[i + 1..].iter().flatten().map(|(arguments, _)| arguments);
            if outer.chain([&value]).any(|stage| stage.needs(3 + i)) {
                noises[i] = Some((Stage::new(&context, &call.arguments, &variables)?, call.noise));
            }
        }
        let range = RangeTape::new(&context, root, &calls);
        Ok(Self { text: text.to_owned(), noises, value, range })
    }
}

impl Expression {
    /// The values where `fill` puts columns of x, y and z.
    fn sample_columns(&self, values: &mut [f32], fill: impl FnOnce(&mut [Vec<f32>])) {
        WORKSPACE.with_borrow_mut(|Workspace { evaluator, columns }| {
            let count = 3 + self.noises.len();
            columns.resize_with(columns.len().max(count), Vec::new);
            columns[..3].iter_mut().for_each(Vec::clear);
            fill(&mut columns[..3]);
            for (i, noise) in self.noises.iter().enumerate() {
                let Some((arguments, noise)) = noise else { continue };
                let found = arguments.eval(columns, evaluator);
                let places = [0, 1, 2].map(|axis| &found[axis][..values.len()]);
                noise_call::values(noise, places, &mut columns[3 + i]);
            }
            values.copy_from_slice(&self.value.eval(columns, evaluator)[0]);
        });
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
    evaluator: Evaluator,
    /// x, y, z, and the values of noise.
    columns: Vec<Vec<f32>>,
}

thread_local! {
    static WORKSPACE: RefCell<Workspace> = RefCell::default();
}

impl StudyField for Expression {
    fn sample(&self, p: Vec3) -> f32 {
        let mut value = [0.0];
        self.sample_row(&[p.x], p.y, p.z, &mut value);
        value[0]
    }

    fn sample_row(&self, x: &[f32], y: f32, z: f32, values: &mut [f32]) {
        self.sample_columns(values, |columns| {
            columns[0].extend_from_slice(x);
            columns[1].resize(x.len(), y);
            columns[2].resize(x.len(), z);
        });
    }

    fn sample_near(&self, points: &[Vec3], values: &mut [f32], _before: Option<(Vec3, f32)>) {
        self.sample_columns(values, |columns| {
            for (axis, column) in columns.iter_mut().enumerate() {
                column.extend(points.iter().map(|p| p[axis]));
            }
        });
    }

    /// By automatic differentiation, exact but for rounding. Where `min`, `max` or `abs` have an edge, or noise a crest, it is that of one
    /// side.
    fn gradient(&self, p: Vec3) -> Option<Vec3> {
        WORKSPACE.with_borrow_mut(|Workspace { evaluator, .. }| {
            let mut columns: Vec<Grad> = Vec::with_capacity(3 + self.noises.len());
            columns.extend([0, 1, 2].map(|axis| {
                let along = Vec3::AXES[axis];
                Grad::new(p[axis], along.x, along.y, along.z)
            }));
            for noise in &self.noises {
                let value = noise.as_ref().map(|(arguments, noise)| {
                    let found = arguments.differentiate(&columns, evaluator);
                    noise_call::derivative(noise, [found[0][0], found[1][0], found[2][0]])
                });
                columns.push(value.unwrap_or_default());
            }
            let value = self.value.differentiate(&columns, evaluator)[0][0];
            Some(Vec3::new(value.dx, value.dy, value.dz))
        })
    }

    /// By interval arithmetic.
    fn range(&self, bounds: Bounds, _value: f32) -> Option<(f32, f32)> {
        self.range.of(bounds)
    }
}
