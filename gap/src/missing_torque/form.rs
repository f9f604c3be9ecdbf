//! A form of an effect: the torque that it makes along a motion.
//!
//! An effect that acts on drive or mechanics is switched into the device, as a simulation does; its column is the torque
//! that this makes along the measured motion. What a sensor hides is worked out from the torque that the device itself
//! has there, never from the measured acceleration, which the missing torque contains.

use super::path::Path;
use host_sim::effects::Kind;

/// One way in which an effect may act: a torque for a unit of each coefficient.
pub(crate) struct Form {
    /// Torque over each step, for a unit of each coefficient.
    pub torque: Vec<Vec<f64>>,
    /// Error of the sensor in each row, in units of position, for a unit of each coefficient; empty if the effect is not in the sensor.
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

    /// In which some numbers of an effect move away from `base`, where it does nothing: place and step of each.
    pub fn linear(
        path: &Path<'_>,
        kind: &'static Kind,
        base: &[f64],
        steps: &[(usize, f64)],
    ) -> Self {
        let columns = steps.iter().map(|&(place, step)| {
            let mut values = base.to_vec();
            values[place] += step;
            path.torque_of(kind, &values)
        });
        let columns = columns.collect();
        let (base, steps) = (base.to_vec(), steps.to_vec());
        Self::new(columns, move |coefficients| {
            let mut values = base.clone();
            for (&(place, step), coefficient) in steps.iter().zip(coefficients) {
                values[place] += coefficient * step;
            }
            values
        })
    }

    /// In which an effect acts as a whole with these numbers; its coefficient is 1 where they are right, and scales the number at
    /// `size`, if one is its size.
    pub fn whole(
        path: &Path<'_>,
        kind: &'static Kind,
        values: Vec<f64>,
        size: Option<usize>,
    ) -> Self {
        let column = path.torque_of(kind, &values);
        Self::new(vec![column], move |coefficients| {
            let mut values = values.clone();
            if let Some(size) = size {
                values[size] *= coefficients[0];
            }
            values
        })
        .searched(1)
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

/// The default numbers of an effect, some of them set, by their places.
pub(crate) fn with_defaults(kind: &Kind, set: &[(usize, f64)]) -> Vec<f64> {
    let mut values: Vec<f64> = kind.parameters.iter().map(|p| p.default).collect();
    for &(place, value) in set {
        if let Some(slot) = values.get_mut(place) {
            *slot = value;
        }
    }
    values
}
