//! Passes the commit of the source tree to the compiled program.

use std::path::Path;
use std::process::Command;

/// Other crates of the repository that the program is built from.
const CRATES: [&str; 8] = [
    "../src",
    "../blind",
    "../gap",
    "../host-sim",
    "../link",
    "../remote",
    "../recording",
    "../virtual-board",
];

fn main() {
    println!(
        "cargo::rustc-env=PADDLE_COMMIT={}",
        commit().unwrap_or_else(|| "unknown".into())
    );
    println!("cargo::rerun-if-changed=.");
    let mut watched: Vec<String> = CRATES.map(String::from).to_vec();
    let reference = git(&["symbolic-ref", "--quiet", "HEAD"]);
    let names = ["HEAD", "logs/HEAD", "packed-refs"].map(String::from);
    let of_git = names.into_iter().chain(reference);
    watched.extend(of_git.filter_map(|name| git(&["rev-parse", "--git-path", &name])));
    // Cargo treats a watched path that does not exist as changed at every build.
    for path in watched.iter().filter(|path| Path::new(path).exists()) {
        println!("cargo::rerun-if-changed={path}");
    }
}

/// Returns the commit, with a mark if files differ from it. Returns `None` outside the project's own repository.
fn commit() -> Option<String> {
    // Sources that were unpacked inside another repository do not belong to a commit of that repository.
    git(&["ls-files", "--error-unmatch", "build.rs"])?;
    let hash = git(&["rev-parse", "HEAD"])?;
    let changes = git(&["status", "--porcelain", "--untracked-files=no"])?;
    let mark = if changes.is_empty() { "" } else { "-dirty" };
    Some(hash + mark)
}

fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").args(arguments).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    output.status.success().then(|| text.trim().to_owned())
}
