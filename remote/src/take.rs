//! Runs an experiment on the board.

use haptic_paddle::controller::Mode;
use haptic_paddle::safety::Fault;
use haptic_paddle::sensing::current::OffsetError;
use link::{Channel, Channels};

use crate::wire::Wire;
use crate::{Device, DeviceError, Plan, Row};

/// Control periods per second.
pub(crate) const TICK_HZ: f64 = 20_000.0;
/// Time for the paddle to reach the middle, s.
const CENTRE_S: f64 = 0.8;
/// Longest time without a row, s.
const PATIENCE_S: f64 = 2.0;
/// A run that a fault ended is kept if it has at least this length, s.
const LEAST_S: f64 = 1.5;

/// The result of an experiment.
#[derive(Clone, Debug)]
pub struct Taken {
    /// The requested experiment.
    pub plan: Plan,
    /// The received rows.
    pub rows: Vec<Row>,
    /// Number of lost rows.
    pub lost: u64,
    /// What ended it early, if anything.
    pub fault: Option<String>,
}

impl Taken {
    /// True if the encoder moved. A run without motion cannot be part of a recording.
    pub fn moves(&self) -> bool {
        let position = |row: &Row| row.value(Channel::Encoder);
        self.rows
            .windows(2)
            .any(|pair| position(&pair[0]) != position(&pair[1]))
    }
}

/// Connection to the user, who follows an experiment and can stop it.
pub trait Progress {
    /// Reports the completed fraction of the run, 0 to 1.
    fn done(&mut self, share: f64);

    /// Returns true if the user wants to stop.
    fn ends(&self) -> bool;
}

/// Share of the travel at which a torque-driven paddle is released.
const GUARD: f32 = 0.7;
/// Share of the travel beyond which the paddle must not come to rest, because it could not be armed again.
const LAST: f32 = 0.9;
/// Time from a row until the paddle is braked, s, for the extrapolation of its motion. It is the sum of the console's
/// interval (10 ms), the transmission, and the braking time constant of the lab's paddle with a shorted motor (9.4 ms).
const STOPS_S: f32 = 0.03;
/// Longest wait for a moving paddle to come to rest, s. Each attempt to arm it brakes it, because the bridge shorts the
/// motor while the current offset is measured. One attempt leaves the lab's paddle a hundredth of its speed.
const STANDS_S: f64 = 2.0;
/// Interval between attempts to arm, s.
const TRIAL_S: f64 = 0.05;
/// Message for a run that ended because the paddle moved too far.
const TOO_FAR: &str = "the paddle came near the end of its travel";

/// Runs `plan` and logs `rate_hz` rows per second. It moves the paddle to the middle, arms it, starts the excitation, and
/// disarms it. The paddle is disarmed afterwards in every case.
///
/// # Errors
///
/// [`DeviceError`], and [`DeviceError::Ended`] if the user stops it.
pub fn take<W: Wire>(
    device: &mut Device<W>,
    plan: &Plan,
    rate_hz: f64,
    progress: &mut impl Progress,
) -> Result<Taken, DeviceError> {
    let taken = run_plan(device, plan, rate_hz, progress);
    if taken.is_err() {
        // Errors are ignored here, because the board may not answer any more.
        let _ = device.stop();
        let _ = device.end_stream();
        let _ = device.command("disarm");
    }
    taken
}

fn run_plan<W: Wire>(
    device: &mut Device<W>,
    plan: &Plan,
    rate_hz: f64,
    progress: &mut impl Progress,
) -> Result<Taken, DeviceError> {
    device.command("disarm")?;
    arm_at_rest(device, Mode::Position, progress)?;
    device.expect("ref 0", "mode position")?;
    rest(device, CENTRE_S, progress)?;
    if let Some(fault) = latched_fault(device)? {
        device.command("clear")?;
        return Err(DeviceError::Fault(fault));
    }
    if plan.mode == Mode::Torque {
        device.command("disarm")?;
        arm_at_rest(device, Mode::Torque, progress)?;
    }
    let travel_rad = device.travel_rad();
    let goes_too_far = |row: &Row| {
        let at_rad = row.value(Channel::Encoder);
        let stands_rad = at_rad + STOPS_S * row.value(Channel::Velocity);
        at_rad.abs() > GUARD * travel_rad || stands_rad.abs() > LAST * travel_rad
    };
    device.stream(Channels::ALL, rate_hz)?;
    rest(device, plan.before_s(), progress)?;
    device.expect(&plan.start_line(), &format!("mode {}", plan.mode_name()))?;
    let mut rows = device.take_rows();
    let begun = rows.last().map_or(0, |row| row.period);
    let periods = ((plan.signal_s() + plan.after_s()) * TICK_HZ) as u32;
    let mut heard_s = device.time_s();
    let mut fault = None;
    let mut too_far = false;
    loop {
        if progress.ends() {
            return Err(DeviceError::Ended);
        }
        device.listen()?;
        let new = device.take_rows();
        if new.is_empty() {
            if device.time_s() - heard_s > PATIENCE_S {
                return Err(DeviceError::Silent);
            }
            continue;
        }
        heard_s = device.time_s();
        for row in new {
            if row.value(Channel::Fault) != 0.0 {
                fault.get_or_insert(row.period);
            }
            too_far |= plan.mode == Mode::Torque && goes_too_far(&row);
            if fault.is_none() && !too_far {
                rows.push(row);
            }
        }
        if too_far {
            device.stop()?;
        }
        let gone = rows.last().map_or(0, |row| row.period.wrapping_sub(begun));
        progress.done(f64::from(gone) / f64::from(periods));
        if gone >= periods || fault.is_some() || too_far {
            break;
        }
    }
    let lost = device.lost();
    if too_far {
        // Brakes the paddle within its travel. If that fails, the next run reports it.
        let _ = device.command("arm position")?;
    }
    if fault.is_some() {
        device.let_it_speak()?;
    }
    let fault = match fault {
        Some(_) => Some(latched_fault(device)?.unwrap_or_else(|| "a fault".to_owned())),
        None => too_far.then(|| TOO_FAR.to_owned()),
    };
    device.end_stream()?;
    device.command("disarm")?;
    if lost > 0 {
        return Err(DeviceError::Lost {
            lost,
            all: rows.len() as u64 + lost,
        });
    }
    if let Some(what) = &fault {
        device.command("clear")?;
        let ran_s = rows.len() as f64 / rate_hz;
        if ran_s < LEAST_S {
            return Err(DeviceError::Fault(what.clone()));
        }
    }
    Ok(Taken {
        plan: plan.clone(),
        rows,
        lost,
        fault,
    })
}

/// Arms a mode. Repeats the attempt while the motion of the paddle is the only obstacle.
///
/// # Errors
///
/// [`DeviceError::Fault`] if the paddle does not come to rest within its travel, and the other [`DeviceError`]s.
fn arm_at_rest<W: Wire>(
    device: &mut Device<W>,
    mode: Mode,
    progress: &impl Progress,
) -> Result<(), DeviceError> {
    let passing = [OffsetError::Restless.to_string(), Fault::Travel.to_string()];
    let end_s = device.time_s() + STANDS_S;
    loop {
        match device.expect(&format!("arm {mode}"), &format!("mode {mode}")) {
            Err(DeviceError::Refused { answer, .. })
                if passing.iter().any(|why| answer.contains(why)) =>
            {
                device.command("clear")?;
                if device.time_s() >= end_s {
                    return Err(DeviceError::Fault(answer));
                }
                rest(device, TRIAL_S, progress)?;
            }
            other => return other.map(drop),
        }
    }
}

/// Waits for this time and sends heartbeats.
fn rest<W: Wire>(
    device: &mut Device<W>,
    seconds: f64,
    progress: &impl Progress,
) -> Result<(), DeviceError> {
    let end_s = device.time_s() + seconds;
    while device.time_s() < end_s {
        if progress.ends() {
            return Err(DeviceError::Ended);
        }
        device.listen()?;
    }
    Ok(())
}

/// The latched fault as the board names it, if there is one.
fn latched_fault<W: Wire>(device: &mut Device<W>) -> Result<Option<String>, DeviceError> {
    let status = device.command("status")?;
    let fault = status.lines().find_map(|line| line.strip_prefix("fault: "));
    Ok(fault.map(str::to_owned))
}
