//! The chip: memories and peripherals with their interconnections.

mod bus;
mod conversion;
mod lines;
pub mod map;
mod pins;
mod serial;

pub use conversion::Delivered;
pub use pins::Pin;

use crate::clock::Clock;
use crate::cpu::{Memories, Signals};
use crate::peripherals::NEVER;
use crate::peripherals::adc::Adc;
use crate::peripherals::dbgmcu::{Dbgmcu, Held};
use crate::peripherals::dma::Dma;
use crate::peripherals::exti::Exti;
use crate::peripherals::flash::{Change, Flash};
use crate::peripherals::general_timer::GeneralTimer;
use crate::peripherals::gpio::Gpio;
use crate::peripherals::iwdg::Iwdg;
use crate::peripherals::pwr::{self, Pwr};
use crate::peripherals::rcc::{Clocks, Rcc, ResetCause};
use crate::peripherals::syscfg::Syscfg;
use crate::peripherals::tim5::Tim5;
use crate::peripherals::tim8::Tim8;
use crate::peripherals::usart::Usart;
use conversion::{ANALOG_PINS, CONVERTERS, Level};
use map::PORTS;
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};

const FLASH_BYTES: usize = 1024 * 1024;
const SRAM_BYTES: usize = 128 * 1024;
const CCM_BYTES: usize = 64 * 1024;

/// State of the core supply.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Supply {
    /// The supply is sufficient.
    Sound,
    /// The supply is too low for reliable execution, but the chip is not held in reset.
    TooLow,
    /// The chip is held in reset.
    HeldInReset,
}

/// A flash operation and its time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlashChange {
    /// The change of the cells.
    pub change: Change,
    /// Start time, s.
    pub from_s: f64,
    /// End time, s. A loss of the supply can end it earlier.
    pub to_s: f64,
}

/// The simulated chip.
#[derive(Debug, Clone)]
pub struct Chip {
    memories: Memories,
    clock: Clock,
    clocks: Clocks,
    rcc: Rcc,
    /// The timer of the bridge.
    pub tim8: Tim8,
    tim2: GeneralTimer,
    tim3: GeneralTimer,
    tim5: Tim5,
    adc: [Adc; CONVERTERS],
    adc_common: u32,
    levels: [(Pin, Level); ANALOG_PINS.len()],
    delivered: Delivered,
    dma1: Dma,
    dma2: Dma,
    /// The serial port of the console.
    pub usart2: Usart,
    gpio: [Gpio; PORTS],
    exti: Exti,
    /// Cycle at which the last buffered write reaches EXTI.
    posted_at: u64,
    syscfg: Syscfg,
    pwr: Pwr,
    supply_v: f64,
    flash: Flash,
    flash_changes: Vec<FlashChange>,
    iwdg: Iwdg,
    dbgmcu: Dbgmcu,
    /// Something that an event needs and that is not modelled, see [`crate::cpu::Refusal::Unmodelled`].
    trouble: Option<String>,
    /// Accesses that have no effect on the chip and are probably a mistake of the program.
    remarks: Vec<String>,
    /// Cycle until which the core runs if no event occurs.
    pub deadline: u64,
}

impl Chip {
    /// A chip that has just been powered on, with erased flash.
    pub fn new() -> Self {
        let rcc = Rcc::reset(ResetCause::Power, None);
        let clocks = rcc.clocks();
        let mut chip = Self {
            memories: Memories::new(FLASH_BYTES, SRAM_BYTES, CCM_BYTES),
            clock: Clock::new(0, 0.0, clocks.hclk_hz),
            clocks,
            rcc,
            tim8: Tim8::default(),
            tim2: GeneralTimer::wide(),
            tim3: GeneralTimer::narrow(),
            tim5: Tim5::default(),
            adc: Default::default(),
            adc_common: 0,
            levels: ANALOG_PINS.map(|pin| (pin, Level::default())),
            delivered: Delivered::default(),
            dma1: Dma::default(),
            dma2: Dma::default(),
            usart2: Usart::default(),
            gpio: std::array::from_fn(Gpio::reset),
            exti: Exti::default(),
            posted_at: NEVER,
            syscfg: Syscfg::default(),
            pwr: Pwr::reset(pwr::NOMINAL_V),
            supply_v: pwr::NOMINAL_V,
            flash: Flash::default(),
            flash_changes: Vec::new(),
            iwdg: Iwdg::default(),
            dbgmcu: Dbgmcu::default(),
            trouble: None,
            remarks: Vec::new(),
            deadline: 0,
        };
        chip.forget(0);
        chip
    }

    /// Resets everything except the memories at cycle `now`. A running flash operation is interrupted.
    pub fn reset(&mut self, cause: ResetCause, now: u64, signals: &mut Signals) {
        self.cut_flash_change(now);
        self.rcc = Rcc::reset(cause, Some(&self.rcc));
        self.follow_clocks(now);
        self.tim8 = Tim8::default();
        self.tim2 = GeneralTimer::wide();
        self.tim3 = GeneralTimer::narrow();
        self.tim5 = Tim5::default();
        self.adc = Default::default();
        self.adc_common = 0;
        self.dma1 = Dma::default();
        self.dma2 = Dma::default();
        self.usart2 = Usart::default();
        for (port, gpio) in self.gpio.iter_mut().enumerate() {
            gpio.reset_registers(port);
        }
        self.exti = Exti::default();
        self.syscfg = Syscfg::default();
        self.pwr = Pwr::reset(self.supply_v);
        self.flash = self.flash.reset(cause == ResetCause::Power);
        self.iwdg = Iwdg::default();
        if cause == ResetCause::Power {
            self.dbgmcu = Dbgmcu::default();
        }
        self.show_lines(signals);
        signals.set_nmi(false);
        signals.set_flash_timing(self.flash.timing());
    }

    /// Restarts at time `s` after a loss of the supply. RAM holds random values.
    pub fn lose_power_until(&mut self, s: f64, now: u64) {
        self.cut_flash_change(now);
        self.clock = Clock::new(now, s, self.clock.hz());
        self.forget(now);
    }

    /// Fills RAM with random values.
    fn forget(&mut self, seed: u64) {
        let mut noise = noise(seed);
        noise.fill_bytes(&mut self.memories.sram);
        noise.fill_bytes(&mut self.memories.ccm);
    }

    fn cut_flash_change(&mut self, now: u64) {
        if let Some(change) = self.flash.done() {
            let mut noise = noise(now);
            change.interrupt(self.memories.flash_mut(), || noise.next_u32() as u8);
        }
    }

    fn follow_clocks(&mut self, now: u64) {
        let clocks = self.rcc.clocks();
        if clocks != self.clocks {
            self.clocks = clocks;
            // A clock of 1 Hz stands in for a stopped clock, so that time stays finite.
            self.clock.set_rate(now, clocks.hclk_hz.max(1.0));
        }
    }

    /// Stops or restarts the crystal oscillator. Returns true if the clock security system has detected a failure.
    pub fn set_crystal(&mut self, runs: bool, now: u64) -> bool {
        let seen = self.rcc.set_crystal(runs);
        if seen {
            self.tim8.brake();
        }
        self.follow_clocks(now);
        seen
    }

    /// Sets the highest brown-out level, as if it had been programmed before power-on.
    pub fn set_brown_out(&mut self) {
        self.flash = std::mem::take(&mut self.flash).with_brown_out();
    }

    /// Completes a buffered write that is due at cycle `now`. Returns true if there was one.
    pub fn settle_posted(&mut self, now: u64, signals: &mut Signals) -> bool {
        let due = self.posted_at <= now;
        if due {
            self.posted_at = NEVER;
            self.show_exti(signals);
        }
        due
    }

    /// Sets the supply voltage of the chip.
    pub fn set_supply(&mut self, supply_v: f64, signals: &mut Signals) {
        self.supply_v = supply_v;
        let changed = self.pwr.set_supply(supply_v);
        self.follow_detector(changed, signals);
    }

    /// Feeds the output of the voltage detector to its external interrupt line.
    fn follow_detector(&mut self, changed: Option<bool>, signals: &mut Signals) {
        if let Some(low) = changed {
            self.exti.edge(lines::PVD_LINE, low);
            self.show_exti(signals);
        }
    }

    /// Present state of the supply.
    pub fn supply(&self) -> Supply {
        /// Minimum supply above 144 MHz (data sheet, limitations depending on the supply).
        const LEAST_V: f64 = 2.7;
        if self.supply_v < self.flash.brown_out_v() {
            Supply::HeldInReset
        } else if self.supply_v < LEAST_V {
            Supply::TooLow
        } else {
            Supply::Sound
        }
    }

    /// A debugger halts the core at cycle `now`. Peripherals configured to stop with the core stop too.
    pub fn hold(&mut self, now: u64) {
        self.deliver_all(now);
        let now_s = self.clock.seconds(now);
        if self.dbgmcu.stops(Held::Tim8) {
            self.tim8.hold(now);
        }
        if self.dbgmcu.stops(Held::Tim2) {
            self.tim2.hold(now);
        }
        if self.dbgmcu.stops(Held::Tim3) {
            self.tim3.hold(now);
        }
        if self.dbgmcu.stops(Held::Iwdg) {
            self.iwdg.hold(now_s);
        }
    }

    /// The halted core continues at cycle `now`.
    pub fn go_on(&mut self, now: u64) {
        self.deliver_all(now);
        let now_s = self.clock.seconds(now);
        self.tim8.go_on(now);
        self.tim2.go_on(now);
        self.tim3.go_on(now);
        for adc in &mut self.adc {
            adc.begin_at(now);
        }
        self.iwdg.go_on(now_s);
    }

    /// The conversion between core cycles and seconds.
    pub fn clock(&self) -> &Clock {
        &self.clock
    }

    /// Cycle of the next event of a peripheral.
    #[inline]
    pub fn next_event(&self) -> u64 {
        let watchdog = match self.iwdg.expires_s() {
            Some(at_s) => self.clock.cycle_at(at_s),
            None => NEVER,
        };
        self.tim8
            .next_update()
            .min(self.usart2.next_sent())
            .min(self.flash.next_done())
            .min(self.posted_at)
            .min(watchdog)
    }

    /// Returns true if the watchdog has expired by cycle `now`.
    pub fn watchdog_expired(&self, now: u64) -> bool {
        let expires_s = self.iwdg.expires_s();
        expires_s.is_some_and(|at_s| self.clock.cycle_at(at_s) <= now)
    }

    /// Executes an update of TIM8 that is due now.
    pub fn update_tim8(&mut self, signals: &mut Signals) {
        let at = self.tim8.next_update();
        if self.tim8.update() {
            self.trigger(at);
        }
        signals.set_line(lines::TIM8_UP_TIM13, self.tim8.requests_update_interrupt());
    }

    /// Records a flash operation that began at cycle `from`, if there is one.
    fn note_flash_change(&mut self, from: u64) {
        if let Some((change, to)) = self.flash.running() {
            let [from_s, to_s] = [from, to].map(|cycle| self.clock.seconds(cycle));
            self.flash_changes.push(FlashChange {
                change,
                from_s,
                to_s,
            });
        }
    }

    /// Takes the flash operations since the last call.
    pub fn take_flash_changes(&mut self) -> Vec<FlashChange> {
        std::mem::take(&mut self.flash_changes)
    }

    /// Completes a flash operation that is due.
    pub fn finish_flash_change(&mut self) {
        if let Some(change) = self.flash.done() {
            change.apply(self.memories.flash_mut());
            self.flash.keep(change);
        }
    }

    fn remark(&mut self, remark: String) {
        // A repeated remark is logged once.
        if !self.remarks.contains(&remark) {
            self.remarks.push(remark);
        }
    }

    /// Takes the remarks since the last call: accesses that have no effect and are probably a mistake of the program.
    pub fn take_remarks(&mut self) -> Vec<String> {
        std::mem::take(&mut self.remarks)
    }

    /// Takes the description of what is not modelled, if an event needed it.
    pub fn take_trouble(&mut self) -> Option<String> {
        self.trouble.take()
    }
}

impl Default for Chip {
    fn default() -> Self {
        Self::new()
    }
}

/// Generator of the random values in cells that were not written.
fn noise(seed: u64) -> Xoshiro256PlusPlus {
    Xoshiro256PlusPlus::seed_from_u64(seed)
}
