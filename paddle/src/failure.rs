//! Why a command cannot do what it is asked, in one line with the mend.

use crate::plot::PlotError;
use haptic_paddle::safety::Fault;
use haptic_paddle::settings::{FIELDS, SettingError};
use std::path::{Path, PathBuf};

/// Why a command stops.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// The recording cannot be used.
    #[error(transparent)]
    Recording(#[from] recording::Error),
    /// A log cannot be imported.
    #[error(transparent)]
    Import(#[from] import::ImportError),
    /// The user does not agree with the roles that were guessed from a log.
    #[error("nothing was written; say what the columns are by --time, --input and --position")]
    NotConfirmed,
    /// A column of it is in another unit than its model.
    #[error("{}: {mistake}", .folder.display())]
    Unit {
        /// The recording.
        folder: PathBuf,
        /// Which.
        mistake: gap::UnitMistake,
    },
    /// An effect cannot be understood.
    #[error(transparent)]
    Effect(#[from] host_sim::effects::EffectError),
    /// A file that is to define an effect.
    #[error("{}: {cause}", .path.display())]
    OwnEffect {
        /// The file.
        path: PathBuf,
        /// What is wrong, and the mend.
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
        /// What the system said.
        source: std::io::Error,
    },
    /// A place named on the command line where nothing can be written.
    #[error("{option} {}: {why}", .path.display())]
    Target {
        /// The option.
        option: &'static str,
        /// The place.
        path: PathBuf,
        /// Why, and the mend.
        why: String,
    },
    /// A file cannot be written.
    #[error("cannot write {}: {source}; name another place", .path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// Text after --set that sets nothing.
    #[error("--set '{0}' is not NAME=VALUE; write for instance --set pid.setpoint_weight=0.5")]
    NotASetting(String),
    /// A setting that the core refuses.
    #[error("{0}")]
    Setting(String),
    /// A loop that cannot start.
    #[error(transparent)]
    Loop(#[from] host_sim::closed_loop::LoopError),
    /// An experiment that cannot be carried out.
    #[error(transparent)]
    Experiment(#[from] host_sim::experiment::ExperimentError),
    /// The controller stopped an experiment whose end is needed.
    #[error("the paddle stopped at {:.0} ms: {fault}; ask for a smaller amplitude, or for lower gains", 1e3 * .time_s)]
    Stopped {
        /// When, s.
        time_s: f64,
        /// Why.
        fault: Fault,
    },
    /// A loop that no proportional gain keeps swinging.
    #[error(
        "no proportional gain up to {0} N m/deg keeps it swinging; raise --amplitude, or lower the friction"
    )]
    NeverSwings(f64),
    /// A specification that no gains meet.
    #[error(
        "no gains were found that meet the specification; the best miss it as shown: ask for less, or narrow the spread"
    )]
    OutOfReach,
    /// Rows of the reproduced report that miss their bars.
    #[error("{missed} of {barred} rows with a bar miss it")]
    Missed {
        /// Number of rows that miss their bar.
        missed: usize,
        /// All with a bar.
        barred: usize,
    },
    /// The blind check cannot go on.
    #[error(transparent)]
    Blind(#[from] blind::CheckError),
    /// What stands there may be a measurement.
    #[error("{} holds a recording already, which would be lost; name another folder", .0.display())]
    HoldsRecording(PathBuf),
    /// No recording where one is looked for.
    #[error("{} holds no recording; name a folder with recording.toml in it or below it", .0.display())]
    NoRecording(PathBuf),
    /// No lab recording where some are said to be.
    #[error("--recorded {} holds neither sine-0011 nor steps-encoder; name the folder that has them", .0.display())]
    NotRecorded(PathBuf),
    /// Some recordings of a batch could not be used.
    #[error("{failed} of {all} recordings could not be used; the others are done")]
    Batch {
        /// Number of recordings that could not be used.
        failed: usize,
        /// All.
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
        /// What is wrong, and the mend.
        source: virtual_board::image::ImageError,
    },
    /// The virtual board can go no further.
    #[error(transparent)]
    Halt(#[from] virtual_board::board::Halt),
    /// The board at the other end of the serial port.
    #[error(transparent)]
    Device(#[from] remote::DeviceError),
    /// The program is at fault.
    #[error("the diagnosis broke off on a fault of the program; report it with the recording")]
    Fault,
    /// A model in other units of position than those of simulators.
    #[error("{}: its positions are neither in rad nor in m, as simulators take them; diagnose a recording in these", .0.display())]
    NotSi(PathBuf),
    /// No diagnosis where some are looked for.
    #[error("{} holds no diagnosis; name what `paddle gap diagnose --batch` left", .0.display())]
    NoResults(PathBuf),
    /// A model file without numbers where there is no recording to take them from.
    #[error(
        "{} holds effects alone; give a model that was saved without --effects-only, or use it with a recording: paddle gap measure RECORDING --model", .0.display()
    )]
    EffectsAlone(PathBuf),
    /// A model file that is not as it should be.
    #[error("{}: {cause}", .path.display())]
    ModelFile {
        /// The file.
        path: PathBuf,
        /// What is wrong, and the mend.
        cause: gap::model_file::ModelFileError,
    },
    /// A device file that is not as it should be.
    #[error("{}: {cause}", .path.display())]
    DeviceFile {
        /// The file.
        path: PathBuf,
        /// What is wrong, and the mend.
        cause: String,
    },
}

/// Exit status for input that could not be used.
pub const BAD_INPUT: u8 = 2;
/// Exit status of a check or a search that found something amiss.
const CHECK_MISSED: u8 = 1;

impl Failure {
    /// Exit status of the program.
    pub fn status(&self) -> u8 {
        match self {
            Self::Missed { .. } | Self::OutOfReach => CHECK_MISSED,
            _ => BAD_INPUT,
        }
    }

    /// The setting called `name` was refused.
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

    /// For `map_err` after writing to `path`.
    pub fn write<P: AsRef<Path>>(path: P) -> impl FnOnce(std::io::Error) -> Self {
        move |source| Self::Write {
            path: path.as_ref().to_owned(),
            source,
        }
    }

    /// For `map_err` after reading from `path`.
    pub fn read<P: AsRef<Path>>(path: P) -> impl FnOnce(std::io::Error) -> Self {
        move |source| Self::Read {
            path: path.as_ref().to_owned(),
            source,
        }
    }
}
