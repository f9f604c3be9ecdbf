//! What is odd about a recording without spoiling it.

use crate::digits::short;
use std::mem::discriminant;

/// Something odd that was found and worked around, as one line.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Oddity {
    /// A key that nobody reads.
    #[error("recording.toml, line {line}: `{key}` in {table} is unknown and ignored{}", match nearest { Some(name) => format!("; was `{name}` meant?"), None => String::new() })]
    UnknownKey {
        /// Its line.
        line: usize,
        /// Its table.
        table: String,
        /// The key.
        key: String,
        /// What was probably meant.
        nearest: Option<&'static str>,
    },
    /// A unit that nobody knows.
    #[error("`{unit}` under [units] is no known unit of `{column}`{}; it is shown as it stands, and decides nothing", match nearest { Some(name) => format!(" (was `{name}` meant?)"), None => String::new() })]
    UnknownUnit {
        /// The column that is in it.
        column: &'static str,
        /// As written.
        unit: String,
        /// What was probably meant.
        nearest: Option<&'static str>,
    },
    /// A position column about which nothing is stated.
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
    #[error("{file}: {count} {} in time, the longest {longest_s} s at {at_s} s, where the sample period is {median_s} s; prediction begins anew after what a restart cannot bridge", if *count == 1 { "gap" } else { "gaps" }, median_s = short(*median_s), longest_s = short(*longest_s), at_s = short(*at_s))]
    Gaps {
        /// The run.
        file: String,
        /// How many.
        count: usize,
        /// The longest, s.
        longest_s: f64,
        /// Time at which the longest starts, s.
        at_s: f64,
        /// Median of the period, s.
        median_s: f64,
    },
    /// The input never changes, so it excites nothing.
    #[error("{file}: `input` is {value} in every row; it tells nothing about actuation", value = short(*value))]
    ConstantInput {
        /// The run.
        file: String,
        /// The only value.
        value: f64,
    },
    /// A column that repeats one value, as if it were not live.
    #[error("{file}: column `{column}` never changes and is not used")]
    FrozenColumn {
        /// The run.
        file: String,
        /// The column.
        column: String,
    },
    /// The position stays at an extreme that a motion runs into, and comes out of at once as fast as it goes elsewhere.
    #[error("{file}: `position` saturates at {value}, for {stay_s} s from {from_s} s on at the longest; the rows in which it does are left out: stay within the sensor's range", value = short(*value), stay_s = short(*stay_s), from_s = short(*from_s))]
    Saturated {
        /// The run.
        file: String,
        /// The extreme.
        value: f64,
        /// Start of the longest stay, s.
        from_s: f64,
        /// Its length, s.
        stay_s: f64,
    },
    /// The position runs into its extreme and stays there.
    #[error("{file}: `position` runs into {value} and stays for {stay_s} s from {from_s} s on while the input changes: the sensor saturates, or a stop holds; its samples count as they are", value = short(*value), stay_s = short(*stay_s), from_s = short(*from_s))]
    Held {
        /// The run.
        file: String,
        /// The extreme.
        value: f64,
        /// Start of the longest stay, s.
        from_s: f64,
        /// Its length, s.
        stay_s: f64,
    },
    /// The position stays amid a motion and then jumps to where that has gone.
    #[error("{file}: `position` freezes {count} {}, the longest for {stay_s} s from {from_s} s on, and then jumps to where the motion has gone; the rows in which it does are left out: check the sensor and its bus", if *count == 1 { "time" } else { "times" }, from_s = short(*from_s), stay_s = short(*stay_s))]
    FrozenPosition {
        /// The run.
        file: String,
        /// How often.
        count: usize,
        /// Start of the longest, s.
        from_s: f64,
        /// Its length, s.
        stay_s: f64,
    },
    /// The position is new in some rows only.
    #[error("{file}: `position` is new in every {every}{} row only; the rows between are left out: log no faster than the sensor is read", match every { 2 => "nd", 3 => "rd", _ => "th" })]
    Repeated {
        /// The run.
        file: String,
        /// Rows from one to the next, mostly.
        every: usize,
    },
    /// Single samples far from both their neighbours, as no motion makes them.
    #[error("{file}: {count} samples of `position` stand out from both their neighbours, the farthest by {farthest} at {at_s} s; their rows are left out: check the sensor and its wiring", farthest = short(*farthest), at_s = short(*at_s))]
    Spikes {
        /// The run.
        file: String,
        /// How many.
        count: usize,
        /// How far the farthest stands out, in units of position.
        farthest: f64,
        /// Its time, s.
        at_s: f64,
    },
    /// A first sample far from where the next ones come from: a sensor that was read before it was ready.
    #[error("{file}: the first `position` stands {off} apart from where the next ones come from; the first row is left out: begin the log when the sensor is ready", off = short(*off))]
    StaleStart {
        /// The run.
        file: String,
        /// How far, in units of position.
        off: f64,
    },
    /// The input of a run that is stated as open-loop is a controller's.
    #[error(
        "{file}: {percent:.0} % of what is quick in `input` follows the noise of `position`: it is a controller's own law, and the run is taken as closed-loop; write so in `drive`"
    )]
    Controlled {
        /// The run.
        file: String,
        /// Share of the quick part of the input, %.
        percent: f64,
    },
    /// The position goes the other way than the input drives the model.
    #[error("`input` and `position` go against each other: the model leaves {told} {unit} with both as they are, {mute} without any input and {turned} with the other sign of `{column}`, which is assumed: correct the sign in the log", told = short(*told), mute = short(*mute), turned = short(*turned))]
    Turned {
        /// The one that the other sign suits better.
        column: &'static str,
        /// Root mean square of what the model leaves as it is given, in units of position.
        told: f64,
        /// Root mean square that the model leaves without any input, in units of position.
        mute: f64,
        /// Root mean square that the model leaves with the other sign, in units of position.
        turned: f64,
        /// Unit of position.
        unit: String,
    },
    /// Two runs claim the same stretch of session time.
    #[error("{first} and {second} overlap in time; they are taken as separate runs")]
    Overlap {
        /// The run that starts first.
        first: String,
        /// The run that starts before that has ended.
        second: String,
    },
    /// The data have another quantum than is stated.
    #[error("{file}: `position` has steps of {seen}, but [sensor.position] says a resolution of {stated}", seen = short(*seen), stated = short(*stated))]
    Resolution {
        /// The run.
        file: String,
        /// Median distance of neighbouring values.
        seen: f64,
        /// What the manifest says.
        stated: f64,
    },
    /// The position jitters by far more than is stated.
    #[error("{file}: `position` jitters by {seen} from sample to sample, where [sensor.position] says {stated}: what stirs it so is taken for noise, and no gap is looked for below it", seen = short(*seen), stated = short(*stated))]
    Noisy {
        /// The run.
        file: String,
        /// Standard deviation of white noise that jitters so.
        seen: f64,
        /// What the manifest says, quantising included.
        stated: f64,
    },
    /// A servo that is simulated without its dead band.
    #[error(
        "`deadband` of `servo` is not simulated in the nominal model; what it does counts as part of the gap"
    )]
    ServoDeadband,
    /// The supply is read so coarsely that its steps are not events.
    #[error("{file}: `supply` is read in steps of {step}, {} % of it; a change of one step is no event", short(*percent), step = short(*step))]
    CoarseSupply {
        /// The run.
        file: String,
        /// The quantum.
        step: f64,
        /// The quantum relative to the median reading, %.
        percent: f64,
    },
}

impl Oddity {
    /// The run that it is odd about, if it is one.
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
            | Self::ServoDeadband
            | Self::UnknownUnit { .. }
            | Self::SensorAssumed { .. }
            | Self::Turned { .. }
            | Self::Overlap { .. } => None,
        }
    }

    /// True if another run is odd in the same way.
    fn is_like(&self, other: &Self) -> bool {
        let columns = [self, other].map(|one| match one {
            Self::FrozenColumn { column, .. } => Some(column),
            _ => None,
        });
        discriminant(self) == discriminant(other) && columns[0] == columns[1]
    }
}

/// Files that are named after the first.
const NAMED: usize = 3;

/// What is odd as lines: where several runs are odd in the same way one tells of the first, and which the others are.
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
