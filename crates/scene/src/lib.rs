//! The scene file: RON with spans, and diagnostics
