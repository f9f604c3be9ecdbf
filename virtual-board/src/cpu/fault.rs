//! Faults: which exception they raise and how the status registers show them.

use super::exceptions::{BUS_FAULT, HARD_FAULT, MEM_MANAGE, USAGE_FAULT};

/// A fault, synchronous unless it says otherwise.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fault {
    /// An instruction from where none may come.
    InstructionAccess,
    /// An instruction from where nothing answers.
    InstructionBus,
    /// A load, or a store without the write buffer, where nothing answers.
    PreciseBus(u32),
    /// A store through the write buffer where nothing answers. Asynchronous.
    ImpreciseBus,
    /// The frame of an exception return could not be read.
    Unstacking,
    /// The frame of an exception entry could not be written.
    Stacking,
    /// The postponed part of a frame, that of the FPU, could not be written.
    LazyStacking,
    UndefinedInstruction,
    /// An instruction outside Thumb state.
    InvalidState,
    /// An exception return that cannot be.
    InvalidPc,
    /// The FPU is off, or the coprocessor is not there.
    NoCoprocessor,
    Unaligned,
    DivideByZero,
    /// The vector of an exception could not be read.
    VectorTable,
    /// BKPT without a debugger.
    Debug,
}

impl Fault {
    /// Number of its exception.
    pub fn exception(self) -> u16 {
        match self {
            Self::InstructionAccess => MEM_MANAGE,
            Self::InstructionBus
            | Self::PreciseBus(_)
            | Self::ImpreciseBus
            | Self::Unstacking
            | Self::Stacking
            | Self::LazyStacking => BUS_FAULT,
            Self::VectorTable | Self::Debug => HARD_FAULT,
            _ => USAGE_FAULT,
        }
    }
}

/// CFSR, HFSR, BFAR and MMFAR.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct FaultStatus {
    pub configurable: u32,
    pub hard: u32,
    pub bus_address: u32,
    pub memory_address: u32,
}

impl FaultStatus {
    /// HFSR.FORCED.
    pub const FORCED: u32 = 1 << 30;

    /// Takes a fault down.
    pub fn record(&mut self, fault: Fault) {
        self.configurable |= match fault {
            Fault::InstructionAccess => 1,
            Fault::InstructionBus => 1 << 8,
            Fault::PreciseBus(address) => {
                self.bus_address = address;
                1 << 9 | 1 << 15
            }
            Fault::ImpreciseBus => 1 << 10,
            Fault::Unstacking => 1 << 11,
            Fault::Stacking => 1 << 12,
            Fault::LazyStacking => 1 << 13,
            Fault::UndefinedInstruction => 1 << 16,
            Fault::InvalidState => 1 << 17,
            Fault::InvalidPc => 1 << 18,
            Fault::NoCoprocessor => 1 << 19,
            Fault::Unaligned => 1 << 24,
            Fault::DivideByZero => 1 << 25,
            Fault::VectorTable | Fault::Debug => 0,
        };
        self.hard |= match fault {
            Fault::VectorTable => 1 << 1,
            Fault::Debug => 1 << 31,
            _ => 0,
        };
    }
}
