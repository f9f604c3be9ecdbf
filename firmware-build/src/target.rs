//! Makes the firmware's compiler target available to the active toolchain.
//!
//! There are three ways, tried in turn: the target is already installed; `rustup` installs it; or `core` is built from the
//! distribution's source package of exactly this compiler version.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::TARGET;

/// Releases of the distribution that may contain the source of a newer compiler.
const SUITES: [&str; 3] = ["trixie", "trixie-backports", "sid"];

/// Reason why the target is not available.
#[derive(Debug, thiserror::Error)]
pub enum TargetError {
    /// A required program is not installed.
    #[error("cannot run `{program}`: {source}; install it, or add its folder to PATH")]
    Spawn {
        /// Name of the program.
        program: String,
        /// Error of the operating system.
        source: io::Error,
    },
    /// A required program failed.
    #[error("`{program}` failed: {message}")]
    Failed {
        /// Name of the program.
        program: String,
        /// Message of the program.
        message: String,
    },
    /// A file or folder cannot be read or written.
    #[error("cannot read or write {}: {source}; check its permissions and the free space", path.display())]
    File {
        /// Path of the file or folder.
        path: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
    /// No source provides the target.
    #[error(
        "no {TARGET} for this compiler ({version}): rustup did not provide it \
         and {lacking}; run `rustup target add {TARGET}` where its server can be reached"
    )]
    NoWay {
        /// Version of the compiler.
        version: String,
        /// Missing requirement of the third way.
        lacking: String,
    },
}

/// Makes [`TARGET`] available to the active toolchain. Before each long step, `say` receives a message with the step and its
/// approximate duration.
///
/// # Errors
/// Returns [`TargetError`] with the failed step. The toolchain is then unchanged.
pub fn ensure(say: impl Fn(&str)) -> Result<(), TargetError> {
    let library = PathBuf::from(rustc(&["--print", "target-libdir", "--target", TARGET])?);
    if holds_core(&library) {
        return Ok(());
    }
    say(&format!(
        "adding the compiler's target {TARGET}, once: rustup fetches some 10 MB, which takes a few seconds"
    ));
    match output(Command::new("rustup").args(["target", "add", TARGET])) {
        Ok(_) if holds_core(&library) => return Ok(()),
        Ok(_) => say("rustup serves another toolchain"),
        Err(error) => say(&error.to_string()),
    }
    say("building core from the distribution's source instead, which takes one to five minutes");
    let scratch = crate::root().join("target/thumb-core");
    clear(&scratch)?;
    let source = standard_library_source(&scratch)?;
    let built = build_core(&source, &scratch)?;
    install(&built, &library)?;
    remove(&scratch)
}

fn holds_core(library: &Path) -> bool {
    fs::read_dir(library).is_ok_and(|entries| {
        entries
            .flatten()
            .any(|entry| entry.file_name().to_string_lossy().starts_with("libcore-"))
    })
}

/// Source of the standard library for the installed compiler, from the toolchain or from a package.
fn standard_library_source(scratch: &Path) -> Result<PathBuf, TargetError> {
    let sysroot = rustc(&["--print", "sysroot"])?;
    let own = Path::new(&sysroot).join("lib/rustlib/src/rust/library");
    if own.join("Cargo.lock").is_file() {
        return Ok(own);
    }
    let banner = rustc(&["--version"])?;
    let version = banner.split_whitespace().nth(1).unwrap_or_default();
    let archive = Archive::of_this_machine(scratch, version)?;
    let package = archive.find(version)?;
    let unpacked = scratch.join("unpacked");
    output(
        Command::new("dpkg-deb")
            .arg("-x")
            .args([&archive.download(&package)?, &unpacked]),
    )?;
    Ok(unpacked.join(format!("usr/src/rustc-{version}/library")))
}

/// The package archive of the distribution. It is read with separate package lists, so that those of the machine stay
/// unchanged.
struct Archive {
    folder: PathBuf,
    sources: PathBuf,
}

impl Archive {
    /// Uses the mirror and key of this machine, with the releases that may contain the source.
    fn of_this_machine(scratch: &Path, version: &str) -> Result<Self, TargetError> {
        let (mirror, key) = machine_mirror().ok_or_else(|| TargetError::NoWay {
            version: version.into(),
            lacking: "this machine has no Debian package mirror to take rust-src from".into(),
        })?;
        let folder = scratch.join("apt");
        for part in ["lists/partial", "cache/archives/partial"] {
            create_folder(&folder.join(part))?;
        }
        let lines: String = SUITES
            .iter()
            .map(|suite| format!("deb [signed-by={key}] {mirror} {suite} main\n"))
            .collect();
        let archive = Self {
            sources: folder.join("sources.list"),
            folder,
        };
        write(&archive.sources, &lines)?;
        output(archive.apt("apt-get").arg("update"))?;
        Ok(archive)
    }

    /// Full version of the `rust-src` package for a compiler version.
    fn find(&self, version: &str) -> Result<String, TargetError> {
        let listing = output(self.apt("apt-cache").args(["madison", "rust-src"]))?;
        matching_version(&listing, version)
            .map(str::to_owned)
            .ok_or_else(|| TargetError::NoWay {
                version: version.into(),
                lacking: "the package mirror shows no rust-src of the same version".into(),
            })
    }

    /// Downloads the package and returns the path of its file.
    fn download(&self, package: &str) -> Result<PathBuf, TargetError> {
        output(
            self.apt("apt-get")
                .args(["download", &format!("rust-src={package}")])
                .current_dir(&self.folder),
        )?;
        entries(&self.folder)?
            .into_iter()
            .find(|path| path.extension().is_some_and(|extension| extension == "deb"))
            .ok_or_else(|| TargetError::Failed {
                program: "apt-get download".into(),
                message: "it left no package file".into(),
            })
    }

    fn apt(&self, program: &str) -> Command {
        let mut command = Command::new(program);
        for (key, value) in [
            ("Dir::Etc::sourcelist", self.sources.display().to_string()),
            ("Dir::Etc::sourceparts", "-".into()),
            (
                "Dir::State::Lists",
                self.folder.join("lists").display().to_string(),
            ),
            (
                "Dir::Cache",
                self.folder.join("cache").display().to_string(),
            ),
            ("APT::Sandbox::User", String::new()),
        ] {
            command.arg("-o").arg(format!("{key}={value}"));
        }
        command
    }
}

/// Mirror and signing key of the first Debian entry in the machine's package sources.
fn machine_mirror() -> Option<(String, String)> {
    entries(Path::new("/etc/apt/sources.list.d"))
        .ok()?
        .iter()
        .filter(|path| {
            path.extension()
                .is_some_and(|extension| extension == "sources")
        })
        .filter_map(|path| fs::read_to_string(path).ok())
        .find_map(|text| debian_stanza(&text))
}

/// Mirror and key of the first entry that offers Debian's `main`.
fn debian_stanza(sources: &str) -> Option<(String, String)> {
    sources.split("\n\n").find_map(|stanza| {
        let field = |name: &str| {
            stanza.lines().find_map(|line| {
                let value = line.strip_prefix(name)?.strip_prefix(':')?;
                value.split_whitespace().next().map(str::to_owned)
            })
        };
        let mirror = field("URIs").filter(|uri| uri.trim_end_matches('/').ends_with("/debian"))?;
        Some((mirror, field("Signed-By")?))
    })
}

/// Finds the package version for a compiler version in the table of `apt-cache madison`.
fn matching_version<'a>(madison: &'a str, version: &str) -> Option<&'a str> {
    madison
        .lines()
        .filter_map(|line| line.split('|').nth(1).map(str::trim))
        .find(|full| {
            full.strip_prefix(version)
                .is_some_and(|rest| rest.starts_with(['+', '-', '~']))
        })
}

/// Builds `core` and `alloc` for the target and returns their folder.
fn build_core(source: &Path, scratch: &Path) -> Result<PathBuf, TargetError> {
    let package = scratch.join("empty");
    create_folder(&package.join("src"))?;
    write(
        &package.join("Cargo.toml"),
        "[package]\nname = \"empty\"\nedition = \"2024\"\n[workspace]\n",
    )?;
    write(&package.join("src/lib.rs"), "#![no_std]\n")?;
    let build = scratch.join("build");
    output(
        crate::cargo(&[
            "build",
            "--quiet",
            "--release",
            "-Zbuild-std=core,alloc",
            "--target",
            TARGET,
        ])
        .current_dir(&package)
        // Link-time optimization of core needs its bitcode.
        .env("CARGO_ENCODED_RUSTFLAGS", "-Cembed-bitcode=yes")
        // `build-std` is not available to stable compilers, and it searches its source only in the toolchain.
        .env("RUSTC_BOOTSTRAP", "1")
        .env("__CARGO_TESTS_ONLY_SRC_ROOT", source)
        .env("CARGO_TARGET_DIR", &build),
    )?;
    Ok(build.join(TARGET).join("release/deps"))
}

/// Moves the built libraries in one step to the folder in which rustup would install them.
fn install(built: &Path, library: &Path) -> Result<(), TargetError> {
    const CRATES: [&str; 3] = ["libcore-", "liballoc-", "libcompiler_builtins-"];
    let staged = library.with_extension("partial");
    clear(&staged)?;
    for from in entries(built)? {
        let Some(name) = from
            .file_name()
            .map(|name| name.to_string_lossy().into_owned())
        else {
            continue;
        };
        let wanted = CRATES.iter().any(|stem| name.starts_with(stem));
        if wanted && (name.ends_with(".rlib") || name.ends_with(".rmeta")) {
            fs::copy(&from, staged.join(&name)).map_err(file_error(&from))?;
        }
    }
    remove(library)?;
    fs::rename(&staged, library).map_err(file_error(library))
}

fn rustc(arguments: &[&str]) -> Result<String, TargetError> {
    Ok(output(Command::new("rustc").args(arguments))?
        .trim()
        .to_owned())
}

/// Runs a command without showing its output. Returns its standard output, or an error with its message.
fn output(command: &mut Command) -> Result<String, TargetError> {
    let program = command.get_program().to_string_lossy().into_owned();
    let outcome = command.output().map_err(|source| TargetError::Spawn {
        program: program.clone(),
        source,
    })?;
    if outcome.status.success() {
        Ok(String::from_utf8_lossy(&outcome.stdout).into_owned())
    } else {
        Err(TargetError::Failed {
            program,
            message: String::from_utf8_lossy(&outcome.stderr).trim().to_owned(),
        })
    }
}

fn entries(folder: &Path) -> Result<Vec<PathBuf>, TargetError> {
    fs::read_dir(folder)
        .and_then(|entries| entries.map(|entry| Ok(entry?.path())).collect())
        .map_err(file_error(folder))
}

fn clear(folder: &Path) -> Result<(), TargetError> {
    remove(folder)?;
    create_folder(folder)
}

fn remove(folder: &Path) -> Result<(), TargetError> {
    match fs::remove_dir_all(folder) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(file_error(folder)(error)),
        _ => Ok(()),
    }
}

fn create_folder(folder: &Path) -> Result<(), TargetError> {
    fs::create_dir_all(folder).map_err(file_error(folder))
}

fn write(path: &Path, text: &str) -> Result<(), TargetError> {
    fs::write(path, text).map_err(file_error(path))
}

fn file_error(path: &Path) -> impl FnOnce(io::Error) -> TargetError {
    let path = path.to_owned();
    move |source| TargetError::File { path, source }
}

#[cfg(test)]
mod tests {
    use super::{debian_stanza, matching_version};

    #[test]
    fn the_package_version_equals_the_compiler_version() {
        let madison = "  rust-src | 1.95.1+dfsg1-1 | http://mirror sid/main amd64 Packages\n  \
                       rust-src | 1.95.0+dfsg1-1~bpo13+1 | http://mirror backports/main Packages\n";
        assert_eq!(
            matching_version(madison, "1.95.0"),
            Some("1.95.0+dfsg1-1~bpo13+1")
        );
        assert_eq!(matching_version(madison, "1.9"), None);
        assert_eq!(matching_version("", "1.95.0"), None);
    }

    #[test]
    fn mirror_and_key_of_the_debian_entry_are_read() {
        let sources = "Types: deb\nURIs: https://other/tools\nSigned-By: /other.gpg\n\n\
                       Types: deb\n# a note\nURIs: http://mirror/debian\nSuites: bookworm\n\
                       Signed-By: /debian.gpg\n";
        assert_eq!(
            debian_stanza(sources),
            Some(("http://mirror/debian".into(), "/debian.gpg".into()))
        );
        assert_eq!(debian_stanza("Types: deb\n"), None);
    }
}
