//! The step: candidates, contacts, laws, forces
