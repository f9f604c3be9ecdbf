//! Low-pass on the measured position, of the order that the settings choose.

use idsp::iir::Biquad;

use super::biquad::{self, SecondOrder};
use super::low_pass::{self, LowPass};
use crate::settings::{EstimateSettings, FilterOrder};

/// Coefficients for one cutoff, order and rate.
#[derive(Clone, Debug)]
pub enum PositionFilterTuning {
    /// Gain of [`LowPass`].
    First(f32),
    /// Butterworth section.
    Second(Biquad<f32>),
}

impl PositionFilterTuning {
    /// For samples every `tick_s`.
    pub fn new(settings: &EstimateSettings, tick_s: f32) -> Self {
        match settings.order {
            FilterOrder::First => Self::First(low_pass::gain(settings.cutoff_hz, tick_s)),
            FilterOrder::Second => Self::Second(biquad::butterworth(settings.cutoff_hz, tick_s)),
        }
    }
}

/// The filter with its state.
#[derive(Clone, Debug)]
pub enum PositionFilter {
    /// First order.
    First(LowPass),
    /// Second order.
    Second(SecondOrder),
}

impl PositionFilter {
    /// A filter at rest at `position_rad`.
    pub fn at_rest(tuning: PositionFilterTuning, position_rad: f32) -> Self {
        let mut filter = match tuning {
            PositionFilterTuning::First(gain) => Self::First(LowPass::new(gain)),
            PositionFilterTuning::Second(section) => Self::Second(SecondOrder::new(section)),
        };
        filter.reset(position_rad);
        filter
    }

    /// Puts the filter at rest at `position_rad`.
    pub fn reset(&mut self, position_rad: f32) {
        match self {
            Self::First(filter) => filter.reset(position_rad),
            Self::Second(filter) => filter.reset(position_rad),
        }
    }

    /// Takes one sample and gives the filtered one, rad.
    #[inline]
    pub fn update(&mut self, position_rad: f32) -> f32 {
        match self {
            Self::First(filter) => filter.update(position_rad),
            Self::Second(filter) => filter.update(position_rad),
        }
    }
}
