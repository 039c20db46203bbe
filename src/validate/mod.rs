//! The program held against what is known: closed forms, the paper's equations, published numbers,
//! the oracle.
//!
//! A check is a number that was measured on the code beside the number it should have, worked out
//! elsewhere. What is checked is a [`Subject`]: the shipped constants, or those that a user has
//! set, so that a wrong constant shows. Where the paper as printed disagrees with its own sources,
//! a row states both numbers and judges nothing.

mod anchors;
pub mod chart;
mod exposure;
mod limit;
mod observer;
mod optics;
mod oracle;
mod paper;
mod pictures;
mod printed;
mod table;

use std::path::Path;

use crate::config::Config;
use crate::constants::RODS;
use crate::error::Result;
use crate::kinetics::Kinetics;
use crate::observer::Observer;
use crate::units::{Seconds, Trolands};

pub(crate) use limit::Field;
pub(crate) use table::summary;
pub use table::{csv, rows, text};

/// What became of a check.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    Pass,
    Fail,
    /// A disagreement that is known and stated, not judged.
    Info,
}

impl Verdict {
    /// The word in `validate.csv`.
    pub(crate) fn word(self) -> &'static str {
        match self {
            Verdict::Pass => "true",
            Verdict::Fail => "false",
            Verdict::Info => "info",
        }
    }
}

/// One row: a number measured on the code beside the one it should have.
#[derive(Clone, Debug, PartialEq)]
pub struct Check {
    pub name: String,
    pub(crate) source: &'static str,
    pub measured: f64,
    pub expected: f64,
    /// Largest difference that passes.
    pub(crate) tolerance: f64,
    pub verdict: Verdict,
}

impl Check {
    /// A check that passes if the two differ by no more than `tolerance`.
    pub(crate) fn new(
        name: impl Into<String>,
        source: &'static str,
        measured: f64,
        expected: f64,
        tolerance: f64,
    ) -> Self {
        let verdict =
            if (measured - expected).abs() <= tolerance { Verdict::Pass } else { Verdict::Fail };
        Check { name: name.into(), source, measured, expected, tolerance, verdict }
    }

    /// A known disagreement: what is computed here beside what was printed.
    pub(crate) fn info(
        name: impl Into<String>,
        source: &'static str,
        ours: f64,
        printed: f64,
    ) -> Self {
        let tolerance = f64::NAN;
        Check {
            name: name.into(),
            source,
            measured: ours,
            expected: printed,
            tolerance,
            verdict: Verdict::Info,
        }
    }

    /// How much of its tolerance a check uses up; `None` where nothing is judged.
    pub fn share(&self) -> Option<f64> {
        (self.verdict != Verdict::Info)
            .then(|| (self.measured - self.expected).abs() / self.tolerance)
    }
}

/// Checks of one kind under a heading.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Group {
    pub(crate) title: &'static str,
    pub(crate) checks: Vec<Check>,
}

/// All that was checked.
#[derive(Clone, Debug)]
pub struct Validation {
    pub(crate) groups: Vec<Group>,
    /// How the error of the steady state falls on uniform fields, for the picture.
    pub(crate) fields: Vec<Field>,
}

impl Validation {
    /// Every check of every group.
    pub(crate) fn checks(&self) -> impl Iterator<Item = &Check> {
        self.groups.iter().flat_map(|group| &group.checks)
    }

    /// How many checks ended so.
    pub fn count(&self, verdict: Verdict) -> usize {
        self.checks().filter(|check| check.verdict == verdict).count()
    }
}

/// The thing under test.
#[derive(Clone, Debug)]
pub struct Subject {
    sets: Vec<String>,
    /// Rods are in no configuration: they appear here and in a chart only.
    pub rods: Kinetics,
}

impl Subject {
    /// The program as shipped, with `KEY=VALUE` settings on top of every configuration that is
    /// checked.
    pub fn new(sets: &[String]) -> Self {
        let (log_td, tau) = RODS;
        Subject {
            sets: sets.to_vec(),
            rods: Kinetics::first_order(Trolands(10f64.powf(log_td)), Seconds(tau)),
        }
    }

    /// A configuration as the subject would have it.
    fn config(&self, toml: &str) -> Result<Config> {
        Config::parse(toml, "validate", "validate", Path::new(""), &self.sets)
    }

    fn observer(&self, toml: &str) -> Result<Observer> {
        Ok(self.config(toml)?.observer())
    }

    fn pigments(&self, toml: &str) -> Result<[Kinetics; 3]> {
        Ok(self.config(toml)?.pigments())
    }
}

/// The observers that are checked, as configurations: the default and the paper's.
const STANDARD: &str = "observer.preset = \"standard\"";
const PAPER: &str = "observer.preset = \"paper\"";

/// One subject of the table: what heads its rows, and what makes them.
pub struct Topic {
    pub title: &'static str,
    pub checks: fn(&Subject) -> Result<Vec<Check>>,
}

/// Every topic, in the order in which they are shown.
pub const TOPICS: [Topic; 9] = [
    Topic {
        title: "The steady state as the limit of long exposure: uniform fields",
        checks: limit::checks,
    },
    Topic {
        title: "The steady state as the limit of long exposure: pictures",
        checks: pictures::checks,
    },
    Topic { title: "Short exposure, reciprocity, recovery", checks: exposure::checks },
    Topic { title: "The paper's equations and Table 1", checks: paper::checks },
    Topic { title: "The observer", checks: observer::checks },
    Topic { title: "Light scattered in the eye", checks: optics::checks },
    Topic { title: "Published anchors", checks: anchors::checks },
    Topic { title: "The oracle: 30 digits from 60-digit arithmetic", checks: oracle::checks },
    Topic {
        title: "The paper as printed: ours beside the printed number",
        checks: printed::checks,
    },
];

/// Makes every check. `progress` is told which topic comes next.
pub fn validate(subject: &Subject, progress: &mut dyn FnMut(&str)) -> Result<Validation> {
    let mut groups = Vec::new();
    for Topic { title, checks } in TOPICS {
        progress(title);
        groups.push(Group { title, checks: checks(subject)? });
    }
    let fields = limit::fields(&subject.pigments(STANDARD)?[0]);
    Ok(Validation { groups, fields })
}
