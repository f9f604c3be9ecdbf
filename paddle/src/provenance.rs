//! Provenance of a result: program version, command, time, and checksums of the input files.

use crate::failure::Failure;
use chrono::{SecondsFormat, Utc};
use recording::Recording;
use serde::Serialize;
use sha2::{Digest, Sha256};
use std::io::Read;
use std::path::Path;

const MANIFEST: &str = "recording.toml";

/// Provenance of a result.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Provenance {
    /// Version of this program.
    pub version: &'static str,
    /// The commit from which the program was built, with the suffix `-dirty` if files differed from it. It is `unknown`
    /// outside a repository.
    pub commit: &'static str,
    /// The command as it was typed, quoted for a shell.
    pub command: String,
    /// Time of the call, in UTC (RFC 3339).
    pub time: String,
    /// The input files.
    pub files: Vec<InputFile>,
}

/// An input file.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct InputFile {
    /// Name of the file, relative to the folder of the recording.
    pub file: String,
    /// SHA-256 of the file's bytes, in hexadecimal digits.
    pub sha256: String,
}

impl Provenance {
    /// The provenance of a result of this call on the recording in `folder`.
    ///
    /// # Errors
    /// Returns [`Failure::Read`] if a file cannot be read.
    pub fn of(folder: &Path, recording: &Recording) -> Result<Self, Failure> {
        let runs = recording.runs.iter().map(|run| run.file.as_str());
        let files = [MANIFEST].into_iter().chain(runs);
        let files = files.map(|file| InputFile::read(file, &folder.join(file)));
        Ok(Self {
            version: env!("CARGO_PKG_VERSION"),
            commit: env!("PADDLE_COMMIT"),
            command: command(std::env::args_os().map(|word| word.to_string_lossy().into_owned())),
            time: Utc::now().to_rfc3339_opts(SecondsFormat::Secs, true),
            files: files.collect::<Result<_, _>>()?,
        })
    }

    /// Adds a further input file.
    ///
    /// # Errors
    /// Returns [`Failure::Read`] if the file cannot be read.
    pub fn and(mut self, path: &Path) -> Result<Self, Failure> {
        self.files
            .push(InputFile::read(&path.display().to_string(), path)?);
        Ok(self)
    }
}

/// Bytes of a file that are in memory at once.
const PART_BYTES: usize = 1 << 16;

impl InputFile {
    fn read(file: &str, path: &Path) -> Result<Self, Failure> {
        let mut source = recording::open_file(path, "give a file that can be read")?;
        let mut hash = Sha256::new();
        let mut part = vec![0; PART_BYTES];
        loop {
            let read = source.read(&mut part).map_err(Failure::read(path))?;
            if read == 0 {
                break;
            }
            hash.update(&part[..read]);
        }
        let digits = hash
            .finalize()
            .iter()
            .map(|byte| format!("{byte:02x}"))
            .collect();
        Ok(Self {
            file: file.to_owned(),
            sha256: digits,
        })
    }
}

/// The command line quoted for a shell. The program is given by its name without its folder.
fn command(arguments: impl Iterator<Item = String>) -> String {
    let words = arguments.enumerate().map(|(place, word)| match place {
        0 => Path::new(&word)
            .file_name()
            .map_or(word.clone(), |name| name.to_string_lossy().into_owned()),
        _ => word,
    });
    let words = words.map(|word| shlex::try_quote(&word).map_or(word.clone(), Into::into));
    words.collect::<Vec<_>>().join(" ")
}

/// A provenance for tests.
#[cfg(test)]
pub fn example() -> Provenance {
    Provenance {
        version: "0.1.0",
        commit: "0123abcd",
        command: "paddle gap diagnose 'a & b'".into(),
        time: "2026-01-02T03:04:05Z".into(),
        files: vec![InputFile {
            file: "sine.csv".into(),
            sha256: "00ff".into(),
        }],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_command_is_quoted_where_a_shell_would_split_it() {
        let words = ["/usr/bin/paddle", "gap", "diagnose", "my recording"].map(String::from);
        assert_eq!(
            command(words.into_iter()),
            "paddle gap diagnose 'my recording'"
        );
    }
}
