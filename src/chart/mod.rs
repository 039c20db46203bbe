//! Charts that the program makes of itself: each writes `<name>.csv`, `.svg` and `.png` into a
//! folder.
//!
//! A chart is a function and a row of [`CHARTS`]; the ink is laid by the room `plot`.

mod difference;
mod fundamentals;
mod ladder;
mod ladder_figure;
mod ladder_scenes;
mod machine;
mod methods;
mod optics;
mod optics_ways;
mod panels;
mod pigment;
mod scenes;
mod stability;
mod stability_map;
mod transform;
mod verdict;
mod work;
mod work_precision;

use crate::config::Config;
use crate::error::{Error, Result};
use crate::frames::atomic;
use std::path::Path;

/// Takes the progress of a chart, line by line.
pub(crate) type Progress<'a> = &'a mut (dyn FnMut(&str) + 'a);

/// What makes a chart in a folder.
#[derive(Clone, Copy)]
pub(crate) enum Make {
    /// Of the program's methods and the standard observer.
    Fixed(fn(&Path, Progress) -> Result<()>),
    /// Of the observer of a configuration.
    OfObserver(fn(&Path, &Config, Progress) -> Result<()>),
}

/// One chart: its name on the command line, what it shows, in one line, and what makes it.
pub struct Chart {
    pub name: &'static str,
    pub shows: &'static str,
    pub(crate) make: Make,
}

/// Every chart, in the order in which they are made.
pub const CHARTS: &[Chart] = &[
    Chart {
        name: "work-precision",
        shows: "What each method costs and how far it errs",
        make: Make::Fixed(work_precision::write),
    },
    Chart {
        name: "stability",
        shows: "Error of one step of each method, and where it fails",
        make: Make::Fixed(stability_map::write),
    },
    Chart {
        name: "ladder",
        shows: "What modelling costs and errs, scene by scene, and what auto chose",
        make: Make::Fixed(ladder::write),
    },
    Chart {
        name: "pigment",
        shows: "Bleaching and recovery of cones and rods; takes --set observer.KEY=VALUE",
        make: Make::OfObserver(pigment::write),
    },
    Chart {
        name: "fundamentals",
        shows: "An observer's cone fundamentals beside the paper's; takes --set too",
        make: Make::OfObserver(fundamentals::write),
    },
    Chart {
        name: "optics",
        shows: "Light that the eye scatters, and what computing it costs",
        make: Make::Fixed(optics::write),
    },
];

impl Chart {
    /// Whether it draws the observer that is given.
    pub fn takes_observer(&self) -> bool {
        matches!(self.make, Make::OfObserver(_))
    }

    /// Makes its files in a folder.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write(&self, out_dir: &Path, observer: &Config, progress: Progress) -> Result<()> {
        match self.make {
            Make::Fixed(write) => write(out_dir, progress),
            Make::OfObserver(write) => write(out_dir, observer, progress),
        }
    }
}

/// The observer of charts: the standard one, with `observer.KEY=VALUE` settings on top.
///
/// # Errors
/// A setting of another table, or one that no run would take.
pub fn observer(sets: &[String]) -> Result<Config> {
    match sets.iter().find(|set| !set.trim_start().starts_with("observer.")) {
        Some(set) => Err(Error::config("--set", set, "charts take keys of observer only")),
        None => Config::load(None, sets),
    }
}

/// Write a table of `header` and `rows` as `<name>.csv`. No value of ours holds a comma.
pub(crate) fn write_csv(
    out_dir: &Path,
    name: &str,
    header: &str,
    rows: impl Iterator<Item = String>,
) -> Result<()> {
    let table = std::iter::once(header.to_owned())
        .chain(rows)
        .fold(String::new(), |text, row| text + &row + "\n");
    atomic::write_text(&out_dir.join(format!("{name}.csv")), &table)
}
