//! Frequency response of the control core and of the actuator. It is measured on the core itself, so that the control law is
//! implemented only there.

use super::gains::Gains;
use crate::failure::Failure;
use haptic_paddle::controller::{Controller, Duty, Measurement, Mode, TickRate};
use haptic_paddle::excitation::Excitation;
use haptic_paddle::settings::{CompensationSettings, Sensor, Settings};
use host_sim::closed_loop::{ClosedLoop, LoopError, LoopSetup};
use host_sim::drive::Drive;
use host_sim::paddle::Actuator;
use host_sim::sensors::{CurrentAmplifier, Encoder, Noise};
use num_complex::Complex64;
use std::f64::consts::TAU;

/// Frequency response from position to actual torque at a set of frequencies, for any gains.
#[derive(Clone, Debug)]
pub struct CoreResponse {
    /// Angular frequencies of the true signal in ascending order, rad/s.
    pub omega_rad_s: Vec<f64>,
    /// Torque at the motor per position of the paddle, N m/rad, for unit proportional, integral and derivative gain. It
    /// includes the actuator and the hold.
    unit: Vec<[Complex64; 3]>,
}

/// Lowest frequency, Hz.
const FROM_HZ: f64 = 0.5;
/// Frequencies per decade.
const PER_DECADE: f64 = 24.0;
/// Highest frequency as a share of the sampling rate of the position loop.
const UP_TO: f64 = 0.4;
/// Time before the measurement, s. The initial transients of filters and current loop have then decayed.
const WARM_UP_S: f64 = 0.05;

/// Amplitude of the test motion, rad.
const AMPLITUDE_RAD: f64 = 0.05;
/// Gain at which each term is measured.
const PROBE: f64 = 0.01;
/// Counts per turn of the test encoder. Its steps are finer than those of any encoder, so quantization is negligible.
const COUNTS_PER_TURN: f32 = 2e6;
/// Amplitude of the test torque of the actuator, N m at the motor. It is far below every limit.
const TORQUE_NM: f32 = 0.005;
/// Inertia of a paddle that does not move, kg m².
const BLOCKED: f64 = 1e9;

impl CoreResponse {
    /// Measures the frequency response.
    ///
    /// # Errors
    /// Returns a [`Failure`] if the controller refuses.
    pub fn measure(setup: &LoopSetup) -> Result<Self, Failure> {
        let period_s = setup.rates.position_tick_s();
        let decades = (UP_TO / (FROM_HZ * period_s)).log10();
        let mut periods: Vec<_> = (0..=(decades * PER_DECADE) as usize)
            .map(|i| FROM_HZ * 10f64.powf(i as f64 / PER_DECADE))
            .map(|hz| (1.0 / (hz * period_s)).round() as usize)
            .collect();
        periods.dedup();
        let mut response = Self {
            omega_rad_s: Vec::new(),
            unit: Vec::new(),
        };
        for positions in periods {
            let ticks = positions * usize::from(setup.rates.divider.max(1));
            let tick_s = setup.rates.tick_s * setup.rates.true_s_per_s;
            let omega_rad_s = TAU / (ticks as f64 * tick_s);
            let actuator = actuator(setup, ticks)? * hold(omega_rad_s * tick_s);
            let mut unit = [Complex64::ZERO; 3];
            for (term, unit) in unit.iter_mut().enumerate() {
                *unit = core(setup, &Gains::only(term, PROBE), ticks)? * actuator / PROBE;
            }
            response.omega_rad_s.push(omega_rad_s);
            response.unit.push(unit);
        }
        Ok(response)
    }

    /// Torque at the motor per position of the paddle with these gains, N m/rad, at each frequency.
    pub fn of(&self, gains: &Gains) -> impl Iterator<Item = Complex64> {
        let Gains { kp, ki, kd } = *gains;
        let each = self.unit.iter();
        each.map(move |[p, i, d]| p * kp + i * ki + d * kd)
    }

    /// Torque at the motor per position at the highest frequency, N m/rad: the gain for sensor noise.
    pub fn noise_gain(&self, gains: &Gains) -> f64 {
        self.of(gains).last().map_or(0.0, |torque| torque.norm())
    }
}

/// Frequency response of a zero-order hold over an angle of `radians`.
fn hold(radians: f64) -> Complex64 {
    let half = 0.5 * radians;
    Complex64::from_polar(half.sin() / half, -half)
}

/// Correlates input and output with a sinusoid over whole periods.
#[derive(Default)]
struct Wave([Complex64; 2]);

impl Wave {
    fn add(&mut self, phase: f64, input: f64, output: f64) {
        let turn = Complex64::from_polar(1.0, -phase);
        self.0[0] += turn * input;
        self.0[1] += turn * output;
    }

    fn ratio(&self) -> Complex64 {
        self.0[1] / self.0[0]
    }
}

fn warm_up_ticks(setup: &LoopSetup) -> usize {
    (WARM_UP_S / setup.rates.tick_s) as usize
}

/// Torque command per position, N m/rad, for a sinusoidal motion with a period of `ticks` control periods.
fn core(setup: &LoopSetup, gains: &Gains, ticks: usize) -> Result<Complex64, Failure> {
    let mut settings = Settings {
        compensation: CompensationSettings::default(),
        ..setup.settings
    };
    gains
        .put(&mut settings)
        .map_err(|error| Failure::setting("pid", error))?;
    settings.estimate.sensor = Sensor::Encoder;
    settings.mechanism.counts_per_turn = COUNTS_PER_TURN;
    settings.motor.torque_limit_nm = f32::MAX;
    let unbounded = [
        &mut settings.limit.speed_deg_s,
        &mut settings.limit.disagreement_deg,
        &mut settings.limit.travel_deg,
        // This measurement has no current loop, so the mismatch limit is disabled.
        &mut settings.limit.mismatch_v,
    ];
    for bound in unbounded {
        *bound = f32::INFINITY;
    }
    let encoder = Encoder::new(&settings.mechanism, 0.0, 0);
    let mut amplifier = CurrentAmplifier::default();
    amplifier.noise_a = 0.0;
    let idle_counts = amplifier.counts(0.0, &mut Noise::new(0));
    let measured = |position_rad: f64| Measurement {
        encoder_count: encoder.count(position_rad),
        hall_adc: MIDDLE_OF_THE_HALL_RANGE,
        current_adc: idle_counts,
    };
    let rate = TickRate::new((1.0 / setup.rates.tick_s) as f32, setup.rates.divider);
    let mut controller = Controller::new(&settings, rate);
    for _ in 0..setup.rates.divider.max(1) {
        controller.step(&measured(0.0));
    }
    controller.zero_at(0.0).map_err(LoopError::Zero)?;
    controller.arm(Mode::Position).map_err(LoopError::Arm)?;
    let mut wave = Wave::default();
    let warm_up = warm_up_ticks(setup).next_multiple_of(ticks);
    for tick in 0..warm_up + ticks {
        let phase = TAU * tick as f64 / ticks as f64;
        let position_rad = AMPLITUDE_RAD * phase.sin();
        let _: Duty = controller.step(&measured(position_rad));
        if tick >= warm_up {
            wave.add(
                phase,
                position_rad,
                f64::from(controller.torque_command_nm()),
            );
        }
    }
    Ok(wave.ratio())
}

const MIDDLE_OF_THE_HALL_RANGE: u16 = 2048;

/// Actual torque per torque command, averaged over a control period, with a blocked shaft.
fn actuator(setup: &LoopSetup, ticks: usize) -> Result<Complex64, Failure> {
    let Actuator::Bridge(motor) = setup.paddle.actuator else {
        return Ok(Complex64::ONE);
    };
    let mut setup = setup.clone();
    setup.settings.compensation = CompensationSettings::default();
    setup.paddle.amplifier.noise_a = 0.0;
    setup.paddle.device.mechanics.inertia = BLOCKED;
    setup.paddle.device.drive = Drive::ideal(setup.paddle.device.drive.ratio);
    let mut closed_loop = ClosedLoop::armed(&setup, Mode::Torque)?;
    let frequency_hz = 1.0 / (ticks as f64 * setup.rates.tick_s);
    let sine = Excitation::sine(TORQUE_NM, frequency_hz as f32);
    let started = closed_loop.controller_mut().start(&sine);
    started.map_err(host_sim::experiment::ExperimentError::Excitation)?;
    let mut wave = Wave::default();
    let warm_up = warm_up_ticks(&setup).next_multiple_of(ticks);
    for tick in 0..warm_up + ticks {
        closed_loop.tick();
        if tick >= warm_up {
            let told_nm = f64::from(closed_loop.controller().torque_command_nm());
            let made_nm = motor.torque_constant_nm_per_a * closed_loop.paddle().current_a();
            wave.add(TAU * tick as f64 / ticks as f64, told_nm, made_nm);
        }
    }
    Ok(wave.ratio())
}
