//! Control core of a one-axis haptic paddle. It turns measurements into a duty.
//!
//! The data flow of one control period, in [`controller::Controller::step`]:
//!
//! ```text
//! sensing      counts         -> angles, current
//! estimate     angles         -> filtered position, velocity
//! excitation   time           -> setpoint
//! control      setpoint       -> torque at the motor -> duty
//! safety       watches each of them
//! telemetry    tells a computer
//! ```
//!
//! All numbers are `f32`. The core does not allocate memory and does not panic. Angles are radians at the paddle and torques
//! are N m at the motor, unless a name says otherwise. [`settings`] are in user units.
//!
//! ```
//! use haptic_paddle::controller::{Controller, Duty, Measurement, Mode, TickRate};
//! use haptic_paddle::settings::Settings;
//!
//! let mut controller = Controller::new(&Settings::default(), TickRate::new(20_000.0, 2));
//! let at_rest = Measurement { encoder_count: 0, hall_adc: 2034, current_adc: 2048.0 };
//! assert_eq!(controller.step(&at_rest), Duty::ZERO);
//! controller.zero_at(0.0)?;
//! controller.arm(Mode::Position)?;
//! controller.set_reference(0.1)?;
//! for _ in 0..2 {
//!     controller.step(&at_rest);
//! }
//! assert!(controller.torque_command_nm() > 0.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
#![no_std]

/// On a host only, a console may write into a string.
#[cfg(not(target_os = "none"))]
extern crate std;

pub mod console;
pub mod control;
pub mod controller;
pub mod decimal;
pub mod estimate;
pub mod excitation;
pub mod metrics;
pub mod phase;
pub mod procedures;
pub mod safety;
pub mod scalar;
pub mod sensing;
pub mod settings;
pub mod telemetry;
pub mod units;
pub mod wiring;
