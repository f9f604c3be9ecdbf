//! A form of an effect: the torque that the effect causes along a motion.
//!
//! An effect on drive or mechanics is installed in the device model, and its column is the change of the torque along the measured
//! motion. The column of a sensor error is computed from the torque of the device model. It does not use the measured acceleration, which
//! contains the missing torque.

use super::path::Path;
use host_sim::effects::Kind;

/// One way in which an effect may act: a torque per unit of each coefficient.
pub(crate) struct Form {
    /// Torque over each step, per unit of each coefficient.
    pub torque: Vec<Vec<f64>>,
    /// Sensor error in each row, in position units per unit of each coefficient. It is empty for an effect outside the sensor.
    pub reading: Vec<Vec<f64>>,
    /// Computes the parameters of the effect, in the order of its kind, from the coefficients.
    pub values: Values,
    /// Number of parameters that were searched in addition to the coefficients, for example a position or an instant.
    pub searched: usize,
    /// True if the effect may act in so few instants that held-out data cannot confirm it.
    pub seldom: bool,
    /// True if the first coefficient must be positive.
    pub positive: bool,
}

/// Computes the parameters of an effect from coefficients.
pub(crate) type Values = Box<dyn Fn(&[f64]) -> Vec<f64> + Send + Sync>;

impl Form {
    /// A form with torques and without a sensor error.
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

    /// A form whose coefficients move parameters of an effect away from `base`, where the effect has no influence. `steps` holds the
    /// index of each parameter and its change per unit of coefficient.
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

    /// A form with the whole effect at given parameters and one coefficient, which is 1 if the parameters are right. The coefficient
    /// multiplies the parameter at `size`, if given.
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

    /// Sets the number of searched parameters.
    #[must_use]
    pub fn searched(self, searched: usize) -> Self {
        Self { searched, ..self }
    }

    /// Marks the effect as one that may act in few instants.
    #[must_use]
    pub fn seldom(self) -> Self {
        Self {
            seldom: true,
            ..self
        }
    }

    /// Requires a positive first coefficient.
    #[must_use]
    pub fn positive(self) -> Self {
        Self {
            positive: true,
            ..self
        }
    }
}

/// The default parameters of an effect, with some of them set by index.
pub(crate) fn with_defaults(kind: &Kind, set: &[(usize, f64)]) -> Vec<f64> {
    let mut values: Vec<f64> = kind.parameters.iter().map(|p| p.default).collect();
    for &(place, value) in set {
        if let Some(slot) = values.get_mut(place) {
            *slot = value;
        }
    }
    values
}
