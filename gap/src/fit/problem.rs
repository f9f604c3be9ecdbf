//! The data that all fits share, and the residuals of a hypothesis on them.

use super::costs::Costs;
use super::fitted::Fit;
use super::hypothesis::{self, Hypothesis, PriorParameter};
use super::objective::Objective;
use super::part::Part;
use super::whitening::{Whitening, dot, whitenings};
use crate::predict::Predictor;
use crate::windows::series::Series;
use host_sim::device::Device;
use rayon::prelude::*;
use recording::{Recording, Run};

/// The data that all fits share.
pub(crate) struct Problem<'a> {
    pub recording: &'a Recording,
    pub series: Vec<Series>,
    pub priors: Vec<PriorParameter>,
    /// Allowed model error: rms deviation of an acceptable model, in position units.
    pub modelling: f64,
    /// The objective of its fits.
    pub objective: Objective,
    /// The same data with restarts four times as often.
    pub quarter: Option<Box<Problem<'a>>>,
}

/// Weight of a squared deviation from a stated value, in standard deviations, against the robust cost of a window.
pub(crate) const PRIOR_WEIGHT: f64 = 0.25;

impl Problem<'_> {
    /// The problem without an allowed model error.
    pub(crate) fn exact(&self) -> Self {
        self.off_by(0.0)
    }

    /// The problem with an allowed model error of `modelling`, rms in position units.
    pub(crate) fn off_by(&self, modelling: f64) -> Self {
        Self {
            recording: self.recording,
            series: self.series.clone(),
            priors: self.priors.clone(),
            modelling,
            objective: self.objective,
            quarter: self
                .quarter
                .as_ref()
                .map(|quarter| Box::new(quarter.off_by(modelling))),
        }
    }

    /// The problem with another objective of the fits.
    pub(crate) fn with_objective(mut self, objective: Objective) -> Self {
        self.objective = objective;
        self.quarter = self
            .quarter
            .map(|quarter| Box::new(quarter.with_objective(objective)));
        self
    }

    /// The problem with other model parameters free.
    pub(crate) fn with_numbers(mut self, numbers: &[PriorParameter]) -> Self {
        self.priors = numbers.to_vec();
        self.quarter = self
            .quarter
            .map(|quarter| Box::new(quarter.with_numbers(numbers)));
        self
    }

    /// Root mean square over all samples, from the sum of squares of each window.
    pub(crate) fn rms(&self, squares: &[f64]) -> f64 {
        let samples: usize = self.series.iter().map(|s| s.position.len()).sum();
        (squares.iter().sum::<f64>() / samples.max(1) as f64).sqrt()
    }

    pub(crate) fn window_count(&self) -> usize {
        self.series.iter().map(|s| s.windows.len()).sum()
    }

    /// Duration of all runs, s.
    pub(crate) fn duration_s(&self) -> f64 {
        self.recording.runs.iter().map(Run::duration_s).sum()
    }

    /// All measured positions.
    pub(crate) fn positions(&self) -> impl Iterator<Item = f64> {
        self.series.iter().flat_map(|s| s.position.iter().copied())
    }

    /// The lowest and the highest measured position.
    pub(crate) fn extremes(&self) -> [f64; 2] {
        self.positions()
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| {
                [low.min(x), high.max(x)]
            })
    }

    pub(crate) fn predictor(&self, hypothesis: &Hypothesis, x: &[f64]) -> Predictor {
        let device = hypothesis.device(&self.recording.model, &self.priors, x);
        let shifts_s = hypothesis::input_shifts_s(self.recording, &self.priors, x);
        Predictor::new(device, self.recording).shifted(shifts_s)
    }

    /// Rms of measured less predicted position on given series, in position units.
    pub(crate) fn plain_gap(&self, series: &[Series], fit: &Fit) -> f64 {
        let predictor = self.predictor(&fit.hypothesis, &fit.x);
        let mut sum = 0.0;
        let mut count = 0;
        for series in series {
            for (p, m) in predictor.predict(series).iter().zip(&series.position) {
                sum += (p - m).powi(2);
                count += 1;
            }
        }
        (sum / f64::from(count.max(1))).sqrt()
    }

    /// Sum of squared residuals of each window of a part under a fit, by running index. It is NaN for the other windows.
    pub(crate) fn window_squares(&self, fit: &Fit, part: Part<'_>) -> Vec<f64> {
        self.squares(&self.predictor(&fit.hypothesis, &fit.x), part)
    }

    /// Sum of squared residuals of each window under the nominal model.
    pub(crate) fn nominal_squares(&self) -> Vec<f64> {
        let nominal = Device::nominal(&self.recording.model);
        self.squares(&Predictor::new(nominal, self.recording), Part::All)
    }

    /// Sum of squared residuals of each window of a part under a predictor, by running index. It is NaN for the other windows.
    pub(crate) fn squares(&self, predictor: &Predictor, part: Part<'_>) -> Vec<f64> {
        let residuals = self.residuals(predictor, part);
        let windows = self.by_window(&residuals).enumerate();
        let squares = windows.map(|(w, r)| if part.has(w) { dot(r, r) } else { f64::NAN });
        squares.collect()
    }

    /// The values of each window, by running index, from the values of each series.
    pub(super) fn by_window<'b>(
        &'b self,
        values: &'b [Vec<f64>],
    ) -> impl Iterator<Item = &'b [f64]> {
        let pairs = self.series.iter().zip(values);
        pairs.flat_map(|(series, values)| {
            let windows = series.windows.iter();
            windows.map(|window| &values[window.samples.clone()])
        })
    }

    /// True for the windows that overlap given intervals of the session, s, and for the windows that follow them.
    pub(crate) fn during(&self, times_s: &[[f64; 2]]) -> Vec<bool> {
        let windows = self.series.iter().flat_map(|series| {
            let mut is_before = false;
            series.windows.iter().map(move |window| {
                let samples = &window.samples;
                let first_s = window.restart.time_s + series.session_offset_s;
                let last_s = series.session(samples.end - 1);
                let mut times = times_s.iter();
                let is_within = times.any(|[from_s, to_s]| *from_s <= last_s && first_s <= *to_s);
                let follows = core::mem::replace(&mut is_before, is_within);
                is_within || follows
            })
        });
        windows.collect()
    }

    /// Running index of the first window of each series.
    pub(super) fn bases(&self) -> Vec<usize> {
        let counts = self.series.iter().scan(0, |next, s| {
            let base = *next;
            *next += s.windows.len();
            Some(base)
        });
        counts.collect()
    }

    /// Measured less predicted positions, per series.
    pub(crate) fn residuals(&self, predictor: &Predictor, part: Part<'_>) -> Vec<Vec<f64>> {
        let pairs = self.series.par_iter().zip(self.bases());
        pairs
            .map(|(series, base)| {
                let wanted = |w: usize| part.has(base + w);
                let mut out = predictor.predict_shifted(series, [0.0, 0.0], wanted);
                for (p, m) in out.iter_mut().zip(&series.position) {
                    *p = m - *p;
                }
                out
            })
            .collect()
    }

    pub(crate) fn whitenings(
        &self,
        predictor: &Predictor,
        residuals: &[Vec<f64>],
        part: Part<'_>,
    ) -> Vec<Option<Whitening>> {
        let mut all = Vec::new();
        for ((series, residual), base) in self.series.iter().zip(residuals).zip(self.bases()) {
            let predicted: Vec<f64> = series
                .position
                .iter()
                .zip(residual)
                .map(|(m, r)| m - r)
                .collect();
            all.extend(whitenings(
                predictor,
                series,
                &predicted,
                self.modelling,
                |w| part.has(base + w),
            ));
        }
        all
    }

    /// Whitened copies of the residuals of the windows that take part, by running index. The entries of other windows are empty.
    pub(crate) fn whitened(
        &self,
        residuals: &[Vec<f64>],
        whitenings: &[Option<Whitening>],
    ) -> Vec<Vec<f64>> {
        self.by_window(residuals)
            .zip(whitenings)
            .map(|(residual, whitening)| match whitening {
                Some(whitening) => {
                    let mut residual = residual.to_vec();
                    whitening.apply(&mut residual);
                    residual
                }
                None => Vec::new(),
            })
            .collect()
    }

    pub(crate) fn prior(&self, x: &[f64]) -> f64 {
        let z = &x[..self.priors.len()];
        PRIOR_WEIGHT * z.iter().map(|z| z * z).sum::<f64>()
    }

    /// Cost of a hypothesis at a point, with the whitenings of that point.
    pub(crate) fn costs(&self, hypothesis: &Hypothesis, x: &[f64], part: Part<'_>) -> Costs {
        let predictor = self.predictor(hypothesis, x);
        let residuals = self.residuals(&predictor, part);
        let whitenings = self.whitenings(&predictor, &residuals, part);
        Costs::new(&self.whitened(&residuals, &whitenings), self.prior(x))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::floor::WHITE;
    use crate::made;

    #[test]
    fn a_residual_within_the_allowed_model_error_costs_no_more_than_noise() {
        let recording = made::recording(&["torque_offset:torque=0.001"]);
        let bare = Hypothesis { terms: Vec::new() };
        let exact = made::problem(&recording);
        let fit = exact.fit(&bare, Vec::new(), Part::All, 0);
        let gap = exact.plain_gap(&exact.series, &fit);
        let level = |modelling| {
            let problem = Problem {
                modelling,
                ..made::problem(&recording)
            };
            problem.costs(&bare, &[], Part::All).level()
        };
        assert!(level(0.0) > 2.0 * WHITE, "{}", level(0.0));
        assert!(level(gap) < WHITE, "{}", level(gap));
        assert!(level(0.1 * gap) > level(gap));
    }
}
