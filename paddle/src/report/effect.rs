//! Describes an effect in a sentence.

use super::quantity::{Display, show};
use super::region::Labels;
use gap::diagnosis::{Estimate, Finding};
use gap::effects::{Nominal, Part};
use host_sim::effects;

pub use gap::effects::noun;

/// The effect with its parameters, as a phrase.
pub fn phrase(finding: &Finding, labels: &Labels) -> String {
    let nominal = Nominal {
        coulomb: labels.coulomb,
        input_limit: labels.input_limit,
        has_stops: labels.has_stops,
        has_runs: labels.runs.len() > 1,
    };
    let phrase = gap::effects::phrase(finding, &nominal);
    phrase.0.iter().map(written).collect()
}

fn written(part: &Part) -> String {
    match part {
        Part::Words(words) => words.to_string(),
        Part::Number(estimate) => shown(estimate),
        Part::Instant { at, lasts } => {
            let decimals = (1.0 - lasts.log10().floor()).clamp(0.0, MOST_DECIMALS) as usize;
            format!("{:.decimals$} {}", at.value, at.unit)
        }
    }
}

/// Largest number of decimals of a time.
const MOST_DECIMALS: f64 = 6.0;

fn shown(estimate: &Estimate) -> String {
    // For a factor, the difference from 1 matters.
    if estimate.unit == "1" && (estimate.value - 1.0).abs() < NEAR_ONE {
        return format!("{:.2}", estimate.value);
    }
    show(estimate.value, &estimate.unit)
}

/// Difference from 1 below which two digits of a factor would round to 1.
const NEAR_ONE: f64 = 0.1;

/// An estimate with its standard deviation, if that is known.
pub fn with_std(estimate: &Estimate) -> String {
    let display = Display::of(&estimate.unit, estimate.value);
    display.show_with_std(estimate.value, estimate.std)
}

/// Reason why an estimate has no standard deviation. `None` if it has one.
pub fn why_no_std(estimate: &Estimate) -> Option<&'static str> {
    match (estimate.std, estimate.is_fitted) {
        (Some(_), _) => None,
        (None, true) => Some("uncertainty not known"),
        (None, false) => Some("not fitted"),
    }
}

/// Divides the parameters into those that were estimated, in the order of the finding, and the rest. The rest was held at a
/// value without effect, or at its default.
pub fn parameters(finding: &Finding) -> (Vec<Named<'_>>, Vec<Named<'_>>) {
    let known = effects::kind(finding.name).map_or(&[][..], |kind| kind.parameters);
    let place = |name: &str| known.iter().position(|p| p.name == name);
    let all: Vec<_> = finding.parameters.iter().collect();
    let default = |name: &str| place(name).map_or(0.0, |place| known[place].default);
    all.into_iter().partition(|(name, estimate)| {
        estimate.is_fitted || (estimate.value != 0.0 && estimate.value != default(name))
    })
}

/// Name and estimate of a parameter.
pub type Named<'a> = (&'a String, &'a Estimate);

/// Meaning of the parameter `name` of the effect `effect`.
pub fn parameter(effect: &str, name: &str) -> &'static str {
    let Some(kind) = effects::kind(effect) else {
        return "";
    };
    let base = |name: &str| kind.parameters.iter().find(|p| p.name == name);
    base(name)
        .or_else(|| base(name.rsplit_once('_')?.0))
        .map_or("", |parameter| parameter.about)
}

/// Description of the effect in a sentence, and its equation.
pub fn explained(name: &str) -> (&'static str, &'static str) {
    effects::kind(name).map_or(("", ""), |kind| (kind.about, kind.equation))
}

#[cfg(test)]
mod tests {
    use super::super::example::labels;
    use super::*;

    fn finding(name: &'static str, numbers: &[(&str, f64, f64, &str)]) -> Finding {
        let parameters = numbers.iter().map(|&(name, value, std, unit)| {
            let unit = unit.to_owned();
            let estimate = Estimate {
                value,
                std: (std > 0.0).then_some(std),
                unit,
                is_fitted: std > 0.0,
            };
            (name.to_owned(), estimate)
        });
        Finding {
            name,
            channel: "",
            confidence: 0.9,
            not_separable_from: Vec::new(),
            basis: "prediction",
            held_out: true,
            parameters: parameters.collect(),
            shrink: 0.5,
            shrink_interval: [0.4, 0.6],
        }
    }

    fn names<'a>(parameters: &[Named<'a>]) -> Vec<&'a str> {
        parameters.iter().map(|(name, _)| name.as_str()).collect()
    }

    #[test]
    fn a_parameter_that_selects_another_form_changes_the_phrase() {
        let carried = finding(
            "load_dependent_friction",
            &[("share", 0.54, 0.04, "1"), ("passive", -0.87, 0.04, "1")],
        );
        assert_eq!(
            phrase(&carried, &labels()),
            "dry friction that grows by 0.54 of what the drive and −0.87 times the weight or spring pull together"
        );
        let twice = finding(
            "lag",
            &[("time", 0.004, 1e-4, "s"), ("twice", 1.0, 0.0, "1")],
        );
        assert_eq!(
            phrase(&twice, &labels()),
            "a torque that lags by 4.0 ms, and by as much again"
        );
        let anew = [("rate", 0.0, 0.0, "1/s"), ("anew", 1.0, 0.0, "1")];
        let step = [("step", -0.3, 0.01, "1"), ("step_at", 4.0, 0.1, "s")];
        let stepping = finding("friction_drift", &[anew, step].concat());
        let pause = [step[0], ("step_at", 4.0, 0.0, "s")];
        assert_eq!(
            phrase(&finding("friction_drift", &pause), &labels()),
            "dry friction that steps by −0.30 between two runs"
        );
        assert!(labels().runs.len() > 1);
        assert_eq!(
            phrase(&stepping, &labels()),
            "dry friction that steps by −0.30 at 4.0 s in every run"
        );
    }

    #[test]
    fn a_negative_parameter_is_reported_as_an_excess_of_the_model() {
        let shorter = |name| finding(name, &[("time", -0.004, 1e-4, "s")]);
        assert_eq!(
            phrase(&shorter("delay"), &labels()),
            "a torque that comes 4.0 ms sooner than the model has it"
        );
        assert_eq!(
            phrase(&shorter("lag"), &labels()),
            "a torque that lags by 4.0 ms less than the model has it"
        );
        let labels = Labels {
            input_limit: Some(2.0),
            has_stops: true,
            ..labels()
        };
        let unmet = finding("saturation", &[("limit", 5.0, 0.0, "N m")]);
        assert!(phrase(&unmet, &labels).contains("not clipped where the model"));
        let at_its_end = finding("saturation", &[("limit", 1.0, 0.0, "N m")]);
        assert_eq!(
            phrase(&at_its_end, &labels),
            "an input that saturates at 1.0 N m"
        );
        let unmet = finding("end_stop", &[("lower", -5.0, 0.0, "rad")]);
        assert!(phrase(&unmet, &labels).contains("not met where the model"));
    }

    #[test]
    fn only_the_stop_that_was_reached_is_named() {
        let numbers = [("lower", -2.0, 0.0, "rad"), ("upper", 0.576, 0.001, "rad")];
        assert_eq!(
            phrase(&finding("end_stop", &numbers), &labels()),
            "a hard stop at 33°"
        );
    }

    #[test]
    fn a_hand_contact_is_described_by_its_side() {
        let phrase = |side| {
            let numbers = [
                ("side", side, 0.0, "1"),
                ("from", 1.0, 0.1, "s"),
                ("to", 2.5, 0.1, "s"),
            ];
            phrase(&finding("contact", &numbers), &labels())
        };
        assert_eq!(
            phrase(0.0),
            "something outside that holds it from 1.0 s to 2.5 s"
        );
        assert_eq!(
            phrase(-1.0),
            "something outside that pushes back from 1.0 s to 2.5 s"
        );
    }

    #[test]
    fn repeated_hand_contacts_are_counted() {
        let numbers = ["from_1", "to_1", "from_2", "to_2"].map(|name| (name, 1.0, 0.1, "s"));
        assert_eq!(
            phrase(&finding("contact", &numbers), &labels()),
            "something outside that comes 2 times"
        );
    }

    #[test]
    fn times_of_a_hand_contact_are_rounded_to_a_tenth_of_its_duration() {
        let phrase = |from, to| {
            let numbers = [("from", from, 1e-4, "s"), ("to", to, 1e-4, "s")];
            phrase(&finding("contact", &numbers), &labels())
        };
        assert_eq!(
            phrase(15.5562, 16.4785),
            "something outside that pushes back from 15.56 s to 16.48 s"
        );
        assert_eq!(
            phrase(3.0, 25.02),
            "something outside that pushes back from 3 s to 25 s"
        );
    }

    #[test]
    fn parameters_without_information_are_left_out_and_the_others_keep_their_order() {
        let numbers = [
            ("slope", -0.5, 0.0, "1/rad"),
            ("level", 1.0, 0.1, "1"),
            ("ripple_sine", 0.0, 0.0, "1"),
            ("spot", 0.0, 0.01, "1"),
            ("spot_width", 0.1, 0.0, "rad"),
        ];
        let finding = finding("position_dependent_coulomb", &numbers);
        let (told, held) = parameters(&finding);
        assert_eq!(names(&told), ["slope", "level", "spot"]);
        assert_eq!(names(&held), ["ripple_sine", "spot_width"]);
    }

    #[test]
    fn dry_friction_is_compared_with_that_of_the_model() {
        let labels = Labels {
            coulomb: 0.015,
            ..labels()
        };
        let phrase = |level: f64| {
            let numbers = [("level", level, 1e-5, "N m")];
            phrase(&finding("coulomb", &numbers), &labels)
        };
        assert_eq!(phrase(0.02), "dry friction of 20 mN m in place of 15 mN m");
        assert!(phrase(0.0).starts_with("dry friction that does not act"));
    }

    #[test]
    fn a_factor_near_one_keeps_enough_digits() {
        let phrase = |gain| {
            phrase(
                &finding("torque_gain", &[("gain", gain, 1e-3, "1")]),
                &labels(),
            )
        };
        assert_eq!(phrase(1.0298), "a torque of 1.03 times the commanded one");
        assert_eq!(phrase(0.7312), "a torque of 0.73 times the commanded one");
    }

    #[test]
    fn several_jumps_are_counted() {
        let numbers = [
            ("jump_1", 0.1, 0.01, "rad"),
            ("time_1", 0.1, 0.0, "s"),
            ("jump_2", 0.1, 0.01, "rad"),
        ];
        assert_eq!(
            phrase(&finding("lost_counts", &numbers), &labels()),
            "a sensor that jumps 2 times"
        );
    }
}
