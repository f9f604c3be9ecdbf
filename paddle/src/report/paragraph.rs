//! Describes a diagnosis in one paragraph.

use super::effect::{noun, phrase};
use super::number;
use super::quantity::{Display, percent, show};
use super::region::{self, Labels};
use gap::diagnosis::{Diagnosis, Finding, FloorOf, NextExperiment, Region, Verdict};

/// Number of candidates that the paragraph rules out.
const RULED_OUT: usize = 2;
/// Share of the closed gap that a candidate must leave open to be ruled out.
const LEFT_BY_RULED_OUT: f64 = 0.3;
/// Smallest share that is called "most of the gap".
const MOST: f64 = 0.5;
/// An effect that closes less than this share of the gap with less than this confidence is mentioned separately.
const LITTLE: f64 = 0.05;
const SURE: f64 = 0.9;

/// The verdict as a headline.
pub fn headline(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::NoGap => "No gap: the model predicts what the sensor can show",
        Verdict::Explained => "The gap is explained",
        Verdict::PartlyExplained => "The gap is explained in part",
        Verdict::Unexplained => "There is a gap that no known effect explains",
    }
}

/// States where the gap lies, which effects explain it, how far it shrinks, which effects do not explain it, and the next
/// step.
pub fn paragraph(diagnosis: &Diagnosis, labels: &Labels) -> String {
    let gap = &diagnosis.gap;
    let display = Display::of(&gap.unit, gap.before);
    let [before, after, floor] =
        [gap.before, gap.after, gap.floor].map(|value| display.show(value));
    let mut sentences = Vec::new();
    sentences.extend(labels.turned.map(|column| {
        format!(
            "Input and position have opposite signs, so the sign of {column} is reversed: correct the log."
        )
    }));
    sentences.extend(number::sentences(diagnosis));
    if diagnosis.verdict == Verdict::NoGap && !diagnosis.numbers.is_empty() {
        sentences.push(format!(
            "The gap falls from {before} to {after} by these numbers alone (floor {floor}), all within what is stated of them."
        ));
        return sentences.join(" ");
    }
    if diagnosis.verdict == Verdict::NoGap {
        sentences.push(format!(
            "The gap is {before}, and {floor} of it would be left by a perfect model: noise and quantising. What is \
             beyond is no more than the stated tolerances of the model allow, or than restarts and averaged \
             inputs hide."
        ));
        return sentences.join(" ");
    }
    sentences.push(match diagnosis.regions.first() {
        Some(region) => located(region, labels),
        None => "No part of the recording carries clearly more of the gap than its share of the samples.".into(),
    });
    let is_aside = |effect: &&Finding| effect.shrink < LITTLE && effect.confidence < SURE;
    let (mut aside, mut main): (Vec<_>, Vec<_>) = diagnosis.effects.iter().partition(is_aside);
    if main.is_empty() {
        std::mem::swap(&mut main, &mut aside);
    }
    let phrases = |effects: &[&Finding]| -> Vec<_> {
        let effects = effects.iter();
        effects.map(|effect| phrase(effect, labels)).collect()
    };
    let found = phrases(&main);
    if let Some(rejection) = &diagnosis.rejection {
        sentences.push(format!(
            "The gap is {before} where a perfect model would leave {floor}. {}.",
            capitalized(rejection)
        ));
    } else if found.is_empty() && !diagnosis.numbers.is_empty() && gap.shrink > 0.0 {
        sentences.push(format!(
            "By these numbers alone the gap falls from {before} to {after} (floor {floor}). No effect of the library \
             makes the rest smaller on data the fit has not seen."
        ));
    } else if found.is_empty() {
        sentences.push(format!(
            "The gap is {before} where a perfect model would leave {floor}, and no effect of the library makes it \
             smaller on data the fit has not seen."
        ));
    } else {
        let all = capitalized(&listed(&found, "and"));
        let verb = if found.len() > 1 {
            "explain"
        } else {
            "explains"
        };
        let is_partial = diagnosis.verdict == Verdict::PartlyExplained;
        let how = match (is_partial, gap.is_closed()) {
            (true, true) => "may explain it".into(),
            (true, false) => format!("{verb} part of it"),
            (false, _) => format!("{verb} it"),
        };
        let on = on_which_data(diagnosis);
        sentences.push(format!(
            "{all} {how}: the gap falls from {before} to {after} (floor {floor}){on}."
        ));
        if !aside.is_empty() {
            sentences.push(format!(
                "{} may be there, too, and closes little of it.",
                capitalized(&listed(&phrases(&aside), "or"))
            ));
        }
        sentences.extend(ruled_out(diagnosis));
        if is_partial {
            sentences.push(
                "Something more may be left that no further effect of the library explains.".into(),
            );
        }
        let effects = diagnosis.effects.iter();
        let compared = effects.filter(|effect| effect.basis == "sensor_comparison");
        sentences.extend(compared.map(|effect| {
            format!(
                "The two position sensors disagree just as {} makes them.",
                noun(effect.name)
            )
        }));
    }
    sentences.extend(open_ends(diagnosis, labels));
    sentences.join(" ")
}

/// States the floor of the corrected model, if the nominal model has another floor.
pub fn floors(diagnosis: &Diagnosis) -> Option<String> {
    let gap = &diagnosis.gap;
    let display = Display::of(&gap.unit, gap.before);
    let [floor, nominal] = [gap.floor, gap.nominal_floor].map(|floor| display.show(floor));
    (gap.floor_of == FloorOf::CorrectedModel && floor != nominal).then(|| {
        format!(
            "The floor of {floor} is that of the corrected model: what noise, quantising and restarts alone would leave if it \
             were right. If the nominal model were right, they would leave {nominal}, which is the floor that `paddle gap \
             measure` gives for it."
        )
    })
}

/// States that the gap fell on held-out data, if all of that data was held out.
pub fn on_which_data(diagnosis: &Diagnosis) -> &'static str {
    match diagnosis.effects.iter().all(|effect| effect.held_out) {
        true => " on data the fit has not seen",
        false => "",
    }
}

fn located(region: &Region, labels: &Labels) -> String {
    let share = percent(region.share_of_gap);
    let part = match region.share_of_gap >= MOST {
        true => format!("Most of the gap ({share})"),
        false => format!("A share of the gap ({share})"),
    };
    let place = region::phrase(region, labels);
    let samples = match region.axis {
        // The regions of these axes have no share of the samples.
        "frequency" | "channel" => String::new(),
        _ => format!(", in {} of the samples", percent(region.share_of_samples)),
    };
    format!("{part} sits {place}{samples}.")
}

/// Lists the next best candidates that are not tied with the finding. Candidates that were tried in addition to the finding
/// are not ruled out.
fn ruled_out(diagnosis: &Diagnosis) -> Option<String> {
    let tied = |name: &str| {
        diagnosis
            .effects
            .iter()
            .any(|e| e.not_separable_from.contains(&name))
    };
    let gap = &diagnosis.gap;
    let least = gap.after + LEFT_BY_RULED_OUT * (gap.before - gap.after);
    let names: Vec<_> = diagnosis
        .candidates
        .iter()
        .filter(|tried| !tied(tried.name) && tried.after > least)
        .take(RULED_OUT)
        .map(|tried| noun(tried.name))
        .collect();
    if names.is_empty() {
        return None;
    }
    let verb = if names.len() > 1 { "do" } else { "does" };
    Some(format!(
        "{} {verb} not.",
        capitalized(&listed(&names, "and"))
    ))
}

/// Lists the effects that the data cannot distinguish, and the experiment that would distinguish them.
fn open_ends(diagnosis: &Diagnosis, labels: &Labels) -> Vec<String> {
    let next = diagnosis.next_experiment.as_ref();
    let mut sentences = Vec::new();
    let mut settled = false;
    for effect in &diagnosis.effects {
        let next = next.filter(|next| next.separates.contains(&effect.name));
        let rivals = effect.not_separable_from.iter();
        let (told_apart, left): (Vec<&str>, Vec<&str>) =
            rivals.partition(|name| next.is_some_and(|next| next.separates.contains(name)));
        let or = |names: &[&str]| {
            let nouns: Vec<_> = names.iter().map(|name| noun(name)).collect();
            listed(&nouns, "or")
        };
        if let Some(next) = next.filter(|_| !told_apart.is_empty()) {
            settled = true;
            sentences.push(format!(
                "To tell {} from {}, run {}.",
                noun(effect.name),
                or(&told_apart),
                experiment(next, labels)
            ));
        }
        if !left.is_empty() {
            sentences.push(format!(
                "This recording cannot tell {} from {}.",
                noun(effect.name),
                or(&left)
            ));
        }
    }
    if let (Some(next), false) = (next, settled) {
        let names: Vec<_> = next.separates.iter().map(|name| noun(name)).collect();
        sentences.push(match names.is_empty() {
            true => format!("To learn more, run {}.", experiment(next, labels)),
            false => format!(
                "To tell {} apart, run {}.",
                listed(&names, "and"),
                experiment(next, labels)
            ),
        });
    }
    sentences
}

/// Describes an excitation, with its amplitude in the unit of the input.
pub fn experiment(next: &NextExperiment, labels: &Labels) -> String {
    let settings: Vec<_> = next
        .settings
        .iter()
        .map(|(name, value)| {
            if *name == "amplitude" {
                return format!("{name} {} {}", show(*value, ""), labels.input);
            }
            let (name, unit) = with_unit(name);
            format!("{} {}", name.replace('_', " "), show(*value, unit))
        })
        .collect();
    match settings.is_empty() {
        true => format!("a {}", next.kind),
        false => format!("a {} with {}", next.kind, listed(&settings, "and")),
    }
}

/// Splits the name of a setting into the name and the unit.
fn with_unit(name: &str) -> (&str, &str) {
    const UNITS: [(&str, &str); 5] = [
        ("_hz", "Hz"),
        ("_nm", "N m"),
        ("_rad", "rad"),
        ("_deg", "deg"),
        ("_s", "s"),
    ];
    let known = UNITS
        .iter()
        .find_map(|(suffix, unit)| Some((name.strip_suffix(suffix)?, *unit)));
    known.unwrap_or((name, ""))
}

/// Joins items: "a", "a and b", "a, b and c".
fn listed(items: &[impl AsRef<str>], last: &str) -> String {
    match items {
        [] => String::new(),
        [one] => one.as_ref().to_owned(),
        [others @ .., end] => {
            let others: Vec<_> = others.iter().map(AsRef::as_ref).collect();
            format!("{} {last} {}", others.join(", "), end.as_ref())
        }
    }
}

fn capitalized(text: &str) -> String {
    let mut letters = text.chars();
    let first = letters.next().map(char::to_uppercase).into_iter().flatten();
    first.chain(letters).collect()
}

#[cfg(test)]
mod tests {
    use super::super::example;
    use super::*;
    use gap::diagnosis::{MeasuredBy, Tried};

    #[test]
    fn the_paragraph_states_location_effect_and_shrinkage() {
        assert_eq!(
            paragraph(&example::stribeck(), &example::labels()),
            "Most of the gap (71 %) sits at low speed (velocities of −2.9 to 2.9 °/s), in 12 % of the samples. \
             Static friction 1.4 times the sliding level explains it: the gap falls from 0.56° to 0.12° (floor \
             0.020°) on data the fit has not seen. Viscous friction and delay do not. To tell static friction from \
             presliding, run a ramp with amplitude 0.020 N m and duration 10 s."
        );
    }

    #[test]
    fn a_gap_that_is_spread_evenly_has_no_location() {
        let mut diagnosis = example::stribeck();
        diagnosis.regions.clear();
        let text = paragraph(&diagnosis, &example::labels());
        assert!(
            text.starts_with("No part of the recording carries clearly more of the gap"),
            "{text}"
        );
    }

    #[test]
    fn a_reversed_sign_is_reported_first() {
        let labels = Labels {
            turned: Some("position"),
            ..example::labels()
        };
        let text = paragraph(&example::stribeck(), &labels);
        assert!(
            text.starts_with(
                "Input and position have opposite signs, so the sign of position is reversed"
            ),
            "{text}"
        );
    }

    #[test]
    fn data_that_was_not_held_out_is_not_called_held_out() {
        let mut diagnosis = example::stribeck();
        diagnosis.effects[0].held_out = false;
        let text = paragraph(&diagnosis, &example::labels());
        assert!(
            text.contains("falls from 0.56° to 0.12° (floor 0.020°)."),
            "{text}"
        );
    }

    #[test]
    fn without_a_gap_nothing_is_named() {
        let mut diagnosis = example::stribeck();
        diagnosis.verdict = Verdict::NoGap;
        diagnosis.effects.clear();
        let text = paragraph(&diagnosis, &example::labels());
        assert!(
            !text.contains("friction") && text.contains("tolerances"),
            "{text}"
        );
    }

    #[test]
    fn an_unexplained_gap_still_has_a_location() {
        let mut diagnosis = example::stribeck();
        diagnosis.verdict = Verdict::Unexplained;
        diagnosis.effects.clear();
        diagnosis.next_experiment = None;
        let text = paragraph(&diagnosis, &example::labels());
        assert!(text.starts_with("Most of the gap (71 %)"), "{text}");
        assert!(
            text.contains("no effect of the library") && !text.contains("explains it"),
            "{text}"
        );
    }

    #[test]
    fn numbers_that_close_a_gap_without_an_effect_are_said_to_do_so() {
        let mut diagnosis = example::stribeck();
        diagnosis.verdict = Verdict::Unexplained;
        diagnosis.effects.clear();
        diagnosis.numbers = vec![example::moved_number()];
        let text = paragraph(&diagnosis, &example::labels());
        assert!(
            text.contains("By these numbers alone") && text.contains("No effect of the library"),
            "{text}"
        );
    }

    /// Adds a delay to the example.
    fn with_a_delay() -> Diagnosis {
        let mut diagnosis = example::stribeck();
        let mut delay = diagnosis.effects[0].clone();
        delay.name = "delay";
        delay.not_separable_from.clear();
        let time = delay.parameters["static_ratio"].clone();
        let late = gap::diagnosis::Estimate {
            value: 0.003,
            unit: "s".into(),
            ..time
        };
        delay.parameters = [("time".to_owned(), late)].into();
        diagnosis.effects.push(delay);
        diagnosis
    }

    #[test]
    fn an_uncertain_effect_that_closes_little_is_mentioned_separately() {
        let mut diagnosis = with_a_delay();
        diagnosis.effects[1].shrink = 0.02;
        let both = "sliding level and a torque that comes 3.0 ms late explain it";
        assert!(paragraph(&diagnosis, &example::labels()).contains(both));
        diagnosis.effects[1].confidence = 0.5;
        let text = paragraph(&diagnosis, &example::labels());
        assert!(
            text.contains("sliding level explains it")
                && text.contains("A torque that comes 3.0 ms late may be there, too"),
            "{text}"
        );
    }

    #[test]
    fn two_effects_share_a_sentence_and_the_remainder_is_stated() {
        let mut diagnosis = with_a_delay();
        diagnosis.verdict = Verdict::PartlyExplained;
        diagnosis.candidates.truncate(1);
        let text = paragraph(&diagnosis, &example::labels());
        assert!(
            text.contains("sliding level and a torque that comes 3.0 ms late explain part of it"),
            "{text}"
        );
        assert!(
            text.contains("Something more may be left")
                && text.contains("Viscous friction does not."),
            "{text}"
        );
    }

    #[test]
    fn a_tied_candidate_is_not_ruled_out() {
        let mut diagnosis = example::stribeck();
        let tied = Tried {
            name: "presliding",
            after: 0.002,
            why_not: String::new(),
        };
        diagnosis.candidates.insert(0, tied);
        diagnosis.next_experiment = None;
        let text = paragraph(&diagnosis, &example::labels());
        assert!(
            text.contains("cannot tell static friction from presliding"),
            "{text}"
        );
        assert!(!text.contains("Presliding"), "{text}");
    }

    #[test]
    fn candidates_that_no_experiment_separates_are_listed_too() {
        let mut diagnosis = example::stribeck();
        diagnosis.effects[0]
            .not_separable_from
            .push("friction_drift");
        let text = paragraph(&diagnosis, &example::labels());
        assert!(
            text.contains("To tell static friction from presliding, run a ramp")
                && text
                    .contains("This recording cannot tell static friction from drifting friction."),
            "{text}"
        );
    }

    #[test]
    fn candidates_tried_in_addition_to_the_finding_are_not_ruled_out() {
        let mut diagnosis = example::stribeck();
        let on_top = Tried {
            name: "lag",
            after: 0.115f64.to_radians(),
            why_not: String::new(),
        };
        diagnosis.candidates.insert(0, on_top);
        let text = paragraph(&diagnosis, &example::labels());
        assert!(
            text.contains("Viscous friction and delay do not."),
            "{text}"
        );
    }

    #[test]
    fn a_time_in_one_of_several_runs_names_the_run() {
        let mut diagnosis = example::stribeck();
        diagnosis.regions[0] = Region {
            axis: "time",
            from: Some(1.2),
            to: Some(1.6),
            name: None,
            run: Some(1),
            measured_by: MeasuredBy::ShortPredictions,
            share_of_gap: 0.4,
            share_of_gap_interval: [0.3, 0.5],
            share_of_samples: 0.04,
            profile: None,
        };
        let text = paragraph(&diagnosis, &example::labels());
        assert!(
            text.starts_with(
                "A share of the gap (40 %) sits in the time from 1.20 to 1.60 s of step.csv"
            ),
            "{text}"
        );
    }
}
