//! The report as one page that needs nothing else.

use super::bar::{Tone, bar};
use super::charts::{Charts, RUNS};
use super::course::{arising, courses};
use super::effect;
use super::paragraph::{experiment, headline, on_which_data, paragraph};
use super::quantity::{Display, percent, show};
use super::region::{self, Labels};
use crate::plot::PlotError;
use gap::Outcome;
use gap::diagnosis::{Diagnosis, Finding};
use recording::{Model, Recording};

const STYLE: &str = include_str!("page.css");
/// Axes along which the residual is always shown.
const AXES: [&str; 2] = ["velocity", "position"];
/// Further ones, shown where a part of the gap lies on them.
const MORE_AXES: [&str; 2] = ["input", "acceleration"];
/// Rivals that are listed.
const CANDIDATES: usize = 12;

/// The page of a diagnosis.
///
/// # Errors
/// [`PlotError`] if a plot cannot be drawn.
pub fn page(recording: &Recording, outcome: &Outcome) -> Result<String, PlotError> {
    let labels = Labels::of(recording);
    let diagnosis = &outcome.diagnosis;
    let title = match recording.title.trim() {
        "" => "Untitled recording",
        title => title,
    };
    let sections = [
        findings(diagnosis),
        shrinks(diagnosis),
        plots(recording, outcome, &labels)?,
        regions(diagnosis, &labels),
        candidates(diagnosis),
        numbers(recording, &outcome.model.model),
        next(diagnosis, &labels),
        warnings(diagnosis),
        method(recording, diagnosis),
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

/// The four numbers that matter.
fn tiles(diagnosis: &Diagnosis) -> String {
    let gap = &diagnosis.gap;
    let display = Display::of(&gap.unit, gap.before);
    let mut tiles = vec![
        ("gap", display.show(gap.before)),
        ("floor", display.show(gap.floor)),
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

fn table(heads: &[&str], rows: impl Iterator<Item = String>) -> String {
    let heads: String = heads
        .iter()
        .map(|head| format!("<th>{head}</th>"))
        .collect();
    let rows: String = rows.collect();
    format!(
        "<div class=\"wide\"><table>\n<thead><tr>{heads}</tr></thead>\n<tbody>\n{rows}</tbody>\n</table></div>\n"
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
        let held = match estimate.std > 0.0 {
            true => "",
            false => " <small>held</small>",
        };
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
            "<p class=\"note\">Held: {}.</p>\n",
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
        table(&["parameter", "value ± standard deviation"], rows)
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
    let least = all
        .iter()
        .fold(0.0, |least: f64, (.., [low, _])| least.min(*low));
    let range = least..1.0;
    let rows = all.into_iter().map(|(name, shrink, interval)| {
        format!(
            "<tr><td>{}</td><td class=\"cell\">{}</td><td class=\"number\">{}<br><small>{} to {}</small></td></tr>\n",
            escaped(name),
            bar(shrink, &range, Some(interval), Tone::Corrected),
            percent(shrink),
            percent(interval[0]),
            percent(interval[1])
        )
    });
    let body = table(
        &[
            "effect",
            "share of the way to the floor",
            "with 95 % interval",
        ],
        rows,
    );
    section(
        &format!("How far the gap shrinks{}", on_which_data(diagnosis)),
        &body,
    )
}

fn plots(recording: &Recording, outcome: &Outcome, labels: &Labels) -> Result<String, PlotError> {
    let courses = courses(recording, outcome);
    let regions = &outcome.diagnosis.regions;
    let (short_s, arising) = arising(recording, outcome);
    let charts = Charts {
        courses: &courses,
        arising: &arising,
        regions,
        labels,
        horizon_s: recording.horizon,
        half_width_s: recording.restart_half_width,
    };
    let figure = |svg: String| format!("<figure>{svg}</figure>\n");
    let mut body = String::new();
    if let Some(svg) = charts.stretch() {
        body.push_str(&legend(!outcome.diagnosis.effects.is_empty()));
        body.push_str(&figure(svg?));
    }
    let seen = section(
        "What was measured, and what the models make of it",
        &format!(
            "{body}<p class=\"note\">The models are re-started from the measurement every {}; in between they see the \
             input alone.</p>\n",
            show(recording.horizon, "s")
        ),
    );
    let mut body = String::new();
    if !regions.is_empty() {
        body.push_str("<p class=\"note\">Marked: the parts that carry more of the gap than their share of the samples, along two axes \
             where it arises, and along a third where that is plain, too, or where it has grown largest.</p>\n");
    }
    for svg in charts.over_time()? {
        body.push_str(&figure(svg));
    }
    if courses.len() > RUNS {
        body.push_str(&format!(
            "<p class=\"note\">The {RUNS} of {} runs that carry most of the gap.</p>\n",
            courses.len()
        ));
    }
    body.push_str(&format!(
        "<p class=\"note\">Along velocity and the like, predictions of {} show where the gap arises, before it has \
         grown.</p>\n",
        show(short_s, "s")
    ));
    let more = MORE_AXES
        .into_iter()
        .filter(|axis| regions.iter().any(|region| region.axis == *axis));
    for axis in AXES.into_iter().chain(more) {
        if let Some(svg) = charts.along(axis) {
            body.push_str(&figure(svg?));
        }
    }
    if let Some(svg) = charts.over_frequency() {
        body.push_str(&figure(svg?));
    }
    Ok(seen
        + &section(
            "What the models miss: over time, velocity, position and frequency",
            &body,
        ))
}

/// For screens too narrow for that of the plots.
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
        let run = run.map_or(String::new(), |file| format!("<br><small>{}</small>", escaped(file)));
        format!(
            "<tr><td>{}</td><td>{}{run}</td><td class=\"number\">{}</td><td class=\"number\">{}</td></tr>\n",
            region.axis,
            escaped(&region::range(region, labels)),
            percent(region.share_of_gap),
            percent(region.share_of_samples)
        )
    });
    let body = table(
        &["along", "from … to", "of the gap", "of the samples"],
        rows,
    );
    section("Where the gap lies", &body)
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
    let range = 0.0..largest;
    let row = |name: &str, note: &str, value: f64, tone: Tone| {
        format!(
            "<tr><td>{}<br><small>{}</small></td><td class=\"cell\">{}</td><td class=\"number\">{}</td></tr>\n",
            escaped(name),
            escaped(note),
            bar(value, &range, None, tone),
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
    let mut body = table(&["with", "gap that is left", ""], rows.into_iter());
    if !diagnosis.effects.is_empty() {
        body.push_str(
            "<p class=\"note\">What leaves about as little as what was found was tried on top of it.</p>\n",
        );
    }
    section("What else was tried", &body)
}

/// Numbers of the nominal model that moved within their tolerances.
fn numbers(recording: &Recording, corrected: &Model) -> String {
    let moved = Model::NAMES.into_iter().filter_map(|name| {
        let (stated, now) = (recording.model.get(name)?, corrected.get(name)?);
        (stated != now).then(|| {
            let relative = (now - stated) / stated;
            format!(
                "<tr><td><code>{name}</code></td><td class=\"number\">{stated:.4e} ± {}</td><td class=\"number\">{now:.4e} \
                 <small>({:+.1} %)</small></td></tr>\n",
                percent(recording.tolerance.of(name)),
                100.0 * relative
            )
        })
    });
    let rows: Vec<_> = moved.collect();
    if rows.is_empty() {
        return String::new();
    }
    let body = table(
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
         position; the floor is what noise, quantising and the restarts would leave of it with a perfect model.</p>\n\
         <p>Each effect of the library was switched into the simulation and its numbers were fitted so that the \
         prediction matches, with the model’s own numbers free within the tolerances stated for them. What it gains was \
         then judged on windows that the fit had not seen. An effect is named only if that gain is beyond chance and the \
         prediction is no worse at a quarter of the time between restarts; further effects are fitted together with those \
         before. Intervals are 95 %, by resampling the windows. This took {}.</p>\n",
        show(duration_s, "s"),
        show(recording.horizon, "s"),
        show(diagnosis.elapsed_s, "s")
    );
    section("What was done", &body)
}

/// An equation with its indices below the line and its powers above.
fn equation_in_html(equation: &str) -> String {
    let safe = escaped(equation);
    let indices = shifted(&safe, '_', "sub");
    shifted(&indices, '^', "sup")
}

/// What follows on each `mark`, as far as it is one word, in an element of its own.
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

/// Text that is safe within HTML.
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
    use gap::CorrectedModel;
    use gap::diagnosis::{Region, Verdict};
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
                model: Model {
                    coulomb: 1e-3,
                    ..Model::new(5.8e-4)
                },
                effects: vec![corrected],
            },
        }
    }

    #[test]
    fn the_page_needs_nothing_else_and_is_well_formed() {
        let mut diagnosis = example::stribeck();
        let time = Region {
            axis: "time",
            from: Some(1.0),
            to: Some(1.4),
            run: Some(1),
            ..diagnosis.regions[0].clone()
        };
        let band = Region {
            axis: "frequency",
            from: Some(20.0),
            to: Some(28.0),
            ..diagnosis.regions[0].clone()
        };
        diagnosis.regions.extend([time, band]);
        let html = page(&recording(), &outcome(diagnosis)).unwrap();
        let elsewhere = html.replace("http://www.w3.org/2000/svg", "");
        for outside in [
            "http:", "https:", "src=", "url(", "@import", "<script", "<link",
        ] {
            assert!(!elsewhere.contains(outside), "{outside}");
        }
        assert!(html.contains("Paddle &lt;24&gt; &amp; &quot;co&quot;"));
        assert!(!html.contains("NaN"));
        for tag in [
            "section", "table", "figure", "svg", "tr", "td", "article", "dl", "p",
        ] {
            let opened = html.matches(&format!("<{tag}>")).count()
                + html.matches(&format!("<{tag} ")).count();
            assert_eq!(opened, html.matches(&format!("</{tag}>")).count(), "{tag}");
        }
        // Stretch, two runs over time, velocity, position, frequency.
        assert_eq!(html.matches("<figure>").count(), 6);
    }

    #[test]
    fn without_effects_there_is_no_corrected_model_to_show() {
        let mut diagnosis = example::stribeck();
        diagnosis.verdict = Verdict::Unexplained;
        diagnosis.effects.clear();
        let html = page(&recording(), &outcome(diagnosis)).unwrap();
        assert!(!html.contains("corrected model") && html.contains("nominal model"));
    }
}
