//! Tests formats that need cargo features, with files written by Python packages.

use import::{Recipe, import, read_log};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Writes a file of the format if Python has the package. Otherwise prints why not.
fn written(test: &str, package: &str, file: &str, script: &str) -> Option<PathBuf> {
    let folder = std::env::temp_dir().join(format!("import-formats-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let path = folder.join(file);
    let samples = "
import sys
path = sys.argv[1]
try:
    import numpy as np
    k = np.arange(400)
except ImportError:
    sys.exit(77)
t = np.round(k * 2e-3, 6)
u = np.round(0.02 * np.sin(9 * t), 6)
x = np.round(0.3 * np.cos(9 * t), 6)
";
    let guarded = format!(
        "{samples}\ntry:\n    import {package}\nexcept ImportError:\n    sys.exit(77)\n{script}"
    );
    let output = Command::new("python3")
        .arg("-c")
        .arg(guarded)
        .arg(&path)
        .output();
    match output {
        Ok(output) if output.status.success() => Some(path),
        Ok(output) if output.status.code() == Some(77) => {
            println!("skipped: python_formats: {test}: Python has no {package}");
            None
        }
        Ok(output) => panic!("{test}: {}", String::from_utf8_lossy(&output.stderr)),
        Err(error) => {
            println!("skipped: python_formats: {test}: no python3: {error}");
            None
        }
    }
}

fn assert_samples(path: &Path, recipe: &Recipe, runs: usize) {
    let log = read_log(path).unwrap_or_else(|error| panic!("{error}"));
    let names: Vec<&str> = log
        .columns
        .iter()
        .map(|column| column.name.as_str())
        .collect();
    let imported = import(std::slice::from_ref(&log), recipe)
        .unwrap_or_else(|error| panic!("{error}; {names:?}"));
    assert_eq!(imported.recording.runs.len(), runs, "{:?}", imported.notes);
    for run in &imported.recording.runs {
        assert_eq!(run.len(), 400, "{:?}", imported.notes);
        for k in 0..400 {
            let t = k as f64 * 2e-3;
            let off = [
                run.time[k] - t,
                run.input[k] - 0.02 * (9.0 * t).sin(),
                run.position[k] - 0.3 * (9.0 * t).cos(),
            ];
            assert!(
                off.iter().all(|off| off.abs() < 1e-6),
                "row {k}: {off:?}; {:?}",
                imported.roles
            );
        }
    }
}

#[cfg(feature = "numpy")]
mod numpy {
    use super::*;

    #[test]
    fn npz_with_vectors_and_a_matrix_is_read() {
        let script = "np.savez_compressed(path, time=t, q=np.stack([x, 2 * x], 1), tau=u.astype(np.float64), note=np.array('a'), once=np.array(3.0))";
        if let Some(path) = written("npz", "numpy", "log.npz", script) {
            let recipe = Recipe {
                position: Some("q[0]".into()),
                ..Recipe::default()
            };
            assert_samples(&path, &recipe, 1);
        }
    }

    #[test]
    fn npy_by_rows_and_by_columns_is_read() {
        for order in ["C", "F"] {
            let script =
                format!("np.save(path, np.array(np.stack([t, u, x], 1), order='{order}'))");
            if let Some(path) = written("npy", "numpy", &format!("{order}.npy"), &script) {
                let column = |at| Some(format!("a[{at}]"));
                let recipe = Recipe {
                    time: column(0),
                    input: column(1),
                    position: column(2),
                    ..Recipe::default()
                };
                assert_samples(&path, &recipe, 1);
            }
        }
    }
}

#[cfg(feature = "matlab")]
mod matlab {
    use super::*;

    #[test]
    fn mat_5_with_and_without_a_structure_is_read() {
        for (file, script) in [
            (
                "flat.mat",
                "scipy.io.savemat(path, {'t': t, 'tau': u, 'q': x})",
            ),
            (
                "packed.mat",
                "scipy.io.savemat(path, {'log': {'t': t, 'tau': u, 'q': x}, 'name': 'a'}, do_compression=True)",
            ),
        ] {
            if let Some(path) = written("mat 5", "scipy.io", file, script) {
                assert_samples(&path, &Recipe::default(), 1);
            }
        }
    }

    #[test]
    fn mat_7_3_is_read() {
        // MATLAB puts 512 bytes of its own before the HDF5 content.
        let script = "
f = h5py.File(path, 'w', userblock_size=512)
g = f.create_group('log')
for name, values in (('t', t), ('tau', u), ('q', x)):
    g.create_dataset(name, data=values.reshape(1, -1), chunks=(1, 100), compression='gzip')
f.close()
with open(path, 'r+b') as f:
    f.write(b'MATLAB 7.3 MAT-file, Platform: GLNXA64'.ljust(124) + b'\\x00\\x02IM')
";
        if let Some(path) = written("mat 7.3", "h5py", "log73.mat", script) {
            assert_samples(&path, &Recipe::default(), 1);
        }
    }
}

#[cfg(feature = "parquet")]
mod parquet {
    use super::*;

    #[test]
    fn flat_parquet_is_read() {
        let script = "
import pyarrow as pa, pyarrow.parquet as pq
pq.write_table(pa.table({'stamp': (t * 1e9).astype(np.int64) + 1700000000000000000, 'tau': u, 'q': x, 'mode': ['run'] * 400}), path)
";
        if let Some(path) = written("parquet", "pyarrow.parquet", "log.parquet", script) {
            assert_samples(&path, &Recipe::default(), 1);
        }
    }

    #[test]
    fn episodes_of_lerobot_become_runs() {
        let script = "
import pyarrow as pa, pyarrow.parquet as pq
state = [[float(a), float(2 * a)] for a in x] * 2
action = [[float(a), 0.0] for a in u] * 2
pq.write_table(pa.table({
    'observation.state': pa.array(state, pa.list_(pa.float64(), 2)), 'action': pa.array(action, pa.list_(pa.float64(), 2)),
    'timestamp': np.tile(t, 2), 'frame_index': np.tile(np.arange(400), 2), 'episode_index': np.repeat([0, 1], 400)}), path, compression='zstd')
";
        if let Some(path) = written("LeRobot", "pyarrow.parquet", "episodes.parquet", script) {
            let recipe = Recipe {
                position: Some("observation.state[0]".into()),
                input: Some("action[0]".into()),
                ..Recipe::default()
            };
            assert_samples(&path, &recipe, 2);
        }
    }
}

#[cfg(feature = "mcap")]
mod mcap {
    use super::*;

    #[test]
    fn joint_states_are_read_by_joint() {
        let script = "
import struct
from mcap.writer import Writer
SCHEMA = '''std_msgs/Header header
string[] name
float64[] position
float64[] velocity
float64[] effort
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
'''
class Cdr:
    def __init__(self): self.b = bytearray()
    def align(self, n): self.b += bytes(-len(self.b) % n)
    def put(self, f, n, v): self.align(n); self.b += struct.pack('<' + f, v)
    def text(self, s): self.put('I', 4, len(s) + 1); self.b += s.encode() + bytes(1)
    def many(self, vs):
        self.put('I', 4, len(vs))
        for v in vs: self.put('d', 8, v)
with open(path, 'wb') as f:
    w = Writer(f); w.start('ros2')
    s = w.register_schema('sensor_msgs/msg/JointState', 'ros2msg', SCHEMA.encode())
    c = w.register_channel('/joint_states', 'cdr', s)
    o = w.register_channel('/rosout', 'cbor', 0)
    w.add_message(o, 1, b'x', 1)
    for i in range(400):
        m = Cdr(); ns = int(round(t[i] * 1e9)) + 5
        m.put('i', 4, 1700000000); m.put('I', 4, ns); m.text('')
        m.put('I', 4, 2); m.text('wrist'); m.text('elbow')
        m.many([0.5, x[i]]); m.many([]); m.many([0.0, u[i]])
        w.add_message(c, i, bytes([0, 1, 0, 0]) + bytes(m.b), i + 7)
    w.finish()
";
        if let Some(path) = written("mcap", "mcap", "log.mcap", script) {
            let recipe = Recipe {
                position: Some("elbow.position".into()),
                input: Some("elbow.effort".into()),
                ..Recipe::default()
            };
            assert_samples(&path, &recipe, 1);
        }
    }
}

#[cfg(feature = "mcap")]
#[test]
fn unsupported_messages_are_refused_in_one_line_with_the_remedy() {
    for (encoding, schema) in [
        ("ros1", "ros1msg"),
        ("protobuf", "protobuf"),
        ("json", "jsonschema"),
    ] {
        let script = format!(
            "
from mcap.writer import Writer
with open(path, 'wb') as f:
    w = Writer(f); w.start()
    s = w.register_schema('sensor_msgs/JointState', '{schema}', b'x')
    c = w.register_channel('/joint_states', '{encoding}', s)
    for i in range(400): w.add_message(c, i, bytes(16), i)
    w.finish()
"
        );
        if let Some(path) = written("mcap", "mcap", &format!("{encoding}.mcap"), &script) {
            let error = read_log(&path).expect_err(encoding).to_string();
            assert!(!error.contains('\n'), "{error}");
            for said in [
                "/joint_states",
                encoding,
                "ros2msg",
                "export it anew, or as CSV",
            ] {
                assert!(error.contains(said), "{said}: {error}");
            }
        }
    }
}

#[cfg(not(feature = "numpy"))]
#[test]
fn a_format_that_is_not_built_in_is_named_with_its_feature() {
    if let Some(path) = written("not built in", "numpy", "log.npz", "np.savez(path, t=t)") {
        let error = read_log(&path).expect_err("no reader").to_string();
        assert!(error.contains("--features numpy"), "{error}");
    }
}

#[test]
fn a_text_that_python_packs_is_read() {
    let script = "
with gzip.open(path, 'wt', newline='') as f:
    w = csv.writer(f, delimiter=';')
    w.writerow(['t [s]', 'tau [Nm]', 'q [rad]'])
    w.writerows(zip(t, u, x))
";
    if let Some(path) = written("csv", "csv, gzip", "log.csv.gz", script) {
        assert_samples(&path, &Recipe::default(), 1);
    }
}
