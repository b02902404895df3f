//! Run manifest, tables, plots and self-contained HTML
