//! Body rows, contact tables and history columns
