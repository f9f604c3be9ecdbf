//! Tests of telemetry over the serial port of the firmware image.

use crate::bench::{Bench, CONTROL, image};
use link::{
    Body, Channel, Channels, Frame, Heard, Sample, Sequence, ShortSample, Splitter, Trigger,
};

/// Baud rate of the board after boot.
const BOOT_BAUD: f64 = 460_800.0;
const PERIOD_S: f64 = 50e-6;

/// A program at the other end of the serial line.
#[derive(Default)]
struct Host {
    splitter: Splitter,
    sequence: Sequence,
    text: String,
    corrupt: usize,
    rows: Vec<(u32, u32, Vec<f32>)>,
    head: Option<(Trigger, u16, u16, u32)>,
    samples: Vec<Sample>,
}

impl Host {
    fn hear(&mut self, bytes: &[u8]) {
        for byte in bytes {
            match self.splitter.push(*byte) {
                Heard::Nothing => {}
                Heard::Text(byte) => self.text.push(char::from(byte)),
                Heard::Frame(Frame { sequence, body, .. }) => {
                    self.sequence.follow(sequence);
                    match body {
                        Body::Row {
                            period,
                            dropped,
                            channels,
                            values,
                        } => {
                            let values = link::values(channels, values).map(|(_, value)| value);
                            self.rows.push((period, dropped, values.collect()));
                        }
                        Body::Capture {
                            trigger,
                            samples,
                            triggered_at,
                            period,
                        } => self.head = Some((trigger, samples, triggered_at, period)),
                        Body::Samples { first, samples } => {
                            assert_eq!(usize::from(first), self.samples.len());
                            let (samples, _) = samples.as_chunks();
                            let samples = samples.iter().copied().map(ShortSample::from_bytes);
                            self.samples.extend(samples.map(Sample::from));
                        }
                    }
                }
                Heard::Corrupt | Heard::OtherVersion(_) => self.corrupt += 1,
            }
        }
    }

    /// Runs the board and receives its output.
    fn listen(&mut self, bench: &mut Bench, seconds: f64) {
        let end_s = bench.board.time_s() + seconds;
        while bench.board.time_s() < end_s {
            bench.run(1e-3);
            self.hear(&bench.board.terminal.take_answer());
        }
    }

    /// Types a line and returns the time until the prompt after its answer, s.
    fn command(&mut self, bench: &mut Bench, line: &str) -> f64 {
        self.text.clear();
        let from_s = bench.board.time_s();
        bench.board.type_in(&format!("{line}\r"));
        while !self.text.ends_with("\n> ") {
            bench.run(1e-3);
            self.hear(&bench.board.terminal.take_answer());
            assert!(bench.board.time_s() < from_s + 2.0, "{line}: {}", self.text);
        }
        bench.board.time_s() - from_s
    }
}

#[test]
fn six_channels_at_2_khz_lose_no_row_while_the_console_answers() {
    const SECONDS: usize = 60;
    const LONGEST_ANSWER_S: f64 = 0.020;
    let Some(image) = image("six_channels_at_2_khz") else {
        return;
    };
    let mut bench = Bench::armed(image);
    bench.speed_up();
    bench.command("start multisine 5 0.5");
    let mut host = Host::default();
    host.command(
        &mut bench,
        "stream setpoint,encoder,hall,velocity,torque,current 2000",
    );
    assert!(host.text.contains("2000 Hz"), "{}", host.text);
    bench.board.cpu.record_activations(true);
    let mut longest_s: f64 = 0.0;
    let mut worst = (0, 0);
    for _ in 0..SECONDS {
        longest_s = longest_s.max(host.command(&mut bench, "status"));
        host.listen(&mut bench, 1.0);
        let control = bench.board.cpu.take_activations();
        for run in control.iter().filter(|run| run.exception == CONTROL) {
            worst = (worst.0.max(run.instructions), worst.1.max(run.cycles));
        }
    }
    println!(
        "{} rows, answers within {:.1} ms, control interrupt {} instructions, {} cycles worst",
        host.rows.len(),
        1e3 * longest_s,
        worst.0,
        worst.1
    );
    assert!(host.rows.len() >= 2000 * SECONDS - 1, "{}", host.rows.len());
    assert_eq!((host.sequence.lost(), host.corrupt), (0, 0));
    for pair in host.rows.windows(2) {
        assert_eq!(pair[1].0 - pair[0].0, 10, "at {}", pair[0].0);
        assert_eq!(pair[1].1, 0, "rows dropped");
    }
    assert!(longest_s <= LONGEST_ANSWER_S, "{longest_s}");
    host.command(&mut bench, "stream off");
    host.command(&mut bench, "faults");
    assert!(host.text.contains("no fault"), "{}", host.text);
}

#[test]
fn rows_agree_with_the_true_motion() {
    const PERIODS: usize = 20;
    let Some(image) = image("rows_are_what_the_paddle_did") else {
        return;
    };
    let mut bench = Bench::armed(image);
    let mut host = Host::default();
    host.command(&mut bench, "stream encoder,torque,mode 1000");
    host.command(&mut bench, "start sine 10 2");
    bench.board.record_steps(true);
    let begun = host.rows.len() + 2;
    host.listen(&mut bench, 0.5);
    let steps = bench.board.take_steps();
    let rows = &host.rows[begun..host.rows.len() - 10];
    assert!(rows.len() > 400, "{}", rows.len());
    assert!(rows.iter().all(|(_, _, values)| values[2] == 3.0));
    // The firmware numbers its control periods. The test finds the offset to the simulated steps at which the angles agree
    // best. The zero comes from the Hall sensor, so a constant difference may remain.
    let deviations = |shift: usize| -> Vec<f64> {
        let indices = (0..rows.len()).map(|row| shift + row * PERIODS);
        indices
            .zip(rows)
            .map(|(step, (_, _, values))| steps[step].position_rad - f64::from(values[0]))
            .collect()
    };
    let spread = |values: &[f64]| {
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        (values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / values.len() as f64).sqrt()
    };
    let (angle_rad, shift) = (0..4 * PERIODS)
        .map(|shift| (spread(&deviations(shift)), shift))
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .unwrap();
    // A torque command acts one period later.
    let torques: Vec<_> = (0..rows.len())
        .map(|row| {
            let acting = &steps[shift + row * PERIODS + 1..][..PERIODS];
            let mean = acting.iter().map(|step| step.torque_nm).sum::<f64>() / PERIODS as f64;
            mean - f64::from(rows[row].2[1])
        })
        .collect();
    let torque_nm = spread(&torques);
    println!("angles agree within {angle_rad:.1e} rad rms, torques within {torque_nm:.1e} N m rms");
    // One encoder count is 2.1e-4 rad.
    assert!(angle_rad < 1e-4, "{angle_rad}");
    assert!(torque_nm < 2e-4, "{torque_nm}");
}

#[test]
fn binary_bytes_are_sent_only_on_request_and_the_terminal_stays_readable_after() {
    let Some(image) = image("no_binary_byte_is_sent") else {
        return;
    };
    let mut bench = Bench::armed(image);
    bench.board.type_in("get\rstatus\rcapture\rstream\r");
    bench.run(0.3);
    let said = bench.board.terminal.take_answer();
    assert!(said.iter().all(|byte| byte.is_ascii() && *byte != 0));
    let mut host = Host::default();
    host.command(&mut bench, "stream all 1000");
    host.listen(&mut bench, 0.1);
    host.command(&mut bench, "stream off");
    bench.run(0.01);
    bench.board.terminal.take_answer();
    let status = bench.command("status");
    assert!(status.starts_with("status\r\nmode position"), "{status:?}");
    assert!(status.bytes().all(|byte| byte.is_ascii() && byte != 0));
}

#[test]
fn a_stream_beyond_the_capacity_of_the_line_is_refused() {
    let Some(image) = image("more_than_the_line_carries") else {
        return;
    };
    let mut bench = Bench::armed(image);
    let refusal = bench.command("stream all 2000");
    assert!(refusal.contains("the serial line carries"), "{refusal}");
    assert!(
        bench
            .command("stream fish 1000")
            .contains("no such channel")
    );
    assert!(bench.command("stream encoder 3000").contains("must divide"));
    assert!(bench.command("baud 3000000").contains("write baud"));
}

#[test]
fn a_changed_baud_rate_returns_to_the_rate_after_boot() {
    let Some(image) = image("a_line_of_another_rate") else {
        return;
    };
    let mut bench = Bench::armed(image);
    bench.speed_up();
    bench.board.terminal.baud = BOOT_BAUD;
    bench.board.type_in(&"\r".repeat(16));
    bench.run(0.1);
    bench.board.terminal.take_answer();
    assert!((bench.board.baud() / BOOT_BAUD - 1.0).abs() < 0.01);
    let status = bench.command("status");
    assert!(status.contains("mode position"), "{status}");
}

#[test]
fn a_step_is_captured_every_control_period() {
    const SHORTEST_S: f64 = 0.150;
    let Some(image) = image("a_step_is_captured") else {
        return;
    };
    let mut bench = Bench::armed(image);
    bench.command("ref 0");
    bench.run(0.5);
    bench.command("capture step 20");
    bench.command("step 10");
    bench.run(0.3);
    let mut host = Host::default();
    host.command(&mut bench, "capture send");
    host.listen(&mut bench, 1.5);
    let (trigger, samples, triggered_at, _) = host.head.unwrap();
    assert_eq!((trigger, triggered_at), (Trigger::Step, 400));
    assert_eq!(host.samples.len(), usize::from(samples));
    assert!(f64::from(samples) * PERIOD_S >= SHORTEST_S, "{samples}");
    assert_eq!((host.sequence.lost(), host.corrupt), (0, 0));
    let at = usize::from(triggered_at);
    let setpoint_deg = |index: usize| host.samples[index].setpoint.to_degrees();
    assert!(
        setpoint_deg(at - 1).abs() < 0.01,
        "{}",
        setpoint_deg(at - 1)
    );
    assert!(
        (setpoint_deg(at) - 10.0).abs() < 0.01,
        "{}",
        setpoint_deg(at)
    );
    let last = host.samples.last().unwrap();
    assert!(
        (last.encoder_rad.to_degrees() - 10.0).abs() < 1.0,
        "{last:?}"
    );
    // The current follows within a few periods.
    let current_a = host.samples[at + 40].value(Channel::Current);
    assert!(current_a > 0.1, "{current_a}");
}

#[test]
fn a_fault_captures_the_samples_before_it() {
    let Some(image) = image("a_fault_keeps_what_led_to_it") else {
        return;
    };
    let mut bench = Bench::armed(image);
    bench.command("start sine 10 2");
    bench.run(0.5);
    bench.board.wires_mut().encoder_cut = true;
    bench.run(0.5);
    bench.board.terminal.take_answer();
    let mut host = Host::default();
    host.command(&mut bench, "capture");
    assert!(host.text.contains("triggered by a fault"), "{}", host.text);
    host.command(&mut bench, "capture send");
    host.listen(&mut bench, 1.5);
    let at = usize::from(host.head.unwrap().2);
    assert!(host.samples[at].fault != 0 && host.samples[at - 1].fault == 0);
    assert_eq!(host.samples[at - 1].mode, 3);
    assert!(at as f64 * PERIOD_S > 0.14, "{at}");
    let still = |sample: &Sample| sample.encoder_rad == host.samples[at - 1].encoder_rad;
    assert!(
        host.samples[at - 20..at].iter().all(still),
        "the cut encoder stands still"
    );
    assert_eq!(Channels::ALL.len(), 9);
}
