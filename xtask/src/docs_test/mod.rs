//! `cargo xtask docs-test`: runs every command of README and docs in a clean copy of the repository.

mod checkout;
mod page;
mod shell;

use std::fs;
use std::path::Path;
use std::process::Command;
use std::time::Instant;

use crate::Failure;
use crate::documentation::{pages, target_folder};
use checkout::Checkout;
use page::Step;
use shell::Shell;

/// Number of lines of a failed command's output that are printed.
const LINES_SHOWN: usize = 15;

/// Runs the commands of all pages, or of the pages whose paths contain one of `parts`.
pub fn run(parts: &[&str]) -> Result<(), Failure> {
    let folder = target_folder().join("docs-test");
    let checkout = Checkout::new(folder.join("checkout"))?;
    // Cargo identifies packages by their path within the workspace, so two checkouts must not share a target folder.
    let target = folder.join("target");
    fs::create_dir_all(&target).map_err(|e| Failure::file(&target, e))?;
    checkout.clean()?;
    // The pages call the program by its name, as if it were installed.
    crate::run(
        Command::new("cargo")
            .args(["build", "--quiet", "--release", "--package", "paddle"])
            .current_dir(checkout.folder())
            .env("CARGO_TARGET_DIR", &target),
    )?;
    let mut failed = Vec::new();
    for page in pages()? {
        let name = page.display().to_string();
        if parts.is_empty() || parts.iter().any(|part| name.contains(part)) {
            failed.extend(run_page(&page, &checkout, &target)?);
        }
    }
    if failed.is_empty() {
        Ok(())
    } else {
        Err(Failure::Documented(failed))
    }
}

/// Runs the commands of a page. Returns the failed commands, each with its page and line.
fn run_page(page: &Path, checkout: &Checkout, target: &Path) -> Result<Vec<String>, Failure> {
    let path = firmware_build::root().join(page);
    let markdown = fs::read_to_string(&path).map_err(|e| Failure::file(&path, e))?;
    let name = page.display();
    let steps = match page::steps(&markdown) {
        Ok(steps) => steps,
        Err(error) => {
            println!("FAILED {name}: {error}");
            return Ok(vec![format!("{name}: {error}")]);
        }
    };
    if steps.is_empty() {
        return Ok(Vec::new());
    }
    checkout.clean()?;
    let mut shell = Shell::new(checkout.folder(), target);
    let mut failed = Vec::new();
    for step in steps {
        match step {
            Step::Skip {
                line,
                command,
                reason,
            } => println!("skipped: {name}:{line} {command}: {reason}"),
            Step::File { name, content } => write(&checkout.folder().join(name), &content)?,
            Step::Run { line, command } => {
                let begun = Instant::now();
                let outcome = shell.run(&command)?;
                let seconds = begun.elapsed().as_secs_f64();
                match outcome {
                    Ok(()) => println!("ok {name}:{line} {command} ({seconds:.1} s)"),
                    Err(trouble) => {
                        println!("FAILED {name}:{line} {command}: {}", trouble.outcome);
                        let lines: Vec<_> = trouble.printed.lines().collect();
                        for line in &lines[lines.len().saturating_sub(LINES_SHOWN)..] {
                            println!("    {line}");
                        }
                        failed.push(format!("{name}:{line}"));
                    }
                }
            }
        }
    }
    Ok(failed)
}

fn write(path: &Path, content: &str) -> Result<(), Failure> {
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder).map_err(|e| Failure::file(folder, e))?;
    }
    fs::write(path, content).map_err(|e| Failure::file(path, e))
}
