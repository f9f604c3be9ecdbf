//! One setting: lookup, read, write and display. Console, store, command line and files use it.

use core::fmt;

use super::tree::{FIELDS, Settings};
use crate::decimal::{self, Decimal};

/// Allowed values of a setting.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// A number from `min` to `max`.
    Number {
        /// Smallest value.
        min: f32,
        /// Largest value.
        max: f32,
    },
    /// One of these names. The numeric value is its index.
    Choice(&'static [&'static str]),
}

/// A group of settings.
#[derive(Debug)]
pub struct Group {
    /// First part of their names.
    pub name: &'static str,
    /// Description of the group.
    pub about: &'static str,
}

/// One setting.
#[derive(Debug)]
pub struct Field {
    /// Full name, with dots.
    pub name: &'static str,
    /// Short name, if any.
    pub short: Option<&'static str>,
    /// Unit of the value. Empty if there is none.
    pub unit: &'static str,
    /// Description of the setting.
    pub about: &'static str,
    /// Allowed values.
    pub kind: Kind,
    pub(super) read: fn(&Settings) -> f32,
    pub(super) write: fn(&mut Settings, f32),
}

impl Field {
    /// Finds the setting with this full or short name.
    ///
    /// # Errors
    ///
    /// [`SettingError::Unknown`].
    pub fn find(name: &str) -> Result<&'static Self, SettingError> {
        FIELDS
            .iter()
            .find(|field| field.is_called(name))
            .ok_or(SettingError::Unknown)
    }

    /// The value in [`Self::unit`]. For a choice it is the index.
    pub fn read(&self, settings: &Settings) -> f32 {
        (self.read)(settings)
    }

    /// The default value.
    pub fn default_value(&self) -> f32 {
        self.read(&Settings::default())
    }

    /// Sets the value.
    ///
    /// # Errors
    ///
    /// [`SettingError`] for a value outside the bounds or NaN. Nothing is changed in that case.
    pub fn write(&'static self, settings: &mut Settings, value: f32) -> Result<(), SettingError> {
        self.check(value)?;
        (self.write)(settings, value);
        Ok(())
    }

    /// Parses a value: a number, or the name of a choice.
    ///
    /// # Errors
    ///
    /// [`SettingError`] for a text that is neither, or for a value outside the bounds.
    pub fn parse(&'static self, text: &str) -> Result<f32, SettingError> {
        let named = match self.kind {
            Kind::Choice(names) => names
                .iter()
                .position(|name| *name == text)
                .map(|index| index as f32),
            Kind::Number { .. } => None,
        };
        let value = match named {
            Some(index) => index,
            None => decimal::parse(text).ok_or_else(|| self.refusal())?,
        };
        self.check(value)?;
        Ok(value)
    }

    fn check(&'static self, value: f32) -> Result<(), SettingError> {
        let fits = match self.kind {
            Kind::Number { min, max } => value >= min && value <= max,
            Kind::Choice(names) => (0..names.len()).any(|index| index as f32 == value),
        };
        if fits { Ok(()) } else { Err(self.refusal()) }
    }

    fn refusal(&'static self) -> SettingError {
        match self.kind {
            Kind::Number { .. } => SettingError::OutOfRange(self),
            Kind::Choice(_) => SettingError::NotAChoice(self),
        }
    }

    /// The setting with its value in `settings`, for display.
    pub fn shown(&'static self, settings: &Settings) -> Shown {
        Shown {
            field: self,
            value: self.read(settings),
        }
    }

    /// The setting with its default value, for display.
    pub fn default_shown(&'static self) -> Shown {
        Shown {
            field: self,
            value: self.default_value(),
        }
    }
}

/// A set of settings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FieldSet(u64);

const _: () = assert!(FIELDS.len() < u64::BITS as usize);

impl FieldSet {
    /// All settings.
    pub const ALL: Self = Self((1 << FIELDS.len()) - 1);

    /// Finds the setting with this full or short name. Otherwise finds all settings whose name begins with `text` part by
    /// part: `e.s` matches `estimate.sensor`.
    ///
    /// # Errors
    ///
    /// [`SettingError::Unknown`] if none matches.
    pub fn named(text: &str) -> Result<Self, SettingError> {
        let places_where = |is: &dyn Fn(&Field) -> bool| {
            let places = FIELDS.iter().enumerate();
            Self(
                places
                    .filter(|(_, field)| is(field))
                    .fold(0, |bits, (place, _)| bits | 1 << place),
            )
        };
        let exact = places_where(&|field| field.is_called(text));
        let found = if exact.0 == 0 {
            places_where(&|field| field.begins_like(text))
        } else {
            exact
        };
        if found.0 == 0 {
            return Err(SettingError::Unknown);
        }
        Ok(found)
    }

    /// The only setting of the set.
    ///
    /// # Errors
    ///
    /// [`SettingError::Ambiguous`] if there are several.
    pub fn only(self) -> Result<&'static Field, SettingError> {
        let mut fields = self.iter();
        match (fields.next(), fields.next()) {
            (Some(field), None) => Ok(field),
            _ => Err(SettingError::Ambiguous(self)),
        }
    }

    /// The settings in the order of display.
    pub fn iter(self) -> impl Iterator<Item = &'static Field> {
        let places = FIELDS.iter().enumerate();
        places
            .filter(move |(place, _)| self.0 >> place & 1 == 1)
            .map(|(_, field)| field)
    }

    /// Number of settings.
    pub fn count(self) -> usize {
        self.0.count_ones() as usize
    }
}

impl Field {
    fn is_called(&self, text: &str) -> bool {
        self.name == text || self.short == Some(text)
    }

    fn begins_like(&self, text: &str) -> bool {
        let mut parts = self.name.split('.');
        text.split('.')
            .all(|typed| parts.next().is_some_and(|part| part.starts_with(typed)))
    }
}

impl PartialEq for Field {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

/// A setting with its value. Its `Display` is, for example, `pid.kp = 0.05 N m/deg at the paddle`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shown {
    field: &'static Field,
    value: f32,
}

impl Shown {
    /// The value alone, in the form in which it can be set.
    pub fn value(&self) -> impl fmt::Display {
        Value(*self)
    }

    /// The command that sets this value, with the unit as a comment.
    pub fn as_command(&self) -> impl fmt::Display {
        AsCommand(*self)
    }
}

impl fmt::Display for Shown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} = {}", self.field.name, Value(*self))?;
        with_unit(f, " ", self.field.unit)
    }
}

struct Value(Shown);

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Shown { field, value } = self.0;
        match field.kind {
            Kind::Choice(names) => f.write_str(names.get(value as usize).copied().unwrap_or("?")),
            Kind::Number { .. } => Decimal(value).fmt(f),
        }
    }
}

struct AsCommand(Shown);

impl fmt::Display for AsCommand {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "set {} {}", self.0.field.name, Value(self.0))?;
        with_unit(f, " # ", self.0.field.unit)
    }
}

/// Writes `separator` and the unit, if there is one.
fn with_unit(f: &mut fmt::Formatter<'_>, separator: &str, unit: &str) -> fmt::Result {
    if unit.is_empty() {
        return Ok(());
    }
    f.write_str(separator)?;
    f.write_str(unit)
}

/// Displays the allowed values, for example `0 to 2` or `encoder, hall`.
impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number { min, max } => write!(f, "{} to {}", Decimal(*min), Decimal(*max)),
            Self::Choice(names) => names.iter().enumerate().try_for_each(|(place, name)| {
                f.write_str(if place > 0 { ", " } else { "" })?;
                f.write_str(name)
            }),
        }
    }
}

/// Why a setting or its value is refused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SettingError {
    /// No setting has this name.
    Unknown,
    /// All these settings match.
    Ambiguous(FieldSet),
    /// The value is not a number within the bounds.
    OutOfRange(&'static Field),
    /// The value is none of the names.
    NotAChoice(&'static Field),
}

impl fmt::Display for SettingError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unknown => f.write_str("no such setting: get lists them all"),
            Self::Ambiguous(fields) => {
                f.write_str("write more of the name, it may be")?;
                fields
                    .iter()
                    .try_for_each(|field| write!(f, " {}", field.name))
            }
            Self::OutOfRange(field) => {
                write!(f, "{} must be a number from {}", field.name, field.kind)?;
                with_unit(f, " ", field.unit)
            }
            Self::NotAChoice(field) => write!(f, "{} must be one of {}", field.name, field.kind),
        }
    }
}

impl core::error::Error for SettingError {}

impl Settings {
    /// Checks that every value is within its bounds.
    ///
    /// # Errors
    ///
    /// The first [`SettingError`].
    pub fn check(&self) -> Result<(), SettingError> {
        FIELDS
            .iter()
            .try_for_each(|field| field.check(field.read(self)))
    }

    /// Sets a setting by its full or short name.
    ///
    /// # Errors
    ///
    /// [`SettingError`]. Nothing is changed in that case.
    pub fn set(&mut self, name: &str, text: &str) -> Result<&'static Field, SettingError> {
        let field = Field::find(name)?;
        field.write(self, field.parse(text)?)?;
        Ok(field)
    }
}
