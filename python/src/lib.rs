//! Native part of the Python package. Recordings and diagnoses are passed as text, and arrays without conversion.

use gap::{Device, MissingTorque, ModelFile, Options};
use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use recording::{Drive, Model, Run, Sensor};
use std::collections::BTreeMap;

fn refused(error: impl ToString) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// A recording in memory.
#[pyclass(name = "Recording")]
struct PyRecording(recording::Recording);

/// Name, time, measured position and predicted position of a run.
type Predicted<'py> = (String, Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>);

#[pymethods]
impl PyRecording {
    /// Reads the recording in a folder.
    #[staticmethod]
    fn read(folder: &str) -> PyResult<Self> {
        recording::Recording::read(folder).map(Self).map_err(refused)
    }

    /// Creates a recording without runs.
    #[new]
    fn new(title: &str, horizon: f64, model: BTreeMap<String, f64>, units: (String, String)) -> PyResult<Self> {
        let mut numbers = Model::new(1.0);
        let mut unstated: Vec<&'static str> = Model::ESSENTIAL.to_vec();
        for (name, value) in &model {
            if !numbers.state(name, *value) {
                let known = Model::NAMES.join(", ");
                return Err(refused(format!("the model has no number {name}; there are {known}")));
            }
            unstated.retain(|other| other != name);
        }
        let mut made = recording::Recording::new(title, horizon, numbers);
        made.unstated = unstated;
        made.units = recording::Units { position: units.0, input: units.1 };
        made.model.angle_rad = made.units.angle_rad();
        Ok(Self(made))
    }

    /// Adds a run with the columns time, input and position.
    fn add_run(
        &mut self,
        name: String,
        closed_loop: bool,
        time: PyReadonlyArray1<'_, f64>,
        input: PyReadonlyArray1<'_, f64>,
        position: PyReadonlyArray1<'_, f64>,
    ) -> PyResult<()> {
        let drive = if closed_loop { Drive::ClosedLoop } else { Drive::OpenLoop };
        let column = |array: PyReadonlyArray1<'_, f64>| -> Vec<f64> { array.as_array().iter().copied().collect() };
        let run = Run::new(name, drive, column(time), column(input), column(position));
        if run.input.len() != run.len() || run.position.len() != run.len() {
            return Err(refused("time, input and position differ in length; give one value of each a row"));
        }
        self.0.runs.push(run);
        Ok(())
    }

    /// States the properties of the position sensor.
    fn set_sensor(&mut self, resolution: f64, noise: f64, cutoff_hz: Option<f64>) {
        self.0.sensors.insert("position".into(), Sensor { resolution, noise, cutoff_hz });
    }

    /// States the relative standard deviation of a number of the model.
    fn set_tolerance(&mut self, name: &str, relative: f64) {
        self.0.tolerance.set(name, relative);
    }

    /// Checks that the recording can be used.
    fn validate(&self) -> PyResult<()> {
        self.0.validate().map_err(refused)
    }

    /// Writes the recording to a folder.
    fn write(&self, folder: &str) -> PyResult<()> {
        self.0.write(folder).map_err(refused)
    }

    /// Title of the recording.
    #[getter]
    fn title(&self) -> &str {
        &self.0.title
    }

    /// Names of the runs with their numbers of rows.
    #[getter]
    fn runs(&self) -> Vec<(String, usize)> {
        self.0.runs.iter().map(|run| (run.file.clone(), run.len())).collect()
    }

    /// Warnings about the recording.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.0.warnings()
    }

    /// Diagnoses the recording. Returns the JSON and the text of the corrected model.
    fn diagnose(&self, py: Python<'_>, without: Vec<String>) -> PyResult<(String, String)> {
        if let Some(unknown) = without.iter().find(|name| host_sim::effects::kind(name).is_none()) {
            return Err(refused(format!("there is no effect {unknown}")));
        }
        let recording = gap::inspected(self.0.clone()).map_err(refused)?;
        py.detach(|| {
            let options = Options { without, progress: |_| {} };
            let outcome = gap::diagnose(&recording, &options);
            let mut json = serde_json::to_value(&outcome.diagnosis).map_err(refused)?;
            let missing = MissingTorque::of(&recording, &Device::nominal(&recording.model));
            json["missing_torque"] = serde_json::to_value(missing.summary()).map_err(refused)?;
            let model = ModelFile::new(&outcome.model, &recording).to_string();
            Ok((json.to_string(), model))
        })
    }

    /// Measures the gap of the nominal model or of a saved one. Returns the JSON, and time, measured and predicted position
    /// of each run.
    fn measure<'py>(&self, py: Python<'py>, model: Option<&str>) -> PyResult<(String, Vec<Predicted<'py>>)> {
        let device = match model {
            Some(text) => {
                let file: ModelFile = text.parse().map_err(refused)?;
                file.on(&self.0).map_err(refused)?.0.device()
            }
            None => Device::nominal(&self.0.model),
        };
        let (gap, runs) = py.detach(|| gap::measure(&self.0, &device));
        let runs = runs.into_iter().map(|run| {
            let [time, measured, predicted] = [run.time, run.measured, run.predicted].map(|column| column.into_pyarray(py));
            (run.file, time, measured, predicted)
        });
        Ok((serde_json::to_string(&gap).map_err(refused)?, runs.collect()))
    }

    /// Estimates the missing torque and returns it as JSON.
    fn look(&self, py: Python<'_>) -> PyResult<String> {
        let recording = gap::inspected(self.0.clone()).map_err(refused)?;
        let summary = py.detach(|| serde_json::to_value(MissingTorque::of(&recording, &Device::nominal(&recording.model)).summary()));
        Ok(summary.map_err(refused)?.to_string())
    }
}

/// Estimates the unknown numbers of the recording's device. Returns the text of its manifest.
#[pyfunction]
fn manifest(recording: &PyRecording) -> PyResult<String> {
    import::manifest(&recording.0, &import::Known::default(), &[], false).map_err(refused)
}

/// The Python module.
#[pymodule]
fn _native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<PyRecording>()?;
    module.add_function(wrap_pyfunction!(manifest, module)?)?;
    Ok(())
}
