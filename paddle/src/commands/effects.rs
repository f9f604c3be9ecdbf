//! `paddle effects`: lists the effects that can be added to the simulated paddle.

use crate::answer::Answer;
use crate::effect_page;
use crate::failure::Failure;
use crate::files::Folder;
use crate::targets::{Target, Use};
use clap::Args;
use host_sim::effects::{self, EffectError, KINDS, Kind};
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Options of the command.
#[derive(Args)]
#[command(after_help = "Examples:\n  paddle effects\n  paddle effects stribeck")]
pub struct Arguments {
    /// List only the effect with this name.
    name: Option<String>,
    /// Write the documentation page and the picture of each effect to this folder.
    #[arg(long, value_name = "DIR", hide = true, conflicts_with = "name")]
    docs: Option<PathBuf>,
}

impl Arguments {
    /// Paths that the command writes.
    pub fn targets(&self) -> Vec<Target<'_>> {
        let docs = Target::of("--docs", Use::Folder, self.docs.as_ref());
        docs.into_iter().collect()
    }
}

/// Unit of the paddle's position.
const POSITION: &str = "rad";
const INPUT: &str = "N m";

/// Lists the effects, or writes their pages.
///
/// # Errors
/// Returns a [`Failure`] if no effect has the given name, or if a page cannot be written.
pub fn run(arguments: &Arguments) -> Result<Answer, Failure> {
    if let Some(folder) = &arguments.docs {
        return write_pages(folder);
    }
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

fn write_pages(folder: &Path) -> Result<Answer, Failure> {
    let mut folder = Folder::new(folder);
    for (name, text) in effect_page::files()? {
        folder.put(name, &text);
    }
    Ok(Answer {
        text: format!(
            "{} files in {}\n",
            folder.files().len(),
            folder.path().display()
        ),
        json: json!({ "files": folder.files() }),
        problems: folder.lost(),
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
