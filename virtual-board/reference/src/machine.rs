//! What both machines have: one RAM, of which the lower part is data and the upper part code.

use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::Rng;

use crate::outcome::Outcome;
use crate::state::State;
use crate::words::Trial;

/// Where the RAM begins.
pub const RAM: u32 = 0x2000_0000;
/// Size of the RAM, bytes.
pub const SIZE: usize = 0xC000;
/// Where in it instructions find their data, as an offset.
pub const DATA: u32 = 0x2000;

/// A machine that executes one trial.
pub trait Machine {
    /// Places the trial's code at `address` and executes it from `state`; memory is afterwards as before, but for
    /// the code.
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

/// Places for code, one after the other, far enough from both ends for what is relative to them.
pub fn addresses() -> impl Iterator<Item = u32> {
    // Every second place is not at a word.
    (0..0x200)
        .map(|i| RAM + 0x9000 + 16 * i + 2 * (i & 1))
        .cycle()
}
