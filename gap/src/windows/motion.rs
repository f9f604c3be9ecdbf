//! The measured motion, and the torque that the nominal model lacks for it.

use super::restart::Restart;
use super::series::Series;
use super::statistics::{quantile, rms};
use core::f64::consts::{PI, SQRT_2, TAU};
use host_sim::device::Device;
use host_sim::drive::DriveLine;
use std::collections::BTreeMap;

/// Smoothed motion at each coarse sample of a series. The errors of the position sensor are removed, except for its hysteresis.
#[derive(Clone, Debug)]
pub(crate) struct Motion {
    pub position: Vec<f64>,
    pub velocity: Vec<f64>,
    pub acceleration: Vec<f64>,
    /// Drive torque at the joint, N m.
    pub drive_nm: Vec<f64>,
    /// Torque that the motion needed beyond that of the device model, N m. It is NaN near standstill, where Coulomb friction may have any
    /// value up to its level.
    pub missing_nm: Vec<f64>,
    /// Torque that static friction had to balance, N m. It is NaN where the direction of sliding is known.
    pub held_nm: Vec<f64>,
}

/// Speed, in standard deviations of the fitted slope, below which the direction of sliding is unknown.
const KNOWN_DIRECTION: f64 = 4.0;

impl Motion {
    /// Computes the motion of a series. `cutoff_hz` is the cutoff frequency of the low-pass of its position column, if any.
    pub(crate) fn of(
        series: &Series,
        device: &Device,
        cutoff_hz: Option<f64>,
        half_width_s: f64,
    ) -> Self {
        let sensing = &device.sensing;
        let behind_s = sensing.lag_s + sensing.further_lag_s + series.logged_lag_s(cutoff_hz);
        let n = series.time.len();
        let read = |i: usize| series.position[i] - sensing.jumped(series.session(i));
        let position: Vec<f64> = (0..n).map(|i| sensing.inverse(read(i))).collect();
        let mut motion = Self {
            position: Vec::with_capacity(n),
            velocity: Vec::with_capacity(n),
            acceleration: Vec::with_capacity(n),
            drive_nm: Vec::with_capacity(n),
            missing_nm: Vec::with_capacity(n),
            held_nm: Vec::with_capacity(n),
        };
        let mut line = DriveLine::at_rest(&device.drive);
        let m = &device.mechanics;
        let noises = series
            .windows
            .iter()
            .flat_map(|w| w.samples.clone().map(|_| w.noise));
        for (i, noise) in (0..n).zip(noises) {
            let now = series.time[i];
            let from = series.input_time[i];
            line.command(&device.drive, from, series.input[i], series.velocity[i]);
            let dt = series.input_time.get(i + 1).map_or(0.0, |next| next - from);
            let (torque, _) = line.piece(from, dt);
            motion.drive_nm.push(torque.at(0.5 * dt));
            // A reading that is delayed by `behind_s` shows the present motion.
            let shown_s = (now + behind_s).min(series.time[n - 1]);
            let Some(fit) = Restart::fit(&series.time, &position, shown_s, half_width_s) else {
                continue;
            };
            let (x, v, a) = (fit.value, fit.slope, fit.curvature);
            motion.position.push(x);
            motion.velocity.push(v);
            motion.acceleration.push(a);
            let known = v.abs() > KNOWN_DIRECTION * noise * fit.covariance[1][1].sqrt();
            let without_friction_nm = m.inertia * a
                + (m.viscous + m.drag * v.abs()) * v
                + m.gravity * m.from_hanging_rad(x).sin()
                - m.spring(x)
                - m.offset_nm
                - m.cogging.map_or(0.0, |cogging| cogging.torque(x))
                - motion.drive_nm[i];
            let [missing_nm, held_nm] = if known {
                [
                    without_friction_nm + m.friction.level(v).copysign(v),
                    f64::NAN,
                ]
            } else {
                [f64::NAN, -without_friction_nm]
            };
            motion.missing_nm.push(missing_nm);
            motion.held_nm.push(held_nm);
        }
        motion
    }
}

/// Typical magnitudes in a recording, for start values.
#[derive(Clone, Debug)]
pub(crate) struct Scales {
    pub position: [f64; 2],
    /// Range of the position in the run with the smallest range, at least [`LEAST_SPAN`] of the range of all runs.
    pub least_span: f64,
    pub velocity: f64,
    /// Rms input, after the limits of the drive.
    pub input: f64,
    pub torque: f64,
    pub friction: f64,
    pub period_s: f64,
    pub duration_s: f64,
    pub horizon_s: f64,
    pub noise: f64,
}

/// Friction level, as a share of the rms drive torque, if the model has no Coulomb friction.
const FRICTION_SHARE: f64 = 0.05;
/// Least range of the position, over the noise, for a run to count as moving.
const LEAST_SPAN_OVER_NOISE: f64 = 30.0;
/// Least range of a run, as a share of the whole range.
const LEAST_SPAN: f64 = 0.01;
/// Least number of samples per spatial period at the rms speed.
const SAMPLES_PER_PERIOD: f64 = 6.0;

impl Scales {
    pub(crate) fn of(
        series: &[Series],
        motions: &[Motion],
        device: &Device,
        horizon_s: f64,
    ) -> Self {
        let all = |f: fn(&Motion) -> &Vec<f64>| -> Vec<f64> {
            motions
                .iter()
                .flat_map(|m| f(m).iter().copied())
                .filter(|v| v.is_finite())
                .collect()
        };
        let inputs: Vec<f64> = series
            .iter()
            .flat_map(|s| &s.input)
            .map(|u| device.drive.taken(*u))
            .collect();
        let positions = all(|m| &m.position);
        let torque = rms(&all(|m| &m.drive_nm)).max(f64::MIN_POSITIVE);
        let levels = device.mechanics.friction.level_nm;
        let spans = series.iter().filter_map(Series::session_span_s);
        let [from, to] = spans.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], [c, d]| {
            [a.min(c), b.max(d)]
        });
        let noise: Vec<f64> = series
            .iter()
            .flat_map(|s| s.windows.iter().map(|w| w.noise))
            .collect();
        let position = [0.005, 0.995].map(|share| quantile(&positions, share));
        let span = (position[1] - position[0]).max(f64::MIN_POSITIVE);
        let noise = rms(&noise);
        Self {
            position,
            least_span: least_span(series, noise).clamp(LEAST_SPAN * span, span),
            velocity: rms(&all(|m| &m.velocity)).max(f64::MIN_POSITIVE),
            input: rms(&inputs).max(f64::MIN_POSITIVE),
            torque,
            friction: levels[0].max(levels[1]).max(FRICTION_SHARE * torque),
            period_s: crate::windows::series::median_period(&series[0].time),
            duration_s: (to - from).max(horizon_s),
            horizon_s,
            noise,
        }
    }

    /// Frequency of a sine of the same span and rms velocity, Hz.
    pub(crate) fn motion_hz(&self) -> f64 {
        SQRT_2 * self.velocity / (PI * self.span())
    }

    /// The highest wave number over the position that the samples resolve at the rms speed.
    pub(crate) fn finest_wave_number(&self) -> f64 {
        self.finest_wave_number_at(self.velocity)
    }

    /// The highest wave number over the position that the samples resolve at a given speed.
    pub(crate) fn finest_wave_number_at(&self, speed: f64) -> f64 {
        TAU / (speed * self.period_s * SAMPLES_PER_PERIOD)
    }

    /// The lowest and highest wave number: one period over the range of the position, and the highest that the samples resolve.
    pub(crate) fn wave_numbers(&self) -> [f64; 2] {
        [TAU / self.span(), self.finest_wave_number()]
    }

    pub(crate) fn middle(&self) -> f64 {
        0.5 * (self.position[0] + self.position[1])
    }

    pub(crate) fn span(&self) -> f64 {
        (self.position[1] - self.position[0]).max(f64::MIN_POSITIVE)
    }
}

/// The smallest range of the position among the runs that move.
fn least_span(series: &[Series], noise: f64) -> f64 {
    let mut runs: BTreeMap<usize, Vec<f64>> = BTreeMap::new();
    for s in series {
        runs.entry(s.run).or_default().extend(&s.position);
    }
    let spans = runs.values().map(|x| quantile(x, 0.95) - quantile(x, 0.05));
    spans
        .filter(|span| *span > LEAST_SPAN_OVER_NOISE * noise)
        .fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::made;
    use host_sim::effects::Effect;

    #[test]
    fn with_the_right_sensor_model_less_torque_is_missing() {
        let missing_rms = |hidden: &str, known: &[&str]| {
            let recording = made::recording(&[hidden]);
            let mut device = Device::nominal(&recording.model);
            for effect in known {
                effect.parse::<Effect>().unwrap().install(&mut device);
            }
            let problem = made::problem(&recording);
            let half_width_s = recording.restart_half_width;
            let motion = Motion::of(&problem.series[0], &device, None, half_width_s);
            let known = motion.missing_nm.into_iter().filter(|nm| nm.is_finite());
            rms(&known.collect::<Vec<f64>>())
        };
        for hidden in [
            "sensor_lag:time=0.02",
            "sensor_gain:gain=1.6",
            "sensor_nonlinearity:quadratic=0.3,cubic=1.5",
            "sensor_nonlinearity:quadratic=0,ripple_sine=0.03,wave_number=20",
        ] {
            let [unknown, known] = [missing_rms(hidden, &[]), missing_rms(hidden, &[hidden])];
            assert!(known < 0.6 * unknown, "{hidden}: {known} {unknown}");
        }
    }
}
