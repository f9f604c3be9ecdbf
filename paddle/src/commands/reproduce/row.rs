//! A number of the report and the simulated number.

use serde_json::{Value, json};
use std::fmt::Write;

/// One row of the table. A time that is never reached is infinite.
#[derive(Clone, Debug)]
pub struct Row {
    /// Name of the experiment and of the quantity.
    pub name: String,
    /// Number in the report, if the report states it.
    pub report: Option<f64>,
    /// Simulated number.
    pub ours: f64,
    /// Unit of both numbers.
    pub unit: &'static str,
    /// Limits of the simulated number, if there are any.
    pub bar: Option<[f64; 2]>,
    /// Remark for the reader.
    pub remark: Option<&'static str>,
}

impl Row {
    /// Creates a row without a bar.
    pub fn new(
        name: impl Into<String>,
        report: Option<f64>,
        ours: f64,
        unit: &'static str,
    ) -> Self {
        Self {
            name: name.into(),
            report,
            ours,
            unit,
            bar: None,
            remark: None,
        }
    }

    /// Sets the bar to `centre` ± `half`.
    pub fn within(self, half: f64, centre: f64) -> Self {
        self.between([centre - half, centre + half])
    }

    /// Sets the bar to this relative deviation from `centre`. If `centre` is infinite, the simulated time must be infinite
    /// too.
    pub fn within_share(self, share: f64, centre: f64) -> Self {
        let half = if centre.is_finite() {
            (share * centre).abs()
        } else {
            0.0
        };
        self.within(half, centre)
    }

    /// Sets the bar to these limits, both included.
    pub fn between(mut self, bar: [f64; 2]) -> Self {
        self.bar = Some(bar);
        self
    }

    /// Adds a remark.
    pub fn remarked(mut self, remark: &'static str) -> Self {
        self.remark = Some(remark);
        self
    }

    /// Whether the simulated number is within the bar. Returns `None` without a bar.
    pub fn ok(&self) -> Option<bool> {
        self.bar
            .map(|[low, high]| (low..=high).contains(&self.ours))
    }

    /// The row as a JSON object. An infinite number is written as "∞".
    pub fn json(&self) -> Value {
        json!({
            "name": self.name,
            "report": self.report.map(number),
            "ours": number(self.ours),
            "unit": self.unit,
            "bar": self.bar.map(|bar| bar.map(number)),
            "ok": self.ok(),
            "remark": self.remark,
        })
    }
}

fn number(value: f64) -> Value {
    match value.is_finite() {
        true => json!(value),
        false => json!("∞"),
    }
}

/// The table as text, with the differences and verdicts, and the remarks below.
pub fn table(rows: &[Row]) -> String {
    let longest = rows.iter().map(|row| row.name.chars().count()).max();
    let width = longest.unwrap_or(0);
    let mut text = format!(
        "{:<width$}  {:>9} {:>9} {:>9}  {:<6} {:>17}\n",
        "", "report", "ours", "differ", "", "bar"
    );
    let mut remarks: Vec<&str> = Vec::new();
    for row in rows {
        let mark = row.remark.map_or(String::new(), |remark| {
            let place = remarks.iter().position(|other| *other == remark);
            let place = place.unwrap_or_else(|| {
                remarks.push(remark);
                remarks.len() - 1
            });
            format!(" [{}]", place + 1)
        });
        let report = row.report.map_or(String::new(), shown);
        let differ = match row.report.map(|report| row.ours - report) {
            Some(difference) if difference.is_finite() => shown(difference),
            _ => String::new(),
        };
        let bar = match row.bar {
            Some([low, high]) if low == high => shown(low),
            Some([low, high]) => format!("{} to {}", shown(low), shown(high)),
            None => String::new(),
        };
        let verdict = match row.ok() {
            Some(true) => "  ok",
            Some(false) => "  MISSED",
            None => "",
        };
        let line = format!(
            "{:<width$}  {report:>9} {:>9} {differ:>9}  {:<6} {bar:>17}{verdict}{mark}",
            row.name,
            shown(row.ours),
            row.unit
        );
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{}", line.trim_end());
    }
    for (place, remark) in remarks.iter().enumerate() {
        let _ = writeln!(text, "[{}] {remark}", place + 1);
    }
    text
}

/// Formats a number with four digits, or as an infinity sign.
fn shown(value: f64) -> String {
    if !value.is_finite() {
        return "∞".into();
    }
    // A number that rounds to zero has no sign.
    let decimals = match value.abs() {
        size if size >= 1000.0 => 0,
        size if size >= 100.0 => 1,
        size if size >= 1.0 => 2,
        _ => 3,
    };
    let text = format!("{value:.decimals$}");
    match text
        .trim_start_matches('-')
        .chars()
        .all(|c| "0.".contains(c))
    {
        true => "0".into(),
        false => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_infinite_time_satisfies_only_an_infinite_bar() {
        let row = |ours| Row::new("settling", None, ours, "ms").within_share(0.1, f64::INFINITY);
        assert_eq!(row(f64::INFINITY).ok(), Some(true));
        assert_eq!(row(1e9).ok(), Some(false));
        let row = Row::new("settling", None, f64::INFINITY, "ms").within_share(0.1, 300.0);
        assert_eq!(row.ok(), Some(false));
        assert_eq!(row.json()["ours"], "∞");
    }

    #[test]
    fn a_row_without_a_bar_has_no_verdict() {
        let row = Row::new("overshoot", Some(0.82), 1.3, "°");
        assert_eq!((row.ok(), &row.json()["bar"]), (None, &Value::Null));
    }

    #[test]
    fn a_remark_is_printed_once_below_the_table() {
        let row = |ours| Row::new("a", Some(1.0), ours, "°").remarked("knife-edge");
        let text = table(&[row(1.0), row(2.0)]);
        assert_eq!(text.matches("[1]").count(), 3);
        assert_eq!(text.matches("knife-edge").count(), 1);
    }
}
