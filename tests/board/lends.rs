//! Records when the console accessed the controller in the image.
//!
//! Between two control periods the console loop borrows the controller under a lock that raises BASEPRI. The address of the
//! locking instruction shows the borrower: the periodic check once per millisecond, or a typed command.

use std::collections::VecDeque;

use crate::bench::Bench;
use virtual_board::board::Pause;
use virtual_board::cpu::Width;

/// `msr basepri_max, rN`. The register number N, in the lowest bits of the first halfword, is zero here.
const RAISE_BASEPRI: [u16; 2] = [0xF380, 0x8812];

/// False for the tables that the compiler makes of a function's branches: their names contain that of the function.
fn is_function(name: &str) -> bool {
    name.starts_with("_ZN")
}

/// One access of the console to the controller.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lend {
    /// Number of control periods since boot before the access.
    pub tick: u32,
    /// Whether a command caused the access.
    pub by_command: bool,
}

/// Records the accesses on a bench.
pub struct Watch {
    commands: Vec<std::ops::Range<u32>>,
    ticks: u32,
    lends: VecDeque<Lend>,
}

impl Watch {
    /// Starts recording.
    pub fn new(bench: &mut Bench) -> Self {
        let function = |parts: &[&str]| {
            let symbol = bench
                .image
                .symbol(|name| is_function(name) && parts.iter().all(|part| name.contains(part)))?;
            Some(symbol.address..symbol.address + symbol.size)
        };
        let required =
            |parts| function(parts).unwrap_or_else(|| panic!("no function {parts:?} in the image"));
        let mut commands = vec![
            required(&["console", "session", "Session", "obey"]),
            required(&["console", "session", "Session", "execute"]),
        ];
        // Other functions that only these functions call, unless the compiler has inlined them.
        commands.extend(function(&["console7execute"]));
        commands.extend(function(&["console", "session", "Session", "prepare"]));
        let mut looks = vec![required(&["firmware", "app", "idle"])];
        looks.extend(function(&["console", "session", "Session", "look"]));
        looks.extend(function(&["console", "session", "Session", "5go_on"]));
        looks.extend(function(&["console", "session", "Session", "6retune"]));
        looks.extend(function(&[
            "console",
            "session",
            "Session",
            "advance_procedure",
        ]));
        let ticks = bench.address_of(&["firmware", "5TICKS"]);
        let all = looks.into_iter().chain(commands.clone());
        for address in all.flat_map(|function| function.step_by(2)) {
            let mut half = |at| bench.board.memories().read(at, Width::Half);
            let word = [half(address), half(address + 2)];
            if word
                == [
                    word[0].map(|first| u32::from(RAISE_BASEPRI[0]) | first & 0xF),
                    Some(RAISE_BASEPRI[1].into()),
                ]
            {
                bench.board.cpu.set_breakpoint(address, true);
            }
        }
        Self {
            commands,
            ticks,
            lends: VecDeque::new(),
        }
    }

    /// Runs until `time_s`.
    pub fn run_until(&mut self, bench: &mut Bench, time_s: f64) {
        while let Pause::Breakpoint(address) = bench.board.run_until(time_s).unwrap() {
            self.lends.push_back(Lend {
                tick: self.ticks(bench),
                by_command: self
                    .commands
                    .iter()
                    .any(|function| function.contains(&address)),
            });
        }
    }

    /// Number of control periods since boot.
    pub fn ticks(&self, bench: &mut Bench) -> u32 {
        bench
            .board
            .memories()
            .read(self.ticks, Width::Word)
            .unwrap()
    }

    /// The recorded accesses, oldest first.
    pub fn into_lends(self) -> VecDeque<Lend> {
        self.lends
    }
}
