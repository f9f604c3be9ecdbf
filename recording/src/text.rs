//! Opens and reads text files of other programs and of people.

use std::fs::File;
use std::io::{self, ErrorKind, Read};
use std::path::Path;

use crate::error::{Error, Fault};

/// Number of bytes used to detect the encoding.
pub(crate) const HEAD_BYTES: usize = 64;
/// Least share of zeros among every second byte in UTF-16 text with mostly Latin letters.
const ZEROS: f64 = 0.75;

/// Opens the file `path`. It must be a regular file: a pipe without a writer would block the program. `mend` is the remedy
/// to report if it cannot be opened.
///
/// # Errors
///
/// [`Fault::Io`] and [`Fault::NotAFile`].
pub fn open_file(path: &Path, mend: &'static str) -> Result<File, Error> {
    let refused = |source| {
        let doing = "read";
        Error::new(Fault::Io {
            doing,
            source,
            mend,
        })
        .in_file(path)
    };
    let kind = path.metadata().map_err(refused)?.file_type();
    if !kind.is_file() {
        let found = if kind.is_dir() {
            "a folder"
        } else {
            "a pipe or a device"
        };
        return Err(Error::new(Fault::NotAFile { found }).in_file(path));
    }
    File::open(path).map_err(refused)
}

/// Reads the text of the file `path`. `mend` is as in [`open_file`].
///
/// # Errors
///
/// The same as for [`open_file`], and [`Fault::Utf16`] and [`Fault::NotUtf8`] for text that is not UTF-8.
pub fn read_text(path: &Path, mend: &'static str) -> Result<String, Error> {
    let mut bytes = Vec::new();
    open_file(path, mend)?
        .read_to_end(&mut bytes)
        .map_err(|source| {
            let doing = "read";
            Error::new(Fault::Io {
                doing,
                source,
                mend,
            })
            .in_file(path)
        })?;
    if is_utf16(&bytes) {
        return Err(Error::new(Fault::Utf16).in_file(path));
    }
    let text = String::from_utf8(bytes).map_err(|_| Error::new(Fault::NotUtf8).in_file(path))?;
    // Some editors write a byte order mark at the beginning.
    Ok(match text.strip_prefix('\u{feff}') {
        Some(rest) => rest.to_owned(),
        None => text,
    })
}

/// The first bytes of `source`, fewer if it is shorter.
pub(crate) fn head(source: &mut impl Read) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::with_capacity(HEAD_BYTES);
    match source.take(HEAD_BYTES as u64).read_to_end(&mut bytes) {
        Err(error) if error.kind() != ErrorKind::Interrupted => Err(error),
        _ => Ok(bytes),
    }
}

/// Returns true if text that begins with `bytes` is UTF-16. It starts with a byte order mark, or most of its odd or of its
/// even bytes are 0.
pub(crate) fn is_utf16(bytes: &[u8]) -> bool {
    let head = &bytes[..bytes.len().min(HEAD_BYTES)];
    if head.starts_with(&[0xFF, 0xFE]) || head.starts_with(&[0xFE, 0xFF]) {
        return true;
    }
    let pairs = head.len() / 2;
    [0, 1].into_iter().any(|place| {
        let zeros = head.chunks_exact(2).filter(|pair| pair[place] == 0).count();
        pairs > 1 && zeros as f64 >= ZEROS * pairs as f64
    })
}

/// The message of a TOML parser in one line, without names of Rust types.
pub fn plain_message(message: &str) -> String {
    let line = message.lines().collect::<Vec<_>>().join(", ");
    let Some((found, wanted)) = line
        .strip_prefix("invalid type: ")
        .or(line.strip_prefix("invalid value: "))
        .and_then(|rest| rest.rsplit_once(", expected "))
    else {
        return line;
    };
    let wanted = match wanted {
        "f64" | "f32" => "a number",
        "u8" | "u16" | "u32" | "u64" | "usize" | "i32" | "i64" => "a whole number",
        "a sequence" => "a list",
        "a map" => "a table",
        "a boolean" => "true or false",
        "a string" => "text in quotes",
        other if other.starts_with("struct ") || other.contains("enum ") => "a table",
        other => other,
    };
    let kinds = [
        ("string ", "the text "),
        ("floating point ", ""),
        ("integer ", ""),
        ("boolean ", ""),
        ("map", "a table"),
        ("sequence", "a list"),
    ];
    let named = kinds
        .into_iter()
        .find_map(|(kind, plain)| Some(format!("{plain}{}", found.strip_prefix(kind)?)));
    let found = named.unwrap_or_else(|| found.to_owned());
    format!("{found} stands where {wanted} belongs")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parser_is_quoted_without_its_types() {
        for (said, plain) in [
            (
                "invalid type: string \"x\", expected f64",
                "the text \"x\" stands where a number belongs",
            ),
            (
                "invalid type: floating point `1.5`, expected u32",
                "`1.5` stands where a whole number belongs",
            ),
            (
                "invalid type: integer `3`, expected struct Sensor",
                "`3` stands where a table belongs",
            ),
            ("missing field `inertia`", "missing field `inertia`"),
        ] {
            assert_eq!(plain_message(said), plain);
        }
    }

    #[test]
    fn utf_16_text_is_recognised_with_and_without_a_byte_order_mark() {
        let little = |text: &str| text.encode_utf16().flat_map(u16::to_le_bytes).collect();
        let big = |text: &str| text.encode_utf16().flat_map(u16::to_be_bytes).collect();
        let texts: [Vec<u8>; 3] = [
            little("time,input,position\n"),
            big("time,input,position\n"),
            little("\u{feff}time"),
        ];
        for bytes in texts {
            assert!(is_utf16(&bytes), "{bytes:?}");
        }
        for text in ["time,input,position\n", "", "t", "µ,°,ä"] {
            assert!(!is_utf16(text.as_bytes()), "{text}");
        }
    }
}
