//! What drives make of the recorded input.

use super::series::{MOST_SAMPLES, Series};
use super::torque_profiles::{Stretch, Stretches, WindowTorque};
use super::window::Window;
use host_sim::decay::Decay;
use host_sim::drive::{Drive, Slew};
use host_sim::plant::{Cascade, Course, Torque};
use std::cell::RefCell;

/// The torque that one drive makes of the recorded input, window by window.
pub(crate) struct DriveResponse<'a> {
    /// What their torque is to be multiplied by: drives that differ in nothing else share them.
    pub(crate) gain: f64,
    /// With a ratio of ±1.
    drive: Drive,
    series: &'a Series,
    /// Windows of a stretch: what a drive remembers is gone through once for all of them.
    stretch: usize,
    kept: Option<Stretches>,
    /// The stretch that was looked at last, where none is kept that fits.
    last: RefCell<Option<(usize, Stretch)>>,
}

impl<'a> DriveResponse<'a> {
    pub(crate) fn new(drive: &Drive, series: &'a Series) -> Self {
        let gain = drive.ratio.abs();
        let drive = Drive {
            ratio: drive.ratio.signum(),
            ..drive.clone()
        };
        let windows = series.windows.len();
        let stretch = (drive.memory_s() / series.window_s()).ceil();
        let stretch = (stretch as usize).clamp(1, windows.max(1));
        let keeps = series.time.len() <= MOST_SAMPLES;
        let stretches = windows.div_ceil(stretch);
        Self {
            gain,
            series,
            stretch,
            kept: keeps.then(|| series.torque_profiles.under(&drive, stretches)),
            drive,
            last: RefCell::new(None),
        }
    }

    /// Looks at the torque profile of a window.
    #[inline]
    pub(crate) fn in_window<T>(&self, index: usize, look: impl FnOnce(&WindowTorque) -> T) -> T {
        let window = &self.series.windows[index];
        let fits = |course: &&WindowTorque| {
            course.restart_s == window.restart.time_s && course.samples == window.samples
        };
        let place = index / self.stretch;
        let within = index % self.stretch;
        if let Some(kept) = &self.kept {
            let stretch = kept[place].get_or_init(|| self.profiles(place));
            if let Some(course) = stretch.get(within).filter(fits) {
                return look(course);
            }
        }
        let mut last = self.last.borrow_mut();
        let (_, stretch) = match last.take().filter(|(at, _)| *at == place) {
            Some(same) => last.insert(same),
            None => last.insert((place, self.profiles(place))),
        };
        look(&stretch[within])
    }

    /// Those of a stretch.
    fn profiles(&self, place: usize) -> Stretch {
        let Self { drive, series, .. } = self;
        let first = place * self.stretch;
        let end = series.windows.len().min(first + self.stretch);
        let start_s = series.windows[0].restart.time_s;
        let mut listener = Listener::from(start_s, drive, series);
        let before = first.checked_sub(1).map(|before| &series.windows[before]);
        let left_s = before.map_or(start_s, |before| series.time[before.samples.end - 1]);
        listener.skip_to(left_s);
        let windows = series.windows[first..end].iter();
        windows.map(|window| listener.course(window)).collect()
    }
}

/// A drive that is told what a series says.
struct Listener<'a> {
    drive: &'a Drive,
    is_linear: bool,
    series: &'a Series,
    times: &'a [f64],
    /// From when on the first input has been told for ever, s.
    start_s: f64,
    slew: Option<Slew>,
    line: Line,
    now_s: f64,
    next: usize,
}

/// What becomes of what a drive is told once its delay has passed.
enum Line {
    /// It acts at once, N m.
    Instant(f64),
    /// It relaxes to what it is told, N m.
    Lagging {
        acting_nm: f64,
        target_nm: f64,
        decay: Decay,
    },
    /// Likewise through one lag behind another.
    Cascading {
        cascade: Cascade,
        decays: [Decay; 2],
    },
}

/// What acts for a while, with the decay of each lag over that.
enum Piece {
    /// N m.
    Held(f64),
    Relaxing(Torque, f64),
    Cascading(Cascade, [f64; 2]),
}

impl<'a> Listener<'a> {
    /// From an instant on, at which it is told the first input, which may lie a little later: before, nothing, or where the series
    /// goes on with what was told before, the same.
    fn from(start_s: f64, drive: &'a Drive, series: &'a Series) -> Self {
        let told = series.told.as_ref();
        let mut listener = Self {
            drive,
            is_linear: drive.is_linear(series.largest_input),
            series,
            times: told.map_or(&series.input_time, |told| &told.time),
            start_s,
            slew: Slew::at_rest(drive),
            line: Line::Instant(0.0),
            now_s: start_s,
            next: 0,
        };
        let before_nm = if series.goes_on {
            listener.settled_nm()
        } else {
            0.0
        };
        if let Some(slew) = &mut listener.slew {
            slew.stand_at(before_nm);
        }
        listener.line = if drive.further_lag_s > 0.0 {
            let lags_s = [drive.lag_s, drive.further_lag_s];
            Line::Cascading {
                cascade: Cascade::at_rest(before_nm, lags_s),
                decays: [Decay::default(); 2],
            }
        } else if drive.lag_s > 0.0 {
            Line::Lagging {
                acting_nm: before_nm,
                target_nm: before_nm,
                decay: Decay::default(),
            }
        } else {
            Line::Instant(before_nm)
        };
        listener
    }

    /// What comes of the next input once it is through, N m.
    #[inline(always)]
    fn settled_nm(&self) -> f64 {
        let Self { drive, series, .. } = self;
        match &series.told {
            Some(told) => told.settled_nm(drive, self.is_linear, self.next),
            None => drive.settled_at(series.input[self.next], series.velocity[self.next]),
        }
    }

    /// Takes the next input, which has come through the delay by now.
    #[inline(always)]
    fn take(&mut self) {
        let mut settled_nm = self.settled_nm();
        if let Some(slew) = &mut self.slew {
            let told_s = |place: usize| self.times.get(place).copied();
            let now_s = told_s(self.next).unwrap_or(self.start_s);
            let end_s = told_s(self.next + 1).unwrap_or(now_s + self.series.period_s);
            settled_nm = slew.mean_towards(settled_nm, now_s, end_s);
        }
        match &mut self.line {
            Line::Instant(acting_nm) => *acting_nm = settled_nm,
            Line::Lagging { target_nm, .. } => *target_nm = settled_nm,
            Line::Cascading { cascade, .. } => cascade.target_nm = settled_nm,
        }
        self.next += 1;
    }

    /// When the next input comes through the delay, s.
    #[inline(always)]
    fn arrival_s(&self) -> f64 {
        let Some(&told_s) = self.times.get(self.next) else {
            return f64::INFINITY;
        };
        let known_s = if self.next == 0 {
            told_s.min(self.start_s)
        } else {
            told_s
        };
        known_s + self.drive.delay_s
    }

    /// Takes all that has come by now.
    #[inline(always)]
    fn listen(&mut self) {
        // Within rounding of now is now: pieces must not become empty.
        while self.arrival_s() <= self.now_s + rounding_s(self.now_s) {
            self.take();
        }
    }

    /// Lets it run on to `to_s` of the run with nothing to drive.
    fn skip_to(&mut self, to_s: f64) {
        // What it was told before the last that it still remembers makes no difference.
        let forgotten_s = to_s - self.drive.memory_s();
        let told = self.times.partition_point(|&at| at <= forgotten_s);
        if let Some(last) = told.checked_sub(1).filter(|&i| i > self.next) {
            self.next = last;
            self.now_s = self.arrival_s();
        }
        self.run_to(to_s, |_, _| {});
        self.listen();
    }

    /// The torque profile of a window, from the last sample before it on.
    fn course(&mut self, window: &Window) -> WindowTorque {
        let restart_s = window.restart.time_s;
        let samples = window.samples.clone();
        // What comes of the input falls between two samples where it is late.
        let pieces = 1 + usize::from(self.drive.delay_s > 0.0);
        let mut lead = Course::default();
        let mut steps = Course::with_room(samples.len(), pieces);
        self.step_through(&[restart_s], &mut lead);
        self.step_through(&self.series.time[samples.clone()], &mut steps);
        WindowTorque {
            restart_s,
            samples,
            lead,
            steps,
        }
    }

    /// Adds the steps to some instants of the run to a torque profile.
    fn step_through(&mut self, instants_s: &[f64], course: &mut Course) {
        for &to_s in instants_s {
            self.run_to(to_s, |piece, lasts_s| match piece {
                Piece::Held(torque_nm) => course.act(Torque::held(torque_nm), lasts_s),
                Piece::Relaxing(torque, decay) => course.relax(torque, lasts_s, decay),
                Piece::Cascading(cascade, decays) => {
                    course.relax_twice(&cascade, lasts_s, decays);
                }
            });
            course.close();
        }
    }

    /// Lets it run on to `to_s`: tells of each piece and for how long it acts.
    fn run_to(&mut self, to_s: f64, mut acts: impl FnMut(Piece, f64)) {
        let lag_s = self.drive.lag_s;
        loop {
            self.listen();
            let arrival_s = self.arrival_s();
            let comes_before = arrival_s < to_s - rounding_s(to_s);
            let until_s = if comes_before { arrival_s } else { to_s };
            if self.now_s < until_s {
                let lasts_s = until_s - self.now_s;
                let piece = match &mut self.line {
                    Line::Instant(acting_nm) => Piece::Held(*acting_nm),
                    Line::Lagging {
                        acting_nm,
                        target_nm,
                        decay,
                    } => {
                        let torque = Torque::relaxing(*acting_nm, *target_nm, lag_s);
                        let decay = decay.over(lasts_s, || -lag_s.recip());
                        (*acting_nm, _) = torque.end_and_mean(lasts_s, decay);
                        Piece::Relaxing(torque, decay)
                    }
                    Line::Cascading { cascade, decays } => {
                        let [first, second] = decays;
                        let [first_s, second_s] = cascade.lags_s();
                        let decays = [
                            first.over(lasts_s, || -first_s.recip()),
                            second.over(lasts_s, || -second_s.recip()),
                        ];
                        let from = *cascade;
                        *cascade = from.after(decays);
                        Piece::Cascading(from, decays)
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

/// What two ways to one instant may differ by, s.
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

    /// What a right model leaves of a device with some effects.
    fn left(effects: &[&str]) -> f64 {
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
    fn a_late_input_and_what_lags_behind_it_are_told_as_the_device_is_driven() {
        let at_once = left(&[]);
        for late in [
            &["delay:time=0.0037"][..],
            &["delay:time=0.005"],
            &["delay:time=0.0037", "lag:time=0.004"],
            &["delay:time=0.0037", "lag:time=0.004,twice=1"],
            &["lag:time=2e-6,twice=1"],
            &["rate_limit:rate=0.02"],
            &["rate_limit:rate=0.02", "lag:time=0.004"],
        ] {
            assert!(left(late) < 1.1 * at_once, "{late:?}");
        }
    }
}
