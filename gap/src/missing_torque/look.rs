//! The presentation of a missing torque: its axes, possible explanations, and the points of a plot.

use super::axis::Axis;
use super::orders::{Order, orders};
use super::repeats::repeats;
use super::ripple::Waves;
use super::shares::{Share, shares};
use super::shortlist::{Proposal, ShortlistSearch, respond};
use super::smoother::Steps;
use super::target::Target;
use super::{BLOCK_HORIZONS, MissingTorque};
use crate::effects;
use host_sim::device::Device;
use serde::Serialize;

/// Length of a held-out block of time for the shares of the axes, in horizons. Tables could memorize shorter blocks. The value is
/// unlikely to be the period of an excitation.
const TABLE_HORIZONS: f64 = 1.37;
/// Number of proposed sets of effects.
const PROPOSALS: usize = 8;

/// The summary of a missing torque, as defined by the recording format.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// Rms of the missing torque, in `unit`.
    pub rms: f64,
    /// Unit of the torque: the unit of the input, at the joint.
    pub unit: String,
    /// Shares of the axes, largest first.
    pub shares: Vec<Share>,
    /// Share that the best sum of functions of these axes explains.
    pub additive_share: f64,
    /// True if the motion is only periodic. The shares then say little.
    pub repeats: bool,
}

/// One instant of the missing torque.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Index of the run.
    pub run: usize,
    /// Time of the run, s.
    pub time_s: f64,
    /// Position, in position units.
    pub position: f64,
    /// Velocity, in position units per s.
    pub velocity: f64,
    /// Drive torque of the model, in units of torque.
    pub drive: f64,
    /// Total torque of the model.
    pub net: f64,
    /// Missing torque.
    pub torque: f64,
    /// Standard deviation of the missing torque.
    pub std: f64,
    /// Part of the missing torque that the explanation gives.
    pub explained: f64,
}

/// All data of a plot of the missing torque.
#[derive(Clone, Debug, PartialEq)]
pub struct Look {
    /// Shares of the axes, and the rms.
    pub summary: Summary,
    /// Sets of effects that explain the missing torque, best first.
    pub proposals: Vec<Proposal>,
    /// Orders of a ripple, largest first. It is empty without a ripple.
    pub orders: Vec<Order>,
    /// Instants at which the direction of sliding is known, in the order of time.
    pub points: Vec<Point>,
    /// The axis of the plot: the one that explains most, or [`Axis::Wave`] for a ripple.
    pub axis: Axis,
    /// Names of the effects behind [`Point::explained`].
    pub explained_by: Vec<&'static str>,
    /// Share of the samples in which static friction may act, so that the missing torque is unknown.
    pub held_share: f64,
}

impl MissingTorque {
    /// The shares of the axes and the rms.
    pub fn summary(&self) -> Summary {
        let smoothed = &self.estimate.smoothed;
        let path = self.path();
        let steps = Steps::of(&self.samples, &self.device.mechanics);
        let sliding = &self.estimate.sliding;
        let smoother = steps.smoother(self.estimate.noise, &smoothed.velocity, sliding);
        let rows = self.rows(TABLE_HORIZONS * self.recording.horizon);
        let target = rows.of(&smoothed.torque);
        let waves = Waves::of(&path, &rows, &target, self.corner());
        let (shares, additive_share) = shares(&path, &smoother, &rows, &target, self.rms(), &waves);
        Summary {
            rms: self.rms(),
            unit: self.recording.units.input.clone(),
            shares,
            additive_share,
            repeats: repeats(&self.samples, smoothed),
        }
    }

    /// The instants of the missing torque, without an explanation.
    pub(crate) fn points(&self) -> Vec<Point> {
        let smoothed = &self.estimate.smoothed;
        let path = self.path();
        let net = path.torque(&self.device);
        let rows = self.rows(BLOCK_HORIZONS * self.recording.horizon);
        let points = rows.rows.iter().map(|&row| {
            let mut stretches = self.samples.stretches.iter();
            let stretch = stretches.find(|stretch| stretch.rows.contains(&row));
            Point {
                run: stretch.map_or(0, |stretch| stretch.run),
                time_s: self.samples.time_s[row],
                position: smoothed.position[row],
                velocity: smoothed.velocity[row],
                drive: path.drive[row],
                net: net[row],
                torque: smoothed.torque[row],
                std: smoothed.torque_std[row],
                explained: 0.0,
            }
        });
        points.collect()
    }

    /// All data of a plot. The explanation is the device `found` with its effects, or otherwise the best proposal.
    pub fn look(&self, found: Option<(&Device, Vec<&'static str>)>) -> Look {
        let smoothed = &self.estimate.smoothed;
        let path = self.path();
        let steps = Steps::of(&self.samples, &self.device.mechanics);
        let sliding = &self.estimate.sliding;
        let smoother = steps.smoother(self.estimate.noise, &smoothed.velocity, sliding);
        let rows = self.rows(BLOCK_HORIZONS * self.recording.horizon);
        let summary = self.summary();
        let target = rows.of(&smoothed.torque);
        let corner = self.corner();
        let waves = Waves::of(&path, &rows, &target, corner);
        let weight = self.weights(&rows);
        let torque = Target {
            torque: &smoothed.torque,
            corner,
            rows: &rows.rows,
            weight: &weight,
            innovation: &smoothed.innovation,
            waves: &waves,
        };
        let search = ShortlistSearch::of(&self.recording, &path, &smoother, &rows, &torque);
        let proposals = search.shortlist(PROPOSALS);
        let is_found = found.is_some();
        let (explained, explained_by) = match found {
            Some((device, names)) => {
                // From J' a = T' follows J a − T = J/J' T' − T.
                let ratio = self.device.mechanics.inertia / device.mechanics.inertia;
                let pairs = path
                    .torque(device)
                    .into_iter()
                    .zip(path.torque(&self.device));
                let torque = pairs
                    .map(|(with, without)| ratio * with - without)
                    .collect();
                let columns = respond(&smoother, &rows, &[torque], &[]);
                (columns.into_iter().flatten().collect(), names)
            }
            None => {
                let names = proposals
                    .first()
                    .map(|first| first.names())
                    .unwrap_or_default();
                (search.explained(&names), names)
            }
        };
        let points = self.points().into_iter().enumerate();
        let points = points.map(|(i, point)| Point {
            explained: explained.get(i).copied().unwrap_or(0.0),
            ..point
        });
        let explaining_effect = explained_by.first().filter(|_| is_found);
        let axis = explaining_effect
            .and_then(|name| effects::find(name))
            .map(|effect| effect.axis());
        let axis = axis.unwrap_or_else(|| most_explaining(&summary.shares, proposals.first()));
        let orders = orders(&path, &smoother, &rows, &target, corner);
        let axis = if axis == Axis::Wave && orders.is_empty() {
            Axis::Position
        } else {
            axis
        };
        let sticking = sliding.iter().filter(|slides| !**slides).count();
        Look {
            points: points.collect(),
            summary,
            proposals,
            orders,
            axis,
            explained_by,
            held_share: sticking as f64 / sliding.len().max(1) as f64,
        }
    }
}

/// Axes that a plot can have.
const PLOTTED: [Axis; 7] = [
    Axis::Velocity,
    Axis::Position,
    Axis::Input,
    Axis::Load,
    Axis::Acceleration,
    Axis::Time,
    Axis::DirectionAndPosition,
];
/// Share by which proposed effects must explain more than a function of one axis for their axis to be plotted.
const CLEARLY_MORE: f64 = 0.1;

/// The axis that explains most, unless the first proposed effect has another axis and explains clearly more.
fn most_explaining(shares: &[Share], proposal: Option<&Proposal>) -> Axis {
    let most = shares.iter().find(|share| PLOTTED.contains(&share.axis));
    let first = proposal.and_then(|proposal| {
        let least = most.map_or(0.0, |most| most.share) + CLEARLY_MORE;
        let name = proposal.effects.first()?.0;
        let effect = effects::find(name).filter(|_| proposal.share > least)?;
        Some(effect.axis())
    });
    first
        .or(most.map(|most| most.axis))
        .unwrap_or(Axis::Velocity)
}

impl Proposal {
    /// Names of the effects.
    pub fn names(&self) -> Vec<&'static str> {
        self.effects.iter().map(|(name, _)| *name).collect()
    }
}
