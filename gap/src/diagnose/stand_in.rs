//! Effects that bend to what has no name: they close the gap, and would close that of another cause as well.

use crate::fit::Fit;
use crate::fit::problem::Problem;
use core::f64::consts::TAU;
use std::fmt;

/// Waves of a ripple that were travelled at least for it to be seen to repeat.
const LEAST_WAVES: f64 = 1.0;

/// Why what was found may stand in for something else.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum StandIn {
    /// Less than a wave of a ripple was travelled: any force over position looks so.
    Wave { travelled: f64 },
    /// A soft transmission behind a drive that is late, or before a sensor that is: so is any drive with dynamics of its own.
    Drive { late: &'static str },
}

impl StandIn {
    /// The reason to doubt what was found beyond the first effects that are `certain`, if there is one.
    pub(super) fn of(problem: &Problem<'_>, fit: &Fit, certain: usize) -> Option<Self> {
        let predictor = problem.predictor(&fit.hypothesis, &fit.x);
        let [low, high] = problem.extremes();
        let cogging = predictor.device().mechanics.cogging;
        let travelled = cogging.map(|c| c.wave_number * (high - low) / TAU);
        if let Some(travelled) = travelled.filter(|waves| *waves < LEAST_WAVES) {
            return Some(Self::Wave { travelled });
        }
        let found = fit.hypothesis.terms.iter().skip(certain);
        let names: Vec<&str> = found.map(|term| term.kind.name).collect();
        let late = ["delay", "lag", "sensor_lag"]
            .into_iter()
            .find(|n| names.contains(n))?;
        names
            .contains(&"compliance")
            .then_some(Self::Drive { late })
    }
}

impl fmt::Display for StandIn {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Wave { travelled } => write!(
                f,
                "only {travelled:.1} waves of the cogging were travelled: any force over position would look so; \
                 record a longer travel to see whether it repeats"
            ),
            Self::Drive { late } => write!(
                f,
                "compliance and {late} together act as a drive with a resonance of its own would: measure the torque \
                 or the motor's side to tell"
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::hypothesis::{Hypothesis, Term};
    use crate::fit::problem::Part;
    use crate::made;

    /// Whether these terms, the first ones `certain`, may stand in for something else.
    fn is_doubted(terms: Vec<Term>, certain: usize) -> bool {
        let recording = made::recording(&[]);
        let problem = made::problem(&recording);
        let fit = problem.fit(&Hypothesis { terms }, Vec::new(), Part::All, 0);
        StandIn::of(&problem, &fit, certain).is_some()
    }

    #[test]
    fn a_ripple_is_one_where_it_was_seen_to_repeat() {
        let recording = made::recording(&[]);
        let [low, high] = made::problem(&recording).extremes();
        let ripple = |waves: f64| {
            let mut term = made::term("cogging", &[]);
            term.values[..2].copy_from_slice(&[1e-4, waves * TAU / (high - low)]);
            vec![term]
        };
        assert!(is_doubted(ripple(0.8), 0));
        assert!(!is_doubted(ripple(1.2), 0));
    }

    #[test]
    fn a_soft_transmission_behind_a_late_drive_may_be_the_drive() {
        let named = |names: &[&str]| names.iter().map(|n| made::term(n, &[])).collect();
        assert!(is_doubted(named(&["compliance", "lag"]), 0));
        assert!(is_doubted(named(&["delay", "compliance"]), 0));
        assert!(is_doubted(named(&["compliance", "sensor_lag"]), 0));
        assert!(!is_doubted(named(&["sensor_lag", "compliance"]), 1));
        assert!(!is_doubted(named(&["compliance", "viscous"]), 0));
        assert!(!is_doubted(named(&["delay"]), 0));
    }
}
