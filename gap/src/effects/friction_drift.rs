//! Coulomb friction that changes over time.

use super::coulomb::Coulomb;
use super::identification::Identification;
use super::phrase::{Found, Phrase};
use crate::guess::Evidence;
use crate::guess::regression::{Moment, moments, regress, regress_in};
use crate::guess::sliding::{best_explaining, friction_nm, has_coulomb_friction};
use crate::guess::start::{guessed, linear, log, term, terms};
use crate::missing_torque::axis::Axis;
use crate::missing_torque::form::{Form, with_defaults};
use crate::missing_torque::path::Path;
use crate::missing_torque::target::Target;
use crate::term::Term;
use host_sim::effects::Kind;
use host_sim::effects::friction_drift::KIND;

/// Time constants of a settling friction, over the duration of the recording.
const SETTLINGS: [f64; 2] = [0.15, 0.5];
/// Indices of the parameters `anew` and `settled`.
const ANEW: usize = 2;
const SETTLED: usize = 3;
/// Indices of the parameters `step` and `step_at`, and the number of instants at which a step is tried.
const STEP: usize = 4;
const STEP_AT: usize = 5;
const STEPS: usize = 48;
/// Time constants and instants of a step that are screened for the missing torque, as shares of the session.
const SETTLINGS_SCREENED: [f64; 2] = [0.2, 0.5];
const STEPS_SCREENED: [f64; 13] = [
    0.15, 0.21, 0.27, 0.33, 0.39, 0.45, 0.51, 0.57, 0.63, 0.69, 0.75, 0.81, 0.87,
];

#[derive(Debug)]
pub(super) struct FrictionDrift;

impl Identification for FrictionDrift {
    fn kind(&self) -> &'static Kind {
        &KIND
    }

    /// Starts of a friction that changes linearly, settles as the device warms up, or steps. The change refers to the session, or to each
    /// run if the clock restarts in each run. A single run does not distinguish the two. Then the change is assumed to refer to the run,
    /// so that no other run is extrapolated beyond the recorded time.
    fn starts(&self, e: &Evidence<'_>) -> Vec<Term> {
        if !has_coulomb_friction(e) {
            return Vec::new();
        }
        let starts = e.series.iter().map(|series| series.session(0));
        let start_s = starts.min_by(f64::total_cmp).unwrap_or(0.0);
        let session = drifts_since(e, |m| m.session_s - start_s);
        if e.series.iter().all(|series| series.run == e.series[0].run) {
            return session.into_iter().map(restarted_per_run).collect();
        }
        let starts_anew = e.series.iter().any(|series| series.session_offset_s != 0.0);
        let runs = starts_anew.then(|| drifts_since(e, |m| m.run_s));
        let runs = runs.into_iter().flatten().map(restarted_per_run);
        session.into_iter().chain(runs).collect()
    }

    fn special_cases(&self) -> &'static [&'static dyn Identification] {
        &[&Coulomb]
    }

    fn axis(&self) -> Axis {
        Axis::Time
    }

    fn torque_forms(&self, path: &Path<'_>, target: &Target<'_>) -> Vec<Form> {
        if path.friction_level() == 0.0 {
            return Vec::new();
        }
        let [from_s, to_s] = path.scale.session_s;
        let lasts_s = (to_s - from_s).max(f64::MIN_POSITIVE);
        let linear = |base: &[(usize, f64)], step: (usize, f64)| {
            Form::linear(path, &KIND, &with_defaults(&KIND, base), &[step])
        };
        let steady = [(0, 0.0), (1, 0.0), (SETTLED, 0.0)];
        let mut forms = vec![linear(&steady, (0, 0.3 / lasts_s))];
        for part in SETTLINGS_SCREENED {
            for settled in [0.0, 1.0] {
                let base = [(0, 0.0), (1, part * lasts_s), (SETTLED, settled)];
                forms.push(linear(&base, (0, 0.3 / (part * lasts_s))).searched(1));
            }
        }
        for part in STEPS_SCREENED {
            let base = [(0, 0.0), (1, 0.0), (STEP_AT, from_s + part * lasts_s)];
            forms.push(linear(&base, (STEP, 0.3)).searched(1));
        }
        target.screened(forms, 3)
    }

    fn noun(&self) -> &'static str {
        "drifting friction"
    }

    fn tell_apart(&self) -> &'static str {
        "The friction of the same motion changes from minute to minute. Another level of dry friction is constant. Repeat the same motion at the start and at the end of a session."
    }

    fn template(&self, found: &Found<'_>) -> &'static str {
        match (found.fitted("step"), found.fitted("step_at")) {
            (Some(_), Some(_)) => "dry friction that steps by {step} at {step_at}",
            // The instant lies between two runs, so it is unknown.
            (Some(_), None) => "dry friction that steps by {step} between two runs",
            (None, _) => "dry friction that changes by {rate}",
        }
    }

    fn phrase(&self, found: &Found<'_>) -> Phrase {
        let once = found.filled(self.template(found));
        let is_anew = found.value("anew") == Some(1.0) && found.nominal.has_runs;
        match once {
            Some(once) if is_anew => once.then(" in every run"),
            Some(once) => once,
            None => Phrase::of(self.noun()),
        }
    }
}

/// The drift, restarted in every run.
fn restarted_per_run(drift: Term) -> Term {
    drift.starting_at(&[(ANEW, 1.0)])
}

fn drifts_since(e: &Evidence<'_>, since_s: impl Fn(&Moment) -> f64) -> Vec<Term> {
    let duration_s = e.scales.duration_s;
    // A constant change of the level is another effect. It is fitted too, so that it does not distort the drift.
    let guess = regress(e, |m| {
        let friction = friction_nm(e, m);
        [friction * since_s(m), friction]
    });
    let guess = guess.map(|[rate, _]| vec![guessed(0, rate, 0.3 / duration_s)]);
    let settling = |share: f64| {
        let settling_s = share * duration_s;
        let found = regress(e, |m| {
            let friction = friction_nm(e, m);
            [friction * -(-since_s(m) / settling_s).exp_m1(), friction]
        });
        let [all, _] = found?;
        let free = vec![
            linear(0, all / settling_s, 0.5 / settling_s),
            log(1, settling_s),
        ];
        Some([0.0, 1.0].map(|settled| term(&KIND, free.clone(), &[(SETTLED, settled)])))
    };
    let settling = SETTLINGS.into_iter().filter_map(settling).flatten();
    let steady = |f: f64| vec![linear(0, f / duration_s, 0.5 / duration_s)];
    let steady = terms(&KIND, guess, [0.3, -0.3].map(steady));
    let stepping = step(e, &since_s);
    steady.into_iter().chain(settling).chain(stepping).collect()
}

/// A step of the level at the instant at which it explains most.
fn step(e: &Evidence<'_>, since_s: impl Fn(&Moment) -> f64) -> Option<Term> {
    let spacing_s = e.scales.duration_s / STEPS as f64;
    let instants = (1..STEPS).map(|k| k as f64 * spacing_s);
    let tried = instants.filter_map(|at_s| {
        let found = regress_in(moments(e), |m| {
            let friction = friction_nm(e, m);
            [friction * f64::from(since_s(m) >= at_s), friction]
        });
        let ([step, _], explained) = found?;
        let free = vec![linear(STEP, step, 0.3), linear(STEP_AT, at_s, spacing_s)];
        Some((explained, term(&KIND, free, &[(0, 0.0)])))
    });
    best_explaining(tried)
}
