//! Builds, checks, measures and flashes the firmware image.

use std::fmt;
use std::fs;
use std::path::Path;

use crate::image::{Image, ImageError};
use crate::{Failure, ensure, run, say, stack};
use firmware_build::{firmware, image_path};
use sha2::{Digest, Sha256};

/// Interrupts that the firmware serves, in the order of their priorities, with their numbers (RM0090, vector table).
const SERVED: [(usize, &str); 6] = [
    (17, "DMA1_STREAM6"),
    (46, "TIM8_CC"),
    (8, "EXTI2"),
    (44, "TIM8_UP_TIM13"),
    (40, "EXTI15_10"),
    (1, "PVD"),
];

/// Flash limit of the image, bytes.
pub const FLASH_LIMIT_BYTES: u64 = 128 * 1024;

/// RAM limit of its variables and its stack together, bytes.
pub const RAM_LIMIT_BYTES: u64 = 96 * 1024;

/// Builds and checks the image, and runs the lints on it.
pub fn check() -> Result<(), Failure> {
    ensure(say)?;
    run(firmware("clippy").args(["--quiet", "--", "--deny", "warnings"]))?;
    println!("{}", measured()?);
    Ok(())
}

/// Builds the image and prints its memory use.
pub fn size() -> Result<(), Failure> {
    ensure(say)?;
    println!("{}", measured()?);
    Ok(())
}

/// Builds, flashes and runs the image, and prints its log.
pub fn flash() -> Result<(), Failure> {
    ensure(say)?;
    run(&mut firmware("run"))
}

/// Builds the image and prints its path and its SHA-256.
pub fn image() -> Result<(), Failure> {
    ensure(say)?;
    run(firmware("build").arg("--quiet"))?;
    let path = image_path();
    println!("{}\nSHA-256 {}", path.display(), sha256(&bytes(&path)?));
    Ok(())
}

fn bytes(path: &Path) -> Result<Vec<u8>, Failure> {
    fs::read(path).map_err(|source| Failure::file(path, source))
}

/// SHA-256 in the format of `sha256sum`.
fn sha256(bytes: &[u8]) -> String {
    let digest = Sha256::digest(bytes);
    digest.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Memory use of an image.
pub struct Size {
    /// Flash use, bytes.
    pub flash_bytes: u64,
    /// RAM use of the variables, bytes.
    pub statics_bytes: u64,
    /// Largest RAM use of the stack, bytes.
    pub stack_bytes: u64,
    /// SHA-256 of the file in the format of `sha256sum`.
    sha256: String,
}

impl fmt::Display for Size {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            flash_bytes,
            statics_bytes,
            stack_bytes,
            sha256,
        } = self;
        let ram_bytes = statics_bytes + stack_bytes;
        write!(
            f,
            "firmware: flash {flash_bytes} of {FLASH_LIMIT_BYTES} bytes, RAM {ram_bytes} of {RAM_LIMIT_BYTES} bytes \
             (variables {statics_bytes}, worst stack {stack_bytes})\nSHA-256 {sha256}"
        )
    }
}

/// Builds, checks and measures the image.
pub fn measured() -> Result<Size, Failure> {
    run(firmware("build").arg("--quiet"))?;
    let bytes = bytes(&image_path())?;
    let image = Image::read(&bytes)?;
    image.check_vectors(&SERVED)?;
    image.check_settings_are_spared()?;
    image.check_single_precision()?;
    let flash_bytes = image.flash_bytes();
    if flash_bytes > FLASH_LIMIT_BYTES {
        return Err(ImageError::TooLarge {
            bytes: flash_bytes,
            limit: FLASH_LIMIT_BYTES,
        }
        .into());
    }
    let stack_bytes = stack::worst(&image, SERVED.map(|(_, name)| name))?;
    let statics_bytes = image.static_ram_bytes();
    if statics_bytes + stack_bytes > RAM_LIMIT_BYTES {
        return Err(ImageError::TooMuchRam {
            statics: statics_bytes,
            stack: stack_bytes,
            limit: RAM_LIMIT_BYTES,
        }
        .into());
    }
    Ok(Size {
        flash_bytes,
        statics_bytes,
        stack_bytes,
        sha256: sha256(&bytes),
    })
}
