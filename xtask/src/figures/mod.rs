//! `cargo xtask figures`: the tables of README and docs that hold numbers, written by what measures them.
//!
//! A page marks a table by `<!-- figures: NAME -->` and `<!-- end -->`. Some figures are the same on every machine: they are made anew
//! each time, and `--check` says which pages hold others. Those of the firmware image depend on the compiler alone, which their tables
//! name. All other results are kept in `docs/figures`, with date, machine and commit, and the tables come from there: the sets of the
//! blind check, which take hours (`figures accuracy FILE...`), and speeds (`figures performance`). A table whose results nobody kept
//! stays as it is.

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

/// Writes every table that is not as measured.
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

/// Makes sure that every table is as measured.
pub fn check() -> Result<(), Failure> {
    compare(&built_program()?)
}

/// Checks with the program that the tests have built, which may have other features than a build of its own.
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

/// Keeps the results of blind checks, and writes the tables of them.
pub fn keep_accuracy(files: &[&str]) -> Result<(), Failure> {
    for file in files {
        println!("{}", accuracy::keep(Path::new(file))?.display());
    }
    write()
}

/// Measures how fast the simulator and the virtual board are, and writes the tables of it.
pub fn keep_performance() -> Result<(), Failure> {
    performance::measure()?;
    write()
}

/// A page with other text than it has.
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

/// The command line, built for development: its numbers are those of every other build.
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
