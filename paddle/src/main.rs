//! Command line of the haptic paddle: simulates, measures the gap, and diagnoses it.

mod answer;
mod commands;
mod device_file;
#[cfg(test)]
mod documented;
mod effect_page;
mod failure;
mod files;
mod interrupt;
mod numbers;
mod plant_choice;
mod plot;
mod progress;
mod provenance;
mod report;
mod rig;
mod settings_file;
mod spectrum;
mod targets;
mod tuning;

use answer::JsonTo;
use clap::Parser;
use commands::Command;
use failure::{BAD_INPUT, Failure};
use std::io::Write;
use std::process::ExitCode;
use targets::{Target, Use};

/// Position of the common options in the help.
const LAST: usize = 900;

/// Haptic paddle: simulate it, measure the gap between a simulation and a recording.
#[derive(Parser)]
#[command(version, after_help = "Example: paddle demo")]
struct Cli {
    #[command(subcommand)]
    command: Command,
    /// Write the result as JSON to this file; with `-`, write only the JSON to standard output.
    #[arg(long, global = true, value_name = "FILE|-", display_order = LAST)]
    json: Option<JsonTo>,
}

fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(refusal) => return refuse(&refusal),
    };
    let problems = done(&cli).unwrap_or_else(|failure| vec![failure]);
    for failure in &problems {
        complain(&failure.to_string());
    }
    let status = problems.iter().map(Failure::status).max();
    status.map_or(ExitCode::SUCCESS, ExitCode::from)
}

/// Runs the command. Returns the failures that left parts of the result missing.
fn done(cli: &Cli) -> Result<Vec<Failure>, Failure> {
    let json = match &cli.json {
        Some(JsonTo::File(path)) => Target::of("--json", Use::File, path),
        _ => None,
    };
    let targets = cli.command.targets().into_iter().chain(json);
    let _held = targets::check(&targets.collect::<Vec<_>>())?;
    let mut answer = progress::shown(|| cli.command.run())?;
    answer.give(cli.json.as_ref());
    Ok(answer.problems)
}

/// Prints help if it was requested, else a one-line message about the error in the command line.
fn refuse(refusal: &clap::Error) -> ExitCode {
    use clap::error::ErrorKind::{
        DisplayHelp, DisplayHelpOnMissingArgumentOrSubcommand, DisplayVersion,
    };
    if matches!(refusal.kind(), DisplayHelp | DisplayVersion) {
        // If standard output is closed, there is no reader.
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
    // If standard error is closed, there is no reader.
    let _ = writeln!(std::io::stderr(), "paddle: {text}");
}
