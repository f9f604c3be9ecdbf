//! Figures of the firmware image. They depend only on the compiler, because the virtual board is equal on every machine.

use std::process::Command;

use super::table::row;
use crate::firmware::{self, FLASH_LIMIT_BYTES, RAM_LIMIT_BYTES, Size};
use crate::test::say_skipped;
use crate::{Failure, cargo, output};

const KIB: f64 = 1024.0;
/// The test that prints the figures of the control interrupt.
const INTERRUPT: &str =
    "cargo test --package haptic-paddle --test board control_interrupt -- --nocapture";

/// Selects the compilers whose figures are measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Compiled {
    /// The installed compiler: all figures are measured.
    Anew,
    /// Only the compiler that the page names: figures of another compiler are not measured.
    AsOnThePage,
}

/// Measures the figures of the image.
pub struct Image(Compiled);

impl Image {
    /// Creates the measurement for these compilers.
    pub fn new(compiled: Compiled) -> Self {
        Self(compiled)
    }

    /// The figures with the name `name`. Returns `None` if the `present` figures belong to a compiler that is not compared.
    ///
    /// # Errors
    /// Returns a [`Failure`] if the name is unknown, or if the image cannot be built or run.
    pub fn table(&self, name: &str, present: &str) -> Result<Option<String>, Failure> {
        let compiler = compiler()?;
        let is_other = !present.contains(&format!("{compiler}."));
        if self.0 == Compiled::AsOnThePage && is_other {
            let why = format!(
                "the page names another compiler for `{name}` than {compiler}, which is in use"
            );
            say_skipped("image_figures", &why);
            return Ok(None);
        }
        let table = match name {
            "image" => size(&firmware::measured()?),
            "control-interrupt" => {
                let said = output(&mut cargo(
                    &INTERRUPT.split(' ').skip(1).collect::<Vec<_>>(),
                ))?;
                interrupt(&said).ok_or_else(|| Failure::Benchmark(INTERRUPT.into()))?
            }
            other => return Err(Failure::NoFigures(other.into())),
        };
        Ok(Some(format!("{table}\nBuilt by {compiler}.\n")))
    }
}

/// Name and version of the installed compiler.
fn compiler() -> Result<String, Failure> {
    let said = output(Command::new("rustc").arg("--version"))?;
    Ok(said.split(' ').take(2).collect::<Vec<_>>().join(" "))
}

fn size(size: &Size) -> String {
    let kib = |bytes: u64| format!("{:.1} KiB", bytes as f64 / KIB);
    let limit = |bytes: u64| format!("≤ {:.0} KiB", bytes as f64 / KIB);
    [
        row(&["what", "limit", "size"]),
        "|---|---|---|\n".into(),
        row(&["flash", &limit(FLASH_LIMIT_BYTES), &kib(size.flash_bytes)]),
        row(&[
            "RAM: variables and the deepest stack together",
            &limit(RAM_LIMIT_BYTES),
            &kib(size.statics_bytes + size.stack_bytes),
        ]),
        row(&["the deepest stack", "", &kib(size.stack_bytes)]),
    ]
    .concat()
}

/// Makes the table from the output of the test. The test fails before its output if a control period was missed. Cycle
/// counts are left out, because they depend on the code addresses, which change with every commit.
fn interrupt(said: &str) -> Option<String> {
    let mut lines = said.lines();
    let (count, figures) = lines.find_map(|line| line.split_once(" control interrupts: "))?;
    let (median, rest) = figures.split_once(" instructions median, ")?;
    let (worst, _) = rest.split_once(" worst; ")?;
    let table = [
        row(&["what", "limit", "measured"]),
        "|---|---|---|\n".into(),
        row(&["instructions of the control interrupt, median", "", median]),
        row(&[
            "instructions of the control interrupt, at worst",
            "≤ 700",
            worst,
        ]),
        row(&[
            "control periods that were missed",
            "0",
            &format!("0 of {count}"),
        ]),
    ];
    Some(table.concat())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_figures_of_the_interrupt_are_read_from_the_output_of_its_test() {
        let said = "running 1 test\n200000 control interrupts: 436 instructions median, 492 worst; 885 model cycles median, \
                    965 worst; jitter 0.250 µs\ntest ... ok\n";
        let table = interrupt(said).unwrap();
        for cell in [
            "median |  | 436 |",
            "at worst | ≤ 700 | 492 |",
            "| 0 | 0 of 200000 |",
        ] {
            assert!(table.contains(cell), "{table}");
        }
        assert_eq!(interrupt("nothing of the kind"), None);
    }
}
