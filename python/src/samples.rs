//! The samples of an array, where they are.

use numpy::{PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::PyResult;
use pyo3::exceptions::PyValueError;

/// An array of three axes in C order as a volume: the array's last axis is the first of the volume, the fastest one in memory.
pub(crate) struct Volume<'a> {
    /// Samples along the volume's axes.
    pub(crate) counts: [usize; 3],
    pub(crate) values: &'a [f32],
}

impl<'a> Volume<'a> {
    /// # Errors
    /// `ValueError` unless the array has three axes, in C order.
    pub(crate) fn try_new(array: &'a PyReadonlyArrayDyn<'_, f32>) -> PyResult<Self> {
        let &[x, y, z] = array.shape() else {
            let axes = array.shape().len();
            return Err(PyValueError::new_err(format!("an array of {axes} axes: a volume has three")));
        };
        let values = if array.is_c_contiguous() { array.as_slice().ok() } else { None };
        let values = values.ok_or_else(|| PyValueError::new_err("the samples are not in C order"))?;
        Ok(Self { counts: [z, y, x], values })
    }
}

/// From one sample to the next along each of a volume's axes, where those of the array have this spacing.
pub(crate) fn steps([x, y, z]: [f64; 3]) -> [[f64; 3]; 3] {
    [[0.0, 0.0, z], [0.0, y, 0.0], [x, 0.0, 0.0]]
}
