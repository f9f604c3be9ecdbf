//! Chores of this repository: `cargo xtask test` is the one gate in front of every change.

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
  size    Build the firmware image, check it, and print what it takes of flash, RAM and stack
  flash   Build the firmware image, flash it through probe-rs, and show its log
  target  Make the firmware's target available to the active toolchain

Options:
  -h, --help  Print this help
";

/// Exit status of a command line that is not understood.
const USAGE_ERROR: u8 = 2;

fn main() -> ExitCode {
    let arguments: Vec<_> = std::env::args().skip(1).collect();
    let arguments: Vec<_> = arguments.iter().map(String::as_str).collect();
    let outcome = match arguments.as_slice() {
        ["test"] => test::run(),
        ["size"] => firmware::size(),
        ["flash"] => firmware::flash(),
        ["target"] => ensure(say).map_err(Failure::from),
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

/// Why a chore did not succeed.
#[derive(Debug, thiserror::Error)]
enum Failure {
    #[error("`{0}` failed; its own message stands above")]
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
    #[error("cannot read {}: {source}", path.display())]
    File {
        path: std::path::PathBuf,
        source: std::io::Error,
    },
    #[error(transparent)]
    Image(#[from] image::ImageError),
    #[error(transparent)]
    Target(#[from] TargetError),
}

/// Says what is being done.
fn say(line: &str) {
    println!("{line}");
}

/// Runs a command to its end with its output shown.
fn run(command: &mut Command) -> Result<(), Failure> {
    let status = command.status().map_err(|source| Failure::Spawn {
        command: shown(command),
        source,
    })?;
    if status.success() {
        Ok(())
    } else {
        Err(Failure::Step(shown(command)))
    }
}

/// A command as a person would type it.
fn shown(command: &Command) -> String {
    let program = Path::new(command.get_program());
    std::iter::once(program.file_name().unwrap_or(program.as_os_str()))
        .chain(command.get_args())
        .map(|word| word.to_string_lossy())
        .collect::<Vec<_>>()
        .join(" ")
}
