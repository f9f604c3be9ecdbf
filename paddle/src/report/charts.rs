//! The plots of a report.

use super::predicted_run::{PredictedRun, worst};
use super::quantity::{Display, percent};
use super::region::{self, Labels};
use crate::plot::{Band, Bar, Bars, Figure, Ink, Line, Panel, PlotError, Scale};
use gap::diagnosis::{AFTER_REST, MeasuredBy, Profile, Region};
use std::ops::Range;

/// Number of prediction windows in the plot of the worst interval.
const WINDOWS: f64 = 4.0;
/// Number of runs whose residual is plotted over time.
pub const RUNS: usize = 4;
/// Tolerance of a restart time, as a share of the horizon. Rounding may place the first sample slightly before the restart.
const HAIR: f64 = 1e-6;
/// Number of ticks along an axis whose widths are shares.
const TICKS: f64 = 9.0;
/// Number of runs in the bar chart of the shares.
const BARS: usize = 20;

/// A plot with a caption.
pub struct Captioned {
    /// The plot.
    pub svg: String,
    /// Caption in sentences.
    pub caption: String,
}

/// One value per sample.
struct Trace {
    label: &'static str,
    ink: Ink,
    values: Vec<f64>,
}

/// Data of all plots.
pub struct Charts<'a> {
    /// Runs with their predictions.
    pub predicted_runs: &'a [PredictedRun],
    /// Regions of the data in which the gap lies.
    pub regions: &'a [Region],
    /// Units and names.
    pub labels: &'a Labels,
    /// Time between restarts, s.
    pub horizon_s: f64,
}

impl Charts<'_> {
    /// Measured, nominal and corrected position in the interval in which the nominal model is worst.
    pub fn stretch(&self) -> Option<Result<String, PlotError>> {
        let span_s = WINDOWS * self.horizon_s;
        let (index, rows) = worst(self.predicted_runs, self.horizon_s, span_s)?;
        let predicted = &self.predicted_runs[index];
        let residuals = self.residuals(predicted);
        let display = self.position();
        let trace = |label, ink, values: &[f64]| Trace {
            label,
            ink,
            values: values.to_vec(),
        };
        let mut traces = vec![
            trace("measured", Ink::Measured, &predicted.measured),
            trace("nominal model", Ink::Model, &predicted.nominal),
        ];
        if let Some(corrected) = &predicted.corrected {
            traces.push(trace("corrected model", Ink::Corrected, corrected));
        }
        let lines = traces
            .iter()
            .map(|trace| self.line(trace, predicted, rows.clone(), &display));
        let figure = Figure {
            title: format!("{}, where the nominal model is worst", predicted.file),
            x_label: "time, s".into(),
            panels: vec![
                Panel {
                    y_label: format!("position, {}", display.unit()),
                    lines: lines.collect(),
                    ..Panel::default()
                },
                self.residual_panel(predicted, rows.clone(), &residuals),
            ],
            ..Figure::default()
        };
        Some(figure.svg())
    }

    /// Residuals over time of the runs with the largest shares of the gap, in the order of the recording, with their files.
    pub fn over_time(&self) -> Result<Vec<(String, String)>, PlotError> {
        let mut worst: Vec<&PredictedRun> = self.predicted_runs.iter().collect();
        worst.sort_by(|a, b| {
            b.nominal_squared_error()
                .total_cmp(&a.nominal_squared_error())
        });
        worst.truncate(RUNS);
        worst.sort_by_key(|predicted| predicted.run);
        let figures = worst.into_iter().map(|predicted| {
            let rows = 0..predicted.time.len();
            let figure = Figure {
                title: predicted.file.clone(),
                x_label: "time, s".into(),
                panels: vec![self.residual_panel(predicted, rows, &self.residuals(predicted))],
                ..Figure::default()
            };
            figure.svg().map(|svg| (svg, predicted.file.clone()))
        });
        figures.collect()
    }

    /// For each axis with a reported region: the shares of the gap along the axis, from which the region was chosen.
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

    /// Plots the share of the gap divided by the share of the samples along an axis, with the reported regions marked. Equal
    /// widths are equal shares of the samples, so an area is a share of the gap. A frequency axis is logarithmic instead.
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
            // A part without samples has zero width.
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

    /// The unit of the axis of a region.
    fn across(&self, region: &Region, profile: &Profile) -> Display {
        let size = match region.axis {
            // Time axes stay in seconds.
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

    fn residual_panel(
        &self,
        predicted: &PredictedRun,
        rows: Range<usize>,
        residuals: &[Trace],
    ) -> Panel {
        let display = residual_display(self.predicted_runs, &self.labels.position);
        let lines = residuals
            .iter()
            .map(|trace| self.line(trace, predicted, rows.clone(), &display));
        Panel {
            y_label: format!("measured minus model, {}", display.unit()),
            lines: lines.collect(),
            ..Panel::default()
        }
    }

    fn residuals(&self, predicted: &PredictedRun) -> Vec<Trace> {
        let nominal = Trace {
            label: "nominal model",
            ink: Ink::Model,
            values: predicted.nominal_residual(),
        };
        let corrected = predicted.corrected_residual().map(|values| Trace {
            label: "corrected model",
            ink: Ink::Corrected,
            values,
        });
        [Some(nominal), corrected].into_iter().flatten().collect()
    }

    /// A trace over time. A prediction is interrupted at each restart.
    fn line(
        &self,
        trace: &Trace,
        predicted: &PredictedRun,
        rows: Range<usize>,
        display: &Display,
    ) -> Line {
        let start = predicted.time.first().copied().unwrap_or(0.0);
        let window = |i: usize| ((predicted.time[i] - start) / self.horizon_s + HAIR).floor();
        let mut points = Vec::with_capacity(rows.len());
        for i in rows.clone() {
            if trace.ink != Ink::Measured && i > rows.start && window(i) > window(i - 1) {
                points.push((predicted.time[i], f64::NAN));
            }
            points.push((predicted.time[i], trace.values[i] * display.factor));
        }
        Line {
            label: trace.label.into(),
            ink: trace.ink,
            points,
        }
    }

    fn position(&self) -> Display {
        let all = self
            .predicted_runs
            .iter()
            .flat_map(|predicted| &predicted.measured);
        Display::of(
            &self.labels.position,
            all.fold(0.0, |most, x| x.abs().max(most)),
        )
    }
}

fn residual_display(predicted_runs: &[PredictedRun], unit: &str) -> Display {
    let all = predicted_runs
        .iter()
        .flat_map(PredictedRun::nominal_residual);
    Display::of(unit, all.fold(0.0, |most, x| x.abs().max(most)))
}

/// Limits of the parts of an axis.
fn edges(profile: &Profile) -> Vec<f64> {
    let first = profile.parts.first().map(|part| part.from);
    let ends = profile.parts.iter().map(|part| part.to);
    first.into_iter().chain(ends).collect()
}

/// Selects some of the `edges` at about equal distances in their `place`.
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

/// Quantity by which the share of the gap is divided.
fn share_of_what(region: &Region) -> &'static str {
    match region.measured_by {
        MeasuredBy::Spectrum => "share of the power of motion and input",
        _ => "share of the samples",
    }
}

/// Name of the measure of the gap along an axis.
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

/// Bars per run, for the runs that differ most from an even share.
fn run_bars(profile: &Profile) -> Bars {
    let [from, to] = profile.marked;
    let mut parts: Vec<_> = profile.parts.iter().collect();
    parts.sort_by(|a, b| b.density().total_cmp(&a.density()));
    parts.truncate(BARS);
    let bars = parts.into_iter().map(|part| Bar {
        label: part.run.clone().unwrap_or_default(),
        value: part.density(),
        ink: match part.from >= from && part.to <= to {
            true => Ink::GapRegion,
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
    fn the_plot_along_an_axis_shows_the_scored_shares_and_marks_the_highest() {
        let diagnosis = example::stribeck();
        let charts = Charts {
            predicted_runs: &[],
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
