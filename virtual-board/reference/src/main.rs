//! Compares the virtual processor core with Unicorn: both execute the same instruction from the same state.
//!
//! ```text
//! cd virtual-board/reference && cargo run --release [-- IMAGE]
//! ```
//!
//! It compares every distinct instruction of the firmware image, by default the one that `cargo fw` builds. It also compares
//! every 16-bit instruction, in and outside an IT block, and 32-bit instructions with every first and random second
//! halfwords. The states are random, with many edge values. It prints what was compared and what was left out. It fails on
//! any difference.

mod machine;
mod ours;
mod outcome;
mod state;
mod theirs;
mod words;

use std::collections::BTreeMap;
use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use machine::Machine;
use ours::Ours;
use outcome::{Outcome, Verdict};
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::SeedableRng;
use state::State;
use theirs::Theirs;
use words::Trial;

const SEED: u64 = 1;
const DIFFERENCES_SHOWN: usize = 40;

fn main() -> ExitCode {
    let image = std::env::args_os().nth(1).map_or_else(
        || {
            PathBuf::from(env!("CARGO_MANIFEST_DIR"))
                .join("../../target/thumbv7em-none-eabihf/firmware/firmware")
        },
        PathBuf::from,
    );
    match compare(&image) {
        Ok(0) => ExitCode::SUCCESS,
        Ok(differences) => {
            println!("{differences} differences");
            ExitCode::FAILURE
        }
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn compare(image: &Path) -> Result<usize, Box<dyn Error>> {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(SEED);
    let memory = machine::random_memory(&mut random);
    let mut pair = Pair {
        ours: Ours::new(&memory),
        theirs: Theirs::new(&memory)?,
    };
    let mut addresses = machine::addresses();
    let mut differences = 0;
    for (name, trials) in [
        ("instructions of the image", words::of_image(image)?),
        ("16-bit instructions", words::narrow(&mut random)),
        ("32-bit instructions", words::wide(&mut random)),
        ("32-bit instructions of the FPU", words::float(&mut random)),
    ] {
        let mut counts = BTreeMap::<&str, usize>::new();
        let instructions = trials.len();
        for trial in trials {
            for _ in 0..trial.states {
                let state = State::random(&mut random, trial.wants_alignment());
                let address = addresses.next().ok_or("no place for code")?;
                let verdict = pair.compare(&trial, address, &state)?;
                *counts.entry(verdict.name()).or_default() += 1;
                if let Verdict::Different(what) = verdict {
                    differences += 1;
                    if differences <= DIFFERENCES_SHOWN {
                        println!("{trial}: {what}");
                    }
                    // One failing example per instruction is enough.
                    break;
                }
            }
        }
        println!("{instructions} {name}:");
        for (verdict, count) in counts {
            println!("  {count:9} {verdict}");
        }
    }
    Ok(differences)
}

struct Pair {
    ours: Ours,
    theirs: Theirs,
}

impl Pair {
    fn compare(
        &mut self,
        trial: &Trial,
        address: u32,
        state: &State,
    ) -> Result<Verdict, Box<dyn Error>> {
        if let Some(reason) = outcome::left_out(trial) {
            return Ok(Verdict::LeftOut(reason));
        }
        let ours = self.ours.execute(trial, address, state)?;
        if matches!(ours, Outcome::Unpredictable) {
            // Unicorn might change more than this program restores.
            return Ok(Verdict::Unpredictable);
        }
        let theirs = self.theirs.execute(trial, address, state)?;
        Ok(outcome::judge(trial, state, &ours, &theirs))
    }
}
