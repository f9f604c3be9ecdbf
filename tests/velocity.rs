//! Compares the velocity observer with a filtered difference on sensor signals of a known motion.

use haptic_paddle::estimate::low_pass::{self, LowPass};
use haptic_paddle::estimate::velocity::{ObserverGains, VelocityObserver};
use std::f64::consts::TAU;

const TICK_S: f64 = 1e-4;
const BANDWIDTH_HZ: f32 = 50.0;
const ENCODER_QUANTUM_RAD: f64 = TAU / 30_000.0;

struct Motion<F> {
    /// Position, velocity and acceleration as a function of time.
    at: F,
    /// Share of the acceleration that the torque explains. The rest is friction.
    explained: f64,
    /// Standard deviation of the sensor noise, rad.
    noise_rad: f64,
    quantum_rad: f64,
}

/// Root-mean-square velocity errors of the observer, and of a filtered difference with this cutoff, rad/s.
fn errors(motion: &Motion<impl Fn(f64) -> [f64; 3]>, difference_cutoff_hz: f32) -> (f64, f64) {
    let mut observer = VelocityObserver::new(ObserverGains::new(BANDWIDTH_HZ, TICK_S as f32));
    let mut difference = LowPass::new(low_pass::gain(difference_cutoff_hz, TICK_S as f32));
    let mut previous_rad = None;
    let mut noise = 1_u64;
    let (mut observer_sum, mut difference_sum, mut samples) = (0.0, 0.0, 0);
    for tick in 0..60_000 {
        let [position_rad, velocity_rad_s, acceleration_rad_s2] =
            (motion.at)(f64::from(tick) * TICK_S);
        // The sum of twelve uniform numbers is approximately normal.
        let normal: f64 = (0..12)
            .map(|_| {
                noise = noise
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1_442_695_040_888_963_407);
                (noise >> 33) as f64 / f64::from(1_u32 << 31) - 0.5
            })
            .sum();
        let noisy_rad = position_rad + normal * motion.noise_rad;
        let measured_rad = ((noisy_rad / motion.quantum_rad).round() * motion.quantum_rad) as f32;
        let previous = previous_rad.replace(measured_rad).unwrap_or(measured_rad);
        let by_observer = observer.update(
            measured_rad,
            (acceleration_rad_s2 * motion.explained) as f32,
        );
        let by_difference = difference.update((measured_rad - previous) / TICK_S as f32);
        if tick > 5000 {
            observer_sum += (f64::from(by_observer) - velocity_rad_s).powi(2);
            difference_sum += (f64::from(by_difference) - velocity_rad_s).powi(2);
            samples += 1;
        }
    }
    let rms = |sum: f64| (sum / f64::from(samples)).sqrt();
    (rms(observer_sum), rms(difference_sum))
}

fn sine(amplitude_rad: f64, frequency_hz: f64) -> impl Fn(f64) -> [f64; 3] {
    let w = TAU * frequency_hz;
    move |t| {
        let (sin, cos) = (w * t).sin_cos();
        [
            amplitude_rad * sin,
            amplitude_rad * w * cos,
            -amplitude_rad * w * w * sin,
        ]
    }
}

#[test]
fn with_the_encoder_the_observer_is_better_than_a_difference_with_any_cutoff() {
    // The torque explains 80 % of the acceleration. The difference uses the best cutoff for each motion.
    for (amplitude_rad, frequency_hz) in [(0.5, 1.0), (0.1, 3.0), (0.05, 11.5)] {
        let motion = Motion {
            at: sine(amplitude_rad, frequency_hz),
            explained: 0.8,
            noise_rad: 0.0,
            quantum_rad: ENCODER_QUANTUM_RAD,
        };
        let (observer, _) = errors(&motion, BANDWIDTH_HZ);
        let best = [12.5, 25.0, 50.0, 100.0, 200.0, 400.0, 800.0]
            .map(|cutoff_hz| errors(&motion, cutoff_hz).1)
            .into_iter()
            .fold(f64::INFINITY, f64::min);
        println!("{frequency_hz} Hz: observer {observer:.4}, best difference {best:.4} rad/s");
        assert!(
            observer < 0.6 * best,
            "{frequency_hz} Hz: {observer} {best}"
        );
    }
}

#[test]
fn with_the_hall_sensor_the_observer_has_less_noise_than_a_difference_with_half_the_bandwidth() {
    // The noise is 0.79 mV and the quantization step 1.11 mV at 34.55 degrees per volt. The torque is unknown.
    let degrees_per_volt = 34.55_f64;
    let motion = Motion {
        at: sine(0.1, 0.5),
        explained: 0.0,
        noise_rad: (0.79e-3 * degrees_per_volt).to_radians(),
        quantum_rad: (1.11e-3 * degrees_per_volt).to_radians(),
    };
    let (observer, difference) = errors(&motion, BANDWIDTH_HZ / 2.0);
    println!("Hall: observer {observer:.4}, difference {difference:.4} rad/s");
    assert!(observer < 0.5 * difference, "{observer} {difference}");
}

#[test]
fn on_a_ramp_the_observer_has_no_mean_error() {
    let mut observer = VelocityObserver::new(ObserverGains::new(BANDWIDTH_HZ, TICK_S as f32));
    let mut sum = 0.0;
    for tick in 0..20_000 {
        let measured_rad =
            (0.1 * f64::from(tick) * TICK_S / ENCODER_QUANTUM_RAD).round() * ENCODER_QUANTUM_RAD;
        let velocity = observer.update(measured_rad as f32, 0.0);
        if tick >= 10_000 {
            sum += f64::from(velocity);
        }
    }
    assert!((sum / 1e4 - 0.1).abs() < 1e-3, "{}", sum / 1e4);
}

#[test]
fn a_blocked_paddle_has_zero_velocity_at_any_torque() {
    let mut observer = VelocityObserver::new(ObserverGains::new(BANDWIDTH_HZ, TICK_S as f32));
    let full_torque_rad_s2 = 0.0323 * 15.0 / 5.755e-4;
    let velocities: Vec<f32> = (0..5000)
        .map(|_| observer.update(0.0, full_torque_rad_s2))
        .collect();
    assert!(velocities[4999].abs() < 1e-3, "{}", velocities[4999]);
}
