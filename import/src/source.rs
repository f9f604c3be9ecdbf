//! A log with the roles of its columns, given by the recipe or guessed.

use crate::clock;
use crate::counter;
use crate::error::ImportError;
use crate::guess;
use crate::log::{Column, Log};
use crate::recipe::Recipe;
use crate::sensor;
use crate::signal::{Choice, numbers};
use crate::unit::{self, Quantity};
use std::f64::consts::TAU;

/// Default wrap-around spans of angles in rad, deg and turns.
const ANGLE_SPANS: [f64; 3] = [TAU, 360.0, 1.0];
/// Default wrap-around spans of registers.
const COUNTER_SPANS: [f64; 7] = [
    1024.0,
    4096.0,
    8192.0,
    16_384.0,
    65_536.0,
    4_294_967_296.0,
    36_000.0,
];

/// A log with the roles of its columns.
pub(crate) struct Source<'a> {
    pub log: &'a Log,
    pub recipe: &'a Recipe,
    /// Index of the log.
    pub place: usize,
    pub seconds: Vec<f64>,
    pub origin_s: f64,
    /// True if the log has the recording's own format, so that its times are kept.
    pub keeps_time: bool,
    pub input: Option<Choice<'a>>,
    pub position: Choice<'a>,
    pub is_velocity: bool,
    pub setpoint: Option<Choice<'a>>,
    pub further: Vec<(String, Choice<'a>)>,
    pub split_by: Option<&'a Column>,
    pub roles: Vec<String>,
    pub notes: Vec<String>,
    pub is_guessed: bool,
}

impl<'a> Source<'a> {
    pub fn of(log: &'a Log, recipe: &'a Recipe, place: usize) -> Result<Self, ImportError> {
        let mut roles = Vec::new();
        let mut notes: Vec<String> = log
            .notes
            .iter()
            .map(|note| format!("{}: {note}", log.name))
            .collect();
        let mut is_guessed = false;
        let mut taken = Vec::new();
        let at = |choice: &Choice| match choice {
            Choice::Column { column, .. } => log
                .columns
                .iter()
                .position(|other| std::ptr::eq(other, *column)),
            Choice::Formula { .. } => None,
        };
        let not_guessed = |role, option| ImportError::NotGuessed {
            log: log.name.clone(),
            role,
            option,
            known: log.live_names(),
        };
        let of_column = |at: usize| Choice::Column {
            column: &log.columns[at],
            unit: None,
        };

        let (seconds, origin_s, said) = match (&recipe.time, recipe.rate_hz) {
            (_, Some(rate_hz)) if rate_hz > 0.0 && rate_hz.is_finite() => {
                let seconds = (0..log.rows()).map(|row| row as f64 / rate_hz).collect();
                (seconds, 0.0, format!("{rate_hz} rows a second, as stated"))
            }
            (_, Some(rate_hz)) => {
                return Err(ImportError::Option(format!(
                    "--rate is {rate_hz}; it must be above 0"
                )));
            }
            (Some(text), None) => match Choice::of(text, log)? {
                Choice::Column { column, unit } => {
                    taken.extend(at(&Choice::Column { column, unit: None }));
                    let times = clock::times(column, unit.as_deref(), &log.name)?;
                    let said = format!("`{}` in {}", column.name.trim(), times.unit);
                    (times.seconds, times.origin_s, said)
                }
                formula @ Choice::Formula { .. } => {
                    let values = formula.values(log)?;
                    let si = match formula.unit().map(unit::parse) {
                        None => 1.0,
                        Some(Some((Quantity::Time, si))) => si,
                        Some(_) => {
                            let unit = formula.unit().unwrap_or_default().to_owned();
                            return Err(ImportError::Unit {
                                unit,
                                role: "time",
                                examples: "s, ms, us, ns",
                            });
                        }
                    };
                    let first = values
                        .iter()
                        .copied()
                        .find(|value| !value.is_nan())
                        .unwrap_or(0.0);
                    let seconds = values.iter().map(|value| (value - first) * si).collect();
                    (
                        seconds,
                        first * si,
                        format!("{} in {}", formula.name(), formula.unit().unwrap_or("s")),
                    )
                }
            },
            (None, None) => {
                let found = guess::time(log).ok_or_else(|| not_guessed("time", "--time"))?;
                is_guessed = true;
                taken.push(found);
                let column = &log.columns[found];
                let times = clock::times(column, None, &log.name)?;
                let how = if times.is_guessed {
                    ", told by its size"
                } else {
                    ""
                };
                let said = format!("`{}` in {}{how}", column.name.trim(), times.unit);
                (times.seconds, times.origin_s, said)
            }
        };
        roles.push(format!("time      {said}"));

        let position_text = recipe.position.as_ref().or(recipe.velocity.as_ref());
        let is_velocity = recipe.position.is_none() && recipe.velocity.is_some();
        let (position, is_velocity) = match position_text {
            Some(text) => (Choice::of(text, log)?, is_velocity),
            None => {
                is_guessed = true;
                let position = guess::position(log, &taken).map(|at| (of_column(at), false));
                let velocity = || guess::velocity(log, &taken).map(|at| (of_column(at), true));
                position
                    .or_else(velocity)
                    .ok_or_else(|| not_guessed("position", "--position"))?
            }
        };
        taken.extend(at(&position));
        let input = match (&recipe.input, &recipe.pid) {
            (Some(_), Some(_)) => {
                return Err(ImportError::Option(
                    "--input and --pid both say what the input was; leave one out".into(),
                ));
            }
            (Some(text), None) => Some(Choice::of(text, log)?),
            (None, Some(_)) => None,
            (None, None) => {
                is_guessed = true;
                let found =
                    guess::input(log, &taken).ok_or_else(|| not_guessed("input", "--input"))?;
                Some(of_column(found))
            }
        };
        taken.extend(input.as_ref().and_then(at));
        let setpoint = match &recipe.setpoint {
            Some(text) => Some(Choice::of(text, log)?),
            None => guess::setpoint(log, &taken).map(of_column),
        };
        let mut further = Vec::new();
        for (name, text) in &recipe.further {
            if !is_further(name) {
                return Err(ImportError::Option(format!(
                    "a recording has no column `{name}`; it may be called position_NAME, current, supply or temperature"
                )));
            }
            further.push((name.clone(), Choice::of(text, log)?));
        }
        for column in &log.columns {
            let name = column.name.trim();
            if is_further(name)
                && !further.iter().any(|(other, _)| other == name)
                && column.values().is_some()
            {
                further.push((name.to_owned(), Choice::Column { column, unit: None }));
            }
        }
        let split_by = match &recipe.split_by {
            Some(name) => Some(&log.columns[log.find(name)?]),
            None => ["episode_index", "episode", "run", "trial"]
                .iter()
                .find_map(|name| {
                    log.columns
                        .iter()
                        .find(|column| column.name.eq_ignore_ascii_case(name) && column.is_live())
                }),
        };
        let frozen = log.frozen_names();
        if !frozen.is_empty() {
            let names = crate::log::listed(frozen.into_iter());
            notes.push(format!(
                "{}: these columns repeat one value, as if they were not live: {names}",
                log.name
            ));
        }
        let has = |name: &str| log.columns.iter().any(|column| column.name == name);
        let keeps_time = has("time")
            && has("input")
            && has("position")
            && recipe.time.is_none()
            && recipe.rate_hz.is_none();
        let mut seconds = seconds;
        if keeps_time && let Some(column) = log.columns.iter().find(|column| column.name == "time")
        {
            // Times in the recording format are always in s.
            seconds = numbers(column, log)?;
        }
        Ok(Self {
            log,
            recipe,
            place,
            seconds,
            origin_s,
            keeps_time,
            input,
            position,
            is_velocity,
            setpoint,
            further,
            split_by,
            roles,
            notes,
            is_guessed,
        })
    }

    /// The unit of the position, and its conversion to the unit of the recording.
    pub fn position_quantity(&self) -> Result<Reading, ImportError> {
        let unit = self.position.unit();
        let wrong = |role: &'static str, examples: &'static str| ImportError::Unit {
            unit: unit.unwrap_or_default().to_owned(),
            role,
            examples,
        };
        let logged = unit.map(str::to_owned);
        let parsed = unit.map(unit::parse);
        if self.is_velocity {
            return match parsed {
                None => Ok(Reading {
                    si: 1.0,
                    unit: "rad",
                    logged,
                    counts: None,
                }),
                Some(Some((Quantity::AngularVelocity, si))) => Ok(Reading {
                    si,
                    unit: "rad",
                    logged,
                    counts: None,
                }),
                Some(Some((Quantity::Speed, si))) => Ok(Reading {
                    si,
                    unit: "m",
                    logged,
                    counts: None,
                }),
                Some(_) => Err(wrong("velocity", "rad/s, deg/s, rpm, m/s")),
            };
        }
        match (self.recipe.counts_per_turn, parsed) {
            (Some(counts), None | Some(Some((Quantity::Count, _))))
                if counts > 0.0 && counts.is_finite() =>
            {
                Ok(Reading {
                    si: TAU / counts,
                    unit: "rad",
                    logged: Some("counts".into()),
                    counts: Some(counts),
                })
            }
            (Some(counts), _) if !(counts > 0.0 && counts.is_finite()) => Err(ImportError::Option(
                format!("--counts-per-turn is {counts}; it must be above 0"),
            )),
            (Some(_), _) => Err(ImportError::Option(format!(
                "--counts-per-turn is given, but the position is in {}; leave one out",
                unit.unwrap_or_default()
            ))),
            (None, None) => Ok(Reading {
                si: 1.0,
                unit: "rad",
                logged,
                counts: None,
            }),
            (None, Some(Some((Quantity::Angle, si)))) => Ok(Reading {
                si,
                unit: "rad",
                logged,
                counts: None,
            }),
            (None, Some(Some((Quantity::Length, si)))) => Ok(Reading {
                si,
                unit: "m",
                logged,
                counts: None,
            }),
            (None, Some(Some((Quantity::Count, _)))) => Err(ImportError::CountsPerTurn),
            (None, Some(_)) => Err(wrong(
                "position",
                "rad, deg, turns, m, mm, or counts with --counts-per-turn",
            )),
        }
    }

    /// The conversion of the input to the unit of the recording, and that unit.
    pub fn input_unit(&self) -> Result<(f64, String), ImportError> {
        let Some(choice) = &self.input else {
            return Ok((1.0, "N m".into()));
        };
        let Some(text) = choice.unit() else {
            return Ok((1.0, unit_of_name(choice).to_owned()));
        };
        let Some((quantity, si)) = unit::parse(text) else {
            return Ok((1.0, text.to_owned()));
        };
        Ok(match quantity {
            Quantity::Torque => (si, "N m".into()),
            Quantity::Force => (si, "N".into()),
            Quantity::Current => (si, "A".into()),
            Quantity::Voltage => (si, "V".into()),
            Quantity::Share => (si, "duty".into()),
            Quantity::Angle => (si, "rad".into()),
            Quantity::Length => (si, "m".into()),
            Quantity::AngularVelocity => (si, "rad/s".into()),
            Quantity::Speed => (si, "m/s".into()),
            Quantity::Count | Quantity::Other => (1.0, text.to_owned()),
            Quantity::Time => {
                return Err(ImportError::Unit {
                    unit: text.to_owned(),
                    role: "input",
                    examples: "Nm, mNm, A, mA, V, duty, %",
                });
            }
        })
    }

    /// The position as numbers in the logged unit.
    pub fn readings(&self) -> Result<Vec<f64>, ImportError> {
        let mut readings = self.position.values(self.log)?;
        if let Some(bit) = self.recipe.position_sign_bit {
            counter::sign_magnitude(&mut readings, bit);
        }
        Ok(readings)
    }

    /// Undoes wrap-around. Returns a description of what was done.
    pub fn wrapped(&self, readings: &mut [f64], counts: Option<f64>) -> String {
        if self.is_velocity {
            return String::new();
        }
        let span = match self.recipe.wrap {
            Some(0.0) => return String::new(),
            Some(span) => Some(span),
            None => {
                let logged = self.position.unit().and_then(unit::parse);
                let spans: Vec<f64> = match (counts, logged) {
                    (Some(counts), _) => std::iter::once(counts).chain(COUNTER_SPANS).collect(),
                    (None, Some((Quantity::Angle, si))) => vec![TAU / si],
                    (None, Some(_)) => return String::new(),
                    (None, None) => ANGLE_SPANS[..2].to_vec(),
                };
                counter::wraps(readings, &spans)
            }
        };
        let Some(span) = span else {
            return String::new();
        };
        match counter::unwrap(readings, span) {
            0 => String::new(),
            times => format!(
                ", {times} wraps around {} undone",
                sensor::three_digits(span)
            ),
        }
    }
}

/// Unit of the position.
pub(crate) struct Reading {
    /// One logged unit in units of the recording.
    pub si: f64,
    /// The unit in the recording.
    pub unit: &'static str,
    pub logged: Option<String>,
    /// Counts per turn.
    pub counts: Option<f64>,
}

impl Reading {
    pub fn said(&self, source: &Source, wraps: &str) -> String {
        let name = source.position.name();
        let from = match (&self.logged, source.is_velocity) {
            (None, false) => format!("`{name}`, taken as {}", self.unit),
            (None, true) => format!("the integral of `{name}`, taken as {}/s", self.unit),
            (Some(logged), false) if logged == self.unit => format!("`{name}` in {}", self.unit),
            (Some(logged), false) => format!("`{name}` from {logged} to {}", self.unit),
            (Some(logged), true) => {
                format!("the integral of `{name}` in {logged}, in {}", self.unit)
            }
        };
        let low_pass = match source.recipe.undo_low_pass_hz {
            Some(cutoff_hz) => format!(", low-pass of {cutoff_hz} Hz undone"),
            None => String::new(),
        };
        format!("{from}{wraps}{low_pass}")
    }
}

/// The unit of an input without a stated unit, guessed from its name.
fn unit_of_name(choice: &Choice) -> &'static str {
    let name = choice.name().to_lowercase();
    let tells = [
        ("torque", "N m"),
        ("tau", "N m"),
        ("effort", "N m"),
        ("current", "A"),
        ("voltage", "V"),
        ("volt", "V"),
        ("duty", "duty"),
        ("pwm", "pwm"),
        ("force", "N"),
    ];
    let told = tells
        .iter()
        .find(|(word, _)| name.contains(word))
        .map(|(_, unit)| *unit);
    // A column named `input`, as in the recording format, is in N m by default.
    told.unwrap_or(if name == "input" { "N m" } else { "1" })
}

pub(crate) fn shown(unit: &str) -> &str {
    match unit {
        "1" => "units of its own",
        unit => unit,
    }
}

fn is_further(name: &str) -> bool {
    matches!(name, "current" | "supply" | "temperature")
        || name
            .strip_prefix("position_")
            .is_some_and(|rest| !rest.is_empty())
}
