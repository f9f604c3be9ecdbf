//! A dead band: small inputs have no effect.

use super::identification::Identification;
use super::phrase::Found;
use crate::guess::Evidence;
use crate::guess::start::{geometric, linear, log, term, terms};
use crate::missing_torque::axis::Axis;
use crate::missing_torque::form::{Form, with_defaults};
use crate::missing_torque::path::Path;
use crate::missing_torque::target::Target;
use crate::term::{Coordinate, Term};
use host_sim::effects::Kind;
use host_sim::effects::deadband::KIND;

/// Narrowest and widest dead band with a jump at its edge that are tried, over the rms input, and their number.
const JUMP_WIDTHS: [f64; 2] = [0.03, 1.5];
const JUMP_STARTS: usize = 40;
/// Index of the parameter `first`.
const BEFORE_LIMIT: usize = 2;
/// Index of the parameter `skew`, and one unit of its coordinate.
const SKEW: usize = 3;
const SKEWED: f64 = 0.5;
/// Widths that are screened for the missing torque, over the largest input.
const WIDTHS_SCREENED: [f64; 8] = [0.03, 0.06, 0.1, 0.15, 0.21, 0.28, 0.36, 0.46];

#[derive(Debug)]
pub(super) struct Deadband;

impl Identification for Deadband {
    fn kind(&self) -> &'static Kind {
        &KIND
    }

    fn starts(&self, e: &Evidence<'_>) -> Vec<Term> {
        let s = e.scales;
        let missing = [0.05, 0.2, 0.6].map(|f| vec![log(0, f * s.input)]);
        let missing = terms(&KIND, None, missing);
        let before_limit = missing.iter().filter(|_| e.clips_input());
        let before_limit = before_limit.map(|start| start.starting_at(&[(BEFORE_LIMIT, 1.0)]));
        let before_limit: Vec<Term> = before_limit.collect();
        let skewed = [0.2, 0.6].map(|f| vec![log(0, f * s.input), linear(SKEW, 0.0, SKEWED)]);
        let skewed = terms(&KIND, None, skewed);
        [missing, skewed, before_limit, starts_with_jump(e)].concat()
    }

    fn further_shape(&self, fitted: &Term, _half_span: f64) -> Vec<Coordinate> {
        let skew = (!fitted.is_free(SKEW)).then(|| linear(SKEW, 0.0, SKEWED));
        skew.into_iter().collect()
    }

    fn axis(&self) -> Axis {
        Axis::Input
    }

    fn torque_forms(&self, path: &Path<'_>, target: &Target<'_>) -> Vec<Form> {
        let widths = WIDTHS_SCREENED.iter().map(|part| part * path.scale.input);
        let forms = widths.flat_map(|width| {
            // Beyond the dead band the torque begins at zero, or it jumps to that of the whole input.
            [(0.0, Some(0)), (1.0, None)].map(|(jump, size)| {
                let values = with_defaults(&KIND, &[(0, width), (1, jump)]);
                Form::whole(path, &KIND, values, size).positive()
            })
        });
        target.screened(forms.collect(), 2)
    }

    fn noun(&self) -> &'static str {
        "a dead band"
    }

    fn tell_apart(&self) -> &'static str {
        "The torque lacks by the same amount for every input beyond the band; a torque gain lacks more for more input. Friction has that shape over velocity, a dead band over input. Record inputs of several sizes at the same speed."
    }

    fn template(&self, _found: &Found<'_>) -> &'static str {
        "a dead band of {width} in the input"
    }
}

/// Starts of dead bands with a jump at the edge. The cost is not smooth over the width, because each sample passes up to a width of its
/// own.
fn starts_with_jump(e: &Evidence<'_>) -> Vec<Term> {
    let widths = geometric(JUMP_WIDTHS, JUMP_STARTS).map(|f| f * e.scales.input);
    widths
        .map(|width| term(&KIND, vec![log(0, width)], &[(1, 1.0)]))
        .collect()
}
