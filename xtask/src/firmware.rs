//! The firmware image: built, checked, measured, flashed.

use std::fs;

use crate::image::{Image, ImageError};
use crate::{Failure, cargo, ensure, run, say, stack};
use firmware_build::{OPTIONS, image_path};

/// Boards, by their cargo features; the default one comes last, so that its image is the one that stays.
const BOARDS: [&str; 2] = ["nucleo-f446", DEFAULT_BOARD];
const DEFAULT_BOARD: &str = "paddle-f407";

/// Interrupts that the app serves, in the order of their priorities, with their numbers, which all boards share
/// (reference manuals of STM32F407 and STM32F446, vector tables).
const SERVED: [(usize, &str); 3] = [(38, "USART2"), (44, "TIM8_UP_TIM13"), (40, "EXTI15_10")];

/// Most that the image may take of the flash, bytes.
const FLASH_LIMIT_BYTES: u64 = 64 * 1024;

/// Builds and checks the image of every board, with its lints.
pub fn check() -> Result<(), Failure> {
    ensure(say)?;
    for board in BOARDS {
        run(cargo(&["clippy", "--quiet"])
            .args(options(board))
            .args(["--", "--deny", "warnings"]))?;
        println!("{}", measure(board)?);
    }
    Ok(())
}

/// Builds the default board's image and prints what it takes.
pub fn size() -> Result<(), Failure> {
    ensure(say)?;
    println!("{}", measure(DEFAULT_BOARD)?);
    Ok(())
}

/// Builds, flashes and runs the default board's image, with its log.
pub fn flash() -> Result<(), Failure> {
    ensure(say)?;
    run(cargo(&["run"]).args(options(DEFAULT_BOARD)))
}

fn options(board: &str) -> Vec<&str> {
    let mut options = OPTIONS.to_vec();
    options.extend(["--no-default-features", "--features", board]);
    options
}

/// Builds an image and says what it takes, once it is found sound.
fn measure(board: &str) -> Result<String, Failure> {
    run(cargo(&["build", "--quiet"]).args(options(board)))?;
    let path = image_path();
    let bytes = fs::read(&path).map_err(|source| Failure::File {
        path: path.clone(),
        source,
    })?;
    let image = Image::read(&bytes)?;
    image.check_vectors(&SERVED)?;
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
    let left = image.stack_room_bytes();
    if stack > left {
        return Err(ImageError::StackTooDeep {
            bytes: stack,
            room: left,
        }
        .into());
    }
    Ok(format!(
        "firmware for {board}: flash {flash} of {FLASH_LIMIT_BYTES} bytes, static RAM {} bytes, \
         worst stack {stack} of {left} bytes",
        image.static_ram_bytes(),
    ))
}
