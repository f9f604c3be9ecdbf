//! The machine that both simulators have: one RAM. Its lower part holds data, its upper part code.

use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::Rng;

use crate::outcome::Outcome;
use crate::state::State;
use crate::words::Trial;

/// Address of the RAM.
pub const RAM: u32 = 0x2000_0000;
/// Size of the RAM, bytes.
pub const SIZE: usize = 0xC000;
/// Offset in the RAM at which instructions find their data.
pub const DATA: u32 = 0x2000;

/// A simulator that executes one trial.
pub trait Machine {
    /// Places the code of the trial at `address` and executes it from `state`. Afterwards the memory is as before, except
    /// for the code.
    fn execute(
        &mut self,
        trial: &Trial,
        address: u32,
        state: &State,
    ) -> Result<Outcome, Box<dyn std::error::Error>>;
}

/// The content of the RAM before each trial.
pub fn random_memory(random: &mut Xoshiro256PlusPlus) -> Vec<u8> {
    let mut memory = vec![0; SIZE];
    random.fill_bytes(&mut memory);
    memory
}

/// Addresses for code. They are far enough from both ends of the RAM for PC-relative accesses.
pub fn addresses() -> impl Iterator<Item = u32> {
    // Every second address is not aligned to a word.
    (0..0x200)
        .map(|i| RAM + 0x9000 + 16 * i + 2 * (i & 1))
        .cycle()
}
