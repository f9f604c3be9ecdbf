//! Reads `.npy` and `.npz` files of numpy.

use super::arrays::{Array, log_of};
use crate::log::Log;
use npyz::{DType, NpyFile, Order, TypeChar};
use std::io::{Cursor, Read};
use zip::ZipArchive;

/// Reads one array or an archive of several.
pub(super) fn read(bytes: &[u8]) -> Result<Log, String> {
    if !bytes.starts_with(b"PK") {
        return Ok(log_of(array("a", bytes)?));
    }
    let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(|error| error.to_string())?;
    let mut arrays = Vec::new();
    for place in 0..archive.len() {
        let mut file = archive.by_index(place).map_err(|error| error.to_string())?;
        let name = file
            .name()
            .map_err(|error| error.to_string())?
            .trim_end_matches(".npy")
            .to_owned();
        let mut unpacked = Vec::new();
        file.read_to_end(&mut unpacked)
            .map_err(|error| error.to_string())?;
        // Archives can contain text and objects, which are left out.
        arrays.extend(array(&name, &unpacked).unwrap_or_default());
    }
    Ok(log_of(arrays))
}

/// The arrays of one file: one, or one per field of a structured array.
fn array(name: &str, bytes: &[u8]) -> Result<Vec<Array>, String> {
    let failed = |error: std::io::Error| error.to_string();
    let file = NpyFile::new(bytes).map_err(failed)?;
    let shape: Vec<usize> = file
        .shape()
        .iter()
        .filter_map(|size| usize::try_from(*size).ok())
        .collect();
    let is_by_columns = file.order() == Order::Fortran;
    let whole = |values| Array {
        name: name.to_owned(),
        shape: shape.clone(),
        is_by_columns,
        values,
    };
    let plain = match file.dtype() {
        DType::Plain(plain) => plain,
        DType::Record(_) => {
            return Err("it is an array of records; save each field as an array".into());
        }
        DType::Array(..) => return Err("it is an array of arrays; save each as one".into()),
    };
    let narrow = |bytes: u64| plain.size_field() == bytes;
    macro_rules! read {
        ($type:ty) => {
            file.into_vec::<$type>()
                .map_err(failed)?
                .into_iter()
                .map(|value| value as f64)
                .collect()
        };
    }
    #[expect(
        clippy::cast_precision_loss,
        reason = "counters beyond 2^53 are no positions"
    )]
    let values: Vec<f64> = match plain.type_char() {
        TypeChar::Float if narrow(4) => read!(f32),
        TypeChar::Float if narrow(8) => read!(f64),
        TypeChar::Int if narrow(1) => read!(i8),
        TypeChar::Int if narrow(2) => read!(i16),
        TypeChar::Int if narrow(4) => read!(i32),
        TypeChar::Int if narrow(8) => read!(i64),
        TypeChar::Uint if narrow(1) => read!(u8),
        TypeChar::Uint if narrow(2) => read!(u16),
        TypeChar::Uint if narrow(4) => read!(u32),
        TypeChar::Uint if narrow(8) => read!(u64),
        TypeChar::Bool => file
            .into_vec::<bool>()
            .map_err(failed)?
            .into_iter()
            .map(f64::from)
            .collect(),
        _ => return Err("it is no array of numbers".into()),
    };
    Ok(vec![whole(values)])
}
