//! Runs the commands of a page, with a virtual board in the background if a command starts one.

use std::fs::{self, File};
use std::io::{BufRead, BufReader, Read};
use std::os::unix::process::CommandExt;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc;
use std::thread;
use std::time::{Duration, Instant};

use crate::Failure;

/// Longest time of a command. The first command also builds the program.
const LONGEST: Duration = Duration::from_secs(30 * 60);
/// Interval at which a running command is polled.
const LOOK: Duration = Duration::from_millis(20);
/// Text that a virtual board prints before its serial port.
const PORT: &str = "serial port: ";
/// Ports named on the pages. They are replaced by the port of the running virtual board.
const PORTS_NAMED: [&str; 2] = ["/dev/ttyUSB0", "/dev/pts/3"];

/// Shell for the commands of one page.
pub struct Shell<'a> {
    folder: &'a Path,
    target: &'a Path,
    board: Option<Board>,
}

/// A command that failed.
#[derive(Debug)]
pub struct Trouble {
    /// Result of the command, such as its exit status.
    pub outcome: String,
    /// Output of the command.
    pub printed: String,
}

impl<'a> Shell<'a> {
    /// Creates a shell whose commands run in `folder`, with cargo's target folder at `target`.
    pub fn new(folder: &'a Path, target: &'a Path) -> Self {
        Self {
            folder,
            target,
            board: None,
        }
    }

    /// Runs a command to its end. A virtual board that runs until Ctrl-C stays in the background for the following commands,
    /// which use its port.
    ///
    /// # Errors
    /// Returns a [`Failure`] if the shell cannot be started.
    pub fn run(&mut self, command: &str) -> Result<Result<(), Trouble>, Failure> {
        let mut line = command.to_owned();
        if let Some(board) = &self.board {
            for named in PORTS_NAMED {
                line = line.replace(named, &board.port);
            }
        }
        if runs_until_interrupted(command) {
            self.board = None;
            let board = Board::start(self.shell(&line), command)?;
            return Ok(board.map(|board| self.board = Some(board)));
        }
        self.finish(&line)
    }

    fn finish(&self, line: &str) -> Result<Result<(), Trouble>, Failure> {
        let log = self.target.join("docs-test.log");
        let open = || File::create(&log).map_err(|e| Failure::file(&log, e));
        let file = open()?;
        let also = file.try_clone().map_err(|e| Failure::file(&log, e))?;
        let mut shell = self.shell(line);
        let spawned = shell.stdout(file).stderr(also).spawn();
        let mut child = Group(spawned.map_err(|source| Failure::spawn(&shell, source))?);
        let begun = Instant::now();
        let status = loop {
            let status = child.0.try_wait();
            match status.map_err(|source| Failure::spawn(&shell, source))? {
                Some(status) => break Some(status),
                None if begun.elapsed() > LONGEST => break None,
                None => thread::sleep(LOOK),
            }
        };
        if status.is_some_and(|status| status.success()) {
            return Ok(Ok(()));
        }
        let printed = fs::read(&log).unwrap_or_default();
        Ok(Err(Trouble {
            outcome: status.map_or("takes too long".to_owned(), |status| status.to_string()),
            printed: String::from_utf8_lossy(&printed).into_owned(),
        }))
    }

    /// A shell in its own process group, with the built program in its PATH.
    fn shell(&self, line: &str) -> Command {
        let before = std::env::var_os("PATH").unwrap_or_default();
        let built = self.target.join("release");
        let folders = std::iter::once(built).chain(std::env::split_paths(&before));
        let mut shell = Command::new("sh");
        shell
            .args(["-c", line])
            .current_dir(self.folder)
            .env("CARGO_TARGET_DIR", self.target)
            .stdin(Stdio::null())
            .process_group(0);
        if let Ok(path) = std::env::join_paths(folders) {
            shell.env("PATH", path);
        }
        shell
    }
}

/// Whether the command is a virtual board that runs until Ctrl-C.
fn runs_until_interrupted(command: &str) -> bool {
    let command = command.strip_prefix("cargo ").unwrap_or(command);
    command.starts_with("paddle board") && !command.contains("--seconds")
}

/// A process group. Dropping the value ends all its processes.
struct Group(Child);

impl Drop for Group {
    fn drop(&mut self) {
        if matches!(self.0.try_wait(), Ok(Some(_))) {
            return;
        }
        let group = format!("-{}", self.0.id());
        // If the group has ended in the meantime, the signal has no receiver.
        let _ = Command::new("kill").args(["-INT", "--", &group]).status();
        let _ = self.0.wait();
    }
}

/// A running virtual board.
struct Board {
    port: String,
    _process: Group,
}

impl Board {
    /// Starts the board and waits until it has printed its port.
    fn start(mut shell: Command, command: &str) -> Result<Result<Self, Trouble>, Failure> {
        let spawned = shell.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn();
        let mut process = Group(spawned.map_err(|source| Failure::spawn(&shell, source))?);
        let (said, hears) = mpsc::channel();
        let streams = [
            process
                .0
                .stdout
                .take()
                .map(|s| Box::new(s) as Box<dyn Read + Send>),
            process
                .0
                .stderr
                .take()
                .map(|s| Box::new(s) as Box<dyn Read + Send>),
        ];
        for stream in streams.into_iter().flatten() {
            let said = said.clone();
            // The thread reads the output to its end, so that the board is never blocked by a full pipe.
            thread::spawn(move || {
                for line in BufReader::new(stream).lines().map_while(Result::ok) {
                    let _ = said.send(line);
                }
            });
        }
        drop(said);
        let mut printed = String::new();
        while let Ok(line) = hears.recv_timeout(LONGEST) {
            if let Some(port) = line.strip_prefix(PORT) {
                return Ok(Ok(Self {
                    port: port.trim().to_owned(),
                    _process: process,
                }));
            }
            printed.push_str(&line);
            printed.push('\n');
        }
        Ok(Err(Trouble {
            outcome: format!("`{command}` named no serial port"),
            printed,
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_board_without_a_duration_stays_in_the_background() {
        assert!(runs_until_interrupted("cargo paddle board --plant nominal"));
        assert!(runs_until_interrupted("paddle board"));
        assert!(!runs_until_interrupted("paddle board --seconds 7"));
        assert!(!runs_until_interrupted("paddle demo --board"));
    }

    #[test]
    fn the_output_of_a_failing_command_is_reported() {
        let folder = std::env::temp_dir();
        let mut shell = Shell::new(&folder, &folder);
        let trouble = shell
            .run("echo one; echo two >&2; exit 3")
            .unwrap()
            .unwrap_err();
        assert!(trouble.outcome.contains('3'), "{}", trouble.outcome);
        assert_eq!(trouble.printed, "one\ntwo\n");
        assert!(shell.run("true").unwrap().is_ok());
    }
}
