//! Simulates the readings of the position sensor of a device under an excitation.

use haptic_paddle::excitation::{Excitation, Generator};
use host_sim::device::Device;
use host_sim::drive::DriveLine;
use host_sim::plant::Plant;
use host_sim::sensing::Reading;

/// The conditions of a trial.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Setting {
    /// Start of the trial on the clock of the session, s. It lies after all events of the recording.
    pub start_s: f64,
    /// Position at the start, at standstill.
    pub rest: f64,
    /// Range of positions that the device must not leave.
    pub range: [f64; 2],
    /// Time between two readings, s.
    pub tick_s: f64,
}

/// Readings of a noise-free sensor at each tick. Returns `None` if the device leaves the range, or if the excitation is not valid for
/// this tick.
pub(super) fn readings(device: &Device, excitation: &Excitation, at: &Setting) -> Option<Vec<f64>> {
    let mut generator = Generator::new(excitation, at.tick_s as f32).ok()?;
    let plant = Plant::quick(device.mechanics.clone());
    let mut state = plant.state(at.start_s, at.rest, 0.0);
    let mut line = DriveLine::at_rest(&device.drive);
    let mut reading = Reading::at_rest(&device.sensing, at.rest);
    let ticks = (f64::from(excitation.duration_s) / at.tick_s).round() as usize;
    let mut readings = Vec::with_capacity(ticks);
    for tick in 0..ticks {
        let (seen, _) = plant.seen(&state);
        if !(at.range[0]..=at.range[1]).contains(&seen) {
            return None;
        }
        let dt_s = if tick == 0 { 0.0 } else { at.tick_s };
        let reading_value = reading.follow(&device.sensing, seen, dt_s);
        readings.push(reading_value);
        // A ramp ends after the break-away of the device.
        let input = generator.next(reading_value as f32).unwrap_or(0.0);
        let now_s = state.time_s;
        line.command(&device.drive, now_s, f64::from(input), state.velocity);
        line.carry(&plant, &mut state, at.tick_s);
    }
    Some(readings)
}

#[cfg(test)]
mod tests {
    use super::*;
    use recording::Model;

    const AT: Setting = Setting {
        start_s: 100.0,
        rest: 0.0,
        range: [-10.0, 10.0],
        tick_s: 1e-3,
    };

    fn step(input: f32) -> Excitation {
        Excitation {
            duration_s: 1.0,
            ..Excitation::step(input)
        }
    }

    #[test]
    fn a_constant_torque_gives_a_parabola() {
        let device = Device::nominal(&Model::new(2.0));
        let readings = readings(&device, &step(4.0), &AT).unwrap();
        assert_eq!(readings.len(), 1000);
        assert!((readings[500] - 0.25).abs() < 1e-9);
    }

    #[test]
    fn a_device_that_leaves_the_range_gives_no_readings() {
        let device = Device::nominal(&Model::new(2.0));
        let narrow = Setting {
            range: [-0.1, 0.1],
            ..AT
        };
        assert_eq!(readings(&device, &step(4.0), &narrow), None);
    }
}
