//! Line charts over a common abscissa, with one panel or several.

use super::axis::{self, Axis, Scale};
use super::ink::Ink;
use super::sheet::{
    self, AXIS, Area, Failure, GRID, LARGE, PlotError, SMALL, TEXT, UNIT, WIDTH, Words,
};
use super::thin;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// One line.
#[derive(Clone, Debug)]
pub struct Line {
    /// Label in the legend.
    pub label: String,
    /// Meaning of the line, which sets its colour.
    pub ink: Ink,
    /// Abscissa and ordinate. The abscissas are in ascending order. An ordinate that is NaN interrupts the line.
    pub points: Vec<(f64, f64)>,
}

impl Line {
    /// Creates a line of `y` over `x`.
    pub fn new(label: impl Into<String>, ink: Ink, x: &[f64], y: &[f64]) -> Self {
        Self {
            label: label.into(),
            ink,
            points: x.iter().copied().zip(y.iter().copied()).collect(),
        }
    }
}

/// A shaded range along an axis.
#[derive(Clone, Copy, Debug)]
pub struct Band {
    /// Lower end.
    pub from: f64,
    /// Upper end.
    pub to: f64,
}

/// A labelled time or peak.
#[derive(Clone, Debug)]
pub enum Mark {
    /// A vertical line.
    At {
        /// Abscissa of the line.
        x: f64,
        /// Label of the line.
        label: String,
    },
    /// A small circle.
    Peak {
        /// Abscissa and ordinate of the peak.
        at: (f64, f64),
        /// Label of the peak.
        label: String,
    },
}

/// One pair of axes.
#[derive(Clone, Debug, Default)]
pub struct Panel {
    /// Quantity and unit of the ordinate.
    pub y_label: String,
    /// Layout of the ordinate.
    pub y_scale: Scale,
    /// Lines in drawing order; the last is on top.
    pub lines: Vec<Line>,
    /// Shaded range of ordinates, if any.
    pub band: Option<Band>,
    /// Shaded ranges of abscissas.
    pub regions: Vec<Band>,
    /// Labelled times and peaks.
    pub marks: Vec<Mark>,
}

/// A chart of one or more panels, arranged vertically.
#[derive(Clone, Debug, Default)]
pub struct Figure {
    /// Title in one line.
    pub title: String,
    /// Quantity and unit of the abscissa.
    pub x_label: String,
    /// Layout of the abscissa.
    pub x_scale: Scale,
    /// Positions and labels of the ticks. If the list is empty, ticks are at round values.
    pub x_ticks: Vec<(f64, String)>,
    /// Panels from top to bottom; the first is the tallest.
    pub panels: Vec<Panel>,
}

// All lengths are in pixels.
const LEFT: i32 = 58;
const RIGHT: i32 = 14;
const TITLE: i32 = 30;
const Y_LABEL: i32 = 24;
const PANEL: [i32; 2] = [230, 110];
const X_TICKS: i32 = 18;
const X_LABEL: i32 = 26;
const SWATCH: i32 = 18;
const LEGEND_ROW: i32 = 18;
const MARK_ROW: i32 = 16;
const COLUMN: i32 = 1;

impl Panel {
    fn height(place: usize) -> i32 {
        Y_LABEL + PANEL[place.min(1)] + X_TICKS
    }

    fn ordinates(&self) -> impl Iterator<Item = f64> {
        let band = self.band.iter().flat_map(|band| [band.from, band.to]);
        self.lines
            .iter()
            .flat_map(|line| line.points.iter().map(|p| p.1))
            .chain(band)
    }

    fn draw(&self, area: &Area<'_>, x: &Axis, legend: i32, height: i32) -> Result<(), Failure> {
        sheet::write(
            area,
            &self.y_label,
            (LEFT, Y_LABEL - 12),
            HPos::Left,
            sheet::font(SMALL),
        )?;
        let y = Axis::roomy(self.ordinates(), self.y_scale, (height / 34) as usize);
        let mut chart = ChartBuilder::on(area)
            .margin_top(Y_LABEL * UNIT)
            .margin_right((RIGHT + legend) * UNIT)
            .y_label_area_size(LEFT * UNIT)
            .x_label_area_size(X_TICKS * UNIT)
            .build_cartesian_2d(x.clone(), y.clone())?;
        chart.draw_series(self.regions.iter().filter_map(|region| {
            let [from, to] = [region.from, region.to].map(|end| {
                let place = x.scale.place(end);
                // A logarithmic axis cannot show zero.
                let place = if place.is_nan() {
                    f64::NEG_INFINITY
                } else {
                    place
                };
                place.clamp(x.range.start, x.range.end)
            });
            let corners = [(from, y.range.start), (to, y.range.end)];
            (to > from).then(|| Rectangle::new(corners, Ink::GapRegion.color().mix(0.22).filled()))
        }))?;
        if let Some(band) = self.band {
            chart.draw_series([Rectangle::new(
                [
                    (x.range.start, y.scale.place(band.from)),
                    (x.range.end, y.scale.place(band.to)),
                ],
                Ink::Other(1).color().mix(0.16).filled(),
            )])?;
        }
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
        let columns = ((WIDTH - LEFT - RIGHT - legend) / COLUMN) as usize;
        for line in &self.lines {
            let width = (line.ink.width() * f64::from(UNIT)) as u32;
            for piece in line.points.split(|p| p.1.is_nan()) {
                let placed: Vec<_> = piece
                    .iter()
                    .map(|p| (x.scale.place(p.0), y.scale.place(p.1)))
                    .collect();
                let thin = thin::envelope(&placed, [x.range.start, x.range.end], columns);
                chart.draw_series(LineSeries::new(thin, line.ink.color().stroke_width(width)))?;
            }
        }
        let mut row = 0;
        let top = self.band.map_or(y.range.end, |band| y.scale.place(band.to));
        let per_pixel = (y.range.end - y.range.start) / f64::from(height - Y_LABEL - X_TICKS);
        for mark in &self.marks {
            match mark {
                Mark::At { x: at, label } => {
                    let at = x.scale.place(*at);
                    // The vertical line begins at its label, above the labels of the previous marks.
                    let foot = y.range.start + f64::from(MARK_ROW * (2 * row + 1) / 2) * per_pixel;
                    let line =
                        PathElement::new([(at, foot), (at, top)], AXIS.stroke_width(UNIT as u32));
                    chart.draw_series([line])?;
                    chart.draw_series([EmptyElement::at((at, foot))
                        + Text::new(label.clone(), (5 * UNIT, 0), text(SMALL, VPos::Center))])?;
                    row += 1;
                }
                Mark::Peak { at, label } => {
                    let at = (x.scale.place(at.0), y.scale.place(at.1));
                    chart.draw_series([EmptyElement::at(at)
                        + Circle::new((0, 0), 3 * UNIT, TEXT.stroke_width(UNIT as u32))
                        + Text::new(
                            label.clone(),
                            (7 * UNIT, -7 * UNIT),
                            text(SMALL, VPos::Center),
                        )])?;
                }
            }
        }
        if self.lines.len() > 1 {
            self.legend(area, WIDTH - RIGHT - legend + 12)?;
        }
        Ok(())
    }

    fn legend(&self, area: &Area<'_>, left: i32) -> Result<(), Failure> {
        let top = Y_LABEL + LEGEND_ROW / 2;
        for (row, line) in (0..).zip(&self.lines) {
            let y = top + row * LEGEND_ROW;
            let ends = [left, left + SWATCH].map(|x| (x * UNIT, y * UNIT));
            area.draw(&PathElement::new(
                ends,
                line.ink.color().stroke_width(2 * UNIT as u32),
            ))?;
            let at = (left + SWATCH + 6, y);
            sheet::write(area, &line.label, at, HPos::Left, sheet::font(SMALL))?;
        }
        Ok(())
    }
}

fn text(size: f64, vertical: VPos) -> TextStyle<'static> {
    sheet::font(size).pos(Pos::new(HPos::Left, vertical))
}

impl Panel {
    /// Describes the chart in a sentence. If the abscissa `has_values`, the sentence includes the shaded ranges.
    fn in_words(&self, has_values: bool) -> String {
        let lines: Vec<_> = self.lines.iter().map(|line| line.label.as_str()).collect();
        let ends = |values: &mut dyn Iterator<Item = f64>| {
            let values = values.filter(|value| value.is_finite());
            values.fold(None, |ends: Option<[f64; 2]>, value| {
                Some(ends.map_or([value; 2], |[low, high]| [low.min(value), high.max(value)]))
            })
        };
        let range = ends(&mut self.ordinates()).map_or(String::new(), |[low, high]| {
            format!(" from {} to {}", axis::rounded(low), axis::rounded(high))
        });
        let shaded = self.regions.iter().map(|region| {
            let [from, to] = [region.from, region.to].map(axis::rounded);
            match has_values {
                true => format!(", shaded from {from} to {to}"),
                false => String::new(),
            }
        });
        let shaded: String = shaded.collect();
        format!("{}{range}: {}{shaded}.", self.y_label, lines.join(", "))
    }
}

impl Figure {
    /// A text description of the chart, for screen readers.
    fn words(&self) -> Words {
        let has_values = self.x_ticks.is_empty();
        let panels = self.panels.iter().map(|panel| panel.in_words(has_values));
        let panels: Vec<_> = panels.collect();
        Words {
            title: self.title.clone(),
            description: format!("Over {}. {}", self.x_label, panels.join(" ")),
        }
    }

    /// The chart as SVG text.
    ///
    /// # Errors
    /// Returns [`PlotError`] if the drawing library reports an error.
    pub fn svg(&self) -> Result<String, PlotError> {
        let lines = || self.panels.iter().flat_map(|panel| &panel.lines);
        let x = Axis::tight(
            lines().flat_map(|line| line.points.iter().map(|p| p.0)),
            self.x_scale,
            8,
        );
        let x = match self.x_ticks.is_empty() {
            true => x,
            false => x.with_ticks(&self.x_ticks),
        };
        let legend = match self.panels.iter().any(|panel| panel.lines.len() > 1) {
            true => lines()
                .map(|line| sheet::width_of(&line.label, SMALL) + SWATCH + 18)
                .max()
                .unwrap_or(0),
            false => 0,
        };
        let panels: i32 = (0..self.panels.len()).map(Panel::height).sum();
        sheet::draw(TITLE + panels + X_LABEL, &self.words(), |area| {
            let at = (LEFT, TITLE / 2 + 2);
            sheet::write(area, &self.title, at, HPos::Left, sheet::font(LARGE))?;
            let mut top = TITLE;
            for (place, panel) in self.panels.iter().enumerate() {
                let height = Panel::height(place);
                let (_, rest) = area.split_vertically(top * UNIT);
                let (part, _) = rest.split_vertically(height * UNIT);
                panel.draw(&part, &x, legend, height)?;
                top += height;
            }
            let middle = (LEFT + WIDTH - RIGHT - legend) / 2;
            let at = (middle, top + X_LABEL / 2 - 2);
            sheet::write(area, &self.x_label, at, HPos::Center, sheet::font(SMALL))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chart_has_a_text_description_for_screen_readers() {
        let figure = Figure {
            title: "run <1> & more".into(),
            x_label: "time, s".into(),
            panels: vec![Panel {
                y_label: "position, degrees".into(),
                lines: vec![Line::new(
                    "measured",
                    Ink::Measured,
                    &[0.0, 1.0],
                    &[-2.0, 4.0],
                )],
                regions: vec![Band {
                    from: 0.25,
                    to: 0.5,
                }],
                ..Panel::default()
            }],
            ..Figure::default()
        };
        let svg = figure.svg().unwrap();
        for said in [
            "role=\"img\" aria-label=\"run &lt;1&gt; &amp; more\"",
            "<title>run &lt;1&gt; &amp; more</title>",
            "<desc>Over time, s. position, degrees from −2 to 4: measured, shaded from 0.25 to 0.5.</desc>",
            "viewBox",
        ] {
            assert!(svg.contains(said), "{said} is not in {svg}");
        }
    }
}
