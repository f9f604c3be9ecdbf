//! What a loop may have told between the rows of a log that is slower than itself: the column has its means alone.

use super::series::{Series, largest};
use super::torque_profiles::TorqueProfiles;
use host_sim::sensors::Noise;
use recording::{Pid, low_pass_gain};

/// Steps of a course in a row at most.
const MOST_TICKS: f64 = 32.0;
const SEED: u64 = 0x6c6f_6f70;

impl Series {
    /// Puts one possible course of a loop in the place of each row's mean input, which it keeps: where the mean lies between
    /// its neighbours, the step that it would come from, else the mean itself; and on all what the loop makes of the noise
    /// of its sensor.
    pub(crate) fn resample_inputs(&mut self, pid: &Pid, sensor_noise: f64) {
        let noise = told_noise(pid, sensor_noise);
        let mut draw = Noise::new(SEED);
        let (mut times, mut inputs, mut velocities) = (Vec::new(), Vec::new(), Vec::new());
        for row in 0..self.input.len() {
            let [start_s, mean] = [self.input_time[row], self.input[row]];
            let neighbours = row.checked_sub(1).zip(self.input_time.get(row + 1));
            let ticks = |end_s: f64| ((end_s - start_s) / pid.period).round().min(MOST_TICKS);
            let ticks = neighbours.map(|(_, end_s)| ticks(*end_s));
            let (Some((before, end_s)), Some(ticks @ 2.0..)) = (neighbours, ticks) else {
                times.push(start_s);
                inputs.push(mean);
                velocities.push(self.velocity[row]);
                continue;
            };
            let [before, after] = [self.input[before], self.input[row + 1]];
            let told = step(before, mean, after, ticks as usize);
            let added: Vec<f64> = told.iter().map(|_| draw.next(noise)).collect();
            let drift = added.iter().sum::<f64>() / ticks;
            for (tick, (told, added)) in told.iter().zip(added).enumerate() {
                times.push(start_s + (end_s - start_s) * tick as f64 / ticks);
                inputs.push(told + added - drift);
                velocities.push(self.velocity[row]);
            }
        }
        self.largest_input = largest(&inputs);
        (self.input_time, self.input, self.velocity) = (times, inputs, velocities);
        self.torque_profiles = TorqueProfiles::default();
    }
}

/// The step from `before` to `after` whose mean over the ticks is `mean`; where there is none, that mean.
fn step(before: f64, mean: f64, after: f64, ticks: usize) -> Vec<f64> {
    let share = (after - mean) / (after - before);
    let tick = |tick: usize| {
        let still = (share * ticks as f64 - tick as f64).clamp(0.0, 1.0);
        still * before + (1.0 - still) * after
    };
    if share > 0.0 && share < 1.0 {
        (0..ticks).map(tick).collect()
    } else {
        vec![mean; ticks]
    }
}

/// Standard deviation of what a loop makes of the noise of its sensor from one period to the next: the low-pass leaves
/// a²·2/(2 − a) of the variance of white noise in the differences of what it passes, a being its gain.
fn told_noise(pid: &Pid, sensor_noise: f64) -> f64 {
    let gain = low_pass_gain(pid.position_cutoff_hz, pid.period);
    sensor_noise * gain * (2.0 / (2.0 - gain)).sqrt() * pid.kd.abs() / pid.period
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::TAU;

    #[test]
    fn a_step_inside_a_row_is_put_where_its_mean_says() {
        assert_eq!(step(0.0, 6.0, 8.0, 4), [0.0, 8.0, 8.0, 8.0]);
        assert_eq!(step(1.0, 1.25, 2.0, 2), [1.0, 1.5]);
        assert_eq!(step(1.0, 3.0, 2.0, 2), [3.0, 3.0]);
    }

    #[test]
    fn the_law_makes_noise_of_noise() {
        let pid = Pid {
            kp: 1.0,
            ki: 0.0,
            kd: 0.01,
            period: 1e-3,
            position_cutoff_hz: Some(50.0),
        };
        let mut draw = Noise::new(1);
        let (mut passed, mut squares) = (0.0, 0.0);
        let count = 100_000;
        for _ in 0..count {
            let before = passed;
            passed += TAU * 0.05 * (draw.next(0.1) - passed);
            squares += (pid.kd * (passed - before) / pid.period).powi(2);
        }
        let seen = (squares / f64::from(count)).sqrt();
        let said = told_noise(&pid, 0.1);
        assert!((seen / said - 1.0).abs() < 0.01, "{seen} {said}");
    }
}
