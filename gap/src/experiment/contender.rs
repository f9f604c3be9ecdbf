//! A rival model in a trial, with what is known of its numbers.

use super::separation::separation;
use super::trial::{Setting, readings};
use crate::fit::part::Part;
use crate::fit::problem::Problem;
use crate::fit::{DIFFERENCES, Fit, difference_within};
use haptic_paddle::excitation::Excitation;
use host_sim::device::Device;
use nalgebra::{DMatrix, DVector};

/// A rival as it was fitted.
pub(super) struct Contender {
    device: Device,
    /// With one coordinate moved, and by how much.
    moved: Vec<(f64, Device)>,
    /// Inverse of the covariance of the coordinates.
    information: DMatrix<f64>,
}

/// What a contender would show, a constant left out, and how that changes along its coordinates, a column each.
pub(super) struct Shown {
    readings: DVector<f64>,
    slopes: DMatrix<f64>,
    information: DMatrix<f64>,
}

impl Contender {
    pub(super) fn new(problem: &Problem<'_>, fit: &Fit) -> Self {
        let model = &problem.recording.model;
        let at = |x: &[f64]| fit.hypothesis.device(model, &problem.priors, x);
        let reaches = fit.hypothesis.reaches(&problem.priors);
        let moved = fit
            .x
            .iter()
            .zip(reaches)
            .enumerate()
            .map(|(i, (x, reach))| {
                let by = difference_within(*x, DIFFERENCES[1], reach);
                let mut there = fit.x.clone();
                there[i] += by;
                (by, at(&there))
            });
        let linearization = problem.linearization(fit, Part::All);
        Self {
            device: at(&fit.x),
            moved: moved.collect(),
            information: linearization.information(problem.priors.len()),
        }
    }

    /// Readings as it was fitted, a constant left out; `None` if it does not stay where it may be.
    pub(super) fn readings(&self, excitation: &Excitation, at: &Setting) -> Option<DVector<f64>> {
        readings(&self.device, excitation, at).map(centred)
    }

    /// The same, and along its coordinates.
    pub(super) fn shown(&self, excitation: &Excitation, at: &Setting) -> Option<Shown> {
        let fitted = self.readings(excitation, at)?;
        let mut slopes = DMatrix::zeros(fitted.len(), self.moved.len());
        for (mut slope, (by, device)) in slopes.column_iter_mut().zip(&self.moved) {
            let there = centred(readings(device, excitation, at)?);
            slope.copy_from(&((there - &fitted) / *by));
        }
        Some(Shown {
            readings: fitted,
            slopes,
            information: self.information.clone(),
        })
    }
}

impl Shown {
    /// How far this is from another, over the noise of a reading.
    pub(super) fn separation(&self, other: &Self, noise: f64) -> f64 {
        let (own, all) = (
            self.slopes.ncols(),
            self.slopes.ncols() + other.slopes.ncols(),
        );
        let mut slopes = self.slopes.clone().resize_horizontally(all, 0.0);
        slopes
            .columns_mut(own, all - own)
            .copy_from(&-&other.slopes);
        let mut information = self.information.clone().resize(all, all, 0.0);
        let theirs = (other.slopes.ncols(), other.slopes.ncols());
        information
            .view_mut((own, own), theirs)
            .copy_from(&other.information);
        separation(
            &(&self.readings - &other.readings),
            &slopes,
            &information,
            noise,
        )
    }
}

fn centred(readings: Vec<f64>) -> DVector<f64> {
    let readings = DVector::from_vec(readings);
    let mean = readings.mean();
    readings.add_scalar(-mean)
}
