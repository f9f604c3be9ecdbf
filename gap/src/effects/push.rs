//! A constant external torque for a limited time.

use super::episode::{Episode, instant_coordinates, last_occurrence, phrase_between};
use super::identification::{Family, Identification};
use super::phrase::{Found, Phrase};
use super::torque_offset::TorqueOffset;
use crate::guess::Evidence;
use crate::guess::contact::worst_intervals;
use crate::guess::regression::{moments, regress_in};
use crate::guess::start::{guessed, term};
use crate::missing_torque::axis::Axis;
use crate::missing_torque::form::{Form, with_defaults};
use crate::missing_torque::path::Path;
use crate::missing_torque::target::Target;
use crate::term::{Coordinate, Term};
use crate::windows::series::Series;
use host_sim::effects::Kind;
use host_sim::effects::push::KIND;
use std::ops::Range;

/// Offsets of the parameters torque, begin and end of an occurrence.
const TORQUE: usize = 0;
const INSTANTS: [usize; 2] = [1, 2];
/// Torque of a start, over the rms drive torque, if the regression gives no torque.
const USUAL: f64 = 0.3;

#[derive(Debug)]
pub(super) struct Push;

impl Identification for Push {
    fn kind(&self) -> &'static Kind {
        &KIND
    }

    fn starts(&self, e: &Evidence<'_>) -> Vec<Term> {
        let usual_nm = USUAL * e.scales.torque;
        let pushes = worst_intervals(e).into_iter().flat_map(|during_s| {
            let [from_s, to_s] = during_s;
            let during = moments(e).filter(|m| m.session_s >= from_s && m.session_s <= to_s);
            let mean_nm = regress_in(during, |_| [1.0]).map(|([mean], _)| mean);
            let torques = match mean_nm.filter(|mean| *mean != 0.0) {
                Some(mean) => vec![mean],
                None => vec![usual_nm, -usual_nm],
            };
            torques.into_iter().map(move |torque_nm| {
                let mut free = vec![guessed(TORQUE, torque_nm, 0.3 * usual_nm)];
                free.extend(instant_coordinates(INSTANTS, during_s, 0));
                term(&KIND, free, &[])
            })
        });
        pushes.collect()
    }

    fn is_local(&self) -> bool {
        true
    }

    fn episode(&self) -> Option<&dyn Episode> {
        Some(self)
    }

    fn special_cases(&self) -> &'static [&'static dyn Identification] {
        &[&TorqueOffset]
    }

    fn family(&self) -> Option<Family> {
        Some(Family::Push)
    }

    fn axis(&self) -> Axis {
        Axis::Time
    }

    fn torque_forms(&self, path: &Path<'_>, target: &Target<'_>) -> Vec<Form> {
        let Some((first, last)) = target.most_missing(path) else {
            return Vec::new();
        };
        let instants_s = [first, last].map(|row| path.samples.session_s[row]);
        let step = path.scale.torque_step();
        let rows = 0..path.position.len();
        let column = rows.map(|i| {
            if (first..=last).contains(&i) {
                step
            } else {
                0.0
            }
        });
        let form = Form::new(vec![column.collect()], move |c| {
            let values = [
                (TORQUE, step * c[0]),
                (INSTANTS[0], instants_s[0]),
                (INSTANTS[1], instants_s[1]),
            ];
            with_defaults(&KIND, &values)
        });
        vec![form.searched(2).seldom()]
    }

    fn noun(&self) -> &'static str {
        "a push from outside"
    }

    fn tell_apart(&self) -> &'static str {
        "The torque is constant between two instants and absent before and after. A contact pushes only beyond a position, and the more the further. A constant torque is there all the time. Repeat the session without touching the device."
    }

    fn template(&self, _found: &Found<'_>) -> &'static str {
        "a push from outside of {torque} from {from} to {to}"
    }

    fn phrase(&self, found: &Found<'_>) -> Phrase {
        if found.estimate("from").is_none() {
            let times = found.count("from");
            return Phrase::of(format!("{times} pushes from outside"));
        }
        phrase_between(found, self.template(found)).unwrap_or_else(|| Phrase::of(self.noun()))
    }
}

impl Episode for Push {
    fn strength(&self) -> usize {
        TORQUE
    }

    fn with_occurrence(&self, push: &Term, series: &Series, windows: Range<usize>) -> Term {
        let [first, last] = [windows.start, windows.end - 1].map(|w| &series.windows[w].samples);
        let during_s = [first.start, last.end - 1].map(|row| series.session(row));
        let place = push.values.len();
        let torque_nm = push.values[last_occurrence(push) + TORQUE];
        let mut push = push.clone();
        let torque: Coordinate = guessed(place + TORQUE, torque_nm, 0.0);
        push.free.push(torque);
        push.free
            .extend(instant_coordinates(INSTANTS, during_s, place));
        push.values.extend([torque_nm, during_s[0], during_s[1]]);
        push
    }

    fn other_forms(&self, push: &Term) -> Vec<Term> {
        let place = last_occurrence(push) + TORQUE;
        vec![push.starting_at(&[(place, -push.values[place])])]
    }
}
