//! Command line of the haptic paddle: simulate, measure the gap, diagnose it.

mod answer;
mod commands;
mod device_file;
mod failure;
mod files;
mod plant_choice;
mod plot;
mod progress;
mod provenance;
mod report;
mod spectrum;
mod tuning;

use answer::JsonTo;
use clap::Parser;
use commands::Command;
use failure::BAD_INPUT;
use std::io::Write;
use std::process::ExitCode;

/// Place in the help of what all commands have.
const LAST: usize = 900;

/// Haptic paddle: simulate it, measure the gap between a simulation and a recording.
#[derive(Parser)]
#[command(version, after_help = "Example: paddle demo")]
struct Cli {
    #[command(subcommand)]
    command: Command,
    /// Write the result as JSON to this file; `-` is standard output, and nothing else then goes there.
    #[arg(long, global = true, value_name = "FILE|-", display_order = LAST)]
    json: Option<JsonTo>,
}

fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(refusal) => return refuse(&refusal),
    };
    let done = progress::shown(|| cli.command.run()).and_then(|answer| {
        answer.give(cli.json.as_ref())?;
        answer.amiss.map_or(Ok(()), Err)
    });
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            complain(&failure.to_string());
            ExitCode::from(failure.status())
        }
    }
}

/// Shows help where it was asked for, else says in one line what is wrong with the command line.
fn refuse(refusal: &clap::Error) -> ExitCode {
    use clap::error::ErrorKind::{
        DisplayHelp, DisplayHelpOnMissingArgumentOrSubcommand, DisplayVersion,
    };
    if matches!(refusal.kind(), DisplayHelp | DisplayVersion) {
        // Nobody is left to be told if standard output is closed.
        let _ = refusal.print();
        return ExitCode::SUCCESS;
    }
    if refusal.kind() == DisplayHelpOnMissingArgumentOrSubcommand {
        let _ = refusal.print();
        return ExitCode::from(BAD_INPUT);
    }
    let text = refusal.to_string();
    let cause: Vec<_> = text
        .lines()
        .take_while(|line| !line.starts_with("Usage:") && !line.starts_with("For more"))
        .map(|line| line.trim().trim_start_matches("error: "))
        .filter(|line| !line.is_empty())
        .collect();
    complain(&format!("{}; see --help", cause.join(" ")));
    ExitCode::from(BAD_INPUT)
}

fn complain(text: &str) {
    // As above, of standard error.
    let _ = writeln!(std::io::stderr(), "paddle: {text}");
}
