//! What the console reaches of the device: controller and telemetry behind their locks, the stored settings, and the
//! watchdog that all must keep in mind.

use haptic_paddle::console;
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
