//! Time integration of body rows
