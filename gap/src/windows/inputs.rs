//! Inputs averaged over intervals of time, with the input values that each mean is made of.

use host_sim::drive::Drive;

/// Mean inputs, each held from an instant to the next.
#[derive(Clone, Debug, Default)]
pub(crate) struct Inputs {
    /// Instant from which on each mean input is held, in the time of the run, s.
    pub time: Vec<f64>,
    mean: Vec<f64>,
    /// The input values of all means, one after the other, and the end index of each mean.
    parts: Vec<Part>,
    ends: Vec<usize>,
}

/// One input value of a mean, with its share of the interval.
#[derive(Clone, Copy, Debug)]
struct Part {
    input: f64,
    velocity: f64,
    share: f64,
}

impl Inputs {
    /// Averages inputs between consecutive `instants_s`. Each input is held from its time to the next, and the last one indefinitely. The
    /// first instant must not be before the first time. `velocity` is the measured velocity at each input.
    pub(crate) fn between(
        instants_s: &[f64],
        time: &[f64],
        input: &[f64],
        velocity: &[f64],
    ) -> Self {
        let mut all = Self::default();
        let mut row = 0;
        for ends in instants_s.windows(2) {
            let [start_s, end_s] = [ends[0], ends[1]];
            if end_s <= start_s {
                continue;
            }
            let until_s = |row: usize| time.get(row + 1).copied().unwrap_or(f64::INFINITY);
            while until_s(row) <= start_s {
                row += 1;
            }
            let mut now_s = start_s;
            let mut mean = 0.0;
            while now_s < end_s {
                let to_s = until_s(row).min(end_s);
                let part = Part {
                    input: input[row],
                    velocity: velocity[row],
                    share: (to_s - now_s) / (end_s - start_s),
                };
                mean += part.share * part.input;
                all.parts.push(part);
                now_s = to_s;
                row += usize::from(until_s(row) <= now_s);
            }
            all.time.push(start_s);
            all.mean.push(mean);
            all.ends.push(all.parts.len());
        }
        all
    }

    /// Inputs that were sampled at given times and follow straight lines in between. Each line is divided into `parts` intervals of equal
    /// length, which hold the mean of the line. `velocity` is the measured velocity at each sample.
    pub(crate) fn along(time: &[f64], input: &[f64], velocity: &[f64], parts: usize) -> Self {
        let mut all = Self::default();
        for (row, &start_s) in time.iter().enumerate() {
            let end_s = time.get(row + 1).copied().unwrap_or(start_s);
            let end = input.get(row + 1).copied().unwrap_or(input[row]);
            let parts = if end_s > start_s { parts } else { 1 };
            for part in 0..parts {
                let share = part as f64 / parts as f64;
                let middle = share + 0.5 / parts as f64;
                let mean = input[row] + middle * (end - input[row]);
                all.time.push(start_s + share * (end_s - start_s));
                all.mean.push(mean);
                all.parts.push(Part {
                    input: mean,
                    velocity: velocity[row],
                    share: 1.0,
                });
                all.ends.push(all.parts.len());
            }
        }
        all
    }

    /// The mean inputs.
    pub(crate) fn means(self) -> Vec<f64> {
        self.mean
    }

    fn start(&self, i: usize) -> usize {
        i.checked_sub(1).map_or(0, |before| self.ends[before])
    }

    /// Steady torque of a drive for mean input `i`, after delay and lags, N m. It is the mean of the torques of the single input values,
    /// because a limit or a dead band is nonlinear.
    #[inline]
    pub(crate) fn settled_nm(&self, drive: &Drive, is_linear: bool, i: usize) -> f64 {
        if is_linear {
            return drive.ratio * self.mean[i];
        }
        let parts = self.parts[self.start(i)..self.ends[i]].iter();
        parts
            .map(|part| part.share * drive.settled_at(part.input, part.velocity))
            .sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use host_sim::device::Device;
    use recording::Model;

    #[test]
    fn inputs_are_averaged_by_their_duration() {
        let (time, input) = ([0.0, 1.0, 2.0, 3.0], [4.0, 0.0, -8.0, 2.0]);
        let inputs = Inputs::between(&[0.5, 2.5, 2.5, 4.0, 5.0], &time, &input, &[0.0; 4]);
        assert_eq!(inputs.time, [0.5, 2.5, 4.0]);
        let limited = Model {
            input_limit: Some(2.0),
            ..Model::new(1.0)
        };
        let drive = Device::nominal(&limited).drive;
        let settled = |inputs: &Inputs, is_linear, i| inputs.settled_nm(&drive, is_linear, i);
        let means = [(4.0 * 0.5 - 8.0 * 0.5) / 2.0, (-8.0 * 0.5 + 2.0) / 1.5, 2.0];
        let limited = [0.0, (-2.0 * 0.5 + 2.0) / 1.5, 2.0];
        for i in 0..3 {
            assert!((settled(&inputs, true, i) - drive.ratio * means[i]).abs() < 1e-12);
            assert!((settled(&inputs, false, i) - drive.ratio * limited[i]).abs() < 1e-12);
        }
        let line = Inputs::along(&time[..2], &input[..2], &[0.0; 2], 2);
        assert_eq!(
            (line.time, line.mean),
            (vec![0.0, 0.5, 1.0], vec![3.0, 1.0, 0.0])
        );
    }
}
