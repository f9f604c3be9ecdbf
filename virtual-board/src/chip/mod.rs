//! The chip: memories and peripherals, and what connects them to each other and to the core.

pub mod map;

use crate::clock::Clock;
use crate::cpu::{Bus, Memories, Refusal, Signals, Width};
use crate::peripherals::adc::{self, Adc};
use crate::peripherals::dbgmcu::Dbgmcu;
use crate::peripherals::dma::Dma;
use crate::peripherals::exti::{Exti, PIN_LINES};
use crate::peripherals::flash::Flash;
use crate::peripherals::gpio::{Gpio, Mode};
use crate::peripherals::iwdg::Iwdg;
use crate::peripherals::pwr::Pwr;
use crate::peripherals::rcc::{Bus as RccBus, Clocks, Gate, Rcc, ResetCause};
use crate::peripherals::syscfg::Syscfg;
use crate::peripherals::tim5::Tim5;
use crate::peripherals::tim8::Tim8;
use crate::peripherals::usart::Usart;
use crate::peripherals::{Answer, Lack, NEVER, bit};
use map::{PORTS, Place, Unit};

const FLASH_BYTES: usize = 1024 * 1024;
const SRAM_BYTES: usize = 128 * 1024;
const CCM_BYTES: usize = 64 * 1024;

/// A pin: port, counted from A, and number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Pin(pub usize, pub usize);

const PORT_A: usize = 0;
const PORT_B: usize = 1;
const PORT_C: usize = 2;
const PORT_D: usize = 3;

/// Numbers of alternate functions.
const AF_TIM5: Mode = Mode::Alternate(2);
const AF_TIM8: Mode = Mode::Alternate(3);
const AF_USART2: Mode = Mode::Alternate(7);

/// Pins of TIM8's first two channels, TIM5's inputs, and USART2.
const TIM8_PINS: [Pin; 2] = [Pin(PORT_C, 6), Pin(PORT_C, 7)];
const TIM5_PINS: [Pin; 2] = [Pin(PORT_A, 0), Pin(PORT_A, 1)];
const USART2_TX: Pin = Pin(PORT_D, 5);
const USART2_RX: Pin = Pin(PORT_D, 6);

/// Interrupt lines.
mod line {
    pub const EXTI: [(usize, std::ops::RangeInclusive<u32>); 7] = [
        (6, 0..=0),
        (7, 1..=1),
        (8, 2..=2),
        (9, 3..=3),
        (10, 4..=4),
        (23, 5..=9),
        (40, 10..=15),
    ];
    pub const USART2: usize = 38;
    pub const TIM8_UP_TIM13: usize = 44;
    /// Of DMA2's streams 0 to 4, and 5 to 7.
    pub const DMA2: [usize; 8] = [56, 57, 58, 59, 60, 68, 69, 70];
}

/// Streams and channels of DMA2 that serve each converter.
const ADC_STREAMS: [[(usize, u32); 2]; 3] = [[(0, 0), (4, 0)], [(2, 1), (3, 1)], [(0, 2), (1, 2)]];
const ADC_BASE: u32 = 0x4001_2000;
const CONVERTERS: usize = 3;
const CONVERTER_BYTES: u32 = 0x100;

/// What stands at a pin for the converters: parts of a count, and what rounding has left over.
#[derive(Debug, Clone, Copy)]
struct Level {
    parts: u32,
    left_over: u32,
}

impl Level {
    const PARTS_PER_COUNT: u32 = 1 << 16;

    fn set(&mut self, counts: f64) {
        self.parts = (counts * f64::from(Self::PARTS_PER_COUNT)) as u32;
    }

    /// The next conversion. The signal's noise is far above one count where it is not a whole number, so that the mean
    /// of many conversions has no steps: what rounding leaves over goes into the next.
    #[inline]
    fn convert(&mut self) -> u16 {
        let wanted = self.parts + self.left_over;
        self.left_over = wanted % Self::PARTS_PER_COUNT;
        (wanted / Self::PARTS_PER_COUNT) as u16
    }
}

impl Default for Level {
    fn default() -> Self {
        Self {
            parts: 0,
            left_over: Self::PARTS_PER_COUNT / 2,
        }
    }
}

/// The chip.
#[derive(Debug, Clone)]
pub struct Chip {
    memories: Memories,
    clock: Clock,
    clocks: Clocks,
    /// Control of the clocks.
    pub rcc: Rcc,
    /// The bridge's timer.
    pub tim8: Tim8,
    tim5: Tim5,
    adc: [Adc; CONVERTERS],
    adc_common: u32,
    levels: [(Pin, Level); ANALOG_PINS.len()],
    delivered: Delivered,
    dma2: Dma,
    /// The console's port.
    pub usart2: Usart,
    gpio: [Gpio; PORTS],
    exti: Exti,
    syscfg: Syscfg,
    pwr: Pwr,
    flash: Flash,
    iwdg: Iwdg,
    dbgmcu: Dbgmcu,
    /// What an event could not do, as for [`Refusal::Unmodelled`].
    trouble: Option<String>,
    /// What the chip lets pass, and a program does not mean.
    remarks: Vec<String>,
    /// Until when the core runs if nobody calls.
    pub deadline: u64,
}

/// Pins at which something stands for the converters: current, Hall sensor.
const ANALOG_PINS: [Pin; 2] = [Pin(PORT_A, 3), Pin(PORT_B, 1)];
const CURRENT: usize = 0;
const HALL: usize = 1;

/// Conversions that DMA has carried away.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Delivered {
    /// Their sum, counts.
    pub sum: u32,
    /// Their number.
    pub conversions: u32,
}

impl Chip {
    /// A chip whose supply has just come, with erased flash.
    pub fn new() -> Self {
        let rcc = Rcc::reset(ResetCause::Power, None);
        let clocks = rcc.clocks();
        let mut chip = Self {
            memories: Memories::new(FLASH_BYTES, SRAM_BYTES, CCM_BYTES),
            clock: Clock::new(0, 0.0, clocks.hclk_hz),
            clocks,
            rcc,
            tim8: Tim8::default(),
            tim5: Tim5::default(),
            adc: Default::default(),
            adc_common: 0,
            levels: ANALOG_PINS.map(|pin| (pin, Level::default())),
            delivered: Delivered::default(),
            dma2: Dma::default(),
            usart2: Usart::default(),
            gpio: std::array::from_fn(Gpio::reset),
            exti: Exti::default(),
            syscfg: Syscfg::default(),
            pwr: Pwr::default(),
            flash: Flash::default(),
            iwdg: Iwdg::default(),
            dbgmcu: Dbgmcu::default(),
            trouble: None,
            remarks: Vec::new(),
            deadline: 0,
        };
        chip.forget(0);
        chip
    }

    /// Resets everything but the memories, at cycle `now`. A change of the flash is cut short.
    pub fn reset(&mut self, cause: ResetCause, now: u64, signals: &mut Signals) {
        self.cut_flash_change(now);
        self.rcc = Rcc::reset(cause, Some(&self.rcc));
        self.follow_clocks(now);
        self.tim8 = Tim8::default();
        self.tim5 = Tim5::default();
        self.adc = Default::default();
        self.adc_common = 0;
        self.dma2 = Dma::default();
        self.usart2 = Usart::default();
        for (port, gpio) in self.gpio.iter_mut().enumerate() {
            gpio.reset_registers(port);
        }
        self.exti = Exti::default();
        self.syscfg = Syscfg::default();
        self.pwr = Pwr::default();
        self.flash = Flash::default();
        self.iwdg = Iwdg::default();
        if cause == ResetCause::Power {
            self.dbgmcu = Dbgmcu::default();
        }
        self.show_lines(signals);
        signals.set_nmi(false);
        signals.set_flash_timing(self.flash.timing());
    }

    /// Goes on at time `s`, with what RAM holds after its supply was gone.
    pub fn lose_power_until(&mut self, s: f64, now: u64) {
        self.cut_flash_change(now);
        self.clock = Clock::new(now, s, self.clock.hz());
        self.forget(now);
    }

    /// Fills RAM with what nobody wrote.
    fn forget(&mut self, seed: u64) {
        let mut noise = noise(seed);
        for cell in self.memories.sram.iter_mut().chain(&mut self.memories.ccm) {
            *cell = noise();
        }
    }

    fn cut_flash_change(&mut self, now: u64) {
        if let Some(change) = self.flash.done() {
            change.interrupt(self.memories.flash_mut(), noise(now));
        }
    }

    fn follow_clocks(&mut self, now: u64) {
        let clocks = self.rcc.clocks();
        if clocks != self.clocks {
            self.clocks = clocks;
            // A core without a clock would stand still for ever; so does one of 1 Hz.
            self.clock.set_rate(now, clocks.hclk_hz.max(1.0));
        }
    }

    /// Stops or starts the crystal. Returns whether the clock security system has seen it.
    pub fn set_crystal(&mut self, runs: bool, now: u64) -> bool {
        let seen = self.rcc.set_crystal(runs);
        self.follow_clocks(now);
        seen
    }

    /// Time and cycles.
    pub fn clock(&self) -> &Clock {
        &self.clock
    }

    /// Memories, to be looked at.
    pub fn memory(&self) -> &Memories {
        &self.memories
    }

    /// Cycles of the core in a bit of the console's port.
    pub fn usart2_bit_cycles(&self) -> u64 {
        self.usart2.bit_cycles(self.clocks.apb1_divider)
    }

    /// Cycle of the next event in here.
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
            .min(watchdog)
    }

    /// Whether the watchdog has run out by cycle `now`.
    pub fn watchdog_expired(&self, now: u64) -> bool {
        let expires_s = self.iwdg.expires_s();
        expires_s.is_some_and(|at_s| self.clock.cycle_at(at_s) <= now)
    }

    /// Carries out an update of TIM8 that is due at its cycle.
    pub fn update_tim8(&mut self, signals: &mut Signals) {
        let at = self.tim8.next_update();
        if self.tim8.update() {
            self.trigger(at);
        }
        signals.set_line(line::TIM8_UP_TIM13, self.tim8.requests_update_interrupt());
    }

    fn trigger(&mut self, at: u64) {
        if self.tim8.triggers_by_update() {
            let divider = self.adc_divider();
            for adc in &mut self.adc {
                adc.trigger(at, divider);
            }
        }
    }

    /// Takes the byte that USART2 has just sent; `None` if its pin is not given to it.
    pub fn take_sent(&mut self, signals: &mut Signals) -> Option<u8> {
        let byte = self.usart2.sent(self.clocks.apb1_divider);
        self.show_usart2(signals);
        byte.filter(|_| self.mode(USART2_TX) == AF_USART2)
    }

    /// A byte arrives at USART2's pin.
    pub fn receive(&mut self, byte: u8, signals: &mut Signals) {
        if self.mode(USART2_RX) == AF_USART2 {
            self.usart2.receive(byte);
            self.show_usart2(signals);
        }
    }

    /// Ends a change of the flash that is due.
    pub fn finish_flash_change(&mut self) {
        if let Some(change) = self.flash.done() {
            change.apply(self.memories.flash_mut());
        }
    }

    /// Share of the supply, -1 to 1, that TIM8's channels put between their pins; `None` if one is not driven.
    pub fn half_bridges(&self) -> Option<f64> {
        let [a, b] = TIM8_PINS;
        if self.mode(a) != AF_TIM8 || self.mode(b) != AF_TIM8 {
            return None;
        }
        Some(self.tim8.high_share(0)? - self.tim8.high_share(1)?)
    }

    /// Level that the program drives on a pin.
    pub fn driven(&self, Pin(port, pin): Pin) -> Option<bool> {
        self.gpio[port].driven(pin)
    }

    fn mode(&self, Pin(port, pin): Pin) -> Mode {
        self.gpio[port].mode(pin)
    }

    /// Connects a pin to a level from outside, with what its edge does.
    pub fn connect(&mut self, Pin(port, pin): Pin, level: Option<bool>, signals: &mut Signals) {
        let before = self.gpio[port].level(pin);
        self.gpio[port].connect(pin, level);
        let after = self.gpio[port].level(pin);
        self.edge(port, pin, before, after);
        self.show_exti(signals);
    }

    fn edge(&mut self, port: usize, pin: usize, before: bool, after: bool) {
        if before != after && self.syscfg.port_of_line(pin) == port {
            self.exti.edge(pin, after);
        }
    }

    /// The encoder has moved by so many counts in so many cycles.
    pub fn follow_encoder(&mut self, counts: i32, cycles: u64) {
        if TIM5_PINS.iter().all(|pin| self.mode(*pin) == AF_TIM5) {
            let divider = Clocks::timer_divider(self.clocks.apb1_divider);
            self.tim5.follow(counts, cycles / u64::from(divider));
        }
    }

    /// Sets what stands at the converters' pins, counts, and lets DMA carry away what was converted up to cycle `now`.
    pub fn sense(&mut self, current_counts: f64, hall_counts: u16, now: u64) {
        self.levels[CURRENT].1.set(current_counts);
        self.levels[HALL].1.set(f64::from(hall_counts));
        for number in 0..CONVERTERS {
            if self.adc[number].collected() {
                self.deliver(number, now);
            }
        }
    }

    /// The conversions that DMA has carried away since the last call.
    pub fn take_delivered(&mut self) -> Delivered {
        std::mem::take(&mut self.delivered)
    }

    /// The count that a program reads from the encoder's timer now.
    pub fn encoder_count(&self) -> u32 {
        self.tim5.read(TIM5_CNT).unwrap_or_default()
    }

    fn remark(&mut self, remark: String) {
        // Once is enough for a loop that does it all the time.
        if !self.remarks.contains(&remark) {
            self.remarks.push(remark);
        }
    }

    /// What a program did since the last call that has no effect on the chip, and that it does not mean.
    pub fn take_remarks(&mut self) -> Vec<String> {
        std::mem::take(&mut self.remarks)
    }

    /// What cannot go on, if there is something.
    pub fn take_trouble(&mut self) -> Option<String> {
        self.trouble.take()
    }

    /// Converts up to cycle `now`.
    fn deliver(&mut self, number: usize, now: u64) {
        let adc = &mut self.adc[number];
        let ended = adc.ended(now);
        if ended == 0 {
            return;
        }
        let channel = adc.channel();
        let Some((_, level)) = connected(&mut self.levels, &self.gpio, channel) else {
            self.trouble = Some(format!(
                "what channel {channel} of ADC{} converts, at no analog pin that is connected,",
                number + 1
            ));
            return;
        };
        if !adc.collected() {
            adc.deliver(level.convert());
            return;
        }
        let from = ADC_BASE + CONVERTER_BYTES * number as u32 + adc::DR;
        let stream = self.dma2.serving(from, &ADC_STREAMS[number]);
        for _ in 0..ended {
            let counts = level.convert();
            if !adc.deliver(counts) {
                break;
            }
            let Some(to) = stream.and_then(|stream| self.dma2.carry(stream)) else {
                adc.overrun();
                break;
            };
            adc.taken();
            let in_sram = to.address >> 24 == Memories::SRAM >> 24;
            let written = in_sram
                .then(|| self.memories.write(to.address, to.width, counts.into()))
                .flatten();
            if written.is_none() {
                self.trouble = Some(format!(
                    "a transfer of DMA2 to {:#010x}, where it reaches no RAM,",
                    to.address
                ));
            }
            self.delivered.sum += u32::from(counts);
            self.delivered.conversions += 1;
        }
    }

    fn adc_divider(&self) -> u32 {
        let prescaler = 2 * ((self.adc_common >> 16 & 0b11) + 1);
        prescaler * self.clocks.apb2_divider
    }

    fn show_lines(&mut self, signals: &mut Signals) {
        signals.set_line(line::TIM8_UP_TIM13, self.tim8.requests_update_interrupt());
        self.show_usart2(signals);
        self.show_exti(signals);
        self.show_dma2(signals);
    }

    fn show_usart2(&self, signals: &mut Signals) {
        signals.set_line(line::USART2, self.usart2.requests_interrupt());
    }

    fn show_exti(&self, signals: &mut Signals) {
        for (line, pins) in line::EXTI {
            signals.set_line(line, self.exti.requests(pins));
        }
    }

    fn show_dma2(&self, signals: &mut Signals) {
        for (stream, line) in line::DMA2.into_iter().enumerate() {
            signals.set_line(line, self.dma2.requests_interrupt(stream));
        }
    }

    fn read_unit(&mut self, unit: Unit, offset: u32, signals: &mut Signals) -> Answer<u32> {
        let now = signals.cycle();
        match unit {
            Unit::Tim8 => self.tim8.read(offset, now),
            Unit::Tim5 => self.tim5.read(offset),
            Unit::Adc => self.read_adc(offset, now),
            Unit::Usart2 => {
                let value = self.usart2.read(offset);
                self.show_usart2(signals);
                value
            }
            Unit::Gpio(port) => self.gpio[port].read(offset),
            Unit::Rcc => self.rcc.read(offset, now),
            Unit::Dma2 => self.dma2.read(offset),
            Unit::Exti => self.exti.read(offset),
            Unit::Syscfg => self.syscfg.read(offset),
            Unit::Pwr => self.pwr.read(offset),
            Unit::Flash => self.flash.read(offset),
            Unit::Iwdg => self.iwdg.read(offset),
            Unit::Dbgmcu => self.dbgmcu.read(offset),
            Unit::Factory => factory_word(offset),
        }
    }

    fn read_adc(&mut self, offset: u32, now: u64) -> Answer<u32> {
        if offset == adc::CCR {
            return Ok(self.adc_common);
        }
        let number = (offset / CONVERTER_BYTES) as usize;
        if number >= CONVERTERS {
            return Err(Lack::Register);
        }
        // What DMA carries away is delivered when it is sensed, a control period at a time.
        if !self.adc[number].collected() {
            self.deliver(number, now);
        }
        self.adc[number].read(offset % CONVERTER_BYTES)
    }

    fn write_unit(&mut self, unit: Unit, offset: u32, value: u32, signals: &mut Signals) -> Answer {
        let now = signals.cycle();
        let apb1 = self.clocks.apb1_divider;
        match unit {
            Unit::Tim8 => {
                let divider = Clocks::timer_divider(self.clocks.apb2_divider);
                if self.tim8.write(offset, value, now, divider)? {
                    self.trigger(now);
                }
                signals.set_line(line::TIM8_UP_TIM13, self.tim8.requests_update_interrupt());
                // A timer that starts sets the pace of the paddle too.
                self.expect(self.tim8.next_update(), signals);
            }
            Unit::Tim5 => self.tim5.write(offset, value)?,
            Unit::Adc => self.write_adc(offset, value, now)?,
            Unit::Usart2 => {
                self.usart2.write(offset, value, now, apb1)?;
                self.show_usart2(signals);
                self.expect(self.usart2.next_sent(), signals);
            }
            Unit::Gpio(port) => self.write_gpio(port, offset, value, signals)?,
            Unit::Rcc => {
                self.rcc.write(offset, value, now)?;
                self.reset_held();
                self.follow_clocks(now);
                signals.set_nmi(self.rcc.clock_failed());
                signals.call_board();
            }
            Unit::Dma2 => {
                self.dma2.write(offset, value)?;
                self.show_dma2(signals);
            }
            Unit::Exti => {
                self.exti.write(offset, value)?;
                self.show_exti(signals);
            }
            Unit::Syscfg => self.syscfg.write(offset, value)?,
            Unit::Pwr => self.pwr.write(offset, value)?,
            Unit::Flash => {
                self.flash.write(offset, value, now, self.clock.hz())?;
                signals.set_flash_timing(self.flash.timing());
                self.stall_while_flash_is_busy(signals);
            }
            Unit::Iwdg => {
                self.iwdg.write(offset, value, self.clock.seconds(now))?;
                if let Some(at_s) = self.iwdg.expires_s() {
                    self.expect(self.clock.cycle_at(at_s), signals);
                }
            }
            Unit::Dbgmcu => self.dbgmcu.write(offset, value)?,
            Unit::Factory => return Err(Lack::Use("a write to read-only memory")),
        }
        Ok(())
    }

    fn write_adc(&mut self, offset: u32, value: u32, now: u64) -> Answer {
        if offset == adc::CCR {
            const PRESCALER: u32 = 0b11 << 16;
            if value & !PRESCALER != 0 {
                return Err(Lack::Use(
                    "converters that work together, and the chip's own sensors",
                ));
            }
            self.adc_common = value;
            return Ok(());
        }
        let divider = self.adc_divider();
        let number = (offset / CONVERTER_BYTES) as usize;
        self.adc.get_mut(number).ok_or(Lack::Register)?.write(
            offset % CONVERTER_BYTES,
            value,
            now,
            divider,
        )
    }

    fn write_gpio(
        &mut self,
        port: usize,
        offset: u32,
        value: u32,
        signals: &mut Signals,
    ) -> Answer {
        let watched = self.exti.watched();
        let mut before = [false; PIN_LINES];
        for (pin, level) in before.iter_mut().enumerate() {
            *level = bit(watched, pin as u32) && self.gpio[port].level(pin);
        }
        self.gpio[port].write(offset, value)?;
        for (pin, before) in before.into_iter().enumerate() {
            if bit(watched, pin as u32) {
                self.edge(port, pin, before, self.gpio[port].level(pin));
                self.show_exti(signals);
            }
        }
        Ok(())
    }

    /// Resets the peripherals whose reset bit is set.
    fn reset_held(&mut self) {
        let held = |unit| gate(unit).is_some_and(|gate| self.rcc.held_in_reset(gate));
        let [tim8, tim5, adc, dma2, usart2, syscfg, pwr] = [
            Unit::Tim8,
            Unit::Tim5,
            Unit::Adc,
            Unit::Dma2,
            Unit::Usart2,
            Unit::Syscfg,
            Unit::Pwr,
        ]
        .map(held);
        let ports: [bool; PORTS] = std::array::from_fn(|port| held(Unit::Gpio(port)));
        if tim8 {
            self.tim8 = Tim8::default();
        }
        if tim5 {
            self.tim5 = Tim5::default();
        }
        if adc {
            self.adc = Default::default();
            self.adc_common = 0;
        }
        if dma2 {
            self.dma2 = Dma::default();
        }
        if usart2 {
            self.usart2 = Usart::default();
        }
        if syscfg {
            self.syscfg = Syscfg::default();
        }
        if pwr {
            self.pwr = Pwr::default();
        }
        for (port, _) in ports.iter().enumerate().filter(|(_, held)| **held) {
            self.gpio[port].reset_registers(port);
        }
    }

    /// The core fetches from flash, which does not answer until a change has ended.
    fn stall_while_flash_is_busy(&mut self, signals: &mut Signals) {
        let done = self.flash.next_done();
        if done != NEVER {
            let cycles = done.saturating_sub(signals.cycle());
            signals.wait(u32::try_from(cycles).unwrap_or(u32::MAX));
            self.expect(done, signals);
        }
    }

    /// There will be an event at cycle `at`; the run must not pass it.
    #[inline]
    fn expect(&self, at: u64, signals: &mut Signals) {
        if at < self.deadline {
            signals.call_board();
        }
    }

    /// Whether a peripheral has a clock, without which it neither answers nor takes anything.
    #[inline]
    fn has_clock(&self, unit: Unit) -> bool {
        gate(unit).is_none_or(|gate| self.rcc.enabled(gate))
    }

    /// The modelled register at `address`.
    #[inline]
    fn find(address: u32) -> Result<(Unit, u32), Refusal> {
        match map::place(address) {
            Place::Modelled(unit, offset) => Ok((unit, offset)),
            Place::Known(name, offset) => {
                Err(Refusal::Unmodelled(format!("{name} + {offset:#04x}")))
            }
            Place::Nothing => Err(Refusal::BusFault),
        }
    }
}

impl Default for Chip {
    fn default() -> Self {
        Self::new()
    }
}

impl Bus for Chip {
    #[inline]
    fn memories(&mut self) -> &mut Memories {
        &mut self.memories
    }

    fn read(&mut self, address: u32, width: Width, signals: &mut Signals) -> Result<u32, Refusal> {
        let (unit, offset) = Self::find(address & !3)?;
        if !self.has_clock(unit) {
            return Err(refusal(unit, offset, Lack::Use("a read without its clock")));
        }
        let word = self
            .read_unit(unit, offset, signals)
            .map_err(|lack| refusal(unit, offset, lack))?;
        let shifted = word >> (8 * (address & 3));
        Ok(match width {
            Width::Byte => shifted & 0xFF,
            Width::Half => shifted & 0xFFFF,
            Width::Word => shifted,
        })
    }

    fn write(
        &mut self,
        address: u32,
        width: Width,
        value: u32,
        signals: &mut Signals,
    ) -> Result<(), Refusal> {
        if let Some(at) = address.checked_sub(Memories::FLASH)
            && (at as usize) < FLASH_BYTES
        {
            let hz = self.clock.hz();
            self.flash
                .program(at, width, value, signals.cycle(), hz)
                .map_err(|lack| refusal(Unit::Flash, 0, lack))?;
            self.stall_while_flash_is_busy(signals);
            return Ok(());
        }
        let (unit, offset) = Self::find(address & !3)?;
        if !self.has_clock(unit) {
            let register = map::register(unit, offset);
            self.remark(format!("a write to {register} without its clock is lost"));
            return Ok(());
        }
        // These have 16 bits; the bridge to APB makes a word of what is narrower, in a way that the others would show.
        let of_16_bits = matches!(unit, Unit::Usart2 | Unit::Tim8 | Unit::Iwdg | Unit::Syscfg);
        if width == Width::Byte
            || width == Width::Half && (!of_16_bits || !address.is_multiple_of(4))
        {
            let narrow = Lack::Use("a write narrower than the register");
            return Err(refusal(unit, offset, narrow));
        }
        self.write_unit(unit, offset, value, signals)
            .map_err(|lack| refusal(unit, offset, lack))
    }
}

/// What stands at the pin of a converter's channel, if that is an analog one.
fn connected<'a>(
    levels: &'a mut [(Pin, Level)],
    gpio: &[Gpio],
    channel: usize,
) -> Option<&'a mut (Pin, Level)> {
    let pin = match channel {
        0..8 => Pin(PORT_A, channel),
        8..10 => Pin(PORT_B, channel - 8),
        10..16 => Pin(PORT_C, channel - 10),
        _ => return None,
    };
    levels
        .iter_mut()
        .find(|(known, _)| *known == pin && gpio[pin.0].mode(pin.1) == Mode::Analog)
}

/// Offset of the counter of TIM5.
const TIM5_CNT: u32 = 0x24;

fn refusal(unit: Unit, offset: u32, lack: Lack) -> Refusal {
    let register = map::register(unit, offset);
    Refusal::Unmodelled(match lack {
        Lack::Register => register,
        Lack::Use(what) => format!("{register} ({what})"),
    })
}

/// Clock gate of a peripheral; `None` for those that always have a clock.
#[inline]
const fn gate(unit: Unit) -> Option<Gate> {
    Some(match unit {
        Unit::Gpio(port) => Gate(RccBus::Ahb1, port as u32),
        Unit::Dma2 => Gate(RccBus::Ahb1, 22),
        Unit::Tim5 => Gate(RccBus::Apb1, 3),
        Unit::Usart2 => Gate(RccBus::Apb1, 17),
        Unit::Pwr => Gate(RccBus::Apb1, 28),
        Unit::Tim8 => Gate(RccBus::Apb2, 1),
        // Each converter has a gate of its own; this is that of the first.
        Unit::Adc => Gate(RccBus::Apb2, 8),
        Unit::Syscfg => Gate(RccBus::Apb2, 14),
        Unit::Iwdg | Unit::Exti | Unit::Rcc | Unit::Flash | Unit::Dbgmcu | Unit::Factory => {
            return None;
        }
    })
}

/// Words that the factory wrote: a made-up identity and lot, the size of the flash in KiB, and the calibration of the
/// converters at 3.3 V (data sheet, typical): reference voltage, temperature sensor at 30 and at 110 °C.
fn factory_word(offset: u32) -> Answer<u32> {
    const REFERENCE: u32 = 1500;
    const AT_30: u32 = 943;
    const AT_110: u32 = 1191;
    const FLASH_KIB: u32 = FLASH_BYTES as u32 / 1024;
    match offset {
        0x00 => Ok(0x0028_0019),
        0x04 => Ok(0x3133_5110),
        0x08 => Ok(0x3235_3739),
        0x10 => Ok(FLASH_KIB << 16),
        0x18 => Ok(REFERENCE << 16),
        0x1C => Ok(AT_110 << 16 | AT_30),
        _ => Err(Lack::Register),
    }
}

/// Bytes that look like chance and are the same for the same seed (xorshift64*, Vigna 2016).
fn noise(seed: u64) -> impl FnMut() -> u8 {
    let mut state = seed ^ 0x9E37_79B9_7F4A_7C15;
    move || {
        state ^= state >> 12;
        state ^= state << 25;
        state ^= state >> 27;
        (state.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 56) as u8
    }
}
