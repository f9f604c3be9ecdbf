//! Bars in table cells, which scale with the cell.

/// Colour of a bar, as in the plots.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tone {
    /// The nominal model, and models that are not better.
    Model,
    /// The corrected model.
    Corrected,
    /// The floor, which no model can improve on.
    Floor,
    /// A candidate that was tried and not named.
    Other,
}

impl Tone {
    fn color(self) -> &'static str {
        match self {
            Self::Model => "#0072b2",
            Self::Corrected => "#d55e00",
            Self::Floor => "#999999",
            Self::Other => "#9cc3dc",
        }
    }
}

/// A bar from zero to `value` on a scale from zero to `most`, with an error bar over `interval`. A negative value has no
/// bar, because its length would look like a positive value.
pub fn bar(value: f64, most: f64, interval: Option<[f64; 2]>, tone: Tone) -> String {
    let place = |value: f64| match (100.0 * value / most).clamp(0.0, 100.0) {
        place if place.is_finite() => place,
        _ => 0.0,
    };
    let whiskers = interval.map(|ends| ends.map(place));
    let whiskers = whiskers.filter(|[low, high]| high > low);
    let whiskers = whiskers.map_or(String::new(), |[low, high]| {
        format!(
            "<path d=\"M{low:.1} 5H{high:.1}M{low:.1} 2V8M{high:.1} 2V8\" stroke=\"#222\" fill=\"none\" \
             vector-effect=\"non-scaling-stroke\"/>"
        )
    });
    format!(
        "<svg class=\"bar\" viewBox=\"0 0 100 10\" preserveAspectRatio=\"none\" aria-hidden=\"true\">\
         <path d=\"M0 0V10\" stroke=\"#888\" vector-effect=\"non-scaling-stroke\"/>\
         <rect x=\"0\" y=\"1\" width=\"{:.1}\" height=\"8\" fill=\"{}\"/>{whiskers}</svg>",
        place(value),
        tone.color()
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bar_never_leaves_its_cell() {
        for value in [-2.0, 0.0, 0.4, 7.0, f64::NAN, f64::INFINITY] {
            let svg = bar(value, 1.0, Some([value, 9.0]), Tone::Model);
            assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
        }
        assert!(bar(0.4, 1.0, None, Tone::Model).contains("width=\"40.0\""));
    }

    #[test]
    fn a_negative_value_has_no_bar() {
        let worse = bar(-0.5, 1.0, Some([-0.8, -0.2]), Tone::Corrected);
        assert!(
            worse.contains("width=\"0.0\"") && !worse.contains("#222"),
            "{worse}"
        );
        let unsure = bar(-0.1, 1.0, Some([-0.3, 0.2]), Tone::Corrected);
        assert!(
            unsure.contains("width=\"0.0\"") && unsure.contains("M0.0 5H20.0"),
            "{unsure}"
        );
    }
}
