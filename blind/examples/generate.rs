//! Writes recordings with something hidden in them, each with its truth beside it.
//!
//! `cargo run --release -p blind --example generate -- DIR CASES SEED [EFFECT]`

use blind::{Case, Mixture};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [folder, cases, seed, only @ ..] = words.as_slice() else {
        return Err("usage: generate DIR CASES SEED [EFFECT]".into());
    };
    let mixture = Mixture {
        only: only.first().cloned(),
    };
    for number in 1..=cases.parse()? {
        let case = Case::make(seed.parse()?, number, &mixture)?;
        let folder = std::path::Path::new(folder).join(format!("case-{number:04}"));
        case.recording.write(folder.join("recording"))?;
        case.fresh.write(folder.join("fresh"))?;
        std::fs::write(
            folder.join("truth.json"),
            serde_json::to_string_pretty(&case.truth)?,
        )?;
        let names: Vec<_> = case
            .truth
            .effects
            .iter()
            .map(|effect| effect.name.as_str())
            .collect();
        let reference = &case.truth.reference;
        println!(
            "{number:4} {:8} {:40} before {:9.2e} floor {:9.2e} ratio {:6.1}",
            format!("{:?}", case.truth.kind),
            names.join(" + "),
            reference.before,
            reference.after,
            reference.before / reference.after,
        );
    }
    Ok(())
}
