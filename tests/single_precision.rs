//! Checks that the library contains no f64, because the target's FPU has no double precision.

use std::fs;
use std::path::Path;

fn check(folder: &Path) -> usize {
    let mut files = 0;
    for entry in fs::read_dir(folder).unwrap().map(Result::unwrap) {
        let path = entry.path();
        if path.is_dir() {
            files += check(&path);
        } else {
            let text = fs::read_to_string(&path).unwrap();
            let shipped = text.split("#[cfg(test)]").next().unwrap();
            assert!(!shipped.contains("f64"), "{} mentions f64", path.display());
            files += 1;
        }
    }
    files
}

#[test]
fn no_f64_in_the_library() {
    assert!(check(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src")) > 10);
}
