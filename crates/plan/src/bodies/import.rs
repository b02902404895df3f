//! Bodies from files.

use granule_scene::ImportBlock;

use super::Draft;
use crate::build::Builder;

/// The bodies of one block.
pub fn bodies(builder: &mut Builder<'_>, block: &ImportBlock, _index: usize) -> Vec<Draft> {
    let file = builder.base.join(&block.file.value);
    builder
        .error(block.file.span.clone(), format!("cannot import {}: no reader is built in", file.display()));
    Vec::new()
}
