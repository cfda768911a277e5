//! A field whose values come from a function of the caller.

use std::ffi::c_void;

use isostudy_extract::{Aabb, Bound, ScalarField};

/// As [`IsostudyField::sample`], where cbindgen sees no name.
type Sample = unsafe extern "C" fn(user: *mut c_void, x: f32, y: f32, z: f32) -> f32;

/// As [`IsostudyField::range`].
type Range = unsafe extern "C" fn(
    user: *mut c_void,
    min: *const f32,
    max: *const f32,
    least: *mut f32,
    greatest: *mut f32,
) -> bool;

/// A field by functions of the caller. They are called on the thread that extracts, and must not unwind.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct IsostudyField {
    /// The value at a point: above the isovalue is inside. The same point has the same value each time.
    pub sample: Option<unsafe extern "C" fn(user: *mut c_void, x: f32, y: f32, z: f32) -> f32>,
    /// The least and the greatest value in the box from `min` to `max`, three numbers each, and true; or false where they are not known. It
    /// may be null. It saves most calls of `sample`. A range that does not hold makes holes.
    pub range: Option<
        unsafe extern "C" fn(
            user: *mut c_void,
            min: *const f32,
            max: *const f32,
            least: *mut f32,
            greatest: *mut f32,
        ) -> bool,
    >,
    /// Given to both functions.
    pub user: *mut c_void,
}

/// The same, checked.
pub(crate) struct Called {
    sample: Sample,
    range: Option<Range>,
    user: *mut c_void,
}

// SAFETY: a field must be usable from several threads. This one never is: all functions of this crate extract by `Control::default()`, which
// is the calling thread and no other, and `Called` does not leave the crate.
unsafe impl Sync for Called {}

impl Called {
    /// `None` without a function for values.
    pub(crate) fn new(field: &IsostudyField) -> Option<Self> {
        Some(Self { sample: field.sample?, range: field.range, user: field.user })
    }
}

impl ScalarField for Called {
    fn sample(&self, [x, y, z]: [f32; 3]) -> f32 {
        // SAFETY: who gave the field promises that the function takes its `user`.
        unsafe { (self.sample)(self.user, x, y, z) }
    }

    fn bound(&self, bounds: Aabb) -> Bound {
        let Some(range) = self.range else { return Bound::UNKNOWN };
        let (mut least, mut greatest) = (f32::NAN, f32::NAN);
        // SAFETY: as above; the pointers lead to three numbers and to one that live until the call returns.
        let is_known =
            unsafe { range(self.user, bounds.min.as_ptr(), bounds.max.as_ptr(), &mut least, &mut greatest) };
        if is_known && least <= greatest { Bound::range(least, greatest) } else { Bound::UNKNOWN }
    }
}
