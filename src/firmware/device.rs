//! What the console reaches of the device: controller and telemetry behind their locks, the stored settings, and the
//! watchdog that all must keep in mind.

use core::sync::atomic::{AtomicU32, Ordering};

use cortex_m::peripheral::SCB;
use haptic_paddle::console::{self, Timing};
use haptic_paddle::controller::{Controller, Mode};
use haptic_paddle::settings::{Recalled, Settings, Store, StoreError};
use haptic_paddle::telemetry::Telemetry;
use rtic::Mutex;
use stm32f4xx_hal::pac::Interrupt;
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::watchdog::IndependentWatchdog;

use super::ticks;
use crate::board::{self, SettingsFlash, events};

/// Nominal time to reset without a sign of life, ms. The oscillator behind it may have 17 to 47 kHz instead of
/// 32 (data sheet), so that the true time is 14 to 38 ms.
pub const WATCHDOG_MS: u32 = 20;
/// The same while the flash is written: two sectors are erased at most, in 0.5 s each at most (data sheet, 16 KiB by 32
/// bits), and the true time is 2.7 s at least.
const STORE_WATCHDOG_MS: u32 = 4000;

/// What the control interrupt took last, and at worst since somebody asked, as bits of seconds.
static LAST_S: AtomicU32 = AtomicU32::new(0);
static WORST_S: AtomicU32 = AtomicU32::new(0);

/// Takes notice of what the control interrupt has just taken.
pub fn note_timing() {
    let bits = board::since_control_began_s().to_bits();
    LAST_S.store(bits, Ordering::Relaxed);
    // Numbers that are not negative compare as their bits do.
    WORST_S.fetch_max(bits, Ordering::Relaxed);
}

/// The settings' place in flash.
pub type SettingsStore = Store<SettingsFlash>;

/// The device, as the lowest priority sees it.
pub struct Device<'a, C, T> {
    pub controller: C,
    pub telemetry: T,
    pub store: &'a mut SettingsStore,
    pub watchdog: &'a mut IndependentWatchdog,
}

impl<C: Mutex<T = Controller>, T: Mutex<T = Telemetry>> console::Device for Device<'_, C, T> {
    /// Lends the controller out right after a control period, so that the work is over long before the next one and the
    /// lock, which masks the control interrupt, never delays it.
    fn with<R>(&mut self, work: impl FnOnce(&mut Controller) -> R) -> R {
        let now = ticks();
        // Should the period end just before the sleep, the next one is taken.
        while ticks() == now {
            cortex_m::asm::wfi();
        }
        self.controller.lock(work)
    }

    fn telemetry<R>(&mut self, work: impl FnOnce(&mut Telemetry) -> R) -> Option<R> {
        let answer = self.telemetry.lock(|telemetry| {
            telemetry.baud = board::serial::baud();
            work(telemetry)
        });
        // There may be something to send now.
        rtic::pend(Interrupt::DMA1_STREAM6);
        Some(answer)
    }

    fn timing(&mut self) -> Option<Timing> {
        let seconds = |time: &AtomicU32| f32::from_bits(time.load(Ordering::Relaxed));
        let timing = Timing {
            last_s: seconds(&LAST_S),
            worst_s: seconds(&WORST_S),
            period_s: 1.0 / board::CONTROL_HZ as f32,
        };
        WORST_S.store(0, Ordering::Relaxed);
        Some(timing)
    }

    fn reboot(&mut self) {
        board::bridge_off();
        SCB::sys_reset();
    }

    /// With the controller's lock taken, so that nobody can arm.
    fn save(&mut self, settings: &Settings) -> Result<(), StoreError> {
        let store = &mut *self.store;
        self.watchdog.start(STORE_WATCHDOG_MS.millis());
        let saved = self.controller.lock(|controller| {
            if controller.mode() != Mode::Off {
                return Err(StoreError::Armed);
            }
            if board::supply_is_low() {
                return Err(StoreError::Supply);
            }
            let saved = store.save(settings);
            events::raise(events::FLASH);
            board::wait_for_next_period();
            saved
        });
        self.watchdog.start(WATCHDOG_MS.millis());
        saved
    }

    fn load(&mut self) -> Result<Recalled, StoreError> {
        self.watchdog.feed();
        self.store.load()
    }
}
