//! Checks of the Python parts of this repository: the tests of the package, and the exported model in MuJoCo.

use std::process::Command;

use crate::test::say_skipped;
use crate::{Failure, cargo, run, shown};

/// Folder of the package build, relative to the repository, so that nothing is installed.
const FOLDER: &str = "target/python";
/// Exit status of a script whose requirements are missing.
const SKIPPED: i32 = 77;

/// Runs the checks whose requirements are available.
pub fn checks() -> Result<(), Failure> {
    package()?;
    mujoco()
}

/// Builds the package with maturin and runs its tests.
fn package() -> Result<(), Failure> {
    if let Err(lacking) = has(&["numpy", "maturin", "pip"]) {
        say_skipped("python_package", &lacking);
        return Ok(());
    }
    let folder = firmware_build::root().join(FOLDER);
    let [wheels, built, site] = ["wheels", "build", "site"].map(|name| folder.join(name));
    // A wheel of an earlier version would also be found.
    if wheels.exists() {
        std::fs::remove_dir_all(&wheels).map_err(|source| Failure::File {
            path: wheels.clone(),
            source,
        })?;
    }
    let mut build = python();
    build.args(["-m", "maturin", "build", "--quiet", "--manifest-path"]);
    build.args(["python/Cargo.toml", "--out"]).arg(&wheels);
    run(build.arg("--target-dir").arg(built))?;
    let mut install = python();
    install.args(["-m", "pip", "install", "--quiet", "--no-index", "--no-deps"]);
    install.args(["--upgrade", "--find-links"]).arg(wheels);
    run(install.arg("--target").arg(&site).arg("paddle-gap"))?;
    let mut tests = python();
    tests.args(["-m", "unittest", "discover", "python/tests"]);
    run(tests.env("PYTHONPATH", site))
}

/// Compares the gaps of exported models in MuJoCo with those of the simulator.
fn mujoco() -> Result<(), Failure> {
    if let Err(lacking) = has(&["numpy", "mujoco"]) {
        say_skipped("mujoco", &lacking);
        return Ok(());
    }
    run(&mut cargo(&["build", "--quiet", "--package", "paddle"]))?;
    let target = std::env::var_os("CARGO_TARGET_DIR").unwrap_or_else(|| "target".into());
    let program = firmware_build::root().join(target).join("debug/paddle");
    let mut check = python();
    check.arg("scripts/mujoco_check.py").arg(program);
    let status = check.status().map_err(|source| Failure::Spawn {
        command: shown(&check),
        source,
    })?;
    match status.code() {
        Some(0) => Ok(()),
        // The script has printed the reason.
        Some(SKIPPED) => {
            say_skipped("mujoco", "see above");
            Ok(())
        }
        _ => Err(Failure::Step(shown(&check))),
    }
}

/// Whether Python has these modules. Otherwise returns the missing ones.
fn has(modules: &[&str]) -> Result<(), String> {
    for module in modules {
        let import = format!("import {module}");
        match python().args(["-c", &import]).output() {
            Ok(output) if output.status.success() => {}
            Ok(_) => return Err(format!("Python has no {module}")),
            Err(error) => return Err(format!("no python3: {error}")),
        }
    }
    Ok(())
}

fn python() -> Command {
    let mut command = Command::new("python3");
    command.current_dir(firmware_build::root());
    command
}
