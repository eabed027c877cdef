//! Exit statuses, a public interface.

use std::process::ExitCode;

/// Result of a command.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Exit {
    /// 0: the requested end was reached.
    Reached,
    /// 1: any other outcome; output was still written.
    Other,
    /// 2: bad flags or input.
    Refused,
}

impl Exit {
    /// The exit status of the process.
    pub const fn code(self) -> u8 {
        match self {
            Self::Reached => 0,
            Self::Other => 1,
            Self::Refused => 2,
        }
    }
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> Self {
        Self::from(exit.code())
    }
}
