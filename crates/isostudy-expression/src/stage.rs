//! A part of a formula that fidget evaluates in one go.

use fidget_core::Context;
use fidget_core::context::Node;
use fidget_core::eval::{BulkEvaluator, BulkOutput, Function, MathFunction, Tape};
use fidget_core::types::Grad;
use fidget_core::var::Var;
use fidget_core::vm::{GenericVmTape, VmFloatSliceEval, VmFunction, VmGradSliceEval};

use crate::ExpressionError;

/// Some values at many points, from columns of values: x, y, z, and those of the calls of noise.
#[derive(Clone)]
pub(crate) struct Stage {
    tape: GenericVmTape<255>,
    /// The same, for values with their derivatives.
    derivatives: GenericVmTape<255>,
    /// Which column each of the tape's inputs is.
    inputs: Vec<usize>,
}

/// What a thread evaluates with, so that no sample allocates.
#[derive(Default)]
pub(crate) struct Evaluator {
    evaluator: VmFloatSliceEval<255>,
    derivatives: VmGradSliceEval<255>,
    /// The columns in the order of a tape's inputs, while it is evaluated.
    inputs: Vec<Vec<f32>>,
}

impl Stage {
    /// `variables` are those of the columns.
    pub(crate) fn new(context: &Context, nodes: &[Node], variables: &[Var]) -> Result<Self, ExpressionError> {
        let function = VmFunction::new(context, nodes).map_err(|_| ExpressionError::TooComplex)?;
        let tape = function.float_slice_tape(Default::default());
        let mut inputs = vec![0; tape.vars().len()];
        for (column, variable) in variables.iter().enumerate() {
            if let Some(input) = tape.vars().get(variable) {
                inputs[input] = column;
            }
        }
        Ok(Self { tape, derivatives: function.grad_slice_tape(Default::default()), inputs })
    }

    /// The values at a point with their changes along x, y and z, by automatic differentiation: from those of the columns.
    pub(crate) fn differentiate<'a>(
        &self,
        columns: &[Grad],
        Evaluator { derivatives, .. }: &'a mut Evaluator,
    ) -> BulkOutput<'a, Grad> {
        let inputs: Vec<Vec<Grad>> = self.inputs.iter().map(|&column| vec![columns[column]]).collect();
        derivatives.eval(&self.derivatives, &inputs).expect("one value a variable and point")
    }

    pub(crate) fn needs(&self, column: usize) -> bool {
        self.inputs.contains(&column)
    }

    /// The columns are all equally long.
    pub(crate) fn eval<'a>(
        &self,
        columns: &mut [Vec<f32>],
        Evaluator { evaluator, inputs, .. }: &'a mut Evaluator,
    ) -> BulkOutput<'a, f32> {
        let inputs = {
            inputs.resize_with(inputs.len().max(self.inputs.len()), Vec::new);
            &mut inputs[..self.inputs.len()]
        };
        for (input, &column) in inputs.iter_mut().zip(&self.inputs) {
            std::mem::swap(input, &mut columns[column]);
        }
        let found = evaluator.eval(&self.tape, inputs);
        for (input, &column) in inputs.iter_mut().zip(&self.inputs) {
            std::mem::swap(input, &mut columns[column]);
        }
        found.expect("one value a variable and point")
    }
}
