//! The hardware around the control core: what the board drives and what its converters read.

use crate::device::Device;
use crate::drive::{Drive, DriveLine};
use crate::motor::{Motor, Winding};
use crate::plant::{Plant, State};
use crate::sensing::{Reading, Sensing};
use crate::sensors::{CurrentAmplifier, Encoder, Hall, HallReader, Noise};
use haptic_paddle::controller::{Duty, Measurement};
use haptic_paddle::settings::{Sensor, Settings};

/// How the controller's command becomes torque at the motor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Actuator {
    /// The torque that the position loop asks for, exactly; the duty is ignored.
    Ideal,
    /// The duty, through bridge and winding.
    Bridge(Motor),
}

/// The controller's command to the actuator for one tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Command {
    /// Duty of the bridge, −1 to 1: mean voltage over supply.
    pub duty: Duty,
    /// Torque that the duty is to make, N m at the motor.
    pub torque_nm: f32,
}

/// Everything that a simulated paddle is made from.
#[derive(Clone, Debug)]
pub struct PaddleSetup {
    /// Drive, mechanics, and what lies between the position and the regulating sensor.
    pub device: Device,
    /// How the torque is made.
    pub actuator: Actuator,
    /// Counts of the bridge's timer in a period, which quantise the duty; `None` for a continuous duty.
    pub bridge_top: Option<u16>,
    /// Sensor of the motor current.
    pub amplifier: CurrentAmplifier,
    /// Errors of the Hall sensor alone.
    pub hall: Hall,
    /// Encoder counter at the start, counts.
    pub encoder_count: u32,
    /// Where it stands at rest at the start, rad.
    pub start_rad: f64,
    /// Time of the session at the start, s.
    pub start_s: f64,
    /// Seed of all noise.
    pub seed: u64,
    /// Number of equal parts in which a tick is simulated, 1 or more: for studies of convergence.
    pub parts_per_tick: u32,
}

impl PaddleSetup {
    /// `device` at rest at 0 rad, driven by exactly the commanded torque, with the sensors that `settings` expect.
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
/// The device's sensing effects act on the sensor that feeds the regulator; the other one reads the true position.
#[derive(Clone, Debug)]
pub struct Paddle {
    plant: Plant,
    state: State,
    drive: Drive,
    line: DriveLine,
    /// `None` makes exactly the commanded torque.
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
    /// The paddle of `setup`, measured and driven every `tick_s`.
    pub fn new(setup: &PaddleSetup, settings: &Settings, tick_s: f64) -> Self {
        let device = &setup.device;
        let plant = Plant::new(device.mechanics.clone());
        let ratio = f64::from(settings.mechanism.ratio);
        let parts_per_tick = setup.parts_per_tick.max(1);
        let share_of_part = 1.0 / f64::from(parts_per_tick);
        let part_s = tick_s * share_of_part;
        let reading = Reading::at_rest(&device.sensing, setup.start_rad);
        // The sensors start at rest on what they read, effects of sensing included.
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

    /// Reads all sensors as the board does; call it once per tick.
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

    /// Carries it over one tick with the bridge's outputs off: no current, so neither drive nor brake. What the winding
    /// carried is taken to be gone at once; it takes 30 µs at the motor's rated current.
    pub fn coast(&mut self) {
        self.current_a = 0.0;
        if let Some(winding) = &mut self.winding {
            winding.open();
        }
        let (now_s, velocity) = (self.state.time_s, self.state.velocity);
        self.line.command(&self.drive, now_s, 0.0, velocity);
        self.carry(self.tick_s);
    }

    /// The mean current over the part, A.
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

    /// True position where the position sensor sits, rad.
    #[inline]
    pub fn position_rad(&self) -> f64 {
        self.plant.seen(&self.state).0
    }

    /// True velocity where the position sensor sits, rad/s.
    pub fn velocity_rad_s(&self) -> f64 {
        self.plant.seen(&self.state).1
    }

    /// Mean motor current over the last tick, A.
    #[inline]
    pub fn current_a(&self) -> f64 {
        self.current_a
    }
}

/// Positions before the encoder and before the Hall sensor: the effects are on the one that regulates.
#[inline]
fn before_sensors(regulating: Sensor, position_rad: f64, affected_rad: f64) -> [f64; 2] {
    match regulating {
        Sensor::Encoder => [affected_rad, position_rad],
        Sensor::Hall => [position_rad, affected_rad],
    }
}
