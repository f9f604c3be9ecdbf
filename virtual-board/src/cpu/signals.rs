//! The wires between board and core beside the data: time, interrupt lines, wait states.

use super::exceptions::{INTERRUPT_0, NMI, Set};

/// What the board may say to the core at any moment, in an access or between two runs.
#[derive(Debug, Clone, Default)]
pub struct Signals {
    pub(super) cycle: u64,
    /// Exceptions whose line is high.
    pub(super) levels: Set,
    /// Exceptions whose line has risen since the core last looked.
    pub(super) rises: Set,
    pub(super) risen: bool,
    pub(super) board_called: bool,
    pub(super) wait_cycles: u32,
    pub(super) flash_timing: FlashTiming,
}

impl Signals {
    /// Core clock cycles since power-on. In an access: when its instruction began.
    #[must_use]
    pub fn cycle(&self) -> u64 {
        self.cycle
    }

    /// Sets interrupt line `line` (0 to 239, the number of the vector table less 16). A line that rises pends its
    /// interrupt; one that is still high when its handler returns pends it again.
    pub fn set_line(&mut self, line: usize, high: bool) {
        self.set_level(number_of(line), high);
    }

    /// Level of interrupt line `line`.
    #[must_use]
    pub fn line(&self, line: usize) -> bool {
        self.levels.contains(number_of(line))
    }

    /// Sets the line of the non-maskable interrupt.
    pub fn set_nmi(&mut self, high: bool) {
        self.set_level(NMI, high);
    }

    fn set_level(&mut self, number: u16, high: bool) {
        if high && !self.levels.contains(number) {
            self.rises.set(number, true);
            self.risen = true;
        }
        self.levels.set(number, high);
    }

    /// Makes the run end after the present instruction, with [`super::Stop::Event`].
    pub fn call_board(&mut self) {
        self.board_called = true;
    }

    /// Makes the present access take so many cycles longer, as a slower bus does.
    pub fn wait(&mut self, cycles: u32) {
        self.wait_cycles += cycles;
    }

    /// Sets how long flash makes the core wait.
    pub fn set_flash_timing(&mut self, timing: FlashTiming) {
        self.flash_timing = timing;
    }
}

/// Exception of an interrupt line; one that does not exist for a line that does not.
fn number_of(line: usize) -> u16 {
    u16::try_from(line)
        .unwrap_or(u16::MAX)
        .saturating_add(INTERRUPT_0)
}

/// How long flash makes the core wait: the FLASH_ACR of an STM32F4.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct FlashTiming {
    /// Cycles that a read of 128 bits takes beyond the first.
    pub wait_states: u8,
    /// The next 128 bits are read ahead (PRFTEN).
    pub prefetch: bool,
    /// The instruction cache is on (ICEN).
    pub instruction_cache: bool,
    /// The data cache is on (DCEN).
    pub data_cache: bool,
}
