//! Arguments, exit codes, and who prints what: results on stdout, everything else on stderr.

mod chart;
mod completions;
mod frames;
mod inspect;
mod plan;
mod run;
mod say;
mod stop;
mod sweep;
mod validate;
mod view;
mod watch;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Args, CommandFactory, Parser, Subcommand};

use sungaze::error::{Error, Result};
use sungaze::run::{Existing, not_empty};

/// What a person sees while staring at a bright light.
#[derive(Parser)]
#[command(version, about, arg_required_else_help = true, infer_subcommands = true)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Take frames through the eye. Without an argument: the built-in sunset.
    #[command(
        after_help = "Example:\n  sungaze run configs/sunset.toml --set observer.age=60 --out out/sixty\n  \
                            sungaze run 'shot/sun.####.exr' --fov 40 --white 5000 --fps 24"
    )]
    Run {
        /// A TOML file, or frames: a file or a pattern such as sun.####.exr.
        #[arg(value_name = "CONFIG or FRAMES")]
        config: Option<PathBuf>,
        #[command(flatten)]
        keys: frames::Keys,
        #[command(flatten)]
        common: Common,
    },
    /// Sweep exposure durations and any other parameter, from one TOML file with [sweep].
    ///
    /// A folder that holds the same sweep is gone on with: finished cases are kept.
    #[command(after_help = "Examples:\n  sungaze sweep configs/exposure_sweep.toml\n  \
                            seq 0 4 | parallel sungaze sweep configs/half_bleach_sweep.toml --index {} && \\\n  \
                            sungaze sweep configs/half_bleach_sweep.toml --merge")]
    Sweep {
        config: PathBuf,
        #[command(flatten)]
        asked: sweep::Asked,
        #[command(flatten)]
        common: Common,
    },
    /// Look through the eye, live, on a page in the browser: click where to look.
    #[command(
        after_help = "Examples:\n  sungaze view\n  sungaze view --port 8765 --no-open   and elsewhere: ssh -L 8765:127.0.0.1:8765 HOST"
    )]
    View {
        /// A TOML file, or frames; without one, the built-in sunset.
        #[arg(value_name = "CONFIG or FRAMES")]
        config: Option<PathBuf>,
        #[command(flatten)]
        keys: frames::Keys,
        #[command(flatten)]
        asked: view::Asked,
        #[command(flatten)]
        common: Common,
    },
    /// Chart methods, models and observers. Without NAME: every chart.
    #[command(
        after_help = "Examples:\n  sungaze chart work-precision stability --out out/chart\n  sungaze chart fundamentals --set observer.age=70"
    )]
    Chart {
        /// Charts; those of an observer take --set observer.KEY=VALUE.
        #[arg(value_name = "NAME", value_parser = chart::names())]
        names: Vec<String>,
        #[command(flatten)]
        common: Common,
    },
    /// Hold the program against closed forms, the paper, published numbers and the oracle; exit
    /// code 1 if it fails.
    #[command(
        after_help = "Example:\n  sungaze validate --out out/validate\n  sungaze validate --set 'observer.tau_s=[121.2, 121.2, 121.2]'   fails: one per cent off"
    )]
    Validate {
        #[command(flatten)]
        common: Common,
    },
    /// Say what a run would model and what it would leave out, each with its error bound and cost.
    /// Writes nothing.
    #[command(after_help = "Example:\n  sungaze plan configs/sunset.toml")]
    Plan {
        /// A TOML file, or frames: a file or a pattern such as sun.####.exr.
        #[arg(value_name = "CONFIG or FRAMES")]
        config: PathBuf,
        #[command(flatten)]
        keys: frames::Keys,
        #[command(flatten)]
        common: Common,
    },
    /// Say what frame files hold: kind, bands or primaries, size, luminance, bad samples.
    #[command(after_help = "Example:\n  sungaze inspect data/sunset_mitsuba.exr")]
    Inspect {
        #[arg(required = true)]
        files: Vec<PathBuf>,
        #[command(flatten)]
        common: Common,
    },
    /// Print a completion script for a shell.
    #[command(
        after_help = "Example:\n  sungaze completions bash > ~/.local/share/bash-completion/completions/sungaze"
    )]
    Completions { shell: clap_complete::Shell },
}

/// Flags that every command knows.
#[derive(Args, Clone)]
pub(crate) struct Common {
    /// Folder for everything that is written [default: out/<config name>]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Any key of the configuration, dotted: observer.age=60. Repeatable.
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Threads to work with [default: all]. Results do not depend on it.
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
    /// No progress and no notes, only warnings and errors.
    #[arg(long)]
    quiet: bool,
    /// Results on stdout as JSON.
    #[arg(long)]
    json: bool,
    /// Go on where an interrupted run stopped.
    #[arg(long)]
    resume: bool,
    /// Replace what an earlier run left in the folder.
    #[arg(long, conflicts_with = "resume")]
    overwrite: bool,
}

impl Common {
    fn existing(&self) -> Existing {
        match (self.resume, self.overwrite) {
            (true, _) => Existing::Resume,
            (_, true) => Existing::Overwrite,
            _ => Existing::Refuse,
        }
    }

    fn folder(&self, name: &str) -> PathBuf {
        self.out.clone().unwrap_or_else(|| PathBuf::from("out").join(name))
    }

    /// Makes the folder, or refuses one that holds something without leave to replace it.
    fn ready(&self, folder: &Path) -> Result<()> {
        if folder.exists() && !folder.is_dir() {
            let problem = "is a file; accepted: a folder, or a new name";
            return Err(Error::config("--out", folder.display().to_string(), problem));
        }
        std::fs::create_dir_all(folder).map_err(Error::io(folder, "create"))?;
        let empty = std::fs::read_dir(folder).map_err(Error::io(folder, "read"))?.next().is_none();
        if empty || self.overwrite || self.resume {
            return Ok(());
        }
        Err(not_empty(folder))
    }

    /// One pool for everything, of the size that was asked for.
    fn pool(&self) -> Result<()> {
        let threads = self.threads.unwrap_or(0);
        if self.threads == Some(0) || threads > 1024 {
            return Err(Error::config("--threads", threads.to_string(), "accepted: 1 to 1024"));
        }
        let built = rayon::ThreadPoolBuilder::new().num_threads(threads).build_global();
        built.map_err(|e| Error::io("--threads", "start the threads of")(std::io::Error::other(e)))
    }
}

/// Parses the arguments, runs the command and gives the exit code.
pub(crate) fn main() -> ExitCode {
    let command = Cli::parse().command;
    let resumable = matches!(command, Command::Run { .. } | Command::Sweep { .. });
    stop::unless_asked(resumable, || {
        dispatch(command).unwrap_or_else(|error| {
            say::failure(&error);
            ExitCode::from(error.exit_code())
        })
    })
}

fn dispatch(command: Command) -> Result<ExitCode> {
    match command {
        Command::Run { config, keys, common } => run::command(config.as_deref(), &keys, &common),
        Command::Sweep { config, asked, common } => sweep::command(&config, &asked, &common),
        Command::View { config, keys, asked, common } => {
            view::command(config.as_deref(), &keys, &asked, &common)
        }
        Command::Chart { names, common } => chart::command(&names, &common),
        Command::Plan { config, keys, common } => plan::command(&config, &keys, &common),
        Command::Inspect { files, common } => inspect::command(&files, &common),
        Command::Validate { common } => validate::command(&common),
        Command::Completions { shell } => completions::command(shell, &mut Cli::command()),
    }
}
