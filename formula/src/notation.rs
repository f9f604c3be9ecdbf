//! Converts the usual notation for the crate `exmex`. That crate applies a sign before a power, so it reads `-x^2` as
//! `(-x)^2`, and it does not accept `1e-3`.

/// Writes a sign and its following power as a difference in parentheses: `2*(0-x^2)` for `2*-x^2`. Writes numbers without an
/// exponent of ten. A sign after `^` stays unchanged, because it applies to nothing else.
pub fn for_exmex(text: &str) -> String {
    let mut usual = String::with_capacity(text.len() + 8);
    let mut rest = text;
    // A minus character is a sign if no value ends before it.
    let mut is_sign = true;
    while let Some(next) = rest.chars().next() {
        if next == '-' && is_sign {
            let (power, behind) = split_power(&rest[1..]);
            usual.push_str(&format!("(0-{})", for_exmex(power)));
            rest = behind;
            is_sign = false;
            continue;
        }
        let length = match next {
            '{' => braced(rest),
            c if is_word(c) => word(rest),
            c => c.len_utf8(),
        };
        let (part, behind) = rest.split_at(length);
        match part.parse::<f64>() {
            Ok(number) if number.is_finite() => usual.push_str(&number.to_string()),
            _ => usual.push_str(part),
        }
        rest = behind;
        if next == '^' {
            // The exponent with its signs.
            let (exponent, behind) = rest.split_at(signs(rest));
            usual.push_str(exponent);
            rest = behind;
        }
        if !next.is_whitespace() {
            is_sign = matches!(next, '(' | ',' | '+' | '-' | '*' | '/' | '%');
        }
    }
    usual
}

/// Splits the text after the power at its beginning, including the signs of the power.
fn split_power(text: &str) -> (&str, &str) {
    let mut end = factor(text);
    loop {
        let behind = &text[end..];
        let trimmed = behind.trim_start();
        let Some(exponent) = trimmed.strip_prefix('^') else {
            return text.split_at(end);
        };
        end = text.len() - exponent.len() + factor(exponent);
    }
}

/// Length of the signs, the name, number or group, and the argument of a function at the beginning of the text.
fn factor(text: &str) -> usize {
    let begun = signs(text);
    let value = &text[begun..];
    let length = match value.chars().next() {
        Some('(') => group(value),
        Some('{') => braced(value),
        Some(c) if is_word(c) => {
            let name = word(value);
            let behind = value[name..].trim_start();
            match behind.starts_with('(') {
                true => value.len() - behind.len() + group(behind),
                false => name,
            }
        }
        _ => 0,
    };
    begun + length
}

/// Length of the signs and spaces at the beginning of the text.
fn signs(text: &str) -> usize {
    let behind = text.trim_start_matches(|c: char| c == '-' || c.is_whitespace());
    text.len() - behind.len()
}

/// Length of the name or number at the beginning of the text, including the sign of an exponent.
fn word(text: &str) -> usize {
    let is_number = text.starts_with(|c: char| c.is_ascii_digit() || c == '.');
    let mut before = ' ';
    let end = text.char_indices().find(|&(_, c)| {
        let is_exponent = is_number && matches!(before, 'e' | 'E') && matches!(c, '-' | '+');
        before = c;
        !(is_word(c) || is_exponent)
    });
    end.map_or(text.len(), |(end, _)| end)
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || matches!(c, '_' | '.')
}

/// Length of the name in braces at the beginning of the text.
fn braced(text: &str) -> usize {
    text.find('}').map_or(text.len(), |end| end + 1)
}

/// Length of the group in parentheses at the beginning of the text.
fn group(text: &str) -> usize {
    let mut depth = 0usize;
    let end = text.char_indices().find(|&(_, c)| {
        match c {
            '(' => depth += 1,
            ')' => depth = depth.saturating_sub(1),
            _ => {}
        }
        depth == 0
    });
    end.map_or(text.len(), |(end, _)| end + 1)
}
