//! How a call ended, and why.

use std::cell::RefCell;
use std::ffi::{CString, c_char};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// How a call ended.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum IsostudyStatus {
    /// Done.
    Ok = 0,
    /// An argument is not what it must be: a null pointer, a name that there is not.
    Argument = 1,
    /// The extraction is not possible as it was asked for.
    Extract = 2,
    /// The library has a fault. The object may be freed, and not be used otherwise.
    Panic = 3,
}

/// Why a call did not end well.
#[derive(Debug)]
pub(crate) struct Failure {
    status: IsostudyStatus,
    reason: String,
}

impl Failure {
    pub(crate) fn argument(reason: impl Into<String>) -> Self {
        Self { status: IsostudyStatus::Argument, reason: reason.into() }
    }
}

impl<E: std::error::Error> From<E> for Failure {
    fn from(error: E) -> Self {
        Self { status: IsostudyStatus::Extract, reason: error.to_string() }
    }
}

thread_local! {
    static LAST_ERROR: RefCell<CString> = RefCell::default();
}

/// What went wrong in the last call of this thread that did not return `ISOSTUDY_STATUS_OK`, in UTF-8. The text is valid until the next call of this
/// thread. It is empty before the first one.
#[unsafe(no_mangle)]
pub extern "C" fn isostudy_last_error() -> *const c_char {
    LAST_ERROR.with_borrow(|text| text.as_ptr())
}

/// The version of the library, as in `0.1.0`.
#[unsafe(no_mangle)]
pub extern "C" fn isostudy_version() -> *const c_char {
    const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), "\0");
    VERSION.as_ptr().cast()
}

/// Runs what a function does, and keeps the reason where it fails. A panic must not go on into code that knows none.
pub(crate) fn status_of(work: impl FnOnce() -> Result<(), Failure>) -> IsostudyStatus {
    // After a panic the object is only freed, which is what the status says.
    let failure = match catch_unwind(AssertUnwindSafe(work)) {
        Ok(Ok(())) => return IsostudyStatus::Ok,
        Ok(Err(failure)) => failure,
        Err(_) => Failure { status: IsostudyStatus::Panic, reason: "the library has a fault".into() },
    };
    let text = CString::new(failure.reason.replace('\0', " ")).unwrap_or_default();
    LAST_ERROR.set(text);
    failure.status
}

#[cfg(test)]
mod tests {
    use std::ffi::CStr;

    use super::*;

    fn last_error() -> String {
        // SAFETY: the text ends with a zero, and no other call of this thread comes between.
        unsafe { CStr::from_ptr(isostudy_last_error()) }.to_str().unwrap().to_owned()
    }

    #[test]
    fn reasons_are_kept_and_panics_stay_inside() {
        assert_eq!(status_of(|| Ok(())), IsostudyStatus::Ok);
        assert_eq!(status_of(|| Err(Failure::argument("a \0 b"))), IsostudyStatus::Argument);
        assert_eq!(last_error(), "a   b");
        assert_eq!(status_of(|| panic!("planted")), IsostudyStatus::Panic);
        assert_eq!(last_error(), "the library has a fault");
    }
}
