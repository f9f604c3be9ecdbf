//! What a user can set. Numbers are in the unit that the user sees, which each name carries; the defaults are
//! the lab's paddle.

pub mod field;

pub use field::{FIELDS, Field, Kind, SettingError, Shown};

/// Sensor that feeds the regulator.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sensor {
    /// Incremental encoder on the motor.
    #[default]
    Encoder,
    /// Hall sensor on the paddle.
    Hall,
}

/// Velocity that drives the compensation of dry friction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum VelocitySource {
    /// The observer's. Near rest this takes damping away: 0.585 mN m at the motor over 10 degrees a second are
    /// -0.050 N m s/rad at the paddle, as much as the default gains give. It needs a wide band, or gains that damp more.
    Measured,
    /// That of the setpoint: helps a motion that is wanted, and cannot make one. Torque mode, which has no such motion,
    /// is then not compensated.
    #[default]
    Setpoint,
}

/// What the derivative of the position regulator is taken from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DerivativeSource {
    /// The observer with the Hall sensor, whose noise it cuts to an eighth (1.0 to 0.12 mN m rms at the default gains),
    /// and differences with the encoder, which has none: a step of 5 degrees then settles in 63 ms instead of 78.
    #[default]
    Auto,
    /// Differences of the filtered position, the lab's.
    Position,
    /// The observer, which knows the torque.
    Observer,
}

impl DerivativeSource {
    /// Whether it is the observer with this sensor.
    pub fn is_observer(self, sensor: Sensor) -> bool {
        match self {
            Self::Auto => sensor == Sensor::Hall,
            Self::Position => false,
            Self::Observer => true,
        }
    }
}

/// What the current loop takes for the current of a control period.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CurrentSampling {
    /// The mean over the period: rejects the amplifier's noise.
    #[default]
    Mean,
    /// One sample at the centre of the PWM.
    Centre,
}

/// Order of the low-pass on the position.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FilterOrder {
    /// First order, the lab's.
    #[default]
    First,
    /// Second order, Butterworth.
    Second,
}

/// Gains of the position regulator, torque at the paddle per degree: the motor's share is /ratio.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PidSettings {
    /// Proportional gain, N m per degree at the paddle.
    pub kp_nm_per_deg: f32,
    /// Integral gain, N m per degree and second at the paddle.
    pub ki_nm_per_deg_s: f32,
    /// Derivative gain, N m s per degree at the paddle.
    pub kd_nm_s_per_deg: f32,
    /// Share of the setpoint that the proportional term sees.
    pub setpoint_weight: f32,
    /// Cutoff of the low-pass on the derivative, Hz; 0 = none.
    pub derivative_cutoff_hz: f32,
    /// What the derivative is taken from.
    pub derivative: DerivativeSource,
}

impl Default for PidSettings {
    /// Row "encoder 3" of the report's table 1.
    fn default() -> Self {
        Self {
            kp_nm_per_deg: 0.05,
            ki_nm_per_deg_s: 0.0,
            kd_nm_s_per_deg: 0.0008,
            setpoint_weight: 1.0,
            derivative_cutoff_hz: 0.0,
            derivative: DerivativeSource::Auto,
        }
    }
}

/// Estimation of position and velocity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EstimateSettings {
    /// Sensor that feeds the regulator.
    pub sensor: Sensor,
    /// Cutoff of the low-pass on the position, Hz; 0 = none.
    pub cutoff_hz: f32,
    /// Order of that low-pass.
    pub order: FilterOrder,
    /// Bandwidth of the velocity observer, Hz.
    pub velocity_bandwidth_hz: f32,
}

impl Default for EstimateSettings {
    fn default() -> Self {
        Self {
            sensor: Sensor::Encoder,
            cutoff_hz: 100.0,
            order: FilterOrder::First,
            velocity_bandwidth_hz: 50.0,
        }
    }
}

/// Torques that cancel what the paddle itself opposes; all off by default.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CompensationSettings {
    /// Dry friction on.
    pub dry: bool,
    /// Dry friction of the positive direction, N m at the motor.
    pub dry_forward_nm: f32,
    /// Dry friction of the negative direction, N m at the motor.
    pub dry_backward_nm: f32,
    /// Band of velocity over which dry friction is smoothed, degrees per second either side.
    pub dry_band_deg_s: f32,
    /// Velocity that drives dry friction.
    pub dry_source: VelocitySource,
    /// Viscous friction on.
    pub viscous: bool,
    /// Viscous friction, N m s/rad at the paddle.
    pub viscous_nm_s_per_rad: f32,
    /// Gravity on.
    pub gravity: bool,
    /// Weight times lever, N m at the paddle.
    pub gravity_nm: f32,
    /// Angle at which the paddle hangs, degrees.
    pub gravity_zero_deg: f32,
}

impl Default for CompensationSettings {
    fn default() -> Self {
        Self {
            dry: false,
            dry_forward_nm: 0.000_585,
            dry_backward_nm: 0.000_375,
            dry_band_deg_s: 10.0,
            dry_source: VelocitySource::Setpoint,
            viscous: false,
            viscous_nm_s_per_rad: 1.78e-4,
            gravity: false,
            gravity_nm: 0.01464,
            gravity_zero_deg: 0.0,
        }
    }
}

/// The motor, its supply and its current loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotorSettings {
    /// Torque constant, N m/A.
    pub torque_constant_nm_per_a: f32,
    /// Resistance of the winding, ohm.
    pub resistance_ohm: f32,
    /// Inductance of the winding, H.
    pub inductance_h: f32,
    /// Supply of the bridge, V.
    pub supply_v: f32,
    /// Bandwidth of the current loop, Hz; lowered where the tick is too slow for it.
    pub current_bandwidth_hz: f32,
    /// How the board samples the current.
    pub current_sampling: CurrentSampling,
    /// Largest torque, N m at the motor.
    pub torque_limit_nm: f32,
}

impl Default for MotorSettings {
    fn default() -> Self {
        Self {
            torque_constant_nm_per_a: 0.0538,
            resistance_ohm: 10.6,
            inductance_h: 1.25e-3,
            supply_v: 24.0,
            current_bandwidth_hz: 600.0,
            current_sampling: CurrentSampling::Mean,
            torque_limit_nm: 0.0323,
        }
    }
}

/// The transmission, the encoder and what they move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MechanismSettings {
    /// Turns of the motor per turn of the paddle.
    pub ratio: f32,
    /// Encoder counts per turn of the motor.
    pub counts_per_turn: f32,
    /// Inertia at the paddle, motor included, kg m^2; the velocity observer uses it.
    pub inertia_kg_m2: f32,
}

impl Default for MechanismSettings {
    fn default() -> Self {
        Self {
            ratio: 15.0,
            counts_per_turn: 2000.0,
            inertia_kg_m2: 5.755e-4,
        }
    }
}

/// Calibration of the Hall sensor: a cubic about a centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HallSettings {
    /// Hall voltage at 0 degrees.
    pub centre_v: f32,
    /// Slope at the centre, degrees per volt.
    pub slope_deg_per_v: f32,
    /// Second-order term, degrees per volt squared.
    pub quadratic_deg_per_v2: f32,
    /// Third-order term, degrees per volt cubed.
    pub cubic_deg_per_v3: f32,
}

impl Default for HallSettings {
    /// Lab 3: 33 V - 81.9 degrees.
    fn default() -> Self {
        Self {
            centre_v: 2.4818,
            slope_deg_per_v: 33.0,
            quadratic_deg_per_v2: 0.0,
            cubic_deg_per_v3: 0.0,
        }
    }
}

/// Bounds that an armed paddle must keep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LimitSettings {
    /// Largest angle either side, degrees.
    pub travel_deg: f32,
    /// Largest speed of the paddle, degrees per second.
    pub speed_deg_s: f32,
    /// Largest motor current, A.
    pub current_a: f32,
    /// Largest difference between encoder and Hall sensor, degrees.
    pub disagreement_deg: f32,
    /// Longest push at the torque limit without motion, s; 0 = any.
    pub stall_s: f32,
    /// Largest difference between the motor's voltage and what its model makes of the current, V.
    pub mismatch_v: f32,
}

impl Default for LimitSettings {
    fn default() -> Self {
        Self {
            travel_deg: 40.0,
            speed_deg_s: 1500.0,
            current_a: 1.5,
            disagreement_deg: 8.0,
            stall_s: 1.0,
            // Half more resistance than the sheet says is 3 V at the rated current, a tenth of the supply 2.4 V.
            mismatch_v: 6.0,
        }
    }
}

/// The program that steers the paddle, if one does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HostSettings {
    /// Longest silence of a program that has sent `beat` once, ms; 0 = any.
    pub heartbeat_ms: f32,
}

impl Default for HostSettings {
    fn default() -> Self {
        Self {
            heartbeat_ms: 200.0,
        }
    }
}

/// Step metrics.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MetricsSettings {
    /// Settled means within this of the target, degrees.
    pub band_deg: f32,
}

impl Default for MetricsSettings {
    fn default() -> Self {
        Self { band_deg: 0.2 }
    }
}

/// Everything that can be set.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Settings {
    /// Position regulator.
    pub pid: PidSettings,
    /// Estimation.
    pub estimate: EstimateSettings,
    /// Compensations.
    pub compensation: CompensationSettings,
    /// Motor and current loop.
    pub motor: MotorSettings,
    /// Transmission and encoder.
    pub mechanism: MechanismSettings,
    /// Hall calibration.
    pub hall: HallSettings,
    /// Bounds.
    pub limit: LimitSettings,
    /// The program that steers the paddle.
    pub host: HostSettings,
    /// Step metrics.
    pub metrics: MetricsSettings,
}
