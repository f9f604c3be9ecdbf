//! Compares every register that the virtual board models with the vendor's SVD: offset, reset value, access, and width of
//! fields.
//!
//! ```text
//! cd virtual-board/registers && cargo run
//! ```
//!
//! The comparison uses no table of the board: it accesses the registers. It reads each word of a peripheral on a chip after
//! reset and writes it with each bit changed. A bit that keeps the written value is a writable field. Any other bit is
//! reserved, read-only, or triggers an action. A write that is refused by name is not modelled and counts as no difference.
//! `explained.rs` lists the intended differences with their reasons. Every other difference fails.

mod explained;
mod svd;
mod trial;

use std::process::ExitCode;

use svd::{Access, Register, Source};
use trial::{Effect, Trial};

/// Peripherals: name, base address, name in the SVD, and size in bytes.
const PERIPHERALS: [(&str, u32, &str, u32); 23] = [
    ("TIM2", 0x4000_0000, "tim2", 0x54),
    ("TIM3", 0x4000_0400, "tim3", 0x54),
    ("TIM5", 0x4000_0C00, "tim5", 0x54),
    ("IWDG", 0x4000_3000, "iwdg", 0x10),
    ("USART2", 0x4000_4400, "usart1", 0x1C),
    ("PWR", 0x4000_7000, "pwr", 0x08),
    ("TIM8", 0x4001_0400, "tim1", 0x50),
    ("ADC1", 0x4001_2000, "adc1", 0x50),
    ("ADC2", 0x4001_2100, "adc1", 0x50),
    ("ADC3", 0x4001_2200, "adc1", 0x50),
    ("ADC_COMMON", 0x4001_2300, "adc_common", 0x0C),
    ("SYSCFG", 0x4001_3800, "syscfg", 0x24),
    ("EXTI", 0x4001_3C00, "exti", 0x18),
    ("GPIOA", 0x4002_0000, "gpioa", 0x28),
    ("GPIOB", 0x4002_0400, "gpiob", 0x28),
    ("GPIOC", 0x4002_0800, "gpioi", 0x28),
    ("GPIOD", 0x4002_0C00, "gpioi", 0x28),
    ("GPIOE", 0x4002_1000, "gpioi", 0x28),
    ("RCC", 0x4002_3800, "rcc", 0x90),
    ("FLASH", 0x4002_3C00, "flash", 0x18),
    ("DMA1", 0x4002_6000, "dma2", 0xD0),
    ("DMA2", 0x4002_6400, "dma2", 0xD0),
    ("DBGMCU", 0xE004_2000, "dbgmcu", 0x10),
];

fn main() -> ExitCode {
    match compare() {
        Ok(0) => ExitCode::SUCCESS,
        Ok(differences) => {
            println!("{differences} unexplained differences");
            ExitCode::FAILURE
        }
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn compare() -> Result<usize, svd::SvdError> {
    let source = Source::find()?;
    let mut differences = 0;
    let (mut registers, mut bits, mut refused, mut explained) = (0, 0, 0, 0);
    for (name, base, description, bytes) in PERIPHERALS {
        let described = source.registers(description)?;
        for offset in (0..bytes).step_by(4) {
            let Some(trial) = Trial::of(base + offset) else {
                continue;
            };
            registers += 1;
            let there: Vec<_> = described.iter().filter(|r| r.offset == offset).collect();
            let mut found = Vec::new();
            if there.is_empty() {
                found.push((None, "no such register".to_owned()));
            } else {
                judge(&trial, &there, &mut found);
            }
            bits += trial
                .effects
                .iter()
                .filter(|e| **e != Effect::Refused)
                .count();
            refused += trial
                .effects
                .iter()
                .filter(|e| **e == Effect::Refused)
                .count();
            let known = there.first().map_or("?", |register| register.name.as_str());
            for (bit, what) in found {
                if explained::reason(name, known, bit).is_some() {
                    explained += 1;
                    continue;
                }
                differences += 1;
                let bit = bit.map_or(String::new(), |bit| format!(", bit {bit}"));
                println!("{name}.{known} + {offset:#04x}{bit}: {what}");
            }
        }
    }
    println!(
        "{registers} registers, {bits} bits tried, {refused} bits refused by name, {explained} differences explained"
    );
    Ok(differences)
}

/// Differences between a tested register and its description, under any of its names.
fn judge(trial: &Trial, described: &[&Register], found: &mut Vec<(Option<u32>, String)>) {
    let register = described[0];
    if trial.reset != register.reset {
        let (ours, theirs) = (trial.reset, register.reset);
        found.push((
            None,
            format!("reset value {ours:#010x}, not {theirs:#010x}"),
        ));
    }
    for bit in 0..32 {
        let access = described
            .iter()
            .map(|register| register.access(bit))
            .fold(Access::NONE, Access::or);
        let what = match (trial.effects[bit as usize], access) {
            (Effect::Refused, _) => continue,
            (
                Effect::Sticks,
                Access {
                    writable: true,
                    readable: true,
                },
            ) => continue,
            (
                Effect::Nothing,
                Access {
                    writable: false, ..
                },
            ) => continue,
            (Effect::Sticks, Access { writable: true, .. }) => {
                "can be read, and is for writing only"
            }
            (Effect::Sticks, Access { readable: true, .. }) => "can be written, and is read-only",
            (Effect::Sticks, _) => "can be written, and is reserved",
            (Effect::Nothing, Access { readable: true, .. }) => "cannot be written",
            // A write-only bit reads as zero.
            (Effect::Nothing, _) => continue,
            (Effect::Other, _) => "changes other bits",
        };
        found.push((Some(bit), what.to_owned()));
    }
}
