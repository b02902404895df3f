//! The laws that granule ships: one line a law crate.
//!
//! A law crate registers itself, but only if something refers to it: the linker drops what nobody names.

use granule_law_collision_rules as _;
use granule_law_kondic_collision as _;
use granule_law_normal_hysteretic as _;
use granule_law_normal_linear as _;
use granule_law_normal_power as _;
use granule_law_substrate as _;
use granule_law_tangential_coulomb as _;
use granule_law_tangential_spring as _;
use granule_law_tangential_viscous as _;
use granule_law_viscoelastic as _;
