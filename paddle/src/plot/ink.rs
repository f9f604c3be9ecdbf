//! Colours of the charts. People with any colour vision can distinguish them (Okabe and Ito, 2008).

use plotters::style::RGBColor;

/// Meaning of a line. The same meaning has the same colour in all charts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ink {
    /// Setpoint.
    Setpoint,
    /// Measured or true value.
    Measured,
    /// Prediction of the nominal model.
    Model,
    /// Prediction of the corrected model.
    Corrected,
    /// The part of the data in which the gap lies.
    GapRegion,
    /// Any other line, by its number.
    Other(usize),
}

const OTHERS: [RGBColor; 4] = [
    RGBColor(0xD5, 0x5E, 0x00),
    RGBColor(0x00, 0x9E, 0x73),
    RGBColor(0xCC, 0x79, 0xA7),
    RGBColor(0xE6, 0x9F, 0x00),
];

impl Ink {
    pub(super) fn color(self) -> RGBColor {
        match self {
            Self::Setpoint => RGBColor(0x99, 0x99, 0x99),
            Self::Measured => RGBColor(0x22, 0x22, 0x22),
            Self::Model => RGBColor(0x00, 0x72, 0xB2),
            Self::Corrected => RGBColor(0xD5, 0x5E, 0x00),
            Self::GapRegion => RGBColor(0xE6, 0x9F, 0x00),
            Self::Other(place) => OTHERS[place % OTHERS.len()],
        }
    }

    /// Width of a line, px.
    pub(super) fn width(self) -> f64 {
        match self {
            // The measured line is wide, so that it stays visible behind a correct model.
            Self::Measured => 3.0,
            _ => 1.4,
        }
    }
}
