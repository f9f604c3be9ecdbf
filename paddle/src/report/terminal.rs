//! Formats a diagnosis for a terminal.

use super::effect;
use super::paragraph::{experiment, floors, headline, paragraph};
use super::quantity::{Display, hundredths, percent};
use super::region::{self, Labels};
use gap::diagnosis::{Diagnosis, Finding};
use std::fmt::Write;

const COLUMNS: usize = 96;
/// Largest number of listed regions and of listed candidates.
const MOST: usize = 4;

/// The complete text: verdict, paragraph, effects with their parameters, regions, candidates and warnings.
pub fn text(diagnosis: &Diagnosis, labels: &Labels) -> String {
    let mut text = String::new();
    for warning in &diagnosis.warnings {
        line(&mut text, format_args!("warning: {warning}"));
    }
    line(&mut text, format_args!("{}\n", headline(diagnosis.verdict)));
    text.push_str(&wrapped(&paragraph(diagnosis, labels)));
    let display = Display::of(&diagnosis.gap.unit, diagnosis.gap.before);
    text.push_str(&wrapped(&format!(
        "Without any model, a position that stays where it was at the restart would leave {}, one that goes on at its velocity {}.",
        display.show(diagnosis.gap.standing),
        display.show(diagnosis.gap.coasting)
    )));
    if let Some(floors) = floors(diagnosis) {
        text.push_str(&wrapped(&floors));
    }
    if !diagnosis.effects.is_empty() {
        line(
            &mut text,
            format_args!(
                "\n{:<28}{:>6}   {:<24}parameters",
                "effect", "sure", "shrink (95 %)"
            ),
        );
        for finding in &diagnosis.effects {
            row(&mut text, finding);
        }
    }
    if !diagnosis.regions.is_empty() {
        line(
            &mut text,
            format_args!("\n{:<44}{:>8}{:>12}", "where", "of gap", "of samples"),
        );
        for region in diagnosis.regions.iter().take(MOST) {
            line(
                &mut text,
                format_args!(
                    "{:<44}{:>8}{:>12}",
                    format!("{} {}", region.axis, region::range(region, labels)),
                    percent(region.share_of_gap),
                    percent(region.share_of_samples)
                ),
            );
        }
    }
    if !diagnosis.candidates.is_empty() {
        let display = Display::of(&diagnosis.gap.unit, diagnosis.gap.before);
        line(
            &mut text,
            format_args!("\n{:<44}{:>8}  why not", "tried as well", "leaves"),
        );
        for tried in diagnosis.candidates.iter().take(MOST) {
            line(
                &mut text,
                format_args!(
                    "{:<44}{:>8}  {}",
                    tried.name,
                    display.show(tried.after),
                    tried.why_not
                ),
            );
        }
    }
    if let Some(next) = &diagnosis.next_experiment {
        line(
            &mut text,
            format_args!("\nnext: {}", experiment(next, labels)),
        );
    }
    line(&mut text, format_args!("\n{:.1} s", diagnosis.elapsed_s));
    text
}

fn row(text: &mut String, finding: &Finding) {
    let [low, high] = finding.shrink_interval.map(hundredths);
    let (told, _) = effect::parameters(finding);
    let mut parameters = told.into_iter().map(|(name, estimate)| {
        let why = effect::why_no_std(estimate).map_or(String::new(), |why| format!(" ({why})"));
        format!("{name} {}{why}", effect::with_std(estimate))
    });
    line(
        text,
        format_args!(
            "{:<28}{:>6}   {:<24}{}",
            finding.name,
            percent(finding.confidence),
            format!("{} ({low} to {high})", hundredths(finding.shrink)),
            parameters.next().unwrap_or_default()
        ),
    );
    for parameter in parameters {
        line(text, format_args!("{:<61}{parameter}", ""));
    }
    if !finding.not_separable_from.is_empty() {
        let rivals = finding.not_separable_from.join(", ");
        line(
            text,
            format_args!("  or {rivals}: not told apart by this recording"),
        );
    }
}

fn line(text: &mut String, line: std::fmt::Arguments<'_>) {
    // Writing to a String cannot fail.
    let _ = writeln!(text, "{line}");
}

/// Wraps text at [`COLUMNS`] columns, between words.
fn wrapped(text: &str) -> String {
    let mut lines = String::new();
    let mut width = 0;
    for word in text.split(' ') {
        let length = word.chars().count();
        if width > 0 && width + 1 + length > COLUMNS {
            lines.push('\n');
            width = 0;
        } else if width > 0 {
            lines.push(' ');
            width += 1;
        }
        lines.push_str(word);
        width += length;
    }
    lines + "\n"
}

#[cfg(test)]
mod tests {
    use super::super::example;
    use super::*;

    #[test]
    fn the_text_contains_all_findings_and_its_lines_are_short() {
        let text = text(&example::stribeck(), &example::labels());
        for said in [
            "warning: sine.csv: 3 gaps in time",
            "The gap is explained",
            "static_ratio 1.400 ± 0.050",
            "0.81 (0.76 to 0.85)",
            "97 %",
            "or presliding",
            "velocity −2.9 to 2.9 °/s",
            "a ramp",
        ] {
            assert!(text.contains(said), "{said} is not in\n{text}");
        }
        assert!(
            text.lines().all(|line| line.chars().count() <= 110),
            "{text}"
        );
    }
}
