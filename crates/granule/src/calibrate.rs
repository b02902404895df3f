//! From a file of measured impacts to parameters.

use std::path::Path;

use granule_calibration::{DataError, Fit, FitError, Impact, Options, fit, read};

/// Why a file of impacts gives no parameters.
#[derive(Debug)]
pub enum CalibrateError {
    /// The file cannot be read, or is no table of impacts.
    Data(DataError),
    /// The impacts cannot be fitted.
    Fit(FitError),
}

impl std::fmt::Display for CalibrateError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Data(error) => error.fmt(f),
            Self::Fit(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for CalibrateError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Data(error) => Some(error),
            Self::Fit(error) => Some(error),
        }
    }
}

/// Reads measured impacts and fits e_n, μ and e_t0 to them (Luding 1998, Sec. 4.2). The columns of the file are told by
/// [`calibration::table`](crate::calibration::table). Returns the impacts, too.
///
/// # Errors
/// The file is no table of impacts, there are too few, or an option is not allowed.
pub fn calibrate(path: impl AsRef<Path>, options: &Options) -> Result<(Vec<Impact>, Fit), CalibrateError> {
    let impacts = read(path).map_err(CalibrateError::Data)?;
    let fit = fit(&impacts, options).map_err(CalibrateError::Fit)?;
    Ok((impacts, fit))
}
