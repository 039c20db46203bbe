//! The page: one HTML file for two uses. With data in it, it is `report.html` of a run or a sweep; without, it is what
//! `sungaze view` serves. Plain HTML, CSS and JavaScript; it loads nothing but the pictures beside it.
//!
//! The data of a report are one JSON object:
//!
//! ```text
//! { "title": text,
//!   "cases": [ { "name": text, "before": picture or null,
//!                "frames": [ { "frame", "time_s", "picture": name or null, "gaze": [x, y] or null, ... } ],
//!                "probes": { "columns": [name], "rows": [[cell]] } } ],
//!   "report": report.json }
//! ```
//!
//! Pictures are names relative to the page. A run is one case. The probes' columns are those of `probes.csv` or
//! `sweep.csv`, thinned to at most [`FRAMES`] frames. The page inserts all of it as text, never as HTML.

mod case;
mod table;

use std::path::Path;

use data_encoding::BASE64;
use serde::Serialize;
use serde_json::Value;
use sha2::{Digest, Sha256};

use crate::error::{Error, Result};
use crate::frames::atomic;

pub(crate) use case::{Case, of_run, of_sweep};
pub(crate) use table::Table;

const HTML: &str = include_str!("page.html");
const STYLE: &str = include_str!("page.css");
const SCRIPTS: [&str; 7] = [
    include_str!("basics.js"),
    include_str!("chart.js"),
    include_str!("words.js"),
    include_str!("report.js"),
    include_str!("controls.js"),
    include_str!("live.js"),
    include_str!("main.js"),
];

/// The name of a report's page in its folder.
pub(crate) const REPORT: &str = "report.html";

/// What a report shows.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Report<'a> {
    pub(crate) title: &'a str,
    pub(crate) cases: Vec<Case>,
    /// `report.json`, as far as there is one; `timing` is not shown.
    pub(crate) report: &'a Value,
}

impl Report<'_> {
    /// The page as HTML. It leaves out `timing`, so that the same run leaves the same bytes.
    ///
    /// # Errors
    /// Data that JSON cannot hold.
    fn html(&self) -> Result<String> {
        let mut json =
            serde_json::to_value(self).map_err(|e| Error::file(REPORT, e.to_string()))?;
        if let Some(report) = json["report"].as_object_mut() {
            report.remove("timing");
        }
        let json = json.to_string();
        // Within a script element only `<` could end it or begin a comment.
        let json = json.replace('<', "\\u003c");
        let data = format!("<script type=\"application/json\" id=\"data\">{json}</script>");
        Ok(assembled("img-src 'self' file: data:", &data))
    }

    /// Writes the page into a folder, whole or not at all.
    ///
    /// # Errors
    /// The system's refusal to write.
    pub(crate) fn write(&self, folder: &Path) -> Result<()> {
        atomic::write_text(&folder.join(REPORT), &self.html()?)
    }
}

/// The page without data, for `sungaze view` to serve. `host`: the name and port that it was asked
/// for, whose socket it may open; Safari before 15.4 does not take `'self'` for that.
#[cfg(feature = "view")]
pub(crate) fn live(host: &str) -> String {
    // A policy has no word for an address of IPv6.
    let socket = if host.starts_with('[') { String::new() } else { format!(" ws://{host}") };
    assembled(&format!("img-src blob: data:; connect-src 'self'{socket}"), "")
}

/// The page's parts in one file. `allowed`: what the content security policy lets it load.
fn assembled(allowed: &str, data: &str) -> String {
    let script = SCRIPTS.join("\n");
    let policy = format!(
        "default-src 'none'; base-uri 'none'; form-action 'none'; {allowed}; style-src '{}'; script-src '{}'",
        source(STYLE),
        source(&script)
    );
    HTML.replacen("{{policy}}", &policy, 1)
        .replacen("{{style}}", &format!("<style>{STYLE}</style>"), 1)
        .replacen("{{script}}", &format!("<script>{script}</script>"), 1)
        .replacen("{{data}}", data, 1)
}

/// A text by its digest, as a content security policy names what may run.
fn source(text: &str) -> String {
    format!("sha256-{}", BASE64.encode(&Sha256::digest(text)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn page(title: &str, report: &Value) -> String {
        Report { title, cases: Vec::new(), report }.html().unwrap()
    }

    #[test]
    fn no_text_of_the_data_can_end_its_script_or_begin_a_comment() {
        let hostile = "</script><script>alert(1)</script><!--";
        let html = page(hostile, &json!({ "warnings": [hostile], hostile: hostile }));
        assert!(!html.contains(hostile) && !html.contains("<!--"));
        assert_eq!(html.matches("</script>").count(), 2, "the data's and the program's");
    }

    #[test]
    fn the_data_come_back_out_of_the_page_as_they_went_in() {
        let report = json!({ "a": "<b> & \u{2028} \"", "n": [1.5e-300, null] });
        let html = page("{{script}}", &report);
        let (_, rest) = html.split_once("id=\"data\">").unwrap();
        let data: Value = serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap();
        assert_eq!((&data["report"], data["title"].as_str()), (&report, Some("{{script}}")));
    }

    #[test]
    fn the_live_page_may_open_the_socket_of_its_own_address_and_no_other() {
        let policy = |host: &str| {
            let html = live(host);
            let (_, rest) = html.split_once("connect-src ").unwrap();
            rest.split_once(';').unwrap().0.to_owned()
        };
        assert_eq!(policy("127.0.0.1:8765"), "'self' ws://127.0.0.1:8765");
        assert_eq!(policy("[::1]:8765"), "'self'");
        assert!(!page("sunset", &Value::Null).contains("connect-src"));
    }

    #[test]
    fn the_page_runs_its_own_script_only_and_asks_nobody_for_anything() {
        for html in [page("sunset", &Value::Null), live("localhost:1")] {
            assert!(!html.contains("{{") && !html.contains("unsafe"), "{}", &html[..600]);
            let external =
                ["src=\"", "href=\"http", "@import", "url(", "innerHTML", "document.write"];
            assert!(external.iter().all(|words| !html.contains(words)));
            let script = html.rsplit_once("<script>").unwrap().1.split_once("</script>").unwrap().0;
            assert!(html.contains(&format!("script-src '{}'", source(script))));
        }
    }
}
