//! `paddle completions`: prints the completion script of a shell.

use crate::Cli;
use crate::answer::Answer;
use clap::{Args, CommandFactory};
use clap_complete::Shell;
use serde_json::json;

/// Options of the command.
#[derive(Args)]
#[command(after_help = "Examples:
  paddle completions bash > ~/.local/share/bash-completion/completions/paddle
  paddle completions zsh > ~/.zfunc/_paddle
  paddle completions fish > ~/.config/fish/completions/paddle.fish")]
pub struct Arguments {
    /// Shell for which the script is made.
    shell: Shell,
}

/// Generates the completion script.
pub fn run(arguments: &Arguments) -> Answer {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut Cli::command(), "paddle", &mut script);
    let text = String::from_utf8_lossy(&script).into_owned();
    let json = json!({ "shell": arguments.shell.to_string(), "script": &text });
    Answer {
        text,
        json,
        ..Answer::default()
    }
}
