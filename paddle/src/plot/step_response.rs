//! Plots a step response with its metrics.

use super::figure::{Band, Line, Mark, Panel};
use super::ink::Ink;
use haptic_paddle::metrics::StepReport;

/// Plots position in degrees over time in ms for a step to `target_deg` at time 0. Marks the settling band of half width
/// `band_deg`, the rise time, the settling time and the overshoot.
pub fn step_response(
    position: Vec<(f64, f64)>,
    target_deg: f64,
    band_deg: f64,
    report: &StepReport,
) -> Panel {
    let span = |at: fn(f64, f64) -> f64, from: f64| position.iter().map(|p| p.0).fold(from, at);
    let (first, last) = (span(f64::min, 0.0), span(f64::max, 0.0));
    let at_ms = |seconds: f32| 1e3 * f64::from(seconds);
    let time = |what: &str, seconds: Option<f32>| {
        let x = at_ms(seconds?);
        let label = format!("{what} {x:.1} ms");
        (x > 0.0 && x <= last).then_some(Mark::At { x, label })
    };
    let mut marks: Vec<_> = [
        time("rise", report.rise_s),
        time("settled", report.settling_s),
    ]
    .into_iter()
    .flatten()
    .collect();
    let overshoot_deg = f64::from(report.overshoot_rad.to_degrees());
    if overshoot_deg > band_deg {
        let beyond = |p: &&(f64, f64)| target_deg.signum() * p.1;
        let peak = position
            .iter()
            .max_by(|a, b| beyond(a).total_cmp(&beyond(b)));
        marks.extend(peak.map(|&at| Mark::Peak {
            at,
            label: format!("overshoot {overshoot_deg:.2}°"),
        }));
    }
    Panel {
        y_label: "position, degrees".into(),
        band: Some(Band {
            from: target_deg - band_deg,
            to: target_deg + band_deg,
        }),
        lines: vec![
            Line {
                label: "setpoint".into(),
                ink: Ink::Setpoint,
                points: vec![
                    (first, 0.0),
                    (0.0, 0.0),
                    (0.0, target_deg),
                    (last, target_deg),
                ],
            },
            Line {
                label: "position".into(),
                ink: Ink::Measured,
                points: position,
            },
        ],
        marks,
        ..Panel::default()
    }
}
