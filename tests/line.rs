//! Line editing as a person at a terminal, or a script, meets it.

use haptic_paddle::console::{LineEditor, MAX_LINE_BYTES, Typed};

/// The lines that typing this ends; `None` for one that is too long.
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
