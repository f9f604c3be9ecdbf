//! Current and Hall voltage.
//!
//! The current amplifier is noisy around 120 kHz. TIM3 starts a conversion every 2 us, 25 in a control period, and DMA
//! keeps a ring of exactly the samples of the last period, in step with it: their mean has a zero at every multiple of
//! the control rate, 120 kHz among them. The Hall signal is converted without pause.
//!
//! Sampling times, by the data sheet's formula for the source behind which a sample is good to a quarter of a count,
//! R = (k - 0.5) / (f C ln 2^14) - R_ADC, with f = 21 MHz, C = 7 pF and R_ADC = 6 kohm, both at most: 28 cycles for the
//! current allow 13 kohm, 56 for the Hall signal 33 kohm. 3 cycles allow none, 15 allow 4 kohm. Behind 5 kohm the
//! sampler comes within 1e-7 of the current's signal, behind 20 kohm within 1e-6 of the Hall signal's.

use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use stm32f4xx_hal::pac::adc1::RegisterBlock;
use stm32f4xx_hal::pac::adc1::cr2::EXTSEL;
use stm32f4xx_hal::pac::adc1::smpr1::SMP10;
use stm32f4xx_hal::pac::{ADC_COMMON, ADC1, ADC3, DMA2, TIM3};
use stm32f4xx_hal::rcc::{Enable, Rcc};

use super::pins::{CURRENT_CHANNEL, HALL_CHANNEL};

/// Samples of the current in one control period: 42 clocks of the converter apart, of which a conversion takes 28 for
/// sampling and 12 for the bits.
const SAMPLES: usize = 25;
/// Clocks of TIM3 from one sample to the next.
const PACE: u16 = (super::PCLK2_HZ / super::CONTROL_HZ / SAMPLES as u32) as u16;
/// TIM3 begins so near the end of its first round that the first sample begins with the period; the last one has then
/// arrived before its end.
const HEAD_START: u16 = PACE - 2;
/// Control periods from the timer's start until there is a current: at the end of the first the ring is full.
pub const PERIODS_TO_MEASURE: u32 = 2;
/// The sample that is taken at the turning point of the PWM in the middle of the period.
const CENTRE: usize = SAMPLES / 2;

/// The samples, two of 16 bit in a word, and one of none; the DMA writes them, nobody else does.
static RING: [AtomicU32; SAMPLES.div_ceil(2)] = [const { AtomicU32::new(0) }; SAMPLES.div_ceil(2)];

/// Stream of DMA2, and its request channel, that serve ADC3.
const STREAM: usize = 1;
const REQUEST: u8 = 2;

/// Both converters.
pub struct Converters {
    hall: ADC1,
    current: ADC3,
    dma: DMA2,
    pace: TIM3,
}

impl Converters {
    /// Converters that are on; the current's waits for [`Self::start`].
    pub fn new(
        hall: ADC1,
        current: ADC3,
        common: &ADC_COMMON,
        dma: DMA2,
        pace: TIM3,
        rcc: &mut Rcc,
    ) -> Self {
        /// Time that a converter needs after it is switched on (data sheet: 3 us).
        const SETTLING_CLOCKS: u32 = super::SYSCLK_HZ / 1_000_000 * 3;

        ADC1::enable(rcc);
        ADC3::enable(rcc);
        DMA2::enable(rcc);
        TIM3::enable(rcc);
        common.ccr().write(|w| w.adcpre().div4());
        for converter in [&*hall, &*current] {
            converter.cr2().write(|w| w.adon().enabled());
        }
        cortex_m::asm::delay(SETTLING_CLOCKS);
        choose(&hall, HALL_CHANNEL, SMP10::Cycles56);
        // Its latest sample is at most 4 us old.
        hall.cr2().write(|w| {
            w.adon().enabled();
            w.cont().continuous();
            w.swstart().set_bit()
        });
        choose(&current, CURRENT_CHANNEL, SMP10::Cycles28);
        pace.arr().write(|w| w.arr().set(PACE - 1));
        pace.cnt().write(|w| w.cnt().set(HEAD_START));
        pace.cr2().write(|w| w.mms().update());
        let converters = Self {
            hall,
            current,
            dma,
            pace,
        };
        converters.go_on();
        converters
    }

    /// Starts the pace; to be called right before the timer of the control periods starts.
    pub fn start(&self) {
        self.pace.cr1().write(|w| w.cen().enabled());
    }

    /// Stops the ring. After an overrun the converter asks DMA for nothing until the flag is cleared and both are set up
    /// anew (RM0090, section 13.8.1).
    pub fn stop(&self) {
        /// A transfer that is under way ends within some clocks of the bus.
        const LONGEST_WAIT: u32 = 100;
        self.current.cr2().write(|w| {
            w.adon().enabled();
            w.extsel().variant(EXTSEL::Tim3trgo);
            w.exten().rising_edge()
        });
        let stream = self.dma.st(STREAM);
        stream.cr().write(|w| w.en().disabled());
        for _ in 0..LONGEST_WAIT {
            if stream.cr().read().en().is_disabled() {
                break;
            }
        }
        self.dma.lifcr().write(|w| {
            w.cdmeif1().set_bit();
            w.cfeif1().set_bit();
            w.chtif1().set_bit();
            w.ctcif1().set_bit();
            w.cteif1().set_bit()
        });
        self.current.sr().write(|w| w.ovr().clear_bit());
    }

    /// Fills a ring that stands still from its beginning, with the next sample.
    pub fn go_on(&self) {
        fill_ring(&self.dma, &self.current);
        self.current.cr2().write(|w| {
            w.adon().enabled();
            w.dma().enabled();
            w.dds().continuous();
            w.extsel().variant(EXTSEL::Tim3trgo);
            w.exten().rising_edge()
        });
    }

    /// Current in counts: mean over the last control period, or the sample at the centre of the PWM.
    #[inline(always)]
    pub fn current_counts(&self) -> f32 {
        if SINGLE_SAMPLE.load(Ordering::Relaxed) {
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

/// Whether samples of the current were lost, and the ring stands still.
#[expect(
    unsafe_code,
    reason = "whoever owns the converter, its flag may be read"
)]
pub fn overrun() -> bool {
    // SAFETY: a flag is only read.
    let current = unsafe { ADC3::steal() };
    current.sr().read().ovr().bit()
}

/// Whether the current is the sample at the centre of the PWM instead of the mean of the period.
static SINGLE_SAMPLE: AtomicBool = AtomicBool::new(false);

/// Takes the current from the sample at the centre of the PWM, or from the mean of the period.
pub fn sample_current_once(once: bool) {
    SINGLE_SAMPLE.store(once, Ordering::Relaxed);
}

/// As many samples of 12 bit as 16 bit can sum are in each half of the words.
const _: () = assert!(SAMPLES.div_ceil(2) <= 16);

#[inline]
fn mean_of_ring() -> f32 {
    let both: u32 = RING.iter().map(|word| word.load(Ordering::Relaxed)).sum();
    let sum = (both & 0xFFFF) + (both >> 16);
    sum as f32 * (1.0 / SAMPLES as f32)
}

#[inline]
fn sample_at_centre() -> f32 {
    const WORD: usize = CENTRE / 2;
    const SHIFT: usize = CENTRE % 2 * 16;
    let word = RING[WORD].load(Ordering::Relaxed);
    ((word >> SHIFT) & 0xFFFF) as f32
}

/// One channel, sampled for so long.
#[expect(unsafe_code, reason = "the register takes any number")]
fn choose(converter: &RegisterBlock, channel: u8, sampling: SMP10) {
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
