//! The hardware around the control core: actuator, mechanics and sensors with their converters.

use crate::device::Device;
use crate::drive::{Drive, DriveLine};
use crate::motor::{Motor, Winding};
use crate::plant::{Plant, State};
use crate::sensing::{Reading, Sensing};
use crate::sensors::{CurrentAmplifier, Encoder, Hall, HallReader, Noise};
use haptic_paddle::controller::{Duty, Measurement};
use haptic_paddle::settings::{Sensor, Settings};

/// How the command of the controller becomes torque at the motor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Actuator {
    /// Exactly the commanded torque. The duty is ignored.
    Ideal,
    /// The duty acts through bridge and winding.
    Bridge(Motor),
}

/// The controller's command to the actuator for one tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Command {
    /// Duty of the bridge, −1 to 1: mean voltage over supply.
    pub duty: Duty,
    /// Commanded torque, N m at the motor.
    pub torque_nm: f32,
}

/// Settings of a simulated paddle.
#[derive(Clone, Debug)]
pub struct PaddleSetup {
    /// Drive, mechanics, and the sensing effects before the sensor that feeds the regulator.
    pub device: Device,
    /// The actuator.
    pub actuator: Actuator,
    /// Top of the bridge's timer, which quantises the duty. `None` for a continuous duty.
    pub bridge_top: Option<u16>,
    /// Sensor of the motor current.
    pub amplifier: CurrentAmplifier,
    /// Errors of the Hall sensor.
    pub hall: Hall,
    /// Initial count of the encoder.
    pub encoder_count: u32,
    /// Initial position, at rest, rad.
    pub start_rad: f64,
    /// Initial time of the session, s.
    pub start_s: f64,
    /// Seed of all noise.
    pub seed: u64,
    /// Number of equal parts into which a tick is divided, 1 or more. For convergence studies.
    pub parts_per_tick: u32,
}

impl PaddleSetup {
    /// `device` at rest at 0 rad with an ideal actuator, and the sensors that `settings` describe.
    pub fn new(device: Device, settings: &Settings) -> Self {
        Self {
            device,
            actuator: Actuator::Ideal,
            bridge_top: None,
            amplifier: CurrentAmplifier::default(),
            hall: Hall::calibrated(&settings.hall),
            encoder_count: 0,
            start_rad: 0.0,
            start_s: 0.0,
            seed: 0,
            parts_per_tick: 1,
        }
    }
}

/// A simulated paddle with its motor and sensors.
///
/// The sensing effects of the device act on the sensor that feeds the regulator. The other sensor reads the true position.
#[derive(Clone, Debug)]
pub struct Paddle {
    plant: Plant,
    state: State,
    drive: Drive,
    line: DriveLine,
    /// Winding of the motor. `None` for an ideal actuator.
    winding: Option<Winding>,
    bridge_top: Option<u16>,
    amperes_per_nm: f64,
    current_a: f64,
    sensing: Sensing,
    reading: Reading,
    sensed: Sensor,
    encoder: Encoder,
    hall: HallReader,
    amplifier: CurrentAmplifier,
    noise: Noise,
    ratio: f64,
    parts_per_tick: u32,
    share_of_part: f64,
    tick_s: f64,
}

impl Paddle {
    /// The paddle of `setup`, with ticks of `tick_s`.
    pub fn new(setup: &PaddleSetup, settings: &Settings, tick_s: f64) -> Self {
        let device = &setup.device;
        let plant = Plant::new(device.mechanics.clone());
        let ratio = f64::from(settings.mechanism.ratio);
        let parts_per_tick = setup.parts_per_tick.max(1);
        let share_of_part = 1.0 / f64::from(parts_per_tick);
        let part_s = tick_s * share_of_part;
        let reading = Reading::at_rest(&device.sensing, setup.start_rad);
        // The sensors start at rest at their readings, including sensing effects.
        let affected = device.sensing.curve(setup.start_rad) + device.sensing.jumped(setup.start_s);
        let [encoder_rad, hall_rad] =
            before_sensors(settings.estimate.sensor, setup.start_rad, affected);
        Self {
            state: plant.state(setup.start_s, setup.start_rad, 0.0),
            plant,
            line: DriveLine::at_rest(&device.drive),
            drive: device.drive.clone(),
            winding: match setup.actuator {
                Actuator::Ideal => None,
                Actuator::Bridge(motor) => {
                    let acceleration_per_nm = ratio * device.drive.ratio / device.mechanics.inertia;
                    Some(Winding::without_current(motor, acceleration_per_nm, part_s))
                }
            },
            bridge_top: setup.bridge_top,
            amperes_per_nm: 1.0 / f64::from(settings.motor.torque_constant_nm_per_a),
            current_a: 0.0,
            sensing: device.sensing.clone(),
            reading,
            sensed: settings.estimate.sensor,
            encoder: Encoder::new(&settings.mechanism, encoder_rad, setup.encoder_count),
            hall: HallReader::at_rest(setup.hall.clone(), hall_rad),
            amplifier: setup.amplifier,
            noise: Noise::new(setup.seed),
            ratio,
            parts_per_tick,
            share_of_part,
            tick_s,
        }
    }

    /// Reads all sensors. It must be called once per tick.
    #[inline]
    pub fn measure(&mut self) -> Measurement {
        let position_rad = self.position_rad();
        let affected_rad = self
            .reading
            .follow(&self.sensing, position_rad, self.tick_s)
            + self.sensing.jumped(self.state.time_s);
        let [encoder_rad, hall_rad] = before_sensors(self.sensed, position_rad, affected_rad);
        Measurement {
            encoder_count: self.encoder.count(encoder_rad),
            hall_adc: self.hall.count(hall_rad, self.tick_s, &mut self.noise),
            current_adc: self.amplifier.counts(self.current_a, &mut self.noise),
        }
    }

    /// Simulates one tick under `command`.
    #[inline]
    pub fn advance(&mut self, mut command: Command) {
        if let Some(top) = self.bridge_top {
            command.duty = command.duty.stepped(top);
        }
        self.current_a = 0.0;
        for _ in 0..self.parts_per_tick {
            self.current_a += self.advance_part(command) * self.share_of_part;
        }
    }

    /// Simulates one tick with the bridge off: no current, so neither drive nor brake. The current of the winding is set to
    /// zero at once. In reality it takes 30 µs at the rated current.
    pub fn coast(&mut self) {
        self.current_a = 0.0;
        if let Some(winding) = &mut self.winding {
            winding.open();
        }
        let (now_s, velocity) = (self.state.time_s, self.state.velocity);
        self.line.command(&self.drive, now_s, 0.0, velocity);
        self.carry(self.tick_s);
    }

    /// Simulates one part of a tick. Returns the mean current over it, A.
    #[inline]
    fn advance_part(&mut self, command: Command) -> f64 {
        let now_s = self.state.time_s;
        let duty = f64::from(command.duty.0);
        let torque_nm = f64::from(command.torque_nm);
        let velocity = self.state.velocity;
        let before_rad_s = self.ratio * velocity;
        match &self.winding {
            None => self.line.command(&self.drive, now_s, torque_nm, velocity),
            Some(winding) => {
                let made = winding.torque(duty, before_rad_s);
                self.line
                    .command_through(&self.drive, now_s, torque_nm, velocity, made);
            }
        }
        self.carry(self.tick_s * self.share_of_part);
        let after_rad_s = self.ratio * self.state.velocity;
        match &mut self.winding {
            None => torque_nm * self.amperes_per_nm,
            Some(winding) => winding.advance(duty, [before_rad_s, after_rad_s]),
        }
    }

    #[inline]
    fn carry(&mut self, dt_s: f64) {
        self.line.carry(&self.plant, &mut self.state, dt_s);
    }

    /// Time since the start of the session, s.
    pub fn time_s(&self) -> f64 {
        self.state.time_s
    }

    /// True position at the position sensor, rad.
    #[inline]
    pub fn position_rad(&self) -> f64 {
        self.plant.seen(&self.state).0
    }

    /// True velocity at the position sensor, rad/s.
    pub fn velocity_rad_s(&self) -> f64 {
        self.plant.seen(&self.state).1
    }

    /// Mean motor current over the last tick, A.
    #[inline]
    pub fn current_a(&self) -> f64 {
        self.current_a
    }
}

/// Positions at the encoder and at the Hall sensor. Sensing effects apply to the sensor that feeds the regulator.
#[inline]
fn before_sensors(regulating: Sensor, position_rad: f64, affected_rad: f64) -> [f64; 2] {
    match regulating {
        Sensor::Encoder => [affected_rad, position_rad],
        Sensor::Hall => [position_rad, affected_rad],
    }
}
