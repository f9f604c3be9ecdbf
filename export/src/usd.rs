//! Universal Scene Description: UsdPhysics (<https://openusd.org/release/api/usd_physics_page_front.html>) with the joint
//! attributes of PhysX. Its angles are in degrees.

use crate::model::Model;
use crate::part::Part;
use crate::part::{limit, stops};
use crate::pendulum::{GRAVITY_M_S2, Pendulum};
use crate::writer::{Writer, number};
use std::fmt::Write;

pub(crate) struct Usd;

impl Writer for Usd {
    fn expresses(&self, part: Part) -> bool {
        matches!(
            part,
            Part::Limit | Part::Coulomb | Part::Viscous | Part::Gravity | Part::Spring
        )
    }

    fn approximates(&self, part: Part) -> Option<&'static str> {
        part.by_joint_attributes()
    }

    fn text(&self, model: &Model, notes: &[String]) -> String {
        let device = &model.device;
        let mechanics = &device.mechanics;
        let pendulum = Pendulum::of(device, mechanics.inertia);
        let (kind, drive, per) = if model.is_linear {
            ("PhysicsPrismaticJoint", "linear", 1.0)
        } else {
            ("PhysicsRevoluteJoint", "angular", 1f64.to_radians())
        };
        let shown = |at: f64| number(if model.is_linear { at } else { at.to_degrees() });
        let [lower, upper] = stops(device);
        let mut joint = String::new();
        // Writing to a `String` cannot fail.
        let mut line = |written: String| {
            let _ = writeln!(joint, "        {written}");
        };
        line("rel physics:body0 = </World/base>".into());
        line("rel physics:body1 = </World/paddle>".into());
        line(format!(
            "uniform token physics:axis = \"{}\"",
            if model.is_linear { "X" } else { "Y" }
        ));
        if let Some(stop) = lower {
            line(format!("float physics:lowerLimit = {}", shown(stop.at)));
        }
        if let Some(stop) = upper {
            line(format!("float physics:upperLimit = {}", shown(stop.at)));
        }
        line(format!(
            "float drive:{drive}:physics:stiffness = {}",
            number(mechanics.stiffness * per)
        ));
        line(format!(
            "float drive:{drive}:physics:damping = {}",
            number(mechanics.viscous * per)
        ));
        line(format!(
            "float drive:{drive}:physics:targetPosition = {}",
            shown(mechanics.stiffness_zero)
        ));
        let most = limit(device) * device.drive.ratio.abs();
        if most.is_finite() {
            line(format!(
                "custom double paddle:largestInputTorque = {}",
                number(most)
            ));
        }
        line(format!(
            "custom double paddle:torquePerInput = {}",
            number(device.drive.ratio)
        ));
        let [forward, backward] = mechanics.friction.level_nm;
        line(format!(
            "float physxJoint:jointFriction = {}",
            number(f64::midpoint(forward, backward))
        ));
        line(format!(
            "float physxJoint:armature = {}",
            number(if model.is_linear { 0.0 } else { pendulum.rest })
        ));
        let comments = notes.join("; ").replace('"', "'");
        let (sin, cos) = pendulum.hangs_at.sin_cos();
        let mass = if model.is_linear {
            mechanics.inertia
        } else {
            pendulum.mass_kg
        };
        format!(
            "#usda 1.0
(
    doc = \"{comments}\"
    defaultPrim = \"World\"
    metersPerUnit = 1
    kilogramsPerUnit = 1
    upAxis = \"Z\"
)

def Xform \"World\"
{{
    def PhysicsScene \"physics\"
    {{
        vector3f physics:gravityDirection = (0, 0, -1)
        float physics:gravityMagnitude = {GRAVITY_M_S2}
    }}

    def Xform \"base\" (prepend apiSchemas = [\"PhysicsRigidBodyAPI\"])
    {{
        bool physics:kinematicEnabled = true
    }}

    def Xform \"paddle\" (prepend apiSchemas = [\"PhysicsRigidBodyAPI\", \"PhysicsMassAPI\"])
    {{
        float physics:mass = {mass}
        point3f physics:centerOfMass = ({x}, 0, {z})
        float3 physics:diagonalInertia = ({small}, {small}, {small})
    }}

    def {kind} \"axis\" (prepend apiSchemas = [\"PhysicsDriveAPI:{drive}\", \"PhysxJointAPI\"])
    {{
{joint}    }}
}}
",
            mass = number(mass),
            x = number(pendulum.lever_m * sin),
            z = number(-pendulum.lever_m * cos),
            small = number(mechanics.inertia * 1e-3),
        )
    }
}
