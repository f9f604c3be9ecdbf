//! What the numbers of an effect measure.

/// What a parameter measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// A pure number.
    Ratio,
    /// A phase.
    Angle,
    /// s.
    Time,
    /// 1/s.
    Frequency,
    /// Unit of the input.
    Input,
    /// Input/s.
    InputRate,
    /// Unit of position.
    Position,
    /// 1/position.
    PerPosition,
    /// 1/position².
    PerPositionSquared,
    /// Position/s.
    Velocity,
    /// Joint torque.
    Torque,
    /// Torque/position.
    Stiffness,
    /// Torque s/position.
    Damping,
    /// Torque s²/position².
    Drag,
    /// Torque s²/position.
    Inertia,
}

impl Quantity {
    /// The quantity of a number of the nominal model, by its name there; `None` for its ratio, which is torque over
    /// input.
    pub fn of_model(number: &str) -> Option<Self> {
        Some(match number {
            "inertia" => Self::Inertia,
            "viscous" | "stop_damping" => Self::Damping,
            "coulomb" | "gravity" | "offset" => Self::Torque,
            "stiffness" | "stop_stiffness" => Self::Stiffness,
            "delay" | "lag" => Self::Time,
            "input_limit" => Self::Input,
            "input_rate_limit" => Self::InputRate,
            "gravity_zero" | "stiffness_zero" | "travel" => Self::Position,
            _ => return None,
        })
    }

    /// The unit for an axis whose position and input have these units.
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

/// One number of an effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// As a user writes it.
    pub name: &'static str,
    /// What it measures.
    pub quantity: Quantity,
    /// Lowest and highest value that has a meaning.
    pub range: [f64; 2],
    /// What it is where a user does not say, for the paddle.
    pub default: f64,
    /// Typical range, for the paddle.
    pub typical: [f64; 2],
    /// Its meaning, for the report.
    pub about: &'static str,
}
