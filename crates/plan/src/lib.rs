//! Scene and registry to a plan: what will run, and every problem at once
