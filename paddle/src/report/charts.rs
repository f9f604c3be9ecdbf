//! The plots of a report.

use super::course::{Course, worst};
use super::quantity::{Display, percent};
use super::region::{self, Labels};
use crate::plot::{Band, Bar, Bars, Figure, Ink, Line, Panel, PlotError, Scale};
use gap::diagnosis::{AFTER_REST, MeasuredBy, Profile, Region};
use std::ops::Range;

/// Windows that the telling stretch shows.
const WINDOWS: f64 = 4.0;
/// Runs whose residual is shown over time.
pub const RUNS: usize = 4;
/// Share of a horizon by which rounding may put a sample before its restart.
const HAIR: f64 = 1e-6;
/// Ticks along an axis whose widths are shares.
const TICKS: f64 = 9.0;
/// Runs of which the share of the gap is shown.
const BARS: usize = 20;

/// A plot with what is to be seen in it.
pub struct Captioned {
    /// The plot.
    pub svg: String,
    /// In sentences.
    pub caption: String,
}

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
    /// Where the gap lies.
    pub regions: &'a [Region],
    /// Units and names.
    pub labels: &'a Labels,
    /// Time between restarts, s.
    pub horizon_s: f64,
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
                    ..Panel::default()
                },
                self.residual_panel(course, rows.clone(), &residuals),
            ],
            ..Figure::default()
        };
        Some(figure.svg())
    }

    /// Residuals over time of the runs that carry most, in their order, with their files.
    pub fn over_time(&self) -> Result<Vec<(String, String)>, PlotError> {
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
            figure.svg().map(|svg| (svg, course.file.clone()))
        });
        figures.collect()
    }

    /// For each axis on which a part of the gap is told, the shares by which it was chosen.
    pub fn shares(&self) -> Result<Vec<Captioned>, PlotError> {
        let mut groups: Vec<Vec<(&Region, &Profile)>> = Vec::new();
        let all = self.regions.iter();
        for (region, profile) in all.filter_map(|r| Some((r, r.profile.as_ref()?))) {
            let group = groups
                .iter_mut()
                .find(|group| group[0].1.parts == profile.parts);
            match group {
                Some(group) => group.push((region, profile)),
                None => groups.push(vec![(region, profile)]),
            }
        }
        let captioned = groups.iter().map(|group| {
            let svg = match group[0].0.axis {
                "run" => run_bars(group[0].1).svg(),
                _ => self.share_figure(group).svg(),
            };
            let caption = self.share_caption(group);
            svg.map(|svg| Captioned { svg, caption })
        });
        captioned.collect()
    }

    /// Share of the gap over share of the samples along an axis, the told regions marked. Equal widths are equal shares of the
    /// samples, so that areas are shares of the gap; frequencies are as wide as they are on a logarithmic scale.
    fn share_figure(&self, group: &[(&Region, &Profile)]) -> Figure {
        let (region, profile) = group[0];
        let across = self.across(region, profile);
        let is_spectrum = region.measured_by == MeasuredBy::Spectrum;
        let edges = edges(profile);
        let place = |end: f64| match is_spectrum {
            true => end * across.factor,
            false => {
                let before = profile.parts.iter().filter(|part| part.to <= end);
                before.map(|part| part.share_of_samples).sum()
            }
        };
        let steps = profile.parts.iter().flat_map(|part| {
            let density = part.density();
            // A part without samples has no width either.
            let shown = if density.is_finite() { density } else { 0.0 };
            [part.from, part.to].map(|end| (place(end), shown))
        });
        let steps: Vec<_> = steps.collect();
        let even = [steps.first(), steps.last()].into_iter().flatten();
        let even = even.map(|(at, _)| (*at, 1.0)).collect();
        let line = |label: &str, ink, points| Line {
            label: label.into(),
            ink,
            points,
        };
        let marked = group.iter().map(|(_, profile)| {
            let [from, to] = profile.marked.map(place);
            Band { from, to }
        });
        let run = region.run.and_then(|run| self.labels.runs.get(run));
        let run = run.map_or(String::new(), |file| format!(" of {file}"));
        let (x_scale, x_ticks, widths) = match is_spectrum {
            true => (Scale::Logarithmic, Vec::new(), ""),
            false => {
                let ticks = ticks(&edges, place).into_iter();
                let ticks = ticks.map(|end| (place(end), across.number(end)));
                let widths = "; equal widths are equal shares of the samples";
                (Scale::Linear, ticks.collect(), widths)
            }
        };
        Figure {
            title: format!("Along {}{run}", region.axis),
            x_label: format!("{}, {}{widths}", profile.along, across.unit()),
            x_scale,
            x_ticks,
            panels: vec![Panel {
                y_label: format!("share of the gap over {}", share_of_what(region)),
                lines: vec![
                    line("if it were even", Ink::Setpoint, even),
                    line("the gap", Ink::Model, steps),
                ],
                regions: marked.collect(),
                ..Panel::default()
            }],
        }
    }

    /// The unit in which places on the axis of a region are said.
    fn across(&self, region: &Region, profile: &Profile) -> Display {
        let size = match region.axis {
            // Seconds on a clock stay seconds.
            "time" => 1.0,
            _ => edges(profile)
                .iter()
                .fold(0.0, |most: f64, end| most.max(end.abs())),
        };
        Display::of(&self.labels.unit(region.axis), size)
    }

    fn share_caption(&self, group: &[(&Region, &Profile)]) -> String {
        let (region, _) = group[0];
        let marked = group.iter().map(|(region, profile)| {
            let [low, high] = region.share_of_gap_interval.map(percent);
            let range = match region.name.as_deref() {
                Some(AFTER_REST) => {
                    let [from, to] = profile.marked;
                    let unit = self.labels.unit(region.axis);
                    let placed = Display::of(&unit, to).show_range(from, to);
                    let reached = region::range(region, self.labels);
                    format!("{placed}, from which the motion reaches {reached},")
                }
                _ => region::range(region, self.labels),
            };
            format!(
                "{range} with {} ({low} to {high}) of the gap and {} of the {}",
                percent(region.share_of_gap),
                percent(region.share_of_samples),
                share_of_what(region).trim_start_matches("share of the "),
            )
        });
        let marked: Vec<_> = marked.collect();
        format!(
            "{} Marked: {}.",
            measure_in_words(region.measured_by),
            marked.join("; ")
        )
    }

    fn residual_panel(&self, course: &Course, rows: Range<usize>, residuals: &[Trace]) -> Panel {
        let display = residual_display(self.courses, &self.labels.position);
        let lines = residuals
            .iter()
            .map(|trace| self.line(trace, course, rows.clone(), &display));
        Panel {
            y_label: format!("measured minus model, {}", display.unit()),
            lines: lines.collect(),
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

/// Where the parts of an axis begin and end.
fn edges(profile: &Profile) -> Vec<f64> {
    let first = profile.parts.first().map(|part| part.from);
    let ends = profile.parts.iter().map(|part| part.to);
    first.into_iter().chain(ends).collect()
}

/// Some of the `edges`, those about equally far from one another in their `place`.
fn ticks(edges: &[f64], place: impl Fn(f64) -> f64) -> Vec<f64> {
    let Some(&last) = edges.last() else {
        return Vec::new();
    };
    let step = place(last) / TICKS;
    let mut kept: Vec<f64> = Vec::new();
    for &edge in edges {
        let is_far = |before: &f64| place(edge) - place(*before) >= step;
        if kept.last().is_none_or(is_far) {
            kept.push(edge);
        }
    }
    kept
}

/// What the share of the gap is held against.
fn share_of_what(region: &Region) -> &'static str {
    match region.measured_by {
        MeasuredBy::Spectrum => "share of the power of motion and input",
        _ => "share of the samples",
    }
}

/// What the gap is measured by along an axis.
fn measure_in_words(measured_by: MeasuredBy) -> &'static str {
    match measured_by {
        MeasuredBy::ShortPredictions => {
            "Where the gap arises: squared residual of short predictions, beyond noise."
        }
        MeasuredBy::WholeHorizon => {
            "Where the gap has grown largest: squared residual of predictions over the whole time between restarts."
        }
        MeasuredBy::MissingTorque => {
            "Where the torque acts that the nominal model lacks: its square, beyond noise."
        }
        MeasuredBy::Spectrum => "Power of the acceleration that short predictions miss.",
        MeasuredBy::SecondSensor => "How much better a second position sensor is predicted.",
    }
}

/// Bars by run, for the runs that stand out most.
fn run_bars(profile: &Profile) -> Bars {
    let [from, to] = profile.marked;
    let mut parts: Vec<_> = profile.parts.iter().collect();
    parts.sort_by(|a, b| b.density().total_cmp(&a.density()));
    parts.truncate(BARS);
    let bars = parts.into_iter().map(|part| Bar {
        label: part.run.clone().unwrap_or_default(),
        value: part.density(),
        ink: match part.from >= from && part.to <= to {
            true => Ink::Guilty,
            false => Ink::Model,
        },
    });
    Bars {
        title: "By run: share of the gap over share of the samples".into(),
        unit: String::new(),
        bars: bars.collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::example;
    use super::*;

    #[test]
    fn what_is_plotted_along_an_axis_is_what_was_scored_and_the_band_is_where_it_is_highest() {
        let diagnosis = example::stribeck();
        let charts = Charts {
            courses: &[],
            regions: &diagnosis.regions,
            labels: &example::labels(),
            horizon_s: 0.5,
        };
        let region = &diagnosis.regions[0];
        let figure = charts.share_figure(&[(region, region.profile.as_ref().unwrap())]);
        let panel = &figure.panels[0];
        let band = panel.regions[0];
        assert!((band.to - band.from - region.share_of_samples).abs() < 1e-9);
        let inside = |x: f64| x >= band.from && x <= band.to;
        let steps = panel.lines[1].points.chunks(2);
        for step in steps {
            let is_marked = step.iter().all(|(x, _)| inside(*x));
            assert_eq!(step[0].1 > 1.0, is_marked, "{step:?} {band:?}");
        }
        let caption = charts.shares().unwrap().remove(0).caption;
        assert!(
            caption.contains(
                "−2.9 to 2.9 °/s with 71 % (62 % to 79 %) of the gap and 12 % of the samples"
            ),
            "{caption}"
        );
    }
}
