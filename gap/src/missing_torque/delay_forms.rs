//! Forms of delayed torques. Their torque is not proportional to the delay.

use super::form::{Form, with_defaults};
use super::path::Path;
use super::target::Target;
use host_sim::effects::Kind;

/// Delays that are tried, over the time of one radian of the motion.
pub(crate) const DELAYS: [f64; 4] = [0.03, 0.1, 0.25, 0.6];

/// The form of an effect whose first parameter is a delay. The delay may be longer or shorter than the stated one, but not negative. The
/// form is the one of the delay that explains most.
pub(crate) fn delay_form(
    path: &Path<'_>,
    target: &Target<'_>,
    kind: &'static Kind,
    stated_s: f64,
) -> Option<Form> {
    let column =
        |added_s: f64| path.torque_of(kind, &with_defaults(kind, &[(0, stated_s + added_s)]));
    let times = DELAYS.iter().map(|part| part / path.scale.rate());
    let times = times.flat_map(|added_s| [added_s, -added_s.min(stated_s)]);
    let tried = times.filter(|added_s| *added_s != 0.0).map(|added_s| {
        let torque = column(added_s);
        (
            target.explained(core::slice::from_ref(&torque)),
            added_s,
            torque,
        )
    });
    let (_, mut added_s, mut torque) = tried.max_by(|a, b| a.0.total_cmp(&b.0))?;
    // Two iterations towards the delay whose coefficient is 1, because the torque is not proportional to the delay.
    for _ in 0..2 {
        added_s *= target.coefficient(&torque).clamp(0.3, 3.0);
        added_s = added_s.max(-stated_s);
        torque = column(added_s);
    }
    let form = Form::new(vec![torque], move |c| {
        with_defaults(kind, &[(0, (stated_s + c[0] * added_s).max(0.0))])
    });
    Some(form.searched(1).positive())
}
