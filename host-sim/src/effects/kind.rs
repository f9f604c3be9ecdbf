//! A kind of effect: its name, its numbers and how it is put into a device.

use super::EffectError;
use super::quantity::Parameter;
use crate::device::Device;
use crate::plant::{Law, TorqueLaw};
use core::ops::Range;
use std::sync::Arc;

/// Part of a device that an effect sits in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Channel {
    /// From the input to the torque.
    Actuation,
    /// What resists motion.
    Friction,
    /// Inertia, elasticity, stops.
    Mechanics,
    /// From the position to its reading.
    Sensing,
    /// Outside the device.
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
    /// Where it sits.
    pub channel: Channel,
    /// In one sentence.
    pub about: &'static str,
    /// Its equation.
    pub equation: &'static str,
    /// Where the typical sizes of its numbers come from.
    pub sizes_from: &'static str,
    /// Its numbers, in the order in which `install` takes them. Further values repeat those of [`Events`], once for
    /// each further event.
    pub parameters: &'static [Parameter],
    /// Puts it into a device, with numbers in their ranges.
    pub(super) install: fn(&mut Device, &[f64]),
    /// The parameters that may be repeated; `None` if there are none.
    pub(super) events: Option<Events>,
    /// Its torque, if it is given as a law.
    pub(super) law: Option<&'static dyn TorqueLaw>,
}

/// A kind without parameters that changes nothing: the rest of a definition that does not need all fields.
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

/// Parameters of an effect that may be repeated: those of an event at a moment of the session, or of one wave of a ripple.
#[derive(Debug)]
pub(super) struct Events {
    /// Places of what is said of each time.
    pub places: Range<usize>,
    /// How often it may happen.
    pub most: usize,
    /// True if with these values it acts at these moments alone.
    pub alone: fn(&[f64]) -> bool,
    /// Places of the instants from when to when it acts, s of the session, among what is said of each time; none if it stays for ever.
    pub instants: Option<[usize; 2]>,
}

impl Kind {
    /// Puts it into a device. Numbers beyond their range are taken at its end.
    pub fn install(&self, device: &mut Device, values: &[f64]) {
        let values = self.held(values);
        (self.install)(device, &values);
        if let Some(law) = self.law {
            let law = Law::new(Arc::new(law), values, device.drive.ratio);
            device.mechanics.laws.push(law);
        }
    }

    /// The numbers, those beyond their range at its end.
    pub fn held(&self, values: &[f64]) -> Vec<f64> {
        let values = values.iter().enumerate();
        let held = values.map(|(place, value)| {
            let [low, high] = self.parameter(place).range;
            value.max(low).min(high)
        });
        held.collect()
    }

    /// A number written as `name` for the value at `place`.
    ///
    /// # Errors
    /// [`EffectError::Range`] if it has no meaning there.
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

    /// The parameter of the value at `place`; there are more values than parameters where something happens more than once.
    pub fn parameter(&self, place: usize) -> &'static Parameter {
        let Range { start, end } = self.repeated();
        let again = |beyond: usize| start + beyond % (end - start).max(1);
        let beyond = place.checked_sub(self.parameters.len());
        &self.parameters[beyond.map_or(place, again)]
    }

    /// Name of the value at `place` of an effect of this kind that has `count` of them; what happens more than once is
    /// numbered from 1.
    pub fn value_name(&self, place: usize, count: usize) -> String {
        let once = self.parameters.len();
        let name = self.parameter(place).name;
        match place.checked_sub(once) {
            Some(beyond) => format!("{name}_{}", beyond / self.repeated().len().max(1) + 2),
            None if count > once && self.repeated().contains(&place) => format!("{name}_1"),
            None => name.to_owned(),
        }
    }

    /// Places of what is said of each time that it happens; none if it always does.
    fn repeated(&self) -> Range<usize> {
        self.events.as_ref().map_or(0..0, |e| e.places.clone())
    }

    /// How often something may happen.
    pub fn most_events(&self) -> usize {
        self.events.as_ref().map_or(1, |e| e.most)
    }

    /// Names of the values of an effect that happens as often as the numbers of those that are `wanted` say, which may be others.
    pub fn value_names(&self, wanted: &[&str]) -> Vec<String> {
        let number = |name: &&str| name.rsplit_once('_')?.1.parse().ok();
        let told = wanted.iter().filter_map(number).max().unwrap_or(1);
        // Each event needs a number of its own, so that there are no more events than numbers.
        let most = self.most_events().min(wanted.len()).max(1);
        let count = self.event_place(told.clamp(1, most));
        let places = 0..count;
        places.map(|place| self.value_name(place, count)).collect()
    }

    /// True if with these values it acts at moments of one session alone.
    pub fn is_event(&self, values: &[f64]) -> bool {
        self.events.as_ref().is_some_and(|e| (e.alone)(values))
    }

    /// When it acts with these values, s of the session; none if at all times.
    pub fn meanwhile(&self, values: &[f64]) -> Option<Vec<[f64; 2]>> {
        let instants = self.instants()?;
        let places = (0..self.event_count(values)).map(|event| self.event_place(event));
        Some(
            places
                .map(|place| instants.map(|i| values[place + i]))
                .collect(),
        )
    }

    /// Places of the instants from when to when it acts among what is said of each time; none if it acts at all times or stays for
    /// ever.
    pub fn instants(&self) -> Option<[usize; 2]> {
        self.events.as_ref()?.instants
    }

    /// How often it happens with these values.
    pub fn event_count(&self, values: &[f64]) -> usize {
        let counted = (0..).take_while(|event| self.event_place(*event) < values.len());
        counted.count()
    }

    /// Place of the first value of the event `index`.
    pub fn event_place(&self, index: usize) -> usize {
        match index.checked_sub(1) {
            Some(before) => self.parameters.len() + self.repeated().len() * before,
            None => self.repeated().start,
        }
    }

    /// The values of an effect that does nothing but happen so, each time with these values.
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
