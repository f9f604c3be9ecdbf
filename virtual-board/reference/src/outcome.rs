//! The effect of an instruction, and the comparison of two simulators.

use crate::state::State;
use crate::words::Trial;

/// The effect of a trial on one simulator.
#[derive(Debug)]
pub enum Outcome {
    Done {
        state: Box<State>,
        pc: u32,
        /// The data in memory, if it has changed.
        memory: Option<Vec<u8>>,
    },
    /// A fault, or an access to an unmapped address.
    Fault,
    /// The manual does not define the effect.
    Unpredictable,
}

/// The result of comparing one trial.
#[derive(Debug)]
pub enum Verdict {
    Same,
    BothFault,
    Unpredictable,
    LeftOut(&'static str),
    Different(String),
}

impl Verdict {
    pub fn name(&self) -> &'static str {
        match self {
            Self::Same => "the same",
            Self::BothFault => "a fault on both",
            Self::Unpredictable => "left out: unpredictable",
            Self::LeftOut(reason) => reason,
            Self::Different(_) => "DIFFERENT",
        }
    }
}

/// The name of a group of instructions that cannot be compared, if the trial belongs to one.
pub fn left_out(trial: &Trial) -> Option<&'static str> {
    let (word, wide) = (trial.word(), trial.second.is_some());
    let special_write = wide && word & 0xFFE0_D000 == 0xF380_8000;
    let special_read = wide && word & 0xFFE0_D000 == 0xF3E0_8000;
    if !wide && (word & 0xFF00 == 0xDF00 || word & 0xFF00 == 0xBE00) {
        return Some("left out: SVC and BKPT, which raise an exception");
    }
    if !wide && matches!(word, 0xBF20 | 0xBF30) || wide && matches!(word, 0xF3AF_8002 | 0xF3AF_8003)
    {
        return Some("left out: WFE and WFI, which wait");
    }
    if !wide && word & 0xFFF0 == 0xB650 {
        return Some("left out: SETEND, which this profile does not have and Unicorn executes");
    }
    if wide && word & 0xFFE0_0000 == 0xE8C0_0000 && word >> 4 & 15 >= 7 {
        return Some("left out: exclusives of doublewords, load-acquire and store-release");
    }
    if wide && word & 0xFE1F_0000 == 0xF80F_0000 {
        return Some("left out: stores relative to PC, undefined and executed by Unicorn");
    }
    if wide && word & 0xFFE0_0F10 == 0xEEE0_0A10 && word & 0x000F_0000 != 0x0001_0000 {
        return Some("left out: VMRS and VMSR of what this profile does not have");
    }
    if wide && word & 0xFF10_0000 == 0xF900_0000 {
        return Some("left out: Advanced SIMD, of another profile");
    }
    let rounds = matches!(word & 0xFFBF_0E50, 0xEEB6_0A40 | 0xEEB7_0A40);
    if wide && (rounds || word & 0xFF00_0E00 == 0xFE00_0A00) {
        return Some("left out: VRINT, VSEL and their kin, of a later FPU");
    }
    if !wide && word == 0xBF10 || wide && word == 0xF3AF_8001 {
        return Some("left out: YIELD, at which Unicorn stops");
    }
    if !wide && word & 0xFF00 == 0xBF00 && word & 15 != 0 && trial.if_then.is_none() {
        return Some("left out: IT on its own, which Unicorn executes with what follows");
    }
    if (special_read || special_write) && word & 0xFC != 0 {
        return Some("left out: MRS and MSR of masks and stack pointers");
    }
    None
}

/// VCVT from fixed point. It always rounds to nearest, whatever FPSCR says. Unicorn uses the rounding mode of FPSCR.
fn converts_from_fixed(trial: &Trial) -> bool {
    trial.word() & 0xFFBE_0E50 == 0xEEBA_0A40 && trial.second.is_some()
}

pub fn judge(trial: &Trial, before: &State, ours: &Outcome, theirs: &Outcome) -> Verdict {
    match (ours, theirs) {
        (Outcome::Unpredictable, _) | (_, Outcome::Unpredictable) => Verdict::Unpredictable,
        (Outcome::Fault, Outcome::Fault) => Verdict::BothFault,
        (
            Outcome::Done { state, pc, memory },
            Outcome::Done {
                state: other,
                pc: other_pc,
                memory: other_memory,
            },
        ) => {
            let rounds_to_nearest = before.float_status >> 22 & 3 == 0;
            if converts_from_fixed(trial) && !rounds_to_nearest {
                return Verdict::LeftOut("left out: VCVT from fixed point, not to nearest");
            }
            if other.registers[13] & 3 != 0 {
                return Verdict::LeftOut("left out: an SP that is no multiple of 4, unpredictable");
            }
            let mut differences = Vec::new();
            let mut compare = |ours: &[u32], theirs: &[u32], name: &str| {
                for (n, (ours, theirs)) in ours.iter().zip(theirs).enumerate() {
                    if ours != theirs {
                        differences.push(format!("{name}{n} {ours:08x}, not {theirs:08x}"));
                    }
                }
            };
            compare(&state.registers, &other.registers, "r");
            compare(&[*pc], &[*other_pc], "pc");
            compare(&[state.flags], &[other.flags], "apsr");
            compare(&state.floats, &other.floats, "s");
            compare(&[state.float_status], &[other.float_status], "fpscr");
            if memory != other_memory {
                differences.push("memory".into());
            }
            if differences.is_empty() {
                Verdict::Same
            } else {
                Verdict::Different(format!("{}\n   from {before:x?}", differences.join(", ")))
            }
        }
        (Outcome::Fault, _) => {
            Verdict::Different(format!("a fault here only\n   from {before:x?}"))
        }
        (_, _) if may_reach_what_unicorn_lacks(before) => {
            Verdict::LeftOut("left out: bit-band aliases and system space, which Unicorn lacks")
        }
        (_, _) => Verdict::Different(format!("a fault there only\n   from {before:x?}")),
    }
}

/// Returns true if an address formed from one register, or from a register and a shifted register, plus any instruction
/// offset, may be a bit-band alias or a register of the core.
fn may_reach_what_unicorn_lacks(state: &State) -> bool {
    let near = |address: u32| {
        [
            address.wrapping_sub(4096),
            address,
            address.wrapping_add(4096),
        ]
        .iter()
        .any(|address| matches!(address >> 20, 0x220..=0x23F | 0x420..=0x43F | 0xE00))
    };
    let registers = &state.registers;
    registers.iter().any(|&base| {
        near(base)
            || registers
                .iter()
                .any(|&index| (0..4).any(|shift| near(base.wrapping_add(index << shift))))
    })
}
