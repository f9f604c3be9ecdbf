//! Checks the output paths of a command before its work, so that no result is lost because a path cannot be written.

use crate::failure::Failure;
use rustix::fs::OFlags;
use std::fs::{File, OpenOptions};
use std::io::{ErrorKind, Write};
use std::os::unix::fs::{FileTypeExt, OpenOptionsExt};
use std::path::{Path, PathBuf};

/// Purpose of a path on the command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Use {
    /// The path is read, so it must not be overwritten.
    Read,
    /// A file is written at the path and replaces an existing file.
    File,
    /// Files are written into the folder.
    Folder,
    /// Files are written into the folder, which must not contain a recording, because a recording may be a measurement.
    NewFolder,
}

/// A path on the command line.
#[derive(Clone, Copy, Debug)]
pub struct Target<'a> {
    /// The option that names the path.
    pub option: &'static str,
    /// Purpose of the path.
    pub purpose: Use,
    /// The path.
    pub path: &'a Path,
}

impl<'a> Target<'a> {
    /// The path of an option. Returns `None` if the option was left out.
    pub fn of(
        option: &'static str,
        purpose: Use,
        path: impl Into<Option<&'a PathBuf>>,
    ) -> Option<Self> {
        let path = path.into()?;
        Some(Self {
            option,
            purpose,
            path,
        })
    }
}

/// Named pipes that stay open. A reader would take the closing of its pipe for the end of the data.
pub struct Held {
    _pipes: Vec<File>,
}

/// Checks that every target can be written, and that no two targets are the same file. Returns the open pipes, which the
/// caller keeps until the results are written.
///
/// # Errors
/// Returns [`Failure::Target`] or [`Failure::HoldsRecording`] for the first target that fails.
pub fn check(targets: &[Target]) -> Result<Held, Failure> {
    for (at, target) in targets.iter().enumerate() {
        let place = target.place();
        let same = |other: &&Target| {
            let is_written = target.purpose != Use::Read || other.purpose != Use::Read;
            is_written && place.is_some() && other.place() == place
        };
        if let Some(other) = targets[..at].iter().find(same) {
            return Err(target.refused(format!("{} names the same; name another", other.option)));
        }
    }
    let mut pipes = Vec::new();
    for target in targets {
        pipes.extend(target.check()?);
    }
    Ok(Held { _pipes: pipes })
}

impl Target<'_> {
    fn refused(&self, why: String) -> Failure {
        Failure::Target {
            option: self.option,
            path: self.path.to_owned(),
            why,
        }
    }

    /// The canonical path of the target. Returns `None` for a device, which several targets may share.
    fn place(&self) -> Option<PathBuf> {
        if let Ok(metadata) = self.path.metadata()
            && metadata.file_type().is_char_device()
        {
            return None;
        }
        let mut rest = PathBuf::new();
        let mut there = self.path;
        loop {
            let base = if there == Path::new("") {
                Path::new(".")
            } else {
                there
            };
            if let Ok(base) = base.canonicalize() {
                // If the complete path exists, the rest is empty. Joining an empty path would add a slash.
                let is_whole = rest.as_os_str().is_empty();
                return Some(if is_whole { base } else { base.join(rest) });
            }
            rest = match (there.file_name(), rest.as_os_str().is_empty()) {
                (Some(name), true) => name.into(),
                (Some(name), false) => Path::new(name).join(rest),
                (None, _) => return None,
            };
            there = there.parent()?;
        }
    }

    fn check(&self) -> Result<Option<File>, Failure> {
        let is_empty = self.path.as_os_str().is_empty();
        match self.purpose {
            Use::Read => Ok(None),
            _ if is_empty => Err(self.refused("the name is empty; write one".into())),
            Use::File => self.check_file(),
            Use::NewFolder if self.path.join(RECORDING).exists() => {
                Err(Failure::HoldsRecording(self.path.to_owned()))
            }
            Use::Folder | Use::NewFolder => self.check_folder().map(|()| None),
        }
    }

    /// Returns a pipe as an open file.
    fn check_file(&self) -> Result<Option<File>, Failure> {
        let refused = |error: std::io::Error| self.refused(format!("{error}; name another place"));
        let folder = match self.path.parent() {
            Some(parent) if parent != Path::new("") => parent,
            _ => Path::new("."),
        };
        let kind = match self.path.metadata() {
            Ok(metadata) => metadata.file_type(),
            Err(error) if error.kind() == ErrorKind::NotFound => {
                if !folder.is_dir() {
                    let folder = folder.display();
                    return Err(self.refused(format!("the folder {folder} is not there; make it")));
                }
                return tried(self.path).map(|()| None).map_err(refused);
            }
            Err(error) => return Err(refused(error)),
        };
        if kind.is_dir() {
            return Err(self.refused("this is a folder; name a file".into()));
        }
        if kind.is_block_device() {
            return Err(self.refused("this is a disk; name a file".into()));
        }
        if kind.is_file() && is_recorded(self.path, folder) {
            return Err(Failure::HoldsRecording(folder.to_owned()));
        }
        let mut options = OpenOptions::new();
        options.write(true);
        if kind.is_fifo() {
            // A pipe without a reader is refused at once; otherwise opening it would block the program.
            options.custom_flags(OFlags::NONBLOCK.bits().cast_signed());
        }
        let mut file = options.open(self.path).map_err(|error| {
            if kind.is_fifo() {
                self.refused("nobody reads from this pipe; start its reader first".into())
            } else {
                refused(error)
            }
        })?;
        if kind.is_char_device() {
            // A device that cannot be written reports this even for an empty write.
            file.write(&[]).map_err(refused)?;
        }
        Ok(kind.is_fifo().then_some(file))
    }

    fn check_folder(&self) -> Result<(), Failure> {
        let refused = |error: std::io::Error| self.refused(format!("{error}; name another folder"));
        let mut there = self.path;
        loop {
            if there == Path::new("") {
                there = Path::new(".");
            }
            match there.metadata() {
                Ok(metadata) if metadata.is_dir() => break,
                Ok(_) => {
                    let file = there.display();
                    return Err(self.refused(format!("{file} is no folder; name another")));
                }
                Err(error) if error.kind() == ErrorKind::NotFound => {}
                // A parent of the folder is a file.
                Err(error) if error.kind() == ErrorKind::NotADirectory => {}
                Err(error) => return Err(refused(error)),
            }
            there = there.parent().unwrap_or(Path::new("."));
        }
        tried(&there.join(format!(".paddle-{}", std::process::id()))).map_err(refused)
    }
}

const RECORDING: &str = "recording.toml";

/// Whether the file `path` in `folder` belongs to a recording.
fn is_recorded(path: &Path, folder: &Path) -> bool {
    let is_part = path.ends_with(RECORDING) || path.extension().is_some_and(|end| end == "csv");
    is_part && folder.join(RECORDING).exists()
}

/// Creates the file `path` and removes it again.
fn tried(path: &Path) -> std::io::Result<()> {
    OpenOptions::new()
        .write(true)
        .create(true)
        .truncate(false)
        .open(path)?;
    // If `path` is a link, the file that it points to is removed.
    std::fs::remove_file(path.canonicalize()?)
}
