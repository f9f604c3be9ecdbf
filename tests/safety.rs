//! Checks that every fault sets the duty to 0 until it is cleared.

use haptic_paddle::controller::{
    ArmError, Controller, Duty, Measurement, Mode, ReferenceError, TickRate, ZeroError,
};
use haptic_paddle::excitation::{Excitation, ExcitationError};
use haptic_paddle::safety::Fault;
use haptic_paddle::sensing::current::IdleReading;
use haptic_paddle::settings::{Sensor, Settings};

const RATE: TickRate = TickRate::new(20_000.0, 2);
/// Readings of the Hall sensor and of the encoder at 0 degrees.
const AT_ZERO: Measurement = Measurement {
    encoder_count: 0,
    hall_adc: 2032,
    current_adc: 2048.0,
};

fn armed(settings: &Settings, mode: Mode) -> Controller {
    let mut controller = Controller::new(settings, RATE);
    controller.step(&AT_ZERO);
    controller.zero_at(0.0).unwrap();
    controller.arm(mode).unwrap();
    controller
}

fn idle(counts: f32) -> IdleReading {
    let mut reading = IdleReading::default();
    (0..100).for_each(|_| reading.add(counts));
    reading
}

fn run(controller: &mut Controller, ticks: u32, measurement: Measurement) -> Duty {
    (0..ticks)
        .map(|_| controller.step(&measurement))
        .last()
        .unwrap()
}

/// Checks that the controller stops at the fault, and that it stays stopped until it is cleared and armed again.
fn trips(settings: &Settings, fault: Fault, provoke: impl FnOnce(&mut Controller)) {
    let mut controller = armed(settings, Mode::Position);
    controller.set_reference(0.2).unwrap();
    assert!(run(&mut controller, 4, AT_ZERO).0 > 0.0);

    provoke(&mut controller);
    assert_eq!(controller.fault(), Some(fault));
    assert_eq!(controller.mode(), Mode::Off);
    assert_eq!(controller.torque_command_nm(), 0.0);
    assert_eq!(run(&mut controller, 10_000, AT_ZERO), Duty::ZERO);
    assert_eq!(
        controller.fault(),
        Some(fault),
        "a fault does not go away by itself"
    );
    assert_eq!(
        controller.arm(Mode::Position),
        Err(ArmError::Faulted(fault))
    );
    assert_eq!(controller.set_reference(0.1), Err(ReferenceError::Disarmed));
    assert_eq!(
        controller.start(&Excitation::step(0.1)),
        Err(ExcitationError::Disarmed)
    );

    controller.clear_fault();
    assert_eq!(
        run(&mut controller, 10, AT_ZERO),
        Duty::ZERO,
        "clearing does not arm"
    );
    controller.arm(Mode::Position).unwrap();
    assert!(
        run(&mut controller, 10, AT_ZERO).0.abs() < 1e-3,
        "arming holds the paddle where it stands"
    );
}

#[test]
fn each_fault_of_the_measurements_trips() {
    let settings = Settings::default();
    let no_hall_check = {
        let mut settings = settings;
        settings.limit.disagreement_deg = 10_000.0;
        settings.limit.speed_deg_s = 100_000.0;
        settings
    };
    trips(&settings, Fault::Overcurrent, |c| {
        run(
            c,
            1,
            Measurement {
                current_adc: 100.0,
                ..AT_ZERO
            },
        );
    });
    for rail in [0.0, 4095.0] {
        trips(&settings, Fault::CurrentSignal, |c| {
            run(
                c,
                1,
                Measurement {
                    current_adc: rail,
                    ..AT_ZERO
                },
            );
        });
    }
    trips(&settings, Fault::NonFinite, |c| {
        assert_eq!(
            run(
                c,
                1,
                Measurement {
                    current_adc: f32::NAN,
                    ..AT_ZERO
                }
            ),
            Duty::ZERO
        );
    });
    trips(&settings, Fault::NonFinite, |c| {
        assert_eq!(
            run(
                c,
                1,
                Measurement {
                    current_adc: f32::NEG_INFINITY,
                    ..AT_ZERO
                }
            ),
            Duty::ZERO
        );
    });
    // The torque is so small that the missing current, which is not simulated here, causes no fault.
    let mut weak = settings;
    weak.pid.kp_nm_per_deg = 1e-4;
    weak.pid.kd_nm_s_per_deg = 0.0;
    trips(&weak, Fault::SensorDisagreement, |c| {
        for turn in 0..100 {
            run(
                c,
                20,
                Measurement {
                    encoder_count: 25 * (turn % 2),
                    hall_adc: 2500,
                    ..AT_ZERO
                },
            );
        }
    });
    trips(&no_hall_check, Fault::Travel, |c| {
        run(
            c,
            2,
            Measurement {
                encoder_count: 5_000,
                ..AT_ZERO
            },
        );
    });
    trips(&settings, Fault::Overspeed, |c| {
        for tick in 0..40 {
            run(
                c,
                2,
                Measurement {
                    encoder_count: 60 * tick,
                    ..AT_ZERO
                },
            );
        }
    });
    let mut by_hall = settings;
    by_hall.estimate.sensor = Sensor::Hall;
    for rail in [0, 4095] {
        trips(&by_hall, Fault::HallSignal, |c| {
            run(
                c,
                2,
                Measurement {
                    hall_adc: rail,
                    ..AT_ZERO
                },
            );
        });
    }
}

#[test]
fn each_fault_that_the_board_reports_trips() {
    for fault in [Fault::Bridge, Fault::Deadline] {
        trips(&Settings::default(), fault, |c| c.report_fault(fault));
    }
}

#[test]
fn the_first_fault_is_kept() {
    let mut controller = armed(&Settings::default(), Mode::Position);
    controller.report_fault(Fault::Bridge);
    controller.report_fault(Fault::Deadline);
    assert_eq!(controller.fault(), Some(Fault::Bridge));
}

#[test]
fn a_deviation_of_a_single_sample_is_not_a_disagreement() {
    let mut controller = armed(&Settings::default(), Mode::Position);
    for _ in 0..100 {
        run(
            &mut controller,
            20,
            Measurement {
                hall_adc: 2500,
                ..AT_ZERO
            },
        );
        run(&mut controller, 20, AT_ZERO);
    }
    assert_eq!(controller.fault(), None);
}

#[test]
fn the_paddle_may_be_moved_by_hand_while_disarmed() {
    let mut controller = Controller::new(&Settings::default(), RATE);
    for tick in 0..1000 {
        run(
            &mut controller,
            2,
            Measurement {
                encoder_count: 100 * tick,
                hall_adc: 4000,
                current_adc: 100.0,
            },
        );
    }
    assert_eq!(controller.fault(), None);
}

#[test]
fn position_mode_needs_a_zero_and_torque_mode_does_not() {
    let mut controller = Controller::new(&Settings::default(), RATE);
    assert_eq!(
        controller.arm(Mode::Position),
        Err(ArmError::NothingMeasured)
    );
    assert_eq!(controller.zero_at(0.0), Err(ZeroError::NothingMeasured));
    controller.step(&AT_ZERO);
    assert_eq!(controller.arm(Mode::Position), Err(ArmError::NotZeroed));
    controller.arm(Mode::Torque).unwrap();
    assert_eq!(controller.zero_at(0.0), Err(ZeroError::Armed));
    assert_eq!(controller.arm(Mode::Torque), Err(ArmError::AlreadyArmed));
    controller.disarm();
    assert_eq!(controller.zero_at(f32::NAN), Err(ZeroError::OutsideTravel));
    assert_eq!(controller.zero_at(1.0), Err(ZeroError::OutsideTravel));
    controller.zero_at(0.1).unwrap();
    assert_eq!(controller.encoder_rad(), 0.1);
    controller.arm(Mode::Position).unwrap();
}

#[test]
fn the_hall_sensor_gives_the_encoder_its_zero() {
    let mut controller = Controller::new(&Settings::default(), RATE);
    controller.step(&Measurement {
        encoder_count: 123_456,
        hall_adc: 2500,
        current_adc: 2048.0,
    });
    controller.zero_from_hall().unwrap();
    assert_eq!(controller.encoder_rad(), controller.hall_rad());
    assert!(controller.hall_rad() > 0.2);
    run(
        &mut controller,
        2,
        Measurement {
            hall_adc: 4095,
            ..AT_ZERO
        },
    );
    assert_eq!(controller.zero_from_hall(), Err(ZeroError::HallSignal));
}

#[test]
fn references_beyond_the_limits_are_refused() {
    let mut controller = armed(&Settings::default(), Mode::Position);
    for wrong in [f32::NAN, f32::INFINITY, 1.0, -1.0] {
        assert_eq!(
            controller.set_reference(wrong),
            Err(ReferenceError::OutOfRange)
        );
    }
    controller.disarm();
    controller.arm(Mode::Torque).unwrap();
    assert_eq!(
        controller.set_reference(0.1),
        Err(ReferenceError::OutOfRange)
    );
    assert_eq!(
        controller.start(&Excitation::sine(0.04, 1.0)),
        Err(ExcitationError::OutOfRange)
    );
    controller.set_reference(0.001).unwrap();
    run(&mut controller, 2, AT_ZERO);
    assert_eq!(controller.torque_command_nm(), 0.001);
}

#[test]
fn unchecked_settings_cause_a_fault_and_no_torque() {
    let mut settings = Settings::default();
    settings.pid.kp_nm_per_deg = f32::NAN;
    settings.compensation.gravity = true;
    settings.compensation.gravity_nm = f32::INFINITY;
    assert!(settings.check().is_err());
    let mut controller = armed(&settings, Mode::Position);
    assert_eq!(run(&mut controller, 10, AT_ZERO), Duty::ZERO);
    assert_eq!(controller.fault(), Some(Fault::NonFinite));
    controller.apply(&Settings::default());
    controller.clear_fault();
    controller.arm(Mode::Position).unwrap();
    controller.set_reference(0.1).unwrap();
    assert!(
        run(&mut controller, 10, AT_ZERO).0 > 0.0,
        "good settings heal it"
    );
}

#[test]
fn the_current_offset_is_measured_only_with_an_idle_bridge() {
    let mut controller = Controller::new(&Settings::default(), RATE);
    controller.calibrate_current_offset(&idle(2100.0)).unwrap();
    assert!(controller.calibrate_current_offset(&idle(100.0)).is_err());
    controller.step(&Measurement {
        current_adc: 2100.0,
        ..AT_ZERO
    });
    assert_eq!(controller.current_a(), 0.0);
}
