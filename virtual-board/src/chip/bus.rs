//! Bus accesses of the core: selects the peripheral and handles the consequences.

use super::lines;
use super::map::{self, PORTS, Place, Unit};
use super::{Chip, FLASH_BYTES};
use crate::cpu::{Bus, Memories, Refusal, Signals, Width};
use crate::peripherals::dma::Dma;
use crate::peripherals::exti::PIN_LINES;
use crate::peripherals::general_timer::GeneralTimer;
use crate::peripherals::pwr::Pwr;
use crate::peripherals::rcc::Clocks;
use crate::peripherals::syscfg::Syscfg;
use crate::peripherals::tim5::Tim5;
use crate::peripherals::tim8::Tim8;
use crate::peripherals::usart::Usart;
use crate::peripherals::{Answer, Lack, NEVER, bit};

/// Core cycles that a buffered write needs to reach APB2.
const POSTED_CYCLES: u64 = 12;

impl Bus for Chip {
    #[inline]
    fn memories(&mut self) -> &mut Memories {
        &mut self.memories
    }

    fn read(&mut self, address: u32, width: Width, signals: &mut Signals) -> Result<u32, Refusal> {
        let (unit, offset) = Self::find(address & !3)?;
        if !self.has_clock(unit, offset) {
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
            let began = self
                .flash
                .program(at, width, value, signals.cycle(), hz)
                .map_err(|lack| refusal(Unit::Flash, 0, lack))?;
            if began {
                self.note_flash_change(signals.cycle());
            }
            self.stall_while_flash_is_busy(signals);
            return Ok(());
        }
        let (unit, offset) = Self::find(address & !3)?;
        if !self.has_clock(unit, offset) {
            let register = map::register(unit, offset);
            self.remark(format!("a write to {register} without its clock is lost"));
            return Ok(());
        }
        // These peripherals have 16-bit registers. The APB bridge duplicates narrower writes to a full word, which only
        // wider registers would show.
        let of_16_bits = matches!(
            unit,
            Unit::Usart2 | Unit::Tim8 | Unit::Tim3 | Unit::Iwdg | Unit::Syscfg
        );
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

impl Chip {
    fn read_unit(&mut self, unit: Unit, offset: u32, signals: &mut Signals) -> Answer<u32> {
        let now = signals.cycle();
        match unit {
            Unit::Tim8 => self.tim8.read(offset, now),
            Unit::Tim2 => self.tim2.read(offset, now),
            Unit::Tim3 => self.tim3.read(offset, now),
            Unit::Tim5 => self.tim5.read(offset),
            Unit::Adc => self.read_adc(offset, now),
            Unit::Usart2 => {
                let value = self.usart2.read(offset);
                self.show_usart2(signals);
                value
            }
            Unit::Gpio(port) => self.gpio[port].read(offset),
            Unit::Rcc => self.rcc.read(offset, now),
            Unit::Dma1 => self.dma1.read(offset),
            Unit::Dma2 => self.dma2.read(offset),
            Unit::Exti => {
                // A read waits for earlier buffered writes.
                self.settle_posted(NEVER - 1, signals);
                self.exti.read(offset)
            }
            Unit::Syscfg => self.syscfg.read(offset),
            Unit::Pwr => self.pwr.read(offset),
            Unit::Flash => self.flash.read(offset),
            Unit::Iwdg => self.iwdg.read(offset),
            Unit::Dbgmcu => self.dbgmcu.read(offset),
            Unit::Factory => factory_word(offset),
        }
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
                signals.set_line(lines::TIM8_UP_TIM13, self.tim8.requests_update_interrupt());
                // A timer that starts also sets the step times of the paddle.
                self.expect(self.tim8.next_update(), signals);
            }
            Unit::Tim2 => {
                let divider = Clocks::timer_divider(apb1);
                self.tim2.write(offset, value, now, divider)?;
            }
            Unit::Tim3 => {
                self.deliver_all(now);
                let divider = Clocks::timer_divider(apb1);
                self.tim3.write(offset, value, now, divider)?;
            }
            Unit::Tim5 => self.tim5.write(offset, value)?,
            Unit::Adc => self.write_adc(offset, value, now)?,
            Unit::Usart2 => {
                self.usart2.write(offset, value, now, apb1)?;
                self.carry_serial(now, signals);
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
            Unit::Dma1 => {
                self.dma1.write(offset, value)?;
                self.carry_serial(now, signals);
                self.expect(self.usart2.next_sent(), signals);
            }
            Unit::Dma2 => {
                self.dma2.write(offset, value)?;
                self.show_dma2(signals);
            }
            Unit::Exti => {
                // The write is buffered. The interrupt line falls when the write has reached the slower bus, possibly after
                // the handler has returned. Only the EXTI flags are modelled in this way.
                self.exti.write(offset, value)?;
                self.posted_at = now + POSTED_CYCLES;
                self.expect(self.posted_at, signals);
            }
            Unit::Syscfg => self.syscfg.write(offset, value)?,
            Unit::Pwr => {
                let changed = self.pwr.write(offset, value)?;
                self.follow_detector(changed, signals);
            }
            Unit::Flash => {
                if self
                    .flash
                    .write(offset, value, now, self.clock.hz())?
                    .is_some()
                {
                    self.note_flash_change(now);
                }
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
        let held = |unit| map::gate(unit, 0).is_some_and(|gate| self.rcc.held_in_reset(gate));
        let [tim8, tim2, tim3, tim5, adc, dma1, dma2, usart2, syscfg, pwr] = [
            Unit::Tim8,
            Unit::Tim2,
            Unit::Tim3,
            Unit::Tim5,
            Unit::Adc,
            Unit::Dma1,
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
        if tim2 {
            self.tim2 = GeneralTimer::wide();
        }
        if tim3 {
            self.tim3 = GeneralTimer::narrow();
        }
        if tim5 {
            self.tim5 = Tim5::default();
        }
        if adc {
            self.adc = Default::default();
            self.adc_common = 0;
        }
        if dma1 {
            self.dma1 = Dma::default();
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
            self.pwr = Pwr::reset(self.supply_v);
        }
        for (port, _) in ports.iter().enumerate().filter(|(_, held)| **held) {
            self.gpio[port].reset_registers(port);
        }
    }

    /// Delays an instruction fetch from flash until a running flash operation has ended.
    fn stall_while_flash_is_busy(&mut self, signals: &mut Signals) {
        let done = self.flash.next_done();
        if done != NEVER {
            let cycles = done.saturating_sub(signals.cycle());
            signals.wait(u32::try_from(cycles).unwrap_or(u32::MAX));
            self.expect(done, signals);
        }
    }

    /// Tells the core that an event is due at cycle `at`, so that the run ends there.
    #[inline]
    fn expect(&self, at: u64, signals: &mut Signals) {
        if at < self.deadline {
            signals.call_board();
        }
    }

    /// Returns true if the peripheral has a clock. Without it, reads and writes have no effect.
    #[inline]
    fn has_clock(&self, unit: Unit, offset: u32) -> bool {
        map::gate(unit, offset).is_none_or(|gate| self.rcc.enabled(gate))
    }

    /// Finds the modelled register at `address`.
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

fn refusal(unit: Unit, offset: u32, lack: Lack) -> Refusal {
    let register = map::register(unit, offset);
    Refusal::Unmodelled(match lack {
        Lack::Register => register,
        Lack::Use(what) => format!("{register} ({what})"),
    })
}

/// Factory-programmed words: a made-up unique identifier, the flash size in KiB, and calibration values of the converters at
/// 3.3 V. The calibration values are typical ones of the data sheet, for the reference voltage and for the temperature
/// sensor at 30 and 110 °C.
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

#[cfg(test)]
mod tests {
    use super::*;

    const FLASH: u32 = 0x4002_3C00;

    fn unmodelled(chip: &mut Chip, address: u32) -> String {
        match chip.read(address, Width::Word, &mut Signals::default()) {
            Err(Refusal::Unmodelled(what)) => what,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn an_unmodelled_register_is_named() {
        let chip = &mut Chip::new();
        assert_eq!(unmodelled(chip, 0x4000_5410), "I2C1 + 0x10");
        assert_eq!(unmodelled(chip, 0x4002_3C20), "FLASH + 0x20");
        assert_eq!(
            unmodelled(chip, 0x4001_2008),
            "ADC1 + 0x08 (a read without its clock)"
        );
        let nothing = chip.read(0x4000_7800, Width::Word, &mut Signals::default());
        assert_eq!(nothing, Err(Refusal::BusFault));
    }

    #[test]
    fn a_write_without_a_clock_is_lost_and_logged() {
        let chip = &mut Chip::new();
        let written = chip.write(0x4002_0818, Width::Word, 1, &mut Signals::default());
        assert_eq!(written, Ok(()));
        assert_eq!(
            chip.take_remarks(),
            ["a write to GPIOC + 0x18 without its clock is lost"]
        );
    }

    #[test]
    fn a_write_that_clears_an_edge_is_buffered_and_a_read_waits_for_it() {
        const EXTI: u32 = 0x4001_3C00;
        const LINE: usize = 40;
        let chip = &mut Chip::new();
        let signals = &mut Signals::default();
        chip.write(EXTI, Width::Word, 1 << 15, signals).unwrap();
        for reads_back in [false, true] {
            chip.exti.write(0x10, 1 << 15).unwrap();
            chip.show_exti(signals);
            chip.write(EXTI + 0x14, Width::Word, 1 << 15, signals)
                .unwrap();
            if reads_back {
                chip.read(EXTI + 0x14, Width::Word, signals).unwrap();
            }
            assert_eq!(signals.line(LINE), !reads_back);
            assert!(chip.settle_posted(POSTED_CYCLES, signals) != reads_back);
            assert!(!signals.line(LINE));
        }
    }

    #[test]
    fn the_factory_words_can_be_read() {
        let chip = &mut Chip::new();
        let kib = chip.read(0x1FFF_7A22, Width::Half, &mut Signals::default());
        assert_eq!(kib, Ok(1024));
    }

    #[test]
    fn a_loss_of_the_supply_corrupts_only_the_sector_being_erased() {
        let chip = &mut Chip::new();
        let signals = &mut Signals::default();
        chip.memories.flash_mut().fill(0);
        for (offset, value) in [
            (0x04, 0x4567_0123),
            (0x04, 0xCDEF_89AB),
            // Erase sector 1: select and start.
            (0x10, 1 << 1 | 1 << 3 | 1 << 16),
        ] {
            chip.write(FLASH + offset, Width::Word, value, signals)
                .unwrap();
        }
        chip.lose_power_until(1.0, 1000);
        let flash = chip.memories.flash();
        let sector = 16 * 1024..32 * 1024;
        assert!(
            flash[..sector.start]
                .iter()
                .chain(&flash[sector.end..])
                .all(|cell| *cell == 0)
        );
        let erased = flash[sector.clone()]
            .iter()
            .filter(|cell| **cell == 0xFF)
            .count();
        assert!(erased > 0 && erased < sector.len());
    }
}
