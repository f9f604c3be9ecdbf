//! The device as the console accesses it: controller and telemetry behind their locks, the stored settings, and the
//! watchdog.

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

/// Nominal watchdog time, ms. The watchdog oscillator has 17 to 47 kHz instead of the nominal 32 (data sheet), so the true
/// time is 14 to 38 ms.
pub const WATCHDOG_MS: u32 = 20;
/// Nominal watchdog time while the flash is written, ms. At most two sectors are erased, each in at most 0.5 s (data sheet,
/// 16 KiB by 32 bits). The true time is at least 2.7 s.
const STORE_WATCHDOG_MS: u32 = 4000;

/// Duration of the last control interrupt, s, as bits of an `f32`.
static LAST_S: AtomicU32 = AtomicU32::new(0);
/// Longest duration since the last query, s, as bits of an `f32`.
static WORST_S: AtomicU32 = AtomicU32::new(0);

/// Records the duration of the control interrupt that has just ended.
pub fn note_timing() {
    let bits = board::since_control_began_s().to_bits();
    LAST_S.store(bits, Ordering::Relaxed);
    // The bits of non-negative floats have the same order as the numbers.
    WORST_S.fetch_max(bits, Ordering::Relaxed);
}

/// The store of the settings in flash.
pub type SettingsStore = Store<SettingsFlash>;

/// The device, as code of the lowest priority accesses it.
pub struct Device<'a, C, T> {
    pub controller: C,
    pub telemetry: T,
    pub store: &'a mut SettingsStore,
    pub watchdog: &'a mut IndependentWatchdog,
}

impl<C: Mutex<T = Controller>, T: Mutex<T = Telemetry>> console::Device for Device<'_, C, T> {
    /// Runs `work` directly after a control period. It then ends long before the next one. The lock masks the control
    /// interrupt, and this way it never delays it.
    fn with<R>(&mut self, work: impl FnOnce(&mut Controller) -> R) -> R {
        let now = ticks();
        // If the period ends just before the sleep, the loop waits for the next one.
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
        // There may be new data to send.
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

    /// Holds the lock of the controller, so that nothing can arm meanwhile.
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
