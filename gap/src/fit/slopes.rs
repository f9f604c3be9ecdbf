//! Slopes of the residuals along the coordinates of a hypothesis, by finite differences.

use super::hypothesis::Hypothesis;
use super::part::Part;
use super::problem::Problem;

/// Steps of the finite differences. The coordinates are scaled to order one. The first step is wide, to average over the kinks of stick
/// and slip; the second is narrow.
pub(crate) const DIFFERENCES: [f64; 2] = [0.15, 0.02];

/// Derivative of the residuals along one coordinate, per series.
pub(crate) type Slope = Vec<Vec<f64>>;

impl Problem<'_> {
    /// The windows of a part in which the effect of coordinate `i` acts at either of two points. In the other windows the residuals do
    /// not change. Returns `None` if the effect always acts.
    fn affected(
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

    /// Derivative of the residuals along coordinate `i` at `x`, where the residuals are `base`.
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
        let affected = self.affected(hypothesis, [x, &moved], i, part);
        let part = affected.as_deref().map_or(part, Part::Chosen);
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

/// The step of a finite difference with the sign that keeps the coordinate within its range: negative at the upper bound.
pub(crate) fn difference_within(x: f64, difference: f64, [_, high]: [f64; 2]) -> f64 {
    if x + difference > high {
        -difference
    } else {
        difference
    }
}

/// A coordinate limited to its range.
pub(crate) fn clamped(x: f64, [low, high]: [f64; 2]) -> f64 {
    x.max(low).min(high)
}
