//! Scatter charts: points over an axis, a line of the values that are explained, and a second panel with the remainder.

use super::axis::{Axis, Scale};
use super::ink::Ink;
use super::sheet::{self, AXIS, Area, Failure, GRID, LARGE, PlotError, SMALL, UNIT, WIDTH, Words};
use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

/// Points of one kind.
#[derive(Clone, Debug, Default)]
pub struct Cloud {
    /// Label in the legend.
    pub label: String,
    /// Abscissa and ordinate of the points.
    pub points: Vec<(f64, f64)>,
    /// Explained values, as a line.
    pub explained: Vec<(f64, f64)>,
    /// Remainder of the points after the explained values are subtracted. It is empty if there is no second panel.
    pub rest: Vec<(f64, f64)>,
}

/// Groups of points over one axis, and their remainders on the same scale.
#[derive(Clone, Debug, Default)]
pub struct Scatter {
    /// Title in one line.
    pub title: String,
    /// Quantity and unit of the abscissa.
    pub x_label: String,
    /// Quantity and unit of the ordinate.
    pub y_label: String,
    /// Label of the lines in the legend. It is empty if there are no lines and no second panel.
    pub explained_by: String,
    /// Groups of points. The colours distinguish at most two groups.
    pub clouds: Vec<Cloud>,
}

// All lengths are in pixels.
const LEFT: i32 = 58;
const RIGHT: i32 = 12;
const TITLE: i32 = 28;
const LEGEND: i32 = 22;
const Y_LABEL: i32 = 20;
const HEIGHT: i32 = 300;
const X_TICKS: i32 = 18;
const X_LABEL: i32 = 24;
const DOT: f64 = 1.5;
/// Width of the panel with the points, if there is a second panel.
const MAIN: i32 = 440;
/// Largest number of drawn points per group. More points would hide each other.
const MOST_DOTS: usize = 240;
/// Share of the lowest and of the highest ordinates that may lie outside the chart.
const RAREST: f64 = 0.002;

impl Scatter {
    /// The chart as SVG text.
    ///
    /// # Errors
    /// Returns [`PlotError`] if the drawing library reports an error.
    pub fn svg(&self) -> Result<String, PlotError> {
        let points = || self.clouds.iter().flat_map(|cloud| &cloud.points);
        let x = points().map(|point| point.0);
        let y = inner(points().map(|point| point.1).collect()).into_iter();
        let is_explained = !self.explained_by.is_empty();
        let has_rest = is_explained && self.clouds.iter().any(|cloud| !cloud.rest.is_empty());
        let main = if has_rest { MAIN } else { WIDTH };
        let panel = HEIGHT / 34;
        let axes = [
            Axis::tight(x.clone(), Scale::Linear, 7),
            Axis::roomy(y, Scale::Linear, panel as usize),
        ];
        let beside = Axis::tight(x, Scale::Linear, 4);
        let top = TITLE + LEGEND;
        let said = self.clouds.iter().map(|cloud| cloud.label.as_str());
        let words = Words {
            title: self.title.clone(),
            description: format!(
                "Points over {}: {}, {}.",
                self.x_label,
                self.y_label,
                said.collect::<Vec<_>>().join(" and ")
            ),
        };
        sheet::draw(top + Y_LABEL + HEIGHT + X_TICKS + X_LABEL, &words, |area| {
            let at = (LEFT, TITLE / 2 + 2);
            sheet::write(area, &self.title, at, HPos::Left, sheet::font(LARGE))?;
            self.legend(area)?;
            let (_, below) = area.split_vertically(top * UNIT);
            let (left, right) = below.split_horizontally(main * UNIT);
            let [x, y] = &axes;
            self.panel(&left, x, y, &self.y_label, false)?;
            if has_rest {
                self.panel(&right, &beside, y, "what is left", true)?;
            }
            let at = (
                LEFT + (main - LEFT) / 2,
                top + Y_LABEL + HEIGHT + X_TICKS + X_LABEL / 2,
            );
            sheet::write(area, &self.x_label, at, HPos::Center, sheet::font(SMALL))
        })
    }

    fn panel(
        &self,
        area: &Area<'_>,
        x: &Axis,
        y: &Axis,
        label: &str,
        rest: bool,
    ) -> Result<(), Failure> {
        let (height, _) = area.split_vertically((Y_LABEL + HEIGHT + X_TICKS) * UNIT);
        let at = (LEFT, Y_LABEL / 2);
        sheet::write(&height, label, at, HPos::Left, sheet::font(SMALL))?;
        let mut chart = ChartBuilder::on(&height)
            .margin_top(Y_LABEL * UNIT)
            .margin_right(RIGHT * UNIT)
            .y_label_area_size(LEFT * UNIT)
            .x_label_area_size(X_TICKS * UNIT)
            .build_cartesian_2d(x.clone(), y.clone())?;
        chart
            .configure_mesh()
            .bold_line_style(GRID.stroke_width(UNIT as u32))
            .light_line_style(TRANSPARENT)
            .axis_style(AXIS.stroke_width(UNIT as u32))
            .set_all_tick_mark_size(3 * UNIT)
            .x_label_style(sheet::font(SMALL))
            .y_label_style(sheet::font(SMALL))
            .x_label_formatter(&|tick| x.label(*tick))
            .y_label_formatter(&|tick| y.label(*tick))
            .draw()?;
        let size = (DOT * f64::from(UNIT)) as i32;
        let inside = |point: &&(f64, f64)| x.range.contains(&point.0) && y.range.contains(&point.1);
        for (place, cloud) in self.clouds.iter().enumerate() {
            let points = if rest { &cloud.rest } else { &cloud.points };
            let color = ink(place).color().mix(0.45).filled();
            let dots = some(points).filter(inside);
            chart.draw_series(dots.map(|&at| Circle::new(at, size, color)))?;
        }
        if rest {
            let zero = [(x.range.start, 0.0), (x.range.end, 0.0)];
            chart.draw_series(LineSeries::new(zero, AXIS.stroke_width(UNIT as u32)))?;
            return Ok(());
        }
        for cloud in &self.clouds {
            let line = cloud.explained.iter().filter(inside).copied();
            let style = Ink::Measured.color().stroke_width(2 * UNIT as u32);
            chart.draw_series(LineSeries::new(line, style))?;
        }
        Ok(())
    }

    fn legend(&self, area: &Area<'_>) -> Result<(), Failure> {
        let y = TITLE + LEGEND / 2;
        let mut left = LEFT;
        for (place, cloud) in self.clouds.iter().enumerate() {
            let color = ink(place).color().filled();
            let dot = Circle::new(((left + 4) * UNIT, y * UNIT), 3 * UNIT, color);
            area.draw(&dot)?;
            let at = (left + 12, y);
            sheet::write(area, &cloud.label, at, HPos::Left, sheet::font(SMALL))?;
            left += 30 + sheet::width_of(&cloud.label, SMALL);
        }
        if !self.explained_by.is_empty() {
            let ends = [left, left + 18].map(|x| (x * UNIT, y * UNIT));
            let style = Ink::Measured.color().stroke_width(2 * UNIT as u32);
            area.draw(&PathElement::new(ends, style))?;
            let at = (left + 24, y);
            sheet::write(area, &self.explained_by, at, HPos::Left, sheet::font(SMALL))?;
        }
        Ok(())
    }
}

fn ink(place: usize) -> Ink {
    [Ink::Model, Ink::Other(0)][place % 2]
}

/// At most so many points, taken at even intervals.
fn some<T>(points: &[T]) -> impl Iterator<Item = &T> {
    points
        .iter()
        .step_by(points.len().div_ceil(MOST_DOTS).max(1))
}

/// The values without the rarest values at both ends.
fn inner(mut values: Vec<f64>) -> Vec<f64> {
    values.retain(|value| value.is_finite());
    values.sort_by(f64::total_cmp);
    let rare = (RAREST * values.len() as f64) as usize;
    values[rare..values.len() - rare].to_vec()
}
