//! A processor core: ARMv7E-M with the single-precision FPU, the Cortex-M4F of an STM32F4.

mod account;
mod bus;
mod memory;
mod signals;
mod stop;

pub use account::{Activation, Totals};
pub use bus::{Bus, Refusal, Width};
pub use memory::Memories;
pub use signals::{FlashTiming, Signals};
pub use stop::{Stop, Unmodelled};

/// The core.
#[derive(Debug, Clone, Default)]
pub struct Cpu {
    /// The wires between board and core.
    pub signals: Signals,
}

impl Cpu {
    /// A core at power-on. It does nothing sensible before [`Cpu::reset`].
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Takes the reset: stack pointer and first address from the vector table at address 0. Time, interrupt lines
    /// and accounts go on.
    pub fn reset<B: Bus>(&mut self, bus: &mut B) {
        let _ = bus;
    }

    /// Executes until `cycle`, or until something else ends the run. Waiting for an interrupt is a jump of time.
    pub fn run<B: Bus>(&mut self, bus: &mut B, cycle: u64) -> Stop {
        let _ = bus;
        self.signals.cycle = self.signals.cycle.max(cycle);
        Stop::Deadline
    }

    /// Instructions executed since power-on.
    #[must_use]
    pub fn instructions(&self) -> u64 {
        0
    }

    /// True while the core waits for an interrupt or an event.
    #[must_use]
    pub fn asleep(&self) -> bool {
        false
    }

    /// Value of register `number`, 0 to 15; 15 is the address of the next instruction.
    #[must_use]
    pub fn register(&self, number: usize) -> u32 {
        let _ = number;
        0
    }

    /// Sets register `number`, 0 to 15.
    pub fn set_register(&mut self, number: usize, value: u32) {
        let _ = (number, value);
    }

    /// Number of the exception that is being handled; 0 in thread mode.
    #[must_use]
    pub fn exception(&self) -> u16 {
        0
    }

    /// Makes runs end before the instruction at `address` in flash, or no longer.
    pub fn set_breakpoint(&mut self, address: u32, on: bool) {
        let _ = (address, on);
    }

    /// What exception `number` has taken since power-on.
    #[must_use]
    pub fn totals(&self, number: u16) -> Totals {
        let _ = number;
        Totals::default()
    }

    /// Completed activations since the last call, oldest first, if [`Cpu::record_activations`] asked for them.
    pub fn take_activations(&mut self) -> Vec<Activation> {
        Vec::new()
    }

    /// Starts or ends keeping every activation.
    pub fn record_activations(&mut self, on: bool) {
        let _ = on;
    }
}
