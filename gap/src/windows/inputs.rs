//! Inputs put together over stretches of time: their means, and of what these are made.

use host_sim::drive::Drive;

/// Inputs, each held from an instant on to the next.
#[derive(Clone, Debug, Default)]
pub(crate) struct Inputs {
    /// s, in the run's own time.
    pub time: Vec<f64>,
    mean: Vec<f64>,
    /// Those that each is the mean of, one after the other, and one past the last of each.
    parts: Vec<Part>,
    ends: Vec<usize>,
}

/// One of the inputs that are put together, and its share of the time.
#[derive(Clone, Copy, Debug)]
struct Part {
    input: f64,
    velocity: f64,
    share: f64,
}

impl Inputs {
    /// Inputs that are held from some times on, the last for ever, put together between instants, the first of which is not
    /// before the first of them; with the measured velocity at each.
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

    /// Inputs that were sampled at some times and go in straight lines from one to the next, the last for ever: the means of so many
    /// equal parts of the time between, with the measured velocity at each.
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

    /// One each.
    pub(crate) fn means(self) -> Vec<f64> {
        self.mean
    }

    fn start(&self, i: usize) -> usize {
        i.checked_sub(1).map_or(0, |before| self.ends[before])
    }

    /// Torque that a drive makes of one of them once delay and lag have passed, N m: the mean of what it makes of each part, as
    /// a limit or a dead band of the mean would be something else.
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
    fn inputs_are_put_together_by_how_long_they_are_held() {
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
