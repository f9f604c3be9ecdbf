//! `paddle gap fleet`: compares the diagnoses of many recordings.

use crate::answer::Answer;
use crate::failure::Failure;
use clap::Args;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Options of the comparison.
#[derive(Args)]
#[command(after_help = "Examples:
  paddle gap fleet paddle-out/diagnoses
  paddle gap fleet shard-*.jsonl --device 1

A recording belongs to the device that its folder's parent names: fleet/paddle-07/2026-01-02 to paddle-07. --device N takes
the N-th folder from the end instead, 0 the recording's own. Recordings of a device are in the order of their names.")]
pub struct Arguments {
    /// Folders of batch results, and files of JSON lines.
    #[arg(required = true, value_name = "RESULTS")]
    results: Vec<PathBuf>,
    /// Position of the device name in a recording's path: the number of the folder, counted from the end.
    #[arg(long, value_name = "N", default_value_t = 1)]
    device: usize,
}

/// A device is reported if its value differs from the median of the other devices by this many median absolute deviations.
const APART: f64 = 5.0;
/// Fewest other devices for a comparison.
const LEAST_SIBLINGS: usize = 4;
/// Smallest relative difference that is reported, even if the spread of the other devices is smaller.
const LEAST_SHARE: f64 = 0.1;

/// A parameter of an effect on one recording.
struct Size {
    device: String,
    recording: String,
    value: f64,
    unit: String,
}

/// Summarises the diagnoses.
///
/// # Errors
/// Returns a [`Failure`] if a result cannot be read, and if there are no results.
pub fn run(arguments: &Arguments) -> Result<Answer, Failure> {
    let mut lines = Vec::new();
    for path in &arguments.results {
        collect(path, &mut lines)?;
    }
    // If a recording was diagnosed several times, the last diagnosis counts.
    let mut by_recording: BTreeMap<String, Value> = BTreeMap::new();
    for line in lines {
        let name = line["recording"].as_str().unwrap_or_default().to_owned();
        by_recording.insert(name, line);
    }
    if by_recording.is_empty() {
        return Err(Failure::NoResults(arguments.results[0].clone()));
    }
    let mut devices: BTreeMap<String, Vec<&Value>> = BTreeMap::new();
    let mut sizes: BTreeMap<(String, String), Vec<Size>> = BTreeMap::new();
    for (recording, line) in &by_recording {
        let device = device(recording, arguments.device);
        devices.entry(device.clone()).or_default().push(line);
        for effect in line["effects"].as_array().into_iter().flatten() {
            let name = effect["name"].as_str().unwrap_or_default();
            for (parameter, estimate) in effect["parameters"].as_object().into_iter().flatten() {
                if let Some(value) = estimate["value"].as_f64() {
                    let key = (name.to_owned(), parameter.clone());
                    sizes.entry(key).or_default().push(Size {
                        device: device.clone(),
                        recording: recording.clone(),
                        value,
                        unit: estimate["unit"].as_str().unwrap_or_default().to_owned(),
                    });
                }
            }
        }
    }
    let (mut text, table) = effects_by_device(&devices);
    let drifts = drifts(&sizes);
    let apart = apart(&sizes);
    for drift in &drifts {
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "drift: {} {} on {} goes from {:.3e} to {:.3e} {} over {} recordings",
            drift["effect"].as_str().unwrap_or_default(),
            drift["parameter"].as_str().unwrap_or_default(),
            drift["device"].as_str().unwrap_or_default(),
            drift["first"].as_f64().unwrap_or_default(),
            drift["last"].as_f64().unwrap_or_default(),
            drift["unit"].as_str().unwrap_or_default(),
            drift["recordings"]
        );
    }
    for unit in &apart {
        let _ = writeln!(
            text,
            "apart: {} has {} {} of {:.3e} {}, its siblings {:.3e}",
            unit["device"].as_str().unwrap_or_default(),
            unit["effect"].as_str().unwrap_or_default(),
            unit["parameter"].as_str().unwrap_or_default(),
            unit["value"].as_f64().unwrap_or_default(),
            unit["unit"].as_str().unwrap_or_default(),
            unit["siblings"].as_f64().unwrap_or_default()
        );
    }
    Ok(Answer {
        text,
        json: json!({ "format": 1, "recordings": by_recording.len(), "devices": table, "drifts": drifts, "apart": apart }),
        problems: Vec::new(),
    })
}

/// Adds the diagnoses in a file, or in a folder and its subfolders.
fn collect(path: &Path, lines: &mut Vec<Value>) -> Result<(), Failure> {
    if path.is_dir() {
        let mut inside: Vec<PathBuf> = std::fs::read_dir(path)
            .map_err(Failure::read(path))?
            .filter_map(|entry| Some(entry.ok()?.path()))
            .collect();
        inside.sort();
        for path in inside {
            let is_json = path
                .extension()
                .is_some_and(|ext| ext == "json" || ext == "jsonl");
            if path.is_dir() || is_json {
                collect(&path, lines)?;
            }
        }
        return Ok(());
    }
    let text = recording::read_text(path, "give a file that can be read")?;
    let values = serde_json::Deserializer::from_str(&text).into_iter::<Value>();
    // An incomplete line is skipped; the batch diagnoses that recording again.
    lines.extend(
        values
            .map_while(Result::ok)
            .filter(|line| line.get("recording").is_some()),
    );
    Ok(())
}

/// The folder in a recording's path that names its device.
fn device(recording: &str, from_end: usize) -> String {
    let names: Vec<&str> = recording
        .split('/')
        .filter(|name| !name.is_empty())
        .collect();
    let at = names.len().checked_sub(1 + from_end);
    at.map_or(recording, |at| names[at]).to_owned()
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

/// Table of effects per device, as text and as JSON.
fn effects_by_device(devices: &BTreeMap<String, Vec<&Value>>) -> (String, Value) {
    let mut text = format!(
        "{:<28}{:>10}{:>9}  effects\n",
        "device", "recordings", "shrink"
    );
    let mut table = serde_json::Map::new();
    for (device, lines) in devices {
        let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
        let mut verdicts: BTreeMap<&str, usize> = BTreeMap::new();
        for line in lines {
            let verdict = line["verdict"].as_str().unwrap_or("not used");
            *verdicts.entry(verdict).or_default() += 1;
            for effect in line["effects"].as_array().into_iter().flatten() {
                *counts
                    .entry(effect["name"].as_str().unwrap_or_default())
                    .or_default() += 1;
            }
        }
        let shrinks = lines
            .iter()
            .filter_map(|line| line["gap"]["shrink"].as_f64());
        let shrink = median(shrinks.collect());
        let mut order: Vec<(&&str, &usize)> = counts.iter().collect();
        order.sort_by_key(|(name, count)| (std::cmp::Reverse(**count), **name));
        let named: Vec<String> = order
            .iter()
            .map(|(name, count)| format!("{name} {count}"))
            .collect();
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "{device:<28}{:>10}{shrink:>9.2}  {}",
            lines.len(),
            named.join(", ")
        );
        table.insert(
            device.clone(),
            json!({ "recordings": lines.len(), "shrink": shrink, "effects": counts, "verdicts": verdicts }),
        );
    }
    (text, Value::Object(table))
}

/// Finds parameters that increase or decrease steadily over the recordings of a device, by more than the spread of their
/// steps.
fn drifts(sizes: &BTreeMap<(String, String), Vec<Size>>) -> Vec<Value> {
    let mut drifts = Vec::new();
    for ((effect, parameter), sizes) in sizes {
        let mut of_device: BTreeMap<&str, Vec<&Size>> = BTreeMap::new();
        for size in sizes {
            of_device.entry(&size.device).or_default().push(size);
        }
        for (device, mut own) in of_device {
            own.sort_by(|a, b| a.recording.cmp(&b.recording));
            let values: Vec<f64> = own.iter().map(|size| size.value).collect();
            let [Some(first), Some(last)] = [own.first(), own.last()] else {
                continue;
            };
            if values.len() < LEAST_SIBLINGS {
                continue;
            }
            // In a drift almost all pairs of values have the same order (M. G. Kendall, Biometrika 30, 1938).
            let pairs = (0..values.len()).flat_map(|i| (i + 1..values.len()).map(move |j| (i, j)));
            let signs = pairs.map(|(i, j)| (values[j] - values[i]).signum());
            let (sum, count) =
                signs.fold((0.0, 0.0), |(sum, count), sign| (sum + sign, count + 1.0));
            let n = values.len() as f64;
            let deviation = (n * (n - 1.0) * (2.0 * n + 5.0) / 18.0).sqrt();
            let moved = (last.value - first.value).abs()
                > LEAST_SHARE * median(values.iter().map(|v| v.abs()).collect());
            const CLEAR: f64 = 2.5;
            if moved && (sum.abs() - 1.0) / deviation > CLEAR {
                drifts.push(json!({
                    "effect": effect, "parameter": parameter, "device": device, "first": first.value, "last": last.value,
                    "unit": first.unit, "recordings": values.len(), "tau": sum / count,
                }));
            }
        }
    }
    drifts
}

/// Finds devices whose parameter is far from that of the other devices.
fn apart(sizes: &BTreeMap<(String, String), Vec<Size>>) -> Vec<Value> {
    let mut apart = Vec::new();
    for ((effect, parameter), sizes) in sizes {
        let mut of_device: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
        for size in sizes {
            of_device.entry(&size.device).or_default().push(size.value);
        }
        let medians: Vec<(&str, f64)> = of_device
            .into_iter()
            .map(|(device, own)| (device, median(own)))
            .collect();
        if medians.len() < LEAST_SIBLINGS {
            continue;
        }
        let middle = median(medians.iter().map(|(_, value)| *value).collect());
        let spread = median(
            medians
                .iter()
                .map(|(_, value)| (value - middle).abs())
                .collect(),
        );
        let least = (APART * spread).max(LEAST_SHARE * middle.abs());
        for (device, value) in medians {
            if (value - middle).abs() > least {
                let unit = &sizes[0].unit;
                apart.push(json!({
                    "device": device, "effect": effect, "parameter": parameter, "value": value, "siblings": middle, "unit": unit,
                }));
            }
        }
    }
    apart
}
