//! One analog-to-digital converter. It converts a single regular channel, once or continuously. Software, TIM8 or TIM3
//! starts it.

use super::{Answer, Lack, bit, field, require};

const SR: u32 = 0x00;
const CR1: u32 = 0x04;
const CR2: u32 = 0x08;
const SMPR1: u32 = 0x0C;
const SMPR2: u32 = 0x10;
const SQR1: u32 = 0x2C;
const SQR2: u32 = 0x30;
const SQR3: u32 = 0x34;
/// Offset of the data register, which DMA reads.
pub const DR: u32 = 0x4C;

const EOC: u32 = 1 << 1;
const STRT: u32 = 1 << 4;
const OVR: u32 = 1 << 5;
const ADON: u32 = 0;
const CONT: u32 = 1;
const DMA: u32 = 8;
const ALIGN: u32 = 11;
const SWSTART: u32 = 30;
const TIM8_TRGO: u32 = 0b1110;
const TIM3_TRGO: u32 = 0b1000;
const RISING: u32 = 0b01;

/// Offset of the common registers of all converters.
pub const COMMON: u32 = 0x300;
/// Common control register.
pub const CCR: u32 = COMMON + 0x04;

/// One converter.
#[derive(Debug, Clone, Default)]
pub struct Adc {
    sr: u32,
    cr1: u32,
    cr2: u32,
    smpr: [u32; 2],
    sqr: [u32; 3],
    dr: u32,
    /// Cycle at which the running conversion ends.
    ends_at: Option<u64>,
    /// Core cycles per clock of the converter.
    divider: u32,
    /// Cycle up to which the triggers of TIM3 have been processed.
    followed: u64,
}

impl Adc {
    /// Reads a register. All conversions that have ended must have been [delivered](Self::deliver).
    #[inline]
    pub fn read(&mut self, offset: u32) -> Answer<u32> {
        Ok(match offset {
            DR => {
                self.sr &= !EOC;
                self.dr
            }
            SR => self.sr,
            CR1 => self.cr1,
            CR2 => self.cr2,
            SMPR1 => self.smpr[0],
            SMPR2 => self.smpr[1],
            SQR1..=SQR3 => self.sqr[(offset - SQR1) as usize / 4],
            _ => return Err(Lack::Register),
        })
    }

    /// Writes a register at cycle `now`. `divider` is the number of core cycles per converter clock.
    pub fn write(&mut self, offset: u32, value: u32, now: u64, divider: u32) -> Answer {
        match offset {
            SR => self.sr &= value,
            CR1 => {
                require(
                    value == 0,
                    "scans, interrupts, watchdogs and lower resolutions",
                )?;
                self.cr1 = value;
            }
            CR2 => {
                require(!bit(value, ALIGN), "left alignment")?;
                require(field(value, 20, 2) == 0, "injected channels")?;
                let edge = field(value, 28, 2);
                require(
                    edge == 0
                        || edge == RISING && matches!(field(value, 24, 4), TIM8_TRGO | TIM3_TRGO),
                    "an external trigger other than the rise of TIM8's or TIM3's",
                )?;
                let followed = self.paced() && self.collected();
                const FIELDS: u32 = 0x7F7F_0F03;
                self.cr2 = value & FIELDS & !(1 << SWSTART);
                if self.paced() {
                    require(
                        !bit(value, CONT),
                        "conversions without pause that a trigger paces",
                    )?;
                    self.divider = divider;
                    if !followed {
                        // Earlier results are not collected. A running conversion continues.
                        self.skip_to(now);
                    }
                }
                if !bit(value, ADON) {
                    self.ends_at = None;
                } else if bit(value, SWSTART) {
                    self.start(now, divider);
                }
            }
            SMPR1 => self.smpr[0] = value & 0x07FF_FFFF,
            SMPR2 => self.smpr[1] = value & 0x3FFF_FFFF,
            SQR1 => {
                require(value == 0, "a sequence of more than one channel")?;
                self.sqr[0] = value;
            }
            SQR2 | SQR3 => self.sqr[(offset - SQR1) as usize / 4] = value & 0x3FFF_FFFF,
            _ => return Err(Lack::Register),
        }
        Ok(())
    }

    /// A trigger of TIM8 at cycle `at`.
    pub fn trigger(&mut self, at: u64, divider: u32) {
        let waits = bit(self.cr2, ADON)
            && field(self.cr2, 28, 2) == RISING
            && field(self.cr2, 24, 4) == TIM8_TRGO;
        if waits && self.ends_at.is_none() {
            self.start(at, divider);
        }
    }

    fn start(&mut self, at: u64, divider: u32) {
        self.divider = divider;
        self.sr |= STRT;
        self.ends_at = Some(at + self.conversion_cycles());
    }

    /// Returns true if each update of TIM3 starts one conversion.
    pub fn paced(&self) -> bool {
        bit(self.cr2, ADON)
            && field(self.cr2, 28, 2) == RISING
            && field(self.cr2, 24, 4) == TIM3_TRGO
    }

    /// The interval of triggers, first cycle exclusive and last inclusive, whose conversions have ended since the last call.
    pub fn follow(&mut self, now: u64) -> (u64, u64) {
        let from = self.followed;
        self.followed = now.saturating_sub(self.conversion_cycles()).max(from);
        (from, self.followed)
    }

    /// Discards triggers whose conversions ended before cycle `now`.
    pub fn skip_to(&mut self, now: u64) {
        self.followed = self
            .followed
            .max(now.saturating_sub(self.conversion_cycles()));
    }

    /// Discards all triggers up to cycle `now`.
    pub fn begin_at(&mut self, now: u64) {
        self.followed = self.followed.max(now);
    }

    /// Fraction of the source voltage that the sampling capacitor reaches within the sampling time, for a source of
    /// `source_ohm`. The capacitor is assumed to start empty, which is the worst case (data sheet, ADC characteristics: 6 kΩ
    /// and 7 pF at most). An error below a twentieth of a count is neglected.
    pub fn settled_share(&self, source_ohm: f64, core_hz: f64) -> f64 {
        const SWITCH_OHM: f64 = 6e3;
        const CAPACITOR_F: f64 = 7e-12;
        const NEGLIGIBLE: f64 = 1e-5;
        let sampling_s = f64::from(self.sampling_clocks() * self.divider) / core_hz;
        let left = (-sampling_s / ((source_ohm + SWITCH_OHM) * CAPACITOR_F)).exp();
        if left < NEGLIGIBLE { 1.0 } else { 1.0 - left }
    }

    /// The channel that is converted.
    pub fn channel(&self) -> usize {
        field(self.sqr[2], 0, 5) as usize
    }

    /// Core cycles of a conversion: sampling plus 12 converter clocks.
    pub fn conversion_cycles(&self) -> u64 {
        const BITS: u32 = 12;
        u64::from((self.sampling_clocks() + BITS) * self.divider)
    }

    /// Sampling time in converter clocks.
    fn sampling_clocks(&self) -> u32 {
        const SAMPLING: [u32; 8] = [3, 15, 28, 56, 84, 112, 144, 480];
        let channel = self.channel() as u32;
        let code = match channel.checked_sub(10) {
            Some(place) => field(self.smpr[0], 3 * place, 3),
            None => field(self.smpr[1], 3 * channel, 3),
        };
        SAMPLING[code as usize]
    }

    /// Number of conversions that have ended by cycle `now`. In continuous mode, the next one then runs.
    #[inline]
    pub fn ended(&mut self, now: u64) -> u64 {
        let Some(end) = self.ends_at.filter(|end| *end <= now) else {
            return 0;
        };
        if bit(self.cr2, CONT) {
            let each = self.conversion_cycles();
            let ended = (now - end) / each + 1;
            self.ends_at = Some(end + ended * each);
            ended
        } else {
            self.ends_at = None;
            1
        }
    }

    /// Writes the result of a conversion to the data register. Returns true if DMA is to read it.
    #[inline]
    pub fn deliver(&mut self, counts: u16) -> bool {
        if self.sr & OVR != 0 && self.collected() {
            return false;
        }
        self.dr = u32::from(counts);
        self.sr |= EOC;
        self.collected()
    }

    /// Returns true if DMA reads the results.
    pub fn collected(&self) -> bool {
        bit(self.cr2, DMA)
    }

    /// DMA has read the data register.
    #[inline]
    pub fn taken(&mut self) {
        self.sr &= !EOC;
    }

    /// Sets the overrun flag: the previous result was not read.
    pub fn overrun(&mut self) {
        self.sr |= OVR;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn continuous(channel: u32) -> Adc {
        let mut adc = Adc::default();
        for (offset, value) in [
            (SQR3, channel),
            (
                CR2,
                1 << ADON | 1 << CONT | 1 << DMA | TIM8_TRGO << 24 | RISING << 28,
            ),
        ] {
            adc.write(offset, value, 0, 8).unwrap();
        }
        adc
    }

    #[test]
    fn seventy_conversions_fit_in_a_control_period() {
        let mut adc = continuous(3);
        adc.trigger(1000, 8);
        assert_eq!(adc.ended(1000 + 8400), 70);
        assert_eq!(adc.ends_at, Some(1000 + 8400 + 120));
    }

    #[test]
    fn a_triggered_converter_converts_once_per_trigger() {
        let mut adc = continuous(9);
        assert_eq!(adc.ended(1_000_000), 0);
        adc.trigger(1_000_000, 8);
        adc.trigger(1_000_050, 8);
        assert_eq!(adc.ends_at, Some(1_000_000 + 120));
    }

    #[test]
    fn an_overrun_stops_the_dma_requests() {
        let mut adc = continuous(3);
        assert!(adc.deliver(1));
        adc.overrun();
        assert!(!adc.deliver(2));
        assert_eq!(adc.read(DR).unwrap(), 1);
    }
}
