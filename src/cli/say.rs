//! Everything that the program says: results on stdout, messages on stderr. Nothing else in the project prints.
//! Control characters, which may come out of a file, are shown and not sent.

use std::io::{ErrorKind, Write};

use sungaze::error::{Error, Result};
use sungaze::text::shown_lines;

/// Prints a line of results. A reader that has gone away is not an error; a full disk is.
pub(crate) fn result(text: &str) -> Result<()> {
    let mut stdout = std::io::stdout().lock();
    match writeln!(stdout, "{}", shown_lines(text)).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Error::io("stdout", "write")(error))
        }
        _ => Ok(()),
    }
}

/// Prints a message. One that nobody can read any more (a dead terminal, a full log disk) is let go.
pub(crate) fn message(text: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{}", shown_lines(text));
}

/// Prints why something failed.
pub(crate) fn failure(error: &Error) {
    message(&format!("sungaze: {error}"));
}
