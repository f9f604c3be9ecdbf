//! The plots of a report.

use super::course::{Course, profile, worst};
use super::quantity::Display;
use super::region::Labels;
use crate::plot::{Band, Figure, Ink, Line, Panel, PlotError, Scale};
use crate::spectrum;
use gap::diagnosis::Region;
use std::ops::Range;

/// Windows that the telling stretch shows.
const WINDOWS: f64 = 4.0;
/// Runs whose residual is shown over time.
pub const RUNS: usize = 4;
/// Samples of a piece whose spectrum is taken, at most.
const PIECE: usize = 2048;
/// Share of a horizon by which rounding may put a sample before its restart.
const HAIR: f64 = 1e-6;
/// Regions that are marked on one axis.
const MARKED: usize = 3;

/// One value a sample.
struct Trace {
    label: &'static str,
    ink: Ink,
    values: Vec<f64>,
}

/// What all plots are made from.
pub struct Charts<'a> {
    /// The runs.
    pub courses: &'a [Course],
    /// The same with predictions so short that the gap is seen where it arises.
    pub arising: &'a [Course],
    /// What to mark.
    pub regions: &'a [Region],
    /// Units and names.
    pub labels: &'a Labels,
    /// Time between restarts, s.
    pub horizon_s: f64,
    /// Half the width over which a rate is taken, s.
    pub half_width_s: f64,
}

impl Charts<'_> {
    /// Measured, nominal and corrected where the nominal model is worst.
    pub fn stretch(&self) -> Option<Result<String, PlotError>> {
        let span_s = WINDOWS * self.horizon_s;
        let (index, rows) = worst(self.courses, self.horizon_s, span_s)?;
        let course = &self.courses[index];
        let residuals = self.residuals(course);
        let display = self.position();
        let trace = |label, ink, values: &[f64]| Trace {
            label,
            ink,
            values: values.to_vec(),
        };
        let mut traces = vec![
            trace("measured", Ink::Measured, &course.measured),
            trace("nominal model", Ink::Model, &course.nominal),
        ];
        if let Some(corrected) = &course.corrected {
            traces.push(trace("corrected model", Ink::Corrected, corrected));
        }
        let lines = traces
            .iter()
            .map(|trace| self.line(trace, course, rows.clone(), &display));
        let figure = Figure {
            title: format!("{}, where the nominal model is worst", course.file),
            x_label: "time, s".into(),
            panels: vec![
                Panel {
                    y_label: format!("position, {}", display.unit()),
                    lines: lines.collect(),
                    regions: self.marked("time", Some(course.run)),
                    ..Panel::default()
                },
                self.residual_panel(course, rows.clone(), &residuals),
            ],
            ..Figure::default()
        };
        Some(figure.svg())
    }

    /// Residuals over time of the runs that carry most, in their order.
    pub fn over_time(&self) -> Result<Vec<String>, PlotError> {
        let mut worst: Vec<&Course> = self.courses.iter().collect();
        worst.sort_by(|a, b| b.badness().total_cmp(&a.badness()));
        worst.truncate(RUNS);
        worst.sort_by_key(|course| course.run);
        let figures = worst.into_iter().map(|course| {
            let rows = 0..course.time.len();
            let figure = Figure {
                title: course.file.clone(),
                x_label: "time, s".into(),
                panels: vec![self.residual_panel(course, rows, &self.residuals(course))],
                ..Figure::default()
            };
            figure.svg()
        });
        figures.collect()
    }

    /// Root mean square residual of short predictions along an axis, if it varies; `None` for an axis that has no samples.
    pub fn along(&self, axis: &str) -> Option<Result<String, PlotError>> {
        let unit = self.labels.unit(axis);
        let mut places = Vec::new();
        let mut residuals: Vec<Trace> = Vec::new();
        for course in self.arising {
            let velocity = || course.rate(&course.measured, self.half_width_s);
            places.extend(match axis {
                "position" => course.measured.clone(),
                "velocity" => velocity(),
                "acceleration" => course.rate(&velocity(), self.half_width_s),
                "input" => course.input.clone(),
                _ => return None,
            });
            for (k, trace) in self.residuals(course).into_iter().enumerate() {
                match residuals.get_mut(k) {
                    Some(all) => all.values.extend(trace.values),
                    None => residuals.push(trace),
                }
            }
        }
        let largest = places
            .iter()
            .fold(0.0, |most: f64, place| most.max(place.abs()));
        let (across, up) = (
            Display::of(&unit, largest),
            residual_display(self.arising, &self.labels.position),
        );
        let lines: Vec<_> = residuals
            .into_iter()
            .map(|trace| Line {
                label: trace.label.into(),
                ink: trace.ink,
                points: profile(&places, &trace.values)
                    .into_iter()
                    .map(|(place, rms)| (place * across.factor, rms * up.factor))
                    .collect(),
            })
            .collect();
        if lines.iter().all(|line| line.points.is_empty()) {
            return None;
        }
        let regions = self.marked(axis, None).into_iter();
        let figure = Figure {
            title: format!("Along {axis}"),
            x_label: format!("{axis}, {}", across.unit()),
            panels: vec![Panel {
                y_label: format!("rms of measured minus model, {}", up.unit()),
                lines,
                regions: regions
                    .map(|region| Band {
                        from: region.from * across.factor,
                        to: region.to * across.factor,
                    })
                    .collect(),
                ..Panel::default()
            }],
            ..Figure::default()
        };
        Some(figure.svg())
    }

    /// Spectrum of the residuals of the run that carries most.
    pub fn over_frequency(&self) -> Option<Result<String, PlotError>> {
        let course = self
            .courses
            .iter()
            .max_by(|a, b| a.badness().total_cmp(&b.badness()))?;
        let duration_s = course.time.last()? - course.time.first()?;
        let sample_hz = (course.time.len() - 1) as f64 / duration_s;
        let length = PIECE.min(course.time.len() / 2);
        let display = residual_display(self.courses, &self.labels.position);
        let lines: Vec<_> = self
            .residuals(course)
            .into_iter()
            .map(|trace| {
                let density = spectrum::amplitude_density(&trace.values, sample_hz, length);
                let scaled = density.into_iter().map(|(f, a)| (f, a * display.factor));
                Line {
                    label: trace.label.into(),
                    ink: trace.ink,
                    points: scaled.collect(),
                }
            })
            .collect();
        if lines.iter().any(|line| line.points.is_empty()) {
            return None;
        }
        let figure = Figure {
            title: format!("Along frequency, {}", course.file),
            x_label: "frequency, Hz".into(),
            x_scale: Scale::Logarithmic,
            panels: vec![Panel {
                y_label: format!("measured minus model, {} per √Hz", display.unit()),
                y_scale: Scale::Logarithmic,
                lines,
                regions: self.marked("frequency", None),
                ..Panel::default()
            }],
        };
        Some(figure.svg())
    }

    fn residual_panel(&self, course: &Course, rows: Range<usize>, residuals: &[Trace]) -> Panel {
        let display = residual_display(self.courses, &self.labels.position);
        let lines = residuals
            .iter()
            .map(|trace| self.line(trace, course, rows.clone(), &display));
        Panel {
            y_label: format!("measured minus model, {}", display.unit()),
            lines: lines.collect(),
            regions: self.marked("time", Some(course.run)),
            ..Panel::default()
        }
    }

    fn residuals(&self, course: &Course) -> Vec<Trace> {
        let nominal = Trace {
            label: "nominal model",
            ink: Ink::Model,
            values: course.nominal_residual(),
        };
        let corrected = course.corrected_residual().map(|values| Trace {
            label: "corrected model",
            ink: Ink::Corrected,
            values,
        });
        [Some(nominal), corrected].into_iter().flatten().collect()
    }

    /// A trace over time; a prediction is interrupted where it is re-started.
    fn line(&self, trace: &Trace, course: &Course, rows: Range<usize>, display: &Display) -> Line {
        let start = course.time.first().copied().unwrap_or(0.0);
        let window = |i: usize| ((course.time[i] - start) / self.horizon_s + HAIR).floor();
        let mut points = Vec::with_capacity(rows.len());
        for i in rows.clone() {
            if trace.ink != Ink::Measured && i > rows.start && window(i) > window(i - 1) {
                points.push((course.time[i], f64::NAN));
            }
            points.push((course.time[i], trace.values[i] * display.factor));
        }
        Line {
            label: trace.label.into(),
            ink: trace.ink,
            points,
        }
    }

    /// The regions on an axis; of one run, or of any.
    fn marked(&self, axis: &str, run: Option<usize>) -> Vec<Band> {
        let mine = self.regions.iter().filter(|region| {
            region.axis == axis && (run.is_none() || region.run.is_none() || region.run == run)
        });
        mine.filter_map(|region| {
            Some(Band {
                from: region.from?,
                to: region.to?,
            })
        })
        .take(MARKED)
        .collect()
    }

    fn position(&self) -> Display {
        let all = self.courses.iter().flat_map(|course| &course.measured);
        Display::of(
            &self.labels.position,
            all.fold(0.0, |most, x| x.abs().max(most)),
        )
    }
}

fn residual_display(courses: &[Course], unit: &str) -> Display {
    let all = courses.iter().flat_map(Course::nominal_residual);
    Display::of(unit, all.fold(0.0, |most, x| x.abs().max(most)))
}
