//! Plots and describes the torque that the nominal model lacks, over the quantity on which it depends.

use crate::plot::{Cloud, PlotError, Scatter};
use gap::diagnosis::Verdict;
use gap::missing_torque::{Axis, Look, Point};
use gap::{Device, MissingTorque, Outcome};
use recording::Recording;

/// Number of intervals of the axis over which the explained torque is averaged for its line.
const STRETCHES: usize = 48;
/// Fewest points of an interval that contributes to the line.
const FEWEST: usize = 2;
/// Smallest share of the missing torque that an axis must explain to be named.
const CARRIES: f64 = 0.2;
/// Share of the points at each end of an axis that is averaged for a sentence.
const ENDS: f64 = 0.2;

/// Caption of every picture.
pub const CAPTION: &str = "Each point is an instant at which the axis slides, by a smoother with an unknown torque. The line is what the \
                           named effects, or the best proposal of the library, would give there; what is left is beside.";

/// Arrangement of the points in a picture.
struct View {
    x_label: String,
    y_label: &'static str,
    /// Labels of the two colours.
    labels: [&'static str; 2],
    /// Whether a point has the second colour.
    second: fn(&Point) -> bool,
    /// Abscissa of a point.
    place: Box<dyn Fn(&Point) -> f64>,
    /// Factor of the torque: 1, or the negative sign of the velocity.
    sign: fn(&Point) -> f64,
}

fn backwards(point: &Point) -> bool {
    point.velocity < 0.0
}

fn unchanged(_: &Point) -> f64 {
    1.0
}

fn against_motion(point: &Point) -> f64 {
    -point.velocity.signum()
}

impl View {
    fn of(look: &Look, position_unit: &str) -> Self {
        let torque_unit = &look.summary.unit;
        let over = |x_label: String, place: fn(&Point) -> f64| Self {
            x_label,
            y_label: "missing torque",
            labels: ["forwards", "backwards"],
            second: backwards,
            place: Box::new(place),
            sign: unchanged,
        };
        match (look.axis, look.orders.first()) {
            (Axis::Position, _) => over(format!("position, {position_unit}"), |p| p.position),
            (Axis::Input, _) => over(format!("torque of the input, {torque_unit}"), |p| p.drive),
            (Axis::Acceleration, _) => {
                over(format!("torque by the model, {torque_unit}"), |p| p.net)
            }
            (Axis::Time, _) => over("time, s".into(), |p| p.time_s),
            (Axis::Load, _) => Self {
                x_label: format!("size of the torque of the input, {torque_unit}"),
                y_label: "missing torque against the motion",
                labels: ["the motor drives", "the load drives"],
                second: |p| p.drive * p.velocity < 0.0,
                place: Box::new(|p| p.drive.abs()),
                sign: against_motion,
            },
            (Axis::DirectionAndPosition, _) => Self {
                y_label: "missing torque against the motion",
                sign: against_motion,
                ..over(format!("position, {position_unit}"), |p| p.position)
            },
            (Axis::Wave, Some(order)) => {
                let waves = order.wave_number / core::f64::consts::TAU;
                let label = format!(
                    "position within one of {} waves per {position_unit}",
                    significant(waves)
                );
                Self {
                    place: Box::new(move |p| (p.position * waves).rem_euclid(1.0)),
                    ..over(label, |p| p.position)
                }
            }
            _ => over(format!("velocity, {position_unit}/s"), |p| p.velocity),
        }
    }
}

/// Plots the missing torque over its axis, with the explained torque as a line and the remainder in a second panel.
///
/// # Errors
/// Returns [`PlotError`] if the picture cannot be drawn.
pub fn picture(look: &Look, title: &str, position_unit: &str) -> Result<String, PlotError> {
    scatter(look, title, position_unit).svg()
}

/// The data of the picture.
pub fn scatter(look: &Look, title: &str, position_unit: &str) -> Scatter {
    let view = View::of(look, position_unit);
    let is_explained = !look.explained_by.is_empty();
    let cloud = |second: bool| {
        let points = look.points.iter().filter(|p| (view.second)(p) == second);
        let points: Vec<(f64, f64, f64)> = points
            .map(|p| {
                let sign = (view.sign)(p);
                ((view.place)(p), sign * p.torque, sign * p.explained)
            })
            .collect();
        Cloud {
            label: view.labels[usize::from(second)].into(),
            points: points.iter().map(|(x, y, _)| (*x, *y)).collect(),
            explained: match is_explained {
                true => averaged(points.iter().map(|(x, _, e)| (*x, *e)).collect()),
                false => Vec::new(),
            },
            rest: points.iter().map(|(x, y, e)| (*x, y - e)).collect(),
        }
    };
    let explained_by = match is_explained {
        true => look.explained_by.join(" + "),
        false => String::new(),
    };
    Scatter {
        title: title.into(),
        x_label: view.x_label,
        y_label: format!("{}, {}", view.y_label, look.summary.unit),
        explained_by,
        clouds: [false, true].map(cloud).into(),
    }
}

/// Means over equal intervals of the axis.
fn averaged(points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    let ends = |(low, high): (f64, f64), point: &(f64, f64)| (low.min(point.0), high.max(point.0));
    let (low, high) = points.iter().fold((f64::INFINITY, f64::NEG_INFINITY), ends);
    let mut sums = [(0.0, 0.0, 0usize); STRETCHES];
    for (x, y) in points {
        let place = (x - low) / (high - low).max(f64::MIN_POSITIVE) * STRETCHES as f64;
        let sum = &mut sums[(place as usize).min(STRETCHES - 1)];
        *sum = (sum.0 + x, sum.1 + y, sum.2 + 1);
    }
    let known = sums.iter().filter(|(.., count)| *count >= FEWEST);
    known
        .map(|(x, y, count)| (x / *count as f64, y / *count as f64))
        .collect()
}

/// The first picture in the report of a diagnosis. It shows the torque that the named effects explain, or else the best
/// proposal.
///
/// # Errors
/// Returns [`PlotError`] if the picture cannot be drawn.
pub fn first(recording: &Recording, outcome: &Outcome) -> Result<(String, String), PlotError> {
    let missing = MissingTorque::of(recording, &Device::nominal(&recording.model));
    let effects = &outcome.diagnosis.effects;
    let names: Vec<&'static str> = effects.iter().map(|effect| effect.name).collect();
    let device = outcome.model.device();
    let look = missing.look((!names.is_empty()).then_some((&device, names)));
    let picture = picture(
        &look,
        "The torque that the model lacks",
        &recording.units.position,
    )?;
    let said = match outcome.diagnosis.verdict {
        Verdict::Unexplained => without_name(&look),
        _ => sentence(&look),
    };
    Ok((said, picture))
}

/// One line about a gap that no effect explains.
pub fn unexplained(recording: &Recording) -> String {
    let missing = MissingTorque::of(recording, &Device::nominal(&recording.model));
    format!("{}\n", without_name(&missing.look(None)))
}

fn without_name(look: &Look) -> String {
    let said = sentence(look);
    match look.summary.repeats || look.points.is_empty() {
        true => said,
        false => format!(
            "{said} No effect of the library earns its place when its prediction is judged."
        ),
    }
}

/// Describes the missing torque in one or two sentences.
pub fn sentence(look: &Look) -> String {
    let summary = &look.summary;
    let unit = &summary.unit;
    if look.points.is_empty() {
        return "The motion is too slow for its noise to show a missing torque.".into();
    }
    let rms = significant(summary.rms);
    let missing = format!("The nominal model lacks a torque of {rms} {unit} rms.");
    if summary.repeats {
        return format!(
            "{missing} The motion only repeats itself, so that nothing can be said of what this torque goes with."
        );
    }
    let share = summary.shares.iter().find(|share| share.axis == look.axis);
    let share = share.map_or(0.0, |share| share.share);
    let carried = if share >= CARRIES {
        format!(
            "{} of it {} with {}",
            percent(share),
            if share >= 0.5 { "goes" } else { "may go" },
            said(look.axis)
        )
    } else {
        format!(
            "No function of one axis explains more than {} of it; it is drawn over {}",
            percent(
                summary
                    .shares
                    .first()
                    .map_or(0.0, |first| first.share.max(0.0))
            ),
            said(look.axis)
        )
    };
    format!("{missing} {carried}: {}.", values(look))
}

/// Mean torque in each direction, or at both ends of the axis.
fn values(look: &Look) -> String {
    let unit = &look.summary.unit;
    let mean = |points: &[&Point], sign: fn(&Point) -> f64| {
        let sum: f64 = points.iter().map(|p| sign(p) * p.torque).sum();
        significant(sum / points.len().max(1) as f64)
    };
    let view = View::of(look, "");
    if matches!(
        look.axis,
        Axis::Position | Axis::Input | Axis::Acceleration | Axis::Time
    ) {
        let mut sorted: Vec<&Point> = look.points.iter().collect();
        sorted.sort_by(|a, b| (view.place)(a).total_cmp(&(view.place)(b)));
        let count = ((ENDS * sorted.len() as f64) as usize).max(1);
        let [low, high] = [&sorted[..count], &sorted[sorted.len() - count..]];
        return format!(
            "{} {unit} on the average at its lower end, {} {unit} at its upper end",
            mean(low, unchanged),
            mean(high, unchanged)
        );
    }
    let (mut second, mut first): (Vec<&Point>, Vec<&Point>) =
        look.points.iter().partition(|p| (view.second)(p));
    if look.axis == Axis::Velocity {
        let ends = [&mut first, &mut second].map(|points| {
            points.sort_by(|a, b| a.velocity.abs().total_cmp(&b.velocity.abs()));
            let count = ((ENDS * points.len() as f64) as usize)
                .max(1)
                .min(points.len());
            // The slowest points are at reversals, where the smoother blurs a step, so they are skipped.
            let slow = &points[points.len().min(count / 2)..points.len().min(count / 2 + count)];
            [slow, &points[points.len() - count..]].map(|some| mean(some, against_motion))
        });
        let [[slow, fast], [slow_back, fast_back]] = ends;
        return format!(
            "forwards {slow} {unit} against the motion where it is slow and {fast} {unit} where it is fast, backwards \
             {slow_back} and {fast_back} {unit}"
        );
    }
    let [a, b] = match view.labels {
        ["forwards", _] => ["forwards", "backwards"],
        _ => ["where the motor drives", "where the load drives"],
    };
    format!(
        "{} {unit} against the motion {a}, {} {unit} {b}",
        mean(&first, against_motion),
        mean(&second, against_motion)
    )
}

/// Name of an axis in a sentence.
fn said(axis: Axis) -> &'static str {
    match axis {
        Axis::Velocity => "velocity",
        Axis::Position => "position",
        Axis::Input => "the input",
        Axis::Load => "the size of the torque that is transmitted",
        Axis::Acceleration => "the torque that accelerates",
        Axis::Time => "time",
        Axis::DirectionAndPosition => "position, against the motion",
        Axis::Wave => "the place within a wave over the position",
        Axis::Constant | Axis::VelocityOdd | Axis::VelocityEven | Axis::Memory => "no single axis",
    }
}

fn percent(share: f64) -> String {
    format!("{:.0} %", 100.0 * share)
}

/// Formats a value with two significant digits.
fn significant(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return "0".into();
    }
    let digits = (1 - value.abs().log10().floor() as i32).clamp(0, 9) as usize;
    format!("{value:.digits$}").replace('-', "−")
}

const STYLE: &str = include_str!("page.css");

/// An HTML page with the picture only.
pub fn page(title: &str, sentence: &str, picture: &str) -> String {
    let [title, sentence] = [title, sentence].map(escaped);
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>Missing torque of {title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n<header>\n\
         <p class=\"recording\">{title}</p>\n<h1>The torque that the model lacks</h1>\n\
         <p class=\"answer\">{sentence}</p>\n</header>\n<main>\n<figure>\n{picture}\n\
         <figcaption>{CAPTION}</figcaption>\n</figure>\n</main>\n</body>\n</html>\n"
    )
}

/// Escapes text for HTML.
fn escaped(text: &str) -> String {
    let text = text.replace('&', "&amp;").replace('<', "&lt;");
    text.replace('>', "&gt;").replace('"', "&quot;")
}
