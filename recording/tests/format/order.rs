//! The order of the runs and the names of their files do not change what is read.

use std::fmt::Write;

use crate::folder::Folder;
use proptest::prelude::*;

/// Rows of one of three runs with different oddities: a saturating sensor, jitter, and a constant input.
fn csv(which: usize) -> String {
    let mut text = String::from("time,input,position\n");
    for k in 0..800 + 100 * which {
        let steady = k as f64 * 1e-3;
        let time = if which == 1 {
            steady + 4e-4 * (k % 2) as f64
        } else {
            steady
        };
        let input = if which == 2 {
            1e-3
        } else {
            1e-3 * (9.0 * time).sin()
        };
        let swing = 0.4 * (9.0 * time + which as f64).cos();
        let position = if which == 0 { swing.min(0.3) } else { swing };
        writeln!(text, "{time},{input},{position}").unwrap();
    }
    text
}

/// Reads the runs in this order and with these names. Returns each run without its name, and the oddities, with numbers in
/// place of names.
fn read(order: &[usize], names: &[String]) -> (Vec<String>, Vec<String>) {
    let mut manifest =
        String::from("format = 1\nhorizon = 0.1\n[model]\ninertia = 5e-4\nratio = 15.0\n");
    let mut folder = Folder::empty();
    for &which in order {
        let name = &names[which];
        write!(
            manifest,
            "[[runs]]\nfile = \"{name}\"\ndrive = \"open-loop\"\n"
        )
        .unwrap();
        folder = folder.with(name, csv(which));
    }
    let recording = folder.with("recording.toml", manifest).read().unwrap();
    let anonymous = |text: String| {
        let numbered = names.iter().enumerate();
        numbered.fold(text, |text, (which, name)| {
            text.replace(&format!("\"{name}\""), &format!("\"run {which}\""))
        })
    };
    let mut runs: Vec<_> = recording
        .runs
        .iter()
        .map(|run| anonymous(format!("{run:?}")))
        .collect();
    let mut odd: Vec<_> = recording
        .oddities
        .iter()
        .map(|odd| anonymous(format!("{odd:?}")))
        .collect();
    runs.sort();
    odd.sort();
    (runs, odd)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    #[test]
    fn neither_order_nor_names_of_runs_change_what_is_read(
        order in Just(vec![0, 1, 2]).prop_shuffle(),
        stems in proptest::collection::hash_set("[a-zA-Z0-9_. -]{0,6}[a-z]", 3),
    ) {
        let names: Vec<String> = stems.into_iter().map(|stem| format!("{stem}.csv")).collect();
        let plain = ["a.csv", "b.csv", "c.csv"].map(str::to_owned);
        let (runs, odd) = read(&[0, 1, 2], &plain);
        prop_assert!(odd.len() >= 3, "{odd:?}");
        prop_assert_eq!(read(&order, &names), (runs, odd));
    }
}
