//! The list of all settings as a Markdown page.

use core::fmt;

use super::tree::{FIELDS, GROUPS};
use super::{Field, Group};

/// Its `Display` writes the page.
#[derive(Clone, Copy, Debug)]
pub struct Page;

impl fmt::Display for Page {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(
            "# Settings\n\n\
             `get` on the console shows them, `set NAME VALUE` changes one, `save` keeps them over a reset.\n\
             This page is made from the definition in `src/settings/tree.rs`:\n\
             `cargo run --quiet --example settings_page > docs/settings.md`.\n",
        )?;
        GROUPS.iter().try_for_each(|group| section(f, group))
    }
}

fn section(f: &mut fmt::Formatter<'_>, group: &Group) -> fmt::Result {
    write!(f, "\n## {}\n\n{}\n\n", group.name, group.about)?;
    f.write_str("| name | default | range | unit | what it does |\n|---|---|---|---|---|\n")?;
    let of_group = |field: &&Field| field.name.split('.').next() == Some(group.name);
    FIELDS
        .iter()
        .filter(of_group)
        .try_for_each(|field| row(f, field))
}

fn row(f: &mut fmt::Formatter<'_>, field: &'static Field) -> fmt::Result {
    write!(f, "| `{}`", field.name)?;
    if let Some(short) = field.short {
        write!(f, ", `{short}`")?;
    }
    let value = field.default_shown();
    writeln!(
        f,
        " | {} | {} | {} | {} |",
        value.value(),
        field.kind,
        field.unit,
        field.about
    )
}
