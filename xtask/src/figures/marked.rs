//! Generated parts of a page.

/// Reason why a page cannot be generated.
#[derive(Debug, thiserror::Error)]
pub enum MarkError {
    /// A marked part without an end mark.
    #[error("`<!-- figures: {0} -->` has no `<!-- end -->` behind it")]
    Open(String),
    /// A marked part that has no generator, or whose generator failed.
    #[error("`<!-- figures: {name} -->`: {error}")]
    Part {
        /// Name of the part.
        name: String,
        /// Error of the generator.
        error: String,
    },
}

const OPEN: &str = "<!-- figures: ";
const CLOSE: &str = " -->\n";
const END: &str = "<!-- end -->";

/// Replaces every marked part of the page by the text that `made` returns for its name and present text. If `made` returns
/// `None`, the part stays unchanged.
///
/// # Errors
/// Returns [`MarkError`] for the first part that cannot be generated.
pub fn replaced<E: ToString>(
    page: &str,
    made: impl Fn(&str, &str) -> Result<Option<String>, E>,
) -> Result<String, MarkError> {
    let mut parts = page.split(OPEN);
    let mut text = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (name, rest) = part.split_once(CLOSE).unwrap_or((part, ""));
        let open = || MarkError::Open(name.lines().next().unwrap_or_default().into());
        let (present, rest) = rest.split_once(END).ok_or_else(open)?;
        let made = made(name, present).map_err(|error| MarkError::Part {
            name: name.into(),
            error: error.to_string(),
        })?;
        let made = made.unwrap_or_else(|| present.to_owned());
        text.push_str(&format!("{OPEN}{name}{CLOSE}{made}{END}{rest}"));
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counted(name: &str, present: &str) -> Result<Option<String>, String> {
        match name {
            "length" => Ok(Some("6\n".into())),
            "unknown" => Ok(None),
            "twice" => Ok(Some(present.repeat(2))),
            other => Err(format!("nobody measures {other}")),
        }
    }

    #[test]
    fn the_text_between_the_marks_is_replaced() {
        let page = "a\n<!-- figures: length -->\n5\n<!-- end -->\nb\n";
        let made = replaced(page, counted).unwrap();
        assert_eq!(made, "a\n<!-- figures: length -->\n6\n<!-- end -->\nb\n");
        assert_eq!(replaced(&made, counted).unwrap(), made);
        assert_eq!(replaced("no marks", counted).unwrap(), "no marks");
        let kept = "<!-- figures: unknown -->\n5\n<!-- end -->\n";
        assert_eq!(replaced(kept, counted).unwrap(), kept);
        let twice = replaced("<!-- figures: twice -->\n5\n<!-- end -->", counted).unwrap();
        assert_eq!(twice, "<!-- figures: twice -->\n5\n5\n<!-- end -->");
    }

    #[test]
    fn a_part_without_an_end_mark_or_a_generator_is_refused() {
        let open = replaced("<!-- figures: length -->\n5\n", counted).unwrap_err();
        assert!(open.to_string().contains("no `<!-- end -->`"), "{open}");
        let unknown = replaced("<!-- figures: width -->\n<!-- end -->", counted).unwrap_err();
        assert!(
            unknown.to_string().contains("nobody measures width"),
            "{unknown}"
        );
    }
}
