//! One impact under the laws of a plan.

use granule_geometry::Cell;
use granule_law_api::Impact;

use crate::fingerprint::fingerprint;
use crate::model::{
    BodyTable, Composition, Guards, MaterialPlan, Partner, Plan, Search, StagePlan, TimeStepPlan,
};

/// An impact of two equal bodies under one composition of a plan: a moving one meets one at rest. Their mass and radius are
/// twice the reduced ones, so that they stand for any two bodies with the same reduced mass, reduced radius and inertia
/// factor, and for a body at a wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SingleImpact {
    /// Index into [`Plan::compositions`].
    pub composition: usize,
    /// Reduced mass, reduced radius and normal speed.
    pub impact: Impact,
    /// Inertia factor q = I/(m R²) of both.
    pub inertia_factor: f64,
    /// Tangential over normal velocity at the contact point before the impact (Ψ1 of Luding 1998, Eq. (34)).
    pub tangential: f64,
    /// Distance that they fly until they touch \[m\].
    pub gap: f64,
    /// Time step \[s\].
    pub step: f64,
}

impl SingleImpact {
    /// The plan of the impact alone: no gravity, walls, substrate or outputs; it runs for `steps` steps.
    pub fn plan(&self, plan: &Plan, steps: u64) -> Plan {
        let composition = &plan.compositions[self.composition];
        let (mass, radius) = (2.0 * self.impact.reduced_mass, 2.0 * self.impact.reduced_radius);
        let velocity = [self.impact.normal_speed, self.tangential * self.impact.normal_speed, 0.0];
        let mut single = Plan {
            title: String::new(),
            dimensions: plan.dimensions,
            rotation: plan.rotation,
            ledger: false,
            precision: plan.precision,
            conventions: plan.conventions,
            gravity: [0.0; 3],
            cell: Cell::unbounded(),
            materials: vec![MaterialPlan { name: "moving".into() }, MaterialPlan { name: "resting".into() }],
            bodies: BodyTable {
                id: vec![1, 2],
                material: vec![0, 1],
                radius: vec![radius; 2],
                mass: vec![mass; 2],
                inertia_factor: vec![self.inertia_factor; 2],
                position: vec![[-(2.0 * radius + composition.reach + self.gap), 0.0, 0.0], [0.0; 3]],
                velocity: vec![velocity, [0.0; 3]],
                spin: vec![[0.0; 3]; 2],
                frozen: vec![false; 2],
            },
            walls: Vec::new(),
            substrate: None,
            compositions: vec![between(composition)],
            driver: TimeStepPlan {
                scheme: plan.driver.scheme,
                step: self.step,
                steps,
                step_limit: f64::INFINITY,
                search: Search::AllPairs,
                skin: 0.0,
                threads: Some(1),
            },
            event: None,
            outputs: Vec::new(),
            checkpoint: None,
            guards: Guards::default(),
            decisions: Vec::new(),
            fingerprint: String::new(),
        };
        single.fingerprint = fingerprint(&single);
        single
    }
}

/// The composition between materials 0 and 1.
fn between(composition: &Composition) -> Composition {
    Composition {
        material: 0,
        partner: Partner::Body(1),
        stages: composition
            .stages
            .iter()
            .map(|stage| StagePlan {
                slot: stage.slot,
                law: stage.law,
                params: stage.params.clone(),
                reads: stage.reads,
                history_offset: stage.history_offset,
                history_width: stage.history_width,
                double: stage.double.clone(),
                single: stage.single.clone(),
            })
            .collect(),
        contact_end: composition.contact_end,
        context: composition.context,
        history_width: composition.history_width,
        reach: composition.reach,
        reads: composition.reads,
        writes: composition.writes,
    }
}
