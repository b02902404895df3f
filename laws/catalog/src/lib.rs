//! The laws that granule ships: one line a law crate.
//!
//! A law crate registers itself, but only if something refers to it: the linker drops what nobody names.

use granule_law_api::{Registry, RegistryError};

use granule_law_normal_linear as _;
use granule_law_normal_power as _;
use granule_law_tangential_coulomb as _;
use granule_law_tangential_spring as _;
use granule_law_tangential_viscous as _;

/// The folders of the law crates that this catalog links, in alphabetical order.
pub const CRATES: &[&str] =
    &["normal-linear", "normal-power", "tangential-coulomb", "tangential-spring", "tangential-viscous"];

/// Names of all registered laws, in alphabetical order.
///
/// # Errors
/// As for [`Registry::collect`]: two laws of one name, or a law built against another interface version.
pub fn names() -> Result<Vec<&'static str>, RegistryError> {
    Ok(Registry::collect()?.entries().iter().map(|entry| entry.info.name).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;
    use std::path::Path;

    #[test]
    fn every_law_folder_is_linked_and_registers() {
        let laws = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
        let folders: BTreeSet<String> = std::fs::read_dir(laws)
            .unwrap()
            .map(|entry| entry.unwrap())
            .filter(|entry| entry.path().join("Cargo.toml").exists())
            .map(|entry| entry.file_name().into_string().unwrap())
            .filter(|name| name != "catalog")
            .collect();
        let listed: BTreeSet<String> = CRATES.iter().map(ToString::to_string).collect();
        assert_eq!(folders, listed, "folders in laws/ and laws/catalog/src/lib.rs differ");
        let registered: BTreeSet<String> = Registry::collect()
            .unwrap()
            .entries()
            .iter()
            .map(|entry| entry.crate_name.trim_start_matches("granule-law-").to_string())
            .collect();
        assert_eq!(
            registered, listed,
            "a linked law crate registers nothing, or a registered one is not listed"
        );
    }

    #[test]
    fn names_are_the_shipped_laws() {
        assert_eq!(
            names().unwrap(),
            ["Coulomb", "Hertz", "LinearSpringDashpot", "PowerLaw", "TangentialSpring", "ViscousTangential"]
        );
    }
}
