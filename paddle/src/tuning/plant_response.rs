//! Linear frequency response of a device, without dry friction, backlash, stops and cogging.

use haptic_paddle::settings::Sensor;
use host_sim::closed_loop::LoopSetup;
use host_sim::device::Device;
use num_complex::Complex64;

/// Reading of the regulating sensor per torque command at the motor, rad/(N m), linearized at the angle `at_rad`.
pub fn response(setup: &LoopSetup, at_rad: f64, omega_rad_s: f64) -> Complex64 {
    let s = Complex64::new(0.0, omega_rad_s);
    let device = &setup.paddle.device;
    let lag = |lag_s: f64| 1.0 / (1.0 + s * lag_s);
    let drive = &device.drive;
    // A delay below zero is that of a recording's column, not of the device.
    let late = (-s * drive.delay_s.max(0.0)).exp() * lag(drive.lag_s) * lag(drive.further_lag_s);
    let drive = drive.ratio * late;
    let sensing = device.sensing.slope(at_rad) * lag(device.sensing.lag_s);
    let own = match setup.settings.estimate.sensor {
        Sensor::Encoder => Complex64::ONE,
        Sensor::Hall => {
            let sensing = &setup.paddle.hall.sensing;
            sensing.slope(at_rad) * lag(sensing.lag_s)
        }
    };
    drive * mechanics(device, at_rad, s) * sensing * own
}

/// Position at the sensor's location per torque at the joint, rad/(N m).
fn mechanics(device: &Device, at_rad: f64, s: Complex64) -> Complex64 {
    let m = &device.mechanics;
    let hardened = 1.0 + 3.0 * m.hardening * (at_rad - m.stiffness_zero).powi(2);
    let stiffness = m.stiffness * hardened + m.gravity * (at_rad - m.gravity_zero).cos();
    let Some(link) = m.link else {
        return 1.0 / (m.inertia * s * s + m.viscous * s + stiffness);
    };
    let coupling = link.stiffness + link.damping * s;
    let motor = m.inertia * (1.0 - link.load_share) * s * s + m.viscous * s + coupling;
    let load = m.inertia * link.load_share * s * s + stiffness + coupling;
    let seen = match link.sensor_on_load {
        true => coupling,
        false => load,
    };
    seen / (motor * load - coupling * coupling)
}
