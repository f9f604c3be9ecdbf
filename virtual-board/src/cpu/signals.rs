//! Signals between board and core other than data: time, interrupt lines and wait states.

use super::exceptions::{INTERRUPT_0, NMI, Set};

/// Signals that the board may set at any time, during an access or between two runs.
#[derive(Debug, Clone, Default)]
pub struct Signals {
    pub(super) cycle: u64,
    /// Exceptions whose line is high.
    pub(super) levels: Set,
    /// Exceptions whose line has risen since the core last checked.
    pub(super) rises: Set,
    pub(super) risen: bool,
    pub(super) board_called: bool,
    pub(super) wait_cycles: u32,
    pub(super) flash_timing: FlashTiming,
}

impl Signals {
    /// Core cycles since power-on. During an access, the cycle at which its instruction began.
    #[must_use]
    pub fn cycle(&self) -> u64 {
        self.cycle
    }

    /// Sets interrupt line `line` (0 to 239, the vector number less 16). A rising line makes its interrupt pending. If the
    /// line is still high when the handler returns, the interrupt becomes pending again.
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

    /// Makes the run end after the present instruction with [`super::Stop::Event`].
    pub fn call_board(&mut self) {
        self.board_called = true;
    }

    /// Extends the present access by `cycles`, as a slower bus does.
    pub fn wait(&mut self, cycles: u32) {
        self.wait_cycles += cycles;
    }

    /// Sets the wait times of the flash.
    pub fn set_flash_timing(&mut self, timing: FlashTiming) {
        self.flash_timing = timing;
    }
}

/// Exception number of an interrupt line. A line that does not exist gives a number that does not exist.
fn number_of(line: usize) -> u16 {
    u16::try_from(line)
        .unwrap_or(u16::MAX)
        .saturating_add(INTERRUPT_0)
}

/// Settings of the flash wait times: the FLASH_ACR of an STM32F4.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct FlashTiming {
    /// Additional cycles of reading 128 bits.
    pub wait_states: u8,
    /// If true, the next 128 bits are prefetched (PRFTEN).
    pub prefetch: bool,
    /// If true, the instruction cache is on (ICEN).
    pub instruction_cache: bool,
    /// If true, the data cache is on (DCEN).
    pub data_cache: bool,
}
