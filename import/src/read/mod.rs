//! Reads files of other programs into [`Log`]s.

#[cfg(any(feature = "numpy", feature = "matlab"))]
mod arrays;
mod layout;
#[cfg(feature = "matlab")]
mod matlab;
#[cfg(feature = "mcap")]
mod mcap;
mod number;
#[cfg(feature = "numpy")]
mod numpy;
#[cfg(feature = "parquet")]
mod parquet;
mod table;
mod text;

use crate::error::ImportError;
use crate::log::Log;
use flate2::read::MultiGzDecoder;
use std::io::Read;
use std::path::Path;

/// First bytes of a gzip file.
const GZIP: &[u8] = &[0x1F, 0x8B];

/// Reads a log of any format. The first bytes determine the format. Other files are read as text in columns.
///
/// # Errors
///
/// [`ImportError`] for a file that cannot be read or decoded.
pub fn log(path: &Path) -> Result<Log, ImportError> {
    let name = name(path);
    let failed = |source| ImportError::Read {
        path: path.to_owned(),
        source,
    };
    let mut bytes = std::fs::read(path).map_err(failed)?;
    if bytes.starts_with(GZIP) {
        let mut unpacked = Vec::new();
        MultiGzDecoder::new(bytes.as_slice())
            .read_to_end(&mut unpacked)
            .map_err(failed)?;
        bytes = unpacked;
    }
    let mut log = match Format::of(&bytes) {
        Format::Text => table::read(&text::decoded(bytes), path)?,
        Format::Numpy => numpy_log(&bytes, path)?,
        Format::Matlab => matlab_log(&bytes, path)?,
        Format::Parquet => parquet_log(bytes, path)?,
        Format::Mcap => mcap_log(&bytes, path)?,
    };
    log.name = name;
    Ok(log)
}

/// The name of a file without its extensions.
fn name(path: &Path) -> String {
    let name = path
        .file_name()
        .map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let name = name.strip_suffix(".gz").unwrap_or(&name);
    match name.rsplit_once('.') {
        Some((stem, _)) if !stem.is_empty() => stem.to_owned(),
        _ => name.to_owned(),
    }
}

/// Formats with characteristic first bytes.
enum Format {
    Text,
    Numpy,
    Matlab,
    Parquet,
    Mcap,
}

impl Format {
    fn of(bytes: &[u8]) -> Self {
        let starts = |magic: &[u8]| bytes.starts_with(magic);
        if starts(b"\x93NUMPY") || starts(b"PK\x03\x04") {
            Self::Numpy
        } else if starts(b"MATLAB 5.0 MAT-file")
            || starts(b"MATLAB 7.3 MAT-file")
            || starts(b"\x89HDF\r\n\x1a\n")
        {
            Self::Matlab
        } else if starts(b"PAR1") {
            Self::Parquet
        } else if starts(b"\x89MCAP0\r\n") {
            Self::Mcap
        } else {
            Self::Text
        }
    }
}

macro_rules! optional {
    ($name:ident, $feature:literal, $format:literal, $bytes:ty, $read:path) => {
        #[cfg(feature = $feature)]
        fn $name(bytes: $bytes, path: &Path) -> Result<Log, ImportError> {
            $read(bytes).map_err(|why| ImportError::Malformed {
                path: path.to_owned(),
                why,
            })
        }
        #[cfg(not(feature = $feature))]
        fn $name(_: $bytes, path: &Path) -> Result<Log, ImportError> {
            Err(ImportError::NotBuiltIn {
                path: path.to_owned(),
                format: $format,
                feature: $feature,
            })
        }
    };
}

optional!(numpy_log, "numpy", ".npy and .npz", &[u8], numpy::read);
optional!(matlab_log, "matlab", ".mat", &[u8], matlab::read);
optional!(parquet_log, "parquet", "Parquet", Vec<u8>, parquet::read);
optional!(mcap_log, "mcap", "MCAP", &[u8], mcap::read);
