//! Why a run ends.

use super::Width;

/// Why [`super::Cpu::run`] returned.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Stop {
    /// The cycle asked for is reached, awake or asleep; the last instruction may have taken it a little further.
    Deadline,
    /// The board asked for it by [`super::Signals::call_board`].
    Event,
    /// The next instruction is at a breakpoint of [`super::Cpu::set_breakpoint`]; the next run goes on with it.
    Breakpoint(u32),
    /// The image asked for a reset (AIRCR.SYSRESETREQ). The core does nothing more until [`super::Cpu::reset`].
    Reset,
    /// A fault came where none can be taken. The core lets time pass and does nothing more until [`super::Cpu::reset`].
    Lockup {
        /// Address of the instruction that could not go on.
        pc: u32,
    },
    /// The image did what this board has no model of.
    Unmodelled(Unmodelled),
}

/// Something that the chip does and this board does not.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Unmodelled {
    /// An access.
    #[error(
        "{register} is not modelled: the instruction at {pc:#010x} {} a {width} at {address:#010x}",
        match written { Some(value) => format!("writes {value:#x} as"), None => "reads".into() }
    )]
    Access {
        /// What is there, by peripheral and offset.
        register: String,
        /// Where.
        address: u32,
        /// How wide.
        width: Width,
        /// What was to be written; `None` for a read.
        written: Option<u32>,
        /// Address of the instruction.
        pc: u32,
    },
    /// An instruction.
    #[error("the instruction {word:#010x} at {pc:#010x} is not modelled: {why}")]
    Instruction {
        /// The instruction; the first halfword is the upper one of a 32-bit instruction.
        word: u32,
        /// Address of the instruction.
        pc: u32,
        /// What is missing.
        why: &'static str,
    },
}
