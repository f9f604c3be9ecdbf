//! The hardware around the control core: what the board drives and what its converters read.

use crate::device::Device;
use crate::drive::{Drive, DriveLine};
use crate::motor::{Motor, Winding};
use crate::plant::{Plant, State};
use crate::sensing::{Reading, Sensing};
use crate::sensors::{CurrentAmplifier, Encoder, Hall, HallReader, Noise};
use haptic_paddle::controller::{Duty, Measurement};
use haptic_paddle::settings::{Sensor, Settings};

/// What turns the controller's command into torque at the motor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Actuator {
    /// The torque that the position loop asks for, exactly; the duty is ignored.
    Ideal,
    /// The duty, through bridge and winding.
    Bridge(Motor),
}

/// What the controller tells the actuator for one tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Command {
    /// Share of the supply.
    pub duty: Duty,
    /// Torque that the duty is to make, N m at the motor.
    pub torque_nm: f32,
}

/// How a simulated paddle is made.
#[derive(Clone, Debug)]
pub struct PaddleSetup {
    /// Drive, mechanics, and what lies between the position and the regulating sensor.
    pub device: Device,
    /// What makes the torque.
    pub actuator: Actuator,
    /// Of the current.
    pub amplifier: CurrentAmplifier,
    /// The Hall sensor's own.
    pub hall: Hall,
    /// Encoder counter at the start.
    pub encoder_count: u32,
    /// Where it stands at rest at the start, rad.
    pub start_rad: f64,
    /// Time of the session at the start, s.
    pub start_s: f64,
    /// Of all noise.
    pub seed: u64,
    /// A tick is simulated in this many equal parts, 1 or more: for studies of convergence.
    pub parts_per_tick: u32,
}

impl PaddleSetup {
    /// `device` at rest at 0 rad, driven by exactly the torque that it is told, with the sensors that `settings` expect.
    pub fn new(device: Device, settings: &Settings) -> Self {
        Self {
            device,
            actuator: Actuator::Ideal,
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
    motor: MotorState,
    sensing: Sensing,
    reading: Reading,
    sensed: Sensor,
    encoder: Encoder,
    hall: HallReader,
    amplifier: CurrentAmplifier,
    noise: Noise,
    ratio: f64,
    parts_per_tick: u32,
    tick_s: f64,
}

#[derive(Clone, Copy, Debug)]
enum MotorState {
    Ideal { amperes_per_nm: f64, current_a: f64 },
    Bridge { winding: Winding, current_a: f64 },
}

impl Paddle {
    /// The paddle of `setup`, measured and driven every `tick_s`.
    pub fn new(setup: &PaddleSetup, settings: &Settings, tick_s: f64) -> Self {
        let device = &setup.device;
        let plant = Plant::new(device.mechanics.clone());
        let reading = Reading::at_rest(&device.sensing, setup.start_rad);
        let mut paddle = Self {
            state: plant.state(setup.start_s, setup.start_rad, 0.0),
            plant,
            line: DriveLine::at_rest(&device.drive),
            drive: device.drive.clone(),
            motor: match setup.actuator {
                Actuator::Ideal => MotorState::Ideal {
                    amperes_per_nm: 1.0 / f64::from(settings.motor.torque_constant_nm_per_a),
                    current_a: 0.0,
                },
                Actuator::Bridge(motor) => MotorState::Bridge {
                    winding: Winding::without_current(motor),
                    current_a: 0.0,
                },
            },
            sensing: device.sensing.clone(),
            reading,
            sensed: settings.estimate.sensor,
            encoder: Encoder::new(&settings.mechanism, setup.start_rad, setup.encoder_count),
            hall: HallReader::at_rest(setup.hall.clone(), setup.start_rad),
            amplifier: setup.amplifier,
            noise: Noise::new(setup.seed),
            ratio: f64::from(settings.mechanism.ratio),
            parts_per_tick: setup.parts_per_tick.max(1),
            tick_s,
        };
        // The sensors start at rest on what they read, effects of sensing included.
        let [encoder_rad, hall_rad] = paddle.sensed_positions(0.0);
        paddle.encoder = Encoder::new(&settings.mechanism, encoder_rad, setup.encoder_count);
        paddle.hall = HallReader::at_rest(setup.hall.clone(), hall_rad);
        paddle
    }

    /// Positions before the encoder and before the Hall sensor, rad.
    #[inline]
    fn sensed_positions(&mut self, dt_s: f64) -> [f64; 2] {
        let (position, _) = self.plant.seen(&self.state);
        let affected = self.reading.follow(&self.sensing, position, dt_s)
            + self.sensing.jumped(self.state.time_s);
        match self.sensed {
            Sensor::Encoder => [affected, position],
            Sensor::Hall => [position, affected],
        }
    }

    /// What the board reads now; call once a tick.
    #[inline]
    pub fn measure(&mut self) -> Measurement {
        let [encoder_rad, hall_rad] = self.sensed_positions(self.tick_s);
        let current_a = self.current_a();
        Measurement {
            encoder_count: self.encoder.count(encoder_rad),
            hall_adc: self.hall.count(hall_rad, self.tick_s, &mut self.noise),
            current_adc: self.amplifier.counts(current_a, &mut self.noise),
        }
    }

    /// Carries it over one tick of `command`.
    #[inline]
    pub fn advance(&mut self, command: Command) {
        let part_s = self.tick_s / f64::from(self.parts_per_tick);
        let mut charge = 0.0;
        for _ in 0..self.parts_per_tick {
            charge += self.advance_part(command, part_s);
        }
        let mean_a = charge / f64::from(self.parts_per_tick);
        match &mut self.motor {
            MotorState::Ideal { current_a, .. } | MotorState::Bridge { current_a, .. } => {
                *current_a = mean_a;
            }
        }
    }

    /// The mean current over the part, A.
    #[inline]
    fn advance_part(&mut self, command: Command, part_s: f64) -> f64 {
        let now_s = self.state.time_s;
        match &mut self.motor {
            MotorState::Ideal { amperes_per_nm, .. } => {
                let torque_nm = f64::from(command.torque_nm);
                let current_a = torque_nm * *amperes_per_nm;
                self.line.command(&self.drive, now_s, torque_nm);
                self.carry(part_s);
                current_a
            }
            MotorState::Bridge { winding, .. } => {
                let shaft_rad_s = self.ratio * self.state.velocity;
                let torque = winding.torque(f64::from(command.duty.0), shaft_rad_s);
                let mean_a = winding.advance(torque, part_s);
                self.line.command_relaxing(&self.drive, now_s, torque);
                self.carry(part_s);
                mean_a
            }
        }
    }

    #[inline]
    fn carry(&mut self, dt_s: f64) {
        let mut left = dt_s;
        while left > 0.0 {
            let (torque, piece_s) = self.line.piece(self.state.time_s, left);
            self.plant.advance(&mut self.state, torque, piece_s);
            left -= piece_s;
        }
    }

    /// Since the start of the session, s.
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
        match self.motor {
            MotorState::Ideal { current_a, .. } | MotorState::Bridge { current_a, .. } => current_a,
        }
    }
}
