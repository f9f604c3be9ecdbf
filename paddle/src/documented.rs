//! Tests that the commands in README, docs and help exist. `cargo xtask docs-test` runs these commands.

use crate::Cli;
use clap::{Command, CommandFactory};
use std::path::{Path, PathBuf};

/// The documentation pages with their texts.
fn pages() -> Vec<(PathBuf, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    let listed = ["docs", "docs/effects"].into_iter().flat_map(|folder| {
        let entries = std::fs::read_dir(root.join(folder)).into_iter().flatten();
        entries.map(|entry| entry.unwrap().path())
    });
    let fixed = ["README.md", "CONTRIBUTING.md"].map(|name| root.join(name));
    let pages = fixed.into_iter().chain(listed);
    let pages = pages.filter(|path| path.extension().is_some_and(|extension| extension == "md"));
    pages
        .map(|path| {
            let text = std::fs::read_to_string(&path).unwrap();
            (path, text)
        })
        .collect()
}

/// The words after `paddle` or `cargo paddle`. Returns `None` for another command, and for a command with shell syntax.
fn words(line: &str) -> Option<Vec<String>> {
    let line = line.trim().trim_start_matches("$ ");
    let line = line.strip_prefix("cargo ").unwrap_or(line);
    let is_exact = !line.contains(['$', '{', '…']) && !line.contains("...");
    let is_command = is_exact && (line == "paddle" || line.starts_with("paddle "));
    // An output redirection belongs to the shell.
    let line = line.split(" > ").next().unwrap_or(line);
    is_command.then(|| shlex::split(line)).flatten()
}

/// All commands in the code blocks of a page, on one line or on several.
fn in_blocks(text: &str) -> Vec<Vec<String>> {
    let blocks = text.split("```").skip(1).step_by(2);
    let lines = blocks.flat_map(|block| {
        let joined = block.replace("\\\n", " ");
        joined.lines().filter_map(words).collect::<Vec<_>>()
    });
    lines.collect()
}

/// All commands in the sentences of a page.
fn in_sentences(text: &str) -> Vec<Vec<String>> {
    let sentences: String = text.split("```").step_by(2).collect();
    let quoted = sentences.split('`').skip(1).step_by(2);
    quoted
        .filter_map(|code| words(&code.replace('\n', " ")))
        .collect()
}

/// The first word that is not a command or option of the program.
fn unknown(words: &[String]) -> Option<&str> {
    let mut command = Cli::command();
    command.build();
    let mut command = &command;
    for word in &words[1..] {
        if let Some(option) = word.strip_prefix("--") {
            let name = option.split('=').next().unwrap_or_default();
            let is_known = command.get_arguments().any(|a| a.get_long() == Some(name));
            if !is_known {
                return Some(word);
            }
        } else if let Some(next) = command.find_subcommand(word) {
            command = next;
        } else if command.has_subcommands() {
            return Some(word);
        }
    }
    None
}

#[test]
fn every_command_in_a_code_block_parses() {
    let mut seen = 0;
    for (page, text) in pages() {
        for words in in_blocks(&text) {
            let parsed = Cli::command().try_get_matches_from(&words);
            assert!(
                parsed.is_ok(),
                "{}: {}: {}",
                page.display(),
                words.join(" "),
                parsed.unwrap_err()
            );
            seen += 1;
        }
    }
    assert!(seen > 30, "only {seen} commands were found");
}

#[test]
fn every_command_in_a_sentence_has_words_that_exist() {
    let mut seen = 0;
    for (page, text) in pages() {
        for words in in_sentences(&text) {
            let unknown = unknown(&words);
            assert_eq!(unknown, None, "{}: {}", page.display(), words.join(" "));
            seen += 1;
        }
    }
    assert!(seen > 10, "only {seen} commands were found");
}

#[test]
fn every_example_in_the_help_parses() {
    fn check(command: &Command, seen: &mut usize) {
        let help = command.get_after_help().map(ToString::to_string);
        for line in help.unwrap_or_default().lines() {
            let line = line.trim_start_matches("Example: ").trim();
            let Some(words) = words(line).filter(|words| words.len() > 1) else {
                continue;
            };
            let parsed = Cli::command().try_get_matches_from(&words);
            assert!(parsed.is_ok(), "{line}: {}", parsed.unwrap_err());
            *seen += 1;
        }
        command.get_subcommands().for_each(|c| check(c, seen));
    }
    let mut seen = 0;
    check(&Cli::command(), &mut seen);
    assert!(seen > 30, "only {seen} examples were found");
}

#[test]
fn an_unknown_option_is_detected() {
    let words = ["paddle", "gap", "look", "--loud"].map(String::from);
    assert_eq!(unknown(&words), Some("--loud"));
}
