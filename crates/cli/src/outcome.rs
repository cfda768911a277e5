//! How a command ended, and the exit code that says so.

use std::process::ExitCode;

/// The work was done, but something in it is not as it should be.
const CHECK_FAILED: u8 = 1;

/// How work that could be done came out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Outcome {
    Done,
    CheckFailed,
}

impl Outcome {
    /// [`Done`](Self::Done) if a check was passed.
    pub(crate) fn of_check(passed: bool) -> Self {
        if passed { Self::Done } else { Self::CheckFailed }
    }

    pub(crate) fn exit_code(self) -> ExitCode {
        match self {
            Self::Done => ExitCode::SUCCESS,
            Self::CheckFailed => ExitCode::from(CHECK_FAILED),
        }
    }
}
