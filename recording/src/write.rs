//! Writes a [`Recording`] to a folder.

use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::Path;

use crate::error::{Error, Fault};
use crate::manifest;
use crate::validate::is_inside;
use crate::{Recording, Run};

impl Recording {
    /// Writes the recording into `folder`, which is created if needed. Existing files with the same names are replaced.
    ///
    /// Numbers are written with the fewest digits that give the same number when read.
    ///
    /// # Errors
    ///
    /// If the file system refuses, a column has another length than `time`, two runs have the same file name, or a number of
    /// the manifest is out of range. [`Recording::validate`] checks whether the samples can be used.
    pub fn write(&self, folder: impl AsRef<Path>) -> Result<(), Error> {
        let folder = folder.as_ref();
        let path = folder.join(manifest::FILE);
        self.check_writable()
            .and_then(|()| self.validate_manifest().map(drop))
            .map_err(|error| error.in_file(&path))?;
        let text = manifest::text(self)
            .map_err(|source| Error::new(Fault::Unwritable { source }).in_file(&path))?;

        let mend = "choose a folder that can be written";
        let failed = |path: &Path| {
            let path = path.to_owned();
            move |source| {
                Error::new(Fault::Io {
                    doing: "write",
                    source,
                    mend,
                })
                .in_file(&path)
            }
        };
        fs::create_dir_all(folder).map_err(failed(folder))?;
        for run in &self.runs {
            let path = folder.join(&run.file);
            if let Some(parent) = path.parent() {
                fs::create_dir_all(parent).map_err(failed(parent))?;
            }
            File::create(&path)
                .and_then(|file| write_run(run, BufWriter::new(file)))
                .map_err(failed(&path))?;
        }
        fs::write(&path, text).map_err(failed(&path))
    }

    fn check_writable(&self) -> Result<(), Error> {
        for (k, run) in self.runs.iter().enumerate() {
            let file = run.file.clone();
            if !is_inside(&file) {
                return Err(Error::new(Fault::Outside { file }));
            }
            if file == manifest::FILE || self.runs[..k].iter().any(|other| other.file == file) {
                return Err(Error::new(Fault::SameFile { file }));
            }
            let wide = wide_columns(run).map(|(name, column)| (name, column.len()));
            let narrow = narrow_columns(run).map(|(name, column)| (name, column.len()));
            for (column, found) in wide.chain(narrow) {
                if found != run.len() {
                    let column = format!("{column} of {file}");
                    return Err(Error::new(Fault::Length {
                        column,
                        found,
                        expected: run.len(),
                    }));
                }
            }
        }
        Ok(())
    }
}

fn wide_columns(run: &Run) -> impl Iterator<Item = (&str, &[f64])> {
    [
        ("time", &run.time),
        ("input", &run.input),
        ("position", &run.position),
    ]
    .into_iter()
    .chain(run.setpoint.iter().map(|column| ("setpoint", column)))
    .chain(
        run.positions
            .iter()
            .map(|(name, column)| (name.as_str(), column)),
    )
    .map(|(name, column)| (name, column.as_slice()))
}

fn narrow_columns(run: &Run) -> impl Iterator<Item = (&'static str, &[f32])> {
    [
        ("current", &run.current),
        ("supply", &run.supply),
        ("temperature", &run.temperature),
    ]
    .into_iter()
    .filter_map(|(name, column)| Some((name, column.as_deref()?)))
}

fn write_run(run: &Run, mut out: impl Write) -> std::io::Result<()> {
    let wide: Vec<_> = wide_columns(run).collect();
    let narrow: Vec<_> = narrow_columns(run).collect();
    let names: Vec<_> = wide
        .iter()
        .map(|(name, _)| *name)
        .chain(narrow.iter().map(|(name, _)| *name))
        .collect();
    writeln!(out, "{}", names.join(","))?;
    for k in 0..run.len() {
        for (c, (_, column)) in wide.iter().enumerate() {
            write!(out, "{}{}", if c > 0 { "," } else { "" }, column[k])?;
        }
        for (_, column) in &narrow {
            write!(out, ",{}", column[k])?;
        }
        writeln!(out)?;
    }
    out.flush()
}
