//! Formulas, from outside.

mod formulas;
mod gradients;
mod noise;
