//! Guesses the roles of columns from their names and from whether their values change.

use crate::clock;
use crate::log::{Cells, Column, Log};
use crate::unit::{self, Quantity};

/// Words in column names with their scores.
type Words = &'static [(&'static str, i32)];

const TIME: Words = &[
    ("timestamp", 10),
    ("time", 10),
    ("stamp", 8),
    ("zeit", 8),
    ("temps", 8),
    ("date", 6),
    ("elapsed", 8),
    ("millis", 8),
    ("micros", 8),
    ("seconds", 8),
    ("sec", 6),
    ("t", 7),
    ("clock", 4),
    ("timestep", -9),
    ("period", -9),
    ("rise", -9),
    ("dt", -9),
];
const POSITION: Words = &[
    ("position", 10),
    ("pos", 9),
    ("angle", 9),
    ("theta", 9),
    ("winkel", 9),
    ("phi", 7),
    ("encoder", 6),
    ("enc", 6),
    ("q", 7),
    ("x", 4),
    ("state", 5),
    ("measured", 3),
    ("actual", 3),
    ("present", 3),
    ("joint", 2),
    ("filt", 1),
    ("y", 3),
    ("pot", 4),
];
const INPUT: Words = &[
    ("input", 10),
    ("torque", 9),
    ("tau", 9),
    ("effort", 8),
    ("moment", 6),
    ("u", 7),
    ("current", 7),
    ("voltage", 6),
    ("volt", 5),
    ("pwm", 7),
    ("duty", 7),
    ("command", 6),
    ("cmd", 6),
    ("force", 6),
    ("action", 5),
    ("iq", 7),
    ("drive", 4),
    ("load", 3),
    ("strom", 6),
    ("motor", 2),
    ("hall", -9),
    ("supply", -9),
    ("bus", -4),
    ("battery", -9),
    ("temperature", -9),
    ("temp", -9),
];
const SETPOINT: Words = &[
    ("setpoint", 10),
    ("sp", 8),
    ("target", 9),
    ("goal", 9),
    ("desired", 9),
    ("des", 7),
    ("ref", 8),
    ("reference", 9),
    ("soll", 8),
];
const VELOCITY: Words = &[
    ("velocity", 10),
    ("vel", 9),
    ("speed", 9),
    ("omega", 8),
    ("qd", 8),
    ("dq", 8),
    ("rpm", 7),
    ("rate", 4),
    ("acceleration", -9),
    ("accel", -9),
    ("acc", -9),
];

/// Splits a name into words at signs and at changes from lower to upper case. Trailing digits are removed.
fn words(name: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut before = ' ';
    for letter in name.chars() {
        let splits = !letter.is_alphanumeric() || (letter.is_uppercase() && before.is_lowercase());
        if splits {
            words.push(String::new());
        }
        if letter.is_alphabetic() {
            words
                .last_mut()
                .expect("there is one")
                .extend(letter.to_lowercase());
        }
        before = letter;
    }
    words.retain(|word| !word.is_empty());
    words
}

fn score(column: &Column, telling: Words) -> i32 {
    let words = words(column.bare());
    let known = |(word, worth): &(&str, i32)| words.iter().any(|w| w == word).then_some(*worth);
    telling.iter().filter_map(known).sum()
}

/// The quantity of a column according to its unit.
fn quantity(column: &Column) -> Option<Quantity> {
    let unit = column
        .unit
        .as_deref()
        .or_else(|| unit::of_name(column.bare()))?;
    unit::parse(unit).map(|(quantity, _)| quantity)
}

/// The column with the highest positive score, the first of several.
fn best(log: &Log, score: impl Fn(&Column) -> i32) -> Option<usize> {
    let scored = log
        .columns
        .iter()
        .enumerate()
        .map(|(at, column)| (score(column), at));
    let best = scored
        .filter(|(score, _)| *score > 0)
        .max_by_key(|(score, at)| (*score, std::cmp::Reverse(*at)));
    best.map(|(_, at)| at)
}

fn is_number(column: &Column) -> bool {
    !matches!(column.cells, Cells::Text(_))
}

/// The column of time.
pub(crate) fn time(log: &Log) -> Option<usize> {
    let rises = |column: &Column| match &column.cells {
        Cells::Text(cells) => cells
            .iter()
            .filter(|cell| !cell.is_empty())
            .take(3)
            .all(|cell| clock::is_stamp(cell)),
        Cells::Whole(cells) => mostly_rises(cells.iter().flatten()),
        Cells::Numbers(cells) => mostly_rises(cells.iter().filter(|cell| !cell.is_nan())),
    };
    best(log, |column| {
        let stated = i32::from(quantity(column) == Some(Quantity::Time)) * 5;
        let named = score(column, TIME) + stated;
        if column.is_live() && rises(column) {
            named.max(i32::from(!is_number(column)) * 5)
        } else {
            0
        }
    })
    .or_else(|| {
        // Without a known name, the first column is the time if it only increases.
        let first = log.columns.first()?;
        (is_number(first) && first.is_live() && rises(first)).then_some(0)
    })
}

fn mostly_rises<T: PartialOrd>(cells: impl Iterator<Item = T> + Clone) -> bool {
    let pairs = || cells.clone().zip(cells.clone().skip(1));
    let (all, rising) = (pairs().count(), pairs().filter(|(a, b)| b >= a).count());
    all > 0 && 20 * rising >= 19 * all
}

/// The column of position.
pub(crate) fn position(log: &Log, taken: &[usize]) -> Option<usize> {
    role(log, taken, |column| {
        let quantity = quantity(column);
        let fits = match quantity {
            Some(Quantity::Angle | Quantity::Length) => 4,
            Some(Quantity::Count) | None => 0,
            Some(_) => return 0,
        };
        if score(column, SETPOINT) > 0 || score(column, VELOCITY) != 0 {
            return 0;
        }
        let named = score(column, POSITION);
        if named > 0 || quantity == Some(Quantity::Angle) {
            named + fits
        } else {
            0
        }
    })
}

/// The column of the actuator's command.
pub(crate) fn input(log: &Log, taken: &[usize]) -> Option<usize> {
    role(log, taken, |column| {
        let fits = match quantity(column) {
            Some(Quantity::Torque | Quantity::Force) => 5,
            Some(Quantity::Current | Quantity::Voltage | Quantity::Share) => 3,
            Some(Quantity::Count) | None => 0,
            Some(_) => return 0,
        };
        // A measured current describes the motor better than a commanded one. A command, however, is the input.
        let named = score(column, INPUT);
        if named > 0 {
            named + fits + i32::from(score(column, SETPOINT) > 0)
        } else {
            0
        }
    })
}

/// The column of the setpoint.
pub(crate) fn setpoint(log: &Log, taken: &[usize]) -> Option<usize> {
    let asked = |column: &Column| {
        score(column, SETPOINT) > 0 && score(column, INPUT) <= 0 && score(column, VELOCITY) == 0
    };
    role(log, taken, |column| match quantity(column) {
        Some(Quantity::Angle | Quantity::Length | Quantity::Count) | None if asked(column) => {
            score(column, SETPOINT)
        }
        _ => 0,
    })
}

/// The column of velocity.
pub(crate) fn velocity(log: &Log, taken: &[usize]) -> Option<usize> {
    role(log, taken, |column| score(column, VELOCITY))
}

/// The best column of changing numbers without another role.
fn role(log: &Log, taken: &[usize], score: impl Fn(&Column) -> i32) -> Option<usize> {
    let at = |column: &Column| {
        log.columns
            .iter()
            .position(|other| std::ptr::eq(other, column))
    };
    best(log, |column| {
        let is_free = at(column).is_none_or(|at| !taken.contains(&at));
        if is_free && is_number(column) && column.is_live() {
            score(column)
        } else {
            0
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn log(names: &[&str]) -> Log {
        let column = |(at, name): (usize, &&str)| {
            Column::numbers(*name, vec![0.0, 1.0 + at as f64, 2.5 + at as f64])
        };
        Log {
            name: "a".into(),
            columns: names.iter().enumerate().map(column).collect(),
            notes: Vec::new(),
        }
    }

    #[test]
    fn roles_are_guessed_from_usual_names() {
        for (names, time_at, input_at, position_at) in [
            (&["timestamp [s]", "tau_cmd", "q"][..], 0, 1, 2),
            (
                &[
                    "__time",
                    "/joint_states.elbow.position",
                    "/joint_states.elbow.velocity",
                    "/joint_states.elbow.effort",
                ],
                0,
                3,
                1,
            ),
            (
                &[
                    "t_ms",
                    "present_position",
                    "goal_position",
                    "present_current",
                ],
                0,
                3,
                1,
            ),
            (
                &[
                    "Time",
                    "Motor Current (A)",
                    "Encoder Angle (deg)",
                    "Target Angle (deg)",
                ],
                0,
                1,
                2,
            ),
            (&["seconds", "pwm", "enc_counts"], 0, 1, 2),
        ] {
            let log = log(names);
            let t = time(&log).expect("time");
            let x = position(&log, &[t]).expect("position");
            let u = input(&log, &[t, x]).expect("input");
            assert_eq!((t, u, x), (time_at, input_at, position_at), "{names:?}");
        }
    }
}
