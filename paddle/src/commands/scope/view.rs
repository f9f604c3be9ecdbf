//! Draws the scope.

use super::state::{Panel, Scope, Trace};
use ratatui::Frame;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::{Color, Modifier, Style, Stylize};
use ratatui::symbols::Marker;
use ratatui::text::{Line, Span};
use ratatui::widgets::{Axis, Chart, Dataset, GraphType, Paragraph};

/// One colour per channel, in the order of [`link::Channel::ALL`]. Without colour the names distinguish the channels.
const INKS: [Color; 7] = [
    Color::Yellow,
    Color::Cyan,
    Color::Green,
    Color::Magenta,
    Color::Red,
    Color::Blue,
    Color::White,
];
/// Free space above and below the signals, as a share of their range.
const MARGIN: f64 = 0.05;
/// Smallest range of a vertical axis in its unit, so that noise does not look like motion.
const LEAST_SPAN: f64 = 1e-2;
const KEYS: &str = "q leave  x stop all  space hold  +/- zoom  1-7 channels  tab gain  up/down change  c capture  l live  : console";

/// Draws the complete screen.
pub fn draw(frame: &mut Frame, scope: &Scope, port: &str) {
    let [head, gains, plots, said, keys] = Layout::vertical([
        Constraint::Length(1),
        Constraint::Length(1),
        Constraint::Fill(1),
        Constraint::Length(1),
        Constraint::Length(1),
    ])
    .areas(frame.area());
    frame.render_widget(headline(scope, port), head);
    frame.render_widget(gain_line(scope), gains);
    let traces = scope.traces();
    let panels: Vec<Panel> = Panel::ALL
        .into_iter()
        .filter(|panel| traces.iter().any(|trace| trace.panel == *panel))
        .collect();
    let rows = Layout::vertical(panels.iter().map(|_| Constraint::Fill(1))).split(plots);
    for (panel, area) in panels.iter().zip(rows.iter()) {
        let own: Vec<&Trace> = traces
            .iter()
            .filter(|trace| trace.panel == *panel)
            .collect();
        plot(frame, *area, *panel, &own, scope.span_s());
    }
    let line = match &scope.line {
        Some(line) => format!("> {line}_"),
        None => scope.said.clone(),
    };
    frame.render_widget(Paragraph::new(line), said);
    frame.render_widget(Paragraph::new(KEYS.dim()), keys);
}

fn headline<'a>(scope: &Scope, port: &'a str) -> Line<'a> {
    let mut spans = vec![
        Span::from(port).bold(),
        Span::from(format!("  {}", scope.mode())),
    ];
    if scope.shows_capture() {
        spans.push("  capture, 20 kHz".into());
    } else if scope.held {
        spans.push("  held".into());
    }
    if scope.awaits {
        spans.push("  waits for the trigger".into());
    }
    if scope.lost > 0 {
        spans.push(Span::from(format!("  {} rows lost", scope.lost)).red());
    }
    if let Some(fault) = scope.fault() {
        spans.push(Span::from(format!("  {fault}")).red().bold());
    }
    Line::from(spans)
}

fn gain_line(scope: &Scope) -> Line<'static> {
    let gains = scope.gains.iter().enumerate().map(|(at, gain)| {
        let text = format!(" {} {} ", gain.name, gain.value);
        match at == scope.chosen {
            true => text.add_modifier(Modifier::REVERSED),
            false => text.into(),
        }
    });
    Line::from_iter(gains)
}

fn plot(frame: &mut Frame, area: Rect, panel: Panel, traces: &[&Trace], span_s: [f64; 2]) {
    let datasets = traces.iter().map(|trace| {
        Dataset::default()
            .name(trace.channel.name())
            .marker(Marker::Braille)
            .graph_type(GraphType::Line)
            .style(INKS[trace.channel as usize % INKS.len()])
            .data(&trace.points)
    });
    let bounds = bounds(traces);
    let labels =
        |[low, high]: [f64; 2], digits: usize| [low, high].map(|at| format!("{at:.digits$}"));
    let digits = if bounds[1] - bounds[0] < 1.0 { 3 } else { 1 };
    let chart = Chart::new(datasets.collect())
        .x_axis(
            Axis::default()
                .style(Style::new().dim())
                .bounds(span_s)
                .labels(labels(span_s, 2).map(|label| format!("{label} s"))),
        )
        .y_axis(
            Axis::default()
                .title(panel.unit())
                .style(Style::new().dim())
                .bounds(bounds)
                .labels(labels(bounds, digits)),
        );
    frame.render_widget(chart, area);
}

/// Lower and upper end of a vertical axis.
fn bounds(traces: &[&Trace]) -> [f64; 2] {
    let values = traces.iter().flat_map(|trace| &trace.points);
    let [low, high] = values.fold(
        [f64::INFINITY, f64::NEG_INFINITY],
        |[low, high], (_, at)| [low.min(*at), high.max(*at)],
    );
    if low > high {
        return [-1.0, 1.0];
    }
    let margin = f64::max(MARGIN * (high - low), 0.5 * LEAST_SPAN);
    [low - margin, high + margin]
}

#[cfg(test)]
mod tests {
    use super::*;
    use haptic_paddle::settings::Settings;
    use link::{Channel, Channels};
    use ratatui::Terminal;
    use ratatui::backend::TestBackend;
    use remote::Row;

    fn shown(scope: &Scope, width: u16, height: u16) -> String {
        let mut terminal = Terminal::new(TestBackend::new(width, height)).unwrap();
        terminal
            .draw(|frame| draw(frame, scope, "/dev/ttyUSB0"))
            .unwrap();
        terminal.backend().to_string()
    }

    fn scope() -> Scope {
        let channels = Channels::NONE.with(Channel::Encoder).with(Channel::Current);
        let mut scope = Scope::new(channels, 1.0, &Settings::default());
        let rows = (0..100).map(|at| {
            let values = [
                (Channel::Encoder, (at as f32 * 0.1).sin() * 0.2),
                (Channel::Current, 0.1),
                (Channel::Mode, 3.0),
                (Channel::Fault, 5.0),
            ];
            Row::new(at * 200, values)
        });
        scope.take(rows.collect());
        scope
    }

    #[test]
    fn each_unit_has_a_plot_and_the_selected_gain_is_shown() {
        let mut scope = scope();
        scope.lost = 3;
        let shown = shown(&scope, 100, 30);
        for part in [
            "/dev/ttyUSB0  position  3 rows lost  paddle outside its travel",
            "pid.kp 0.05",
            "encoder",
            "current",
            "deg",
            "-1.00 s",
            "q leave",
        ] {
            assert!(shown.contains(part), "no {part:?} in\n{shown}");
        }
        let braille = |letter: char| ('\u{2801}'..='\u{28ff}').contains(&letter);
        assert!(
            shown.chars().filter(|letter| braille(*letter)).count() > 100,
            "{shown}"
        );
        assert!(!shown.contains("mN m"), "{shown}");
    }

    #[test]
    fn the_scope_can_be_drawn_at_any_terminal_size() {
        let scope = scope();
        for (width, height) in [(1, 1), (3, 2), (20, 5), (300, 100)] {
            shown(&scope, width, height);
        }
    }

    #[test]
    fn a_constant_signal_still_has_a_plot() {
        let channels = Channels::NONE.with(Channel::Duty);
        let empty = Scope::new(channels, 1.0, &Settings::default());
        assert!(shown(&empty, 80, 20).contains('%'));
    }
}
