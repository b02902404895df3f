//! Observers: energy ledger, trajectories, time series; never change the state
