//! Output files of a diagnosis: JSON, the corrected model and the report.

use crate::device_file;
use crate::failure::Failure;
use crate::provenance::Provenance;
use crate::report;
use gap::{Device, MissingTorque, ModelFile, Outcome};
use recording::Recording;
use serde_json::{Value, json};
use std::path::Path;

/// The diagnosis as JSON, with the keys that the recording format defines.
pub fn json(recording: &Recording, outcome: &Outcome, provenance: &Provenance) -> Value {
    // All keys are strings and all values are serializable, so this cannot fail.
    let mut whole = serde_json::to_value(&outcome.diagnosis).unwrap_or_default();
    if let Value::Object(keys) = &mut whole {
        let missing = MissingTorque::of(recording, &Device::nominal(&recording.model));
        keys.insert("missing_torque".into(), json!(missing.summary()));
        keys.insert("provenance".into(), json!(provenance));
    }
    whole
}

/// Writes the corrected model, or only its effects, to a file.
pub fn save_model(
    path: &Path,
    recording: &Recording,
    outcome: &Outcome,
    effects_only: bool,
) -> Result<(), Failure> {
    let whole = ModelFile::new(&outcome.model, recording).to_string();
    let text = if effects_only {
        device_file::effects_alone(&whole)
    } else {
        whole
    };
    std::fs::write(path, text).map_err(Failure::write(path))
}

/// Writes the report to a file.
pub fn save_report(
    path: &Path,
    recording: &Recording,
    outcome: &Outcome,
    provenance: &Provenance,
) -> Result<(), Failure> {
    let page = report::page(recording, outcome, provenance)?;
    std::fs::write(path, page).map_err(Failure::write(path))
}
