//! Detects the layout of a text: delimiter, decimal sign, comments and header.

use super::number::{Decimal, is_nothing, number};
use crate::clock;

/// Separator of cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Delimiter {
    Byte(u8),
    /// Any number of spaces and tabs.
    Spaces,
}

/// The layout of a text.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Layout {
    pub delimiter: Delimiter,
    pub decimal: Decimal,
    /// Names of the columns, if there are any.
    pub names: Option<Vec<String>>,
    /// Units of the columns, if they have a row of their own.
    pub units: Option<Vec<String>>,
    /// Line of the first sample, from 0.
    pub first_row: usize,
}

/// Number of lines that are examined.
const LOOKED_AT: usize = 400;
/// Least share of numbers among the cells of a sample row. Logs can have columns of text.
const NUMBERS: f64 = 0.3;
/// Signs at the beginning of a comment.
const COMMENTS: [&str; 4] = ["#", "%", "//", "!"];

/// The text of a comment line without its sign.
pub(super) fn comment(line: &str) -> Option<&str> {
    let line = line.trim_start();
    let sign = COMMENTS.iter().find(|sign| line.starts_with(**sign))?;
    Some(line.trim_start_matches(*sign).trim())
}

/// The cells of a line.
pub(super) fn cells(line: &str, delimiter: Delimiter) -> Vec<String> {
    match delimiter {
        Delimiter::Spaces => unquoted(line),
        Delimiter::Byte(byte) => {
            let mut reader = csv::ReaderBuilder::new()
                .has_headers(false)
                .delimiter(byte)
                .trim(csv::Trim::All)
                .from_reader(line.as_bytes());
            let record = reader.records().next();
            let record = record.and_then(Result::ok).unwrap_or_default();
            record.iter().map(str::to_owned).collect()
        }
    }
}

/// The words of a line. A quoted text is one word.
fn unquoted(line: &str) -> Vec<String> {
    let mut words = Vec::new();
    let mut rest = line.trim();
    while !rest.is_empty() {
        let quoted = rest.strip_prefix('"').and_then(|rest| rest.split_once('"'));
        let (word, after) = match quoted {
            Some(parts) => parts,
            None => rest.split_once(char::is_whitespace).unwrap_or((rest, "")),
        };
        words.push(word.to_owned());
        rest = after.trim_start();
    }
    words
}

impl Layout {
    /// Detects the layout of these lines. `None` if no line has numbers in columns.
    pub fn of(lines: &[&str]) -> Option<Self> {
        let looked_at: Vec<(usize, &str)> = lines
            .iter()
            .enumerate()
            .filter(|(_, line)| !line.trim().is_empty() && comment(line).is_none())
            .map(|(at, line)| (at, *line))
            .take(LOOKED_AT)
            .collect();
        let delimiters = [b';', b'\t', b',', b'|'].map(Delimiter::Byte).into_iter();
        let mut best: Option<(f64, Self)> = None;
        for delimiter in delimiters.chain([Delimiter::Spaces]) {
            for decimal in [Decimal::Point, Decimal::Comma] {
                if let Some((score, layout)) = Self::tried(delimiter, decimal, &looked_at)
                    && best.as_ref().is_none_or(|(most, _)| score > *most)
                {
                    best = Some((score, layout));
                }
            }
        }
        let (_, mut layout) = best?;
        layout.name(lines, &looked_at);
        Some(layout)
    }

    /// Score of a layout for the lines, and the line of the first sample.
    #[expect(clippy::cast_precision_loss, reason = "counts of lines and cells")]
    fn tried(
        delimiter: Delimiter,
        decimal: Decimal,
        lines: &[(usize, &str)],
    ) -> Option<(f64, Self)> {
        let split: Vec<Vec<String>> = lines
            .iter()
            .map(|(_, line)| cells(line, delimiter))
            .collect();
        // The second half of the lines has no header.
        let mut widths: Vec<usize> = split[split.len() / 2..].iter().map(Vec::len).collect();
        widths.sort_unstable();
        let width = *widths.get(widths.len() / 2)?;
        if width < 2 {
            return None;
        }
        let is_sample = |row: &Vec<String>| row.len() == width && is_sample(row, decimal);
        let first = split.iter().position(is_sample)?;
        let samples = &split[first..];
        let fitting = samples.iter().filter(|row| is_sample(row));
        let telling = |cell: &&String| !is_nothing(cell);
        let all: usize = samples
            .iter()
            .map(|row| row.iter().filter(telling).count())
            .sum();
        let numbers: usize = fitting
            .map(|row| row.iter().filter(|cell| is_number(cell, decimal)).count())
            .sum();
        // If two layouts read the same share of cells, the one with more columns is slightly preferred.
        let score = numbers as f64 / all.max(1) as f64 + 1e-3 * (width as f64).min(50.0) / 50.0;
        let layout = Self {
            delimiter,
            decimal,
            names: None,
            units: None,
            first_row: lines[first].0,
        };
        Some((score, layout))
    }

    /// Finds names and units in the lines before the first sample.
    fn name(&mut self, lines: &[&str], looked_at: &[(usize, &str)]) {
        let width = cells(lines[self.first_row], self.delimiter).len();
        let fits = |line: &str| {
            let mut row = cells(line, self.delimiter);
            // A delimiter at the end of the line makes an empty cell in one of the two.
            while row.len() > width && row.last().is_some_and(String::is_empty) {
                row.pop();
            }
            (row.len() == width || row.len() + 1 == width).then_some(row)
        };
        let before = looked_at.iter().filter(|(at, _)| *at < self.first_row);
        let mut heads: Vec<Vec<String>> = before.filter_map(|(_, line)| fits(line)).collect();
        if heads.is_empty() {
            let comments = lines[..self.first_row]
                .iter()
                .filter_map(|line| comment(line));
            let mut named = comments
                .filter_map(fits)
                .filter(|row| row.iter().any(|cell| is_word(cell)));
            heads.extend(named.next_back());
        }
        let is_units = |row: &Vec<String>| {
            let bare = |cell: &String| {
                let inside = cell
                    .trim_start_matches(['(', '['])
                    .trim_end_matches([')', ']']);
                inside.trim().to_owned()
            };
            let units = row
                .iter()
                .map(bare)
                .filter(|unit| !unit.is_empty() && unit != "-");
            let known = units
                .clone()
                .filter(|unit| crate::unit::parse(unit).is_some())
                .count();
            known > 0 && 2 * known >= units.count()
        };
        if heads.len() > 1 && heads.last().is_some_and(is_units) {
            self.units = heads.pop();
        }
        self.names = heads.pop();
    }
}

fn is_word(cell: &str) -> bool {
    cell.chars().any(char::is_alphabetic)
}

fn is_number(cell: &str, decimal: Decimal) -> bool {
    number(cell, decimal).is_some() || clock::is_stamp(cell)
}

/// True if a row has samples rather than names.
#[expect(clippy::cast_precision_loss, reason = "counts of cells")]
fn is_sample(row: &[String], decimal: Decimal) -> bool {
    let filled = row.iter().filter(|cell| !is_nothing(cell)).count();
    let numbers = row.iter().filter(|cell| is_number(cell, decimal)).count();
    numbers > 0 && numbers as f64 >= NUMBERS * filled as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layout(text: &str) -> Layout {
        Layout::of(&text.lines().collect::<Vec<_>>()).expect("a layout")
    }

    #[test]
    fn delimiter_and_decimal_sign_are_detected_from_the_samples() {
        use Decimal::{Comma, Point};
        for (text, delimiter, decimal, names) in [
            (
                "t,u,x\n0.0,1.5,2\n0.1,1.5,3\n",
                Delimiter::Byte(b','),
                Point,
                true,
            ),
            (
                "t;u;x\n0,0;1,5;2\n0,1;1,5;3\n",
                Delimiter::Byte(b';'),
                Comma,
                true,
            ),
            (
                "0.0\t1\t2\n0.1\t1\t3\n",
                Delimiter::Byte(b'\t'),
                Point,
                false,
            ),
            (
                "% t u x\n 0.0  1 2\n 0.1  1 3\n",
                Delimiter::Spaces,
                Point,
                true,
            ),
            (
                "\"t\",\"u, V\",\"x\"\n\"0,5\",\"1,5\",\"2\"\n\"0,6\",\"1,5\",\"3\"\n",
                Delimiter::Byte(b','),
                Comma,
                true,
            ),
            (
                "Logger 3\nfirst run, of two\nt|u|x\n0.1|2|3\n0.2|2|3\n",
                Delimiter::Byte(b'|'),
                Point,
                true,
            ),
        ] {
            let found = layout(text);
            assert_eq!(
                (found.delimiter, found.decimal),
                (delimiter, decimal),
                "{text}"
            );
            assert_eq!(found.names.is_some(), names, "{text}: {found:?}");
        }
    }

    #[test]
    fn a_row_of_units_is_not_taken_as_names() {
        let found = layout("Time,Channel A,x\n(ms),(V),(deg)\n\n0.0,1,2\n0.1,1,3\n");
        assert_eq!(found.names.unwrap(), ["Time", "Channel A", "x"]);
        assert_eq!(found.units.unwrap(), ["(ms)", "(V)", "(deg)"]);
    }
}
