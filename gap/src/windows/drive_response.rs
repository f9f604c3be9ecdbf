//! The torque that a drive produces from the recorded input.

use super::series::{MOST_SAMPLES, Series};
use super::torque_profiles::{Block, Blocks, WindowTorque};
use super::window::Window;
use host_sim::decay::Decay;
use host_sim::drive::{Drive, Slew};
use host_sim::plant::{Cascade, Torque, TorqueProfile};
use std::cell::RefCell;

/// The torque of one drive for the recorded input, window by window.
pub(crate) struct DriveResponse<'a> {
    /// Factor of the torque, the magnitude of the ratio. Drives that differ only in this factor share their profiles.
    pub(crate) gain: f64,
    /// The drive with a ratio of ±1.
    drive: Drive,
    series: &'a Series,
    /// Number of windows in a block. The response of the drive to the inputs before a block is computed once for the whole block.
    windows_per_block: usize,
    kept: Option<Blocks>,
    /// The last block that was computed and is not kept.
    last: RefCell<Option<(usize, Block)>>,
}

impl<'a> DriveResponse<'a> {
    pub(crate) fn new(drive: &Drive, series: &'a Series) -> Self {
        let gain = drive.ratio.abs();
        let drive = Drive {
            ratio: drive.ratio.signum(),
            ..drive.clone()
        };
        let windows = series.windows.len();
        let block = (drive.memory_s() / series.window_s()).ceil();
        let block = (block as usize).clamp(1, windows.max(1));
        let keeps = series.time.len() <= MOST_SAMPLES;
        let blocks = windows.div_ceil(block);
        Self {
            gain,
            series,
            windows_per_block: block,
            kept: keeps.then(|| series.torque_profiles.under(&drive, blocks)),
            drive,
            last: RefCell::new(None),
        }
    }

    /// Calls `read` with the torque profile of a window.
    #[inline]
    pub(crate) fn in_window<T>(&self, index: usize, read: impl FnOnce(&WindowTorque) -> T) -> T {
        let window = &self.series.windows[index];
        let fits = |profile: &&WindowTorque| {
            profile.restart_s == window.restart.time_s && profile.samples == window.samples
        };
        let place = index / self.windows_per_block;
        let within = index % self.windows_per_block;
        if let Some(kept) = &self.kept {
            let block = kept[place].get_or_init(|| self.profiles(place));
            if let Some(profile) = block.get(within).filter(fits) {
                return read(profile);
            }
        }
        let mut last = self.last.borrow_mut();
        let (_, block) = match last.take().filter(|(at, _)| *at == place) {
            Some(same) => last.insert(same),
            None => last.insert((place, self.profiles(place))),
        };
        read(&block[within])
    }

    /// The torque profiles of a block of windows.
    fn profiles(&self, place: usize) -> Block {
        let Self { drive, series, .. } = self;
        let first = place * self.windows_per_block;
        let end = series.windows.len().min(first + self.windows_per_block);
        let start_s = series.windows[0].restart.time_s;
        let mut replay = DriveReplay::from(start_s, drive, series);
        let before = first.checked_sub(1).map(|before| &series.windows[before]);
        let left_s = before.map_or(start_s, |before| series.time[before.samples.end - 1]);
        replay.skip_to(left_s);
        let windows = series.windows[first..end].iter();
        windows.map(|window| replay.profile(window)).collect()
    }
}

/// A drive that receives the recorded inputs of a series.
struct DriveReplay<'a> {
    drive: &'a Drive,
    is_linear: bool,
    series: &'a Series,
    times: &'a [f64],
    /// Instant at which the first input applies, even if its own time is a little later, s.
    start_s: f64,
    slew: Option<Slew>,
    line: LagState,
    now_s: f64,
    next: usize,
}

/// State of the drive behind its delay.
enum LagState {
    /// A drive without a lag: the acting torque, N m.
    Instant(f64),
    /// A drive with one lag: the torque relaxes to its target.
    Lagging {
        acting_nm: f64,
        target_nm: f64,
        decay: Decay,
    },
    /// A drive with two lags in series.
    Cascading {
        cascade: Cascade,
        decays: [Decay; 2],
    },
}

/// The torque during one step, with the decay of each lag over the step.
enum Step {
    /// A constant torque, N m.
    Held(f64),
    Relaxing(Torque, f64),
    Cascading(Cascade, [f64; 2]),
}

impl<'a> DriveReplay<'a> {
    /// Starts at an instant, at which the first input applies even if it lies a little later. Before that the input is zero, or equal to
    /// the first input if the series continues another one.
    fn from(start_s: f64, drive: &'a Drive, series: &'a Series) -> Self {
        let fine_input = series.fine_input.as_ref();
        let mut replay = Self {
            drive,
            is_linear: drive.is_linear(series.largest_input),
            series,
            times: fine_input.map_or(&series.input_time, |fine_input| &fine_input.time),
            start_s,
            slew: Slew::at_rest(drive),
            line: LagState::Instant(0.0),
            now_s: start_s,
            next: 0,
        };
        let before_nm = if series.continues {
            replay.settled_nm()
        } else {
            0.0
        };
        if let Some(slew) = &mut replay.slew {
            slew.stand_at(before_nm);
        }
        replay.line = if drive.further_lag_s > 0.0 {
            let lags_s = [drive.lag_s, drive.further_lag_s];
            LagState::Cascading {
                cascade: Cascade::at_rest(before_nm, lags_s),
                decays: [Decay::default(); 2],
            }
        } else if drive.lag_s > 0.0 {
            LagState::Lagging {
                acting_nm: before_nm,
                target_nm: before_nm,
                decay: Decay::default(),
            }
        } else {
            LagState::Instant(before_nm)
        };
        replay
    }

    /// Steady torque of the next input, after delay, rate limit and lags, N m.
    #[inline(always)]
    fn settled_nm(&self) -> f64 {
        let Self { drive, series, .. } = self;
        match &series.fine_input {
            Some(fine_input) => fine_input.settled_nm(drive, self.is_linear, self.next),
            None => drive.settled_at(series.input[self.next], series.velocity[self.next]),
        }
    }

    /// Applies the next input, whose delay has passed.
    #[inline(always)]
    fn apply_next(&mut self) {
        let mut settled_nm = self.settled_nm();
        if let Some(slew) = &mut self.slew {
            let sent_s = |place: usize| self.times.get(place).copied();
            let now_s = sent_s(self.next).unwrap_or(self.start_s);
            let end_s = sent_s(self.next + 1).unwrap_or(now_s + self.series.period_s);
            settled_nm = slew.mean_towards(settled_nm, now_s, end_s);
        }
        match &mut self.line {
            LagState::Instant(acting_nm) => *acting_nm = settled_nm,
            LagState::Lagging { target_nm, .. } => *target_nm = settled_nm,
            LagState::Cascading { cascade, .. } => cascade.target_nm = settled_nm,
        }
        self.next += 1;
    }

    /// Instant at which the delay of the next input has passed, s.
    #[inline(always)]
    fn arrival_s(&self) -> f64 {
        let Some(&sent_s) = self.times.get(self.next) else {
            return f64::INFINITY;
        };
        let known_s = if self.next == 0 {
            sent_s.min(self.start_s)
        } else {
            sent_s
        };
        known_s + self.drive.delay_s
    }

    /// Applies all inputs whose delay has passed.
    #[inline(always)]
    fn apply_arrived(&mut self) {
        // An arrival within the rounding error of the present instant counts, so that no step is empty.
        while self.arrival_s() <= self.now_s + rounding_s(self.now_s) {
            self.apply_next();
        }
    }

    /// Advances to `to_s` of the run without a torque profile.
    fn skip_to(&mut self, to_s: f64) {
        // Inputs before the last one that is older than the memory of the drive have no influence.
        let forgotten_s = to_s - self.drive.memory_s();
        let sent = self.times.partition_point(|&at| at <= forgotten_s);
        if let Some(last) = sent.checked_sub(1).filter(|&i| i > self.next) {
            self.next = last;
            self.now_s = self.arrival_s();
        }
        self.run_to(to_s, |_, _| {});
        self.apply_arrived();
    }

    /// The torque profile of a window, from the last sample before the window on.
    fn profile(&mut self, window: &Window) -> WindowTorque {
        let restart_s = window.restart.time_s;
        let samples = window.samples.clone();
        // With a delay, inputs arrive between two samples.
        let pieces = 1 + usize::from(self.drive.delay_s > 0.0);
        let mut lead = TorqueProfile::default();
        let mut steps = TorqueProfile::with_room(samples.len(), pieces);
        self.step_through(&[restart_s], &mut lead);
        self.step_through(&self.series.time[samples.clone()], &mut steps);
        WindowTorque {
            restart_s,
            samples,
            lead,
            steps,
        }
    }

    /// Adds the steps to the given instants of the run to a torque profile.
    fn step_through(&mut self, instants_s: &[f64], profile: &mut TorqueProfile) {
        for &to_s in instants_s {
            self.run_to(to_s, |piece, lasts_s| match piece {
                Step::Held(torque_nm) => profile.act(Torque::held(torque_nm), lasts_s),
                Step::Relaxing(torque, decay) => profile.relax(torque, lasts_s, decay),
                Step::Cascading(cascade, decays) => {
                    profile.relax_twice(&cascade, lasts_s, decays);
                }
            });
            profile.close();
        }
    }

    /// Advances to `to_s` and calls `acts` with each step and its duration, s.
    fn run_to(&mut self, to_s: f64, mut acts: impl FnMut(Step, f64)) {
        let lag_s = self.drive.lag_s;
        loop {
            self.apply_arrived();
            let arrival_s = self.arrival_s();
            let arrives_before = arrival_s < to_s - rounding_s(to_s);
            let until_s = if arrives_before { arrival_s } else { to_s };
            if self.now_s < until_s {
                let lasts_s = until_s - self.now_s;
                let piece = match &mut self.line {
                    LagState::Instant(acting_nm) => Step::Held(*acting_nm),
                    LagState::Lagging {
                        acting_nm,
                        target_nm,
                        decay,
                    } => {
                        let torque = Torque::relaxing(*acting_nm, *target_nm, lag_s);
                        let decay = decay.over(lasts_s, || -lag_s.recip());
                        (*acting_nm, _) = torque.end_and_mean(lasts_s, decay);
                        Step::Relaxing(torque, decay)
                    }
                    LagState::Cascading { cascade, decays } => {
                        let [first, second] = decays;
                        let [first_s, second_s] = cascade.lags_s();
                        let decays = [
                            first.over(lasts_s, || -first_s.recip()),
                            second.over(lasts_s, || -second_s.recip()),
                        ];
                        let from = *cascade;
                        *cascade = from.after(decays);
                        Step::Cascading(from, decays)
                    }
                };
                acts(piece, lasts_s);
                self.now_s = until_s;
            }
            if self.now_s >= to_s {
                return;
            }
        }
    }
}

/// Rounding error of an instant, s.
fn rounding_s(at_s: f64) -> f64 {
    f64::EPSILON * at_s.abs()
}

#[cfg(test)]
mod tests {
    use crate::made;
    use crate::predict::Predictor;
    use crate::windows::series;
    use crate::windows::statistics::rms;
    use host_sim::device::Device;
    use host_sim::effects::Effect;

    /// Rms error of the exact model on a device with some effects.
    fn rms_error(effects: &[&str]) -> f64 {
        let recording = made::recording(effects);
        let mut device = Device::nominal(&recording.model);
        for effect in effects {
            effect.parse::<Effect>().unwrap().install(&mut device);
        }
        let series = &series::coarse(&recording, recording.horizon)[0];
        let predicted = Predictor::new(device, &recording).predict(series);
        let missed = series.position.iter().zip(predicted);
        rms(&missed.map(|(seen, said)| seen - said).collect::<Vec<_>>())
    }

    #[test]
    fn the_exact_model_of_a_delayed_or_lagging_drive_predicts_as_well_as_one_without() {
        let without_delay = rms_error(&[]);
        for delayed in [
            &["delay:time=0.0037"][..],
            &["delay:time=0.005"],
            &["delay:time=0.0037", "lag:time=0.004"],
            &["delay:time=0.0037", "lag:time=0.004,twice=1"],
            &["lag:time=2e-6,twice=1"],
            &["rate_limit:rate=0.02"],
            &["rate_limit:rate=0.02", "lag:time=0.004"],
        ] {
            assert!(rms_error(delayed) < 1.1 * without_delay, "{delayed:?}");
        }
    }
}
