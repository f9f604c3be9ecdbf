//! Runs experiments on the flashed image in a virtual board.

use std::path::{Path, PathBuf};

use haptic_paddle::settings::Settings;
use host_sim::closed_loop::LoopSetup;
use host_sim::presets;
use link::Channel;
use recording::{Drive, Tolerance};
use remote::{Device, DeviceError, Plan, Progress, Recorder, Session, VirtualWire, take};
use virtual_board::board::Board;
use virtual_board::image::Image;
use virtual_board::wiring::Wires;

/// A user who does not watch. The experiment is stopped if the value is true.
struct Quiet(bool);

impl Progress for Quiet {
    fn done(&mut self, _: f64) {}

    fn ends(&self) -> bool {
        self.0
    }
}

fn image(test: &str) -> Option<Image> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let target =
        std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), PathBuf::from);
    let path = root
        .join(target)
        .join("thumbv7em-none-eabihf/firmware/firmware");
    if !path.exists() {
        println!("skipped: {test}: no image; `cargo fw` builds it");
        return None;
    }
    Some(Image::read(&path).unwrap())
}

fn wire(image: &Image) -> VirtualWire {
    let setup = LoopSetup::firmware(presets::refit(), Settings::default(), presets::motor());
    let mut board = Board::new(image, &setup.paddle, &setup.settings, Wires::default()).unwrap();
    board.set_brown_out();
    VirtualWire::new(board)
}

fn ready(image: &Image) -> Device<VirtualWire> {
    let mut device = Device::find(wire(image)).unwrap();
    device.speed_up().unwrap();
    device.expect("zero hall", "zeroed").unwrap();
    device.steer(true).unwrap();
    device
}

fn plan(text: &str) -> Plan {
    text.parse().unwrap()
}

#[test]
fn a_step_and_a_multisine_become_a_recording_that_reads_back() {
    let Some(image) = image("a_step_and_a_multisine_become_a_recording") else {
        return;
    };
    let mut device = ready(&image);
    let settings = device.settings().unwrap();
    assert_eq!(settings.pid.kp_nm_per_deg, 0.05);
    let mut recorder = Recorder::new(Session {
        title: "Two runs".into(),
        horizon_s: 0.3,
        model: presets::nominal(),
        tolerance: Tolerance::default(),
        settings,
    });
    for text in ["step:10,0.5", "multisine:0.0036,2,3"] {
        let taken = take(&mut device, &plan(text), 1000.0, &mut Quiet(false)).unwrap();
        assert_eq!((taken.lost, &taken.fault), (0, &None), "{text}");
        recorder.add(&taken);
    }
    let recording = recorder.recording();
    let folder = std::env::temp_dir().join(format!("remote-two-runs-{}", std::process::id()));
    recording.write(&folder).unwrap();
    let read = recording::Recording::read(&folder).unwrap();
    std::fs::remove_dir_all(&folder).unwrap();
    assert_eq!(read.runs, recording.runs);
    assert_eq!(read.oddities, []);

    let [step, multisine] = &read.runs[..] else {
        panic!("{} runs", read.runs.len());
    };
    assert_eq!(
        (step.drive, multisine.drive),
        (Drive::ClosedLoop, Drive::OpenLoop)
    );
    assert!(step.controller.is_some());
    let highest = step.position.iter().fold(0.0f64, |most, at| most.max(*at));
    assert!((9.5..12.0).contains(&highest.to_degrees()), "{highest}");
    let last = step.position.last().unwrap().to_degrees();
    assert!(last.abs() < 0.5, "back at {last}");
    let largest = multisine
        .input
        .iter()
        .fold(0.0f64, |most, at| most.max(at.abs()));
    assert!((0.003..0.0037).contains(&largest), "{largest}");
    // The run begins at rest, without torque.
    assert!(multisine.input[..200].iter().all(|torque| *torque == 0.0));
    assert!(read.sensors["position_hall"].noise > 0.0);
}

#[test]
fn a_lost_link_disarms_the_board() {
    let Some(image) = image("a_lost_link_disarms_the_board") else {
        return;
    };
    let mut wire = wire(&image);
    // The line is cut in the middle of the run.
    wire.cut_at(4.0);
    let mut device = Device::find(wire).unwrap();
    device.speed_up().unwrap();
    device.expect("zero hall", "zeroed").unwrap();
    device.steer(true).unwrap();
    let failed = take(
        &mut device,
        &plan("position:sine:10,1,20"),
        1000.0,
        &mut Quiet(false),
    );
    assert!(failed.is_err(), "{failed:?}");
    let rows = device.take_rows();
    let last = rows.last().unwrap();
    assert_eq!(last.value(Channel::Mode), 0.0, "disarmed");
    assert!(last.value(Channel::Fault) > 0.0);
}

#[test]
fn a_user_who_ends_leaves_a_disarmed_board() {
    let Some(image) = image("a_user_who_ends") else {
        return;
    };
    let mut device = ready(&image);
    let ended = take(&mut device, &plan("step:10"), 1000.0, &mut Quiet(true));
    assert!(matches!(ended, Err(DeviceError::Ended)), "{ended:?}");
    assert!(device.command("status").unwrap().contains("mode off"));
}

#[test]
fn what_the_board_refuses_is_told_in_its_words() {
    let Some(image) = image("what_the_board_refuses") else {
        return;
    };
    let mut device = ready(&image);
    let refused = take(&mut device, &plan("step:80"), 1000.0, &mut Quiet(false));
    let Err(DeviceError::Refused { line, answer }) = refused else {
        panic!("{refused:?}");
    };
    assert!(line.starts_with("start step 80"), "{line}");
    assert!(answer.contains("limit.travel"), "{answer}");
}

#[test]
fn a_board_that_was_left_at_a_fast_rate_is_found() {
    let Some(image) = image("a_board_that_was_left") else {
        return;
    };
    let mut device = Device::find(wire(&image)).unwrap();
    device.speed_up().unwrap();
    let wire = device.into_wire();
    let mut device = Device::find(wire).unwrap();
    assert!(device.command("status").unwrap().contains("mode off"));
}

#[test]
fn a_capture_is_fetched() {
    let Some(image) = image("a_capture_is_fetched") else {
        return;
    };
    let mut device = ready(&image);
    device.command("capture now 0").unwrap();
    device.wait_s(0.3).unwrap();
    let captured = device.fetch_capture().unwrap();
    assert_eq!(captured.samples.len(), 3072);
}

/// Drives the paddle beyond its travel by a sine of this torque, N m. Returns the reported fault.
fn driven_too_far(device: &mut Device<VirtualWire>, amplitude_nm: &str) -> String {
    device.settings().unwrap();
    let plan = plan(&format!("torque:sine:{amplitude_nm},0.5,4"));
    match take(device, &plan, 1000.0, &mut Quiet(false)) {
        Ok(taken) => taken.fault.unwrap(),
        Err(DeviceError::Fault(fault)) => fault,
        Err(other) => panic!("{amplitude_nm} N m: {other:?}"),
    }
}

#[test]
fn a_paddle_that_is_driven_too_far_is_let_go_and_can_be_armed_again() {
    let Some(image) = image("a_paddle_that_is_driven_too_far") else {
        return;
    };
    let mut device = ready(&image);
    let told = driven_too_far(&mut device, "0.006");
    assert!(told.contains("end of its travel"), "{told}");
    device.expect("arm position", "mode position").unwrap();
}

#[test]
fn a_paddle_that_is_driven_too_far_and_fast_is_braked_within_its_travel() {
    let Some(image) = image("a_paddle_that_is_driven_too_far_and_fast") else {
        return;
    };
    let mut device = ready(&image);
    for amplitude_nm in ["0.01", "0.02", "0.03"] {
        let told = driven_too_far(&mut device, amplitude_nm);
        assert!(told.contains("end of its travel"), "{amplitude_nm}: {told}");
        let next = take(
            &mut device,
            &plan("torque:sine:0.001,1,1"),
            1000.0,
            &mut Quiet(false),
        );
        let next = next.map(|taken| (taken.fault, taken.lost));
        assert!(
            matches!(next, Ok((None, 0))),
            "after {amplitude_nm} N m: {next:?}"
        );
    }
}

#[test]
fn what_a_stopped_board_says_by_itself_tears_no_command() {
    let Some(image) = image("what_a_stopped_board_says") else {
        return;
    };
    for amplitude_nm in ["0.0057", "0.0053", "0.0049", "0.0045"] {
        let told = driven_too_far(&mut ready(&image), amplitude_nm);
        assert!(told.contains("end of its travel"), "{amplitude_nm}: {told}");
    }
}
