//! The H-bridge, driven by TIM8. Its two inputs have opposite polarity, so that 50 % duty gives zero voltage. Each update of
//! the timer starts a control period.

use haptic_paddle::controller::Duty;
use stm32f4xx_hal::pac::{EXTI, TIM8};
use stm32f4xx_hal::rcc::{Enable, Rcc};

use super::events;
use super::pins;

/// Clock of TIM8, Hz: twice the clock of its bus.
pub const TIMER_HZ: u32 = 2 * super::PCLK2_HZ;
/// Top of the up-down counter. It gives a PWM frequency of 40 kHz.
const TOP: u16 = 2100;
/// Repetition counter: every fourth turning point, that is every second PWM period, is an update.
const REPETITIONS: u8 = 3;
/// Timer clocks of one control period.
pub const CLOCKS_PER_PERIOD: u32 = TOP as u32 * (REPETITIONS as u32 + 1);

/// Shortest low time of nFAULT that counts as a fault, us. Bridge drivers hold nFAULT low for milliseconds.
const GLITCH_US: u32 = 2;

/// The bridge. The control loop owns it.
pub struct Bridge {
    timer: TIM8,
}

impl Bridge {
    /// Sets up the timer, stopped and at zero voltage, with the bridge off.
    pub fn new(timer: TIM8, rcc: &mut Rcc) -> Self {
        TIM8::enable(rcc);
        timer.psc().write(|w| w.psc().set(0));
        timer.arr().write(|w| w.arr().set(TOP));
        timer.rcr().write(|w| w.rep().set(REPETITIONS));
        timer.ccmr1_output().write(|w| {
            w.oc1m().pwm_mode1();
            w.oc1pe().enabled();
            // Channel 2 is inverted by its mode and not by its polarity. When a break turns an output off, it passes through
            // the inactive level of its polarity. That level must be low.
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
        // After a break by the clock security system or a halt by a debugger, the outputs are low, which brakes the motor
        // (OSSI, with idle states that are low after a reset). No pin is assigned to the break input. It then reads low, so
        // its active level is high. Automatic output enable stays off, because it would undo a stop.
        bridge.timer.bdtr().write(|w| {
            w.ossi().idle_level();
            w.bke().enabled();
            w.bkp().active_high()
        });
        bridge.timer.bdtr().modify(|_, w| w.moe().set_bit());
        bridge
    }

    /// Starts the timer and with it the control periods.
    pub fn start(&self) {
        self.begin_period();
        self.timer.cr1().modify(|_, w| w.cen().set_bit());
    }

    /// Enables the interrupt at each control period.
    pub fn start_interrupt(&self) {
        self.begin_period();
        self.timer.dier().write(|w| w.uie().set_bit());
    }

    /// Waits for the next control period without the interrupt.
    pub fn wait_for_period(&self) {
        while !self.period_is_over() {}
        self.begin_period();
    }

    /// Acknowledges the start of a control period.
    #[inline]
    pub fn begin_period(&self) {
        // Writing zero clears the flag. Writing ones to the other flags has no effect.
        self.timer.sr().write(|w| w.uif().clear_bit());
    }

    /// Returns true if the next control period has begun.
    #[inline]
    pub fn period_is_over(&self) -> bool {
        self.timer.sr().read().uif().bit()
    }

    /// Sets the duty. It acts from the next update.
    #[inline]
    pub fn drive(&self, duty: Duty) {
        self.set(duty);
        super::bridge_on();
        // An interrupt may have turned the bridge off in the meantime.
        if events::pending() != 0 {
            super::bridge_off();
        }
    }

    /// Turns the bridge off.
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

/// Waits for the next control period. The control interrupt is masked meanwhile, so it then starts without delay.
#[expect(
    unsafe_code,
    reason = "the control interrupt, which owns the timer, is masked"
)]
pub fn wait_for_next_period() {
    // SAFETY: only the flag of the timer is used. Writing zero clears it, and writing ones to the other flags has no effect.
    let timer = unsafe { TIM8::steal() };
    timer.sr().write(|w| w.uif().clear_bit());
    while !timer.sr().read().uif().bit() {}
}

/// The fault line nFAULT of the bridge. The interrupt on its falling edge owns it.
pub struct FaultLine {
    exti: EXTI,
    line: u8,
}

impl FaultLine {
    /// Takes over the external interrupt line with this number, which is already set up.
    pub fn new(exti: EXTI, line: u8) -> Self {
        Self { exti, line }
    }

    /// Acknowledges a falling edge and reports it to the control loop as a fault or as a glitch.
    pub fn trip(&self) {
        self.exti.pr().write(|w| w.pr(self.line).clear());
        // The write is buffered. Reading it back ensures that it takes effect before the return. Otherwise the interrupt
        // would occur again.
        let _ = self.exti.pr().read();
        super::clocks::wait_us(GLITCH_US);
        events::raise(if pins::bridge_reports_fault() {
            events::BRIDGE
        } else {
            events::GLITCH
        });
    }
}
