//! Facade: read a scene, plan it, run it
