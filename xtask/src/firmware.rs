//! The firmware image: built, checked, measured, flashed.

use std::fs;
use std::path::PathBuf;

use crate::image::{Image, ImageError};
use crate::{Failure, cargo, root, run, stack, target};

/// A board that the firmware is built for, by its cargo feature.
struct Board {
    feature: &'static str,
    /// Interrupts that its app serves, by number.
    served: &'static [(usize, &'static str)],
}

/// All boards, the default one last, so that its image is the one that stays.
const BOARDS: [Board; 2] = [
    Board {
        feature: "nucleo-f446",
        served: &SERVED,
    },
    Board {
        feature: "paddle-f407",
        served: &SERVED,
    },
];

/// The same on the STM32F407 and the STM32F446 (reference manuals, vector tables).
const SERVED: [(usize, &str); 3] = [(38, "USART2"), (40, "EXTI15_10"), (44, "TIM8_UP_TIM13")];

/// Interrupts in the order in which they can preempt one another, after the idle loop.
const PREEMPTING: [&str; 3] = ["USART2", "TIM8_UP_TIM13", "EXTI15_10"];

/// Most that the image may take of the flash, bytes.
const FLASH_LIMIT_BYTES: u64 = 64 * 1024;

/// Builds and checks the image of every board, with its lints.
pub fn check() -> Result<(), Failure> {
    target::ensure()?;
    for board in &BOARDS {
        run(cargo(&["clippy", "--quiet"])
            .args(options(board))
            .args(["--", "--deny", "warnings"]))?;
        println!("{}", measure(board)?);
    }
    Ok(())
}

/// Builds the default board's image and prints what it takes.
pub fn size() -> Result<(), Failure> {
    target::ensure()?;
    println!("{}", measure(&BOARDS[BOARDS.len() - 1])?);
    Ok(())
}

/// Builds, flashes and runs the default board's image, with its log.
pub fn flash() -> Result<(), Failure> {
    target::ensure()?;
    run(cargo(&["run"]).args(options(&BOARDS[BOARDS.len() - 1])))
}

fn options(board: &Board) -> Vec<&'static str> {
    let mut options = vec!["--package", "haptic-paddle", "--bin", "firmware"];
    options.extend(["--profile", "firmware", "--target", target::THUMB]);
    options.extend(["--no-default-features", "--features", board.feature]);
    options
}

/// Builds an image and says what it takes, once it is found sound.
fn measure(board: &Board) -> Result<String, Failure> {
    run(cargo(&["build", "--quiet"]).args(options(board)))?;
    let path = image_path();
    let bytes = fs::read(&path).map_err(|source| Failure::File {
        path: path.clone(),
        source,
    })?;
    let image = Image::read(&bytes)?;
    image.check_vectors(board.served)?;
    image.check_single_precision()?;
    let flash = image.flash_bytes();
    if flash > FLASH_LIMIT_BYTES {
        return Err(ImageError::TooLarge {
            bytes: flash,
            limit: FLASH_LIMIT_BYTES,
        }
        .into());
    }
    let stack = stack::worst(&image, &PREEMPTING)?;
    let left = image.stack_room_bytes();
    if stack > left {
        return Err(ImageError::StackTooDeep {
            bytes: stack,
            room: left,
        }
        .into());
    }
    Ok(format!(
        "firmware for {}: flash {flash} of {FLASH_LIMIT_BYTES} bytes, static RAM {} bytes, \
         worst stack {stack} of {left} bytes",
        board.feature,
        image.static_ram_bytes(),
    ))
}

/// Where cargo puts the image.
fn image_path() -> PathBuf {
    let folder = std::env::var_os("CARGO_TARGET_DIR")
        .map_or_else(|| root().join("target"), |folder| root().join(folder));
    folder.join(target::THUMB).join("firmware/firmware")
}
