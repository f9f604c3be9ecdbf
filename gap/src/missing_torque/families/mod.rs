//! The torque of each effect along a motion: columns that explain a missing torque, one file a channel.
//!
//! An effect that acts on drive or mechanics is switched into the device, as a simulation does; the column is the torque
//! that this makes along the measured motion. What a sensor hides is worked out from the torque that the device itself
//! has there, never from the measured acceleration, which the missing torque contains.

mod actuation;
mod friction;
mod mechanics;
mod sensing;
mod surroundings;

use super::path::Path;
use super::ripple::Waves;
use host_sim::effects::{Kind, kind};
use nalgebra::{DMatrix, DVector};

/// One way in which an effect may act: a torque for a unit of each coefficient.
pub(crate) struct Form {
    /// Torque over each step, for a unit of each coefficient.
    pub torque: Vec<Vec<f64>>,
    /// What the sensor shows too much in each row, likewise; empty if it shows what is there.
    pub reading: Vec<Vec<f64>>,
    /// The effect's numbers, in the order of its kind, for some coefficients.
    pub values: Values,
    /// Numbers that were searched for beside the coefficients, as of a place or an instant.
    pub searched: usize,
    /// Whether it may show in so few moments that held-out time says nothing of it.
    pub seldom: bool,
    /// Whether its first coefficient must be above 0 to have a meaning.
    pub positive: bool,
}

/// Makes an effect's numbers of coefficients.
pub(crate) type Values = Box<dyn Fn(&[f64]) -> Vec<f64> + Send + Sync>;

impl Form {
    /// Of torques alone.
    pub fn new(
        torque: Vec<Vec<f64>>,
        values: impl Fn(&[f64]) -> Vec<f64> + Send + Sync + 'static,
    ) -> Self {
        Self {
            torque,
            reading: Vec::new(),
            values: Box::new(values),
            searched: 0,
            seldom: false,
            positive: false,
        }
    }

    /// With numbers that were searched for.
    #[must_use]
    pub fn searched(self, searched: usize) -> Self {
        Self { searched, ..self }
    }

    /// That may show in a few moments only.
    #[must_use]
    pub fn seldom(self) -> Self {
        Self {
            seldom: true,
            ..self
        }
    }

    /// Whose first coefficient must be above 0.
    #[must_use]
    pub fn positive(self) -> Self {
        Self {
            positive: true,
            ..self
        }
    }
}

/// The `count` forms that explain most of what is seen, not smoothed alike yet.
fn screened(seen: &Seen<'_>, forms: Vec<Form>, count: usize) -> Vec<Form> {
    if forms.len() <= count {
        return forms;
    }
    let tried = forms
        .into_iter()
        .map(|form| (seen.explained(&form.torque), form));
    let mut tried: Vec<(f64, Form)> = tried.collect();
    tried.sort_by(|a, b| b.0.total_cmp(&a.0));
    tried.truncate(count);
    tried.into_iter().map(|(_, form)| form).collect()
}

impl Seen<'_> {
    /// Squares that some torques explain by least squares.
    fn explained(&self, torque: &[Vec<f64>]) -> f64 {
        let n = torque.len();
        let mut normal = DMatrix::<f64>::zeros(n, n);
        let mut right = DVector::<f64>::zeros(n);
        for (&row, weight) in self.rows.iter().map(|row| (row, self.weight[*row])) {
            for a in 0..n {
                right[a] += weight * torque[a][row] * self.torque[row];
                for b in 0..=a {
                    normal[(a, b)] += weight * torque[a][row] * torque[b][row];
                }
            }
        }
        for a in 0..n {
            normal[(a, a)] += 1e-9 * normal[(a, a)] + f64::MIN_POSITIVE;
        }
        let solved = normal.cholesky().map(|c| c.solve(&right));
        solved.map_or(0.0, |solved| solved.dot(&right))
    }

    /// Coefficient of one torque by least squares.
    fn coefficient(&self, torque: &[f64]) -> f64 {
        let (mut square, mut product) = (0.0, 0.0);
        for (&row, weight) in self.rows.iter().map(|row| (row, self.weight[*row])) {
            square += weight * torque[row] * torque[row];
            product += weight * torque[row] * self.torque[row];
        }
        if square > 0.0 { product / square } else { 0.0 }
    }
}

/// What forms are made from, beside the motion.
pub(crate) struct Seen<'a> {
    /// Estimated, per row.
    pub torque: &'a [f64],
    /// Corner of the smoother, rad/s.
    pub corner: f64,
    /// That a fit sees.
    pub rows: &'a [usize],
    /// Of each row in a fit; 0 where it says nothing.
    pub weight: &'a [f64],
    /// In standard deviations, per row.
    pub innovation: &'a [f64],
    /// Waves over the position that the torque may have.
    pub waves: &'a Waves,
}

/// The forms that an effect may take along a motion.
type Forms = fn(&Path<'_>, &Seen<'_>) -> Vec<Form>;

/// An effect that shows as a torque along a motion.
pub(crate) struct Family {
    /// Its name in the vocabulary.
    pub effect: &'static str,
    /// The axis along which its torque is seen best: one of those of a share, or `wave`.
    pub axis: &'static str,
    /// The forms that it may take.
    pub forms: Forms,
}

const fn family(effect: &'static str, axis: &'static str, forms: Forms) -> Family {
    Family {
        effect,
        axis,
        forms,
    }
}

/// Every effect that shows as a torque along a motion.
pub(crate) const FAMILIES: [Family; 28] = [
    family("torque_gain", "input", actuation::torque_gain),
    family("torque_offset", "velocity", actuation::torque_offset),
    family("deadband", "input", actuation::deadband),
    family("saturation", "input", actuation::saturation),
    family("lag", "acceleration", actuation::lag),
    family("delay", "acceleration", actuation::delay),
    family("cogging", "wave", actuation::cogging),
    family("coulomb", "velocity", friction::coulomb),
    family(
        "asymmetric_coulomb",
        "velocity",
        friction::asymmetric_coulomb,
    ),
    family(
        "position_dependent_coulomb",
        "direction x position",
        friction::position_dependent_coulomb,
    ),
    family("stribeck", "velocity", friction::stribeck),
    family("viscous", "velocity", friction::viscous),
    family("quadratic_drag", "velocity", friction::quadratic_drag),
    family("presliding", "velocity", friction::presliding),
    family(
        "load_dependent_friction",
        "load",
        friction::load_dependent_friction,
    ),
    family("friction_drift", "time", friction::friction_drift),
    family("inertia", "acceleration", mechanics::inertia),
    family("gravity", "position", mechanics::gravity),
    family("spring", "position", mechanics::spring),
    family("end_stop", "position", mechanics::end_stop),
    family("backlash", "acceleration", mechanics::backlash),
    family("compliance", "acceleration", mechanics::compliance),
    family("sensor_gain", "input", sensing::sensor_gain),
    family(
        "sensor_nonlinearity",
        "position",
        sensing::sensor_nonlinearity,
    ),
    family("sensor_hysteresis", "velocity", sensing::sensor_hysteresis),
    family("sensor_lag", "acceleration", sensing::sensor_lag),
    family("lost_counts", "velocity", sensing::lost_counts),
    family("contact", "time", surroundings::contact),
];

/// The axis along which the torque of an effect is seen best.
pub(crate) fn axis_of(effect: &str) -> Option<&'static str> {
    let family = FAMILIES.iter().find(|family| family.effect == effect)?;
    Some(family.axis)
}

/// The vocabulary's kind of that name.
fn known(name: &str) -> Option<&'static Kind> {
    kind(name)
}

/// The default numbers of an effect, some of them set.
fn with(name: &str, set: &[(usize, f64)]) -> Vec<f64> {
    let parameters = known(name).map_or(&[][..], |kind| kind.parameters);
    let mut values: Vec<f64> = parameters.iter().map(|p| p.default).collect();
    for &(place, value) in set {
        if let Some(slot) = values.get_mut(place) {
            *slot = value;
        }
    }
    values
}

/// The torque of an effect with these numbers on top of the device.
fn on_top(path: &Path<'_>, name: &str, values: &[f64]) -> Vec<f64> {
    let mut device = path.device.clone();
    if let Some(kind) = known(name) {
        kind.install(&mut device, values);
    }
    path.on_top(&device)
}

/// A form in which some numbers of an effect move away from `base`, where it does nothing: place and step of each.
fn linear(path: &Path<'_>, name: &'static str, base: &[f64], steps: &[(usize, f64)]) -> Form {
    let columns = steps.iter().map(|&(place, step)| {
        let mut values = base.to_vec();
        values[place] += step;
        on_top(path, name, &values)
    });
    let columns = columns.collect();
    let (base, steps) = (base.to_vec(), steps.to_vec());
    Form::new(columns, move |coefficients| {
        let mut values = base.clone();
        for (&(place, step), coefficient) in steps.iter().zip(coefficients) {
            values[place] += coefficient * step;
        }
        values
    })
}

/// A form in which an effect acts as a whole with these numbers; its coefficient is 1 where they are right, and scales the
/// number at `size`, if one is its size.
fn whole(path: &Path<'_>, name: &'static str, values: Vec<f64>, size: Option<usize>) -> Form {
    let column = on_top(path, name, &values);
    Form::new(vec![column], move |coefficients| {
        let mut values = values.clone();
        if let Some(size) = size {
            values[size] *= coefficients[0];
        }
        values
    })
    .searched(1)
}
