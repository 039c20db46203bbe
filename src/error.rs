//! What can go wrong, said so that the user can mend it: where, what was found, what is accepted.

use std::path::{Path, PathBuf};

/// Every failure of the library. [`Error::exit_code`] gives the program's exit code.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The configuration or the command line is wrong. `place` is a file with its line, or `--set`.
    #[error("{place}: {key}: {problem}")]
    Config { place: String, key: String, problem: String },
    /// A frame file, a table or a state file cannot be used as it is.
    #[error("{}: {problem}", path.display())]
    File { path: PathBuf, problem: String },
    /// The system refused to read or write.
    #[error("{}: cannot {doing}: {source}", path.display())]
    Io { path: PathBuf, doing: &'static str, source: std::io::Error },
    /// A frame, a gaze or a state that was given in memory cannot be used.
    #[error("{0}")]
    Light(String),
    /// The work was interrupted. `resumable`: it can be gone on with.
    #[error("interrupted{}", if *resumable { "; continue with --resume" } else { "" })]
    Interrupted { resumable: bool },
}

/// The library's result.
pub type Result<T, E = Error> = std::result::Result<T, E>;

impl Error {
    /// A wrong key of the configuration.
    pub fn config(
        place: impl Into<String>,
        key: impl Into<String>,
        problem: impl Into<String>,
    ) -> Self {
        Error::Config { place: place.into(), key: key.into(), problem: problem.into() }
    }

    /// A file that cannot be used.
    pub(crate) fn file(path: impl AsRef<Path>, problem: impl Into<String>) -> Self {
        Error::File { path: path.as_ref().to_owned(), problem: problem.into() }
    }

    /// A frame, a gaze or a state in memory that cannot be used.
    pub(crate) fn light(problem: impl Into<String>) -> Self {
        Error::Light(problem.into())
    }

    /// A refusal of the system, for `map_err(Error::io(path, "write"))`.
    pub fn io(path: impl AsRef<Path>, doing: &'static str) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.as_ref().to_owned();
        move |source| Error::Io { path, doing, source }
    }

    /// 1 a run failed, 2 the command line or the configuration is wrong, 130 interrupted.
    pub fn exit_code(&self) -> u8 {
        match self {
            Error::Config { .. } => 2,
            Error::File { .. } | Error::Io { .. } | Error::Light(_) => 1,
            Error::Interrupted { .. } => 130,
        }
    }
}
