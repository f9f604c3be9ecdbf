//! Why a run ends.

use super::Width;

/// Why [`super::Cpu::run`] returned.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Stop {
    /// The requested cycle is reached, awake or asleep. The last instruction may have exceeded it slightly.
    Deadline,
    /// The board requested it by [`super::Signals::call_board`].
    Event,
    /// The next instruction is at a breakpoint of [`super::Cpu::set_breakpoint`]. The next run starts with it.
    Breakpoint(u32),
    /// The image requested a reset (AIRCR.SYSRESETREQ). The core executes nothing until [`super::Cpu::reset`].
    Reset,
    /// A fault occurred where none can be handled. Time passes, but the core executes nothing until [`super::Cpu::reset`].
    Lockup {
        /// Address of the instruction at which the core locked up.
        pc: u32,
    },
    /// The image used something that this board does not model.
    Unmodelled(Unmodelled),
}

/// A function of the chip that this board does not model.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Unmodelled {
    /// An access to a register.
    #[error(
        "{register} is not modelled: the instruction at {pc:#010x} {} a {width} at {address:#010x}",
        match written { Some(value) => format!("writes {value:#x} as"), None => "reads".into() }
    )]
    Access {
        /// The register, as peripheral and offset.
        register: String,
        /// The address.
        address: u32,
        /// The width of the access.
        width: Width,
        /// The value to write. `None` for a read.
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
        /// The reason.
        why: &'static str,
    },
}
