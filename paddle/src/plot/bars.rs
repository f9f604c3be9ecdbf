//! Horizontal bar charts with printed values.

use super::axis;
use super::ink::Ink;
use super::sheet::{self, LARGE, PlotError, SMALL, UNIT, WIDTH, Words};
use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

/// One bar.
#[derive(Clone, Debug)]
pub struct Bar {
    /// Label to the left of the bar.
    pub label: String,
    /// Length of the bar, 0 or more.
    pub value: f64,
    /// Meaning of the bar, which sets its colour.
    pub ink: Ink,
}

/// A bar chart. All bars start at zero.
#[derive(Clone, Debug)]
pub struct Bars {
    /// Title in one line, which names the quantity.
    pub title: String,
    /// Unit of the values.
    pub unit: String,
    /// Bars from top to bottom.
    pub bars: Vec<Bar>,
}

// All lengths are in pixels.
const TOP: i32 = 34;
const ROW: i32 = 24;
const THICKNESS: i32 = 14;
const GAP: i32 = 8;
const BOTTOM: i32 = 10;

impl Bars {
    /// The chart as SVG text.
    ///
    /// # Errors
    /// Returns [`PlotError`] if the drawing library reports an error.
    pub fn svg(&self) -> Result<String, PlotError> {
        let longest = |texts: &mut dyn Iterator<Item = String>| {
            texts
                .map(|text| sheet::width_of(&text, SMALL))
                .max()
                .unwrap_or(0)
        };
        let value = |bar: &Bar| format!("{} {}", axis::rounded(bar.value), self.unit);
        let left = GAP + longest(&mut self.bars.iter().map(|bar| bar.label.clone())) + GAP;
        let right = GAP + longest(&mut self.bars.iter().map(value)) + GAP;
        let greatest = self.bars.iter().map(|bar| bar.value).fold(0.0, f64::max);
        let per_unit = match greatest > 0.0 {
            true => f64::from((WIDTH - left - right) * UNIT) / greatest,
            false => 0.0,
        };
        let height = TOP + ROW * self.bars.len() as i32 + BOTTOM;
        let said = self
            .bars
            .iter()
            .map(|b| format!("{} {}", b.label, value(b)));
        let words = Words {
            title: self.title.clone(),
            description: format!("Bars: {}.", said.collect::<Vec<_>>().join("; ")),
        };
        sheet::draw(height, &words, |area| {
            let at = (GAP, TOP / 2);
            sheet::write(area, &self.title, at, HPos::Left, sheet::font(LARGE))?;
            for (place, bar) in (0..).zip(&self.bars) {
                let y = TOP + place * ROW + ROW / 2;
                let length = (bar.value.max(0.0) * per_unit) as i32;
                let corners = [
                    (left * UNIT, (y - THICKNESS / 2) * UNIT),
                    (left * UNIT + length, (y + THICKNESS / 2) * UNIT),
                ];
                area.draw(&Rectangle::new(corners, bar.ink.color().filled()))?;
                let at = (left - GAP, y);
                sheet::write(area, &bar.label, at, HPos::Right, sheet::font(SMALL))?;
                let at = (left + length / UNIT + GAP, y);
                sheet::write(area, &value(bar), at, HPos::Left, sheet::font(SMALL))?;
            }
            Ok(())
        })
    }
}
