//! All settings, each defined once: console, store, PC program and `docs/settings.md` go by this.
//!
//! Numbers are in the unit that people see, which each name carries; the defaults are the lab's paddle.

use super::choice::{
    Choice, CurrentSampling, DerivativeSource, FilterOrder, Sensor, VelocitySource,
};
use super::field::{Field, Group, Kind};

settings_tree! {
    /// The position regulator. Its gains make a torque at the paddle; the motor's share is that over mechanism.ratio.
    pid: PidSettings {
        // The gains are row "encoder 3" of the report's table 1.
        /// Proportional gain.
        kp_nm_per_deg = 0.05, number ("pid.kp" | "kp", "N m/deg at the paddle", 0.0..=2.0);
        /// Integral gain.
        ki_nm_per_deg_s = 0.0, number ("pid.ki" | "ki", "N m/(deg s) at the paddle", 0.0..=50.0);
        /// Derivative gain.
        kd_nm_s_per_deg = 0.0008, number ("pid.kd" | "kd", "N m s/deg at the paddle", 0.0..=0.1);
        /// Share of the setpoint that the proportional term sees.
        setpoint_weight = 1.0, number ("pid.setpoint_weight", "", 0.0..=1.0);
        /// Cutoff of the low-pass on the derivative; 0 = none.
        derivative_cutoff_hz = 0.0, number ("pid.derivative_cutoff", "Hz", 0.0..=10_000.0);
        /// Source of the derivative: differences of the position, or the observer; auto is the observer with the Hall
        /// sensor and differences with the encoder.
        derivative = DerivativeSource::Auto, choice ("pid.derivative", DerivativeSource);
    }

    /// Estimation of position and velocity.
    estimate: EstimateSettings {
        /// Sensor that feeds the regulator.
        sensor = Sensor::Encoder, choice ("estimate.sensor", Sensor);
        /// Cutoff of the low-pass on the position; 0 = none.
        cutoff_hz = 100.0, number ("estimate.cutoff", "Hz", 0.0..=10_000.0);
        /// Order of that low-pass.
        order = FilterOrder::First, choice ("estimate.order", FilterOrder);
        /// Bandwidth of the velocity observer.
        velocity_bandwidth_hz = 50.0, number ("estimate.velocity_bandwidth", "Hz", 1.0..=1_000.0);
    }

    /// Torques that cancel what the paddle itself opposes.
    compensation: CompensationSettings {
        /// Dry friction.
        dry = false, choice ("compensation.dry", bool);
        /// Dry friction of the positive direction.
        dry_forward_nm = 0.000_585, number ("compensation.dry_forward", "N m at the motor", 0.0..=0.01);
        /// Dry friction of the negative direction.
        dry_backward_nm = 0.000_375, number ("compensation.dry_backward", "N m at the motor", 0.0..=0.01);
        /// Velocity either side of rest over which dry friction is smoothed.
        dry_band_deg_s = 10.0, number ("compensation.dry_band", "deg/s", 0.1..=1_000.0);
        /// Velocity that drives dry friction: the measured one, or that of the setpoint.
        dry_source = VelocitySource::Setpoint, choice ("compensation.dry_source", VelocitySource);
        /// Viscous friction.
        viscous = false, choice ("compensation.viscous", bool);
        /// Level of the viscous friction.
        viscous_nm_s_per_rad = 1.78e-4, number ("compensation.viscous_level", "N m s/rad at the paddle", 0.0..=0.1);
        /// Gravity.
        gravity = false, choice ("compensation.gravity", bool);
        /// Weight times lever.
        gravity_nm = 0.01464, number ("compensation.gravity_level", "N m at the paddle", -1.0..=1.0);
        /// Angle at which the paddle hangs.
        gravity_zero_deg = 0.0, number ("compensation.gravity_zero", "deg", -180.0..=180.0);
    }

    /// The motor, its supply and its current loop.
    motor: MotorSettings {
        /// Torque constant.
        torque_constant_nm_per_a = 0.0538, number ("motor.torque_constant", "N m/A", 0.001..=1.0);
        /// Resistance of the winding; arming measures it anew.
        resistance_ohm = 10.6, number ("motor.resistance", "ohm", 0.01..=1_000.0);
        /// Inductance of the winding.
        inductance_h = 1.25e-3, number ("motor.inductance", "H", 0.000001..=1.0);
        /// Supply of the bridge.
        supply_v = 24.0, number ("motor.supply", "V", 1.0..=60.0);
        /// Bandwidth of the current loop; less where the control rate is too low for it.
        current_bandwidth_hz = 600.0, number ("motor.bandwidth", "Hz", 1.0..=5_000.0);
        /// What counts as the current of a control period: its mean, or one sample at the centre of the PWM.
        current_sampling = CurrentSampling::Mean, choice ("motor.current_sampling", CurrentSampling);
        /// Largest torque.
        torque_limit_nm = 0.0323, number ("motor.torque_limit", "N m at the motor", 0.0..=0.0323);
    }

    /// The transmission, the encoder and what they move.
    mechanism: MechanismSettings {
        /// Turns of the motor in a turn of the paddle.
        ratio = 15.0, number ("mechanism.ratio", "", 0.1..=1_000.0);
        /// Encoder counts in a turn of the motor.
        counts_per_turn = 2000.0, number ("mechanism.counts_per_turn", "", 4.0..=1_000_000.0);
        /// Inertia at the paddle, motor included; the velocity observer uses it.
        inertia_kg_m2 = 5.755e-4, number ("mechanism.inertia", "kg m2", 0.000001..=1.0);
    }

    /// Calibration of the Hall sensor: a cubic about a centre.
    hall: HallSettings {
        // Lab 3: 33 V - 81.9 degrees.
        /// Voltage of the sensor at 0 degrees.
        centre_v = 2.4818, number ("hall.centre", "V", 0.0..=5.0);
        /// Slope at the centre.
        slope_deg_per_v = 33.0, number ("hall.slope", "deg/V", -200.0..=200.0);
        /// Second-order term.
        quadratic_deg_per_v2 = 0.0, number ("hall.quadratic", "deg/V2", -200.0..=200.0);
        /// Third-order term.
        cubic_deg_per_v3 = 0.0, number ("hall.cubic", "deg/V3", -200.0..=200.0);
    }

    /// Bounds that an armed paddle must keep; what is beyond one turns the motor off.
    limit: LimitSettings {
        // The Hall sensor sees 75 degrees either side.
        /// Largest angle either side.
        travel_deg = 40.0, number ("limit.travel", "deg", 1.0..=75.0);
        // The motor's speed without load at 24 V is 1700 degrees a second of the paddle.
        /// Largest speed of the paddle.
        speed_deg_s = 1500.0, number ("limit.speed", "deg/s", 1.0..=2_000.0);
        // See `sensing::current::MEASURABLE_A`.
        /// Largest current of the motor.
        current_a = 1.5, number ("limit.current", "A", 0.0..=1.55);
        /// Largest difference between encoder and Hall sensor.
        disagreement_deg = 8.0, number ("limit.disagreement", "deg", 0.1..=20.0);
        /// Longest push at the torque limit without motion; 0 = any.
        stall_s = 1.0, number ("limit.stall", "s", 0.0..=60.0);
        // Half more resistance than the sheet says is 3 V at the rated current, a tenth of the supply 2.4 V.
        /// Largest difference between the motor's voltage and what its model makes of the current.
        mismatch_v = 6.0, number ("limit.mismatch", "V", 1.0..=12.0);
    }

    /// The program that steers the paddle, if one does.
    host: HostSettings {
        /// Longest silence of a program that has sent `beat` once; 0 = any.
        heartbeat_ms = 200.0, number ("host.heartbeat", "ms", 0.0..=10_000.0);
    }

    /// The figures of a step.
    metrics: MetricsSettings {
        /// Settled means within this of the target.
        band_deg = 0.2, number ("metrics.band", "deg", 0.001..=90.0);
    }
}
