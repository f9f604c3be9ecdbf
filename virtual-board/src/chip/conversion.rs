//! Analog inputs: the signals at the converter pins, their conversion, and the transfer of the results.

use super::Chip;
use super::pins::{PORT_A, PORT_B, PORT_C, Pin};
use crate::cpu::Memories;
use crate::peripherals::adc;
use crate::peripherals::gpio::{Gpio, Mode};
use crate::peripherals::{Answer, Lack};

/// DMA2 streams and channels that can serve each converter.
const ADC_STREAMS: [[(usize, u32); 2]; 3] = [[(0, 0), (4, 0)], [(2, 1), (3, 1)], [(0, 2), (1, 2)]];

/// Number of converters.
pub(super) const CONVERTERS: usize = 3;
const ADC_BASE: u32 = 0x4001_2000;
const CONVERTER_BYTES: u32 = 0x100;

/// The analog pins: current and Hall sensor.
pub(super) const ANALOG_PINS: [Pin; 2] = [Pin(PORT_A, 3), Pin(PORT_B, 1)];
const CURRENT: usize = 0;
const HALL: usize = 1;
/// Source resistance of each signal at its pin, ohm. The circuit of the board is not published. These values assume voltage
/// dividers of 10 kΩ and 40 kΩ, which fit the sampling times of the lab's firmware.
const SOURCES_OHM: [f64; ANALOG_PINS.len()] = [5e3, 20e3];

/// The signal at an analog pin: its value in fractions of a count, and the accumulated rounding error.
#[derive(Debug, Clone, Copy)]
pub(super) struct Level {
    parts: u32,
    left_over: u32,
}

impl Level {
    const PARTS_PER_COUNT: u32 = 1 << 16;

    fn set(&mut self, counts: f64) {
        self.parts = (counts * f64::from(Self::PARTS_PER_COUNT)) as u32;
    }

    /// The next conversion result. The rounding error is carried into the next result, so that the mean of many results is
    /// exact. A real signal has noise well above one count, which has the same effect.
    #[inline]
    fn convert(&mut self, settled_share: f64) -> u16 {
        let wanted = (f64::from(self.parts) * settled_share) as u32 + self.left_over;
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

/// Conversion results that DMA has transferred.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Delivered {
    /// Sum of the results, counts.
    pub sum: u32,
    /// Number of results.
    pub conversions: u32,
}

impl Chip {
    /// Sets the signals at the converter pins, in counts. Transfers the results up to cycle `now` by DMA first.
    pub fn sense(&mut self, current_counts: f64, hall_counts: u16, now: u64) {
        self.levels[CURRENT].1.set(current_counts);
        self.levels[HALL].1.set(f64::from(hall_counts));
        self.deliver_all(now);
    }

    /// Transfers the results up to cycle `now` by DMA.
    pub(super) fn deliver_all(&mut self, now: u64) {
        for number in 0..CONVERTERS {
            if self.adc[number].collected() {
                self.deliver(number, now);
            }
        }
    }

    /// Makes the current converter report an overrun, as after a burst of bus traffic.
    pub fn overrun_current(&mut self) {
        const CURRENT_CONVERTER: usize = 2;
        self.adc[CURRENT_CONVERTER].overrun();
    }

    /// Remaining items of DMA2 stream `number`.
    pub fn ring_left(&self, number: usize) -> u32 {
        self.dma2.left(number)
    }

    /// Takes the results transferred by DMA since the last call.
    pub fn take_delivered(&mut self) -> Delivered {
        std::mem::take(&mut self.delivered)
    }

    /// Converts up to cycle `now`.
    fn deliver(&mut self, number: usize, now: u64) {
        let adc = &mut self.adc[number];
        let ended = if adc.paced() {
            let (from, to) = adc.follow(now);
            let triggers = self.tim3.triggers_by_update();
            let triggered = if triggers {
                self.tim3.updates(from, to)
            } else {
                0
            };
            if triggered > 0 && self.tim3.update_cycles() < adc.conversion_cycles() {
                self.trouble = Some("a trigger during a conversion".into());
            }
            triggered
        } else {
            adc.ended(now)
        };
        if ended == 0 {
            return;
        }
        let channel = adc.channel();
        let Some(place) = connected(&self.levels, &self.gpio, channel) else {
            self.trouble = Some(format!(
                "what channel {channel} of ADC{} converts, at no analog pin that is connected,",
                number + 1
            ));
            return;
        };
        let settled_share = adc.settled_share(SOURCES_OHM[place], self.clock.hz());
        let level = &mut self.levels[place].1;
        if !adc.collected() {
            adc.deliver(level.convert(settled_share));
            return;
        }
        let from = ADC_BASE + CONVERTER_BYTES * number as u32 + adc::DR;
        let stream = self.dma2.serving(from, &ADC_STREAMS[number]);
        for _ in 0..ended {
            let counts = level.convert(settled_share);
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

    pub(super) fn read_adc(&mut self, offset: u32, now: u64) -> Answer<u32> {
        if offset == adc::CCR {
            return Ok(self.adc_common);
        }
        let number = (offset / CONVERTER_BYTES) as usize;
        if number >= CONVERTERS {
            return Err(Lack::Register);
        }
        // Results that DMA collects are transferred once per control period, when the signals change.
        if !self.adc[number].collected() {
            self.deliver(number, now);
        }
        self.adc[number].read(offset % CONVERTER_BYTES)
    }

    pub(super) fn write_adc(&mut self, offset: u32, value: u32, now: u64) -> Answer {
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

    fn adc_divider(&self) -> u32 {
        let prescaler = 2 * ((self.adc_common >> 16 & 0b11) + 1);
        prescaler * self.clocks.apb2_divider
    }

    pub(super) fn trigger(&mut self, at: u64) {
        if self.tim8.triggers_by_update() {
            let divider = self.adc_divider();
            for adc in &mut self.adc {
                adc.trigger(at, divider);
            }
        }
    }
}

/// Index of the signal at a converter channel. `None` if its pin is not an analog pin in use.
fn connected(levels: &[(Pin, Level)], gpio: &[Gpio], channel: usize) -> Option<usize> {
    let pin = match channel {
        0..8 => Pin(PORT_A, channel),
        8..10 => Pin(PORT_B, channel - 8),
        10..16 => Pin(PORT_C, channel - 10),
        _ => return None,
    };
    levels
        .iter()
        .position(|(known, _)| *known == pin && gpio[pin.0].mode(pin.1) == Mode::Analog)
}
