//! Many outcomes as one table: each goal, what was measured, on how many cases.

use std::collections::BTreeMap;
use std::fmt::{self, Display};

use serde::Serialize;

use super::{Calibration, Outcome};
use crate::truth::Kind;

/// What is aimed at.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Goal {
    /// This or more.
    AtLeast(f64),
    /// This or less.
    AtMost(f64),
}

/// One line of the table.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// What is measured.
    pub what: &'static str,
    /// What is aimed at.
    pub goal: Goal,
    /// What was measured; `None` if no case says anything about it.
    pub measured: Option<f64>,
    /// On how many cases.
    pub cases: usize,
    /// Whether it is shown as a percentage.
    #[serde(skip)]
    percent: bool,
}

impl Row {
    /// Whether the goal is met; `None` if nothing was measured.
    pub fn met(&self) -> Option<bool> {
        self.measured.map(|measured| match self.goal {
            Goal::AtLeast(goal) => measured >= goal,
            Goal::AtMost(goal) => measured <= goal,
        })
    }
}

/// Everything that a set of cases says.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// The goals.
    pub rows: Vec<Row>,
    /// Of every truth, how often each answer came first.
    pub confusion: BTreeMap<String, BTreeMap<String, usize>>,
    /// What confidences are worth.
    pub calibration: Calibration,
    /// Every case.
    pub outcomes: Vec<Outcome>,
}

impl Summary {
    /// The table of `outcomes`.
    pub fn of(outcomes: Vec<Outcome>) -> Self {
        let of = |kind: Kind| outcomes.iter().filter(move |outcome| outcome.kind == kind);
        let share = |what, goal, values: Vec<bool>| {
            let right = values.iter().filter(|value| **value).count() as f64;
            let measured = (!values.is_empty()).then(|| right / values.len() as f64);
            Row {
                what,
                goal: Goal::AtLeast(goal),
                measured,
                cases: values.len(),
                percent: true,
            }
        };
        let part = |what, goal, values: Vec<f64>, at: f64| {
            let cases = values.len();
            Row {
                what,
                goal,
                measured: quantile(values, at),
                cases,
                percent: false,
            }
        };
        let singles: Vec<f64> = of(Kind::Single)
            .map(|outcome| outcome.names as f64)
            .collect();
        let mean =
            (!singles.is_empty()).then(|| singles.iter().sum::<f64>() / singles.len() as f64);
        let claims: Vec<f64> = outcomes
            .iter()
            .filter_map(|o| o.claim_error.map(f64::abs))
            .collect();
        let rows = vec![
            share(
                "first name is the true one",
                0.95,
                of(Kind::Single).map(|o| o.first).collect(),
            ),
            share(
                "true one named or not separable",
                0.99,
                of(Kind::Single).map(|o| o.in_class).collect(),
            ),
            Row {
                what: "names given on average",
                goal: Goal::AtMost(1.4),
                measured: mean,
                cases: singles.len(),
                percent: false,
            },
            share(
                "nothing wrong: no_gap",
                0.98,
                of(Kind::Nothing).map(|o| o.right).collect(),
            ),
            share(
                "outside the vocabulary: no confident wrong name",
                0.90,
                of(Kind::Outside).map(|o| o.right).collect(),
            ),
            share(
                "two effects: both named",
                0.85,
                of(Kind::Pair).map(|o| o.all_named).collect(),
            ),
            share(
                "where",
                0.95,
                outcomes.iter().filter_map(|o| o.place).collect(),
            ),
            part(
                "|claimed - fresh shrink|, median",
                Goal::AtMost(0.03),
                claims.clone(),
                0.5,
            ),
            part(
                "|claimed - fresh shrink|, 95th percentile",
                Goal::AtMost(0.15),
                claims,
                0.95,
            ),
            part(
                "shrink over that of the truth, median",
                Goal::AtLeast(0.95),
                outcomes.iter().filter_map(|o| o.relative_shrink).collect(),
                0.5,
            ),
            part(
                "time of a diagnosis, 95th percentile, s",
                Goal::AtMost(3.0),
                outcomes.iter().filter_map(|o| o.elapsed_s).collect(),
                0.95,
            ),
        ];
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

fn label(outcome: &Outcome) -> String {
    let names = outcome.truth.join(" + ");
    match outcome.kind {
        Kind::Single | Kind::Pair => names,
        Kind::Nothing => "nothing".into(),
        Kind::Outside => format!("outside: {names}"),
    }
}

/// The value below which the share `at` of `values` lies.
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
        if self.place == Some(false) {
            write!(f, " elsewhere")?;
        }
        if let Some(error) = self.claim_error {
            write!(f, " claim {error:+.2}")?;
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
