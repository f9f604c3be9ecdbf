//! Files for one test, and a motion for them.

use import::{ImportError, Imported, Recipe};
use std::path::{Path, PathBuf};

/// A folder that is removed after the test.
pub struct Folder(PathBuf);

impl Folder {
    pub fn new(test: &str) -> Self {
        let folder = std::env::temp_dir().join(format!("import-{test}-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder");
        Self(folder)
    }

    pub fn path(&self) -> &Path {
        &self.0
    }

    pub fn put(&self, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
        let path = self.0.join(name);
        std::fs::write(&path, bytes).expect("a file");
        path
    }

    /// Imports `text` as a file called `name`.
    pub fn import(
        &self,
        name: &str,
        text: impl AsRef<[u8]>,
        recipe: &Recipe,
    ) -> Result<Imported, ImportError> {
        let path = self.put(name, text);
        import::import(&[import::read_log(&path)?], recipe)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        // What remains is in the system's folder for temporary files.
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

pub const ROWS: i32 = 400;

/// Time in s, input in N m, position in rad of row `k`.
pub fn sample(k: i32) -> [f64; 3] {
    let t = f64::from(k) * 2e-3;
    let tidy = |value: f64| (value * 1e6).round() / 1e6;
    [
        tidy(t),
        tidy(0.02 * (9.0 * t).sin()),
        tidy(0.3 * (9.0 * t).cos()),
    ]
}

/// A table of all rows, each written by `row`.
pub fn table(head: &str, row: impl Fn([f64; 3]) -> String) -> String {
    (0..ROWS)
        .map(sample)
        .fold(head.to_owned(), |text, cells| text + &row(cells) + "\n")
}

/// Asserts that the only run has the samples, with an error of at most `within`.
pub fn assert_holds_samples(imported: &Imported, within: f64, of: &str) {
    let [run] = imported.recording.runs.as_slice() else {
        panic!("{of}: {} runs", imported.recording.runs.len());
    };
    assert_eq!(
        run.len(),
        usize::try_from(ROWS).expect("a count"),
        "{of}: {:?}",
        imported.notes
    );
    for k in 0..ROWS {
        let row = usize::try_from(k).expect("a row");
        let [t, u, x] = sample(k);
        let off = [run.time[row] - t, run.input[row] - u, run.position[row] - x];
        assert!(
            off.iter().all(|off| off.abs() <= within),
            "{of}, row {k}: off by {off:?}; {:?}",
            imported.roles
        );
    }
}
