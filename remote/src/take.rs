//! Carries an experiment out.

use haptic_paddle::controller::Mode;
use haptic_paddle::safety::Fault;
use haptic_paddle::sensing::current::OffsetError;
use link::{Channel, Channels};

use crate::wire::Wire;
use crate::{Device, DeviceError, Plan, Row};

/// Control periods a second.
pub(crate) const TICK_HZ: f64 = 20_000.0;
/// How long the paddle gets to come to the middle, s.
const CENTRE_S: f64 = 0.8;
/// Longest time without a row, s.
const PATIENCE_S: f64 = 2.0;
/// A run that a fault ended is kept if it has as much, s.
const LEAST_S: f64 = 1.5;

/// What an experiment gave.
#[derive(Clone, Debug)]
pub struct Taken {
    /// What was asked for.
    pub plan: Plan,
    /// Its rows.
    pub rows: Vec<Row>,
    /// Rows that were lost on the way.
    pub lost: u64,
    /// What ended it too soon.
    pub fault: Option<String>,
}

impl Taken {
    /// Whether the encoder saw the paddle move. A recording with a run in which nothing moves is refused.
    pub fn moves(&self) -> bool {
        let position = |row: &Row| row.value(Channel::Encoder);
        self.rows
            .windows(2)
            .any(|pair| position(&pair[0]) != position(&pair[1]))
    }
}

/// How the user follows an experiment, and ends it.
pub trait Progress {
    /// So much of the run is done, 0 to 1.
    fn done(&mut self, share: f64);

    /// Whether the user wants to end.
    fn ends(&self) -> bool;
}

/// Share of its travel at which a paddle that is driven by torque is let go, and beyond which it must not come to a stand: it could
/// not be armed again there.
const GUARD: f32 = 0.7;
const LAST: f32 = 0.9;
/// Time from a row until the paddle has been braked, s, as if it had gone on as fast: a look of the console (10 ms), the line, and
/// the time constant of the lab's paddle on a shorted motor (9.4 ms).
const STOPS_S: f32 = 0.03;
/// How long a paddle that moves is waited for until it can be armed, s, and between two trials. Each trial brakes it, as the bridge
/// shorts the motor while its current is read: the lab's paddle loses all but a hundredth of its speed in one.
const STANDS_S: f64 = 2.0;
const TRIAL_S: f64 = 0.05;
/// Why a run ended there.
const TOO_FAR: &str = "the paddle came near the end of its travel";

/// Carries `plan` out, with so many rows a second: brings the paddle to the middle, arms it, starts the signal, and
/// disarms it. Whatever happens, the paddle is disarmed afterwards.
///
/// # Errors
/// [`DeviceError`]; [`DeviceError::Ended`] if the user wants to end.
pub fn take<W: Wire>(
    device: &mut Device<W>,
    plan: &Plan,
    rate_hz: f64,
    progress: &mut impl Progress,
) -> Result<Taken, DeviceError> {
    let taken = carry_out(device, plan, rate_hz, progress);
    if taken.is_err() {
        // As far as anybody listens.
        let _ = device.stop();
        let _ = device.end_stream();
        let _ = device.command("disarm");
    }
    taken
}

fn carry_out<W: Wire>(
    device: &mut Device<W>,
    plan: &Plan,
    rate_hz: f64,
    progress: &mut impl Progress,
) -> Result<Taken, DeviceError> {
    device.command("disarm")?;
    arm_standing(device, Mode::Position, progress)?;
    device.expect("ref 0", "mode position")?;
    rest(device, CENTRE_S, progress)?;
    if plan.mode == Mode::Torque {
        device.command("disarm")?;
        arm_standing(device, Mode::Torque, progress)?;
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
        // Brakes it before it is beyond its travel; what cannot be braked is told by the next run.
        let _ = device.command("arm position")?;
    }
    if fault.is_some() {
        device.let_it_speak()?;
    }
    let fault = match fault {
        Some(_) => Some(what_went_wrong(device)?),
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

/// Arms a mode, again and again while nothing but the paddle's motion is against it.
fn arm_standing<W: Wire>(
    device: &mut Device<W>,
    mode: Mode,
    progress: &impl Progress,
) -> Result<(), DeviceError> {
    let passing = [OffsetError::Restless.to_string(), Fault::Travel.to_string()];
    let end_s = device.time_s() + STANDS_S;
    loop {
        match device.expect(&format!("arm {mode}"), &format!("mode {mode}")) {
            Err(DeviceError::Refused { answer, .. })
                if device.time_s() < end_s && passing.iter().any(|why| answer.contains(why)) =>
            {
                device.command("clear")?;
                rest(device, TRIAL_S, progress)?;
            }
            other => return other.map(drop),
        }
    }
}

/// Waits for so long, and gives signs of life.
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

/// The latched fault, in the board's own words.
fn what_went_wrong<W: Wire>(device: &mut Device<W>) -> Result<String, DeviceError> {
    let status = device.command("status")?;
    let fault = status.lines().find_map(|line| line.strip_prefix("fault: "));
    Ok(fault.unwrap_or("a fault").to_owned())
}
