//! Completion of a word by the Tab key.

use super::command::{COMMANDS, find};
use crate::excitation::Shape;
use crate::settings::{FIELDS, FieldSet, Kind};

/// The possible completions of a word.
#[derive(Clone, Copy, Debug)]
pub struct Completion<'a> {
    begun: &'a str,
    commands: bool,
    settings: bool,
    words: &'static [&'static str],
}

static SHAPES: [&str; Shape::NAMED.len()] = {
    let mut names = [""; Shape::NAMED.len()];
    let mut place = 0;
    while place < names.len() {
        names[place] = Shape::NAMED[place].0;
        place += 1;
    }
    names
};

impl<'a> Completion<'a> {
    /// The completions of the last word in the beginning of a line.
    pub fn of(line: &'a str) -> Self {
        let (before, begun) = line.rsplit_once(' ').unwrap_or(("", line));
        let mut words = before.split_ascii_whitespace();
        let mut completion = Self {
            begun,
            commands: false,
            settings: false,
            words: &[],
        };
        let command = words.next();
        let second = words.next();
        match (command, second) {
            (None, _) => completion.commands = true,
            (Some(command), None) => match find(command).map(|usage| usage.name) {
                Ok("help") => {
                    completion.commands = true;
                    completion.settings = true;
                }
                Ok("get" | "set") => completion.settings = true,
                Ok("start") => completion.words = &SHAPES,
                Ok("arm") => completion.words = &["position", "torque"],
                Ok("hall") => completion.words = &["cal"],
                Ok("motor") => completion.words = &["id"],
                Ok("zero") => completion.words = &["hall"],
                _ => {}
            },
            (Some(command), Some(name)) if words.next().is_none() => {
                if let Ok("set") = find(command).map(|usage| usage.name)
                    && let Ok(field) = FieldSet::named(name).and_then(FieldSet::only)
                    && let Kind::Choice(names) = field.kind
                {
                    completion.words = names;
                }
            }
            _ => {}
        }
        completion
    }

    /// The possible full words.
    pub fn candidates(self) -> impl Iterator<Item = &'static str> + use<'a> {
        let commands = COMMANDS.iter().map(|usage| usage.name);
        let settings = FIELDS.iter().map(|field| field.name);
        commands
            .filter(move |_| self.commands)
            .chain(settings.filter(move |_| self.settings))
            .chain(self.words.iter().copied())
            .filter(move |name| name.starts_with(self.begun))
    }

    /// The common continuation of all candidates, and true if there is only one candidate.
    pub fn rest(self) -> (&'static str, bool) {
        let mut candidates = self.candidates();
        let Some(first) = candidates.next() else {
            return ("", false);
        };
        let mut length = first.len();
        let mut only = true;
        for other in candidates {
            only = false;
            let common = first.bytes().zip(other.bytes()).take_while(|(a, b)| a == b);
            length = length.min(common.count());
        }
        (
            first.get(self.begun.len()..length).unwrap_or_default(),
            only,
        )
    }
}
