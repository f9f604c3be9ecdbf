//! Measurement of the motor current and of the Hall voltage.
//!
//! The current amplifier is noisy around 120 kHz. TIM3 starts a conversion every 2 us, 25 in a control period. DMA stores
//! them in a ring that holds exactly the samples of the last period and is aligned with it. The mean of these samples has a
//! zero at every multiple of the control rate, including 120 kHz. The Hall signal is converted continuously.
//!
//! The sampling times follow from the formula of the data sheet. It gives the largest source resistance at which a sample is
//! accurate to a quarter of a count: R = (k - 0.5) / (f C ln 2^14) - R_ADC, with f = 21 MHz and at most C = 7 pF and R_ADC =
//! 6 kohm. The 28 cycles for the current allow 13 kohm. The 56 cycles for the Hall signal allow 33 kohm. 3 cycles would
//! allow none, and 15 would allow 4 kohm. With a source of 5 kohm the settling error of the current is 1e-7. With 20 kohm
//! that of the Hall signal is 1e-6.

use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use stm32f4xx_hal::pac::adc1::RegisterBlock;
use stm32f4xx_hal::pac::adc1::cr2::EXTSEL;
use stm32f4xx_hal::pac::adc1::smpr1::SMP10;
use stm32f4xx_hal::pac::{ADC_COMMON, ADC1, ADC3, DMA2, TIM3};
use stm32f4xx_hal::rcc::{Enable, Rcc};

use super::pins::{CURRENT_CHANNEL, HALL_CHANNEL};

/// Samples of the current per control period. They are 42 converter clocks apart. A conversion takes 28 clocks for sampling
/// and 12 for the bits.
const SAMPLES: usize = 25;
/// Clocks of TIM3 between two samples.
const PACE: u16 = (super::PCLK2_HZ / super::CONTROL_HZ / SAMPLES as u32) as u16;
/// Initial count of TIM3. It is so close to the end of the first timer period that the first sample begins with the control
/// period. The last sample then arrives before the end of the control period.
const HEAD_START: u16 = PACE - 2;
/// Control periods from the start of the timer until a current is available. The ring is full at the end of the first.
pub const PERIODS_TO_MEASURE: u32 = 2;
/// Index of the sample at the turning point of the PWM in the middle of the period.
const CENTRE: usize = SAMPLES / 2;

/// The samples, two of 16 bit per word, with one half word unused. Only the DMA writes them.
static RING: [AtomicU32; SAMPLES.div_ceil(2)] = [const { AtomicU32::new(0) }; SAMPLES.div_ceil(2)];

/// Stream of DMA2 that serves ADC3.
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
    /// Turns the converters on. The current conversions begin with [`Self::start`].
    pub fn new(
        hall: ADC1,
        current: ADC3,
        common: &ADC_COMMON,
        dma: DMA2,
        pace: TIM3,
        rcc: &mut Rcc,
    ) -> Self {
        /// Stabilisation time of a converter after it is turned on (data sheet: 3 us).
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
        // The latest sample is at most 4 us old.
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

    /// Starts the triggers of the current conversions. It must be called directly before the timer of the control periods is
    /// started.
    pub fn start(&self) {
        self.pace.cr1().write(|w| w.cen().enabled());
    }

    /// Stops the ring. After an overrun the converter sends no DMA requests until the flag is cleared and both are set up
    /// again (RM0090, section 13.8.1).
    pub fn stop(&self) {
        /// Polls of the stream, which are enough for a running transfer to end.
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

    /// Restarts a stopped ring at its beginning, with the next sample.
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

    /// Current in counts: the mean over the last control period, or the sample at the centre of the PWM.
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

/// Returns true if samples of the current were lost, so that the ring has stopped.
#[expect(
    unsafe_code,
    reason = "whoever owns the converter, its flag may be read"
)]
pub fn overrun() -> bool {
    // SAFETY: the flag is only read.
    let current = unsafe { ADC3::steal() };
    current.sr().read().ovr().bit()
}

/// If true, the current is the sample at the centre of the PWM instead of the mean of the period.
static SINGLE_SAMPLE: AtomicBool = AtomicBool::new(false);

/// Selects the source of the current: the sample at the centre of the PWM if `once`, otherwise the mean of the period.
pub fn sample_current_once(once: bool) {
    SINGLE_SAMPLE.store(once, Ordering::Relaxed);
}

/// Each half word can sum up to 16 samples of 12 bit without overflow.
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

/// Selects one channel and its sampling time.
#[expect(unsafe_code, reason = "the register takes any number")]
fn choose(converter: &RegisterBlock, channel: u8, sampling: SMP10) {
    /// The first channel that uses the other sampling time register.
    const FIRST_OF_SMPR1: u8 = 10;
    match channel.checked_sub(FIRST_OF_SMPR1) {
        Some(index) => converter.smpr1().write(|w| w.smp(index).variant(sampling)),
        None => converter
            .smpr2()
            .write(|w| w.smp(channel).variant(sampling)),
    };
    // SAFETY: every channel number is valid. An unconnected channel reads as noise.
    converter.sqr3().write(|w| unsafe { w.sq(0).bits(channel) });
}

/// Sets up a circular DMA transfer of every conversion into the ring.
#[expect(unsafe_code, reason = "the DMA is given addresses")]
fn fill_ring(dma: &DMA2, from: &ADC3) {
    let stream = dma.st(STREAM);
    stream
        .par()
        // SAFETY: the DMA only reads the data register of this converter.
        .write(|w| unsafe { w.pa().bits(from.dr().as_ptr() as u32) });
    // SAFETY: the DMA only writes this static of atomics. Its length is the count of the transfer.
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
