//! Units in logs and their conversion to SI.

use std::f64::consts::{PI, TAU};

/// The quantity that a unit measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Angle, in rad.
    Angle,
    /// Length, in m.
    Length,
    /// Angular velocity, in rad/s.
    AngularVelocity,
    /// Speed, in m/s.
    Speed,
    /// Time, in s.
    Time,
    /// Torque, in N m.
    Torque,
    /// Force, in N.
    Force,
    /// Current, in A.
    Current,
    /// Voltage, in V.
    Voltage,
    /// A share of the largest value, without unit.
    Share,
    /// Counts of an encoder or a register.
    Count,
    /// Another known unit.
    Other,
}

use Quantity::{
    Angle, AngularVelocity, Count, Current, Force, Length, Other, Share, Speed, Time, Torque,
    Voltage,
};

/// Symbols, which are case-sensitive, without spaces and multiplication signs.
const SYMBOLS: &[(&str, Quantity, f64)] = &[
    ("°", Angle, PI / 180.0),
    ("m", Length, 1.0),
    ("dm", Length, 0.1),
    ("cm", Length, 0.01),
    ("mm", Length, 1e-3),
    ("um", Length, 1e-6),
    ("µm", Length, 1e-6),
    ("nm", Length, 1e-9),
    ("s", Time, 1.0),
    ("ms", Time, 1e-3),
    ("us", Time, 1e-6),
    ("µs", Time, 1e-6),
    ("ns", Time, 1e-9),
    ("h", Time, 3600.0),
    ("Nm", Torque, 1.0),
    ("mNm", Torque, 1e-3),
    ("uNm", Torque, 1e-6),
    ("µNm", Torque, 1e-6),
    ("Ncm", Torque, 1e-2),
    ("Nmm", Torque, 1e-3),
    ("kNm", Torque, 1e3),
    ("kgfcm", Torque, 0.098_066_5),
    ("kgcm", Torque, 0.098_066_5),
    ("kgfm", Torque, 9.806_65),
    ("gcm", Torque, 9.806_65e-5),
    ("ozin", Torque, 7.061_551_833e-3),
    ("lbfin", Torque, 0.112_984_829),
    ("lbin", Torque, 0.112_984_829),
    ("lbfft", Torque, 1.355_817_948),
    ("N", Force, 1.0),
    ("mN", Force, 1e-3),
    ("kN", Force, 1e3),
    ("A", Current, 1.0),
    ("mA", Current, 1e-3),
    ("V", Voltage, 1.0),
    ("mV", Voltage, 1e-3),
    ("%", Share, 0.01),
    ("rpm", AngularVelocity, TAU / 60.0),
    ("r/min", AngularVelocity, TAU / 60.0),
    ("1/min", AngularVelocity, TAU / 60.0),
    ("rev/min", AngularVelocity, TAU / 60.0),
    ("W", Other, 1.0),
    ("Hz", Other, 1.0),
    ("Pa", Other, 1.0),
    ("kPa", Other, 1e3),
    ("bar", Other, 1e5),
    ("K", Other, 1.0),
    ("°C", Other, 1.0),
    ("degC", Other, 1.0),
    ("m/s^2", Other, 1.0),
    ("m/s²", Other, 1.0),
    ("rad/s^2", Other, 1.0),
    ("rad/s²", Other, 1.0),
    ("deg/s^2", Other, PI / 180.0),
    ("deg/s²", Other, PI / 180.0),
];

/// Words, in any case.
const WORDS: &[(&str, Quantity, f64)] = &[
    ("rad", Angle, 1.0),
    ("radian", Angle, 1.0),
    ("radians", Angle, 1.0),
    ("mrad", Angle, 1e-3),
    ("deg", Angle, PI / 180.0),
    ("degree", Angle, PI / 180.0),
    ("degrees", Angle, PI / 180.0),
    ("grad", Angle, PI / 180.0),
    ("arcmin", Angle, PI / 10_800.0),
    ("rev", Angle, TAU),
    ("revs", Angle, TAU),
    ("revolution", Angle, TAU),
    ("revolutions", Angle, TAU),
    ("turn", Angle, TAU),
    ("turns", Angle, TAU),
    ("in", Length, 0.0254),
    ("inch", Length, 0.0254),
    ("metre", Length, 1.0),
    ("metres", Length, 1.0),
    ("meter", Length, 1.0),
    ("meters", Length, 1.0),
    ("sec", Time, 1.0),
    ("secs", Time, 1.0),
    ("second", Time, 1.0),
    ("seconds", Time, 1.0),
    ("msec", Time, 1e-3),
    ("millis", Time, 1e-3),
    ("milliseconds", Time, 1e-3),
    ("usec", Time, 1e-6),
    ("micros", Time, 1e-6),
    ("microseconds", Time, 1e-6),
    ("nsec", Time, 1e-9),
    ("nanoseconds", Time, 1e-9),
    ("min", Time, 60.0),
    ("amp", Current, 1.0),
    ("amps", Current, 1.0),
    ("volt", Voltage, 1.0),
    ("volts", Voltage, 1.0),
    ("percent", Share, 0.01),
    ("duty", Share, 1.0),
    ("count", Count, 1.0),
    ("counts", Count, 1.0),
    ("cts", Count, 1.0),
    ("tick", Count, 1.0),
    ("ticks", Count, 1.0),
    ("inc", Count, 1.0),
    ("lsb", Count, 1.0),
    ("digits", Count, 1.0),
    ("raw", Count, 1.0),
    ("step", Count, 1.0),
    ("steps", Count, 1.0),
    ("pwm", Count, 1.0),
];

/// The quantity of `unit` and its value in SI. `None` for an unknown unit.
pub fn parse(unit: &str) -> Option<(Quantity, f64)> {
    let bare: String = unit.chars().filter(|c| !" *·⋅".contains(*c)).collect();
    let bare = bare.replace('μ', "µ");
    let plain: String = bare.chars().filter(|c| *c != '.' && *c != '-').collect();
    let find = |name: &str| {
        let symbol = SYMBOLS.iter().find(|(symbol, ..)| *symbol == name);
        let low = name.to_lowercase();
        let known = symbol.or_else(|| WORDS.iter().find(|(word, ..)| *word == low));
        known.map(|(_, quantity, si)| (*quantity, *si))
    };
    if let Some(found) = find(&bare).or_else(|| find(&plain)) {
        return Some(found);
    }
    let rate = ["/s", "/sec", "ps"]
        .iter()
        .find_map(|per| bare.strip_suffix(per));
    match find(rate?)? {
        (Angle, si) => Some((AngularVelocity, si)),
        (Length, si) => Some((Speed, si)),
        (Count, si) => Some((Other, si)),
        _ => None,
    }
}

/// A unit at the end of a name: `angle_deg`, `time_ms`.
pub(crate) fn of_name(name: &str) -> Option<&str> {
    let (_, last) = name.rsplit_once(['_', '.', ' '])?;
    // Single letters are often other names than units, except for these.
    let is_telling = last.len() > 1 || matches!(last, "s" | "A" | "V");
    (is_telling && parse(last).is_some()).then_some(last)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_recognised_in_different_spellings() {
        for (text, quantity, si) in [
            ("N.m", Torque, 1.0),
            ("N*m", Torque, 1.0),
            ("mN m", Torque, 1e-3),
            ("kgf·cm", Torque, 0.098_066_5),
            ("DEG", Angle, PI / 180.0),
            ("deg/s", AngularVelocity, PI / 180.0),
            ("mm/s", Speed, 1e-3),
            ("μs", Time, 1e-6),
            ("rpm", AngularVelocity, TAU / 60.0),
        ] {
            assert_eq!(parse(text), Some((quantity, si)), "{text}");
        }
        for text in ["2", "0.0-1.0", "", "elbow"] {
            assert_eq!(parse(text), None, "{text}");
        }
    }
}
