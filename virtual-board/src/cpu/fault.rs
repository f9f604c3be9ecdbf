//! Faults: their exceptions and their bits in the status registers.

use super::exceptions::{BUS_FAULT, HARD_FAULT, MEM_MANAGE, USAGE_FAULT};

/// A fault. It is synchronous unless stated otherwise.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fault {
    /// Instruction fetch from a region where execution is not allowed.
    InstructionAccess,
    /// Instruction fetch from an unmapped address.
    InstructionBus,
    /// Load, or store without the write buffer, at an unmapped address.
    PreciseBus(u32),
    /// Store through the write buffer to an unmapped address. It is asynchronous.
    ImpreciseBus,
    /// The stack frame could not be read at an exception return.
    Unstacking,
    /// The stack frame could not be written at an exception entry.
    Stacking,
    /// The FPU part of a stack frame could not be written by lazy stacking.
    LazyStacking,
    UndefinedInstruction,
    /// An instruction outside the Thumb state.
    InvalidState,
    /// An invalid exception return.
    InvalidPc,
    /// The FPU is disabled, or the coprocessor does not exist.
    NoCoprocessor,
    Unaligned,
    DivideByZero,
    /// The vector of an exception could not be read.
    VectorTable,
    /// BKPT without a debugger.
    Debug,
}

impl Fault {
    /// Number of the exception that the fault raises.
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

    /// Records a fault in the status registers.
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
