//! `paddle effects`: what can be switched into the simulated paddle.

use crate::answer::Answer;
use crate::failure::Failure;
use clap::Args;
use host_sim::effects::{self, EffectError, KINDS, Kind};
use serde_json::{Value, json};
use std::fmt::Write;

/// Which effects.
#[derive(Args)]
#[command(after_help = "Examples:\n  paddle effects\n  paddle effects stribeck")]
pub struct Arguments {
    /// Only this one.
    name: Option<String>,
}

/// Units of the paddle.
const POSITION: &str = "rad";
const INPUT: &str = "N m";

/// Lists the effects.
///
/// # Errors
/// If there is none of that name.
pub fn run(arguments: &Arguments) -> Result<Answer, Failure> {
    let kinds: Vec<&Kind> = match &arguments.name {
        Some(name) => vec![effects::kind(name).ok_or_else(|| EffectError::Kind(name.clone()))?],
        None => KINDS.to_vec(),
    };
    Ok(Answer {
        text: kinds
            .iter()
            .map(|kind| text(kind))
            .collect::<Vec<_>>()
            .join("\n"),
        json: json!({ "effects": kinds.iter().map(|kind| json(kind)).collect::<Vec<_>>() }),
        ..Answer::default()
    })
}

fn text(kind: &Kind) -> String {
    let mut text = format!(
        "{} ({})\n  {}.\n  {}\n",
        kind.name,
        kind.channel.name(),
        kind.about,
        kind.equation
    );
    for parameter in kind.parameters {
        let [low, high] = parameter.typical;
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "    {:<20} {:>8} {:<12} typically {low} to {high}; {}",
            parameter.name,
            parameter.default,
            parameter.quantity.unit(POSITION, INPUT),
            parameter.about
        );
    }
    if kind.most_events() > 1 {
        let count = kind.event_place(2);
        let names = (0..count).map(|place| (place, kind.value_name(place, count)));
        let numbered = names.filter(|(place, name)| *name != kind.parameter(*place).name);
        let names: Vec<_> = numbered.map(|(_, name)| name).collect();
        let _ = writeln!(text, "    more than once: {}, …", names.join(", "));
    }
    let first = kind.parameters.first();
    let setting = first.map_or(String::new(), |p| format!(":{}={}", p.name, p.default));
    let _ = writeln!(text, "  paddle sim step --with {}{setting}", kind.name);
    text
}

fn json(kind: &Kind) -> Value {
    let parameters: Vec<_> = kind
        .parameters
        .iter()
        .map(|parameter| {
            json!({
                "name": parameter.name,
                "unit": parameter.quantity.unit(POSITION, INPUT),
                "default": parameter.default,
                "typical": parameter.typical,
                "about": parameter.about,
            })
        })
        .collect();
    json!({
        "name": kind.name,
        "channel": kind.channel.name(),
        "about": kind.about,
        "equation": kind.equation,
        "parameters": parameters,
    })
}
