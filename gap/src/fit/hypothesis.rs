//! A hypothesis: the nominal model with additional effects, as a point in a space of few dimensions.

use crate::effects;
use crate::term::Term;
use host_sim::device::Device;
use recording::{Model, Recording};

/// Largest deviation of a model parameter from its stated value, in standard deviations.
const PRIOR_REACH: f64 = 5.0;

/// A parameter of the nominal model that is known only within a tolerance, or the unknown delay of the input of some runs.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PriorParameter {
    /// Name of the parameter in the model table, or [`INPUT_TIME`].
    pub name: String,
    /// The stated value. For [`INPUT_TIME`] it is the standard deviation of the delay, s, whose stated value is 0.
    pub value: f64,
    /// Standard deviation as a share of the value.
    pub relative: f64,
    /// True if the standard deviation is stated. Otherwise it is the typical error of such a parameter.
    pub is_stated: bool,
}

/// Name of the delay between input and position among the prior parameters.
pub(crate) const INPUT_TIME: &str = "input_time";

/// Deviation beyond which a parameter with a stated tolerance counts as an effect, in standard deviations.
pub(crate) const MOST_STATED_DEVIATIONS: f64 = 3.0;
/// Deviation beyond which a parameter without a stated tolerance counts as an effect, in multiples of the typical error of such a parameter.
const MOST_USUAL_DEVIATIONS: f64 = 1.0;

impl PriorParameter {
    /// True if a deviation from the stated value, in standard deviations, is so large that it counts as an effect.
    pub(crate) fn counts_as_effect(&self, deviations: f64) -> bool {
        let most = if self.is_stated {
            MOST_STATED_DEVIATIONS
        } else {
            MOST_USUAL_DEVIATIONS
        };
        deviations.abs() > most
    }

    /// The value of the parameter at a number of standard deviations from the stated one. Increases are exponential and decreases linear,
    /// since the tolerance may be relative to the nominal value or to the true one. The sign never changes.
    pub(crate) fn at(&self, deviations: f64) -> f64 {
        const LEAST: f64 = 0.01;
        let by = self.relative * deviations;
        let factor = if by > 0.0 { by.exp() } else { 1.0 + by };
        self.value * factor.max(LEAST)
    }
}

/// The prior parameters of a recording: each stated tolerance of a nonzero model parameter, and one input delay for all runs with the
/// same stated standard deviation.
pub(crate) fn priors(recording: &Recording) -> Vec<PriorParameter> {
    let stated = recording.tolerance.iter();
    let numbers = stated.filter_map(|(name, relative)| {
        let value = recording.model.get(name)?;
        (relative * value.abs() > 0.0).then(|| PriorParameter {
            name: name.to_owned(),
            value,
            relative,
            is_stated: true,
        })
    });
    numbers.chain(input_times(recording)).collect()
}

fn input_times(recording: &Recording) -> Vec<PriorParameter> {
    let mut stds_s: Vec<f64> = recording
        .runs
        .iter()
        .map(|run| run.input_time_std)
        .collect();
    stds_s.retain(|std_s| *std_s > 0.0);
    stds_s.sort_by(f64::total_cmp);
    stds_s.dedup();
    let times = stds_s.into_iter().map(|value| PriorParameter {
        name: INPUT_TIME.to_owned(),
        value,
        relative: 1.0,
        is_stated: true,
    });
    times.collect()
}

/// Additional delay of the input of each run at the coordinates `x`, s.
pub(crate) fn input_shifts_s(
    recording: &Recording,
    priors: &[PriorParameter],
    x: &[f64],
) -> Vec<f64> {
    let times = priors.iter().zip(x).filter(|(n, _)| n.name == INPUT_TIME);
    let times: Vec<(f64, f64)> = times.map(|(n, z)| (n.value, n.value * z)).collect();
    let of_run = |std_s: f64| times.iter().find(|(stated_s, _)| *stated_s == std_s);
    let runs = recording.runs.iter();
    runs.map(|run| of_run(run.input_time_std).map_or(0.0, |(_, shift_s)| *shift_s))
        .collect()
}

/// Additional delay of the input of all runs at the coordinates `x`, s. Returns `None` if the runs do not have one common delay.
pub(crate) fn common_input_shift_s(
    recording: &Recording,
    priors: &[PriorParameter],
    x: &[f64],
) -> Option<f64> {
    let std_s = recording.runs.first()?.input_time_std;
    let is_one = recording.runs.iter().all(|run| run.input_time_std == std_s);
    let shifts_s = input_shifts_s(recording, priors, x);
    (is_one && std_s > 0.0)
        .then(|| shifts_s.first().copied())
        .flatten()
}

/// Effects that are added to a nominal model whose parameters may deviate within their tolerances. The coordinates are those of the prior
/// parameters, in standard deviations, then those of the effects.
#[derive(Clone, Debug)]
pub(crate) struct Hypothesis {
    pub terms: Vec<Term>,
}

impl Hypothesis {
    pub(crate) fn dimensions(&self, priors: &[PriorParameter]) -> usize {
        priors.len() + self.free()
    }

    /// Lowest and highest value of each coordinate.
    pub(crate) fn reaches(&self, priors: &[PriorParameter]) -> Vec<[f64; 2]> {
        let numbers = priors.iter().map(|_| [-PRIOR_REACH, PRIOR_REACH]);
        let terms = self.terms.iter().flat_map(|term| {
            let free = term.free.iter();
            free.map(|c| c.reach(term.kind.parameter(c.parameter)))
        });
        numbers.chain(terms).collect()
    }

    /// True if an effect sets the model parameter `number`, whose own tolerance then has no influence.
    fn sets(&self, number: &str) -> bool {
        let mut terms = self.terms.iter();
        terms.any(|term| effects::of(term.kind.name).sets_in_model() == Some(number))
    }

    /// Sorted names of the effects.
    pub(crate) fn names(&self) -> Vec<&'static str> {
        let mut names: Vec<_> = self.terms.iter().map(|term| term.kind.name).collect();
        names.sort_unstable();
        names
    }

    /// Number of coordinates of the effects.
    pub(crate) fn free(&self) -> usize {
        self.terms.iter().map(|t| t.free.len()).sum()
    }

    /// The model with its prior parameters at the coordinates `x`.
    pub(crate) fn at_priors(&self, model: &Model, priors: &[PriorParameter], x: &[f64]) -> Model {
        let mut model = *model;
        for (prior, z) in priors.iter().zip(x).filter(|(n, _)| !self.sets(&n.name)) {
            let _ = model.set(&prior.name, prior.at(*z));
        }
        model
    }

    /// Each effect with its part of the coordinates `x`, or of any list with one value per coordinate.
    pub(crate) fn parts<'a>(&'a self, x: &'a [f64]) -> impl Iterator<Item = (&'a Term, &'a [f64])> {
        let mut remaining = &x[x.len() - self.free()..];
        self.terms.iter().map(move |term| {
            let (own, others) = remaining.split_at(term.free.len());
            remaining = others;
            (term, own)
        })
    }

    /// The hypothesis with its effects started at the coordinates `x`, and the coordinates of that point.
    pub(crate) fn moved(&self, x: &[f64]) -> (Self, Vec<f64>) {
        let terms = self.parts(x).map(|(term, own)| term.moved(own));
        let terms = terms.collect();
        let held = x.len() - self.free();
        let mut coordinates = vec![0.0; x.len()];
        coordinates[..held].copy_from_slice(&x[..held]);
        (Self { terms }, coordinates)
    }

    /// Intervals in which the effect of a coordinate acts at the coordinates `x`, s of the session. Returns `None` if it always acts.
    pub(crate) fn meanwhile(&self, x: &[f64], coordinate: usize) -> Option<Vec<[f64; 2]>> {
        let place = coordinate.checked_sub(x.len() - self.free())?;
        let mut end = 0;
        let mut parts = self.parts(x);
        let (term, own) = parts.find(|(_, own)| {
            end += own.len();
            place < end
        })?;
        term.kind.meanwhile(&term.at(own))
    }

    pub(crate) fn device(&self, model: &Model, priors: &[PriorParameter], x: &[f64]) -> Device {
        let mut device = Device::nominal(&self.at_priors(model, priors, x));
        for (term, own) in self.parts(x) {
            device.sensor_on_load = term.sensor_on_load;
            term.kind.install(&mut device, &term.at(own));
        }
        device
    }
}
