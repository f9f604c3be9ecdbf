//! Combines outcomes into one table: goal, measured value and number of cases.

use std::collections::BTreeMap;
use std::fmt::{self, Display};

use serde::Serialize;

use super::{Calibration, Outcome, messy, transfer};
use crate::truth::Kind;

/// The goal of a row.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Goal {
    /// The measured value should be this or more.
    AtLeast(f64),
    /// The measured value should be this or less.
    AtMost(f64),
    /// The row has no goal and is shown for information.
    None,
}

/// One line of the table.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// Name of the measured quantity.
    pub what: &'static str,
    /// The goal.
    pub goal: Goal,
    /// The measured value. `None` if no case provides it.
    pub measured: Option<f64>,
    /// Number of cases.
    pub cases: usize,
    /// Whether the value is shown as a percentage.
    percent: bool,
}

impl Row {
    /// Whether the goal is met. `None` if nothing was measured.
    pub fn met(&self) -> Option<bool> {
        self.measured.map(|measured| match self.goal {
            Goal::AtLeast(goal) => measured >= goal,
            Goal::AtMost(goal) => measured <= goal,
            Goal::None => true,
        })
    }

    /// A row with the share of `values` that are true.
    pub fn share(what: &'static str, goal: Goal, values: impl Iterator<Item = bool>) -> Self {
        let (mut cases, mut right) = (0, 0.0);
        for value in values {
            cases += 1;
            right += f64::from(u8::from(value));
        }
        Self {
            what,
            goal,
            measured: (cases > 0).then(|| right / cases as f64),
            cases,
            percent: true,
        }
    }

    /// A row with a share that should be `goal` or more.
    pub(super) fn at_least(
        what: &'static str,
        goal: f64,
        values: impl Iterator<Item = bool>,
    ) -> Self {
        Self::share(what, Goal::AtLeast(goal), values)
    }

    /// A row with a share that should be `goal` or less.
    pub(super) fn at_most(
        what: &'static str,
        goal: f64,
        values: impl Iterator<Item = bool>,
    ) -> Self {
        Self::share(what, Goal::AtMost(goal), values)
    }

    /// A row with a share, for information.
    pub(super) fn shown(what: &'static str, values: impl Iterator<Item = bool>) -> Self {
        Self::share(what, Goal::None, values)
    }

    /// A row with a mean, for information.
    pub(super) fn mean(what: &'static str, values: impl Iterator<Item = f64>) -> Self {
        let values: Vec<f64> = values.collect();
        Self {
            what,
            goal: Goal::None,
            measured: (!values.is_empty())
                .then(|| values.iter().sum::<f64>() / values.len() as f64),
            cases: values.len(),
            percent: false,
        }
    }

    /// A row with the quantile `at` of `values`.
    pub(super) fn quantile(what: &'static str, goal: Goal, values: Vec<f64>, at: f64) -> Self {
        Self {
            what,
            goal,
            cases: values.len(),
            measured: quantile(values, at),
            percent: false,
        }
    }
}

/// The summary of a set of cases.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// The rows of the table.
    pub rows: Vec<Row>,
    /// For every truth, how often each first answer was given.
    pub confusion: BTreeMap<String, BTreeMap<String, usize>>,
    /// Calibration of the confidences.
    pub calibration: Calibration,
    /// The outcome of every case.
    pub outcomes: Vec<Outcome>,
}

impl Summary {
    /// Summarises `outcomes`.
    pub fn of(outcomes: Vec<Outcome>) -> Self {
        let clean = outcomes.is_empty() || outcomes.iter().any(|o| o.kind != Kind::Messy);
        let mut rows = if clean {
            naming_rows(&outcomes)
        } else {
            Vec::new()
        };
        rows.extend(messy::rows(&outcomes));
        rows.extend(common_rows(&outcomes));
        rows.extend(transfer::rows(&outcomes));
        let mut confusion: BTreeMap<String, BTreeMap<String, usize>> = BTreeMap::new();
        for outcome in &outcomes {
            let answers = confusion.entry(label(outcome)).or_default();
            *answers.entry(outcome.answer.clone()).or_default() += 1;
        }
        Self {
            rows,
            confusion,
            calibration: Calibration::of(&outcomes),
            outcomes,
        }
    }
}

/// Rows on the names in clean cases.
fn naming_rows(outcomes: &[Outcome]) -> Vec<Row> {
    let of = |kind: Kind| outcomes.iter().filter(move |outcome| outcome.kind == kind);
    let singles: Vec<f64> = of(Kind::Single)
        .map(|outcome| outcome.names as f64)
        .collect();
    let mean = (!singles.is_empty()).then(|| singles.iter().sum::<f64>() / singles.len() as f64);
    vec![
        Row::at_least(
            "first name is the true one",
            0.95,
            of(Kind::Single).map(|o| o.first),
        ),
        Row::at_least(
            "true one named or not separable",
            0.99,
            of(Kind::Single).map(|o| o.in_class),
        ),
        Row {
            what: "names given on average",
            goal: Goal::AtMost(1.4),
            measured: mean,
            cases: singles.len(),
            percent: false,
        },
        Row::at_least(
            "nothing wrong: no_gap",
            0.98,
            of(Kind::Nothing).map(|o| o.right),
        ),
        Row::at_least(
            "outside the vocabulary: no confident wrong name",
            0.90,
            of(Kind::Outside).map(|o| o.right),
        ),
        Row::at_least(
            "two effects: both named",
            0.85,
            of(Kind::Pair).map(|o| o.all_named),
        ),
    ]
}

/// Rows on places, claimed shrink and computing time, for cases of any kind.
fn common_rows(outcomes: &[Outcome]) -> Vec<Row> {
    let claims: Vec<f64> = outcomes
        .iter()
        .filter_map(|o| o.claim_error.map(f64::abs))
        .collect();
    vec![
        Row::at_least("where", 0.95, outcomes.iter().filter_map(|o| o.place)),
        Row::quantile(
            "|claimed - fresh shrink|, median",
            Goal::AtMost(0.03),
            claims.clone(),
            0.5,
        ),
        Row::quantile(
            "|claimed - fresh shrink|, 95th percentile",
            Goal::AtMost(0.15),
            claims,
            0.95,
        ),
        Row::quantile(
            "shrink over that of the truth, median",
            Goal::AtLeast(0.95),
            outcomes.iter().filter_map(|o| o.relative_shrink).collect(),
            0.5,
        ),
        Row::quantile(
            "time of a diagnosis, 95th percentile, s",
            Goal::AtMost(3.0),
            outcomes.iter().filter_map(|o| o.elapsed_s).collect(),
            0.95,
        ),
    ]
}

fn label(outcome: &Outcome) -> String {
    let names = outcome.truth.join(" + ");
    match outcome.kind {
        Kind::Messy => {
            let dominant = outcome.truth.first().map_or("", String::as_str);
            let outside = if outcome.nameable { "" } else { "outside: " };
            format!("{outside}{dominant}")
        }
        Kind::Single | Kind::Pair => names,
        Kind::Nothing => "nothing".into(),
        Kind::Outside => format!("outside: {names}"),
    }
}

/// The quantile `at` of `values`.
fn quantile(mut values: Vec<f64>, at: f64) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let rank = (values.len().checked_sub(1)? as f64 * at).round() as usize;
    values.get(rank).copied()
}

impl Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let mark = if self.right { "right" } else { "WRONG" };
        write!(
            f,
            "{:4} {mark} {:48} -> {:28}",
            self.case,
            label(self),
            self.answer
        )?;
        if let Some((confidence, _)) = self.confidences.first() {
            write!(f, " {confidence:4.2}")?;
        }
        for name in &self.not_there {
            write!(f, " not there: {name}")?;
        }
        if self.place == Some(false) {
            write!(f, " elsewhere")?;
        }
        if let Some(error) = self.claim_error {
            write!(f, " claim {error:+.2}")?;
        }
        let over_claimed = self.transfer.and_then(|kept| kept.over_claimed);
        if let Some(over_claimed) = over_claimed {
            write!(f, " transfer {over_claimed:.2}")?;
        }
        if let Some(elapsed_s) = self.elapsed_s {
            write!(f, " {elapsed_s:.1} s")?;
        }
        Ok(())
    }
}

impl Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        writeln!(
            f,
            "{:50} {:>8} {:>9} {:>6}",
            "", "goal", "measured", "cases"
        )?;
        for row in &self.rows {
            let show = |value: f64| {
                if row.percent {
                    format!("{:.0} %", 100.0 * value)
                } else {
                    format!("{value:.3}")
                }
            };
            let goal = match row.goal {
                Goal::AtLeast(goal) => format!(">= {}", show(goal)),
                Goal::AtMost(goal) => format!("<= {}", show(goal)),
                Goal::None => String::new(),
            };
            let measured = row.measured.map_or("-".into(), show);
            let missed = if row.met() == Some(false) {
                "  missed"
            } else {
                ""
            };
            writeln!(
                f,
                "{:50} {goal:>8} {measured:>9} {:>6}{missed}",
                row.what, row.cases
            )?;
        }
        writeln!(f, "\nconfidence       given  right")?;
        for bin in &self.calibration.bins {
            writeln!(
                f,
                "{:.2} to {:.2} {:10} {:6}",
                bin.from, bin.to, bin.given, bin.right
            )?;
        }
        let confident = &self.calibration.confident;
        writeln!(
            f,
            "of {} names given with 0.9 or more, {} are right",
            confident.given, confident.right
        )?;
        writeln!(f, "\ntruth: answers")?;
        for (truth, answers) in &self.confusion {
            let answers: Vec<_> = answers
                .iter()
                .map(|(answer, count)| format!("{answer} {count}"))
                .collect();
            writeln!(f, "{truth}: {}", answers.join(", "))?;
        }
        Ok(())
    }
}
