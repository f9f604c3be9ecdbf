//! The `.msg` text of ROS 2 message types (<https://docs.ros.org/en/rolling/Concepts/Basic/About-Interfaces.html>).

use std::collections::BTreeMap;

/// The type of a message and the types that it contains.
pub(super) struct Definitions {
    main: String,
    types: BTreeMap<String, Vec<Field>>,
}

/// A field of a type.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Field {
    pub name: String,
    pub kind: String,
    pub count: Count,
}

/// Number of values of a field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Count {
    One,
    Fixed(usize),
    Any,
}

impl Definitions {
    /// Parses the text of the type `main`. Other types follow after lines of `=`.
    pub fn parse(main: &str, text: &[u8]) -> Result<Self, String> {
        let text = std::str::from_utf8(text).map_err(|_| "its schema is no text".to_owned())?;
        let mut types = BTreeMap::new();
        let mut name = plain(main);
        let mut fields = Vec::new();
        for line in text.lines() {
            let line = line.split('#').next().unwrap_or_default().trim();
            if line.starts_with("====") {
                types.insert(std::mem::take(&mut name), std::mem::take(&mut fields));
            } else if let Some(other) = line.strip_prefix("MSG:") {
                name = plain(other.trim());
            } else {
                fields.extend(field(line));
            }
        }
        types.insert(name, fields);
        Ok(Self {
            main: plain(main),
            types,
        })
    }

    /// Fields of the message.
    pub fn main(&self) -> &[Field] {
        self.types.get(&self.main).map_or(&[], Vec::as_slice)
    }

    /// Fields of the type `kind`, which may be named relative to the package.
    pub fn fields(&self, kind: &str) -> Option<&[Field]> {
        let kind = plain(kind);
        let found = self.types.get(&kind).or_else(|| {
            // A type of the same package is named without the package.
            let last = format!("/{kind}");
            self.types
                .iter()
                .find(|(name, _)| name.ends_with(&last))
                .map(|(_, fields)| fields)
        });
        found.map(Vec::as_slice)
    }
}

/// Converts `package/msg/Type` to `package/Type`.
fn plain(name: &str) -> String {
    name.replace("/msg/", "/")
}

/// The field of a line. `None` for a constant, a comment or an empty line.
fn field(line: &str) -> Option<Field> {
    let mut words = line.split_whitespace();
    let (kind, name) = (words.next()?, words.next()?);
    if name.contains('=') || words.next().is_some_and(|word| word.starts_with('=')) {
        return None;
    }
    let (kind, count) = match kind.strip_suffix(']').and_then(|kind| kind.split_once('[')) {
        None => (kind, Count::One),
        Some((kind, size)) => (kind, size.parse().map_or(Count::Any, Count::Fixed)),
    };
    // The bound of a string does not affect its encoding.
    let kind = kind.split("<=").next().unwrap_or(kind);
    Some(Field {
        name: name.to_owned(),
        kind: kind.to_owned(),
        count,
    })
}
