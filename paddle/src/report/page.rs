//! The report as a self-contained HTML page.

use super::bar::{Tone, bar};
use super::charts::{Charts, RUNS};
use super::effect;
use super::missing_torque;
use super::paragraph::{experiment, floors, headline, on_which_data, paragraph};
use super::predicted_run::predicted_runs;
use super::quantity::{Display, percent, show};
use super::region::{self, Labels};
use crate::plot::PlotError;
use crate::provenance::Provenance;
use gap::Outcome;
use gap::diagnosis::{Diagnosis, Finding};
use recording::{Model, Recording};

const STYLE: &str = include_str!("page.css");
/// Number of rejected candidates in the table.
const CANDIDATES: usize = 12;

/// The page of a diagnosis, with its provenance.
///
/// # Errors
/// Returns [`PlotError`] if a plot cannot be drawn.
pub fn page(
    recording: &Recording,
    outcome: &Outcome,
    provenance: &Provenance,
) -> Result<String, PlotError> {
    let labels = Labels::of(recording);
    let diagnosis = &outcome.diagnosis;
    let title = match recording.title.trim() {
        "" => "Untitled recording",
        title => title,
    };
    let sections = [
        missing(recording, outcome)?,
        findings(diagnosis),
        shrinks(diagnosis),
        plots(recording, outcome, &labels)?,
        candidates(diagnosis),
        numbers(recording, &outcome.model.model),
        next(diagnosis, &labels),
        warnings(diagnosis),
        method(recording, diagnosis),
        origin(provenance),
    ];
    Ok(format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>Gap of {title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n<header>\n\
         <p class=\"recording\">{title}</p>\n<h1>{}</h1>\n<p class=\"answer\">{}</p>\n{}</header>\n<main>\n{}</main>\n\
         </body>\n</html>\n",
        headline(diagnosis.verdict),
        escaped(&paragraph(diagnosis, &labels)),
        tiles(diagnosis),
        sections.concat(),
        title = escaped(title),
    ))
}

/// The main results, with the gaps of two predictors that use no model.
fn tiles(diagnosis: &Diagnosis) -> String {
    let gap = &diagnosis.gap;
    let display = Display::of(&gap.unit, gap.before);
    let mut tiles = vec![
        ("gap", display.show(gap.before)),
        ("floor", display.show(gap.floor)),
        ("if the position stayed", display.show(gap.standing)),
        ("if the velocity stayed", display.show(gap.coasting)),
    ];
    if !diagnosis.effects.is_empty() {
        tiles.insert(1, ("after correction", display.show(gap.after)));
        let [low, high] = gap.shrink_interval;
        let interval = format!(
            "{} <small>({} to {})</small>",
            percent(gap.shrink),
            percent(low),
            percent(high)
        );
        tiles.push(("closed", interval));
    }
    let tiles: String = tiles
        .iter()
        .map(|(name, value)| format!("<div><dt>{name}</dt><dd>{value}</dd></div>\n"))
        .collect();
    format!("<dl class=\"tiles\">\n{tiles}</dl>\n")
}

fn section(heading: &str, body: &str) -> String {
    match body.is_empty() {
        true => String::new(),
        false => format!("<section>\n<h2>{heading}</h2>\n{body}</section>\n"),
    }
}

fn table(caption: &str, heads: &[&str], rows: impl Iterator<Item = String>) -> String {
    let heads: String = heads
        .iter()
        .map(|head| format!("<th scope=\"col\">{head}</th>"))
        .collect();
    let rows: String = rows.collect();
    format!(
        "<div class=\"wide\"><table>\n<caption>{caption}</caption>\n<thead><tr>{heads}</tr></thead>\n<tbody>\n{rows}</tbody>\n</table></div>\n"
    )
}

fn findings(diagnosis: &Diagnosis) -> String {
    let body: String = diagnosis.effects.iter().map(finding).collect();
    section("What it is", &body)
}

fn finding(finding: &Finding) -> String {
    let (about, equation) = effect::explained(finding.name);
    let rivals: Vec<_> = finding
        .not_separable_from
        .iter()
        .map(|name| effect::noun(name))
        .collect();
    let tied = match rivals.is_empty() {
        true => String::new(),
        false => format!(
            "<p>With this recording it cannot be told from {}.</p>\n",
            escaped(&rivals.join(", "))
        ),
    };
    let (told, held) = effect::parameters(finding);
    let rows = told.into_iter().map(|(name, estimate)| {
        let why = effect::why_no_std(estimate);
        let held = why.map_or(String::new(), |why| format!(" <small>{why}</small>"));
        format!(
            "<tr><td><code>{}</code><br><small>{}</small></td><td>{}{held}</td></tr>\n",
            escaped(name),
            escaped(effect::parameter(finding.name, name)),
            escaped(&effect::with_std(estimate))
        )
    });
    let held = held.into_iter();
    let held = held.map(|(name, estimate)| format!("{name} {}", effect::with_std(estimate)));
    let held: Vec<_> = held.collect();
    let held = match held.is_empty() {
        true => String::new(),
        false => format!(
            "<p class=\"note\">Not fitted: {}.</p>\n",
            escaped(&held.join(", "))
        ),
    };
    format!(
        "<article>\n<h3><code>{}</code> <small>{}, {} sure</small></h3>\n<p>{}. <span class=\"equation\">{}</span></p>\n\
         {tied}{}{held}</article>\n",
        escaped(finding.name),
        escaped(finding.channel),
        percent(finding.confidence),
        escaped(about),
        equation_in_html(equation),
        table(
            "Its numbers, with one standard deviation where that is known.",
            &["parameter", "value"],
            rows
        )
    )
}

fn shrinks(diagnosis: &Diagnosis) -> String {
    if diagnosis.effects.is_empty() {
        return String::new();
    }
    let gap = &diagnosis.gap;
    let each = diagnosis
        .effects
        .iter()
        .map(|e| (e.name, e.shrink, e.shrink_interval));
    let mut all: Vec<_> = each.collect();
    if all.len() > 1 {
        all.push(("all together", gap.shrink, gap.shrink_interval));
    }
    let rows = all.into_iter().map(|(name, shrink, interval)| {
        let worse = if shrink < 0.0 { "<br><small>no less than before</small>" } else { "" };
        format!(
            "<tr><td>{}</td><td class=\"cell\">{}</td><td class=\"number\">{}<br><small>{} to {}</small>{worse}</td></tr>\n",
            escaped(name),
            bar(shrink, 1.0, Some(interval), Tone::Corrected),
            percent(shrink),
            percent(interval[0]),
            percent(interval[1])
        )
    });
    let body = table(
        "Share of the way from the gap down to the floor, with its 95 % interval on another recording of the device. What is below zero has no bar.",
        &["effect", "share of the way", ""],
        rows,
    );
    section(
        &format!("How far the gap shrinks{}", on_which_data(diagnosis)),
        &body,
    )
}

/// Section about the torque that the nominal model lacks.
fn missing(recording: &Recording, outcome: &Outcome) -> Result<String, PlotError> {
    let (said, svg) = missing_torque::first(recording, outcome)?;
    let body = format!(
        "<p>{}</p>\n{}",
        escaped(&said),
        figure(&svg, missing_torque::CAPTION)
    );
    Ok(section("What torque the model lacks", &body))
}

fn figure(svg: &str, caption: &str) -> String {
    format!(
        "<figure>\n{svg}\n<figcaption>{}</figcaption>\n</figure>\n",
        escaped(caption)
    )
}

fn plots(recording: &Recording, outcome: &Outcome, labels: &Labels) -> Result<String, PlotError> {
    let predicted_runs = predicted_runs(recording, outcome);
    let charts = Charts {
        predicted_runs: &predicted_runs,
        regions: &outcome.diagnosis.regions,
        labels,
        horizon_s: recording.horizon,
    };
    let legend = legend(!outcome.diagnosis.effects.is_empty());
    let mut seen = String::new();
    if let Some(svg) = charts.stretch() {
        let caption = format!(
            "Position above, measured minus model below. The models are re-started from the measurement every {}; in \
             between they see the input alone.",
            show(recording.horizon, "s")
        );
        seen = legend.clone() + &figure(&svg?, &caption);
    }
    let mut missed = legend;
    for (svg, file) in charts.over_time()? {
        let caption = format!("What the models miss over all of {file}.");
        missed.push_str(&figure(&svg, &caption));
    }
    if predicted_runs.len() > RUNS {
        missed.push_str(&format!(
            "<p class=\"note\">The {RUNS} of {} runs that carry most of the gap.</p>\n",
            predicted_runs.len()
        ));
    }
    let mut shares = String::new();
    for captioned in charts.shares()? {
        shares.push_str(&figure(&captioned.svg, &captioned.caption));
    }
    let place = regions(&outcome.diagnosis, labels) + &shares;
    Ok(
        section("What was measured, and what the models make of it", &seen)
            + &section("What the models miss over time", &missed)
            + &section("Where the gap lies", &place),
    )
}

/// Legend for screens that are too narrow for the legend in the plots.
fn legend(corrected: bool) -> String {
    let corrected = match corrected {
        true => ", <b class=\"corrected\">corrected model</b>",
        false => "",
    };
    format!(
        "<p class=\"note\"><b class=\"measured\">measured</b>, <b class=\"nominal\">nominal model</b>{corrected}</p>\n"
    )
}

fn regions(diagnosis: &Diagnosis, labels: &Labels) -> String {
    if diagnosis.regions.is_empty() {
        return String::new();
    }
    let rows = diagnosis.regions.iter().map(|region| {
        let run = region.run.and_then(|run| labels.runs.get(run));
        let run = run.map_or(String::new(), |file| {
            format!("<br><small>{}</small>", escaped(file))
        });
        format!(
            "<tr><td>{}</td><td>{}{run}</td><td class=\"number\">{}<br><small>{} to {}</small></td>\
             <td class=\"number\">{}</td></tr>\n",
            region.axis,
            escaped(&region::range(region, labels)),
            percent(region.share_of_gap),
            percent(region.share_of_gap_interval[0]),
            percent(region.share_of_gap_interval[1]),
            percent(region.share_of_samples)
        )
    });
    table(
        "Parts that carry clearly more of the gap than their share of the samples: the lower end of the 95 % interval \
         is above it. Of a frequency the share is that of the power of motion and input.",
        &["along", "from … to", "of the gap", "of the samples"],
        rows,
    )
}

fn candidates(diagnosis: &Diagnosis) -> String {
    if diagnosis.candidates.is_empty() {
        return String::new();
    }
    let gap = &diagnosis.gap;
    let display = Display::of(&gap.unit, gap.before);
    let listed = diagnosis.candidates.iter().take(CANDIDATES);
    let largest = listed
        .clone()
        .map(|tried| tried.after)
        .fold(gap.before, f64::max);
    let row = |name: &str, note: &str, value: f64, tone: Tone| {
        format!(
            "<tr><td>{}<br><small>{}</small></td><td class=\"cell\">{}</td><td class=\"number\">{}</td></tr>\n",
            escaped(name),
            escaped(note),
            bar(value, largest, None, tone),
            display.show(value)
        )
    };
    let mut rows = vec![row("a perfect model", "the floor", gap.floor, Tone::Floor)];
    if !diagnosis.effects.is_empty() {
        let names: Vec<_> = diagnosis
            .effects
            .iter()
            .map(|e| effect::noun(e.name))
            .collect();
        rows.push(row(
            &names.join(" + "),
            "what was found",
            gap.after,
            Tone::Corrected,
        ));
    }
    rows.extend(listed.map(|tried| {
        row(
            effect::noun(tried.name),
            &tried.why_not,
            tried.after,
            Tone::Other,
        )
    }));
    rows.push(row(
        "the nominal model",
        "as stated in the recording",
        gap.before,
        Tone::Model,
    ));
    let mut body = table(
        "Gap that is left with each.",
        &["with", "gap that is left", ""],
        rows.into_iter(),
    );
    if !diagnosis.effects.is_empty() {
        body.push_str(
            "<p class=\"note\">What leaves about as little as what was found was tried on top of it.</p>\n",
        );
    }
    section("What else was tried", &body)
}

/// Numbers of the nominal model that changed within their tolerances.
fn numbers(recording: &Recording, corrected: &Model) -> String {
    let moved = Model::NAMES.into_iter().filter_map(|name| {
        let (stated, now) = (recording.model.get(name)?, corrected.get(name)?);
        (stated != now).then(|| {
            let relative = match stated == 0.0 {
                true => String::new(),
                false => format!(" <small>({:+.1} %)</small>", 100.0 * (now - stated) / stated),
            };
            format!(
                "<tr><td><code>{name}</code></td><td class=\"number\">{stated:.4e} ± {}</td><td class=\"number\">{now:.4e}{relative}</td></tr>\n",
                percent(recording.tolerance.of(name))
            )
        })
    });
    let rows: Vec<_> = moved.collect();
    if rows.is_empty() {
        return String::new();
    }
    let body = table(
        "Stated numbers that moved, within their tolerances.",
        &["number", "stated", "as fitted within that"],
        rows.into_iter(),
    );
    section("The model’s own numbers", &body)
}

fn next(diagnosis: &Diagnosis, labels: &Labels) -> String {
    let Some(next) = &diagnosis.next_experiment else {
        return String::new();
    };
    let names: Vec<_> = next
        .separates
        .iter()
        .map(|name| effect::noun(name))
        .collect();
    let body = format!(
        "<p>Run {}. The rival models ({}) then differ by {} times the noise, whatever their numbers are within what \
         this recording says of them.</p>\n",
        escaped(&experiment(next, labels)),
        escaped(&names.join(", ")),
        show(next.difference_over_noise, "1")
    );
    section("What to record next", &body)
}

fn warnings(diagnosis: &Diagnosis) -> String {
    let items: String = diagnosis
        .warnings
        .iter()
        .map(|warning| format!("<li>{}</li>\n", escaped(warning)))
        .collect();
    match items.is_empty() {
        true => String::new(),
        false => section("Warnings", &format!("<ul>\n{items}</ul>\n")),
    }
}

/// Provenance of the page: program, time and input files.
fn origin(provenance: &Provenance) -> String {
    let files = provenance.files.iter().map(|file| {
        format!(
            "<tr><td>{}</td><td><code class=\"hash\">{}</code></td></tr>\n",
            escaped(&file.file),
            file.sha256
        )
    });
    let body = format!(
        "<p>paddle {}, commit <code class=\"hash\">{}</code>, at {}: <code>{}</code></p>\n{}",
        provenance.version,
        provenance.commit,
        provenance.time,
        escaped(&provenance.command),
        table("What was read.", &["file", "SHA-256"], files)
    );
    section("Where this comes from", &body)
}

fn method(recording: &Recording, diagnosis: &Diagnosis) -> String {
    let samples: usize = recording.runs.iter().map(|run| run.time.len()).sum();
    let duration_s: f64 = recording.runs.iter().map(recording::Run::duration_s).sum();
    let runs = match recording.runs.len() {
        1 => "one run".into(),
        count => format!("{count} runs"),
    };
    let body = format!(
        "<p>{samples} samples of {runs}, {} in all. The model predicts the position from the input alone and is \
         re-started from the measured state every {}. The gap is the root mean square of measured minus predicted \
         position; the floor is what noise, quantising and the restarts would leave of it with a perfect model.{}</p>\n\
         <p>Each effect of the library was switched into the simulation and its numbers were fitted so that the \
         prediction matches, with the model’s own numbers free within the tolerances stated for them. What it gains was \
         then judged on windows that the fit had not seen. An effect is named only if that gain is beyond chance and the \
         prediction is no worse at a quarter of the time between restarts; further effects are fitted together with those \
         before. Intervals are 95 %, by resampling the windows. This took {}.</p>\n",
        show(duration_s, "s"),
        show(recording.horizon, "s"),
        floors(diagnosis).map_or(String::new(), |floors| format!(" {}", escaped(&floors))),
        show(diagnosis.elapsed_s, "s")
    );
    section("What was done", &body)
}

/// An equation with HTML subscripts and superscripts.
fn equation_in_html(equation: &str) -> String {
    let safe = escaped(equation);
    let indices = shifted(&safe, '_', "sub");
    shifted(&indices, '^', "sup")
}

/// Puts the word after each `mark` into an HTML element.
fn shifted(text: &str, mark: char, element: &str) -> String {
    let mut parts = text.split(mark);
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |html, part| {
        let end = part
            .find(|c: char| !c.is_alphanumeric())
            .unwrap_or(part.len());
        let (word, rest) = part.split_at(end);
        format!("{html}<{element}>{word}</{element}>{rest}")
    })
}

/// Escapes text for HTML.
fn escaped(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '"' => safe.push_str("&quot;"),
            other => safe.push(other),
        }
    }
    safe
}

#[cfg(test)]
mod tests {
    use super::super::example;
    use super::*;
    use crate::provenance;
    use gap::CorrectedModel;
    use gap::diagnosis::{FloorOf, MeasuredBy, Region, Verdict};
    use host_sim::effects::Effect;
    use recording::{Drive, Run};

    fn recording() -> Recording {
        let time: Vec<f64> = (0..4000).map(|k| f64::from(k) * 1e-3).collect();
        let position = time.iter().map(|t| 0.2 * (9.0 * t).sin()).collect();
        let input = time
            .iter()
            .map(|t| 1e-3 * (9.0 * t).cos())
            .collect::<Vec<_>>();
        let mut recording = Recording::new("Paddle <24> & \"co\"", 0.25, Model::new(5.755e-4));
        for file in ["sine.csv", "step.csv"] {
            let run = Run::new(
                file,
                Drive::OpenLoop,
                time.clone(),
                input.clone(),
                Vec::clone(&position),
            );
            recording.runs.push(run);
        }
        recording
    }

    fn outcome(diagnosis: Diagnosis) -> Outcome {
        let effect: Effect = "stribeck:static_ratio=1.4".parse().unwrap();
        let corrected = gap::CorrectedEffect {
            effect,
            sensor_on_load: false,
        };
        Outcome {
            diagnosis,
            model: CorrectedModel {
                tables: Vec::new(),
                model: Model {
                    coulomb: 1e-3,
                    ..Model::new(5.8e-4)
                },
                effects: vec![corrected],
            },
        }
    }

    #[test]
    fn the_page_is_self_contained_and_well_formed() {
        let mut diagnosis = example::stribeck();
        let time = Region {
            axis: "time",
            from: Some(1.0),
            to: Some(1.4),
            run: Some(1),
            profile: Some(example::profile("time", [0.0, 1.0, 1.4, 4.0])),
            ..diagnosis.regions[0].clone()
        };
        let band = Region {
            axis: "frequency",
            from: Some(20.0),
            to: Some(28.0),
            measured_by: MeasuredBy::Spectrum,
            profile: Some(example::profile("frequency", [3.0, 20.0, 28.0, 60.0])),
            ..diagnosis.regions[0].clone()
        };
        diagnosis.regions.extend([time, band]);
        let html = page(&recording(), &outcome(diagnosis), &provenance::example()).unwrap();
        let elsewhere = html.replace("http://www.w3.org/2000/svg", "");
        for outside in [
            "http:", "https:", "src=", "url(", "@import", "<script", "<link",
        ] {
            assert!(!elsewhere.contains(outside), "{outside}");
        }
        assert!(html.contains("Paddle &lt;24&gt; &amp; &quot;co&quot;"));
        assert!(!html.contains("NaN"));
        for tag in [
            "section",
            "table",
            "caption",
            "figure",
            "figcaption",
            "svg",
            "title",
            "desc",
            "tr",
            "td",
            "article",
            "dl",
            "p",
        ] {
            let opened = html.matches(&format!("<{tag}>")).count()
                + html.matches(&format!("<{tag} ")).count();
            assert_eq!(opened, html.matches(&format!("</{tag}>")).count(), "{tag}");
        }
        // The figures are: missing torque, worst interval, two runs over time, and shares along velocity, time and
        // frequency.
        let count = |text: &str| html.matches(text).count();
        assert_eq!(count("<figure>"), 7);
        for of_each in ["<figcaption>", "role=\"img\" aria-label=", "<desc>"] {
            assert_eq!(count(of_each), 7, "{of_each}");
        }
        assert_eq!(count("<table>"), count("<caption>"));
    }

    #[test]
    fn the_page_states_its_provenance() {
        let html = page(
            &recording(),
            &outcome(example::stribeck()),
            &provenance::example(),
        )
        .unwrap();
        for said in [
            "paddle 0.1.0",
            "0123abcd",
            "2026-01-02T03:04:05Z",
            "paddle gap diagnose 'a &amp; b'",
            "sine.csv",
            "00ff",
        ] {
            assert!(html.contains(said), "{said}");
        }
    }

    #[test]
    fn an_unknown_deviation_gives_no_interval() {
        let mut diagnosis = example::stribeck();
        let parameters = &mut diagnosis.effects[0].parameters;
        let ratio = parameters.get_mut("static_ratio").unwrap();
        ratio.std = None;
        let text = super::super::text(&diagnosis, &example::labels());
        let html = page(&recording(), &outcome(diagnosis), &provenance::example()).unwrap();
        for page in [text, html] {
            assert!(
                page.contains("uncertainty not known") && !page.contains("± 0.05"),
                "{page}"
            );
        }
    }

    #[test]
    fn a_shrink_below_zero_has_no_bar() {
        let mut diagnosis = example::stribeck();
        diagnosis.effects[0].shrink = -0.4;
        diagnosis.effects[0].shrink_interval = [-0.6, -0.2];
        let html = page(&recording(), &outcome(diagnosis), &provenance::example()).unwrap();
        let row = html
            .split("<tr>")
            .find(|row| row.contains("−40 %"))
            .unwrap();
        assert!(row.contains("width=\"0.0\""), "{row}");
    }

    #[test]
    fn without_effects_no_corrected_model_is_shown() {
        let mut diagnosis = example::stribeck();
        diagnosis.verdict = Verdict::Unexplained;
        diagnosis.effects.clear();
        diagnosis.gap.floor_of = FloorOf::NominalModel;
        let html = page(&recording(), &outcome(diagnosis), &provenance::example()).unwrap();
        assert!(!html.contains("corrected model") && html.contains("nominal model"));
    }
}
