//! The nominal model with the corrections of a diagnosis.

use crate::fit::Fit;
use crate::fit::hypothesis::common_input_shift_s;
use crate::fit::problem::Problem;
use crate::missing_torque::table::Table;
use host_sim::device::Device;
use host_sim::effects::Effect;
use host_sim::plant::Law;
use std::sync::Arc;

/// The nominal model with corrected parameters and additional effects.
#[derive(Clone, Debug)]
pub struct CorrectedModel {
    /// The parameters.
    pub model: recording::Model,
    /// The effects, with all their parameters, in the order in which they are installed.
    pub effects: Vec<CorrectedEffect>,
    /// Torques as tables over an axis.
    pub tables: Vec<Table>,
}

/// An effect of a corrected model.
#[derive(Clone, Debug)]
pub struct CorrectedEffect {
    /// Kind and parameters.
    pub effect: Effect,
    /// Side of the transmission on which the position sensor sits.
    pub sensor_on_load: bool,
}

impl CorrectedModel {
    /// The device of the corrected model.
    pub fn device(&self) -> Device {
        let mut device = Device::nominal(&self.model);
        for corrected in &self.effects {
            device.sensor_on_load = corrected.sensor_on_load;
            corrected.effect.install(&mut device);
        }
        for table in &self.tables {
            let law = Law::new(Arc::new(table.clone()), Vec::new(), device.drive.ratio);
            device.mechanics.laws.push(law);
        }
        device
    }
}

/// The nominal model with the corrections of a fit. Its delay includes the common additional delay of the input.
pub(super) fn corrected(problem: &Problem<'_>, fit: &Fit) -> CorrectedModel {
    let effects = fit
        .hypothesis
        .parts(&fit.x)
        .map(|(term, own)| CorrectedEffect {
            effect: Effect {
                kind: term.kind,
                values: term.at(own),
            },
            sensor_on_load: term.sensor_on_load,
        });
    let effects = effects.collect();
    let (recording, priors) = (problem.recording, &problem.priors);
    let mut model = fit.hypothesis.at_priors(&recording.model, priors, &fit.x);
    model.delay += common_input_shift_s(recording, priors, &fit.x).unwrap_or(0.0);
    CorrectedModel {
        model,
        effects,
        tables: Vec::new(),
    }
}

/// The nominal model without a correction.
pub(super) fn nominal(recording: &recording::Recording) -> CorrectedModel {
    CorrectedModel {
        model: recording.model,
        effects: Vec::new(),
        tables: Vec::new(),
    }
}
