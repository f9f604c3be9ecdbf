//! A number of the report against ours.

use serde_json::{Value, json};
use std::fmt::Write;

/// One row. A time that is never reached is infinite.
#[derive(Clone, Debug)]
pub struct Row {
    /// Experiment and quantity.
    pub name: String,
    /// What the report says, if it does.
    pub report: Option<f64>,
    /// What comes out here.
    pub ours: f64,
    /// Unit of both.
    pub unit: &'static str,
    /// Between which ours must be, if there is a bar.
    pub bar: Option<[f64; 2]>,
    /// What a reader must know.
    pub remark: Option<&'static str>,
}

impl Row {
    /// A row without a bar.
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

    /// Ours must be within `half` of `centre`.
    pub fn within(self, half: f64, centre: f64) -> Self {
        self.between([centre - half, centre + half])
    }

    /// Ours must be within this share of `centre`; never reached if that is infinite.
    pub fn within_share(self, share: f64, centre: f64) -> Self {
        let half = if centre.is_finite() {
            (share * centre).abs()
        } else {
            0.0
        };
        self.within(half, centre)
    }

    /// Ours must be between these, both included.
    pub fn between(mut self, bar: [f64; 2]) -> Self {
        self.bar = Some(bar);
        self
    }

    /// With a remark.
    pub fn remarked(mut self, remark: &'static str) -> Self {
        self.remark = Some(remark);
        self
    }

    /// Whether ours clears the bar; `None` without one.
    pub fn ok(&self) -> Option<bool> {
        self.bar
            .map(|[low, high]| (low..=high).contains(&self.ours))
    }

    /// As an object; what is never reached is "∞".
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

/// The rows for people, with the difference and the verdict, and the remarks below.
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

/// Four digits, or the sign of what is never reached.
fn shown(value: f64) -> String {
    if !value.is_finite() {
        return "∞".into();
    }
    // Rounded away, a zero has no sign.
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
    fn never_is_met_by_never_alone() {
        let row = |ours| Row::new("settling", None, ours, "ms").within_share(0.1, f64::INFINITY);
        assert_eq!(row(f64::INFINITY).ok(), Some(true));
        assert_eq!(row(1e9).ok(), Some(false));
        let row = Row::new("settling", None, f64::INFINITY, "ms").within_share(0.1, 300.0);
        assert_eq!(row.ok(), Some(false));
        assert_eq!(row.json()["ours"], "∞");
    }

    #[test]
    fn a_row_without_a_bar_cannot_miss_it() {
        let row = Row::new("overshoot", Some(0.82), 1.3, "°");
        assert_eq!((row.ok(), &row.json()["bar"]), (None, &Value::Null));
    }

    #[test]
    fn a_remark_stands_once_below_the_table() {
        let row = |ours| Row::new("a", Some(1.0), ours, "°").remarked("knife-edge");
        let text = table(&[row(1.0), row(2.0)]);
        assert_eq!(text.matches("[1]").count(), 3);
        assert_eq!(text.matches("knife-edge").count(), 1);
    }
}
