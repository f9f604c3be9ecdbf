//! Tests of the current regulator with the exact solution of the motor winding between ticks, and with the timing of the
//! board. The duty acts one period after its computation, and the converter returns the mean over the last period.

use haptic_paddle::control::current::{CurrentGains, CurrentLoop, MAX_DUTY};
use haptic_paddle::controller::Duty;
use haptic_paddle::settings::MotorSettings;

struct Winding {
    resistance_ohm: f64,
    inductance_h: f64,
    supply_v: f64,
    current_a: f64,
}

impl Winding {
    /// Simulates one period at this duty and returns the mean current.
    fn step(&mut self, duty: f32, tick_s: f64) -> f32 {
        let exponent = self.resistance_ohm / self.inductance_h * tick_s;
        let end_a = f64::from(duty) * self.supply_v / self.resistance_ohm;
        let decay = (-exponent).exp();
        let mean_a = end_a + (self.current_a - end_a) * (1.0 - decay) / exponent;
        self.current_a = end_a + (self.current_a - end_a) * decay;
        mean_a as f32
    }
}

struct Response {
    overshoot: f64,
    settled_s: f64,
    final_a: f64,
}

const WANTED_A: f64 = 0.5;

/// Response to a torque step with a winding whose resistance and inductance differ from the stated ones by these factors.
fn respond(tick_s: f64, resistance_factor: f64, inductance_factor: f64) -> Response {
    let settings = MotorSettings::default();
    let mut winding = Winding {
        resistance_ohm: f64::from(settings.resistance_ohm) * resistance_factor,
        inductance_h: f64::from(settings.inductance_h) * inductance_factor,
        supply_v: f64::from(settings.supply_v),
        current_a: 0.0,
    };
    let mut regulator = CurrentLoop::new(CurrentGains::new(&settings, 15.0, tick_s as f32));
    let torque_nm = (WANTED_A * f64::from(settings.torque_constant_nm_per_a)) as f32;
    let (mut pending, mut measured_a) = (0.0, 0.0);
    let (mut peak_a, mut settled_s) = (0.0_f64, 0.0);
    for tick in 0..(0.1 / tick_s) as usize {
        let duty = regulator.update(torque_nm, measured_a, 0.0);
        measured_a = winding.step(pending, tick_s);
        pending = duty;
        peak_a = peak_a.max(winding.current_a);
        if (winding.current_a / WANTED_A - 1.0).abs() > 0.05 {
            settled_s = (tick + 1) as f64 * tick_s;
        }
    }
    Response {
        overshoot: peak_a / WANTED_A - 1.0,
        settled_s,
        final_a: winding.current_a,
    }
}

#[test]
fn a_step_of_torque_settles_fast_and_without_overshoot() {
    let response = respond(50e-6, 1.0, 1.0);
    println!(
        "overshoot {:.3}, settled {:.6} s",
        response.overshoot, response.settled_s
    );
    assert!(response.overshoot < 0.05, "{}", response.overshoot);
    assert!(response.settled_s < 0.6e-3, "{}", response.settled_s);
    assert!((response.final_a - WANTED_A).abs() < 1e-4);
}

#[test]
fn the_loop_is_stable_with_a_different_winding() {
    for (resistance, inductance) in [(0.7, 0.7), (0.7, 1.4), (1.4, 0.7), (1.4, 1.4)] {
        let response = respond(50e-6, resistance, inductance);
        println!(
            "{resistance} {inductance}: {:.3}, {:.6} s",
            response.overshoot, response.settled_s
        );
        assert!((response.final_a - WANTED_A).abs() < 1e-3);
        assert!(
            response.overshoot < 0.25,
            "{resistance} {inductance}: {}",
            response.overshoot
        );
        assert!(response.settled_s < 1e-3);
    }
}

#[test]
fn the_loop_is_stable_at_the_slow_tick_of_the_lab() {
    let response = respond(351e-6, 1.0, 1.0);
    println!(
        "overshoot {:.3}, settled {:.6} s",
        response.overshoot, response.settled_s
    );
    assert!((response.final_a - WANTED_A).abs() < 1e-3);
    assert!(response.overshoot < 0.05);
    assert!(response.settled_s < 3e-3);
}

#[test]
fn back_emf_is_fed_forward() {
    let mut regulator = CurrentLoop::new(CurrentGains::new(&MotorSettings::default(), 15.0, 50e-6));
    let duty = regulator.update(0.0, 0.0, 5.0);
    assert!((duty - 0.0538 * 15.0 * 5.0 / 24.0).abs() < 1e-6);
}

#[test]
fn the_duty_is_bounded_and_its_integral_does_not_wind_up() {
    let mut regulator = CurrentLoop::new(CurrentGains::new(&MotorSettings::default(), 15.0, 50e-6));
    // A broken wire carries no current at any duty.
    for _ in 0..100_000 {
        assert!(regulator.update(0.0323, 0.0, 0.0) <= MAX_DUTY);
    }
    let ticks = (0..1000).find(|_| regulator.update(-0.0323, 0.0, 0.0) < 0.0);
    assert!(ticks.is_some_and(|ticks| ticks < 50), "{ticks:?}");
}

#[test]
fn a_duty_is_rounded_to_the_nearest_step_of_the_timer() {
    const TOP: u16 = 2100;
    assert_eq!(Duty::ZERO.compare(TOP), TOP / 2);
    for step in -10_290..=10_290 {
        let duty = Duty(step as f32 / 10_500.0);
        let stepped = duty.stepped(TOP);
        assert!((stepped.0 - duty.0).abs() < 0.51 / 1050.0, "{duty:?}");
        assert_eq!(stepped.stepped(TOP), stepped);
    }
}
