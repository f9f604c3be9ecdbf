//! Simulates and logs a session of runs on a device.

use recording::{Model, Run, Sensor, low_pass_gain};

use crate::draw::Draw;
use crate::reality::{InputSeries, Reality, State};
use crate::scenario::{Drive, Plan, Scale};

/// One run as it was logged, with its true states.
#[derive(Clone, Debug)]
pub(crate) struct Log {
    /// Start of each row, in the time of the session.
    pub time_s: Vec<f64>,
    /// End of the last row.
    pub end_s: f64,
    pub input: Vec<f64>,
    /// The commanded input at every control tick.
    pub commanded: InputSeries,
    pub position: Vec<f64>,
    pub setpoint: Option<Vec<f64>>,
    /// The column of a second sensor of the same position, which hidden sensor effects do not change.
    pub second: Option<Vec<f64>>,
    /// The true state at the start of every prediction window.
    pub restarts: Vec<State>,
}

/// How a session is simulated and logged.
#[derive(Clone, Debug)]
pub(crate) struct Logging {
    pub sensor: Sensor,
    /// Gain of the low-pass of the logged column.
    pub logged_gain: f64,
    pub filters_noise: bool,
    pub second: Option<Sensor>,
    /// Time between restarts of the prediction, s.
    pub horizon_s: f64,
    /// Largest step of the simulation, s.
    pub step_s: f64,
    /// Initial position, at rest.
    pub start: f64,
    /// Unit to which logged positions are rounded.
    pub grain: f64,
}

/// Name of the column of the second sensor.
pub(crate) const SECOND_COLUMN: &str = "position_hall";

impl Log {
    /// The log as a run of a recording. With `own_clock`, its time starts at zero.
    pub fn run(&self, plan: &Plan, file: &str, own_clock: bool) -> Run {
        let origin = if own_clock { self.time_s[0] } else { 0.0 };
        let time = self
            .time_s
            .iter()
            .map(|t| ((t - origin) * 1e7).round() / 1e7)
            .collect();
        let (drive, controller) = match &plan.drive {
            Drive::Open { .. } => (recording::Drive::OpenLoop, None),
            Drive::Closed { pid, .. } => (recording::Drive::ClosedLoop, Some(*pid)),
        };
        let mut run = Run::new(file, drive, time, self.input.clone(), self.position.clone());
        run.controller = controller;
        run.setpoint.clone_from(&self.setpoint);
        if let Some(second) = &self.second {
            run.positions.insert(SECOND_COLUMN.into(), second.clone());
        }
        run
    }
}

/// Rounds a column of inputs to seven digits of its largest magnitude.
pub(crate) fn round_input(input: &mut [f64]) {
    let largest = input
        .iter()
        .fold(f64::MIN_POSITIVE, |most, u| most.max(u.abs()));
    let grain = decimal(largest * 1e-7);
    for value in input {
        *value = (*value / grain).round() * grain;
    }
}

/// Least and largest value of a column.
pub(crate) fn extremes(column: &[f64]) -> (f64, f64) {
    column
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
            (low.min(*x), high.max(*x))
        })
}

fn logged(clean: f64, sensor: &Sensor, draw: &mut Draw) -> f64 {
    let noisy = clean + sensor.noise * draw.normal();
    if sensor.resolution > 0.0 {
        (noisy / sensor.resolution).round() * sensor.resolution
    } else {
        noisy
    }
}

/// One step of a first-order low-pass per control tick.
fn low_passed(value: f64, gain: f64, passed: &mut Option<f64>) -> f64 {
    let before = *passed.get_or_insert(value);
    let now = before + gain * (value - before);
    *passed = Some(now);
    now
}

/// Simulates all `plans` on `reality`.
pub(crate) fn carry_out(reality: &Reality, plans: &[Plan], logging: &Logging) -> Vec<Log> {
    plans
        .iter()
        .enumerate()
        .map(|(run, plan)| carry_out_run(reality, run, plan, logging))
        .collect()
}

fn carry_out_run(reality: &Reality, run: usize, plan: &Plan, logging: &Logging) -> Log {
    let mut draw = Draw::seeded(plan.noise_seed);
    let start_s = plan.ticks_s[0];
    let mut state = reality.at_rest(logging.start, start_s);
    let mut series = InputSeries::default();
    let mut restarts = Vec::new();
    let mut log = Log {
        time_s: Vec::new(),
        end_s: plan.ticks_s[plan.ticks_s.len() - 1],
        input: Vec::new(),
        commanded: InputSeries::default(),
        position: Vec::new(),
        setpoint: matches!(plan.drive, Drive::Closed { .. }).then(Vec::new),
        second: logging.second.map(|_| Vec::new()),
        restarts: Vec::new(),
    };
    let mut rows = plan.rows.iter().copied().peekable();
    let (mut filtered, mut integral) = (None, 0.0);
    let gain = logging.logged_gain;
    let mut passed = None;
    // Time integral of the input since the last row.
    let mut impulse = 0.0;
    for tick in 0..plan.ticks_s.len() - 1 {
        let now_s = plan.ticks_s[tick];
        let span_s = plan.ticks_s[tick + 1] - now_s;
        let clean = reality.reading(&state, run);
        let measured = logged(clean, &logging.sensor, &mut draw);
        let column = if logging.filters_noise || gain == 1.0 {
            low_passed(measured, gain, &mut passed)
        } else {
            let clean = low_passed(clean, gain, &mut passed);
            logged(clean, &logging.sensor, &mut draw)
        };
        let (input, setpoint) = match &plan.drive {
            Drive::Open { amplitude, course } => (amplitude * course.at(now_s - start_s), None),
            Drive::Closed {
                pid,
                amplitude,
                course,
            } => {
                let setpoint = logging.start + amplitude * course.at(now_s - start_s);
                let before = filtered.unwrap_or(measured);
                let share = low_pass_gain(pid.position_cutoff_hz, pid.period);
                let now = low_passed(measured, share, &mut filtered);
                integral += (setpoint - now) * pid.period;
                let input = pid.kp * (setpoint - now) + pid.ki * integral
                    - pid.kd * (now - before) / pid.period;
                (input, Some(setpoint))
            }
        };
        if rows.peek() == Some(&tick) {
            rows.next();
            if let Some(begun) = log.time_s.last() {
                log.input.push(impulse / (now_s - begun));
            }
            impulse = 0.0;
            log.time_s.push(now_s);
            log.position.push(column);
            if let (Some(column), Some(value)) = (&mut log.setpoint, setpoint) {
                column.push(value);
            }
            if let (Some(column), Some(sensor)) = (&mut log.second, &logging.second) {
                column.push(logged(reality.sensed(&state).x, sensor, &mut draw));
            }
        }
        impulse += input * span_s;
        series.push(now_s, input);
        loop {
            let restart_s = start_s + restarts.len() as f64 * logging.horizon_s;
            if restart_s > plan.ticks_s[tick + 1] {
                break;
            }
            reality.advance(&mut state, &series, run, restart_s, logging.step_s);
            restarts.push(state.clone());
        }
        reality.advance(
            &mut state,
            &series,
            run,
            plan.ticks_s[tick + 1],
            logging.step_s,
        );
    }
    if let Some(begun) = log.time_s.last() {
        log.input.push(impulse / (log.end_s - begun));
    }
    log.restarts = restarts;
    log.commanded = series;
    round_input(&mut log.input);
    if logging.sensor.resolution == 0.0 {
        let grain = decimal(logging.grain);
        for value in &mut log.position {
            *value = (*value / grain).round() * grain;
        }
    }
    log
}

/// The largest power of ten not above `x`.
fn decimal(x: f64) -> f64 {
    10f64.powi(x.log10().floor() as i32)
}

/// The scale of the motion in `logs`. `ratio` is torque per unit of input.
pub(crate) fn scale(logs: &[Log], ratio: f64, hz: f64, sensor: &Sensor) -> Scale {
    let (low, high) = logs
        .iter()
        .map(|log| extremes(&log.position))
        .fold((f64::INFINITY, f64::NEG_INFINITY), |whole, run| {
            (whole.0.min(run.0), whole.1.max(run.1))
        });
    let speeds = logs
        .iter()
        .flat_map(|log| log.restarts.iter())
        .map(|state| state.load.v.abs().max(state.motor.v.abs()))
        .collect();
    let inputs = logs
        .iter()
        .flat_map(|log| log.input.iter().map(|u| u.abs()))
        .collect();
    let input = quantile(inputs, 0.97);
    Scale {
        middle: 0.5 * (low + high),
        half_span: 0.5 * (high - low),
        speed: quantile(speeds, 0.95),
        input,
        torque: input * ratio,
        hz,
        runs_s: logs.iter().map(|log| [log.time_s[0], log.end_s]).collect(),
        quantum: sensor.resolution,
    }
}

fn quantile(mut values: Vec<f64>, part: f64) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let rank = ((values.len() - 1) as f64 * part).round() as usize;
    *values.select_nth_unstable_by(rank, f64::total_cmp).1
}

/// The nominal numbers: the true ones with random errors within the tolerances.
pub(crate) fn nominal(truth: &Model, tolerance: &recording::Tolerance, draw: &mut Draw) -> Model {
    let mut model = *truth;
    for (name, relative) in tolerance.iter() {
        if let Some(value) = truth.get(name) {
            let off = value * (1.0 + relative * draw.normal_within(2.0));
            let _ = model.set(name, off);
        }
    }
    model
}
