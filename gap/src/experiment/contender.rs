//! A rival model in a simulated trial, with the information on its parameters.

use super::separation::separation;
use super::trial::{Setting, readings};
use crate::fit::part::Part;
use crate::fit::problem::Problem;
use crate::fit::{DIFFERENCES, Fit, difference_within};
use haptic_paddle::excitation::Excitation;
use host_sim::device::Device;
use nalgebra::{DMatrix, DVector};

/// A rival model as fitted.
pub(super) struct Contender {
    device: Device,
    /// The step of each coordinate, and the device with that coordinate moved.
    moved: Vec<(f64, Device)>,
    /// Information matrix of the coordinates.
    information: DMatrix<f64>,
}

/// The readings of a contender without their mean, and their slopes along its coordinates, one column each.
pub(super) struct LinearReadings {
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

    /// Readings of the fitted device without their mean. Returns `None` if the device leaves its range.
    pub(super) fn readings(&self, excitation: &Excitation, at: &Setting) -> Option<DVector<f64>> {
        readings(&self.device, excitation, at).map(without_mean)
    }

    /// Readings of the fitted device without their mean, with their slopes along its coordinates. Returns `None` if the device leaves its
    /// range.
    pub(super) fn linear_readings(
        &self,
        excitation: &Excitation,
        at: &Setting,
    ) -> Option<LinearReadings> {
        let fitted = self.readings(excitation, at)?;
        let mut slopes = DMatrix::zeros(fitted.len(), self.moved.len());
        for (mut slope, (by, device)) in slopes.column_iter_mut().zip(&self.moved) {
            let there = without_mean(readings(device, excitation, at)?);
            slope.copy_from(&((there - &fitted) / *by));
        }
        Some(LinearReadings {
            readings: fitted,
            slopes,
            information: self.information.clone(),
        })
    }
}

impl LinearReadings {
    /// Separation from another contender, over the noise of a reading.
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

fn without_mean(readings: Vec<f64>) -> DVector<f64> {
    let readings = DVector::from_vec(readings);
    let mean = readings.mean();
    readings.add_scalar(-mean)
}
