//! Generates the page of each effect in `docs/effects` from the definition of the effect.

use crate::failure::Failure;
use crate::plot::{Cloud, Scatter};
use crate::report::missing_torque::scatter;
use gap::effects::{Demonstration, Description, Multisine, descriptions};
use gap::missing_torque::{Axis, Point};
use gap::{Device, MissingTorque};
use haptic_paddle::excitation::{Excitation, Shape};
use haptic_paddle::settings::Settings;
use host_sim::closed_loop::{ClosedLoop, LoopSetup};
use host_sim::effects::{Kind, Parameter};
use host_sim::experiment::{self, Experiment};
use host_sim::presets;
use std::fmt::Write;

/// Unit of the paddle's position.
const POSITION: &str = "rad";
const INPUT: &str = "N m";
/// Duration of the experiment in each picture, s.
const DURATION_S: f64 = 8.0;
const LOG_HZ: f64 = 1000.0;
/// Prediction window that the recording states, s.
const HORIZON_S: f64 = 0.5;
/// Most points per direction of motion in a picture, so that the file stays small.
const MOST_POINTS: usize = 60;
/// Share of the largest missing torque that an effect must explain for its line to be drawn.
const LEAST_EXPLAINED: f64 = 1e-3;
const GENERATED: &str = "<!-- Generated: cargo paddle effects --docs docs/effects -->\n\n";

/// All files with their names in the folder.
///
/// # Errors
/// Returns a [`Failure`] if a picture cannot be drawn.
pub fn files() -> Result<Vec<(String, String)>, Failure> {
    let all: Vec<Description> = descriptions().collect();
    let mut files = vec![("index.md".to_owned(), index(&all))];
    for effect in &all {
        let name = effect.kind.name;
        let scatter = picture(effect)?;
        let has_line = !scatter.explained_by.is_empty();
        files.push((format!("{name}.md"), page(effect, has_line)));
        files.push((format!("{name}.svg"), scatter.svg()?));
    }
    Ok(files)
}

fn index(all: &[Description]) -> String {
    let mut text = format!(
        "{GENERATED}# The effects\n\nA diagnosis names causes from this list. Each page has the equation, the sizes, a picture of \
         the torque that a model without the effect lacks, and what the effect is confused with.\n\n\
         | effect | part of the device | what it is |\n|---|---|---|\n"
    );
    for Description { kind, .. } in all {
        let row = format!(
            "| [`{0}`]({0}.md) | {1} | {2} |\n",
            kind.name,
            kind.channel.name(),
            kind.about
        );
        text.push_str(&row);
    }
    text
}

fn page(effect: &Description, has_line: bool) -> String {
    let kind = effect.kind;
    let name = kind.name;
    let mut text = format!(
        "{GENERATED}# `{name}`\n\n{}. A report calls it \"{}\". It belongs to the {}.\n\n## Equation\n\n```text\n{}\n```\n\n\
         ## Numbers\n\n| number | meaning | unit | default | typical | allowed |\n|---|---|---|---|---|---|\n",
        kind.about,
        effect.noun,
        kind.channel.name(),
        kind.equation
    );
    for parameter in kind.parameters {
        text.push_str(&row(parameter));
    }
    let demonstration = &effect.demonstration;
    let _ = write!(
        text,
        "\nThe typical sizes are for the paddle. {}\n\n## The missing torque\n\n\
         ![The torque that a model without {name} lacks]({name}.svg)\n\n\
         {} Each point is an instant at which the paddle moves: the torque that the nominal model lacks there, {}. \
         {}\n\n## What it is confused with\n\n{}\n{}\n\n## Try it\n\n\
         ```\npaddle sim multisine {} --seconds {DURATION_S} --log-rate {LOG_HZ} \
         --with {} --recording my-recording\npaddle gap look my-recording --report look.html\n```\n",
        kind.sizes_from,
        shown_by(kind, demonstration),
        over(effect.axis),
        line(has_line),
        confused_with(effect),
        effect.tell_apart,
        options(demonstration.multisine),
        switched_in(kind, demonstration),
    );
    text
}

/// Describes the line in a picture, or why there is none.
fn line(has_line: bool) -> &'static str {
    match has_line {
        true => "The line is the mean of what the effect adds to the model.",
        false => {
            "No line is drawn, because the effect is no torque of the instant alone: the points show the torque that a model \
             without it needs in its place."
        }
    }
}

/// Describes the excitation in a picture, and the parameters of its effect.
fn shown_by(kind: &Kind, demonstration: &Demonstration) -> String {
    let moved = match demonstration.multisine {
        Multisine::Position {
            amplitude_deg,
            frequency_hz,
        } => format!(
            "The simulated paddle follows a multisine of {amplitude_deg}° and {frequency_hz} Hz"
        ),
        Multisine::Torque {
            amplitude_nm,
            frequency_hz,
        } => format!(
            "The motor of the simulated paddle gives a multisine of {amplitude_nm} N m and {frequency_hz} Hz, without a controller,"
        ),
    };
    let numbers = demonstration.numbers.iter().map(|(name, value)| {
        let parameter = kind.parameters.iter().find(|p| p.name == *name);
        let unit = parameter.map_or(String::new(), |p| p.quantity.unit(POSITION, INPUT));
        match unit.as_str() {
            "1" => format!("`{name}` {value}"),
            unit => format!("`{name}` {value} {unit}"),
        }
    });
    let numbers: Vec<String> = numbers.collect();
    if numbers.is_empty() {
        return format!("{moved} with the effect at its default numbers.");
    }
    format!(
        "{moved} with the effect at {} and its other default numbers.",
        numbers.join(", ")
    )
}

/// The excitation as options of `paddle sim multisine`.
fn options(multisine: Multisine) -> String {
    match multisine {
        Multisine::Position {
            amplitude_deg,
            frequency_hz,
        } => format!("--amplitude {amplitude_deg} --frequency {frequency_hz}"),
        Multisine::Torque {
            amplitude_nm,
            frequency_hz,
        } => format!("--torque --amplitude {amplitude_nm} --frequency {frequency_hz}"),
    }
}

/// The multisine as an experiment.
fn experiment(multisine: Multisine) -> Experiment {
    let excitation = |amplitude, frequency_hz: f64| Excitation {
        shape: Shape::Multisine,
        amplitude,
        offset: 0.0,
        frequency_hz: frequency_hz as f32,
        end_frequency_hz: 0.0,
        duration_s: 0.0,
    };
    let experiment = match multisine {
        Multisine::Position {
            amplitude_deg,
            frequency_hz,
        } => {
            let amplitude_rad = amplitude_deg.to_radians() as f32;
            Experiment::position(excitation(amplitude_rad, frequency_hz), DURATION_S)
        }
        Multisine::Torque {
            amplitude_nm,
            frequency_hz,
        } => Experiment::torque(excitation(amplitude_nm as f32, frequency_hz), DURATION_S),
    };
    Experiment {
        log_hz: LOG_HZ,
        ..experiment
    }
}

/// The effect with the parameters of its demonstration, or else with its first parameter, as an argument of `--with`.
fn switched_in(kind: &Kind, demonstration: &Demonstration) -> String {
    let first = kind.parameters.first().map(|p| (p.name, p.default));
    let numbers = match demonstration.numbers {
        [] => first.as_slice(),
        numbers => numbers,
    };
    let settings: Vec<String> = numbers
        .iter()
        .map(|(name, value)| format!("{name}={value}"))
        .collect();
    let colon = if settings.is_empty() { "" } else { ":" };
    format!("{}{colon}{}", kind.name, settings.join(","))
}

fn row(parameter: &Parameter) -> String {
    let [low, high] = parameter.typical;
    format!(
        "| `{}` | {} | {} | {} | {low} to {high} | {} |\n",
        parameter.name,
        parameter.about,
        parameter.quantity.unit(POSITION, INPUT),
        parameter.default,
        allowed(parameter.range)
    )
}

fn allowed(range: [f64; 2]) -> String {
    match range {
        [f64::NEG_INFINITY, f64::INFINITY] => "any".into(),
        [f64::MIN_POSITIVE, f64::INFINITY] => "above 0".into(),
        [low, f64::INFINITY] => format!("{low} or more"),
        [f64::NEG_INFINITY, high] => format!("{high} or less"),
        [low, high] => format!("{low} to {high}"),
    }
}

/// Describes the horizontal axis of a picture.
fn over(axis: Axis) -> &'static str {
    match axis {
        Axis::Position => "over the position",
        Axis::Input => "over the torque of the input",
        Axis::Acceleration => "over the torque that the model accelerates with",
        Axis::Time => "over time",
        Axis::Load => "against the motion, over the size of the torque of the input",
        Axis::DirectionAndPosition => "against the motion, over the position",
        Axis::Wave => "over the position within a wave",
        _ => "over the velocity",
    }
}

/// The list of related effects. It is empty if there are none.
fn confused_with(effect: &Description) -> String {
    let relations = [
        ("For some of its numbers it is", &effect.special_cases),
        ("It is a special case of", &effect.special_case_of),
        (
            "Where it explains nearly as much, this simpler effect is named instead:",
            &effect.simpler_substitutes,
        ),
        (
            "These do nearly the same on small, slow motion:",
            &effect.near_equivalents,
        ),
    ];
    let mut text = String::new();
    for (words, names) in relations {
        if !names.is_empty() {
            let links = names.iter().map(|name| format!("[`{name}`]({name}.md)"));
            let _ = writeln!(text, "- {words} {}.", links.collect::<Vec<_>>().join(", "));
        }
    }
    text
}

/// The torque that the nominal model lacks for a paddle with the effect. A line is added if the effect explains part of it.
fn picture(effect: &Description) -> Result<Scatter, Failure> {
    let kind = effect.kind;
    let value = |parameter: &Parameter| {
        let mut numbers = effect.demonstration.numbers.iter();
        let shown = numbers.find(|(name, _)| *name == parameter.name);
        shown.map_or(parameter.default, |(_, value)| *value)
    };
    let values: Vec<f64> = kind.parameters.iter().map(value).collect();
    let model = presets::nominal();
    let mut device = Device::nominal(&model);
    kind.install(&mut device, &values);
    let setup = LoopSetup::ideal(device.clone(), Settings::default());
    let experiment = experiment(effect.demonstration.multisine);
    let mut closed_loop = ClosedLoop::armed(&setup, experiment.mode)?;
    let trace = experiment.run(&mut closed_loop)?;
    let mut recording = experiment::recording(kind.name, HORIZON_S, model, &setup);
    recording.runs.push(trace.to_run("multisine.csv", &setup));
    let missing = MissingTorque::of(&recording, &Device::nominal(&recording.model));
    let mut look = missing.look(Some((&device, vec![kind.name])));
    look.axis = effect.axis;
    let mut scatter = scatter(&look, kind.name, POSITION);
    let size = |of: fn(&Point) -> f64| look.points.iter().map(of).fold(0.0, |a, b| b.abs().max(a));
    let has_line = size(|point| point.explained) > LEAST_EXPLAINED * size(|point| point.torque);
    if !has_line {
        scatter.explained_by.clear();
    }
    for cloud in &mut scatter.clouds {
        *cloud = Cloud {
            points: thinned(&cloud.points),
            explained: match has_line {
                true => std::mem::take(&mut cloud.explained),
                false => Vec::new(),
            },
            rest: Vec::new(),
            ..std::mem::take(cloud)
        };
    }
    Ok(scatter)
}

fn thinned(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let step = points.len().div_ceil(MOST_POINTS).max(1);
    points.iter().step_by(step).copied().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;
    use std::path::Path;

    #[test]
    fn the_pages_of_the_effects_are_those_that_are_generated() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/effects");
        let files = files().unwrap();
        for (name, text) in &files {
            let committed = std::fs::read_to_string(folder.join(name)).unwrap_or_default();
            assert!(
                committed == *text,
                "docs/effects/{name} is old; make it anew: cargo paddle effects --docs docs/effects"
            );
        }
        let there = std::fs::read_dir(&folder).unwrap();
        let there = there.map(|entry| entry.unwrap().file_name().into_string().unwrap());
        let made = files.iter().map(|(name, _)| name.clone());
        assert_eq!(there.collect::<BTreeSet<_>>(), made.collect());
    }
}
