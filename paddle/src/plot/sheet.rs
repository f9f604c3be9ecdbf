//! Common base of the charts: size, fonts, and the SVG text.

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// Drawing units per pixel. The library plotters draws on integer units, which would be visible in thin lines.
pub const UNIT: i32 = 10;
/// Width of every chart, pixels.
pub const WIDTH: i32 = 720;
/// Size of the small font, pixels.
pub const SMALL: f64 = 11.5;
/// Size of the font of titles, pixels.
pub const LARGE: f64 = 14.0;
/// Colour of all text.
pub const TEXT: RGBColor = RGBColor(0x33, 0x33, 0x33);
/// Colour of grid lines.
pub const GRID: RGBColor = RGBColor(0xE6, 0xE6, 0xE6);
/// Colour of axes.
pub const AXIS: RGBColor = RGBColor(0x88, 0x88, 0x88);

/// plotters sets fonts at 1/1.24 of the requested size.
const PLOTTERS_TYPE: f64 = 1.24;
/// Mean width of a character relative to the font size.
const CHARACTER_WIDTH: f64 = 0.56;

pub type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
pub type Failure = DrawingAreaErrorKind<std::io::Error>;

/// A chart could not be drawn.
#[derive(Debug, thiserror::Error)]
#[error("cannot draw the plot: {0}; report it with the command that you typed")]
pub struct PlotError(String);

/// Text description of a chart, for screen readers.
pub struct Words {
    /// Title of the chart.
    pub title: String,
    /// Description of the chart in sentences.
    pub description: String,
}

/// The SVG text of the drawing by `draw` on a white sheet that is `height` pixels high, with the description `words`.
pub fn draw(
    height: i32,
    words: &Words,
    draw: impl FnOnce(&Area<'_>) -> Result<(), Failure>,
) -> Result<String, PlotError> {
    let mut svg = String::new();
    let size = [WIDTH, height].map(|pixels| (pixels * UNIT) as u32);
    {
        let area = SVGBackend::with_string(&mut svg, (size[0], size[1])).into_drawing_area();
        area.fill(&WHITE)
            .and_then(|()| draw(&area))
            .and_then(|()| area.present())
            .map_err(|error| PlotError(error.to_string()))?;
    }
    let [title, description] = [&words.title, &words.description].map(|text| escaped(text));
    let size = format!("width=\"{}\" height=\"{}\"", size[0], size[1]);
    let labelled =
        format!("role=\"img\" aria-label=\"{title}\" width=\"{WIDTH}\" height=\"{height}\"");
    let svg = svg.replacen(&size, &labelled, 1);
    Ok(match svg.split_once(">\n") {
        Some((root, rest)) => {
            format!("{root}>\n<title>{title}</title>\n<desc>{description}</desc>\n{rest}")
        }
        None => svg,
    })
}

/// Escapes text for XML.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}

/// Font of `size` pixels.
pub fn font(size: f64) -> TextStyle<'static> {
    ("sans-serif", size * PLOTTERS_TYPE * f64::from(UNIT))
        .into_font()
        .color(&TEXT)
}

/// Estimated width of `text`, pixels.
pub fn width_of(text: &str, size: f64) -> i32 {
    (text.chars().count() as f64 * size * CHARACTER_WIDTH).ceil() as i32
}

/// Writes `text` at a position in pixels, vertically centred.
pub fn write(
    area: &Area<'_>,
    text: &str,
    (x, y): (i32, i32),
    align: HPos,
    style: TextStyle<'_>,
) -> Result<(), Failure> {
    let style = style.pos(Pos::new(align, VPos::Center));
    area.draw_text(text, &style, (x * UNIT, y * UNIT))
}
