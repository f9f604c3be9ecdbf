//! Ranges of axes, ticks and tick labels.

use plotters::coord::ranged1d::{DefaultFormatting, KeyPointHint, Ranged};
use std::ops::Range;

/// Layout of values along an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Scale {
    /// Linear: equal differences have equal distances.
    #[default]
    Linear,
    /// Logarithmic: equal ratios have equal distances. Values that are not positive are left out.
    Logarithmic,
}

impl Scale {
    /// Position of a value along the axis. It is not finite if the axis cannot show the value.
    pub fn place(self, value: f64) -> f64 {
        match self {
            Self::Linear => value,
            Self::Logarithmic if value > 0.0 => value.log10(),
            Self::Logarithmic => f64::NAN,
        }
    }

    /// The value at a position.
    pub fn value(self, place: f64) -> f64 {
        match self {
            Self::Linear => place,
            Self::Logarithmic => 10f64.powf(place),
        }
    }
}

/// The range of an axis, and its ticks.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    pub scale: Scale,
    pub range: Range<f64>,
    pub ticks: Vec<f64>,
    /// Labels of the ticks, if they are not the values.
    names: Vec<String>,
}

/// Free share of the range at both ends of the values.
const MARGIN: f64 = 0.06;

/// Share of the range by which a tight axis is extended, so that the round number just after the last sample is visible.
const HAIR: f64 = 0.003;

impl Axis {
    /// Creates an axis around `places`, with `margin` at both ends and about `ticks` ticks. Without places the range is 0 to
    /// 1.
    fn around(places: impl Iterator<Item = f64>, scale: Scale, margin: f64, ticks: usize) -> Self {
        let (low, high) = places
            .filter(|place| place.is_finite())
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), place| {
                (low.min(place), high.max(place))
            });
        let (low, high) = match high - low {
            span if span > f64::EPSILON * high.abs() => (low, high),
            span if span >= 0.0 => (
                low - 0.5 * low.abs().max(1.0),
                high + 0.5 * high.abs().max(1.0),
            ),
            _ => (0.0, 1.0),
        };
        let free = margin * (high - low);
        let range = low - free..high + free.max(HAIR * (high - low));
        let ticks = match scale {
            Scale::Linear => linear_ticks(&range, ticks),
            Scale::Logarithmic => decades(&range, ticks),
        };
        Self {
            scale,
            range,
            ticks,
            names: Vec::new(),
        }
    }

    /// Replaces the ticks of the axis by these, each with its label.
    pub fn with_ticks(self, ticks: &[(f64, String)]) -> Self {
        let (ticks, names) = ticks.iter().cloned().unzip();
        Self {
            ticks,
            names,
            ..self
        }
    }

    /// Creates an axis from the lowest to the highest of `values`.
    pub fn tight(values: impl Iterator<Item = f64>, scale: Scale, ticks: usize) -> Self {
        Self::around(values.map(|v| scale.place(v)), scale, 0.0, ticks)
    }

    /// Creates an axis of `values` with a margin at both ends.
    pub fn roomy(values: impl Iterator<Item = f64>, scale: Scale, ticks: usize) -> Self {
        Self::around(values.map(|v| scale.place(v)), scale, MARGIN, ticks)
    }

    /// Label of a tick.
    pub fn label(&self, tick: f64) -> String {
        let named = self.ticks.iter().position(|t| *t == tick);
        if let Some(name) = named.and_then(|place| self.names.get(place)) {
            return name.clone();
        }
        significant(self.scale.value(tick), TICK_DIGITS)
    }
}

impl Ranged for Axis {
    type FormatOption = DefaultFormatting;
    type ValueType = f64;

    fn map(&self, place: &f64, (from, to): (i32, i32)) -> i32 {
        let share = (place - self.range.start) / (self.range.end - self.range.start);
        from + (share * f64::from(to - from)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, _hint: Hint) -> Vec<f64> {
        self.ticks.clone()
    }

    fn range(&self) -> Range<f64> {
        self.range.clone()
    }
}

/// Ticks at multiples of 1, 2 or 5 times a power of ten, about `count` at most.
fn linear_ticks(range: &Range<f64>, count: usize) -> Vec<f64> {
    let least = (range.end - range.start) / count as f64;
    let power = 10f64.powf(least.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0]
        .map(|m| m * power)
        .into_iter()
        .find(|step| *step >= least)
        .unwrap_or(10.0 * power);
    let first = (range.start / step).ceil();
    let last = (range.end / step).floor();
    (0..=(last - first) as usize)
        .map(|i| (first + i as f64) * step)
        .collect()
}

/// Ticks at powers of ten. A wide range skips powers; a range of less than two decades also has ticks at 2 and 5.
fn decades(range: &Range<f64>, count: usize) -> Vec<f64> {
    let (first, last) = (range.start.floor() as i32, range.end.ceil() as i32);
    let stride = ((last - first) as usize).div_ceil(count).max(1);
    let within: &[f64] = if range.end - range.start < 2.0 {
        &[1.0, 2.0, 5.0]
    } else {
        &[1.0]
    };
    (first..=last)
        .step_by(stride)
        .flat_map(|decade| within.iter().map(move |m| m.log10() + f64::from(decade)))
        .filter(|place| range.contains(place))
        .collect()
}

/// Significant digits of a tick label. Further digits are rounding errors.
const TICK_DIGITS: i32 = 6;
/// Significant digits of a printed value.
const VALUE_DIGITS: i32 = 3;

/// Formats a value with three significant digits.
pub fn rounded(value: f64) -> String {
    significant(value, VALUE_DIGITS)
}

/// Formats a value with up to `digits` significant digits, without trailing zeros, and with a Unicode minus sign.
fn significant(value: f64, digits: i32) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    let exact = format!("{:.*e}", (digits - 1) as usize, value.abs());
    let magnitude = value.abs().log10().floor() as i32;
    let rounded: f64 = exact.parse().unwrap_or(value.abs());
    let text = if (-4..TICK_DIGITS).contains(&magnitude) {
        rounded.to_string()
    } else {
        format!("{rounded:e}")
    };
    if value < 0.0 {
        format!("−{text}")
    } else {
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_inside() {
        let axis = Axis::tight([-0.13, 0.48].into_iter(), Scale::Linear, 6);
        let labels: Vec<_> = axis.ticks.iter().map(|t| axis.label(*t)).collect();
        assert_eq!(labels, ["0", "0.2", "0.4"]);
        let axis = Axis::tight([-12.0, 11.0].into_iter(), Scale::Linear, 6);
        let labels: Vec<_> = axis.ticks.iter().map(|t| axis.label(*t)).collect();
        assert_eq!(labels, ["−10", "−5", "0", "5", "10"]);
    }

    #[test]
    fn a_logarithmic_axis_is_labelled_with_values_and_not_with_exponents() {
        let axis = Axis::tight([0.02, 900.0].into_iter(), Scale::Logarithmic, 8);
        let labels: Vec<_> = axis.ticks.iter().map(|t| axis.label(*t)).collect();
        assert_eq!(labels, ["0.1", "1", "10", "100"]);
    }

    #[test]
    fn an_axis_can_be_made_from_one_value_or_none() {
        for values in [&[][..], &[0.0], &[3.5], &[f64::NAN]] {
            let axis = Axis::roomy(values.iter().copied(), Scale::Linear, 5);
            assert!(axis.range.end > axis.range.start && !axis.ticks.is_empty());
        }
    }
}
