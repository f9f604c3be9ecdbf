//! Random states of a processor core.

use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::Rng;

use crate::machine::{DATA, RAM};

/// The registers that an instruction may read or change.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct State {
    /// R0 to R12, SP, LR.
    pub registers: [u32; 15],
    /// N, Z, C, V, Q and GE, at their bit positions in APSR.
    pub flags: u32,
    /// S0 to S31.
    pub floats: [u32; 32],
    /// FPSCR.
    pub float_status: u32,
}

/// N, Z, C, V, Q and GE in APSR.
pub const FLAGS: u32 = 0xF80F_0000;
/// FPSCR without its reserved bits.
const FLOAT_STATUS: u32 = 0xF7C0_009F;

const EDGES: [u32; 12] = [
    0,
    1,
    2,
    31,
    32,
    33,
    0x7F,
    0x80,
    0x7FFF_FFFF,
    0x8000_0000,
    0x8000_0001,
    u32::MAX,
];

const FLOAT_EDGES: [u32; 22] = [
    0,
    0x3F80_0000,
    0x3F80_0001,
    0x3FC0_0000,
    0x3F7F_FFFF,
    0x3F00_0000,
    0x4B80_0000,
    0x4B00_0001,
    0x4F00_0000,
    0x4EFF_FFFF,
    0x4F80_0000,
    0x477F_E000,
    0x477F_F000,
    0x3880_0000,
    0x3300_0000,
    0x0000_0001,
    0x007F_FFFF,
    0x0080_0000,
    0x7F7F_FFFF,
    0x7F80_0000,
    0x7FC0_1234,
    0x7F80_1234,
];

impl State {
    /// A random state. If `aligned`, all registers are multiples of four.
    pub fn random(random: &mut Xoshiro256PlusPlus, aligned: bool) -> Self {
        let mut registers = [0; 15];
        for register in &mut registers {
            *register = word(random) & if aligned { !3 } else { u32::MAX };
        }
        registers[13] &= !3;
        let plain = random.next_u32() & 1 == 0;
        let mut floats = [0; 32];
        for register in &mut floats {
            *register = float(random);
        }
        Self {
            registers,
            flags: random.next_u32() & FLAGS,
            floats,
            // Half of the states have the usual FPSCR, so that the fast paths are tested too.
            float_status: if plain {
                0x10
            } else {
                random.next_u32() & FLOAT_STATUS
            },
        }
    }
}

fn word(random: &mut Xoshiro256PlusPlus) -> u32 {
    let bits = random.next_u32();
    match bits % 8 {
        0 => EDGES[(bits >> 8) as usize % EDGES.len()],
        1 | 2 => bits >> 8 & 0xFF,
        3 => bits.rotate_left(bits >> 27) | 1,
        4 => random.next_u32(),
        // An address in the middle of the data, usually aligned.
        choice => {
            let near = bits >> 8 & 0x3FF;
            let aligned = if choice == 7 { near } else { near & !7 };
            RAM + DATA - 0x200 + aligned
        }
    }
}

fn float(random: &mut Xoshiro256PlusPlus) -> u32 {
    let bits = random.next_u32();
    let sign = bits << 31;
    match bits >> 1 & 7 {
        0 => random.next_u32(),
        1 | 2 => sign | FLOAT_EDGES[(bits >> 8) as usize % FLOAT_EDGES.len()],
        // Denormal numbers and the smallest normal ones.
        3 => sign | bits >> 8 & 0x01FF_FFFF,
        // Numbers near one, so that sums cancel and round.
        4 | 5 => sign | (0x3E00_0000 + (bits >> 8 << 2 & 0x03FF_FFFC)),
        // Integers, and numbers that fit in a half-precision float.
        6 => ((bits >> 8) as i32 as f32).to_bits() | sign,
        _ => sign | (0x3700_0000 + (random.next_u32() & 0x11FF_FFFF)),
    }
}
