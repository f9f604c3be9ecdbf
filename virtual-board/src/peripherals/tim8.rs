//! TIM8, an advanced timer. It counts up or up and down, with a repetition counter and preload registers, and drives PWM
//! outputs.

use super::{Answer, Lack, NEVER, bit, field, require};

const CR1: u32 = 0x00;
const CR2: u32 = 0x04;
const SMCR: u32 = 0x08;
const DIER: u32 = 0x0C;
const SR: u32 = 0x10;
const EGR: u32 = 0x14;
const CCMR1: u32 = 0x18;
const CCMR2: u32 = 0x1C;
const CCER: u32 = 0x20;
const CNT: u32 = 0x24;
const PSC: u32 = 0x28;
const ARR: u32 = 0x2C;
const RCR: u32 = 0x30;
const CCR1: u32 = 0x34;
const CCR4: u32 = 0x40;
const BDTR: u32 = 0x44;

const CEN: u32 = 0;
const UDIS: u32 = 1;
const URS: u32 = 2;
const ARPE: u32 = 7;
const UIF: u32 = 1;
/// Off-state in idle mode: with MOE cleared, the pins are driven to their idle state instead of released.
const OSSI: u32 = 10;
const BKE: u32 = 12;
const BKP: u32 = 13;
const MOE: u32 = 15;
const BIF: u32 = 1 << 7;
const MMS_UPDATE: u32 = 0b010;
const PWM_MODE_1: u32 = 0b110;
const PWM_MODE_2: u32 = 0b111;

/// Number of capture/compare channels.
const CHANNELS: usize = 4;

/// Register values that act until the next update.
#[derive(Debug, Clone, Copy, Default)]
struct Active {
    psc: u32,
    arr: u32,
    ccr: [u32; CHANNELS],
}

/// The timer. All channels are outputs. Compare flags are set at the update, for all matches since the last one.
#[derive(Debug, Clone)]
pub struct Tim8 {
    cr1: u32,
    cr2: u32,
    dier: u32,
    sr: u32,
    ccmr: [u32; 2],
    ccer: u32,
    psc: u32,
    arr: u32,
    rcr: u32,
    ccr: [u32; CHANNELS],
    bdtr: u32,
    active: Active,
    /// Turning points until the update, including the next one.
    turns_left: u32,
    /// Core cycles per clock of the timer.
    divider: u32,
    /// Cycle of the last turning point. Unused while it is stopped.
    turned_at: u64,
    /// True if it counts up after that point.
    up: bool,
    /// Count while it is stopped.
    stopped_at: u32,
    /// Cycle since which a debugger halts the timer.
    held_at: Option<u64>,
}

/// Effect of an output on its pin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Output {
    /// The pin is not driven. Its pull resistor sets the level.
    Released,
    /// The pin is driven and high for this fraction of the time, 0 to 1.
    High(f64),
}

impl Default for Tim8 {
    fn default() -> Self {
        Self {
            cr1: 0,
            cr2: 0,
            dier: 0,
            sr: 0,
            ccmr: [0; 2],
            ccer: 0,
            psc: 0,
            arr: 0xFFFF,
            rcr: 0,
            ccr: [0; CHANNELS],
            bdtr: 0,
            active: Active {
                arr: 0xFFFF,
                ..Active::default()
            },
            turns_left: 1,
            divider: 1,
            turned_at: 0,
            up: true,
            stopped_at: 0,
            held_at: None,
        }
    }
}

impl Tim8 {
    /// Reads a register at cycle `now`.
    pub fn read(&self, offset: u32, now: u64) -> Answer<u32> {
        Ok(match offset {
            CR1 => self.cr1,
            CR2 => self.cr2,
            SMCR => 0,
            DIER => self.dier,
            SR => self.sr,
            EGR => 0,
            CCMR1 | CCMR2 => self.ccmr[(offset - CCMR1) as usize / 4],
            CCER => self.ccer,
            CNT => self.count(now),
            PSC => self.psc,
            ARR => self.arr,
            RCR => self.rcr,
            CCR1..=CCR4 => self.ccr[(offset - CCR1) as usize / 4],
            BDTR => self.bdtr,
            _ => return Err(Lack::Register),
        })
    }

    /// Writes a register at cycle `now`. `divider` is the number of core cycles per timer clock. Returns true if the write
    /// causes an update.
    pub fn write(&mut self, offset: u32, value: u32, now: u64, divider: u32) -> Answer<bool> {
        match offset {
            CR1 => return self.control(value, now, divider).map(|()| false),
            CR2 => {
                const MMS: u32 = 0b111 << 4;
                const IDLE_STATES: u32 = 0b0101_0101 << 8;
                require(
                    value & !(MMS | IDLE_STATES) == 0,
                    "preloaded enables and complementary idle states",
                )?;
                require(
                    matches!(field(value, 4, 3), 0 | MMS_UPDATE),
                    "a trigger output other than reset and update",
                )?;
                self.cr2 = value;
            }
            SMCR => require(value == 0, "slave modes")?,
            DIER => {
                require(
                    value & !1 == 0,
                    "interrupts and DMA other than the update's",
                )?;
                self.dier = value;
            }
            SR => self.sr &= value,
            EGR => {
                require(value & !1 == 0, "events other than the update")?;
                if bit(value, 0) {
                    if !bit(self.cr1, URS) {
                        self.sr |= UIF;
                    }
                    self.reload();
                    self.stopped_at = 0;
                    self.turned_at = now;
                    self.up = true;
                    return Ok(true);
                }
            }
            CCMR1 | CCMR2 => {
                for channel in [field(value, 0, 8), field(value, 8, 8)] {
                    require(channel & 0b11 == 0, "inputs")?;
                    let mode = field(channel, 4, 3);
                    require(
                        matches!(mode, 0 | PWM_MODE_1 | PWM_MODE_2),
                        "an output mode other than PWM",
                    )?;
                }
                self.ccmr[(offset - CCMR1) as usize / 4] = value & 0xFFFF;
            }
            CCER => {
                const COMPLEMENTARY: u32 = 0x0CCC;
                require(value & COMPLEMENTARY == 0, "complementary outputs")?;
                self.ccer = value & 0x3FFF;
            }
            CNT => {
                require(!self.runs(), "setting the count while it runs")?;
                self.stopped_at = value & 0xFFFF;
            }
            PSC => self.psc = value & 0xFFFF,
            ARR => {
                self.arr = value & 0xFFFF;
                if !bit(self.cr1, ARPE) {
                    require(!self.runs(), "a new top without preload while it runs")?;
                    self.active.arr = self.arr;
                }
            }
            RCR => self.rcr = value & 0xFF,
            CCR1..=CCR4 => {
                let channel = (offset - CCR1) as usize / 4;
                self.ccr[channel] = value & 0xFFFF;
                if !self.preloaded(channel) {
                    self.active.ccr[channel] = self.ccr[channel];
                }
            }
            BDTR => {
                const LOCK: u32 = 0b11 << 8;
                const DEAD_TIME: u32 = 0xFF;
                const AUTOMATIC: u32 = 1 << 14;
                require(value & (LOCK | DEAD_TIME) == 0, "lock levels and dead time")?;
                require(
                    value & AUTOMATIC == 0,
                    "outputs that come back by themselves",
                )?;
                self.bdtr = value & 0xFFFF;
                // The break input is not connected to a pin and is low.
                if bit(value, BKE) && !bit(value, BKP) {
                    self.brake();
                }
            }
            _ => return Err(Lack::Register),
        }
        Ok(false)
    }

    fn control(&mut self, value: u32, now: u64, divider: u32) -> Answer {
        const KNOWN: u32 = 1 << CEN | 1 << UDIS | 1 << URS | 0b11 << 5 | 1 << ARPE;
        require(
            value & !KNOWN == 0,
            "one-pulse mode, counting down and clock division",
        )?;
        let starts = bit(value, CEN) && !self.runs();
        let stops = !bit(value, CEN) && self.runs();
        require(
            !self.runs() || stops || (value ^ self.cr1) & 0b11 << 5 == 0,
            "a change of the counting mode while it runs",
        )?;
        if stops {
            self.stopped_at = self.count(now);
        }
        self.cr1 = value;
        if starts {
            require(self.active.arr > 0, "counting to 0")?;
            require(
                self.stopped_at <= self.active.arr,
                "starting beyond the top",
            )?;
            self.divider = divider;
            self.up = true;
            self.turned_at = now - u64::from(self.stopped_at * self.clock_cycles()).min(now);
        }
        Ok(())
    }

    fn runs(&self) -> bool {
        bit(self.cr1, CEN)
    }

    /// Returns true in centre-aligned mode, in which it counts up and down.
    fn centre_aligned(&self) -> bool {
        field(self.cr1, 5, 2) != 0
    }

    fn preloaded(&self, channel: usize) -> bool {
        bit(self.ccmr[channel / 2], 8 * (channel as u32 % 2) + 3)
    }

    /// Core cycles per count.
    fn clock_cycles(&self) -> u32 {
        (self.active.psc + 1) * self.divider
    }

    /// Core cycles between two turning points.
    fn turn_cycles(&self) -> u64 {
        let counts = if self.centre_aligned() {
            self.active.arr
        } else {
            self.active.arr + 1
        };
        u64::from(counts) * u64::from(self.clock_cycles())
    }

    fn count(&self, now: u64) -> u32 {
        if !self.runs() {
            return self.stopped_at;
        }
        let now = self.held_at.unwrap_or(now);
        let since = now.saturating_sub(self.turned_at);
        let turns = since / self.turn_cycles();
        let counted = (since % self.turn_cycles()) as u32 / self.clock_cycles();
        if self.centre_aligned() && turns.is_multiple_of(2) != self.up {
            self.active.arr - counted
        } else {
            counted
        }
    }

    /// Loads the preload registers and restarts the repetition counter.
    fn reload(&mut self) {
        self.active = Active {
            psc: self.psc,
            arr: self.arr,
            ccr: self.ccr,
        };
        self.turns_left = self.rcr + 1;
    }

    /// Cycle of the next update.
    pub fn next_update(&self) -> u64 {
        if self.runs() && self.held_at.is_none() {
            self.turned_at + u64::from(self.turns_left) * self.turn_cycles()
        } else {
            NEVER
        }
    }

    /// Core cycles between updates with the present settings.
    pub fn update_cycles(&self) -> u64 {
        u64::from(self.rcr + 1) * self.turn_cycles()
    }

    /// Executes the update at its cycle. Returns true if it is an enabled update.
    pub fn update(&mut self) -> bool {
        let turns = self.turns_left;
        self.turned_at = self.next_update();
        if self.centre_aligned() && turns % 2 == 1 {
            self.up = !self.up;
        }
        if bit(self.cr1, UDIS) {
            self.turns_left = self.rcr + 1;
            return false;
        }
        for (channel, compare) in self.active.ccr.iter().enumerate() {
            if *compare <= self.active.arr {
                self.sr |= 1 << (channel + 1);
            }
        }
        self.sr |= UIF;
        self.reload();
        true
    }

    /// Returns true if the update requests an interrupt.
    pub fn requests_update_interrupt(&self) -> bool {
        self.sr & self.dier & UIF != 0
    }

    /// Returns true if updates are output as trigger.
    pub fn triggers_by_update(&self) -> bool {
        field(self.cr2, 4, 3) == MMS_UPDATE
    }

    /// A break: the clock security system has detected a failure, or the break input is active. If breaks are enabled, the
    /// outputs go off without software (RM0090, section 17.3.12).
    pub fn brake(&mut self) {
        if bit(self.bdtr, BKE) {
            self.bdtr &= !(1 << MOE);
            self.sr |= BIF;
        }
    }

    /// A debugger halts the counter at cycle `now`. The outputs are then off as with MOE cleared (RM0090, section 17.3.20).
    pub fn hold(&mut self, now: u64) {
        self.held_at = Some(now);
    }

    /// The halted counter continues at cycle `now`.
    pub fn go_on(&mut self, now: u64) {
        if let Some(held_at) = self.held_at.take() {
            self.turned_at += now - held_at;
        }
    }

    /// Effect of output `channel` (from 0) on its pin (RM0090, table of the output control bits).
    pub fn output(&self, channel: usize) -> Output {
        let (number, place) = (channel as u32 / 2, channel as u32 % 2);
        let mode = field(self.ccmr[number as usize], 8 * place + 4, 3);
        if !bit(self.ccer, 4 * channel as u32) {
            return Output::Released;
        }
        if !bit(self.bdtr, MOE) || self.held_at.is_some() {
            return if bit(self.bdtr, OSSI) {
                let idle = bit(self.cr2, 8 + 2 * channel as u32);
                Output::High(f64::from(u8::from(idle)))
            } else {
                Output::Released
            };
        }
        if !self.runs() || mode < PWM_MODE_1 {
            return Output::Released;
        }
        let share = (f64::from(self.active.ccr[channel]) / f64::from(self.active.arr)).min(1.0);
        let inverted = (mode == PWM_MODE_2) != self.inverted(channel);
        Output::High(if inverted { 1.0 - share } else { share })
    }

    /// Returns true if an output passes through the high level on its way to a low idle state. The inactive level comes
    /// first, and its polarity defines it (RM0090, the same table).
    pub fn inverted(&self, channel: usize) -> bool {
        bit(self.ccer, 4 * channel as u32 + 1)
    }

    /// Core cycles of a PWM period.
    pub fn pwm_cycles(&self) -> u64 {
        if self.centre_aligned() {
            2 * self.turn_cycles()
        } else {
            self.turn_cycles()
        }
    }

    /// Value last written to the compare register of `channel` (from 0). It acts from the next update.
    pub fn compare(&self, channel: usize) -> u32 {
        self.ccr[channel]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Centre-aligned up to 2100, with an update at every fourth turning point. Channels 1 and 2 have opposite polarity.
    fn bridge(started_at: u64) -> Tim8 {
        let mut timer = Tim8::default();
        for (offset, value) in [
            (ARR, 2100),
            (RCR, 3),
            (CCMR1, 0x6868),
            (CCER, 0b11_0001),
            (CR2, MMS_UPDATE << 4),
            (CR1, 1 << 5 | 1 << ARPE),
            (CCR1, 1050),
            (CCR1 + 4, 1050),
            (EGR, 1),
            (BDTR, 1 << MOE),
            (SR, !UIF),
            (CR1, 1 << 5 | 1 << ARPE | 1 << CEN),
        ] {
            timer.write(offset, value, started_at, 1).unwrap();
        }
        timer
    }

    #[test]
    fn every_fourth_turning_point_is_an_update() {
        let mut timer = bridge(1000);
        assert_eq!(timer.next_update(), 1000 + 8400);
        assert!(timer.update());
        assert_eq!(timer.next_update(), 1000 + 2 * 8400);
        assert_eq!(timer.read(SR, 0).unwrap() & UIF, UIF);
    }

    #[test]
    fn it_counts_up_and_down() {
        let timer = bridge(1000);
        for (after, count) in [
            (0, 0),
            (100, 100),
            (2100, 2100),
            (2200, 2000),
            (4200, 0),
            (4300, 100),
        ] {
            assert_eq!(timer.read(CNT, 1000 + after).unwrap(), count, "{after}");
        }
    }

    #[test]
    fn a_preloaded_compare_acts_from_the_update_on() {
        let mut timer = bridge(0);
        timer.write(CCR1, 2100, 10, 1).unwrap();
        assert_eq!(timer.output(0), Output::High(0.5));
        timer.update();
        assert_eq!(timer.output(0), Output::High(1.0));
        assert_eq!(timer.output(1), Output::High(0.5), "inverted half");
    }

    #[test]
    fn without_main_output_enable_no_pin_is_driven() {
        let mut timer = bridge(0);
        timer.write(BDTR, 0, 10, 1).unwrap();
        assert_eq!(timer.output(0), Output::Released);
        timer.write(BDTR, 1 << OSSI, 10, 1).unwrap();
        assert_eq!(timer.output(0), Output::High(0.0));
        timer.write(CR2, 1 << 8, 10, 1).unwrap();
        assert_eq!(timer.output(0), Output::High(1.0));
    }

    #[test]
    fn a_debugger_halt_disables_the_outputs_and_loses_no_count() {
        let mut timer = bridge(0);
        timer.hold(100);
        assert_eq!(timer.output(0), Output::Released);
        assert_eq!(timer.next_update(), NEVER);
        assert_eq!(timer.read(CNT, 5000).unwrap(), 100);
        timer.go_on(5000);
        assert_eq!(timer.output(0), Output::High(0.5));
        assert_eq!(timer.next_update(), 8400 + 4900);
    }

    #[test]
    fn a_break_lasts_until_the_program_ends_it() {
        let mut timer = bridge(0);
        timer.brake();
        assert_eq!(timer.output(0), Output::High(0.5), "not enabled");
        let enabled = 1 << MOE | 1 << OSSI | 1 << BKE | 1 << BKP;
        timer.write(BDTR, enabled, 10, 1).unwrap();
        timer.brake();
        assert_eq!(timer.output(0), Output::High(0.0));
        timer.update();
        assert_eq!(timer.output(0), Output::High(0.0));
        timer.write(BDTR, enabled, 10, 1).unwrap();
        assert_eq!(timer.output(0), Output::High(0.5));
        timer.write(BDTR, enabled & !(1 << BKP), 10, 1).unwrap();
        assert_eq!(timer.output(0), Output::High(0.0), "a low input breaks");
    }

    #[test]
    fn writing_zero_clears_a_flag_and_writing_one_keeps_it() {
        let mut timer = bridge(0);
        timer.update();
        timer.write(DIER, 1, 9000, 1).unwrap();
        assert!(timer.requests_update_interrupt());
        timer.write(SR, !0, 9000, 1).unwrap();
        assert!(timer.requests_update_interrupt());
        timer.write(SR, !UIF, 9000, 1).unwrap();
        assert!(!timer.requests_update_interrupt());
    }

    #[test]
    fn unmodelled_settings_are_refused() {
        let mut timer = Tim8::default();
        assert!(matches!(
            timer.write(BDTR, 1 << 14, 0, 1),
            Err(Lack::Use(_))
        ));
        assert!(matches!(timer.write(0x4C, 0, 0, 1), Err(Lack::Register)));
    }
}
