//! How a command ended, and the exit code that says so.

use std::process::ExitCode;

/// The work was done, but something in it is not as it should be.
const CHECK_FAILED: u8 = 1;
/// Nothing was found, and what had to be told would not have been.
const BLIND: u8 = 3;

/// How work that could be done came out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Outcome {
    Done,
    CheckFailed,
    Blind,
}

impl Outcome {
    /// [`Done`](Self::Done) if a check was passed.
    pub(crate) fn of_check(passed: bool) -> Self {
        if passed { Self::Done } else { Self::CheckFailed }
    }

    /// What the command ends with.
    pub(crate) fn status(self) -> u8 {
        match self {
            Self::Done => 0,
            Self::CheckFailed => CHECK_FAILED,
            Self::Blind => BLIND,
        }
    }

    pub(crate) fn exit_code(self) -> ExitCode {
        ExitCode::from(self.status())
    }
}
