//! Why a trade ends without a result.

use granule_scene::Diagnostic;

/// Why a trade ends without a result.
#[derive(Debug)]
pub enum TradeError {
    /// The scene has errors.
    Scene(Vec<Diagnostic>),
    /// There is nothing to trade.
    Nothing(String),
    /// A quantity that was asked for is not known.
    UnknownQuantity {
        /// The name.
        name: String,
        /// The known names.
        known: Vec<String>,
    },
    /// Refining the step does not lead to one answer.
    NotConverged {
        /// The quantity that moves most.
        quantity: String,
        /// Its relative change between the two finest settings.
        change: f64,
        /// The change that would be in order.
        allowed: f64,
        /// What can be done about it.
        advice: String,
    },
    /// A run failed.
    Run {
        /// Label of the setting.
        setting: String,
        /// Why.
        reason: String,
    },
    /// It was asked to stop. What was measured is kept.
    Stopped,
    /// A file cannot be read or written.
    File(String),
}

impl std::fmt::Display for TradeError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Scene(diagnostics) => {
                let messages: Vec<&str> = diagnostics.iter().map(|d| d.message.as_str()).collect();
                write!(f, "the scene has errors: {}", messages.join("; "))
            }
            Self::Nothing(why) => write!(f, "there is nothing to trade: {why}"),
            Self::UnknownQuantity { name, known } => {
                write!(f, "unknown quantity `{name}`; known are {}", known.join(", "))
            }
            Self::NotConverged { quantity, change, allowed, advice } => write!(
                f,
                "no reference: {quantity} still changes by {change:.2e} of its scale between the two finest settings, where \
                 {allowed:.2e} would be in order; {advice}"
            ),
            Self::Run { setting, reason } => write!(f, "{setting}: {reason}"),
            Self::Stopped => f.write_str("stopped; what was measured is kept, the same command goes on"),
            Self::File(reason) => f.write_str(reason),
        }
    }
}

impl std::error::Error for TradeError {}
