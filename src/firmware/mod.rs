//! The RTIC app: tasks, shared resources and start-up.

mod device;
mod last_words;
mod terminal;
mod transmit;

use core::sync::atomic::{AtomicU32, Ordering};

// The logger registers itself.
use defmt_rtt as _;

/// Number of control periods since boot. It wraps.
static TICKS: AtomicU32 = AtomicU32::new(0);

fn ticks() -> u32 {
    TICKS.load(Ordering::Relaxed)
}

/// New baud rate of the serial line, bit/s, set after all pending text has been sent. 0 for no change.
static BAUD_WANTED: AtomicU32 = AtomicU32::new(0);

#[rtic::app(device = stm32f4xx_hal::pac)]
mod app {
    use core::sync::atomic::Ordering;

    use haptic_paddle::console::{Session, Terminal};
    use haptic_paddle::controller::{ArmError, Controller, Mode, StopCause, TickRate};
    use haptic_paddle::safety::{Acted, Fault};
    use haptic_paddle::sensing::current::IdleReading;
    use haptic_paddle::settings::{CurrentSampling, Settings};
    use haptic_paddle::telemetry::{Row, ShortSample, Telemetry};
    use heapless::spsc::{Producer, Queue};
    use stm32f4xx_hal::pac::Interrupt;
    use stm32f4xx_hal::prelude::*;
    use stm32f4xx_hal::watchdog::IndependentWatchdog;

    use super::device::{Device, SettingsStore, WATCHDOG_MS, note_timing};
    use super::terminal::{self, Heard, Input, Output};
    use super::transmit::{self, Sender};
    use super::{BAUD_WANTED, TICKS, last_words, ticks};
    use crate::board::serial::{self, Arrived, Receiver};
    use crate::board::{
        self, Board, Bridge, Button, FaultLine, Oscillator, PeriodClock, Sensors, Supply, events,
    };

    /// Control periods per run of the position loop.
    const POSITION_DIVIDER: u16 = 2;
    /// Control periods over which the offset of the current amplifier is averaged at boot.
    const OFFSET_PERIODS: u32 = 1024;
    /// Control periods before the calibration of the offset, 200 ms, in which the amplifier and its reference settle.
    const WARM_UP_PERIODS: u32 = board::CONTROL_HZ / 5;
    /// Control periods between two calls of the console's supervision of the controller.
    const CONSOLE_PERIODS: u32 = board::CONTROL_HZ / CONSOLE_HZ;
    const CONSOLE_HZ: u32 = 1_000;
    /// Number of samples of a capture: 153.6 ms in 48 KiB.
    const CAPTURE_SAMPLES: usize = 3072;

    #[shared]
    struct Shared {
        controller: Controller,
        telemetry: Telemetry,
    }

    #[local]
    struct Local {
        bridge: Bridge,
        sensors: Sensors,
        fault_line: FaultLine,
        supply: Supply,
        button: Button,
        periods: PeriodClock,
        receiver: Receiver,
        rows: Producer<'static, Row>,
        sender: Sender,
        session: Session,
        input: Input,
        output: Output,
        watchdog: IndependentWatchdog,
        store: SettingsStore,
    }

    #[init(local = [text: Queue<u8, { terminal::OUTPUT_BYTES }> = Queue::new(),
                    row_queue: Queue<Row, { transmit::ROWS }> = Queue::new(),
                    memory: [ShortSample; CAPTURE_SAMPLES] = [ShortSample::NONE; CAPTURE_SAMPLES]])]
    fn init(cx: init::Context) -> (Shared, Local) {
        let Board {
            bridge,
            sensors,
            fault_line,
            receiver,
            transmitter,
            mut watchdog,
            supply,
            button,
            mut periods,
            oscillator,
            settings_flash,
        } = Board::new(cx.device);
        let mut store = SettingsStore::new(settings_flash, board::SETTINGS_SECTORS);
        let (settings, recalled) = match store.load() {
            Ok(recalled) => (recalled.settings, Ok(recalled.left_out)),
            Err(error) => (Settings::default(), Err(error)),
        };
        let rate = TickRate::new(board::CONTROL_HZ as f32, POSITION_DIVIDER);
        let mut controller = Controller::new(&settings, rate);
        let mut idle = IdleReading::default();
        for _ in 0..WARM_UP_PERIODS.max(board::PERIODS_TO_MEASURE) {
            bridge.wait_for_period();
        }
        watchdog.start(WATCHDOG_MS.millis());
        for _ in 0..OFFSET_PERIODS {
            bridge.wait_for_period();
            watchdog.feed();
            idle.add(sensors.current_counts());
        }
        let ready = match oscillator {
            Oscillator::Internal => Err(ArmError::NoCrystal),
            Oscillator::Crystal => controller
                .calibrate_current_offset(&idle)
                .map_err(ArmError::Offset),
        };
        if let Err(error) = &ready {
            defmt::error!("{}", defmt::Display2Format(error));
        }

        let (output, text) = cx.local.text.split();
        let (rows, rows_out) = cx.local.row_queue.split();
        let telemetry =
            Telemetry::new(cx.local.memory, board::CONTROL_HZ as f32, serial::BOOT_BAUD);
        let mut output = Output::new(output);
        let session = Session::new(settings, rate, ready).recalled(recalled);
        let faults = last_words::recall_faults();
        last_words::report(faults.reset, &mut output);
        controller.recall(faults);
        session.greet(&mut output);
        defmt::info!("disarmed, control at {} Hz", board::CONTROL_HZ);
        periods.restart();
        bridge.start_interrupt();
        (
            Shared {
                controller,
                telemetry,
            },
            Local {
                bridge,
                sensors,
                fault_line,
                supply,
                button,
                periods,
                receiver,
                rows,
                sender: Sender::new(transmitter, rows_out, text),
                session,
                input: Input::default(),
                output,
                watchdog,
                store,
            },
        )
    }

    #[task(binds = EXTI15_10, priority = 4, local = [fault_line])]
    fn bridge_fault(cx: bridge_fault::Context) {
        board::bridge_off();
        cx.local.fault_line.trip();
    }

    #[task(binds = EXTI2, priority = 2, local = [button])]
    fn button(cx: button::Context) {
        cx.local.button.take_notice();
    }

    #[task(binds = PVD, priority = 4)]
    fn supply_fell(_: supply_fell::Context) {
        board::bridge_off();
        board::supply_fell();
    }

    #[task(binds = TIM8_UP_TIM13, priority = 3, local = [bridge, sensors, supply, periods, kept: u32 = 0], shared = [controller])]
    fn control(mut cx: control::Context) {
        let bridge = cx.local.bridge;
        let sensors = cx.local.sensors;
        bridge.begin_period();
        let periods = cx.local.periods.periods();
        cx.shared.controller.lock(|controller| {
            let events = events::take();
            if events != 0 || periods != 1 {
                attend(controller, events, periods, cx.local.supply, sensors);
            }
            let duty = controller.step(&sensors.read());
            if controller.mode() == Mode::Off {
                bridge.release();
                let revision = controller.faults().revision();
                if revision != *cx.local.kept {
                    *cx.local.kept = revision;
                    last_words::keep_faults(controller.faults());
                }
            } else {
                bridge.drive(duty);
            }
            if bridge.period_is_over() {
                bridge.release();
                controller.report_fault(Fault::Deadline);
            }
        });
        TICKS.store(ticks().wrapping_add(periods), Ordering::Relaxed);
        rtic::pend(Interrupt::TIM8_CC);
    }

    /// Runs directly after the control interrupt. It takes a telemetry sample and checks the received bytes.
    #[task(binds = TIM8_CC, priority = 2, local = [receiver, rows], shared = [controller, telemetry])]
    fn sample(mut cx: sample::Context) {
        note_timing();
        let arrived = cx.local.receiver.look();
        if arrived.stop || arrived.noisy || arrived.lost {
            take_notice(arrived);
        }
        let sample = cx.shared.controller.lock(|controller| controller.sample());
        let rows = cx.local.rows;
        cx.shared.telemetry.lock(|telemetry| {
            if let Some(row) = telemetry.add(ticks(), &sample) {
                if rows.enqueue(row).is_err() {
                    telemetry.stream.drop_row();
                }
                rtic::pend(Interrupt::DMA1_STREAM6);
            }
        });
    }

    /// Handles received bytes that need more than the console: Ctrl-C, noise and losses.
    #[cold]
    #[inline(never)]
    fn take_notice(arrived: Arrived) {
        if arrived.stop {
            board::bridge_off();
            events::raise(events::STOP);
        }
        if arrived.noisy {
            events::raise(events::NOISE);
        }
        if arrived.lost {
            terminal::cut();
        }
    }

    /// Handles the events from other interrupts, and missed control periods.
    #[cold]
    #[inline(never)]
    fn attend(
        controller: &mut Controller,
        events: u32,
        periods: u32,
        supply: &Supply,
        sensors: &mut Sensors,
    ) {
        if events & events::RESTART != 0 {
            sensors.go_on();
        }
        if periods != 1 && events & events::FLASH == 0 {
            controller.report_fault(Fault::Deadline);
        }
        if events & events::OVERRUN != 0 {
            controller.report_fault(Fault::Converter);
        }
        if periods != 1 || events & events::OVERRUN != 0 {
            sensors.stop();
            events::raise(events::RESTART);
        }
        if events & events::STOP != 0 {
            controller.stop_at_once(StopCause::Typed);
        }
        if events & events::BUTTON != 0 {
            controller.stop_at_once(StopCause::Button);
        }
        if events & events::SUPPLY != 0 {
            controller.report_fault(Fault::Supply);
            if supply.is_low() {
                events::raise(events::SUPPLY);
            }
        }
        if events & events::BRIDGE != 0 && controller.mode() != Mode::Off {
            controller.report_fault(Fault::Bridge);
        }
        if events & (events::BRIDGE | events::LINE) != 0 {
            controller.set_bridge_ready(!board::bridge_reports_fault());
        }
        if events & events::GLITCH != 0 {
            controller.count(Acted::BridgeGlitch);
        }
        if events & events::NOISE != 0 {
            controller.count(Acted::SerialNoise);
        }
    }

    /// Sends the next chunk if the serial line is free.
    #[task(binds = DMA1_STREAM6, priority = 1, local = [sender], shared = [telemetry])]
    fn send(mut cx: send::Context) {
        cx.local.sender.serve(&mut cx.shared.telemetry);
    }

    #[idle(local = [session, input, output, watchdog, store], shared = [controller, telemetry])]
    fn idle(cx: idle::Context) -> ! {
        let idle::LocalResources {
            session,
            input,
            output,
            watchdog,
            store,
            ..
        } = cx.local;
        let mut device = Device {
            controller: cx.shared.controller,
            telemetry: cx.shared.telemetry,
            store,
            watchdog,
        };
        let mut fed = ticks();
        let mut looked = fed;
        loop {
            let now = ticks();
            if now == fed {
                cortex_m::asm::wfi();
                continue;
            }
            // Feeds the watchdog here. A processor is alive only if both the control interrupt and this loop run.
            device.watchdog.feed();
            fed = now;
            if now.wrapping_sub(looked) >= CONSOLE_PERIODS {
                looked = now;
                session.look(1.0 / CONSOLE_HZ as f32, &mut device, output);
                if board::overrun() {
                    events::raise(events::OVERRUN);
                }
                if board::bridge_reports_fault() == session.bridge_is_ready() {
                    events::raise(events::LINE);
                }
                board::sample_current_once(
                    session.settings().motor.current_sampling == CurrentSampling::Centre,
                );
            }
            session.go_on_saying(output);
            if session.listens() && output.has_room() {
                match input.next(now) {
                    Heard::Nothing => {}
                    Heard::Byte(byte) => session.type_in(byte, &mut device, output),
                    Heard::Loss => session.complain(output),
                }
            }
            output.flush();
            if let Some(baud) = session.take_baud() {
                BAUD_WANTED.store(baud, Ordering::Relaxed);
            }
            if BAUD_WANTED.load(Ordering::Relaxed) != 0 {
                rtic::pend(Interrupt::DMA1_STREAM6);
            }
        }
    }
}
