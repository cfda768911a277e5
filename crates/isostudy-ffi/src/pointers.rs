//! Pointers of another language as references, or an error that names the argument.

use std::ffi::{CStr, c_char};

use isostudy_extract::{Method, presets};

use crate::status::Failure;

/// # Safety
/// `pointer` is null, or leads to a `T` that nobody else uses until the reference is gone.
pub(crate) unsafe fn object<'a, T>(pointer: *mut T, name: &str) -> Result<&'a mut T, Failure> {
    // SAFETY: the caller's promise.
    unsafe { pointer.as_mut() }.ok_or_else(|| Failure::argument(format!("{name} is null")))
}

/// # Safety
/// `pointer` is null, or leads to a `T` that nobody changes until the reference is gone.
pub(crate) unsafe fn value<'a, T>(pointer: *const T, name: &str) -> Result<&'a T, Failure> {
    // SAFETY: the caller's promise.
    unsafe { pointer.as_ref() }.ok_or_else(|| Failure::argument(format!("{name} is null")))
}

/// # Safety
/// `pointer` is null, or leads to `count` numbers that nobody changes until the slice is gone.
pub(crate) unsafe fn numbers<'a>(
    pointer: *const f32,
    count: usize,
    name: &str,
) -> Result<&'a [f32], Failure> {
    if pointer.is_null() {
        return Err(Failure::argument(format!("{name} is null")));
    }
    if count > isize::MAX as usize / size_of::<f32>() || !pointer.is_aligned() {
        return Err(Failure::argument(format!("{name} are not an array of {count} numbers")));
    }
    // SAFETY: not null, aligned and within the address space; the rest is the caller's promise.
    Ok(unsafe { std::slice::from_raw_parts(pointer, count) })
}

/// The method of a name, such as `mc33`.
///
/// # Safety
/// `pointer` is null, or leads to text that ends with a zero.
pub(crate) unsafe fn method(pointer: *const c_char) -> Result<Method, Failure> {
    if pointer.is_null() {
        return Err(Failure::argument("method is null"));
    }
    // SAFETY: the caller's promise.
    let name = unsafe { CStr::from_ptr(pointer) }.to_string_lossy();
    let found = presets().iter().find(|preset| preset.id == name);
    found.map(|preset| preset.method).ok_or_else(|| {
        let all: Vec<&str> = presets().iter().map(|preset| preset.id).collect();
        Failure::argument(format!("there is no method {:?}; there are {}", name, all.join(", ")))
    })
}
