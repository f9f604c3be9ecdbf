//! Maintenance commands of this repository. `cargo xtask test` runs every check that a change must pass.

mod book;
mod docs_test;
mod documentation;
mod figures;
mod firmware;
mod image;
mod python;
mod stack;
mod test;

use firmware_build::{TargetError, cargo, ensure};
use std::path::Path;
use std::process::{Command, ExitCode};

const HELP: &str = "\
Chores of this repository.

Usage: cargo xtask <COMMAND>

Commands:
  test    Formatting, clippy with warnings denied, every test of every crate, and the firmware image
  image   Build the firmware image, as `cargo fw` does, and print its SHA-256
  size    Build the firmware image, check it, and print what it takes of flash, RAM and stack
  flash   Build the firmware image, flash it through probe-rs, and show its log
  target  Make the firmware's target available to the active toolchain
  docs-test [PART...]
          Run every command of README and docs in a clean checkout, or those of the pages whose paths contain a PART
  figures [--check]
          Measure what is the same on every machine, and write it into README and docs; or say which pages hold other figures
  figures accuracy FILE...
          Keep what `paddle gap blind --json` wrote, and write the tables of it
  figures performance
          Measure how fast the simulator and the virtual board are, keep it, and write the tables of it
  book    Build the documentation as a book, with mdbook

Options:
  -h, --help  Print this help
";

/// Exit status for an invalid command line.
const USAGE_ERROR: u8 = 2;

fn main() -> ExitCode {
    let arguments: Vec<_> = std::env::args().skip(1).collect();
    let arguments: Vec<_> = arguments.iter().map(String::as_str).collect();
    let outcome = match arguments.as_slice() {
        ["test"] => test::run(),
        ["image"] => firmware::image(),
        ["size"] => firmware::size(),
        ["flash"] => firmware::flash(),
        ["target"] => ensure(say).map_err(Failure::from),
        ["docs-test", parts @ ..] if !parts.iter().any(|part| part.starts_with('-')) => {
            docs_test::run(parts)
        }
        ["figures"] => figures::write(),
        ["figures", "--check"] => figures::check(),
        ["figures", "performance"] => figures::keep_performance(),
        ["figures", "accuracy", files @ ..] if !files.is_empty() => figures::keep_accuracy(files),
        ["book"] => book::build(),
        ["-h" | "--help" | "help"] | [_, "-h" | "--help"] => {
            print!("{HELP}");
            return ExitCode::SUCCESS;
        }
        other => {
            if let Some(word) = other.first() {
                eprintln!("xtask: unknown command line from `{word}` on\n");
            }
            eprint!("{HELP}");
            return ExitCode::from(USAGE_ERROR);
        }
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("xtask: {failure}");
            ExitCode::FAILURE
        }
    }
}

/// Reason why a command failed.
#[derive(Debug, thiserror::Error)]
enum Failure {
    #[error("`{0}` failed; see its message above")]
    Step(String),
    #[error("cannot run `{command}`: {source}")]
    Spawn {
        command: String,
        source: std::io::Error,
    },
    #[error(
        "these tests were skipped and may not be (the list of those that may is in \
         xtask/src/test.rs): {}",
        .0.join(", ")
    )]
    Skipped(Vec<String>),
    #[error("these commands of the documentation failed: {}", .0.join(", "))]
    Documented(Vec<String>),
    #[error(
        "these pages do not hold what is measured: {}; write it by `cargo xtask figures`",
        .0.join(", ")
    )]
    OldFigures(Vec<String>),
    #[error("{page}: {error}")]
    Figures { page: String, error: String },
    #[error("there are no figures called {0}")]
    NoFigures(String),
    #[error("{0}: this is not the JSON that is expected: {1}")]
    Json(String, serde_json::Error),
    #[error("`{0}` does not print the figures that are expected")]
    Benchmark(String),
    #[error("mdbook is not installed; install it by `cargo install mdbook`")]
    NoBook,
    #[error("cannot read or write {}: {source}", path.display())]
    File {
        path: std::path::PathBuf,
        source: std::io::Error,
    },
    #[error(transparent)]
    Image(#[from] image::ImageError),
    #[error(transparent)]
    Target(#[from] TargetError),
}

impl Failure {
    /// Error of reading or writing a file.
    fn file(path: &Path, source: std::io::Error) -> Self {
        Self::File {
            path: path.to_owned(),
            source,
        }
    }

    /// Error of starting a command.
    fn spawn(command: &Command, source: std::io::Error) -> Self {
        Self::Spawn {
            command: shown(command),
            source,
        }
    }
}

/// Prints what is being done.
fn say(line: &str) {
    println!("{line}");
}

/// Runs a command to its end and shows its output.
fn run(command: &mut Command) -> Result<(), Failure> {
    let status = command.status();
    let status = status.map_err(|source| Failure::spawn(command, source))?;
    if status.success() {
        Ok(())
    } else {
        Err(Failure::Step(shown(command)))
    }
}

/// Returns the standard output of a command. Its standard error is shown.
fn output(command: &mut Command) -> Result<String, Failure> {
    let output = command.stderr(std::process::Stdio::inherit()).output();
    let output = output.map_err(|source| Failure::spawn(command, source))?;
    if !output.status.success() {
        return Err(Failure::Step(shown(command)));
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

/// A command in shell syntax.
fn shown(command: &Command) -> String {
    let program = Path::new(command.get_program());
    std::iter::once(program.file_name().unwrap_or(program.as_os_str()))
        .chain(command.get_args())
        .map(|word| word.to_string_lossy())
        .collect::<Vec<_>>()
        .join(" ")
}
