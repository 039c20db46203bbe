//! `sungaze validate`.

use std::io::IsTerminal;
use std::process::ExitCode;

use sungaze::error::Result;
use sungaze::frames::atomic::write_text;
use sungaze::validate::{self, Subject, Verdict};

use super::{Common, say};

/// Makes every check, prints the table, writes it beside its picture; exit code 1 if a check fails.
pub(crate) fn command(common: &Common) -> Result<ExitCode> {
    common.pool()?;
    let folder = common.folder("validate");
    common.ready(&folder)?;
    let mut progress = |group: &str| {
        if !common.quiet {
            say::message(group);
        }
    };
    let validation = validate::validate(&Subject::new(&common.set), &mut progress)?;
    write_text(&folder.join("validate.csv"), &validate::csv(&validation))?;
    validate::chart::write(&folder, &validation)?;
    if common.json {
        say::result(&format!("{:#}", validate::rows(&validation)))?;
    } else {
        say::result(&validate::text(&validation, std::io::stdout().is_terminal()))?;
        say::result(&format!("{}", folder.join("validate.csv").display()))?;
    }
    Ok(ExitCode::from(u8::from(validation.count(Verdict::Fail) > 0)))
}
