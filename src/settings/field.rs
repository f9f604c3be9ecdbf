//! A setting: how it is found, read, written and shown. Console, store, command line and files all go through it.

use core::fmt;

use super::tree::{FIELDS, Settings};
use crate::decimal::{self, Decimal};

/// What a setting may be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// A number from `min` to `max`.
    Number {
        /// Least value.
        min: f32,
        /// Greatest value.
        max: f32,
    },
    /// One of these names; the value is its index.
    Choice(&'static [&'static str]),
}

/// Settings that belong together.
#[derive(Debug)]
pub struct Group {
    /// First part of their names.
    pub name: &'static str,
    /// What they are about.
    pub about: &'static str,
}

/// One setting.
#[derive(Debug)]
pub struct Field {
    /// Full name, with dots.
    pub name: &'static str,
    /// Short name, where there is one.
    pub short: Option<&'static str>,
    /// Unit of the value; empty for none.
    pub unit: &'static str,
    /// What it does.
    pub about: &'static str,
    /// What it may be.
    pub kind: Kind,
    pub(super) read: fn(&Settings) -> f32,
    pub(super) write: fn(&mut Settings, f32),
}

impl Field {
    /// The field of this full or short name.
    ///
    /// # Errors
    /// [`SettingError::Unknown`].
    pub fn find(name: &str) -> Result<&'static Self, SettingError> {
        FIELDS
            .iter()
            .find(|field| field.is_called(name))
            .ok_or(SettingError::Unknown)
    }

    /// The value, in [`Self::unit`]; of a choice, its index.
    pub fn read(&self, settings: &Settings) -> f32 {
        (self.read)(settings)
    }

    /// The value by default.
    pub fn default_value(&self) -> f32 {
        self.read(&Settings::default())
    }

    /// Sets the value.
    ///
    /// # Errors
    /// [`SettingError`], and nothing changes, for a value outside the bounds, NaN included.
    pub fn write(&'static self, settings: &mut Settings, value: f32) -> Result<(), SettingError> {
        self.check(value)?;
        (self.write)(settings, value);
        Ok(())
    }

    /// The value that a text stands for: a number, or the name of a choice.
    ///
    /// # Errors
    /// [`SettingError`] for a text that is neither, or a value outside the bounds.
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

    /// With its value in `settings`, as one shows it to people.
    pub fn shown(&'static self, settings: &Settings) -> Shown {
        Shown {
            field: self,
            value: self.read(settings),
        }
    }

    /// With its default, as one shows it to people.
    pub fn default_shown(&'static self) -> Shown {
        Shown {
            field: self,
            value: self.default_value(),
        }
    }
}

/// Some of the settings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FieldSet(u64);

const _: () = assert!(FIELDS.len() < u64::BITS as usize);

impl FieldSet {
    /// All settings.
    pub const ALL: Self = Self((1 << FIELDS.len()) - 1);

    /// The setting of this full or short name; or else all whose names begin like this, part by part: `e.s` begins
    /// `estimate.sensor`.
    ///
    /// # Errors
    /// [`SettingError::Unknown`] if there is none.
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

    /// The only one.
    ///
    /// # Errors
    /// [`SettingError::Ambiguous`] if there are more.
    pub fn only(self) -> Result<&'static Field, SettingError> {
        let mut fields = self.iter();
        match (fields.next(), fields.next()) {
            (Some(field), None) => Ok(field),
            _ => Err(SettingError::Ambiguous(self)),
        }
    }

    /// In the order in which they are shown.
    pub fn iter(self) -> impl Iterator<Item = &'static Field> {
        let places = FIELDS.iter().enumerate();
        places
            .filter(move |(place, _)| self.0 >> place & 1 == 1)
            .map(|(_, field)| field)
    }

    /// How many.
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

/// A setting with its value; its `Display` is `pid.kp = 0.05 N m/deg at the paddle`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shown {
    field: &'static Field,
    value: f32,
}

impl Shown {
    /// The value alone, as it can be set again.
    pub fn value(&self) -> impl fmt::Display {
        Value(*self)
    }

    /// The command that sets it again, with its unit as a remark.
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

/// A unit behind `separator`, if there is one.
fn with_unit(f: &mut fmt::Formatter<'_>, separator: &str, unit: &str) -> fmt::Result {
    if unit.is_empty() {
        return Ok(());
    }
    f.write_str(separator)?;
    f.write_str(unit)
}

/// Its `Display` is what a setting may be, as `0 to 2` or `encoder, hall`.
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

/// Why a setting is refused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SettingError {
    /// No setting has this name.
    Unknown,
    /// These all begin like this.
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
    /// Whether every value is within its bounds.
    ///
    /// # Errors
    /// The first [`SettingError`].
    pub fn check(&self) -> Result<(), SettingError> {
        FIELDS
            .iter()
            .try_for_each(|field| field.check(field.read(self)))
    }

    /// Sets by full or short name.
    ///
    /// # Errors
    /// [`SettingError`], and nothing changes.
    pub fn set(&mut self, name: &str, text: &str) -> Result<&'static Field, SettingError> {
        let field = Field::find(name)?;
        field.write(self, field.parse(text)?)?;
        Ok(field)
    }
}
