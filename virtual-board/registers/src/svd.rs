//! The vendor's register description, read from the sources of the register crate.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Why the description cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum SvdError {
    #[error("cargo does not say where the register crate's sources are: {0}")]
    Metadata(String),
    #[error("cannot read {}: {source}", path.display())]
    File {
        path: PathBuf,
        source: std::io::Error,
    },
    #[error("no description of {0} is understood; has the register crate changed its form?")]
    Form(String),
}

/// Allowed accesses of a bit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Access {
    pub readable: bool,
    pub writable: bool,
}

impl Access {
    /// Neither read nor write: a reserved bit.
    pub const NONE: Self = Self {
        readable: false,
        writable: false,
    };

    /// The accesses that at least one of the two allows.
    pub fn or(self, other: Self) -> Self {
        Self {
            readable: self.readable || other.readable,
            writable: self.writable || other.writable,
        }
    }
}

/// A register of the description.
#[derive(Debug, Clone)]
pub struct Register {
    pub name: String,
    pub offset: u32,
    pub reset: u32,
    readable: u32,
    writable: u32,
}

impl Register {
    /// Allowed accesses of `bit`.
    pub fn access(&self, bit: u32) -> Access {
        Access {
            readable: self.readable >> bit & 1 == 1,
            writable: self.writable >> bit & 1 == 1,
        }
    }
}

/// Folder of the chip in the sources of the register crate.
pub struct Source(PathBuf);

impl Source {
    /// Finds the folder in which cargo keeps the sources.
    pub fn find() -> Result<Self, SvdError> {
        let unknown = |why: &dyn std::fmt::Display| SvdError::Metadata(why.to_string());
        let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
        let output = Command::new(cargo)
            .args(["metadata", "--format-version", "1", "--manifest-path"])
            .arg(concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.toml"))
            .output()
            .map_err(|error| unknown(&error))?;
        let metadata: serde_json::Value =
            serde_json::from_slice(&output.stdout).map_err(|error| unknown(&error))?;
        let packages = metadata["packages"].as_array();
        let manifest = packages
            .and_then(|packages| packages.iter().find(|package| package["name"] == "stm32f4"))
            .and_then(|package| package["manifest_path"].as_str())
            .ok_or_else(|| unknown(&"it knows no package stm32f4"))?;
        let root = Path::new(manifest).parent().unwrap_or(Path::new("."));
        Ok(Self(root.join("src/stm32f407")))
    }

    /// The registers of a peripheral. `peripheral` is its name in the SVD.
    pub fn registers(&self, peripheral: &str) -> Result<Vec<Register>, SvdError> {
        let registers = self.block(&self.0.join(peripheral), 0)?;
        if registers.is_empty() {
            return Err(SvdError::Form(peripheral.to_owned()));
        }
        Ok(registers)
    }

    /// The registers of a block described in `module`.rs, including those of its clusters.
    fn block(&self, module: &Path, base: u32) -> Result<Vec<Register>, SvdError> {
        let text = read(&module.with_extension("rs"))?;
        let mut registers = Vec::new();
        let mut lines = text.lines();
        while let Some(line) = lines.next() {
            let Some(place) = line.trim().strip_prefix("///0x") else {
                continue;
            };
            let Some((place, _)) = place.split_once(" - ") else {
                continue;
            };
            // The accessor follows after its attribute.
            let Some(accessor) = lines.find(|line| line.contains("fn ")) else {
                break;
            };
            let Some(kind) = accessor
                .split("&")
                .last()
                .and_then(|rest| rest.split([' ', '>']).next())
            else {
                continue;
            };
            let described = module.join(kind.to_lowercase());
            match place.split_once("..") {
                None => {
                    let offset = base + hex(place);
                    registers.push(self.register(module, &text, kind, offset)?);
                }
                Some((first, behind)) if described.is_dir() && !accessor.contains("_iter") => {
                    let first = hex(first);
                    let behind = hex(behind.trim_start_matches("0x"));
                    let count = array_length(&text, kind).unwrap_or(1);
                    for index in 0..count {
                        let at = base + first + index * (behind - first) / count;
                        registers.extend(self.block(&described, at)?);
                    }
                }
                // Each element of an array is also listed by itself.
                Some(_) => {}
            }
        }
        Ok(registers)
    }

    fn register(
        &self,
        module: &Path,
        block: &str,
        kind: &str,
        offset: u32,
    ) -> Result<Register, SvdError> {
        let own = module.join(kind.to_lowercase()).with_extension("rs");
        // A peripheral derived from another one has the registers of that one.
        let path = if own.exists() {
            own
        } else {
            let borrowed = block
                .lines()
                .filter_map(|line| line.trim().strip_prefix("pub use crate::stm32f407::"))
                .find_map(|rest| rest.strip_suffix(&format!("::{kind};")))
                .ok_or_else(|| SvdError::Form(format!("{}::{kind}", module.display())))?;
            self.0
                .join(borrowed)
                .join(kind.to_lowercase())
                .with_extension("rs")
        };
        let text = read(&path)?;
        let mut masks = BTreeMap::from([("R", 0), ("W", 0)]);
        let mut side = "";
        for line in text.lines() {
            if let Some(name) = line.strip_prefix("impl ") {
                side = match name.split(' ').next() {
                    Some("R") => "R",
                    Some("W") => "W",
                    _ => "",
                };
            }
            if let Some(mask) = masks.get_mut(side) {
                *mask |= field(line.trim());
            }
        }
        let reset = text
            .lines()
            .find_map(|line| line.trim().strip_prefix("const RESET_VALUE: u32 = 0x"))
            .map_or(0, |value| hex(value.trim_end_matches(';')));
        // A register without fields is one field.
        let whole = |trait_name: &str, mask: u32| {
            let has = text.contains(&format!("impl crate::{trait_name} for"));
            match (has, mask) {
                (false, _) => 0,
                (true, 0) => u32::MAX,
                (true, mask) => mask,
            }
        };
        Ok(Register {
            name: kind.to_owned(),
            offset,
            reset,
            readable: whole("Readable", masks["R"]),
            writable: whole("Writable", masks["W"]),
        })
    }
}

/// Bits of the field that a line of documentation describes.
fn field(line: &str) -> u32 {
    let number = |text: &str| text.trim().parse::<u32>().ok();
    if let Some(rest) = line.strip_prefix("///Bit ") {
        return number(rest.split(" -").next().unwrap_or("")).map_or(0, |bit| 1 << bit);
    }
    let span = line
        .strip_prefix("///Bits ")
        .and_then(|rest| rest.split(" -").next())
        .and_then(|span| span.split_once(':'));
    match span.map(|(first, last)| (number(first), number(last))) {
        Some((Some(first), Some(last))) => {
            (u32::MAX >> (31 - (last - first).min(31))).wrapping_shl(first)
        }
        _ => 0,
    }
}

/// Number of elements of the array of this kind.
fn array_length(text: &str, kind: &str) -> Option<u32> {
    let (_, rest) = text.split_once(&format!("[{kind}; "))?;
    rest.split(']').next()?.parse().ok()
}

fn hex(text: &str) -> u32 {
    u32::from_str_radix(&text.trim().replace('_', ""), 16).unwrap_or(u32::MAX)
}

fn read(path: &Path) -> Result<String, SvdError> {
    fs::read_to_string(path).map_err(|source| SvdError::File {
        path: path.to_owned(),
        source,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_read_from_their_documentation() {
        assert_eq!(field("///Bit 15 - Main output enable"), 1 << 15);
        assert_eq!(field("///Bits 4:6 - Output compare 1 mode"), 0b111 << 4);
        assert_eq!(field("///Bits 0:31 - Counter"), u32::MAX);
        assert_eq!(field("///Output compare 1 mode"), 0);
    }
}
