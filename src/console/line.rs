//! A line editor with cursor, history and the usual keys of terminals.
//!
//! The crate `embedded-cli` does not fit. It completes names of commands but not of settings. It ignores Ctrl-C and
//! Ctrl-U. It cuts a line that is too long instead of refusing it. The crate `noline` reads lines in a loop of its own.

use super::MAX_LINE_BYTES;

const BACKSPACE: u8 = 0x08;
const DELETE: u8 = 0x7F;
const TAB: u8 = 0x09;
const ESCAPE: u8 = 0x1B;
/// Ctrl-C, which stops the paddle at once.
pub const STOP_BYTE: u8 = 0x03;
/// Ctrl-C and Ctrl-U, which discard the line.
const DROP_LINE: [u8; 2] = [STOP_BYTE, 0x15];

/// Number of lines in the history.
const HISTORY_LINES: usize = 8;

/// Effect of a received byte.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Typed<'a> {
    /// It was appended to the line and must be echoed.
    Added(u8),
    /// It removed the last byte of the line.
    Erased,
    /// It changed the line in another way, or moved the cursor.
    Edited(Edited<'a>),
    /// It requests completion of the last word. The value is the line up to the cursor.
    Complete(&'a [u8]),
    /// It ended this line.
    Line(&'a [u8]),
    /// It ended a line that was too long.
    TooLong,
    /// It discarded the line.
    Dropped,
    /// It had no effect.
    Ignored,
}

/// A line that must be displayed again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Edited<'a> {
    /// The whole line.
    pub line: &'a [u8],
    /// Number of bytes after the cursor.
    pub behind_cursor: usize,
}

/// How much of a key's escape sequence was received.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Sequence {
    #[default]
    None,
    Escape,
    /// After `ESC [` or `ESC O`. The value is the number so far, 0 without digits.
    Introduced(u8),
}

/// The line that is being edited.
#[derive(Clone, Debug, Default)]
pub struct LineEditor {
    line: Line,
    cursor: usize,
    too_long: bool,
    ended: bool,
    after_return: bool,
    sequence: Sequence,
    history: History,
}

impl LineEditor {
    /// Processes a byte. A line ends with CR, LF or both.
    pub fn push(&mut self, byte: u8) -> Typed<'_> {
        if self.ended {
            self.drop_line();
        }
        if let Some(key) = self.key(byte) {
            return self.press(key);
        }
        let second_of_pair = self.after_return && byte == b'\n';
        self.after_return = byte == b'\r';
        match byte {
            _ if self.sequence != Sequence::None => Typed::Ignored,
            b'\n' if second_of_pair => Typed::Ignored,
            b'\r' | b'\n' => self.end(),
            BACKSPACE | DELETE if self.too_long || self.cursor == 0 => Typed::Ignored,
            BACKSPACE | DELETE => {
                let at_end = self.cursor == self.line.length;
                self.cursor -= 1;
                self.line.remove(self.cursor);
                if at_end { Typed::Erased } else { self.edited() }
            }
            TAB => Typed::Complete(self.line.bytes().get(..self.cursor).unwrap_or_default()),
            _ if DROP_LINE.contains(&byte) => {
                self.drop_line();
                Typed::Dropped
            }
            0..b' ' => Typed::Ignored,
            _ if !self.line.insert(self.cursor, byte) => {
                self.too_long = true;
                Typed::Ignored
            }
            _ => {
                self.cursor += 1;
                if self.cursor == self.line.length {
                    Typed::Added(byte)
                } else {
                    self.edited()
                }
            }
        }
    }

    /// Inserts text at the cursor, as far as it fits.
    pub fn insert(&mut self, text: &str) {
        for byte in text.bytes() {
            if self.line.insert(self.cursor, byte) {
                self.cursor += 1;
            }
        }
    }

    /// The present line. It is empty after the end of a line.
    pub fn shown(&self) -> Edited<'_> {
        if self.ended {
            return Edited {
                line: &[],
                behind_cursor: 0,
            };
        }
        Edited {
            line: self.line.bytes(),
            behind_cursor: self.line.length - self.cursor,
        }
    }

    /// Discards the present line. The history is kept.
    pub fn drop_line(&mut self) {
        self.line = Line::default();
        self.cursor = 0;
        self.too_long = false;
        self.ended = false;
        self.sequence = Sequence::None;
        self.history.recalled = 0;
    }

    fn edited(&self) -> Typed<'_> {
        Typed::Edited(self.shown())
    }

    fn end(&mut self) -> Typed<'_> {
        self.ended = true;
        if self.too_long {
            return Typed::TooLong;
        }
        self.history.keep(&self.line);
        Typed::Line(self.line.bytes())
    }

    /// The key that this byte is or completes. All bytes of an escape sequence belong to it.
    fn key(&mut self, byte: u8) -> Option<Key> {
        let (sequence, key) = match (self.sequence, byte) {
            // Ctrl-C and the end of a line are never part of a sequence.
            (_, b'\r' | b'\n' | STOP_BYTE) => (Sequence::None, None),
            (Sequence::None, ESCAPE) => (Sequence::Escape, Some(Key::None)),
            (Sequence::None, _) => (Sequence::None, Key::of_control(byte)),
            (Sequence::Escape, b'[' | b'O') => (Sequence::Introduced(0), Some(Key::None)),
            (Sequence::Escape, _) => (Sequence::None, Some(Key::None)),
            (Sequence::Introduced(number), digit @ b'0'..=b'9') => {
                let number = number.saturating_mul(10).saturating_add(digit - b'0');
                (Sequence::Introduced(number), Some(Key::None))
            }
            (Sequence::Introduced(number), 0x40..=0x7E) => {
                (Sequence::None, Some(Key::of_sequence(number, byte)))
            }
            (Sequence::Introduced(number), _) => (Sequence::Introduced(number), Some(Key::None)),
        };
        self.sequence = sequence;
        key
    }

    fn press(&mut self, key: Key) -> Typed<'_> {
        let (line, cursor) = (&mut self.line, &mut self.cursor);
        match key {
            Key::Left if *cursor > 0 => *cursor -= 1,
            Key::Right if *cursor < line.length => *cursor += 1,
            Key::Home => *cursor = 0,
            Key::End => *cursor = line.length,
            Key::Delete if *cursor < line.length => line.remove(*cursor),
            Key::CutBehind => line.length = *cursor,
            Key::Redraw => {}
            Key::Up | Key::Down => match self.history.recall(key == Key::Up) {
                Some(recalled) => {
                    *line = recalled;
                    *cursor = line.length;
                }
                None => return Typed::Ignored,
            },
            _ => return Typed::Ignored,
        }
        self.edited()
    }
}

/// An editing key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Key {
    None,
    Up,
    Down,
    Left,
    Right,
    Home,
    End,
    Delete,
    CutBehind,
    Redraw,
}

impl Key {
    /// The key of a control byte, as in shells: Ctrl-A, B, D, E, F, K, L, N and P.
    fn of_control(byte: u8) -> Option<Self> {
        Some(match byte {
            0x01 => Self::Home,
            0x02 => Self::Left,
            0x04 => Self::Delete,
            0x05 => Self::End,
            0x06 => Self::Right,
            0x0B => Self::CutBehind,
            0x0C => Self::Redraw,
            0x0E => Self::Down,
            0x10 => Self::Up,
            _ => return None,
        })
    }

    /// The key of an escape sequence with this number and last byte (ECMA-48, and the keys of the VT220).
    fn of_sequence(number: u8, last: u8) -> Self {
        match (number, last) {
            (_, b'A') => Self::Up,
            (_, b'B') => Self::Down,
            (_, b'C') => Self::Right,
            (_, b'D') => Self::Left,
            (_, b'H') | (1 | 7, b'~') => Self::Home,
            (_, b'F') | (4 | 8, b'~') => Self::End,
            (3, b'~') => Self::Delete,
            _ => Self::None,
        }
    }
}

/// The bytes of a line.
#[derive(Clone, Copy, Debug)]
struct Line {
    bytes: [u8; MAX_LINE_BYTES],
    length: usize,
}

impl Default for Line {
    fn default() -> Self {
        Self {
            bytes: [0; MAX_LINE_BYTES],
            length: 0,
        }
    }
}

impl Line {
    fn bytes(&self) -> &[u8] {
        self.bytes.get(..self.length).unwrap_or_default()
    }

    /// Inserts a byte. Returns false if there is no room.
    fn insert(&mut self, at: usize, byte: u8) -> bool {
        let Some(tail) = self.bytes.get_mut(at..self.length + 1) else {
            return false;
        };
        tail.rotate_right(1);
        if let Some(first) = tail.first_mut() {
            *first = byte;
        }
        self.length += 1;
        true
    }

    fn remove(&mut self, at: usize) {
        if let Some(tail) = self.bytes.get_mut(at..self.length) {
            tail.rotate_left(1);
            self.length -= 1;
        }
    }
}

/// The last lines, newest first.
#[derive(Clone, Debug, Default)]
struct History {
    lines: [Line; HISTORY_LINES],
    length: usize,
    /// Number of the displayed entry, counted from 1. 0 = none.
    recalled: usize,
}

impl History {
    fn keep(&mut self, line: &Line) {
        let [newest, ..] = &self.lines;
        if line.length == 0 || newest.bytes() == line.bytes() {
            return;
        }
        self.lines.rotate_right(1);
        let [newest, ..] = &mut self.lines;
        *newest = *line;
        self.length = (self.length + 1).min(HISTORY_LINES);
    }

    /// The older or newer entry than the displayed one. Newer than the newest is an empty line.
    fn recall(&mut self, older: bool) -> Option<Line> {
        let recalled = if older {
            self.recalled + 1
        } else {
            self.recalled.checked_sub(1)?
        };
        if recalled > self.length {
            return None;
        }
        self.recalled = recalled;
        Some(match recalled.checked_sub(1) {
            Some(place) => *self.lines.get(place)?,
            None => Line::default(),
        })
    }
}
