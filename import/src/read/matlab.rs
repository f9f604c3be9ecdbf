//! Reads `.mat` files, versions 5 to 7.2 and 7.3.

use super::arrays::{Array, log_of};
use crate::log::Log;
use hdf5_reader::group::Group;
use hdf5_reader::{Dataset, Datatype, Hdf5File};
use matrw::MatVariable;

/// Reads all numeric arrays. Those in structures are named by their paths.
pub(super) fn read(bytes: &[u8]) -> Result<Log, String> {
    let mut arrays = Vec::new();
    if bytes.starts_with(b"MATLAB 5.0") {
        let bytes = with_usual_header(bytes);
        let file = matrw::load_matfile_from_u8(&bytes).map_err(|error| error.to_string())?;
        for (name, variable) in file.iter() {
            add_variable(name, variable, &mut arrays);
        }
    } else {
        let failed = |error: hdf5_reader::error::Error| error.to_string();
        let file = Hdf5File::from_bytes(bytes).map_err(failed)?;
        add_group("", &file.root_group().map_err(failed)?, &mut arrays)?;
    }
    Ok(log_of(arrays))
}

/// The file with the standard MATLAB header. Its text is arbitrary, and blanks are allowed for the subsystem.
fn with_usual_header(bytes: &[u8]) -> Vec<u8> {
    const TEXT: &[u8] = b"MATLAB 5.0 MAT-file, ";
    const SUBSYSTEM: std::ops::Range<usize> = 116..124;
    let mut bytes = bytes.to_vec();
    if bytes.len() > SUBSYSTEM.end {
        bytes[..TEXT.len()].copy_from_slice(TEXT);
        if bytes[SUBSYSTEM].iter().all(|byte| *byte == b' ') {
            bytes[SUBSYSTEM].fill(0);
        }
    }
    bytes
}

fn add_variable(name: &str, variable: &MatVariable, arrays: &mut Vec<Array>) {
    if let MatVariable::Structure(structure) = variable {
        for field in structure.fieldnames() {
            if let Some(inner) = structure.get(&field) {
                add_variable(&format!("{name}.{field}"), inner, arrays);
            }
        }
    } else if let Some(values) = variable.to_vec_f64() {
        let shape = variable.dim();
        arrays.push(Array {
            name: name.to_owned(),
            shape,
            is_by_columns: true,
            values,
        });
    }
}

fn add_group(path: &str, group: &Group, arrays: &mut Vec<Array>) -> Result<(), String> {
    let failed = |error: hdf5_reader::error::Error| error.to_string();
    let (groups, datasets) = group.members().map_err(failed)?;
    let inside = |name: &str| {
        let last = name.rsplit('/').next().unwrap_or(name);
        if path.is_empty() {
            last.to_owned()
        } else {
            format!("{path}.{last}")
        }
    };
    for inner in groups {
        // MATLAB stores the targets of cell references in `#refs#`.
        if !inner.name().contains('#') {
            add_group(&inside(inner.name()), &inner, arrays)?;
        }
    }
    for dataset in datasets {
        let name = inside(dataset.name());
        if let Some(values) = numbers(&dataset) {
            let shape = dataset
                .shape()
                .iter()
                .filter_map(|size| usize::try_from(*size).ok())
                .collect();
            arrays.push(Array {
                name,
                shape,
                is_by_columns: false,
                values,
            });
        }
    }
    Ok(())
}

/// The numbers of a dataset. `None` for other data.
#[expect(
    clippy::cast_precision_loss,
    reason = "counters beyond 2^53 are no positions"
)]
fn numbers(dataset: &Dataset) -> Option<Vec<f64>> {
    macro_rules! read {
        ($type:ty) => {
            dataset
                .read_array::<$type>()
                .ok()?
                .into_iter()
                .map(|value| value as f64)
                .collect()
        };
    }
    Some(match dataset.dtype() {
        Datatype::FloatingPoint { size: 4, .. } => read!(f32),
        Datatype::FloatingPoint { size: 8, .. } => read!(f64),
        Datatype::FixedPoint {
            size: 1,
            signed: true,
            ..
        } => read!(i8),
        Datatype::FixedPoint {
            size: 2,
            signed: true,
            ..
        } => read!(i16),
        Datatype::FixedPoint {
            size: 4,
            signed: true,
            ..
        } => read!(i32),
        Datatype::FixedPoint {
            size: 8,
            signed: true,
            ..
        } => read!(i64),
        Datatype::FixedPoint { size: 1, .. } => read!(u8),
        Datatype::FixedPoint { size: 2, .. } => read!(u16),
        Datatype::FixedPoint { size: 4, .. } => read!(u32),
        Datatype::FixedPoint { size: 8, .. } => read!(u64),
        _ => return None,
    })
}
