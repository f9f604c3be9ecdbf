//! Tests of line editing, for typed and for pasted input.

use haptic_paddle::console::{LineEditor, MAX_LINE_BYTES, STOP_BYTE, Typed};

/// The lines that this input completes. A line that is too long is `None`.
fn typed(text: &[u8]) -> Vec<Option<String>> {
    let mut editor = LineEditor::default();
    text.iter()
        .filter_map(|byte| match editor.push(*byte) {
            Typed::Line(line) => Some(Some(String::from_utf8_lossy(line).into())),
            Typed::TooLong => Some(None),
            _ => None,
        })
        .collect()
}

#[test]
fn each_kind_of_line_end_ends_one_line() {
    let expected = [Some("arm".into()), Some("ref 1".into())];
    for end in ["\r", "\n", "\r\n"] {
        let text = format!("arm{end}ref 1{end}");
        assert_eq!(typed(text.as_bytes()), expected, "{end:?}");
    }
    assert_eq!(typed(b"\n\n"), [Some("".into()), Some("".into())]);
}

#[test]
fn editing_changes_the_line() {
    assert_eq!(typed(b"arn\x7fm\r"), [Some("arm".into())]);
    assert_eq!(typed(b"\x08\x08arm\r"), [Some("arm".into())]);
    assert_eq!(typed(b"disarm\x15arm\r"), [Some("arm".into())]);
}

#[test]
fn a_line_that_is_too_long_is_refused_whole_and_the_next_one_is_not() {
    let mut text = [b'x'; MAX_LINE_BYTES + 3].to_vec();
    text.extend_from_slice(b"\x7f\rarm\r");
    assert_eq!(typed(&text), [None, Some("arm".into())]);
}

const UP: &str = "\x1b[A";
const DOWN: &str = "\x1b[B";
const RIGHT: &str = "\x1b[C";
const LEFT: &str = "\x1b[D";

#[test]
fn edits_apply_at_the_cursor() {
    let line = |keys: String| typed(format!("{keys}\r").as_bytes());
    assert_eq!(line(format!("am{LEFT}r")), [Some("arm".into())]);
    assert_eq!(line(format!("axrm{LEFT}{LEFT}\x7f")), [Some("arm".into())]);
    assert_eq!(line("rm\x1b[Ha".into()), [Some("arm".into())], "Home");
    assert_eq!(
        line("rm\x01a\x05 torque".into()),
        [Some("arm torque".into())]
    );
    assert_eq!(
        line("xarm\x1b[1~\x1b[3~".into()),
        [Some("arm".into())],
        "Delete"
    );
    assert_eq!(line(format!("arm x{LEFT}{LEFT}\x0b")), [Some("arm".into())]);
    assert_eq!(line(format!("arm{RIGHT}{RIGHT}")), [Some("arm".into())]);
    assert_eq!(
        line("a\x1b[5~\x1b[15~\x1bOPrm".into()),
        [Some("arm".into())],
        "other keys"
    );
}

#[test]
fn the_history_can_be_browsed_in_both_directions() {
    let lines = typed(format!("one\rtwo\r{UP}{UP}\r{UP}{UP}{DOWN}\r{UP}{DOWN}x\r").as_bytes());
    let lines: Vec<_> = lines.into_iter().flatten().collect();
    assert_eq!(lines, ["one", "two", "one", "one", "x"]);
    let many: String = (0..20).map(|line| format!("line {line}\r")).collect();
    let oldest = typed(format!("{many}{}\r", UP.repeat(30)).as_bytes());
    assert_eq!(oldest.last().unwrap().as_deref(), Some("line 12"));
}

#[test]
fn a_stop_byte_aborts_an_incomplete_escape_sequence() {
    let mut editor = LineEditor::default();
    editor.push(0x1b);
    editor.push(b'[');
    assert_eq!(editor.push(STOP_BYTE), Typed::Dropped);
    assert_eq!(editor.push(b'a'), Typed::Added(b'a'));
}
