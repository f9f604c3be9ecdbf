//! The commands of a Markdown page, and the directives that control their execution.
//!
//! A block of code with the info string `sh`, or with none, holds commands. A comment in front of a block,
//! `<!-- docs-test: DIRECTIVE -->` with one directive a line, concerns that block:
//!
//! - `run COMMAND`: a command that runs before the block and that the reader does not see;
//! - `skip REASON`: no command of the block runs;
//! - ``skip `BEGINNING` REASON``: those commands do not run that begin so;
//! - `file NAME`: the block is the content of this file, whatever its info string.

/// The steps of a page, in order.
#[derive(Debug, PartialEq, Eq)]
pub enum Step {
    /// Run a command.
    Run {
        /// Line of the command, counted from 1.
        line: usize,
        /// The command in shell syntax.
        command: String,
    },
    /// Skip a command that cannot run everywhere.
    Skip {
        /// Line of the command, counted from 1.
        line: usize,
        /// The command in shell syntax.
        command: String,
        /// Reason for the skip.
        reason: String,
    },
    /// Write a file that later commands read.
    File {
        /// Path relative to the checkout.
        name: String,
        /// Content of the file.
        content: String,
    },
}

/// A directive that is unknown.
#[derive(Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "line {line}: `{text}` is no directive; write `run COMMAND`, `skip REASON`, ``skip `BEGINNING` REASON`` or `file NAME`"
)]
pub struct BadDirective {
    line: usize,
    text: String,
}

const OPEN: &str = "<!-- docs-test:";
const CLOSE: &str = "-->";

/// The directives since the last code block.
#[derive(Default)]
struct Directives<'a> {
    skips: Vec<(&'a str, &'a str)>,
    file: Option<&'a str>,
}

impl Directives<'_> {
    /// Reason why a command is skipped. Returns `None` if it runs.
    fn reason(&self, command: &str) -> Option<String> {
        let mut skips = self.skips.iter();
        let skip = skips.find(|(beginning, _)| command.starts_with(beginning))?;
        Some(skip.1.to_owned())
    }
}

/// Parses the steps of a page.
///
/// # Errors
/// Returns [`BadDirective`] for the first unknown directive.
pub fn steps(markdown: &str) -> Result<Vec<Step>, BadDirective> {
    let mut steps = Vec::new();
    let mut directives = Directives::default();
    let mut in_comment = false;
    let mut lines = markdown.lines().enumerate();
    while let Some((index, raw)) = lines.next() {
        let line = raw.trim();
        if let Some(info) = line.strip_prefix("```") {
            let block: Vec<_> = lines
                .by_ref()
                .take_while(|(_, line)| line.trim() != "```")
                .collect();
            steps.extend(block_steps(info, &block, &directives));
            directives = Directives::default();
            continue;
        }
        let begun = line.strip_prefix(OPEN);
        if begun.is_none() && !in_comment {
            continue;
        }
        let text = begun.unwrap_or(line);
        let (text, closed) = match text.strip_suffix(CLOSE) {
            Some(text) => (text.trim(), true),
            None => (text.trim(), false),
        };
        in_comment = !closed;
        if !text.is_empty() {
            let hidden = directive(index + 1, text, &mut directives)?;
            steps.extend(hidden);
        }
    }
    Ok(steps)
}

/// Handles one directive. Returns a step if the directive is one.
fn directive<'a>(
    line: usize,
    text: &'a str,
    directives: &mut Directives<'a>,
) -> Result<Option<Step>, BadDirective> {
    let bad = || BadDirective {
        line,
        text: text.to_owned(),
    };
    let (word, rest) = text.split_once(' ').ok_or_else(bad)?;
    match word {
        "run" => {
            let command = rest.to_owned();
            return Ok(Some(Step::Run { line, command }));
        }
        "skip" => {
            let quoted = rest.strip_prefix('`');
            let skip = quoted.map_or(Some(("", rest)), |rest| rest.split_once('`'));
            let (beginning, reason) = skip.ok_or_else(bad)?;
            directives.skips.push((beginning, reason.trim()));
        }
        "file" => directives.file = Some(rest),
        _ => return Err(bad()),
    }
    Ok(None)
}

fn block_steps(info: &str, block: &[(usize, &str)], directives: &Directives<'_>) -> Vec<Step> {
    if let Some(name) = directives.file {
        let content = block.iter().map(|(_, line)| format!("{line}\n")).collect();
        let name = name.to_owned();
        return vec![Step::File { name, content }];
    }
    if !matches!(info.trim(), "" | "sh") {
        return Vec::new();
    }
    let commands = commands(block).into_iter();
    let steps = commands.map(|(line, command)| match directives.reason(&command) {
        Some(reason) => Step::Skip {
            line,
            command,
            reason,
        },
        None => Step::Run { line, command },
    });
    steps.collect()
}

/// The commands of a code block, each with its line number. A backslash at the end of a line continues the command.
fn commands(block: &[(usize, &str)]) -> Vec<(usize, String)> {
    let mut commands: Vec<(usize, String)> = Vec::new();
    let mut goes_on = false;
    for (index, line) in block {
        let line = line.trim();
        if !goes_on && (line.is_empty() || line.starts_with('#')) {
            continue;
        }
        let (part, more) = match line.strip_suffix('\\') {
            Some(part) => (part.trim_end(), true),
            None => (line, false),
        };
        match commands.last_mut() {
            Some((_, command)) if goes_on => {
                command.push(' ');
                command.push_str(part);
            }
            _ => commands.push((index + 1, part.to_owned())),
        }
        goes_on = more;
    }
    commands
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(line: usize, command: &str) -> Step {
        let command = command.to_owned();
        Step::Run { line, command }
    }

    #[test]
    fn commands_are_in_code_blocks_with_the_info_string_sh_or_none() {
        let page =
            "text\n```\na \\\n    b # why\n\n# nothing\n```\n```toml\nc = 1\n```\n```sh\nd\n```\n";
        let steps = steps(page).unwrap();
        assert_eq!(steps, [run(3, "a b # why"), run(12, "d")]);
    }

    #[test]
    fn directives_apply_to_the_next_block_only() {
        let page = "<!-- docs-test: run make -->\n<!-- docs-test:\nskip `cargo xtask` takes minutes\n-->\n\n\
                    ```\ncargo xtask test\nls\n```\n```\ncargo xtask test\n```\n<!-- docs-test: file a.txt -->\n\
                    ```text\none\n  two\n```\n";
        let skip = Step::Skip {
            line: 7,
            command: "cargo xtask test".into(),
            reason: "takes minutes".into(),
        };
        let file = Step::File {
            name: "a.txt".into(),
            content: "one\n  two\n".into(),
        };
        let expected = [
            run(1, "make"),
            skip,
            run(8, "ls"),
            run(11, "cargo xtask test"),
            file,
        ];
        assert_eq!(steps(page).unwrap(), expected);
    }

    #[test]
    fn an_unknown_directive_is_refused() {
        let error = steps("\n<!-- docs-test: hop -->\n").unwrap_err();
        assert_eq!((error.line, error.text.as_str()), (2, "hop"));
        assert!(steps("<!-- docs-test: skip `open -->\n").is_err());
    }
}
