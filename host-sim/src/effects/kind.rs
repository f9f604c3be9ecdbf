//! A kind of effect: its name, its parameters, and how it changes a device.

use super::EffectError;
use super::quantity::Parameter;
use crate::device::Device;
use crate::plant::{Law, TorqueLaw};
use core::ops::Range;
use std::sync::Arc;

/// The part of a device that an effect changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Channel {
    /// The path from the input to the torque.
    Actuation,
    /// Friction.
    Friction,
    /// Inertia, elasticity, stops.
    Mechanics,
    /// The path from the position to its reading.
    Sensing,
    /// Objects outside the device.
    Surroundings,
}

impl Channel {
    /// The name in the recording contract.
    pub fn name(self) -> &'static str {
        match self {
            Self::Actuation => "actuation",
            Self::Friction => "friction",
            Self::Mechanics => "mechanics",
            Self::Sensing => "sensing",
            Self::Surroundings => "surroundings",
        }
    }
}

/// A kind of effect.
#[derive(Debug)]
pub struct Kind {
    /// The name in the recording contract.
    pub name: &'static str,
    /// The part of the device that it changes.
    pub channel: Channel,
    /// Description in one sentence.
    pub about: &'static str,
    /// Its equation.
    pub equation: &'static str,
    /// Source of the typical parameter values.
    pub sizes_from: &'static str,
    /// Its parameters, in the order in which `install` takes their values. Further values repeat the parameters of
    /// [`Events`], once per additional event.
    pub parameters: &'static [Parameter],
    /// Applies the effect to a device. The values must be in their ranges.
    pub(super) install: fn(&mut Device, &[f64]),
    /// The parameters that may be repeated. `None` if there are none.
    pub(super) events: Option<Events>,
    /// Its torque, if it is given as a law.
    pub(super) law: Option<&'static dyn TorqueLaw>,
}

/// A kind without parameters and without effect. It completes definitions that do not set all fields.
pub(super) const PLAIN: Kind = Kind {
    name: "",
    channel: Channel::Mechanics,
    about: "",
    equation: "",
    sizes_from: "",
    parameters: &[],
    install: |_, _| {},
    events: None,
    law: None,
};

/// Parameters that may be repeated: those of an event, or of one wave of a ripple.
#[derive(Debug)]
pub(super) struct Events {
    /// Indices of the parameters of one event.
    pub places: Range<usize>,
    /// Largest number of events.
    pub most: usize,
    /// True if the effect with these values acts only during its events.
    pub alone: fn(&[f64]) -> bool,
    /// Indices of start and end time, s of the session, within the parameters of one event. `None` if an event does not end.
    pub instants: Option<[usize; 2]>,
}

impl Kind {
    /// Applies the effect to a device. Values outside their range are set to its nearer end.
    pub fn install(&self, device: &mut Device, values: &[f64]) {
        let values = self.held(values);
        (self.install)(device, &values);
        if let Some(law) = self.law {
            let law = Law::new(Arc::new(law), values, device.drive.ratio);
            device.mechanics.laws.push(law);
        }
    }

    /// The values, with those outside their range set to its nearer end.
    pub fn held(&self, values: &[f64]) -> Vec<f64> {
        let values = values.iter().enumerate();
        let held = values.map(|(place, value)| {
            let [low, high] = self.parameter(place).range;
            value.max(low).min(high)
        });
        held.collect()
    }

    /// Checks a value for the parameter at index `place`. `name` is the parameter's name as the user wrote it.
    ///
    /// # Errors
    ///
    /// [`EffectError::Range`] if the value is outside the range.
    pub fn checked(&self, place: usize, name: &str, value: f64) -> Result<f64, EffectError> {
        let [low, high] = self.parameter(place).range;
        if value.is_finite() && (low..=high).contains(&value) {
            return Ok(value);
        }
        let mend = match [low, high] {
            [f64::MIN_POSITIVE, f64::INFINITY] => "a number above 0".to_owned(),
            [f64::NEG_INFINITY, f64::INFINITY] => "a finite number".to_owned(),
            [low, f64::INFINITY] => format!("{low} or more"),
            [low, high] => format!("one from {low} to {high}"),
        };
        Err(EffectError::Range {
            kind: self.name,
            name: name.to_owned(),
            value,
            mend,
        })
    }

    /// The parameter of the value at index `place`. Repeated events have more values than parameters.
    pub fn parameter(&self, place: usize) -> &'static Parameter {
        let Range { start, end } = self.repeated();
        let again = |beyond: usize| start + beyond % (end - start).max(1);
        let beyond = place.checked_sub(self.parameters.len());
        &self.parameters[beyond.map_or(place, again)]
    }

    /// Name of the value at index `place` of an effect with `count` values. Names of repeated events are numbered from 1.
    pub fn value_name(&self, place: usize, count: usize) -> String {
        let once = self.parameters.len();
        let name = self.parameter(place).name;
        match place.checked_sub(once) {
            Some(beyond) => format!("{name}_{}", beyond / self.repeated().len().max(1) + 2),
            None if count > once && self.repeated().contains(&place) => format!("{name}_1"),
            None => name.to_owned(),
        }
    }

    /// Indices of the parameters of one event. Empty if they cannot be repeated.
    fn repeated(&self) -> Range<usize> {
        self.events.as_ref().map_or(0..0, |e| e.places.clone())
    }

    /// Largest number of events.
    pub fn most_events(&self) -> usize {
        self.events.as_ref().map_or(1, |e| e.most)
    }

    /// Names of all values of an effect. The number of events is the highest number at the end of the names in `wanted`.
    pub fn value_names(&self, wanted: &[&str]) -> Vec<String> {
        let number = |name: &&str| name.rsplit_once('_')?.1.parse().ok();
        let named = wanted.iter().filter_map(number).max().unwrap_or(1);
        // Each event needs a numbered name of its own, so there cannot be more events than names.
        let most = self.most_events().min(wanted.len()).max(1);
        let count = self.event_place(named.clamp(1, most));
        let places = 0..count;
        places.map(|place| self.value_name(place, count)).collect()
    }

    /// True if the effect with these values acts only during events of one session.
    pub fn is_event(&self, values: &[f64]) -> bool {
        self.events.as_ref().is_some_and(|e| (e.alone)(values))
    }

    /// Times during which the effect with these values acts, s of the session. `None` if it acts at all times.
    pub fn meanwhile(&self, values: &[f64]) -> Option<Vec<[f64; 2]>> {
        let instants = self.instants()?;
        let places = (0..self.event_count(values)).map(|event| self.event_place(event));
        Some(
            places
                .map(|place| instants.map(|i| values[place + i]))
                .collect(),
        )
    }

    /// Indices of start and end time within the parameters of one event. `None` if the effect acts at all times or its
    /// events do not end.
    pub fn instants(&self) -> Option<[usize; 2]> {
        self.events.as_ref()?.instants
    }

    /// Number of events with these values.
    pub fn event_count(&self, values: &[f64]) -> usize {
        let counted = (0..).take_while(|event| self.event_place(*event) < values.len());
        counted.count()
    }

    /// Index of the first value of event number `index`.
    pub fn event_place(&self, index: usize) -> usize {
        match index.checked_sub(1) {
            Some(before) => self.parameters.len() + self.repeated().len() * before,
            None => self.repeated().start,
        }
    }

    /// Values of an effect with these events. All other parameters have their defaults.
    pub fn events<const N: usize>(&self, events: &[[f64; N]]) -> Vec<f64> {
        let count = self.event_place(events.len().max(1));
        let mut values: Vec<f64> = (0..count).map(|i| self.parameter(i).default).collect();
        for (index, event) in events.iter().enumerate() {
            let place = self.event_place(index);
            values[place..place + N].copy_from_slice(event);
        }
        values
    }
}
