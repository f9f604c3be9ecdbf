//! Carries an experiment out.

use haptic_paddle::controller::Mode;
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

/// How the user follows an experiment, and ends it.
pub trait Progress {
    /// So much of the run is done, 0 to 1.
    fn done(&mut self, share: f64);

    /// Whether the user wants to end.
    fn ends(&self) -> bool;
}

/// Share of its travel at which a paddle that is driven by torque is let go: it coasts on, and beyond its travel it could
/// not be armed again.
const GUARD: f32 = 0.7;
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
    device.expect("arm position", "mode position")?;
    device.expect("ref 0", "mode position")?;
    rest(device, CENTRE_S, progress)?;
    if plan.mode == Mode::Torque {
        device.command("disarm")?;
        device.expect(
            &format!("arm {}", plan.mode_name()),
            &format!("mode {}", plan.mode_name()),
        )?;
    }
    let farthest_rad = GUARD * device.travel_rad();
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
            too_far |=
                plan.mode == Mode::Torque && row.value(Channel::Encoder).abs() > farthest_rad;
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
