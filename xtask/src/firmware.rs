//! The firmware image: built, checked, measured, flashed.

use std::fs;

use crate::image::{Image, ImageError};
use crate::{Failure, cargo, ensure, run, say, stack};
use firmware_build::{OPTIONS, image_path};

/// Interrupts that the app serves, in the order of their priorities, with their numbers (RM0090, vector table).
const SERVED: [(usize, &str); 6] = [
    (17, "DMA1_STREAM6"),
    (46, "TIM8_CC"),
    (8, "EXTI2"),
    (44, "TIM8_UP_TIM13"),
    (40, "EXTI15_10"),
    (1, "PVD"),
];

/// Most that the image may take of the flash, bytes.
const FLASH_LIMIT_BYTES: u64 = 128 * 1024;

/// Most that its variables and its stack together may take of the RAM, bytes.
const RAM_LIMIT_BYTES: u64 = 96 * 1024;

/// Builds and checks the image, with its lints.
pub fn check() -> Result<(), Failure> {
    ensure(say)?;
    run(cargo(&["clippy", "--quiet"])
        .args(OPTIONS)
        .args(["--", "--deny", "warnings"]))?;
    println!("{}", measure()?);
    Ok(())
}

/// Builds the image and prints what it takes.
pub fn size() -> Result<(), Failure> {
    ensure(say)?;
    println!("{}", measure()?);
    Ok(())
}

/// Builds, flashes and runs the image, with its log.
pub fn flash() -> Result<(), Failure> {
    ensure(say)?;
    run(cargo(&["run"]).args(OPTIONS))
}

/// Builds the image and says what it takes, once it is found sound.
fn measure() -> Result<String, Failure> {
    run(cargo(&["build", "--quiet"]).args(OPTIONS))?;
    let path = image_path();
    let bytes = fs::read(&path).map_err(|source| Failure::File {
        path: path.clone(),
        source,
    })?;
    let image = Image::read(&bytes)?;
    image.check_vectors(&SERVED)?;
    image.check_settings_are_spared()?;
    image.check_single_precision()?;
    let flash = image.flash_bytes();
    if flash > FLASH_LIMIT_BYTES {
        return Err(ImageError::TooLarge {
            bytes: flash,
            limit: FLASH_LIMIT_BYTES,
        }
        .into());
    }
    let stack = stack::worst(&image, SERVED.map(|(_, name)| name))?;
    let statics = image.static_ram_bytes();
    if statics + stack > RAM_LIMIT_BYTES {
        return Err(ImageError::TooMuchRam {
            statics,
            stack,
            limit: RAM_LIMIT_BYTES,
        }
        .into());
    }
    Ok(format!(
        "firmware: flash {flash} of {FLASH_LIMIT_BYTES} bytes, RAM {} of {RAM_LIMIT_BYTES} bytes \
         (variables {statics}, worst stack {stack})",
        statics + stack,
    ))
}
