//! The torques of a device along a measured motion.

use super::samples::Samples;
use super::smoother::Smoothed;
use host_sim::device::Device;
use host_sim::effects::Kind;
use host_sim::plant::Mechanics;
use std::sync::OnceLock;

/// A smoothed motion in steps, with the torques of a device along it. Each column has one value per step. A step of zero length ends a
/// stretch.
#[derive(Clone, Debug)]
pub(crate) struct Path<'a> {
    pub samples: &'a Samples,
    /// The device whose torque is subtracted.
    pub device: &'a Device,
    /// Drive torque of that device.
    pub drive: Vec<f64>,
    /// Position in the middle of each step.
    pub position: Vec<f64>,
    /// Mean velocity over each step, in position units per s.
    pub velocity: Vec<f64>,
    /// Direction of sliding, from −1 to 1. In a step with a reversal it is the mean of both directions.
    pub direction: Vec<f64>,
    /// True if the direction of sliding is known.
    pub sliding: Vec<bool>,
    /// Magnitudes of the motion.
    pub scale: Scale,
    /// Torque of the device over each step, computed at the first request.
    nominal: OnceLock<Vec<f64>>,
}

/// Magnitudes of a motion.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scale {
    /// Lowest and highest position.
    pub range: [f64; 2],
    /// Rms velocity, in position units per s.
    pub velocity: f64,
    /// Rms drive torque.
    pub torque: f64,
    /// Largest magnitude of the input.
    pub input: f64,
    /// First and last instant of the session, s.
    pub session_s: [f64; 2],
}

impl Scale {
    /// Half of the range of the position.
    pub fn half_span(&self) -> f64 {
        (0.5 * (self.range[1] - self.range[0])).max(f64::MIN_POSITIVE)
    }

    /// Middle of the range of the position.
    pub fn middle(&self) -> f64 {
        0.5 * (self.range[0] + self.range[1])
    }

    /// A torque that is small compared with the drive torque.
    pub fn torque_step(&self) -> f64 {
        0.2 * self.torque
    }

    /// Angular frequency of a sine with this range and rms velocity, rad/s.
    pub fn rate(&self) -> f64 {
        core::f64::consts::SQRT_2 * self.velocity / self.half_span()
    }
}

impl<'a> Path<'a> {
    /// The smoothed motion with the torques of `device`.
    pub fn along(
        samples: &'a Samples,
        device: &'a Device,
        drive: &[f64],
        smoothed: &Smoothed,
        is_sliding: &[bool],
    ) -> Self {
        let n = samples.len();
        let next = |row: usize| {
            if samples.step_s[row] > 0.0 {
                row + 1
            } else {
                row
            }
        };
        let rows = 0..n;
        let position = rows.clone().map(|i| {
            let (x, y) = (smoothed.position[i], smoothed.position[next(i)]);
            0.5 * (x + y)
        });
        let position: Vec<f64> = position.collect();
        let velocity = rows.clone().map(|i| {
            let (v, w) = (smoothed.velocity[i], smoothed.velocity[next(i)]);
            0.5 * (v + w)
        });
        let velocity: Vec<f64> = velocity.collect();
        let direction = rows.clone().map(|i| {
            let (v, w) = (smoothed.velocity[i], smoothed.velocity[next(i)]);
            if v * w < 0.0 {
                (w.abs() - v.abs()) / (v.abs() + w.abs()) * w.signum()
            } else {
                sign(v + w)
            }
        });
        let direction: Vec<f64> = direction.collect();
        let sliding = rows.map(|i| is_sliding[i] || is_sliding[next(i)]).collect();
        let rms =
            |values: &[f64]| (values.iter().map(|v| v * v).sum::<f64>() / n.max(1) as f64).sqrt();
        let ends = |[low, high]: [f64; 2], x: &f64| [low.min(*x), high.max(*x)];
        let none = [f64::INFINITY, f64::NEG_INFINITY];
        let scale = Scale {
            range: position.iter().fold(none, ends),
            velocity: rms(&velocity).max(f64::MIN_POSITIVE),
            torque: rms(drive).max(f64::MIN_POSITIVE),
            input: samples
                .input
                .iter()
                .fold(f64::MIN_POSITIVE, |m: f64, u| u.abs().max(m)),
            session_s: samples.session_s.iter().fold(none, ends),
        };
        Self {
            samples,
            device,
            drive: drive.to_vec(),
            position,
            velocity,
            direction,
            sliding,
            scale,
            nominal: OnceLock::new(),
        }
    }

    /// Drive torque of another device.
    pub fn drive_of(&self, device: &Device) -> Vec<f64> {
        if device.drive == self.device.drive {
            self.drive.clone()
        } else {
            self.samples.drive(&device.drive)
        }
    }

    /// Total torque on the inertia of a device over each step, without its viscous friction and its linear spring.
    pub fn force(&self, device: &Device, drive: &[f64]) -> Vec<f64> {
        let m = &device.mechanics;
        let steps = (0..self.position.len()).map(|i| {
            let at = self.at(i);
            torque(m, drive[i], &at) + m.viscous * at.velocity + m.stiffness * at.position
        });
        steps.collect()
    }

    /// Total torque on the inertia of a device over each step.
    pub fn torque(&self, device: &Device) -> Vec<f64> {
        let drive = self.drive_of(device);
        (0..drive.len())
            .map(|i| torque(&device.mechanics, drive[i], &self.at(i)))
            .collect()
    }

    /// Torque of `device` along the motion less that of the device of this path.
    pub fn added_torque(&self, device: &Device) -> Vec<f64> {
        let nominal = self.nominal.get_or_init(|| self.torque(self.device));
        if device.mechanics == self.device.mechanics && !self.has_friction() {
            // Without friction, a change of the drive torque is simply added.
            let pairs = self.drive_of(device).into_iter().zip(&self.drive);
            return pairs.map(|(with, without)| with - without).collect();
        }
        let mut with = self.torque(device);
        with.iter_mut()
            .zip(nominal)
            .for_each(|(with, without)| *with -= without);
        with
    }

    /// Torque that an effect with given parameters adds to the device of this path.
    pub fn torque_of(&self, kind: &Kind, values: &[f64]) -> Vec<f64> {
        let mut device = self.device.clone();
        kind.install(&mut device, values);
        self.added_torque(&device)
    }

    /// Torque that a rigid transmission transmits to a load with the whole inertia, over each step.
    pub fn transmitted_torque(&self) -> Vec<f64> {
        let m = &self.device.mechanics;
        let net = self.torque(self.device);
        let steps = net.iter().enumerate();
        steps
            .map(|(i, net)| {
                let level = m.friction.level(self.direction[i]);
                net + m.viscous * self.velocity[i] + level * self.direction[i]
            })
            .collect()
    }

    /// The higher Coulomb friction level of both directions, or 0 without Coulomb friction.
    pub fn friction_level(&self) -> f64 {
        self.device.mechanics.friction.highest_nm()
    }

    fn has_friction(&self) -> bool {
        !self.device.mechanics.friction.is_none()
    }

    /// The state of the motion in the middle of a step.
    pub fn at(&self, i: usize) -> Moment {
        Moment {
            time_s: self.samples.session_s[i],
            position: self.position[i],
            velocity: self.velocity[i],
            direction: self.direction[i],
            is_sliding: self.sliding[i],
        }
    }
}

/// The state of a motion at an instant.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moment {
    /// Time on the clock of the session, s.
    pub time_s: f64,
    pub position: f64,
    /// Velocity, in position units per s.
    pub velocity: f64,
    /// Direction of sliding, from −1 to 1.
    pub direction: f64,
    /// True if the direction of sliding is known.
    pub is_sliding: bool,
}

/// Total torque on the inertia at an instant.
pub(crate) fn torque(m: &Mechanics, drive: f64, at: &Moment) -> f64 {
    let (x, v) = (at.position, at.velocity);
    let passive = m.spring(x) - m.gravity * m.from_hanging_rad(x).sin();
    let mut without_friction = drive + m.offset_nm + passive - (m.viscous + m.drag * v.abs()) * v;
    if let Some(cogging) = &m.cogging {
        without_friction += cogging.torque(x);
    }
    for law in &m.laws {
        without_friction += law.torque_nm(x, v, drive, at.time_s);
    }
    for barrier in m.barriers.iter().flatten() {
        if barrier.is_there(at.time_s) {
            without_friction += barrier.torque(barrier.touch(x, v), x, v);
        }
    }
    if m.friction.is_none() {
        return without_friction;
    }
    let side = if at.direction < 0.0 { -1.0 } else { 1.0 };
    let transmitted = drive + m.friction.load_passive * passive;
    if at.is_sliding {
        let level = m.friction.sliding(side, x, v.abs(), at.time_s, transmitted);
        without_friction - at.direction * level
    } else {
        // Static friction balances the other torques up to its level.
        let side_of_push = if without_friction < 0.0 { -1.0 } else { 1.0 };
        let level = m.friction.holding(side_of_push, x, at.time_s, transmitted);
        without_friction - without_friction.clamp(-level.abs(), level.abs())
    }
}

/// Sign of a value: −1, 0 or 1.
pub(crate) fn sign(value: f64) -> f64 {
    if value > 0.0 {
        1.0
    } else if value < 0.0 {
        -1.0
    } else {
        0.0
    }
}
