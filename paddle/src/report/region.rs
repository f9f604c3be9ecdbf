//! Describes a region of the data in words.

use super::quantity::{Display, show};
use gap::diagnosis::{AFTER_REST, Region};
use recording::{Oddity, Recording};

/// Units and names of a recording that the text of a diagnosis uses.
#[derive(Clone, Debug, PartialEq)]
pub struct Labels {
    /// Unit of position.
    pub position: String,
    /// Unit of the input.
    pub input: String,
    /// Files of the runs.
    pub runs: Vec<String>,
    /// Dry friction of the nominal model as a torque at the joint.
    pub coulomb: f64,
    /// Largest input of the nominal model, in the unit of the input.
    pub input_limit: Option<f64>,
    /// True if the nominal model has hard stops.
    pub has_stops: bool,
    /// The column whose sign is reversed, if there is one.
    pub turned: Option<&'static str>,
}

impl Labels {
    /// The labels of `recording`.
    pub fn of(recording: &Recording) -> Self {
        Self {
            position: recording.units.position.clone(),
            input: recording.units.input.clone(),
            runs: recording.runs.iter().map(|run| run.file.clone()).collect(),
            coulomb: recording.model.coulomb,
            input_limit: recording.model.input_limit,
            has_stops: recording.model.travel.is_some(),
            turned: recording.oddities.iter().find_map(|oddity| match oddity {
                Oddity::OppositeSign { column, .. } => Some(*column),
                _ => None,
            }),
        }
    }

    /// Unit of an axis along which the gap is analysed.
    pub fn unit(&self, axis: &str) -> String {
        match axis {
            "position" => self.position.clone(),
            "velocity" => format!("{}/s", self.position),
            "acceleration" => format!("{}/s²", self.position),
            "input" => self.input.clone(),
            "time" => "s".into(),
            "frequency" => "Hz".into(),
            _ => String::new(),
        }
    }
}

/// The range of a region with its unit, or its name.
pub fn range(region: &Region, labels: &Labels) -> String {
    match (region.from, region.to, &region.name) {
        (Some(from), Some(to), _) => {
            let unit = labels.unit(region.axis);
            // Time axes stay in seconds.
            let size = match region.axis {
                "time" => 1.0,
                _ => from.abs().max(to.abs()),
            };
            Display::of(&unit, size).show_range(from, to)
        }
        (Some(from), None, _) => format!("from {}", show(from, &labels.unit(region.axis))),
        (None, Some(to), _) => format!("up to {}", show(to, &labels.unit(region.axis))),
        (None, None, Some(name)) => name.clone(),
        (None, None, None) => match region.run.and_then(|run| labels.runs.get(run)) {
            Some(file) => file.clone(),
            None => "everywhere".into(),
        },
    }
}

/// A range counts as around zero if the shorter side reaches at least this share of the longer side.
const ABOUT_AS_FAR: f64 = 0.5;

fn is_around_zero(region: &Region) -> bool {
    let (Some(from), Some(to)) = (region.from, region.to) else {
        return false;
    };
    (-from).min(to) >= ABOUT_AS_FAR * (-from).max(to)
}

/// The region as a phrase after "the gap sits".
pub fn phrase(region: &Region, labels: &Labels) -> String {
    let range = range(region, labels);
    let place = match region.axis {
        "velocity" if region.name.as_deref() == Some(AFTER_REST) => {
            format!("at rest, at reversals and right after (velocities of {range})")
        }
        "velocity" if is_around_zero(region) => format!("at low speed (velocities of {range})"),
        "velocity" => format!("at velocities of {range}"),
        "position" => format!("at positions of {range}"),
        "acceleration" => format!("at accelerations of {range}"),
        "input" => format!("at inputs of {range}"),
        "frequency" => format!("at frequencies of {range}"),
        "time" => format!("in the time from {range}"),
        "run" => format!("in the run {range}"),
        "channel" => format!("in {range}"),
        axis => format!("along {axis}, {range}"),
    };
    let run = region.run.and_then(|run| labels.runs.get(run));
    match run {
        Some(file) if !matches!(region.axis, "run" | "channel") && labels.runs.len() > 1 => {
            format!("{place} of {file}")
        }
        _ => place,
    }
}

#[cfg(test)]
mod tests {
    use super::super::example;
    use super::*;

    #[test]
    fn a_range_of_speeds_in_one_direction_is_not_called_low_speed() {
        let mut region = example::stribeck().regions.remove(0);
        let labels = example::labels();
        let mut said = |from, to| {
            (region.from, region.to) = (Some(from), Some(to));
            phrase(&region, &labels)
        };
        assert!(said(-0.05, 0.04).starts_with("at low speed (velocities of"));
        assert!(said(-2.0, 10.0).starts_with("at velocities of"));
        assert!(said(0.5, 1.0).starts_with("at velocities of"));
    }
}
