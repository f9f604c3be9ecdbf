//! The board: processor core, chip and paddle on one time axis, with a serial terminal and a debug probe.
//!
//! Time is counted in core cycles. The core runs up to the next event, which then takes effect at exactly its cycle. A core
//! that waits for an interrupt skips to that cycle.

mod step;

pub use step::Step;

pub use crate::chip::FlashChange;
use crate::chip::{Chip, Pin, Supply};
use crate::cpu::{Bus, Cpu, Memories, Stop, Unmodelled};
use crate::image::{Image, ImageError};
use crate::log::{Entry, Log};
use crate::peripherals::NEVER;
use crate::peripherals::rcc::ResetCause;
use crate::peripherals::usart::Line;
use crate::terminal::Terminal;
use crate::wiring::{STEP_S, Wires, Wiring};
use haptic_paddle::settings::Settings;
use host_sim::paddle::PaddleSetup;

/// The enable pins of the bridge.
const BRIDGE_ENABLES: [Pin; 2] = [Pin(2, 8), Pin(2, 9)];
const BRIDGE_NSLEEP: Pin = Pin(3, 14);
const BRIDGE_NFAULT: Pin = Pin(3, 15);
const BUTTON: Pin = Pin(4, 2);

/// Stream of DMA2 that serves the current converter.
const CURRENT_STREAM: usize = 1;

/// Number of paddle steps between two reads of the log by the debug probe.
const STEPS_PER_LOOK: u64 = 20;

/// Why the simulation cannot continue.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Halt {
    /// The image used something that this board does not model.
    #[error("at {time_s:.6} s: {what}")]
    Unmodelled {
        /// Time since power-on, s.
        time_s: f64,
        /// What is not modelled.
        what: Unmodelled,
    },
    /// A hardware setting of the image needs something that this board does not model.
    #[error("at {time_s:.6} s: {what} is not modelled")]
    Uncovered {
        /// Time since power-on, s.
        time_s: f64,
        /// What is not modelled.
        what: String,
    },
    /// The core has locked up, and no watchdog runs that would reset it.
    #[error("at {time_s:.6} s the core locked up at {pc:#010x}, and no watchdog runs")]
    Lockup {
        /// Time since power-on, s.
        time_s: f64,
        /// Address of the instruction at which the core locked up.
        pc: u32,
    },
}

/// State of the bridge inputs, as the chip drives them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Bridge {
    /// An enable pin or nSLEEP is low. The outputs are off.
    Off,
    /// Nothing drives or pulls an enable pin.
    EnablesFloat,
    /// The outputs are on, and nothing drives or pulls an input.
    InputsFloat,
    /// The outputs are on with this duty cycle, from -1 to 1. At 0 the bridge brakes the motor.
    Driven(f64),
}

/// Why [`Board::run_until`] returned.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pause {
    /// The requested time is reached.
    Time,
    /// The core is about to execute the instruction at a breakpoint.
    Breakpoint(u32),
}

/// The simulated board.
pub struct Board {
    /// The processor core. Its state may be read and changed between two runs.
    pub cpu: Cpu,
    chip: Chip,
    wiring: Wiring,
    /// The terminal on the serial port.
    pub terminal: Terminal,
    log: Log,
    entries: Vec<Entry>,
    resets: Vec<(f64, ResetCause)>,
    steps: Option<Vec<Step>>,
    steps_done: u64,
    /// Cycle at which the next paddle step ends.
    next_step: u64,
    /// Address of the instruction at which the core locked up.
    locked_up: Option<u32>,
    /// If true, the supply is too low for the core to execute anything.
    powerless: bool,
    /// Disturbance of the bytes on the serial line.
    line: Line,
    /// If true, nothing is connected to the serial input.
    serial_cut: bool,
    shortest_low_s: f64,
}

impl Board {
    /// A board that has just been powered on, with `image` in its flash and the paddle of `setup` at rest. `settings` sets
    /// the default properties of the sensors.
    ///
    /// # Errors
    ///
    /// [`ImageError`] if the image does not fit the flash.
    pub fn new(
        image: &Image,
        setup: &PaddleSetup,
        settings: &Settings,
        wires: Wires,
    ) -> Result<Self, ImageError> {
        let mut chip = Chip::new();
        image.flash(chip.memories().flash_mut(), Memories::FLASH)?;
        let mut board = Self {
            cpu: Cpu::new(),
            chip,
            wiring: Wiring::new(setup, settings, wires),
            terminal: Terminal::default(),
            log: Log::new(image),
            entries: Vec::new(),
            resets: Vec::new(),
            steps: None,
            steps_done: 0,
            next_step: 0,
            locked_up: None,
            powerless: false,
            line: Line::Quiet,
            serial_cut: false,
            shortest_low_s: f64::INFINITY,
        };
        board.next_step = board.step_cycles();
        board.cpu.reset(&mut board.chip);
        Ok(board)
    }

    /// Runs until `time_s` since power-on, or until a breakpoint.
    ///
    /// # Errors
    ///
    /// [`Halt`].
    pub fn run_until(&mut self, time_s: f64) -> Result<Pause, Halt> {
        loop {
            let end = self.chip.clock().cycle_at(time_s);
            let now = self.cpu.signals.cycle();
            if now >= end {
                return Ok(Pause::Time);
            }
            let deadline = end.min(self.next_event());
            if self.powerless {
                self.cpu.stand_still(deadline);
                self.catch_up(end)?;
                continue;
            }
            self.chip.deadline = deadline;
            let stop = self.cpu.run(&mut self.chip, deadline);
            match stop {
                Stop::Deadline | Stop::Event => {}
                Stop::Breakpoint(address) => {
                    self.catch_up(end)?;
                    return Ok(Pause::Breakpoint(address));
                }
                Stop::Reset => self.reset(ResetCause::Software),
                Stop::Lockup { pc } => self.locked_up = Some(pc),
                Stop::Unmodelled(what) => {
                    let time_s = self.time_s();
                    return Err(Halt::Unmodelled { time_s, what });
                }
            }
            self.catch_up(end)?;
        }
    }

    fn next_event(&self) -> u64 {
        self.chip
            .next_event()
            .min(self.next_step)
            .min(self.next_arrival())
    }

    /// Cycle at which the next typed byte arrives.
    fn next_arrival(&self) -> u64 {
        match self.terminal.next_arrival_s() {
            Some(at_s) => self.chip.clock().cycle_at(at_s),
            None => NEVER,
        }
    }

    /// Executes all events that are due, up to cycle `end`, in the order of time. At equal cycles, a paddle step comes
    /// before a timer update.
    fn catch_up(&mut self, end: u64) -> Result<(), Halt> {
        let now = self.cpu.signals.cycle().min(end);
        self.keep_pace()?;
        while self.next_event() <= now {
            let due = self.chip.next_event().min(self.next_step);
            let arrives = self.next_arrival() < due;
            let signals = &mut self.cpu.signals;
            if arrives {
                self.arrive();
            } else if self.next_step == due || self.chip.tim8.next_update() == due {
                if self.next_step == due {
                    self.step();
                }
                if self.chip.tim8.next_update() == due {
                    self.chip.update_tim8(&mut self.cpu.signals);
                }
            } else if self.chip.usart2.next_sent() == due {
                /// A byte as received at a different baud rate.
                const GARBLED: u8 = 0xFE;
                if let Some(byte) = self.chip.take_sent(signals) {
                    let understood = self.rates_agree();
                    self.terminal
                        .receive(if understood { byte } else { GARBLED });
                }
            } else if self.chip.settle_posted(due, signals) {
            } else if self.chip.watchdog_expired(due) {
                self.reset(ResetCause::IndependentWatchdog);
            } else {
                self.chip.finish_flash_change();
            }
            self.keep_pace()?;
        }
        match self.chip.take_trouble() {
            None => Ok(()),
            Some(what) => Err(self.uncovered(what)),
        }
    }

    fn uncovered(&self, what: String) -> Halt {
        let time_s = self.time_s();
        Halt::Uncovered { time_s, what }
    }

    fn arrive(&mut self) {
        if let Some(byte) = self.terminal.arrive()
            && self.chip.usart2.receives()
            && !self.serial_cut
        {
            let line = if self.rates_agree() {
                self.line
            } else {
                Line::Broken
            };
            self.chip.receive(byte, line, &mut self.cpu.signals);
        }
    }

    /// Returns true if board and terminal have nearly the same baud rate. A receiver that samples the middle of ten bits
    /// tolerates this deviation.
    fn rates_agree(&self) -> bool {
        const TOLERANCE: f64 = 0.03;
        (self.baud() / self.terminal.baud - 1.0).abs() <= TOLERANCE
    }

    /// Baud rate that the firmware has set, bit/s.
    pub fn baud(&self) -> f64 {
        self.chip.clock().hz() / self.chip.usart2_bit_cycles() as f64
    }

    /// Core cycles in one paddle step.
    fn step_cycles(&self) -> u64 {
        (self.chip.clock().hz() * STEP_S).round() as u64
    }

    /// Aligns the ends of the paddle steps with the timer updates. The step in which the timer starts is shortened. This
    /// does not matter for a paddle that is not driven or is braked.
    fn keep_pace(&mut self) -> Result<(), Halt> {
        let update = self.chip.tim8.next_update();
        if update == NEVER || update == self.next_step {
            return Ok(());
        }
        if self.chip.tim8.update_cycles() == self.step_cycles() {
            self.next_step = update;
            Ok(())
        } else if self.bridge_duty().is_none_or(|duty| duty == 0.0) {
            Ok(())
        } else {
            Err(self.uncovered(format!(
                "a drive that changes every {} cycles, where the paddle's step takes {},",
                self.chip.tim8.update_cycles(),
                self.step_cycles()
            )))
        }
    }

    /// Advances the paddle by one step.
    fn step(&mut self) {
        let at = self.next_step;
        let cycles = self.step_cycles();
        let duty = self.bridge_duty();
        if duty.is_some() {
            self.shortest_low_s = self.shortest_low_s.min(self.chip.shortest_low_s());
        }
        let sensed = self.wiring.step(duty);
        self.chip.follow_encoder(sensed.encoder_counts, cycles);
        self.chip
            .sense(sensed.current_counts, sensed.hall_counts, at);
        self.next_step = at + cycles;
        self.steps_done += 1;
        let delivered = self.chip.take_delivered();
        let time_s = self.chip.clock().seconds(at);
        if let Some(steps) = &mut self.steps {
            steps.push(Step {
                time_s,
                cycle: at,
                duty,
                position_rad: self.wiring.paddle().position_rad(),
                velocity_rad_s: self.wiring.paddle().velocity_rad_s(),
                torque_nm: self.wiring.torque_nm(),
                encoder_count: self.chip.encoder_count(),
                hall_counts: sensed.hall_counts,
                current: delivered,
                ring_left: self.chip.ring_left(CURRENT_STREAM),
                compare: self.chip.tim8.compare(0),
            });
        }
        if self.steps_done.is_multiple_of(STEPS_PER_LOOK) {
            self.fetch_log();
            if self.serial_cut && self.chip.receiver_floats() {
                // A floating input picks up arbitrary bytes from the motor wires beside it.
                let byte = (self.steps_done / STEPS_PER_LOOK) as u8;
                self.chip.receive(byte, Line::Broken, &mut self.cpu.signals);
            }
        }
    }

    fn fetch_log(&mut self) {
        let time_s = self.time_s();
        let memories = self.chip.memories();
        self.log.fetch(memories, time_s, &mut self.entries);
        let remarks = self.chip.take_remarks().into_iter();
        self.entries.extend(remarks.map(|message| Entry {
            time_s,
            level: "BOARD".into(),
            message,
        }));
    }

    /// Duty cycle of the bridge, from -1 to 1. `None` if its outputs are off. The state of the enable pins at the end of a
    /// step counts for the whole step, because the control interrupt sets them at its beginning. For floating inputs the
    /// worst case is assumed.
    pub fn bridge_duty(&self) -> Option<f64> {
        match self.bridge() {
            Bridge::Off | Bridge::EnablesFloat => None,
            Bridge::Driven(duty) => Some(duty),
            Bridge::InputsFloat => Some(1.0),
        }
    }

    /// Present state of the bridge inputs.
    pub fn bridge(&self) -> Bridge {
        let enables = BRIDGE_ENABLES.map(|pin| self.chip.settled(pin));
        if enables.contains(&None) {
            return Bridge::EnablesFloat;
        }
        if enables.contains(&Some(false)) || self.chip.driven(BRIDGE_NSLEEP) != Some(true) {
            return Bridge::Off;
        }
        match self.chip.half_bridges() {
            [Some(a), Some(b)] => Bridge::Driven(a - b),
            _ => Bridge::InputsFloat,
        }
    }

    /// Halts the core for `seconds`, as a debugger does, and then lets it continue.
    ///
    /// # Errors
    ///
    /// [`Halt`].
    pub fn halt_core(&mut self, seconds: f64) -> Result<(), Halt> {
        self.begin_halt();
        self.stand_still(seconds)?;
        self.end_halt();
        Ok(())
    }

    /// Halts the core, as a debugger does.
    pub fn begin_halt(&mut self) {
        let now = self.cpu.signals.cycle();
        self.chip.hold(now);
    }

    /// Lets a halted core continue.
    pub fn end_halt(&mut self) {
        let now = self.cpu.signals.cycle();
        self.chip.go_on(now);
        self.next_step = self.next_step.max(now);
    }

    /// Advances time by `seconds`. The core executes nothing.
    ///
    /// # Errors
    ///
    /// [`Halt`].
    pub fn stand_still(&mut self, seconds: f64) -> Result<(), Halt> {
        let end = self.chip.clock().cycle_at(self.time_s() + seconds);
        while self.cpu.signals.cycle() < end {
            let next = end.min(self.next_event());
            self.cpu.stand_still(next);
            self.catch_up(end)?;
        }
        Ok(())
    }

    fn reset(&mut self, cause: ResetCause) {
        self.fetch_log();
        let now = self.cpu.signals.cycle();
        self.resets.push((self.chip.clock().seconds(now), cause));
        self.chip.reset(cause, now, &mut self.cpu.signals);
        self.cpu.reset(&mut self.chip);
        self.log.reset();
        self.locked_up = None;
        self.powerless = self.chip.supply() != Supply::Sound;
        self.next_step = now + self.step_cycles();
    }

    /// Pulls the reset pin low.
    pub fn press_reset(&mut self) {
        self.reset(ResetCause::Pin);
    }

    /// Removes the supply for `seconds`. RAM loses its content, the paddle coasts, and a running flash operation is
    /// interrupted.
    pub fn interrupt_supply(&mut self, seconds: f64) {
        let back_s = self.time_s() + seconds;
        for _ in 0..(seconds / STEP_S).round() as u64 {
            let sensed = self.wiring.step(None);
            let cycles = self.step_cycles();
            self.chip.follow_encoder(sensed.encoder_counts, cycles);
        }
        let now = self.cpu.signals.cycle();
        self.fetch_log();
        self.chip.lose_power_until(back_s, now);
        self.reset(ResetCause::Power);
    }

    /// Sets the highest brown-out level in the option bytes, as after the first boot of the firmware.
    pub fn set_brown_out(&mut self) {
        self.chip.set_brown_out();
    }

    /// Sets the supply of the chip, nominally 3.3 V. Below the brown-out level the chip is held in reset. If no brown-out
    /// level is set and the supply is below the minimum for the core frequency, the core executes nothing. Its pins then
    /// keep their state until a reset.
    pub fn set_supply(&mut self, volts: f64) {
        self.chip.set_supply(volts, &mut self.cpu.signals);
        match self.chip.supply() {
            Supply::HeldInReset => self.reset(ResetCause::BrownOut),
            Supply::TooLow => self.powerless = true,
            Supply::Sound => {
                let held = self.resets.last().map(|(_, cause)| *cause);
                if self.powerless && held == Some(ResetCause::BrownOut) {
                    self.powerless = false;
                }
            }
        }
    }

    /// Pulls nFAULT of the bridge low, or releases it.
    pub fn set_bridge_fault(&mut self, on: bool) {
        let level = on.then_some(false);
        self.chip
            .connect(BRIDGE_NFAULT, level, &mut self.cpu.signals);
    }

    /// Makes the current converter report an overrun, as after a burst of bus traffic.
    pub fn overrun_current(&mut self) {
        self.chip.overrun_current();
    }

    /// Mutable access to the paddle, its wires and the faults of its current amplifier.
    pub fn wiring_mut(&mut self) -> &mut Wiring {
        &mut self.wiring
    }

    /// Sets how the serial line disturbs bytes from now on.
    pub fn set_line(&mut self, line: Line) {
        self.line = line;
    }

    /// Disconnects the serial input.
    pub fn cut_serial(&mut self) {
        self.serial_cut = true;
    }

    /// Presses or releases the button. A pressed button connects its pin to ground.
    pub fn set_button(&mut self, pressed: bool) {
        let level = pressed.then_some(false);
        self.chip.connect(BUTTON, level, &mut self.cpu.signals);
    }

    /// Shortest low time of a bridge input while the outputs were on, s. The bootstrap capacitor of the high side charges
    /// during the low time.
    pub fn shortest_low_s(&self) -> f64 {
        self.shortest_low_s
    }

    /// Stops or restarts the crystal oscillator.
    pub fn set_crystal(&mut self, runs: bool) {
        let now = self.cpu.signals.cycle();
        let seen = self.chip.set_crystal(runs, now);
        self.cpu.signals.set_nmi(seen);
        self.next_step = self.next_step.min(now + self.step_cycles());
    }

    /// Mutable access to the wires of the paddle.
    pub fn wires_mut(&mut self) -> &mut Wires {
        &mut self.wiring.wires
    }

    /// Types `text` on the terminal.
    pub fn type_in(&mut self, text: &str) {
        let now_s = self.time_s();
        self.terminal.send(text.as_bytes(), now_s);
    }

    /// Time since power-on, s.
    pub fn time_s(&self) -> f64 {
        self.chip.clock().seconds(self.cpu.signals.cycle())
    }

    /// The paddle on the board.
    pub fn wiring(&self) -> &Wiring {
        &self.wiring
    }

    /// The chip's memories.
    pub fn memories(&mut self) -> &mut Memories {
        self.chip.memories()
    }

    /// Takes the log entries since the last call.
    pub fn take_log(&mut self) -> Vec<Entry> {
        self.fetch_log();
        std::mem::take(&mut self.entries)
    }

    /// Takes the flash operations since the last call. If the supply fails during an operation, its cells hold random
    /// values.
    pub fn take_flash_changes(&mut self) -> Vec<FlashChange> {
        self.chip.take_flash_changes()
    }

    /// Resets since power-on: time in s, and cause.
    pub fn resets(&self) -> &[(f64, ResetCause)] {
        &self.resets
    }

    /// Starts or stops recording every paddle step.
    pub fn record_steps(&mut self, on: bool) {
        self.steps = on.then(Vec::new);
    }

    /// Takes the recorded steps since the last call. Empty if steps are not recorded.
    pub fn take_steps(&mut self) -> Vec<Step> {
        self.steps.as_mut().map(std::mem::take).unwrap_or_default()
    }
}
