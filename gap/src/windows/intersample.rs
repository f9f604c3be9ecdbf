//! Reconstructs the output of a control loop between the rows of a slower log, whose input column holds only the means.

use super::series::{Series, largest};
use super::torque_profiles::TorqueProfiles;
use host_sim::sensors::Noise;
use recording::{Pid, low_pass_gain};

/// Largest number of loop periods per row.
const MOST_PERIODS: f64 = 32.0;
const SEED: u64 = 0x6c6f_6f70;

impl Series {
    /// Replaces the mean input of each row by one possible output of the loop within the row, with the same mean. If the mean lies
    /// between those of the neighbouring rows, the output is a step from one to the other; otherwise it is constant. The response of the
    /// loop to its sensor noise is added.
    ///
    /// Inputs that were sampled at instants are not means and stay unchanged.
    pub(crate) fn resample_inputs(&mut self, pid: &Pid, sensor_noise: f64) {
        if self.fine_input.is_some() {
            return;
        }
        let noise = output_noise(pid, sensor_noise);
        let mut draw = Noise::new(SEED);
        let (mut times, mut inputs, mut velocities) = (Vec::new(), Vec::new(), Vec::new());
        for row in 0..self.input.len() {
            let [start_s, mean] = [self.input_time[row], self.input[row]];
            let neighbours = row.checked_sub(1).zip(self.input_time.get(row + 1));
            let periods = |end_s: f64| ((end_s - start_s) / pid.period).round().min(MOST_PERIODS);
            let periods = neighbours.map(|(_, end_s)| periods(*end_s));
            let (Some((before, end_s)), Some(periods @ 2.0..)) = (neighbours, periods) else {
                times.push(start_s);
                inputs.push(mean);
                velocities.push(self.velocity[row]);
                continue;
            };
            let [before, after] = [self.input[before], self.input[row + 1]];
            let output = step(before, mean, after, periods as usize);
            let added: Vec<f64> = output.iter().map(|_| draw.next(noise)).collect();
            let added_mean = added.iter().sum::<f64>() / periods;
            for (period, (output, added)) in output.iter().zip(added).enumerate() {
                times.push(start_s + (end_s - start_s) * period as f64 / periods);
                inputs.push(output + added - added_mean);
                velocities.push(self.velocity[row]);
            }
        }
        self.largest_input = largest(&inputs);
        (self.input_time, self.input, self.velocity) = (times, inputs, velocities);
        self.torque_profiles = TorqueProfiles::default();
    }
}

/// The step from `before` to `after` whose mean over the loop periods is `mean`, or a constant output if no step has that mean.
fn step(before: f64, mean: f64, after: f64, periods: usize) -> Vec<f64> {
    let share = (after - mean) / (after - before);
    let period = |period: usize| {
        let before_share = (share * periods as f64 - period as f64).clamp(0.0, 1.0);
        before_share * before + (1.0 - before_share) * after
    };
    if share > 0.0 && share < 1.0 {
        (0..periods).map(period).collect()
    } else {
        vec![mean; periods]
    }
}

/// Standard deviation of the loop output that the sensor noise causes, from one period to the next. A low-pass of gain a passes a²·2/(2 −
/// a) of the variance of white noise into the differences of its output.
fn output_noise(pid: &Pid, sensor_noise: f64) -> f64 {
    let gain = low_pass_gain(pid.position_cutoff_hz, pid.period);
    sensor_noise * gain * (2.0 / (2.0 - gain)).sqrt() * pid.kd.abs() / pid.period
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::TAU;

    #[test]
    fn the_mean_of_a_row_determines_the_instant_of_its_step() {
        assert_eq!(step(0.0, 6.0, 8.0, 4), [0.0, 8.0, 8.0, 8.0]);
        assert_eq!(step(1.0, 1.25, 2.0, 2), [1.0, 1.5]);
        assert_eq!(step(1.0, 3.0, 2.0, 2), [3.0, 3.0]);
    }

    #[test]
    fn the_output_noise_agrees_with_a_simulated_loop() {
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
        let said = output_noise(&pid, 0.1);
        assert!((seen / said - 1.0).abs() < 0.01, "{seen} {said}");
    }
}
