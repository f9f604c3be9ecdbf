//! Errors in the definition of a user's effect.

use host_sim::effects::own::NameTaken;

/// The reason why an effect cannot be used. Each message names the cause and, after the semicolon, the remedy.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum OwnEffectError {
    /// The text is not a table of an effect.
    #[error("{0}; see `docs/own-effects.md` for the form")]
    Toml(String),
    /// The expression cannot be read.
    #[error(
        "`torque = \"{text}\"` is not a valid expression: {why}; write one with x, v, u, t and the parameters"
    )]
    Expression {
        /// The expression as written.
        text: String,
        /// The reason why it cannot be read.
        why: String,
    },
    /// A name in the expression is neither a variable nor a parameter.
    #[error(
        "`torque` uses the unknown name `{0}`; declare it in [parameters.{0}], or write x, v, u or t"
    )]
    UnknownName(String),
    /// A parameter that the expression does not contain.
    #[error("`torque` does not use the parameter `{0}`; use it or remove it")]
    Unused(String),
    /// The number of parameters is not allowed.
    #[error("it has {0} parameters; declare from 1 to 4")]
    Count(usize),
    /// A parameter has the name of a variable.
    #[error("a parameter is called `{0}`, which is a variable; give it another name")]
    IsVariable(String),
    /// The typical range of a parameter is not a valid range.
    #[error("`typical` of `{0}` is not a range; write two finite numbers, the smaller one first")]
    Typical(String),
    /// An effect with this name already exists.
    #[error(transparent)]
    NameTaken(#[from] NameTaken),
}
