//! Colours that people with any colour vision tell apart (Okabe and Ito, 2008), and what each is for.

use plotters::style::RGBColor;

/// What a line stands for; the same thing has the same colour in all charts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ink {
    /// What was asked for.
    Setpoint,
    /// What was measured, or what is true.
    Measured,
    /// What the nominal model says.
    Model,
    /// What the corrected model says.
    Corrected,
    /// The part of the data that carries the gap.
    Guilty,
    /// Any other line, by its place.
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
            Self::Guilty => RGBColor(0xE6, 0x9F, 0x00),
            Self::Other(place) => OTHERS[place % OTHERS.len()],
        }
    }

    /// Width of a line, px.
    pub(super) fn width(self) -> f64 {
        match self {
            // It shows behind a model that is right.
            Self::Measured => 3.0,
            _ => 1.4,
        }
    }
}
