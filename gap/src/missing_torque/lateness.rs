//! Forms of what comes late, which is not proportional to the time by which it does.

use super::form::{Form, with_defaults};
use super::path::Path;
use super::target::Target;
use host_sim::effects::Kind;

/// Times by which a torque is late, over the time of a radian of the motion.
pub(crate) const LATE: [f64; 4] = [0.03, 0.1, 0.25, 0.6];

/// The form of an effect whose first number is a time by which something is later than stated, or sooner, down to not at all.
pub(crate) fn late(
    path: &Path<'_>,
    target: &Target<'_>,
    kind: &'static Kind,
    stated_s: f64,
) -> Option<Form> {
    let column =
        |late_s: f64| path.torque_of(kind, &with_defaults(kind, &[(0, stated_s + late_s)]));
    let times = LATE.iter().map(|part| part / path.scale.rate());
    let times = times.flat_map(|late_s| [late_s, -late_s.min(stated_s)]);
    let tried = times.filter(|late_s| *late_s != 0.0).map(|late_s| {
        let torque = column(late_s);
        (
            target.explained(core::slice::from_ref(&torque)),
            late_s,
            torque,
        )
    });
    let (_, mut late_s, mut torque) = tried.max_by(|a, b| a.0.total_cmp(&b.0))?;
    // Twice to where the coefficient is 1: being late is not proportional to the time.
    for _ in 0..2 {
        late_s *= target.coefficient(&torque).clamp(0.3, 3.0);
        late_s = late_s.max(-stated_s);
        torque = column(late_s);
    }
    let form = Form::new(vec![torque], move |c| {
        with_defaults(kind, &[(0, (stated_s + c[0] * late_s).max(0.0))])
    });
    Some(form.searched(1).positive())
}
