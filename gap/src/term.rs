//! An instance of an effect: its parameter values, and which of them are free in a fit.

use host_sim::effects::{Kind, Parameter, Quantity};

/// The conversion of a dimensionless coordinate x to a parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Scale {
    /// `start + scale · x`.
    Linear(f64),
    /// `start · e^(0.6 x)`.
    Log,
}

/// Change of the logarithm of a parameter per unit of its coordinate.
const LOG_UNIT: f64 = 0.6;
/// Largest magnitudes of coordinates: a factor of 20 for logarithmic parameters, 20 scales for magnitudes, and 5 scales for positions and
/// times, which must stay near their start.
const LOG_REACH: f64 = 5.0;
const MAGNITUDE_REACH: f64 = 20.0;
const POSITION_REACH: f64 = 5.0;

/// A free parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Coordinate {
    /// Index of the parameter in its effect.
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

    /// Lowest and highest value of the coordinate.
    pub(crate) fn reach(&self, of: &Parameter) -> [f64; 2] {
        let (farthest, bounds) = match self.scale {
            Scale::Linear(scale) => {
                let farthest = match of.quantity {
                    Quantity::Position | Quantity::Time => POSITION_REACH,
                    _ => MAGNITUDE_REACH,
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

    /// Standard deviation of the parameter from that of the coordinate.
    pub(crate) fn spread(&self, x: f64, std: f64) -> f64 {
        match self.scale {
            Scale::Linear(scale) => scale.abs() * std,
            Scale::Log => LOG_UNIT * self.value(x).abs() * std,
        }
    }
}

/// An effect with some free parameters.
#[derive(Clone, Debug)]
pub(crate) struct Term {
    pub kind: &'static Kind,
    /// Values of all parameters. A fit overwrites the free ones.
    pub values: Vec<f64>,
    pub free: Vec<Coordinate>,
    /// True if the position sensor is assumed on the load side of the transmission.
    pub sensor_on_load: bool,
}

/// Distance between a start and its neighbours, in scales.
const NEIGHBOUR: f64 = 1.4;

impl Term {
    /// True if the effect is bound to instants of one recording.
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

    /// Standard deviation of a parameter at the coordinates `x`, whose standard deviations are `std`. It is 0 for a fixed parameter.
    pub(crate) fn spread(&self, parameter: usize, x: &[f64], std: &[f64]) -> f64 {
        let free = self.free.iter().position(|c| c.parameter == parameter);
        free.map_or(0.0, |i| self.free[i].spread(x[i], std[i]))
    }

    /// True if a parameter is free.
    pub(crate) fn is_free(&self, parameter: usize) -> bool {
        self.free.iter().any(|c| c.parameter == parameter)
    }

    /// True if both terms have the same kind and the same fixed parameters.
    pub(crate) fn is_same_variant(&self, other: &Self) -> bool {
        let fixed = |term: &Self| -> Vec<(usize, u64)> {
            let values = term.values.iter().map(|v| v.to_bits()).enumerate();
            values.filter(|(i, _)| !term.is_free(*i)).collect()
        };
        self.kind.name == other.kind.name && fixed(self) == fixed(other)
    }

    /// The term with its start values at the coordinates `x`.
    pub(crate) fn moved(&self, x: &[f64]) -> Self {
        let mut moved = self.clone();
        moved.values = self.at(x);
        for coordinate in &mut moved.free {
            coordinate.start = moved.values[coordinate.parameter];
        }
        moved
    }

    /// The term with other start values, by the index of the parameter.
    pub(crate) fn starting_at(&self, numbers: &[(usize, f64)]) -> Self {
        let mut started = self.clone();
        for &(place, value) in numbers {
            started.values[place] = value;
            let free = started.free.iter_mut().filter(|c| c.parameter == place);
            free.for_each(|coordinate| coordinate.start = value);
        }
        started
    }

    /// The term with one parameter fixed at a value.
    pub(crate) fn held(&self, parameter: usize, value: f64) -> Self {
        let mut held = self.starting_at(&[(parameter, value)]);
        held.free.retain(|c| c.parameter != parameter);
        held
    }

    /// The term with the values of the parameters that it has in common with another term: those of equal name and quantity. Returns
    /// `None` if there are none.
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

    /// The term reduced to an effect of a special `kind`. Returns `None` if the effect lacks a parameter of that kind.
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

    /// This start and its neighbours along every linear coordinate.
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
