//! Current and Hall voltage. Both converters run without pause, started by the same update of TIM8, so that no
//! conversion is ever waited for.
//!
//! The current amplifier is noisy around 120 kHz. Samples come 15 converter clocks apart and a control period has
//! 1050: DMA keeps a ring of exactly the 70 samples of the last period, in step with it for ever, and their mean has
//! a zero at every multiple of the control rate, 120 kHz among them.

use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use stm32f4xx_hal::pac::adc1::RegisterBlock;
use stm32f4xx_hal::pac::adc1::smpr1::SMP10;
use stm32f4xx_hal::pac::{ADC_COMMON, ADC1, ADC3, DMA2};
use stm32f4xx_hal::rcc::{Enable, Rcc};

use super::pins::{CURRENT_CHANNEL, HALL_CHANNEL};

/// Divides the converters' bus clock; 21 MHz.
const PRESCALER: u32 = 4;
/// Converter clocks from the beginning of one sample of the current to that of the next: 3 for sampling, which is
/// enough because the sampler still holds the last value of the same channel, and 12 for the bits.
const SAMPLE_CLOCKS: u32 = 3 + 12;
/// Samples of the current in one control period.
const SAMPLES: usize = (super::bridge::CLOCKS_PER_PERIOD
    / (super::bridge::TIMER_HZ / super::PCLK2_HZ * PRESCALER)
    / SAMPLE_CLOCKS) as usize;
/// Control periods from the timer's start until there is a current: the first update starts the converters, the second
/// finds the ring full.
pub const PERIODS_TO_MEASURE: u32 = 2;
/// The sample that is taken at the turning point of the PWM in the middle of the period.
const CENTRE: usize = SAMPLES / 2;

/// The samples, two of 16 bit in a word; the DMA writes them, nobody else does.
static RING: [AtomicU32; SAMPLES / 2] = [const { AtomicU32::new(0) }; SAMPLES / 2];

/// Stream of DMA2, and its request channel, that serve ADC3.
const STREAM: usize = 1;
const REQUEST: u8 = 2;

/// Both converters.
pub struct Converters {
    hall: ADC1,
    current: ADC3,
}

impl Converters {
    /// Converters that begin with the next update of TIM8.
    pub fn new(hall: ADC1, current: ADC3, common: &ADC_COMMON, dma: &DMA2, rcc: &mut Rcc) -> Self {
        /// Time that a converter needs after it is switched on (data sheet: 3 us).
        const SETTLING_CLOCKS: u32 = super::SYSCLK_HZ / 1_000_000 * 3;

        ADC1::enable(rcc);
        ADC3::enable(rcc);
        DMA2::enable(rcc);
        common.ccr().write(|w| w.adcpre().div4());
        for converter in [&*hall, &*current] {
            converter.cr2().write(|w| w.adon().enabled());
        }
        cortex_m::asm::delay(SETTLING_CLOCKS);
        fill_ring(dma, &current);
        // The Hall sensor's divider needs more time; its latest sample is then at most 4 us old.
        run(&hall, HALL_CHANNEL, SMP10::Cycles28, false);
        run(&current, CURRENT_CHANNEL, SMP10::Cycles3, true);
        Self { hall, current }
    }

    /// Current in counts: mean over the last control period, or the sample at the centre of the PWM. Not a number if
    /// the ring has stopped.
    #[inline(always)]
    pub fn current_counts(&self) -> f32 {
        if self.current.sr().read().ovr().bit() {
            f32::NAN
        } else if SINGLE_SAMPLE.load(Ordering::Relaxed) {
            sample_at_centre()
        } else {
            mean_of_ring()
        }
    }

    /// Hall voltage in counts.
    #[inline]
    pub fn hall_counts(&self) -> u16 {
        self.hall.dr().read().data().bits()
    }
}

/// Whether the current is the sample at the centre of the PWM instead of the mean of the period.
static SINGLE_SAMPLE: AtomicBool = AtomicBool::new(false);

/// Takes the current from the sample at the centre of the PWM, or from the mean of the period.
pub fn sample_current_once(once: bool) {
    SINGLE_SAMPLE.store(once, Ordering::Relaxed);
}

#[inline]
fn mean_of_ring() -> f32 {
    /// As many samples of 12 bit as 16 bit can sum.
    const SUMMED_AT_ONCE: usize = 16;
    let sum: u32 = RING
        .chunks(SUMMED_AT_ONCE)
        .map(|words| {
            let both: u32 = words.iter().map(|word| word.load(Ordering::Relaxed)).sum();
            (both & 0xFFFF) + (both >> 16)
        })
        .sum();
    sum as f32 * (1.0 / SAMPLES as f32)
}

#[inline]
fn sample_at_centre() -> f32 {
    const WORD: usize = CENTRE / 2;
    const SHIFT: usize = CENTRE % 2 * 16;
    let word = RING[WORD].load(Ordering::Relaxed);
    ((word >> SHIFT) & 0xFFFF) as f32
}

/// Lets DMA carry every conversion into the ring, round and round.
#[expect(unsafe_code, reason = "the DMA is given addresses")]
fn fill_ring(dma: &DMA2, from: &ADC3) {
    let stream = dma.st(STREAM);
    stream
        .par()
        // SAFETY: the DMA reads this converter's data register only.
        .write(|w| unsafe { w.pa().bits(from.dr().as_ptr() as u32) });
    // SAFETY: the DMA writes this static of atomics only, which is as long as its count says.
    stream
        .m0ar()
        .write(|w| unsafe { w.m0a().bits(RING.as_ptr() as u32) });
    stream.ndtr().write(|w| w.ndt().set(SAMPLES as u16));
    stream.cr().write(|w| {
        w.chsel().set(REQUEST);
        w.pl().very_high();
        w.msize().bits16();
        w.psize().bits16();
        w.minc().incremented();
        w.circ().enabled();
        w.dir().peripheral_to_memory();
        w.en().enabled()
    });
}

/// Converts one channel over and over from the next update of TIM8 on.
#[expect(unsafe_code, reason = "the register takes any number")]
fn run(converter: &RegisterBlock, channel: u8, sampling: SMP10, dma: bool) {
    /// Channels from this one on have the other sampling register.
    const FIRST_OF_SMPR1: u8 = 10;
    match channel.checked_sub(FIRST_OF_SMPR1) {
        Some(index) => converter.smpr1().write(|w| w.smp(index).variant(sampling)),
        None => converter
            .smpr2()
            .write(|w| w.smp(channel).variant(sampling)),
    };
    // SAFETY: any channel may be converted; one that is not there reads as noise.
    converter.sqr3().write(|w| unsafe { w.sq(0).bits(channel) });
    converter.cr2().write(|w| {
        w.adon().enabled();
        w.cont().continuous();
        w.dma().bit(dma);
        w.dds().bit(dma);
        w.extsel().tim8trgo();
        w.exten().rising_edge()
    });
}
