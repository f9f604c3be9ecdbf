//! A reading that follows the position as a first-order lag.

use super::identification::{Family, Identification, SmallMotion};
use super::phrase::Found;
use crate::columns::{Disagreement, lowest};
use crate::guess::Evidence;
use crate::guess::late::{later, twice};
use crate::term::Term;
use host_sim::effects::Kind;
use host_sim::effects::sensor_lag::KIND;
use recording::Model;

/// Place of the parameter that says that there are two of it.
const TWICE: usize = 1;
/// Lags between two columns, over the duration of a window.
const LAGS: [f64; 2] = [1e-4, 1.0];

#[derive(Debug)]
pub(super) struct SensorLag;

impl Identification for SensorLag {
    fn kind(&self) -> &'static Kind {
        &KIND
    }

    fn starts(&self, e: &Evidence<'_>) -> Vec<Term> {
        let once = later(&KIND, e);
        let both = twice(&once, TWICE);
        [once, both].concat()
    }

    fn family(&self) -> Option<Family> {
        Some(Family::Lateness)
    }

    fn on_small_motion(&self, fitted: &Term, _model: &Model) -> Option<SmallMotion> {
        let time_s = fitted.values[0];
        Some(SmallMotion::LateReading { time_s })
    }

    fn column_fits(&self, columns: &Disagreement<'_>) -> Vec<Vec<f64>> {
        let lag = |twice: f64| {
            let range = LAGS.map(|f| f * columns.window_s);
            let time_s = lowest(range, |tau| columns.left(&KIND, &[tau, twice]));
            vec![time_s, twice]
        };
        vec![lag(0.0), lag(1.0)]
    }

    fn noun(&self) -> &'static str {
        "lag of the sensor"
    }

    fn template(&self, found: &Found<'_>) -> &'static str {
        match found.value("twice") {
            Some(1.0) => "a sensor that lags by {time}, and by as much again",
            _ => "a sensor that lags by {time}",
        }
    }
}
