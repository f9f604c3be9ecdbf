//! `paddle gap blind --board`: scores `paddle experiment` on virtual boards whose paddles contain hidden effects.

use super::hidden::{HiddenPaddle, written};
use crate::answer::Answer;
use crate::commands::board::firmware;
use crate::commands::experiment::{Found, How, explore, is_unique};
use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::progress;
use crate::rig::Rig;
use blind::score::{Gaps, Goal, Outcome, Row, judge};
use blind::{Diagnosis, Kind, Reference, Truth};
use haptic_paddle::settings::Settings;
use host_sim::closed_loop::LoopSetup;
use host_sim::presets;
use remote::{DeviceError, VirtualWire};
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::Path;
use std::time::Instant;
use virtual_board::board::Board;
use virtual_board::image::Image;
use virtual_board::wiring::Wires;

/// The set of paddles, and the limits of each experiment.
pub struct BoardCheck<'a> {
    /// Number of paddles.
    pub cases: u64,
    /// Seed of the set.
    pub seed: u64,
    /// Name of the only effect, or of the dominant effect, in every paddle.
    pub only: Option<&'a str>,
    /// Whether small effects and errors of the model's numbers are added to the dominant effect.
    pub messy: bool,
    /// Most paddle time per case, s.
    pub seconds: f64,
    /// Folder of the results, with one subfolder per paddle.
    pub folder: &'a Path,
}

/// A property of a result that is counted over the paddles.
struct Finding {
    what: &'static str,
    /// Goal for paddles with one effect, and for paddles with small effects beside the dominant one.
    goal: Goal,
    messy_goal: Goal,
    holds: fn(&Case) -> bool,
}

/// The first name should be right for 18 of 20 paddles with one effect, and for 15 of 20 with small effects beside it. The
/// answer should be the only one for 16 of 20 paddles with one effect.
const FINDINGS: [Finding; 3] = [
    Finding {
        what: "first name is the hidden (dominant) effect",
        goal: Goal::AtLeast(0.9),
        messy_goal: Goal::AtLeast(0.75),
        holds: |case| case.outcome.first,
    },
    Finding {
        what: "it is named, or listed as not separable",
        goal: Goal::None,
        messy_goal: Goal::None,
        holds: |case| case.outcome.in_class,
    },
    Finding {
        what: "it is the only answer",
        goal: Goal::AtLeast(0.8),
        messy_goal: Goal::None,
        holds: Case::is_unique,
    },
];

/// Whether each of the [`FINDINGS`] holds for a paddle. None holds if its experiments failed.
pub type Findings = [bool; FINDINGS.len()];

/// The findings of all paddles as rows of the summary of a blind check.
pub fn rows(findings: &[Findings], messy: bool) -> Vec<Row> {
    let rows = FINDINGS.iter().enumerate().map(|(which, finding)| {
        let goal = if messy {
            finding.messy_goal
        } else {
            finding.goal
        };
        let holds = findings.iter().map(|holds| holds[which]);
        Row::share(finding.what, goal, holds)
    });
    rows.collect()
}

/// Result for one paddle.
struct Case {
    outcome: Outcome,
    hidden: String,
    unique: bool,
    runs: usize,
    /// Time of the paddle and time of the computer, s.
    paddle_s: f64,
    took_s: f64,
}

impl BoardCheck<'_> {
    /// Draws the paddles, runs the experiments and scores them. Each finished case prints a line on standard error. Returns the
    /// findings of each paddle as well.
    ///
    /// # Errors
    /// Returns a [`Failure`] if there is no firmware. A paddle that cannot be drawn is reported and left out. A paddle whose
    /// experiments fail is reported and counts as wrong.
    pub fn run(&self) -> Result<(Answer, Vec<Findings>), Failure> {
        let path = firmware::build()?;
        let unusable = |source| Failure::Image {
            path: path.clone(),
            source,
        };
        let image = Image::read(&path).map_err(unusable)?;
        let interrupt = Interrupt::watched()?;
        let mut cases: Vec<Case> = Vec::new();
        let mut findings: Vec<Findings> = Vec::new();
        let mut problems = Vec::new();
        for number in 1..=self.cases {
            let paddle = match HiddenPaddle::draw(self.seed, number, self.only, self.messy) {
                Ok(paddle) => paddle,
                Err(failure) => {
                    progress::note(&format!("case {number}: {failure}"));
                    problems.push(failure);
                    continue;
                }
            };
            let board = board(&image, &paddle, number).map_err(unusable)?;
            match self.case(number, &paddle, board, &interrupt) {
                Ok((case, lacking)) => {
                    progress::note(&case.line(number));
                    findings.push(FINDINGS.map(|finding| (finding.holds)(&case)));
                    cases.push(case);
                    for failure in lacking {
                        progress::note(&format!("case {number}: {failure}"));
                        problems.push(failure);
                    }
                }
                Err(Failure::Device(DeviceError::Ended)) => {}
                Err(failure) => {
                    let hidden = paddle.written().join(" ");
                    progress::note(&format!(
                        "case {number:<3} FAILED  {failure}; hidden {hidden}"
                    ));
                    findings.push([false; FINDINGS.len()]);
                    // A paddle that cannot be recorded is a result of the check.
                    if !matches!(failure, Failure::Device(_) | Failure::NothingRecorded) {
                        problems.push(failure);
                    }
                }
            }
            if interrupt.is_requested() {
                break;
            }
        }
        let longest_s = cases.iter().map(|case| case.paddle_s).fold(0.0, f64::max);
        let all = findings.len();
        let failed = all - cases.len();
        let count = |which: usize| findings.iter().filter(|holds| holds[which]).count();
        let [right, in_class, unique] = [0, 1, 2].map(count);
        let mut text = String::new();
        for (finding, count) in FINDINGS.iter().zip([right, in_class, unique]) {
            let _ = writeln!(text, "{:<44} {count} of {all}", finding.what);
        }
        if failed > 0 {
            let _ = writeln!(text, "{:<44} {failed} of {all}", "experiments failed");
        }
        let _ = writeln!(
            text,
            "most time of a paddle's                      {longest_s:.0} s\neverything in {}",
            self.folder.display()
        );
        let answer = Answer {
            text,
            json: json!({
                "board": true, "seed": self.seed, "messy": self.messy, "cases": all, "right": right, "in_class": in_class,
                "unique": unique, "failed": failed, "longest_s": longest_s,
                "each": cases.iter().map(Case::json).collect::<Vec<_>>(),
            }),
            problems,
        };
        Ok((answer, findings))
    }

    fn case(
        &self,
        number: u64,
        paddle: &HiddenPaddle,
        board: Board,
        interrupt: &Interrupt,
    ) -> Result<(Case, Vec<Failure>), Failure> {
        let begun = Instant::now();
        progress::within(&format!("case {number}"));
        let how = How::new(self.folder.join(format!("case-{number:04}")), self.seconds);
        let mut rig = Rig::on(VirtualWire::new(board), "the virtual board")?;
        let found = explore(&mut rig, &how, interrupt)?;
        let (paddle_s, runs) = (rig.device.time_s(), found.recording.runs.len());
        let unique = is_unique(&found.outcome.diagnosis);
        let outcome = self.judged(number, paddle, &found)?;
        let answer = how.answer(found)?;
        let hidden = paddle.written();
        let truth = json!({
            "seed": self.seed, "case": number, "effects": hidden,
            "off": paddle.off.iter().map(|(name, factor)| json!({ "number": name, "true_over_stated": factor })).collect::<Vec<_>>(),
        });
        let path = how.out.join("truth.json");
        std::fs::write(&path, format!("{truth:#}\n")).map_err(Failure::write(&path))?;
        let path = how.out.join("told.txt");
        std::fs::write(&path, answer.text).map_err(Failure::write(&path))?;
        let case = Case {
            outcome,
            hidden: hidden.join(" "),
            unique,
            runs,
            paddle_s,
            took_s: begun.elapsed().as_secs_f64(),
        };
        Ok((case, answer.problems))
    }

    /// Compares the diagnosis with the truth by the rules of the blind check.
    fn judged(
        &self,
        number: u64,
        paddle: &HiddenPaddle,
        found: &Found,
    ) -> Result<Outcome, Failure> {
        let told = serde_json::to_value(&found.outcome.diagnosis);
        let told: Option<Diagnosis> = told.ok().and_then(|told| serde_json::from_value(told).ok());
        let effects = paddle.effects.iter().map(|effect| blind::Effect {
            name: effect.kind.name.into(),
            strength: 1.0,
            form: written(effect),
            places: Vec::new(),
            share: None,
        });
        let off = paddle.off.iter().map(|(name, factor)| blind::Effect {
            name: (*name).into(),
            strength: *factor,
            form: String::new(),
            places: Vec::new(),
            share: None,
        });
        let nothing = Reference {
            before: 0.0,
            after: 0.0,
            hidden_alone: 0.0,
            tolerances_alone: 0.0,
        };
        let truth = Truth {
            seed: self.seed,
            case: number,
            // A changed number of the model is a valid finding, because the hidden effect may be only that.
            kind: Kind::Messy,
            device: "the lab's paddle".into(),
            effects: effects.chain(off).collect(),
            reference: nothing,
            fresh_floor: None,
            transfer_floor: None,
            timing: None,
        };
        Ok(judge(&truth, told.as_ref(), Gaps::default(), None))
    }
}

impl Case {
    /// Whether the diagnosis names the hidden effect first and no other effect could explain the gap.
    fn is_unique(&self) -> bool {
        self.outcome.first && self.unique
    }

    fn line(&self, number: u64) -> String {
        let judged = match (self.is_unique(), self.outcome.first, self.outcome.in_class) {
            (true, ..) => "right, unique",
            (false, true, _) => "right",
            (false, false, true) => "listed",
            (false, false, false) => "WRONG",
        };
        format!(
            "case {number:<3} {judged:<14} {:<28} {} runs, {:.0} s of the paddle's, {:.0} s here; hidden {}",
            self.outcome.answer, self.runs, self.paddle_s, self.took_s, self.hidden
        )
    }

    fn json(&self) -> Value {
        json!({
            "outcome": self.outcome, "hidden": self.hidden, "unique": self.is_unique(), "runs": self.runs,
            "paddle_s": self.paddle_s, "took_s": self.took_s,
        })
    }
}

/// Creates a board with the paddle, just after power-on.
fn board(
    image: &Image,
    paddle: &HiddenPaddle,
    noise: u64,
) -> Result<Board, virtual_board::image::ImageError> {
    let settings = Settings::default();
    let mut setup = LoopSetup::firmware(paddle.device.clone(), settings, presets::motor());
    setup.paddle.seed = noise;
    Board::new(image, &setup.paddle, &settings, Wires::default())
}
