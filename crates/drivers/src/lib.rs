//! Drivers: advance a world in time
