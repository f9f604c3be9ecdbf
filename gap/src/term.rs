//! An instance of an effect: its numbers, and which of them a fit may move.

use host_sim::effects::{Kind, Parameter, Quantity};

/// How a dimensionless coordinate becomes a parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Scale {
    /// `start + scale · x`.
    Linear(f64),
    /// `start · e^(0.6 x)`.
    Log,
}

/// Logarithm that one unit of a coordinate stands for.
const LOG_UNIT: f64 = 0.6;
/// Units within which coordinates stay: a factor of 20, as many scales of a size, but near the place where something was
/// looked for.
const LOG_REACH: f64 = 5.0;
const SIZE_REACH: f64 = 20.0;
const PLACE_REACH: f64 = 5.0;

/// One free parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Coordinate {
    /// Place among the parameters of its effect.
    pub parameter: usize,
    pub start: f64,
    pub scale: Scale,
}

impl Coordinate {
    pub(crate) fn value(&self, x: f64) -> f64 {
        match self.scale {
            Scale::Linear(scale) => self.start + scale * x,
            Scale::Log => self.start * (LOG_UNIT * x).exp(),
        }
    }

    /// Lowest and highest coordinate.
    pub(crate) fn reach(&self, of: &Parameter) -> [f64; 2] {
        let (farthest, bounds) = match self.scale {
            Scale::Linear(scale) => {
                let farthest = match of.quantity {
                    Quantity::Position | Quantity::Time => PLACE_REACH,
                    _ => SIZE_REACH,
                };
                (farthest, of.range.map(|v| (v - self.start) / scale))
            }
            Scale::Log => (
                LOG_REACH,
                of.range.map(|v| (v / self.start).ln() / LOG_UNIT),
            ),
        };
        [bounds[0].max(-farthest), bounds[1].min(farthest)]
    }

    /// Standard deviation of the parameter for one of the coordinate.
    pub(crate) fn spread(&self, x: f64, std: f64) -> f64 {
        match self.scale {
            Scale::Linear(scale) => scale.abs() * std,
            Scale::Log => LOG_UNIT * self.value(x).abs() * std,
        }
    }
}

/// An effect of which some parameters are free.
#[derive(Clone, Debug)]
pub(crate) struct Term {
    pub kind: &'static Kind,
    /// All parameters; the free ones are overwritten.
    pub values: Vec<f64>,
    pub free: Vec<Coordinate>,
    /// Side of the transmission that the position sensor is taken to sit on.
    pub sensor_on_load: bool,
}

/// How far from a start its neighbours are, in scales.
const NEIGHBOUR: f64 = 1.4;

impl Term {
    /// True if it is bound to moments of one recording.
    pub(crate) fn is_event(&self) -> bool {
        self.kind.is_event(&self.values)
    }

    /// The parameters at the coordinates `x` of this term.
    pub(crate) fn at(&self, x: &[f64]) -> Vec<f64> {
        let mut values = self.values.clone();
        for (coordinate, x) in self.free.iter().zip(x) {
            values[coordinate.parameter] = coordinate.value(*x);
        }
        values
    }

    /// Standard deviation of a parameter at the coordinates `x` of this term, known to within `std`; none if it is not free.
    pub(crate) fn spread(&self, parameter: usize, x: &[f64], std: &[f64]) -> f64 {
        let free = self.free.iter().position(|c| c.parameter == parameter);
        free.map_or(0.0, |i| self.free[i].spread(x[i], std[i]))
    }

    /// True if a fit moves one of its numbers.
    pub(crate) fn is_free(&self, parameter: usize) -> bool {
        self.free.iter().any(|c| c.parameter == parameter)
    }

    /// True if nothing that a fit leaves as it is tells it from another.
    pub(crate) fn is_same_variant(&self, other: &Self) -> bool {
        let fixed = |term: &Self| -> Vec<(usize, u64)> {
            let values = term.values.iter().map(|v| v.to_bits()).enumerate();
            values.filter(|(i, _)| !term.is_free(*i)).collect()
        };
        self.kind.name == other.kind.name && fixed(self) == fixed(other)
    }

    /// The same term begun at the coordinates `x`.
    pub(crate) fn moved(&self, x: &[f64]) -> Self {
        let mut moved = self.clone();
        moved.values = self.at(x);
        for coordinate in &mut moved.free {
            coordinate.start = moved.values[coordinate.parameter];
        }
        moved
    }

    /// The same term begun at other numbers, by their places.
    pub(crate) fn begun(&self, numbers: &[(usize, f64)]) -> Self {
        let mut begun = self.clone();
        for &(place, value) in numbers {
            begun.values[place] = value;
            let free = begun.free.iter_mut().filter(|c| c.parameter == place);
            free.for_each(|coordinate| coordinate.start = value);
        }
        begun
    }

    /// The same term with one of its numbers held at a value.
    pub(crate) fn held(&self, parameter: usize, value: f64) -> Self {
        let mut held = self.begun(&[(parameter, value)]);
        held.free.retain(|c| c.parameter != parameter);
        held
    }

    /// The same term with the numbers that it shares with another, if there are any: those of one name and quantity.
    pub(crate) fn alike(&self, other: &Self) -> Option<Self> {
        let mut alike = self.clone();
        let mut shared = false;
        for coordinate in &mut alike.free {
            let own = self.kind.parameter(coordinate.parameter);
            let pairs = other.kind.parameters.iter().zip(&other.values);
            let same = pairs.filter(|(p, _)| (p.name, p.quantity) == (own.name, own.quantity));
            for (_, &value) in same.filter(|(_, v)| **v > 0.0 || coordinate.scale != Scale::Log) {
                coordinate.start = value;
                alike.values[coordinate.parameter] = value;
                shared = true;
            }
        }
        alike.sensor_on_load = other.sensor_on_load;
        shared.then_some(alike)
    }

    /// What it comes to without what it has more than an effect of a special `kind`, if it has all that this one has.
    pub(crate) fn reduced(&self, kind: &'static Kind) -> Option<Self> {
        let own = |special: &Parameter| {
            let mut parameters = self.kind.parameters.iter();
            parameters.position(|p| (p.name, p.quantity) == (special.name, special.quantity))
        };
        let places: Option<Vec<usize>> = kind.parameters.iter().map(own).collect();
        let places = places?;
        let free = places.iter().enumerate().filter_map(|(parameter, own)| {
            let coordinate = self.free.iter().find(|c| c.parameter == *own)?;
            Some(Coordinate {
                parameter,
                ..*coordinate
            })
        });
        Some(Self {
            kind,
            values: places.iter().map(|&own| self.values[own]).collect(),
            free: free.collect(),
            sensor_on_load: self.sensor_on_load,
        })
    }

    /// This start and its neighbours along every coordinate that is linear.
    pub(crate) fn around(&self) -> Vec<Self> {
        let mut all = vec![self.clone()];
        for (i, coordinate) in self.free.iter().enumerate() {
            if coordinate.scale == Scale::Log {
                continue;
            }
            let beside = [NEIGHBOUR, -NEIGHBOUR].map(|by| {
                let mut x = vec![0.0; self.free.len()];
                x[i] = by;
                x
            });
            let moved = beside.iter().flat_map(|x| all.iter().map(|t| t.moved(x)));
            let moved: Vec<Self> = moved.collect();
            all.extend(moved);
        }
        all
    }
}
