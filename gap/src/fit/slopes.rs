//! Slopes of the residuals along the coordinates of a hypothesis, by finite differences.

use super::hypothesis::Hypothesis;
use super::part::Part;
use super::problem::Problem;

/// Finite differences of a coordinate, which are scaled to be of order one: wide at first, to see past the
/// kinks of stick and slip, then narrow.
pub(crate) const DIFFERENCES: [f64; 2] = [0.15, 0.02];

/// Change of the residuals, per series, by one coordinate.
pub(crate) type Slope = Vec<Vec<f64>>;

impl Problem<'_> {
    /// The windows of a part in which the effect that coordinate `i` belongs to acts at either of two points: it changes nothing else.
    /// None if it always acts.
    fn touched(
        &self,
        hypothesis: &Hypothesis,
        points: [&[f64]; 2],
        i: usize,
        part: Part<'_>,
    ) -> Option<Vec<bool>> {
        let [here, there] = points.map(|x| hypothesis.meanwhile(x, i));
        let meanwhile = self.during(&[here?, there?].concat());
        let windows = meanwhile.into_iter().enumerate();
        Some(windows.map(|(w, acts)| acts && part.has(w)).collect())
    }

    /// Change of the residuals from those at `x`, which are `base`, by coordinate `i`.
    pub(crate) fn slope(
        &self,
        hypothesis: &Hypothesis,
        x: &[f64],
        base: &[Vec<f64>],
        i: usize,
        difference: f64,
        part: Part<'_>,
    ) -> Slope {
        let mut moved = x.to_vec();
        moved[i] += difference;
        let touched = self.touched(hypothesis, [x, &moved], i, part);
        let part = touched.as_deref().map_or(part, Part::Chosen);
        let mut slope = self.residuals(&self.predictor(hypothesis, &moved), part);
        for (((slope, base), series), first) in slope
            .iter_mut()
            .zip(base)
            .zip(&self.series)
            .zip(self.bases())
        {
            for (w, window) in series.windows.iter().enumerate() {
                let samples = window.samples.clone();
                if part.has(first + w) {
                    for (s, r) in slope[samples.clone()].iter_mut().zip(&base[samples]) {
                        *s = (*s - r) / difference;
                    }
                } else {
                    slope[samples].fill(0.0);
                }
            }
        }
        slope
    }
}

/// A difference of a coordinate that leaves it in its reach: at the upper end it goes nowhere but back.
pub(crate) fn aside(x: f64, difference: f64, [_, high]: [f64; 2]) -> f64 {
    if x + difference > high {
        -difference
    } else {
        difference
    }
}

/// A coordinate, or the end of its reach where it is beyond.
pub(crate) fn within(x: f64, [low, high]: [f64; 2]) -> f64 {
    x.max(low).min(high)
}
