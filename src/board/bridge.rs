//! The H-bridge on TIM8: two outputs of opposite polarity, so that half duty is no voltage. Its update is the
//! beginning of a control period.

use haptic_paddle::controller::Duty;
use stm32f4xx_hal::pac::{EXTI, TIM8};
use stm32f4xx_hal::rcc::{Enable, Rcc};

use super::events;
use super::pins;

/// Clock of TIM8: twice that of its bus.
pub const TIMER_HZ: u32 = 2 * super::PCLK2_HZ;
/// Up to here and down again makes one PWM period, of 40 kHz.
const TOP: u16 = 2100;
/// Every fourth turning point, that is every second PWM period, updates.
const REPETITIONS: u8 = 3;
/// Timer clocks of one control period.
pub const CLOCKS_PER_PERIOD: u32 = TOP as u32 * (REPETITIONS as u32 + 1);

/// For how long nFAULT must stay low to count, us. Drivers hold theirs for milliseconds.
const GLITCH_US: u32 = 2;

/// The bridge; the control loop owns it.
pub struct Bridge {
    timer: TIM8,
}

impl Bridge {
    /// A bridge that is off, at no voltage, with its timer set up and standing still.
    pub fn new(timer: TIM8, rcc: &mut Rcc) -> Self {
        TIM8::enable(rcc);
        timer.psc().write(|w| w.psc().set(0));
        timer.arr().write(|w| w.arr().set(TOP));
        timer.rcr().write(|w| w.rep().set(REPETITIONS));
        timer.ccmr1_output().write(|w| {
            w.oc1m().pwm_mode1();
            w.oc1pe().enabled();
            // The opposite of channel 1 by its mode and not by its polarity: an output that is broken off passes
            // through the level that its polarity calls inactive, which is to be the low one.
            w.oc2m().pwm_mode2();
            w.oc2pe().enabled()
        });
        timer.ccer().write(|w| {
            w.cc1e().set_bit();
            w.cc2e().set_bit()
        });
        timer.cr2().write(|w| w.mms().update());
        timer.cr1().write(|w| {
            w.cms().center_aligned1();
            w.arpe().set_bit()
        });
        let bridge = Self { timer };
        bridge.release();
        bridge.timer.egr().write(|w| w.ug().set_bit());
        // Broken off by the clock security system or held by a debugger, the outputs are low, which brakes (OSSI, with
        // idle states that are low after a reset). No pin is the break input, which then reads low: it breaks when high.
        // Outputs on by hand only: automatic enable would undo a stop by itself.
        bridge.timer.bdtr().write(|w| {
            w.ossi().idle_level();
            w.bke().enabled();
            w.bkp().active_high()
        });
        bridge.timer.bdtr().modify(|_, w| w.moe().set_bit());
        bridge
    }

    /// Lets the timer run: from now on there are control periods.
    pub fn start(&self) {
        self.begin_period();
        self.timer.cr1().modify(|_, w| w.cen().set_bit());
    }

    /// Lets every period interrupt.
    pub fn start_interrupt(&self) {
        self.begin_period();
        self.timer.dier().write(|w| w.uie().set_bit());
    }

    /// Waits for the next period without the interrupt.
    pub fn wait_for_period(&self) {
        while !self.period_is_over() {}
        self.begin_period();
    }

    /// Takes notice of the period that began.
    #[inline]
    pub fn begin_period(&self) {
        // A zero clears the flag, the ones beside it change nothing.
        self.timer.sr().write(|w| w.uif().clear_bit());
    }

    /// Whether the next period has begun.
    #[inline]
    pub fn period_is_over(&self) -> bool {
        self.timer.sr().read().uif().bit()
    }

    /// Voltage on the motor, from the next update on.
    #[inline]
    pub fn drive(&self, duty: Duty) {
        self.set(duty);
        super::bridge_on();
        // An interrupt may have turned the bridge off in the middle of this.
        if events::pending() != 0 {
            super::bridge_off();
        }
    }

    /// Bridge off.
    #[inline]
    pub fn release(&self) {
        super::bridge_off();
        self.set(Duty::ZERO);
    }

    #[inline]
    fn set(&self, duty: Duty) {
        let compare = duty.compare(TOP);
        self.timer.ccr1().write(|w| w.ccr().set(compare));
        self.timer.ccr2().write(|w| w.ccr().set(compare));
    }
}

/// Waits for the beginning of a control period, while the control interrupt is masked, so that it then begins in time.
#[expect(
    unsafe_code,
    reason = "the control interrupt, which owns the timer, is masked"
)]
pub fn wait_for_next_period() {
    // SAFETY: of the timer only the flag is used, which a zero clears and the ones beside it change nothing.
    let timer = unsafe { TIM8::steal() };
    timer.sr().write(|w| w.uif().clear_bit());
    while !timer.sr().read().uif().bit() {}
}

/// The line by which the bridge reports a fault; the interrupt on its fall owns it.
pub struct FaultLine {
    exti: EXTI,
    line: u8,
}

impl FaultLine {
    /// The interrupt line of this number, already set up.
    pub fn new(exti: EXTI, line: u8) -> Self {
        Self { exti, line }
    }

    /// Takes notice of a fall, and tells the control loop whether it was more than a glitch.
    pub fn trip(&self) {
        self.exti.pr().write(|w| w.pr(self.line).clear());
        // The write is posted: read back, it has taken effect before the return, and the interrupt does not come again.
        let _ = self.exti.pr().read();
        super::clocks::wait_us(GLITCH_US);
        events::raise(if pins::bridge_reports_fault() {
            events::BRIDGE
        } else {
            events::GLITCH
        });
    }
}
