//! Physical quantities of the parameters of effects.

/// The quantity that a parameter measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// A dimensionless number.
    Ratio,
    /// A phase, rad.
    Angle,
    /// A time, s.
    Time,
    /// A frequency, 1/s.
    Frequency,
    /// An input, in the unit of the input.
    Input,
    /// A rate of the input, input/s.
    InputRate,
    /// A position, in the unit of position.
    Position,
    /// An inverse position, 1/position.
    PerPosition,
    /// An inverse squared position, 1/position².
    PerPositionSquared,
    /// A velocity, position/s.
    Velocity,
    /// A torque at the joint.
    Torque,
    /// A stiffness, torque/position.
    Stiffness,
    /// A damping, torque s/position.
    Damping,
    /// A quadratic drag, torque s²/position².
    Drag,
    /// An inertia, torque s²/position.
    Inertia,
}

impl Quantity {
    /// The quantity of a number of the nominal model, by its name. `None` for `ratio`, which is torque per input.
    pub fn of_model(number: &str) -> Option<Self> {
        Some(match number {
            "inertia" => Self::Inertia,
            "viscous" | "stop_damping" => Self::Damping,
            "coulomb" | "gravity" | "offset" => Self::Torque,
            "stiffness" | "stop_stiffness" => Self::Stiffness,
            "delay" | "lag" => Self::Time,
            "input_limit" => Self::Input,
            "input_rate_limit" => Self::InputRate,
            "gravity_zero" | "stiffness_zero" | "error_deadband" | "travel" => Self::Position,
            _ => return None,
        })
    }

    /// Its unit for an axis with these units of position and input.
    pub fn unit(self, position: &str, input: &str) -> String {
        let torque = if position == "m" || position == "mm" {
            "N"
        } else {
            "N m"
        };
        match self {
            Self::Ratio => "1".into(),
            Self::Angle => "rad".into(),
            Self::Time => "s".into(),
            Self::Frequency => "1/s".into(),
            Self::Input => input.into(),
            Self::InputRate => format!("{input}/s"),
            Self::Position => position.into(),
            Self::PerPosition => format!("1/{position}"),
            Self::PerPositionSquared => format!("1/{position}²"),
            Self::Velocity => format!("{position}/s"),
            Self::Torque => torque.into(),
            Self::Stiffness => format!("{torque}/{position}"),
            Self::Damping => format!("{torque} s/{position}"),
            Self::Drag => format!("{torque} s²/{position}²"),
            Self::Inertia => format!("{torque} s²/{position}"),
        }
    }
}

/// A parameter of an effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// Its name, as a user writes it.
    pub name: &'static str,
    /// The quantity that it measures.
    pub quantity: Quantity,
    /// Lowest and highest allowed value.
    pub range: [f64; 2],
    /// Default value, for the paddle.
    pub default: f64,
    /// Typical range, for the paddle.
    pub typical: [f64; 2],
    /// Its meaning, for the report.
    pub about: &'static str,
}
