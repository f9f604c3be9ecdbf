//! The robot description of ROS (<https://wiki.ros.org/urdf/XML/joint>).

use crate::model::Model;
use crate::part::Part;
use crate::part::{limit, stops};
use crate::pendulum::Pendulum;
use crate::writer::{Writer, number};

pub(crate) struct Urdf;

/// A value that means no limit, for attributes that are required.
const NO_LIMIT: f64 = 1e6;

impl Writer for Urdf {
    fn expresses(&self, part: Part) -> bool {
        matches!(
            part,
            Part::Limit | Part::Coulomb | Part::Viscous | Part::Gravity
        )
    }

    fn approximates(&self, part: Part) -> Option<&'static str> {
        part.by_joint_attributes()
    }

    fn text(&self, model: &Model, notes: &[String]) -> String {
        let device = &model.device;
        let mechanics = &device.mechanics;
        let pendulum = Pendulum::of(device, mechanics.inertia);
        let comments: String = notes
            .iter()
            .map(|note| format!("<!-- {} -->\n", note.replace("--", "- -")))
            .collect();
        let (sin, cos) = pendulum.hangs_at.sin_cos();
        let (x, z) = (
            number(-pendulum.lever_m * sin),
            number(-pendulum.lever_m * cos),
        );
        let [lower, upper] = stops(device).map(|stop| stop.map(|stop| stop.at));
        let kind = match (model.is_linear, lower.or(upper)) {
            (true, _) => "prismatic",
            (false, Some(_)) => "revolute",
            (false, None) => "continuous",
        };
        let travel = match kind {
            "continuous" => String::new(),
            _ => format!(
                " lower=\"{}\" upper=\"{}\"",
                number(lower.unwrap_or(-NO_LIMIT)),
                number(upper.unwrap_or(NO_LIMIT))
            ),
        };
        let most = limit(device) * device.drive.ratio.abs();
        let effort = number(if most.is_finite() { most } else { NO_LIMIT });
        let [forward, backward] = mechanics.friction.level_nm;
        let (mass, rest) = if model.is_linear {
            (mechanics.inertia, 1.0)
        } else {
            (pendulum.mass_kg, pendulum.rest)
        };
        let axis = if model.is_linear { "1 0 0" } else { "0 -1 0" };
        format!(
            "<?xml version=\"1.0\"?>
{comments}<robot name=\"{name}\">
  <link name=\"base\"/>
  <link name=\"paddle\">
    <inertial>
      <origin xyz=\"{x} 0 {z}\"/>
      <mass value=\"{mass}\"/>
      <inertia ixx=\"{rest}\" iyy=\"{rest}\" izz=\"{rest}\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/>
    </inertial>
  </link>
  <joint name=\"axis\" type=\"{kind}\">
    <parent link=\"base\"/>
    <child link=\"paddle\"/>
    <axis xyz=\"{axis}\"/>
    <limit effort=\"{effort}\" velocity=\"{velocity}\"{travel}/>
    <dynamics damping=\"{damping}\" friction=\"{friction}\"/>
  </joint>
  <transmission name=\"drive\">
    <type>transmission_interface/SimpleTransmission</type>
    <joint name=\"axis\"><hardwareInterface>hardware_interface/EffortJointInterface</hardwareInterface></joint>
    <actuator name=\"input\"><mechanicalReduction>{ratio}</mechanicalReduction></actuator>
  </transmission>
</robot>
",
            name = model.name.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;"),
            mass = number(mass),
            rest = number(rest),
            velocity = number(NO_LIMIT),
            damping = number(mechanics.viscous),
            friction = number(f64::midpoint(forward, backward)),
            ratio = number(device.drive.ratio),
        )
    }
}
