//! Converts a part of a log to a run.

use crate::controller::{self, Gains};
use crate::error::ImportError;
use crate::log::Column;
use crate::rates::Samples;
use crate::recipe::SwitchOn;
use crate::runs::Span;
use crate::signal::{Choice, held};
use crate::source::{Reading, Source};
use crate::ticks::Ticks;
use crate::unit::{self, Quantity};
use formula::Formula;
use recording::{Drive, InputSampling, Pid, Run, low_pass_gain};

/// Fewest rows of a run.
pub(crate) const LEAST_ROWS: usize = 30;
/// Cells of a whole log in its units. NaN for empty cells.
pub(crate) struct Columns<'a> {
    pub position: &'a [f64],
    pub input: Option<&'a [f64]>,
    pub setpoint: Option<&'a [f64]>,
}

/// Conversion of a part of a log to a run.
pub(crate) struct Stretch<'a> {
    pub source: &'a Source<'a>,
    pub columns: &'a Columns<'a>,
    pub quantity: &'a Reading,
    /// One logged unit of the input in units of the recording.
    pub input_si: f64,
    /// Time of the log's first row, s.
    pub begin_s: f64,
}

impl Stretch<'_> {
    /// One run. `None` if too few rows are left.
    pub fn run(&self, span: &Span, file: String) -> Result<Option<Run>, ImportError> {
        let recipe = self.source.recipe;
        let Self {
            columns,
            quantity,
            input_si,
            ..
        } = *self;
        // Rows of the position with distinct times.
        let mut rows: Vec<usize> = span
            .rows
            .iter()
            .copied()
            .filter(|row| !columns.position[*row].is_nan())
            .collect();
        rows.dedup_by(|b, a| self.source.seconds[*b] <= self.source.seconds[*a]);
        let inputs = columns
            .input
            .map(|input| Samples::of(input, &self.source.seconds, &span.rows));
        if let Some(begin) = inputs.as_ref().and_then(Samples::begin) {
            rows.retain(|row| self.source.seconds[*row] >= begin);
        }
        if rows.len() < LEAST_ROWS {
            return Ok(None);
        }
        let mut time: Vec<f64> = rows.iter().map(|row| self.source.seconds[*row]).collect();
        let mut position: Vec<f64> = rows.iter().map(|row| columns.position[*row]).collect();
        let seen = position.clone();
        let ticks = recipe.tick_s.map(|tick_s| Ticks::of(&time, tick_s));
        let needs_tick = |option: &str| {
            ImportError::Option(format!(
                "{option} needs the period of the device's loop; give --tick in s"
            ))
        };
        if let Some(cutoff_hz) = recipe.undo_low_pass_hz {
            let (ticks, tick_s) = ticks
                .as_ref()
                .zip(recipe.tick_s)
                .ok_or_else(|| needs_tick("--undo-low-pass"))?;
            position = ticks.without_low_pass(&position, low_pass_gain(Some(cutoff_hz), tick_s));
        }
        if self.source.is_velocity {
            position = integral(&time, &position);
        }
        let mut setpoint = columns
            .setpoint
            .map(|column| Samples::of(column, &self.source.seconds, &span.rows).held(&time));
        let mut controller = None;
        let mut on_s = None;
        let mut input = match (inputs, &recipe.pid) {
            (Some(inputs), _) => match (&self.source.input, &ticks) {
                (
                    Some(Choice::Formula {
                        formula, columns, ..
                    }),
                    Some(ticks),
                ) => self.formula_of_ticks(
                    formula,
                    columns,
                    ticks,
                    &rows,
                    recipe.tick_s.unwrap_or(1.0),
                )?,
                _ if recipe.input_is_of_instant => inputs.held(&time),
                _ => inputs.means(&time),
            },
            (None, Some(law)) => {
                let (ticks, tick_s) = ticks
                    .as_ref()
                    .zip(recipe.tick_s)
                    .ok_or_else(|| needs_tick("--pid"))?;
                let asked = setpoint.as_ref().ok_or_else(|| {
                    ImportError::Option(
                        "--pid needs the position that was asked for; give --setpoint".into(),
                    )
                })?;
                let gain = |text: &str| -> Result<f64, ImportError> {
                    let values = Choice::of(text, self.source.log)?.values(self.source.log)?;
                    Ok(rows
                        .iter()
                        .map(|row| values[*row])
                        .find(|value| !value.is_nan())
                        .unwrap_or(0.0))
                };
                let gains = Gains {
                    kp: gain(&law.kp)?,
                    ki: gain(&law.ki)?,
                    kd: gain(&law.kd)?,
                };
                let (seen, asked_ticks) = (ticks.between(&seen), ticks.between(asked));
                let command =
                    |on| controller::command(&seen, &asked_ticks, gains, law.limit, tick_s, on);
                let switched = law.on.get(self.source.place).or(law.on.last()).copied();
                let on = match switched.unwrap_or_default() {
                    SwitchOn::Always => 0,
                    SwitchOn::At(at_s) => {
                        (((at_s - self.source.origin_s - time[0]) / tick_s)
                            .round()
                            .max(0.0)) as usize
                    }
                    SwitchOn::Found => controller::switched_on(ticks, &position, command)
                        .ok_or_else(|| ImportError::NoSwitchOn {
                            log: self.source.log.name.clone(),
                        })?,
                };
                on_s = Some(time[0] + on as f64 * tick_s);
                controller = Some(Pid {
                    kp: gains.kp / quantity.si,
                    ki: gains.ki / quantity.si,
                    kd: gains.kd / quantity.si,
                    period: tick_s,
                    position_cutoff_hz: recipe.undo_low_pass_hz,
                });
                ticks.means(&command(on))
            }
            (None, None) => vec![0.0; time.len()],
        };
        let begins_s = on_s.unwrap_or(time[0]);
        if let Some([from_s, to_s]) = recipe.keep_s {
            let slack_s = 1e-9;
            let kept: Vec<bool> = time
                .iter()
                .map(|t| (from_s - slack_s..=to_s + slack_s).contains(&(t - begins_s)))
                .collect();
            let keep = |column: &mut Vec<f64>| {
                let mut kept = kept.iter();
                column.retain(|_| *kept.next().unwrap_or(&false));
            };
            keep(&mut time);
            keep(&mut position);
            keep(&mut input);
            setpoint.iter_mut().for_each(keep);
            let mut at = kept.iter();
            rows.retain(|_| *at.next().unwrap_or(&false));
            if time.len() < LEAST_ROWS {
                return Ok(None);
            }
        }
        let times = time.clone();
        let begin_s = if self.source.keeps_time {
            0.0
        } else if recipe.keep_s.is_some() {
            time[0]
        } else {
            self.begin_s
        };
        if begin_s != 0.0 {
            time.iter_mut()
                .for_each(|t| *t = ((*t - begin_s) * 1e10).round() / 1e10);
        }
        let scale = |column: &mut Vec<f64>, si: f64| {
            if si != 1.0 {
                column.iter_mut().for_each(|value| *value *= si);
            }
        };
        scale(&mut position, quantity.si);
        scale(&mut input, input_si);
        if let Some(column) = &mut setpoint {
            let si = self
                .source
                .setpoint
                .as_ref()
                .and_then(Choice::unit)
                .and_then(unit::parse);
            let si = match si {
                Some((Quantity::Angle | Quantity::Length, si)) => si,
                _ => quantity.si,
            };
            scale(column, si);
            if let Some(on_s) = on_s {
                // Before the controller is switched on, the setpoint is the rest position.
                let rest = position[0];
                let before = times.iter().zip(column).filter(|(t, _)| **t < on_s - 1e-9);
                before.for_each(|(_, asked)| *asked = rest);
            }
        }
        let is_closed = recipe.is_closed_loop || recipe.pid.is_some() || setpoint.is_some();
        let drive = if is_closed {
            Drive::ClosedLoop
        } else {
            Drive::OpenLoop
        };
        let mut run = Run::new(file, drive, time, input, position);
        run.setpoint = setpoint.filter(|column| column.iter().all(|value| value.is_finite()));
        run.controller = controller;
        if recipe.input_is_of_instant {
            run.input_sampling = InputSampling::Point;
        }
        if let (Some(law), Some(tick_s)) = (&recipe.pid, recipe.tick_s)
            && law.on.contains(&SwitchOn::Found)
        {
            run.input_time_std = tick_s;
        }
        self.add_further(&mut run, &span.rows, &times)?;
        Ok(Some(run))
    }

    /// A formula evaluated at each tick and averaged until the next row. Its columns are interpolated linearly between rows.
    fn formula_of_ticks(
        &self,
        formula: &Formula,
        columns: &[&Column],
        ticks: &Ticks,
        rows: &[usize],
        tick_s: f64,
    ) -> Result<Vec<f64>, ImportError> {
        let mut of_ticks = Vec::with_capacity(columns.len());
        for column in columns {
            let held = held(column, self.source.log)?;
            let is_time = rows.iter().all(|row| {
                (held[*row] - self.source.origin_s - self.source.seconds[*row]).abs() < tick_s / 4.0
            });
            let mut values = Vec::with_capacity(ticks.count());
            for (place, pair) in ticks.of_row.windows(2).enumerate() {
                let (from, to) = (held[rows[place]], held[rows[place + 1]]);
                for tick in 0..pair[1] - pair[0] {
                    let passed = tick as f64;
                    values.push(if is_time {
                        from + passed * tick_s
                    } else {
                        from + (to - from) * passed / (pair[1] - pair[0]) as f64
                    });
                }
            }
            values.extend(rows.last().map(|row| held[*row]));
            of_ticks.push(values);
        }
        let at = |tick: usize| {
            of_ticks
                .iter()
                .map(|column| column[tick])
                .collect::<Vec<_>>()
        };
        let values: Vec<f64> = (0..ticks.count())
            .map(|tick| formula.value(&at(tick)))
            .collect();
        Ok(ticks.means(&values))
    }

    /// The optional columns of the recording.
    fn add_further(&self, run: &mut Run, rows: &[usize], times: &[f64]) -> Result<(), ImportError> {
        for (name, choice) in &self.source.further {
            let values = Samples::of(&choice.values(self.source.log)?, &self.source.seconds, rows)
                .held(times);
            if values.iter().any(|value| !value.is_finite()) {
                continue;
            }
            let parsed = choice.unit().and_then(unit::parse);
            #[expect(
                clippy::cast_possible_truncation,
                reason = "the format's columns are of single precision"
            )]
            let narrow = |values: Vec<f64>| values.into_iter().map(|value| value as f32).collect();
            match name.as_str() {
                "current" => run.current = Some(narrow(values)),
                "supply" => run.supply = Some(narrow(values)),
                "temperature" => run.temperature = Some(narrow(values)),
                _ => {
                    let si = match parsed {
                        Some((Quantity::Angle | Quantity::Length, si)) => si,
                        _ if choice.unit().is_none() && self.source.keeps_time => 1.0,
                        _ => self.quantity.si,
                    };
                    let scaled = values
                        .into_iter()
                        .map(|value| if si == 1.0 { value } else { value * si });
                    run.positions.insert(name.clone(), scaled.collect());
                }
            }
        }
        Ok(())
    }
}

/// Integral of a velocity by the trapezoidal rule, starting at 0.
fn integral(time: &[f64], velocity: &[f64]) -> Vec<f64> {
    let mut way = 0.0;
    let mut ways = Vec::with_capacity(time.len());
    for (row, speed) in velocity.iter().enumerate() {
        if row > 0 {
            way += (time[row] - time[row - 1]) * (speed + velocity[row - 1]) / 2.0;
        }
        ways.push(way);
    }
    ways
}
