//! Reasons why a command fails, as one line with a remedy.

use crate::plot::PlotError;
use haptic_paddle::safety::Fault;
use haptic_paddle::settings::{FIELDS, SettingError};
use std::path::{Path, PathBuf};

/// Reason why a command fails.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// The recording cannot be used.
    #[error(transparent)]
    Recording(#[from] recording::Error),
    /// A log cannot be imported.
    #[error(transparent)]
    Import(#[from] import::ImportError),
    /// The user did not accept the columns that were guessed from a log.
    #[error("nothing was written; say what the columns are by --time, --input and --position")]
    NotConfirmed,
    /// The unit of a column differs from the unit of its model.
    #[error("{}: {mistake}", .folder.display())]
    Unit {
        /// Folder of the recording.
        folder: PathBuf,
        /// The wrong unit.
        mistake: gap::UnitMistake,
    },
    /// The text of an effect cannot be parsed.
    #[error(transparent)]
    Effect(#[from] host_sim::effects::EffectError),
    /// A file does not define an effect correctly.
    #[error("{}: {cause}", .path.display())]
    OwnEffect {
        /// The file.
        path: PathBuf,
        /// The cause and a remedy.
        cause: gap::effects::OwnEffectError,
    },
    /// A chart cannot be drawn.
    #[error(transparent)]
    Plot(#[from] PlotError),
    /// A file cannot be read.
    #[error("cannot read {}: {source}; check the name", .path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// A path on the command line cannot be written.
    #[error("{option} {}: {why}", .path.display())]
    Target {
        /// The option that names the path.
        option: &'static str,
        /// The path.
        path: PathBuf,
        /// The cause and a remedy.
        why: String,
    },
    /// A file cannot be written.
    #[error("cannot write {}: {source}; name another place", .path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// Text after --set without a name and a value.
    #[error("--set '{0}' is not NAME=VALUE; write for instance --set pid.setpoint_weight=0.5")]
    NotASetting(String),
    /// A setting that the control core refuses.
    #[error("{0}")]
    Setting(String),
    /// A closed loop that cannot start.
    #[error(transparent)]
    Loop(#[from] host_sim::closed_loop::LoopError),
    /// An experiment that cannot be carried out.
    #[error(transparent)]
    Experiment(#[from] host_sim::experiment::ExperimentError),
    /// The controller stopped an experiment before its required end.
    #[error("the paddle stopped at {:.0} ms: {fault}; ask for a smaller amplitude, or for lower gains", 1e3 * .time_s)]
    Stopped {
        /// Time of the stop, s.
        time_s: f64,
        /// Cause of the stop.
        fault: Fault,
    },
    /// No proportional gain sustains an oscillation of the loop.
    #[error(
        "no proportional gain up to {0} N m/deg keeps it swinging; raise --amplitude, or lower the friction"
    )]
    NeverSwings(f64),
    /// A specification that no gains meet.
    #[error(
        "no gains were found that meet the specification; the best miss it as shown: ask for less, or narrow the spread"
    )]
    OutOfReach,
    /// Rows of the reproduced report are outside their bars.
    #[error("{missed} of {barred} rows with a bar miss it")]
    Missed {
        /// Number of rows outside their bars.
        missed: usize,
        /// Number of rows with a bar.
        barred: usize,
    },
    /// The blind check cannot continue.
    #[error(transparent)]
    Blind(#[from] blind::CheckError),
    /// The folder contains a recording, which may be a measurement.
    #[error("{} holds a recording already, which would be lost; name another folder", .0.display())]
    HoldsRecording(PathBuf),
    /// A folder contains no recording.
    #[error("{} holds no recording; name a folder with recording.toml in it or below it", .0.display())]
    NoRecording(PathBuf),
    /// A folder contains no recording of the lab.
    #[error("--recorded {} holds neither sine-0011 nor steps-encoder; name the folder that has them", .0.display())]
    NotRecorded(PathBuf),
    /// Some recordings of a batch could not be used.
    #[error("{failed} of {all} recordings could not be used; the others are done")]
    Batch {
        /// Number of recordings that could not be used.
        failed: usize,
        /// Number of all recordings.
        all: usize,
    },
    /// The virtual board cannot be run as asked.
    #[error("{0}")]
    Board(String),
    /// The image cannot be used.
    #[error("{}: {source}", .path.display())]
    Image {
        /// The file.
        path: PathBuf,
        /// The cause and a remedy.
        source: virtual_board::image::ImageError,
    },
    /// The virtual board cannot continue.
    #[error(transparent)]
    Halt(#[from] virtual_board::board::Halt),
    /// The board at the serial port failed.
    #[error(transparent)]
    Device(#[from] remote::DeviceError),
    /// The diagnosis stopped because of a defect of the program.
    #[error("the diagnosis broke off on a fault of the program; report it with the recording")]
    Fault,
    /// No experiment left a run that can be used.
    #[error(
        "no experiment could be recorded: the paddle leaves its travel or does not come to rest; hold it in the middle, or ask for smaller ones"
    )]
    NothingRecorded,
    /// The unit of the model's positions is not one of the units of simulators.
    #[error("{}: its positions are neither in rad nor in m, as simulators take them; diagnose a recording in these", .0.display())]
    NotSi(PathBuf),
    /// A folder contains no diagnosis.
    #[error("{} holds no diagnosis; name what `paddle gap diagnose --batch` left", .0.display())]
    NoResults(PathBuf),
    /// The model file has no numbers, and there is no recording to take them from.
    #[error(
        "{} holds effects alone; give a model that was saved without --effects-only, or use it with a recording: paddle gap measure RECORDING --model", .0.display()
    )]
    EffectsAlone(PathBuf),
    /// A model file is invalid.
    #[error("{}: {cause}", .path.display())]
    ModelFile {
        /// The file.
        path: PathBuf,
        /// The cause and a remedy.
        cause: gap::model_file::ModelFileError,
    },
    /// A device file is invalid.
    #[error("{}: {cause}", .path.display())]
    DeviceFile {
        /// The file.
        path: PathBuf,
        /// The cause and a remedy.
        cause: String,
    },
}

/// Exit status for input that could not be used.
pub const BAD_INPUT: u8 = 2;
/// Exit status of a check that failed and of a search without a result.
const CHECK_MISSED: u8 = 1;

impl Failure {
    /// Exit status of the program.
    pub fn status(&self) -> u8 {
        match self {
            Self::Missed { .. } | Self::OutOfReach => CHECK_MISSED,
            _ => BAD_INPUT,
        }
    }

    /// The setting `name` was refused.
    pub fn setting(name: &str, error: SettingError) -> Self {
        Self::Setting(match error {
            SettingError::Unknown => {
                let known: Vec<_> = FIELDS.iter().map(|field| field.name).collect();
                format!(
                    "no setting is called '{name}'; there are {}",
                    known.join(" ")
                )
            }
            other => other.to_string(),
        })
    }

    /// Error conversion for `map_err` after writing to `path`.
    pub fn write<P: AsRef<Path>>(path: P) -> impl FnOnce(std::io::Error) -> Self {
        move |source| Self::Write {
            path: path.as_ref().to_owned(),
            source,
        }
    }

    /// Error conversion for `map_err` after reading from `path`.
    pub fn read<P: AsRef<Path>>(path: P) -> impl FnOnce(std::io::Error) -> Self {
        move |source| Self::Read {
            path: path.as_ref().to_owned(),
            source,
        }
    }
}
