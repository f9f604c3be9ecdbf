//! Bars that stand in the cell of a table and shrink with it.

use std::ops::Range;

/// Colour of a bar, as in the plots.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tone {
    /// The nominal model, and what is not better.
    Model,
    /// The corrected model.
    Corrected,
    /// What no model can undercut.
    Floor,
    /// What was tried and not named.
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

/// A bar from zero to `value` on a scale over `range`, with whiskers over `interval`.
pub fn bar(value: f64, range: &Range<f64>, interval: Option<[f64; 2]>, tone: Tone) -> String {
    let span = range.end - range.start;
    let place = |value: f64| match (100.0 * (value - range.start) / span).clamp(0.0, 100.0) {
        place if place.is_finite() => place,
        _ => 0.0,
    };
    let (from, to) = (place(value.min(0.0)), place(value.max(0.0)));
    let whiskers = interval.map_or(String::new(), |[low, high]| {
        let [low, high] = [place(low), place(high)];
        format!(
            "<path d=\"M{low:.1} 5H{high:.1}M{low:.1} 2V8M{high:.1} 2V8\" stroke=\"#222\" fill=\"none\" \
             vector-effect=\"non-scaling-stroke\"/>"
        )
    });
    format!(
        "<svg class=\"bar\" viewBox=\"0 0 100 10\" preserveAspectRatio=\"none\" aria-hidden=\"true\">\
         <rect x=\"{from:.1}\" y=\"1\" width=\"{:.1}\" height=\"8\" fill=\"{}\"/>{whiskers}</svg>",
        to - from,
        tone.color()
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bar_never_leaves_its_cell() {
        for value in [-2.0, 0.0, 0.4, 7.0, f64::NAN, f64::INFINITY] {
            let svg = bar(value, &(0.0..1.0), Some([value, 9.0]), Tone::Model);
            assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
        }
        assert!(bar(0.4, &(0.0..1.0), None, Tone::Model).contains("width=\"40.0\""));
        assert!(
            bar(-0.5, &(-1.0..1.0), None, Tone::Model)
                .contains("x=\"25.0\" y=\"1\" width=\"25.0\"")
        );
    }
}
