//! What a diagnosis leaves behind: JSON, the corrected model and the report.

use crate::device_file;
use crate::failure::Failure;
use crate::provenance::Provenance;
use crate::report;
use gap::{Device, MissingTorque, ModelFile, Outcome};
use recording::Recording;
use serde_json::{Value, json};
use std::path::Path;

/// The diagnosis in the recording format's JSON.
pub fn json(recording: &Recording, outcome: &Outcome, provenance: &Provenance) -> Value {
    // Keys are text and numbers are numbers: this cannot fail.
    let mut whole = serde_json::to_value(&outcome.diagnosis).unwrap_or_default();
    if let Value::Object(keys) = &mut whole {
        let missing = MissingTorque::of(recording, &Device::nominal(&recording.model));
        keys.insert("missing_torque".into(), json!(missing.summary()));
        keys.insert("provenance".into(), json!(provenance));
    }
    whole
}

/// Leaves the corrected model in a file, or its effects alone.
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

/// Leaves the page in a file.
pub fn save_report(
    path: &Path,
    recording: &Recording,
    outcome: &Outcome,
    provenance: &Provenance,
) -> Result<(), Failure> {
    let page = report::page(recording, outcome, provenance)?;
    std::fs::write(path, page).map_err(Failure::write(path))
}
