//! What is to be seen of a missing torque: its axes, what may explain it, and the points that a picture shows.

use super::axis::Axis;
use super::orders::{Order, orders};
use super::repeats::repeats;
use super::ripple::Waves;
use super::shares::{Share, shares};
use super::shortlist::{Field, Proposal, respond};
use super::smoother::Steps;
use super::target::Target;
use super::{BLOCK_HORIZONS, MissingTorque};
use crate::effects;
use host_sim::device::Device;
use serde::Serialize;

/// Horizons of a block of time for tables, which would remember shorter ones; no period of an excitation is likely to be this.
const TABLE_HORIZONS: f64 = 1.37;
/// Sets of effects that are kept.
const PROPOSALS: usize = 8;

/// The summary that the recording format has.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// Root mean square, in `unit`.
    pub rms: f64,
    /// Of the torque: that of the input, at the joint.
    pub unit: String,
    /// The most telling axis first.
    pub shares: Vec<Share>,
    /// Share of the best additive law over these axes.
    pub additive_share: f64,
    /// True where the motion only repeats itself, so that shares say little.
    pub repeats: bool,
}

/// One instant of the missing torque.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Index of the run.
    pub run: usize,
    /// In the run's time, s.
    pub time_s: f64,
    /// In units of position.
    pub position: f64,
    /// Per s.
    pub velocity: f64,
    /// Torque of the input by the model.
    pub drive: f64,
    /// All torque of the model.
    pub net: f64,
    /// Missing.
    pub torque: f64,
    /// Standard deviation of that.
    pub std: f64,
    /// What an explanation gives of it.
    pub explained: f64,
}

/// Everything that a picture of the missing torque is made of.
#[derive(Clone, Debug, PartialEq)]
pub struct Look {
    /// Shares and sizes.
    pub summary: Summary,
    /// Sets of effects that explain it, the best first.
    pub proposals: Vec<Proposal>,
    /// Of a ripple, the largest first; empty where there is none.
    pub orders: Vec<Order>,
    /// Where the direction of sliding is known, in the order of time.
    pub points: Vec<Point>,
    /// The axis that carries it best: of a share, or [`Axis::Wave`] for a ripple.
    pub axis: Axis,
    /// Names of the effects behind [`Point::explained`].
    pub explained_by: Vec<&'static str>,
    /// Share of the samples in which dry friction may hold, so that nothing is known of what is missing.
    pub held_share: f64,
}

impl MissingTorque {
    /// Shares and size.
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

    /// Its instants, of which nothing is explained yet.
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

    /// What is to be seen of it. What explains it is the device `found` with its effects `names`, or else the best proposal.
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
        let field = Field::of(&self.recording, &path, &smoother, &rows, &torque);
        let proposals = field.shortlist(PROPOSALS);
        let is_found = found.is_some();
        let (explained, explained_by) = match found {
            Some((device, names)) => {
                // J' a = T', so that J a − T = J/J' T' − T.
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
                (field.explained(&names), names)
            }
        };
        let points = self.points().into_iter().enumerate();
        let points = points.map(|(i, point)| Point {
            explained: explained.get(i).copied().unwrap_or(0.0),
            ..point
        });
        let named = explained_by.first().filter(|_| is_found);
        let axis = named
            .and_then(|name| effects::find(name))
            .map(|effect| effect.axis());
        let axis = axis.unwrap_or_else(|| carrying(&summary.shares, proposals.first()));
        let orders = orders(&path, &smoother, &rows, &target, corner);
        let axis = if axis == Axis::Wave && orders.is_empty() {
            Axis::Position
        } else {
            axis
        };
        let held = sliding.iter().filter(|slides| !**slides).count();
        Look {
            points: points.collect(),
            summary,
            proposals,
            orders,
            axis,
            explained_by,
            held_share: held as f64 / sliding.len().max(1) as f64,
        }
    }
}

/// Axes that a picture can have.
const DRAWN: [Axis; 7] = [
    Axis::Velocity,
    Axis::Position,
    Axis::Input,
    Axis::Load,
    Axis::Acceleration,
    Axis::Time,
    Axis::DirectionAndPosition,
];
/// Share by which named effects must explain more than a function of one axis for theirs to be drawn.
const CLEARLY_MORE: f64 = 0.1;

/// The axis that explains most, unless the first effect that is proposed has another and explains clearly more.
fn carrying(shares: &[Share], proposal: Option<&Proposal>) -> Axis {
    let most = shares.iter().find(|share| DRAWN.contains(&share.axis));
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
    /// Names of its effects.
    pub fn names(&self) -> Vec<&'static str> {
        self.effects.iter().map(|(name, _)| *name).collect()
    }
}
