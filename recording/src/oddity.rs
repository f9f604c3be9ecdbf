//! Oddities: minor problems of a recording that do not prevent its use.

use crate::digits::short;
use std::mem::discriminant;

/// A minor problem and how it was handled, as one line.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Oddity {
    /// An unknown key.
    #[error("recording.toml, line {line}: `{key}` in {table} is unknown and ignored{}", match nearest { Some(name) => format!("; was `{name}` meant?"), None => String::new() })]
    UnknownKey {
        /// Line of the key.
        line: usize,
        /// Table of the key.
        table: String,
        /// The key.
        key: String,
        /// The known key with the most similar name.
        nearest: Option<&'static str>,
    },
    /// An unknown unit.
    #[error("`{unit}` under [units] is no known unit of `{column}`{}; it is displayed as written and has no other effect", match nearest { Some(name) => format!(" (was `{name}` meant?)"), None => String::new() })]
    UnknownUnit {
        /// The column with this unit.
        column: &'static str,
        /// The unit as written.
        unit: String,
        /// The known unit with the most similar name.
        nearest: Option<&'static str>,
    },
    /// A position column without a sensor table.
    #[error("[sensor.{column}] is missing; the column is taken as continuous and free of noise")]
    SensorAssumed {
        /// The column.
        column: String,
    },
    /// The sample period varies.
    #[error("{file}: the sample period varies from {p05_s} to {p95_s} s (5 % to 95 %) around {median_s} s", p05_s = short(*p05_s), p95_s = short(*p95_s), median_s = short(*median_s))]
    Jitter {
        /// The run.
        file: String,
        /// 5 % quantile of the period, s.
        p05_s: f64,
        /// Median of the period, s.
        median_s: f64,
        /// 95 % quantile of the period, s.
        p95_s: f64,
    },
    /// Samples are missing.
    #[error("{file}: {count} {} in time, the longest {longest_s} s at {at_s} s, where the sample period is {median_s} s; the prediction restarts after gaps that are too long to bridge", if *count == 1 { "gap" } else { "gaps" }, median_s = short(*median_s), longest_s = short(*longest_s), at_s = short(*at_s))]
    Gaps {
        /// The run.
        file: String,
        /// Number of gaps.
        count: usize,
        /// Duration of the longest gap, s.
        longest_s: f64,
        /// Time at which the longest starts, s.
        at_s: f64,
        /// Median of the period, s.
        median_s: f64,
    },
    /// The input never changes, so it excites nothing.
    #[error("{file}: `input` is {value} in every row; it gives no information about the actuation", value = short(*value))]
    ConstantInput {
        /// The run.
        file: String,
        /// The only value.
        value: f64,
    },
    /// A column never changes.
    #[error("{file}: column `{column}` never changes and is not used")]
    FrozenColumn {
        /// The run.
        file: String,
        /// The column.
        column: String,
    },
    /// The sensor saturates: the position stays at an extreme that a motion enters and leaves at full speed.
    #[error("{file}: `position` saturates at {value}, for {stay_s} s from {from_s} s on at the longest; the rows in which it does are left out: stay within the sensor's range", value = short(*value), stay_s = short(*stay_s), from_s = short(*from_s))]
    Saturated {
        /// The run.
        file: String,
        /// Position at which it saturates.
        value: f64,
        /// Start of the longest segment, s.
        from_s: f64,
        /// Duration of the longest segment, s.
        stay_s: f64,
    },
    /// The position reaches an extreme abruptly and stays there.
    #[error("{file}: `position` runs into {value} and stays for {stay_s} s from {from_s} s on while the input changes: the sensor saturates, or a stop holds; its samples count as they are", value = short(*value), stay_s = short(*stay_s), from_s = short(*from_s))]
    Held {
        /// The run.
        file: String,
        /// Position at which it stays.
        value: f64,
        /// Start of the longest segment, s.
        from_s: f64,
        /// Duration of the longest segment, s.
        stay_s: f64,
    },
    /// The reading freezes during a motion and then jumps to the true position.
    #[error("{file}: `position` freezes {count} {}, the longest for {stay_s} s from {from_s} s on, and then jumps to where the motion has gone; the rows in which it does are left out: check the sensor and its bus", if *count == 1 { "time" } else { "times" }, from_s = short(*from_s), stay_s = short(*stay_s))]
    FrozenPosition {
        /// The run.
        file: String,
        /// Number of frozen segments.
        count: usize,
        /// Start of the longest segment, s.
        from_s: f64,
        /// Duration of the longest segment, s.
        stay_s: f64,
    },
    /// The position is new in some rows only.
    #[error("{file}: `position` is new in every {every}{} row only; the rows between are left out: log no faster than the sensor is read", match every { 2 => "nd", 3 => "rd", _ => "th" })]
    Repeated {
        /// The run.
        file: String,
        /// Median number of rows between new positions.
        every: usize,
    },
    /// Single samples are far from both their neighbours.
    #[error("{file}: {count} samples of `position` stand out from both their neighbours, the farthest by {farthest} at {at_s} s; their rows are left out: check the sensor and its wiring", farthest = short(*farthest), at_s = short(*at_s))]
    Spikes {
        /// The run.
        file: String,
        /// Number of spikes.
        count: usize,
        /// Largest distance from the neighbours, in units of position.
        farthest: f64,
        /// Time of that sample, s.
        at_s: f64,
    },
    /// The first sample is far from the following ones. The sensor was probably read before it was ready.
    #[error("{file}: the first `position` is {off} away from the extrapolation of the next ones; the first row is left out: begin the log when the sensor is ready", off = short(*off))]
    StaleStart {
        /// The run.
        file: String,
        /// Distance from the extrapolation of the next samples, in units of position.
        off: f64,
    },
    /// A run is stated as open-loop, but its input reacts to the position.
    #[error(
        "{file}: {percent:.0} % of what is quick in `input` follows the noise of `position`: it is a controller's own law, and the run is taken as closed-loop; write so in `drive`"
    )]
    Controlled {
        /// The run.
        file: String,
        /// Share of the fast part of the input that reacts to the position, %.
        percent: f64,
    },
    /// Input and position have opposite signs with respect to the model.
    #[error("`input` and `position` have opposite signs: the rms error of the model is {as_logged} {unit} as logged, {without_input} without any input and {corrected} with the other sign of `{column}`, which is assumed: correct the sign in the log", as_logged = short(*as_logged), without_input = short(*without_input), corrected = short(*corrected))]
    OppositeSign {
        /// The column whose sign is assumed to be wrong.
        column: &'static str,
        /// Rms prediction error with the signs as logged, in units of position.
        as_logged: f64,
        /// Rms prediction error without any input, in units of position.
        without_input: f64,
        /// Rms prediction error with the other sign, in units of position.
        corrected: f64,
        /// Unit of position.
        unit: String,
    },
    /// Two runs overlap in time.
    #[error("{first} and {second} overlap in time; they are taken as separate runs")]
    Overlap {
        /// The run that starts first.
        first: String,
        /// The run that starts before the first one has ended.
        second: String,
    },
    /// The observed quantum differs from the stated resolution.
    #[error("{file}: `position` has steps of {seen}, but [sensor.position] says a resolution of {stated}", seen = short(*seen), stated = short(*stated))]
    Resolution {
        /// The run.
        file: String,
        /// A typical distance between neighbouring values.
        seen: f64,
        /// Resolution in the manifest.
        stated: f64,
    },
    /// The noise of the position is far larger than stated.
    #[error("{file}: `position` jitters by {seen} from sample to sample, where [sensor.position] says {stated}: it is taken as noise, and a smaller gap cannot be detected", seen = short(*seen), stated = short(*stated))]
    Noisy {
        /// The run.
        file: String,
        /// Standard deviation of the observed noise, assumed white.
        seen: f64,
        /// Standard deviation stated in the manifest, including quantisation.
        stated: f64,
    },
    /// The quantum of the supply reading is so large that its steps are not events.
    #[error("{file}: `supply` is read in steps of {step}, {} % of it; a change of one step is no event", short(*percent), step = short(*step))]
    CoarseSupply {
        /// The run.
        file: String,
        /// The quantum.
        step: f64,
        /// The quantum over the median reading, %.
        percent: f64,
    },
}

impl Oddity {
    /// The run with the oddity, if it concerns one run.
    fn file(&self) -> Option<&str> {
        match self {
            Self::Jitter { file, .. }
            | Self::Gaps { file, .. }
            | Self::ConstantInput { file, .. }
            | Self::FrozenColumn { file, .. }
            | Self::Saturated { file, .. }
            | Self::Held { file, .. }
            | Self::FrozenPosition { file, .. }
            | Self::Repeated { file, .. }
            | Self::Spikes { file, .. }
            | Self::StaleStart { file, .. }
            | Self::Controlled { file, .. }
            | Self::Resolution { file, .. }
            | Self::Noisy { file, .. }
            | Self::CoarseSupply { file, .. } => Some(file),
            Self::UnknownKey { .. }
            | Self::UnknownUnit { .. }
            | Self::SensorAssumed { .. }
            | Self::OppositeSign { .. }
            | Self::Overlap { .. } => None,
        }
    }

    /// True if another run has the same oddity.
    fn is_like(&self, other: &Self) -> bool {
        let columns = [self, other].map(|one| match one {
            Self::FrozenColumn { column, .. } => Some(column),
            _ => None,
        });
        discriminant(self) == discriminant(other) && columns[0] == columns[1]
    }
}

/// Number of further files that are named.
const NAMED: usize = 3;

/// The oddities as lines. Equal oddities of several runs share a line, which describes the first and names the others.
pub(crate) fn lines(oddities: &[Oddity]) -> Vec<String> {
    let mut kinds: Vec<(&Oddity, Vec<&str>)> = Vec::new();
    for oddity in oddities {
        let alike = kinds.iter_mut().find(|(first, _)| first.is_like(oddity));
        match (alike, oddity.file()) {
            (Some((_, others)), Some(file)) => others.push(file),
            _ => kinds.push((oddity, Vec::new())),
        }
    }
    let lines = kinds.iter().map(|(first, others)| match others[..] {
        [] => first.to_string(),
        _ if others.len() > NAMED => format!("{first}; likewise {} other runs", others.len()),
        _ => format!("{first}; likewise {}", others.join(", ")),
    });
    lines.collect()
}
