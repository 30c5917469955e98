//! What can stop IDA, in its words and in ours.

use crate::dae::Fault;
use std::ffi::c_int;

/// What can go wrong in solving a system with IDA.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// An option is out of range.
    #[error("{name} must {must}, is {value:e}")]
    Option {
        /// Name of the option.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What it must be.
        must: &'static str,
    },
    /// The system has no coordinates: there is nothing to integrate.
    #[error("the system has no coordinates, so there is nothing to integrate")]
    NothingToSolve,
    /// The library at run time is not the one that the program was built for.
    #[error("SUNDIALS {found} was loaded, but this program is built for 6.4")]
    Version {
        /// Version that was loaded.
        found: String,
    },
    /// SUNDIALS could not make one of its objects.
    #[error("SUNDIALS could not make {0}; is there memory left?")]
    Memory(&'static str),
    /// A step was asked for before the first restart.
    #[error("the engine was asked to step before it was given a state to begin from")]
    NotStarted,
    /// The end of a step lies before its begin.
    #[error("the engine stands at t = {now:e} s and cannot step back to {end:e} s")]
    Backwards {
        /// Time at which the engine stands (s).
        now: f64,
        /// End that was asked for (s).
        end: f64,
    },
    /// A state was asked for at a time outside the last step.
    #[error(
        "the state at t = {time:e} s was asked for, outside the last step, {began:e} to {now:e} s"
    )]
    Outside {
        /// Time asked for (s).
        time: f64,
        /// Begin of the last step (s).
        began: f64,
        /// End of the last step (s).
        now: f64,
    },
    /// The system could not be evaluated, and no shorter step would help.
    #[error("the system could not be evaluated at t = {time:e} s")]
    System {
        /// Time (s).
        time: f64,
        /// What the system says.
        source: Fault,
    },
    /// Step follows step, but time does not go on.
    #[error(
        "the step size has fallen to nothing: {steps} steps led from t = {since:e} s to {now:e} s only; \
         the solution is not smooth there (chattering, a kink without an event), or the tolerances ask for more \
         than the arithmetic holds: loosen relative_tolerance or absolute_tolerance"
    )]
    NoProgress {
        /// Number of steps.
        steps: u32,
        /// Time at which the first of them began (s).
        since: f64,
        /// Time that was reached (s).
        now: f64,
        /// The last complaint of the system, if it asked for shorter steps.
        source: Option<Fault>,
    },
    /// The steps are so short that the end will not be reached.
    #[error(
        "the run has all but come to a stop at t = {now:e} s: at {step:.1e} s a step, {left:.0e} \
         steps are left until {end:e} s; the tolerances ask for more than this motion holds (a \
         velocity that dies away, a body that comes to rest): set \
         solver.absolute_tolerance = \"scaled\", or loosen solver.relative_tolerance"
    )]
    TooSlow {
        /// Time that was reached (s).
        now: f64,
        /// Mean length of the latest steps (s).
        step: f64,
        /// Time to be reached (s).
        end: f64,
        /// Steps that this would take.
        left: f64,
    },
    /// IDA gave up.
    #[error("IDA stopped at t = {time:e} s: {name} ({code}): {words} {advice}")]
    Stopped {
        /// Time up to which the solution is good (s).
        time: f64,
        /// Name of IDA's return flag.
        name: &'static str,
        /// IDA's return flag.
        code: i32,
        /// IDA's own words.
        words: String,
        /// What can be done about it.
        advice: &'static str,
        /// The last complaint of the system, if it asked for shorter steps.
        source: Option<Fault>,
    },
}

impl Error {
    /// IDA returned the flag `code` at a time (s).
    pub(super) fn stopped(code: c_int, time: f64, words: String, source: Option<Fault>) -> Error {
        let (_, name, advice) = FLAGS.iter().find(|(flag, ..)| *flag == code).copied().unwrap_or((
            code,
            "a flag that IDA 6.4 does not list",
            OUR_BUG,
        ));
        Error::Stopped { time, name, code, words, advice, source }
    }

    /// Whether IDA failed to take a step that another order or length might take.
    pub(super) fn is_rough(&self) -> bool {
        matches!(self, Error::Stopped { code: -4 | -3, .. })
    }
}

const OUR_BUG: &str = "This is a bug of freeplay: please report it with the case file.";
const ROUGH: &str = "The solution is not smooth there (a kink without an event, a contact that \
    begins too softly), or the tolerances are too tight: loosen them, or choose a smaller max_step.";
const RESIDUAL: &str = "The model cannot be evaluated near this state; the cause says why.";

/// IDA's return flags that are failures: number, name, what the user can do.
const FLAGS: [(c_int, &str, &str); 26] = [
    (-1, "IDA_TOO_MUCH_WORK", OUR_BUG),
    (
        -2,
        "IDA_TOO_MUCH_ACC",
        "The tolerances ask for more than double precision holds: loosen relative_tolerance.",
    ),
    (-3, "IDA_ERR_FAIL", ROUGH),
    (-4, "IDA_CONV_FAIL", ROUGH),
    (-5, "IDA_LINIT_FAIL", OUR_BUG),
    (-6, "IDA_LSETUP_FAIL", RESIDUAL),
    (
        -7,
        "IDA_LSOLVE_FAIL",
        "The linear equations are singular: look for redundant joints or a body without mass.",
    ),
    (-8, "IDA_RES_FAIL", RESIDUAL),
    (-9, "IDA_REP_RES_ERR", RESIDUAL),
    (-10, "IDA_RTFUNC_FAIL", RESIDUAL),
    (-11, "IDA_CONSTR_FAIL", OUR_BUG),
    (-12, "IDA_FIRST_RES_FAIL", RESIDUAL),
    (-13, "IDA_LINESEARCH_FAIL", OUR_BUG),
    (-14, "IDA_NO_RECOVERY", OUR_BUG),
    (-15, "IDA_NLS_INIT_FAIL", OUR_BUG),
    (-16, "IDA_NLS_SETUP_FAIL", OUR_BUG),
    (-17, "IDA_NLS_FAIL", ROUGH),
    (-20, "IDA_MEM_NULL", OUR_BUG),
    (-21, "IDA_MEM_FAIL", "The machine has no memory left."),
    (-22, "IDA_ILL_INPUT", OUR_BUG),
    (-23, "IDA_NO_MALLOC", OUR_BUG),
    (-24, "IDA_BAD_EWT", OUR_BUG),
    (-25, "IDA_BAD_K", OUR_BUG),
    (-26, "IDA_BAD_T", OUR_BUG),
    (-27, "IDA_BAD_DKY", OUR_BUG),
    (-28, "IDA_VECTOROP_ERR", OUR_BUG),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failure_names_its_flag_and_time_and_says_what_to_do() {
        let error = Error::stopped(-3, 3.2174e-2, "the error test failed.".into(), None);
        let text = error.to_string();
        for part in ["t = 3.2174e-2 s", "IDA_ERR_FAIL (-3)", "the error test failed.", "loosen"] {
            assert!(text.contains(part), "{part} is missing in: {text}");
        }
    }
}
