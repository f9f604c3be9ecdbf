//! The wires between board and core beside the data: time, interrupt lines, wait states.

/// What the board may say to the core at any moment, in an access or between two runs.
#[derive(Debug, Clone, Default)]
pub struct Signals {
    pub(super) cycle: u64,
    pub(super) levels: Lines,
    pub(super) rises: Lines,
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
        if high && !self.levels.contains(line) {
            self.rises.insert(line);
            self.risen = true;
        }
        self.levels.set(line, high);
    }

    /// Level of interrupt line `line`.
    #[must_use]
    pub fn line(&self, line: usize) -> bool {
        self.levels.contains(line)
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

/// A set of interrupt lines.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Lines([u32; 8]);

impl Lines {
    pub fn contains(&self, line: usize) -> bool {
        self.0
            .get(line / 32)
            .is_some_and(|word| word >> (line % 32) & 1 == 1)
    }

    pub fn insert(&mut self, line: usize) {
        self.set(line, true);
    }

    pub fn set(&mut self, line: usize, member: bool) {
        if let Some(word) = self.0.get_mut(line / 32) {
            *word = *word & !(1 << (line % 32)) | u32::from(member) << (line % 32);
        }
    }
}
