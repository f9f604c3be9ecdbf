//! `cargo xtask figures`: writes the tables of measured numbers in README and docs.
//!
//! A page marks a table by `<!-- figures: NAME -->` and `<!-- end -->`. There are three sources of figures:
//!
//! - Some figures are equal on every machine. They are measured each time, and `--check` lists the pages with other figures.
//! - Figures of the firmware image depend only on the compiler, which their tables name.
//! - All other results are stored in `docs/figures` with date, machine and commit: the sets of the blind check, which take
//!   hours (`figures accuracy FILE...`), and speeds (`figures performance`).
//!
//! A table without a stored result stays unchanged.

mod accuracy;
mod exact;
mod image;
mod marked;
mod origin;
mod performance;
mod table;

use std::fs;
use std::path::{Path, PathBuf};

use crate::{Failure, documentation, run};
use accuracy::{Kind, Sets};
use exact::Exact;
use image::{Compiled, Image};
use performance::Performance;

/// Rewrites every table whose figures have changed.
pub fn write() -> Result<(), Failure> {
    let program = built_program()?;
    for page in changed_pages(&program, Compiled::Anew)? {
        let name = page.path.display().to_string();
        let path = firmware_build::root().join(&page.path);
        fs::write(&path, page.text).map_err(|e| Failure::file(&path, e))?;
        println!("{name}");
    }
    Ok(())
}

/// Checks that every table agrees with the measured figures.
pub fn check() -> Result<(), Failure> {
    compare(&built_program()?)
}

/// Checks the tables with the program that the tests have built. It may have other features than a build by this command.
pub fn check_built() -> Result<(), Failure> {
    compare(&program())
}

fn compare(program: &Path) -> Result<(), Failure> {
    let old = changed_pages(program, Compiled::AsOnThePage)?;
    if old.is_empty() {
        return Ok(());
    }
    let names = old.iter().map(|page| page.path.display().to_string());
    Err(Failure::OldFigures(names.collect()))
}

/// Stores the results of blind checks and rewrites their tables.
pub fn keep_accuracy(files: &[&str]) -> Result<(), Failure> {
    for file in files {
        println!("{}", accuracy::keep(Path::new(file))?.display());
    }
    write()
}

/// Measures the speed of the simulator and of the virtual board, and rewrites their tables.
pub fn keep_performance() -> Result<(), Failure> {
    performance::measure()?;
    write()
}

/// A page whose text has to change.
struct Page {
    path: PathBuf,
    text: String,
}

fn changed_pages(program: &Path, compiled: Compiled) -> Result<Vec<Page>, Failure> {
    let exact = Exact::new(program)?;
    let sets = Sets::kept()?;
    let kept = Performance::kept()?;
    let image = Image::new(compiled);
    let mut changed = Vec::new();
    for path in documentation::pages()? {
        let full = firmware_build::root().join(&path);
        let before = fs::read_to_string(&full).map_err(|e| Failure::file(&full, e))?;
        let text = marked::replaced(&before, |name, present| match name {
            "accuracy clean" => Ok(sets.table(Kind::Clean)),
            "accuracy messy" => Ok(sets.table(Kind::Messy)),
            "accuracy board" => Ok(sets.table(Kind::Board)),
            "accuracy messy board" => Ok(sets.table(Kind::MessyBoard)),
            "accuracy summary" => Ok(sets.summary()),
            "accuracy time" => Ok(sets.times()),
            "performance" => Ok(kept.as_ref().map(Performance::table)),
            "performance summary" => Ok(kept.as_ref().map(|kept| kept.summary(&sets))),
            "image" | "control-interrupt" => image.table(name, present),
            name => exact.table(name).map(Some),
        });
        let text = text.map_err(|error| Failure::Figures {
            page: path.display().to_string(),
            error: error.to_string(),
        })?;
        if text != before {
            changed.push(Page { path, text });
        }
    }
    Ok(changed)
}

/// Builds the command line with the development profile. Its numbers are equal to those of every other build.
fn built_program() -> Result<PathBuf, Failure> {
    run(&mut crate::cargo(&[
        "build",
        "--quiet",
        "--package",
        "paddle",
    ]))?;
    Ok(program())
}

fn program() -> PathBuf {
    documentation::target_folder().join("debug/paddle")
}
