//! Describes the numbers of the nominal model that the fit changed.

use super::quantity::{Display, percent, show};
use gap::diagnosis::{Diagnosis, NumberFinding};

/// One sentence per changed number, the number that closes most of the gap first. The sentence states whether the change is
/// beyond the stated tolerance, within it, or without a stated tolerance.
pub fn sentences(diagnosis: &Diagnosis) -> Vec<String> {
    diagnosis.numbers.iter().map(sentence).collect()
}

fn sentence(number: &NumberFinding) -> String {
    let NumberFinding {
        name, shrink, unit, ..
    } = number;
    let found = Display::of(unit, number.found).show_with_std(number.found, number.std);
    let closes = percent(shrink.clamp(0.0, 1.0));
    match (number.stated, number.sigmas) {
        (Some(stated), Some(sigmas)) => format!(
            "The number `{name}` is {found} rather than the stated {}, {sigmas:.1} of its stated standard deviations away; its \
             move closes {closes} of the gap.",
            show(stated, unit)
        ),
        (Some(stated), None) => format!(
            "The number `{name}` is {found} rather than {}, which is stated without a tolerance; its move closes {closes} of the gap.",
            show(stated, unit)
        ),
        (None, _) => format!("The number `{name}` is not stated; the estimate is {found}."),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::example;

    fn number(stated: Option<f64>, sigmas: Option<f64>) -> NumberFinding {
        NumberFinding {
            stated,
            sigmas,
            ..example::moved_number()
        }
    }

    #[test]
    fn a_changed_number_is_reported_with_its_distance_in_standard_deviations() {
        let text = sentence(&number(Some(0.02), Some(2.1)));
        for part in ["`coulomb`", "57", "20", "2.1 of its", "71 %"] {
            assert!(text.contains(part), "{text}");
        }
        let text = sentence(&number(Some(0.02), None));
        assert!(text.contains("without a tolerance"), "{text}");
        let text = sentence(&number(None, None));
        assert!(text.contains("not stated"), "{text}");
    }
}
