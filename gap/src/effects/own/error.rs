//! Errors in the definition of a user's effect.

use host_sim::effects::own::NameTaken;

/// Why an effect cannot be used: the cause and, after the semicolon, the mend.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum OwnEffectError {
    /// The text is no table of an effect.
    #[error("{0}; see `docs/own-effects.md` for the form")]
    Toml(String),
    /// The expression cannot be read.
    #[error(
        "`torque = \"{text}\"` is no expression: {why}; write one of x, v, u, t and the parameters"
    )]
    Expression {
        /// As written.
        text: String,
        /// What is wrong with it.
        why: String,
    },
    /// A name in the expression is neither a variable nor a parameter.
    #[error("`torque` has the name `{0}`; declare it in [parameters.{0}], or write x, v, u or t")]
    UnknownName(String),
    /// A parameter that the expression does not have.
    #[error("`torque` does not have the parameter `{0}`; use it or leave it out")]
    Unused(String),
    /// A number of parameters that cannot be fitted.
    #[error("it has {0} parameters; declare from 1 to 4")]
    Count(usize),
    /// A parameter called as a variable is.
    #[error("a parameter is called `{0}`, which is a variable; give it another name")]
    IsVariable(String),
    /// A range that is none.
    #[error("`typical` of `{0}` is no range; write two finite numbers, the smaller one first")]
    Typical(String),
    /// An effect of that name is there.
    #[error(transparent)]
    NameTaken(#[from] NameTaken),
}
