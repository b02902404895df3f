mod energy;
mod peers;
mod restitution;

use granule_law_api::testing::conformance;

use crate::TangentialSpring;

#[test]
fn conforms() {
    conformance::<TangentialSpring>();
}
