//! One contact material, spelt in every engine's law.

use std::collections::BTreeMap;

use super::CaseLaw;
use crate::peers::{
    ClassicLaw, ClassicStyle, Engine, GranularDamping, GranularLaw, GranularNormal, GranularTangential,
    LiggghtsLaw, LiggghtsNormal, LiggghtsTangential, PeerLaw, PeerMaterial,
};

/// The laws that both engines have between them, of those compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Which {
    LammpsHooke,
    LammpsHookeHistory,
    LammpsHertzHistory,
    GranularHooke,
    GranularHertz,
    GranularHertzMaterial,
    GranularNoHistory,
    LiggghtsHookeStiffness,
    LiggghtsHooke,
    LiggghtsHertz,
    LiggghtsNoHistory,
}

impl Which {
    pub const ALL: [Self; 11] = [
        Self::LammpsHooke,
        Self::LammpsHookeHistory,
        Self::LammpsHertzHistory,
        Self::GranularHooke,
        Self::GranularHertz,
        Self::GranularHertzMaterial,
        Self::GranularNoHistory,
        Self::LiggghtsHookeStiffness,
        Self::LiggghtsHooke,
        Self::LiggghtsHertz,
        Self::LiggghtsNoHistory,
    ];
    /// Linear laws with a tangential spring.
    pub const LINEAR: [Self; 3] =
        [Self::LammpsHookeHistory, Self::GranularHooke, Self::LiggghtsHookeStiffness];
    /// Hertz laws with a tangential spring.
    pub const HERTZ: [Self; 3] = [Self::LammpsHertzHistory, Self::GranularHertzMaterial, Self::LiggghtsHertz];
    /// Linear and Hertz with a tangential spring.
    pub const HISTORY: [Self; 6] = [
        Self::LammpsHookeHistory,
        Self::LammpsHertzHistory,
        Self::GranularHooke,
        Self::GranularHertzMaterial,
        Self::LiggghtsHookeStiffness,
        Self::LiggghtsHertz,
    ];

    fn slug(self) -> &'static str {
        match self {
            Self::LammpsHooke => "lammps-hooke",
            Self::LammpsHookeHistory => "lammps-hooke-history",
            Self::LammpsHertzHistory => "lammps-hertz-history",
            Self::GranularHooke => "lammps-granular-hooke",
            Self::GranularHertz => "lammps-granular-hertz",
            Self::GranularHertzMaterial => "lammps-granular-hertz-material",
            Self::GranularNoHistory => "lammps-granular-no-history",
            Self::LiggghtsHookeStiffness => "liggghts-hooke-stiffness",
            Self::LiggghtsHooke => "liggghts-hooke",
            Self::LiggghtsHertz => "liggghts-hertz",
            Self::LiggghtsNoHistory => "liggghts-no-history",
        }
    }
}

/// Numbers of one contact material.
#[derive(Clone, Copy, Debug)]
pub struct Recipe {
    /// Linear stiffness (N/m).
    pub kn: f64,
    /// Linear damping (1/s); the tangential one is half of it.
    pub gamma_n: f64,
    /// Hertz damping of the LAMMPS styles (1/(s m)); the tangential one is half of it.
    pub gamma_hertz: f64,
    pub material: PeerMaterial,
    /// Restitution of the laws that ask for it.
    pub restitution: f64,
    pub friction: f64,
    pub tangential_damping: bool,
    /// No attractive normal force.
    pub limit: bool,
}

impl Recipe {
    /// Millimetre grains of 1.3 mg: a linear contact of 80 µs with restitution 0.9.
    pub const GRAIN: Self = Self {
        kn: 1000.0,
        gamma_n: 2620.0,
        gamma_hertz: 1.5e8,
        material: PeerMaterial { youngs_modulus: 1e8, poisson_ratio: 0.25 },
        restitution: 0.9,
        friction: 0.5,
        tangential_damping: true,
        limit: false,
    };
    /// Soft centimetre marbles, so that resting overlaps (10 µm of 5 mm) stay well above round-off: a linear contact of
    /// 3.6 ms with restitution 0.9.
    pub const MARBLE: Self = Self {
        gamma_n: 58.6,
        gamma_hertz: 1.2e5,
        material: PeerMaterial { youngs_modulus: 1e7, poisson_ratio: 0.25 },
        ..Self::GRAIN
    };

    /// The material in the words of one engine's law.
    pub fn law(&self, which: Which) -> PeerLaw {
        // 2/7 of the normal stiffness and half the normal damping are the defaults of LAMMPS.
        let (kt, gamma_t) = (2.0 / 7.0 * self.kn, 0.5 * self.gamma_n);
        let m = self.material;
        let youngs = m.youngs_modulus / (2.0 * (1.0 - m.poisson_ratio * m.poisson_ratio));
        let shear = m.youngs_modulus / (4.0 * (2.0 - m.poisson_ratio) * (1.0 + m.poisson_ratio));
        let classic = |style, kn, kt, gamma_n: f64| {
            PeerLaw::Classic(ClassicLaw {
                style,
                kn,
                kt,
                gamma_n,
                gamma_t: 0.5 * gamma_n,
                friction: self.friction,
                tangential_damping: self.tangential_damping,
                limit_damping: self.limit,
            })
        };
        let granular = |normal, damping, tangential| {
            PeerLaw::Granular(GranularLaw {
                normal,
                damping,
                tangential,
                tangential_damping: if self.tangential_damping { 0.5 } else { 0.0 },
                friction: self.friction,
                limit_damping: self.limit,
            })
        };
        let liggghts = |normal, tangential| {
            PeerLaw::Liggghts(LiggghtsLaw {
                normal,
                tangential,
                friction: self.friction,
                tangential_damping: self.tangential_damping,
                limit_force: self.limit,
            })
        };
        let stiffness = LiggghtsNormal::HookeStiffness { kn: self.kn, kt, gamma_n: self.gamma_n, gamma_t };
        let mass_velocity = GranularDamping::MassVelocity(self.gamma_n);
        let (e, history) = (self.restitution, LiggghtsTangential::History);
        match which {
            Which::LammpsHooke => classic(ClassicStyle::HookeNoHistory, self.kn, kt, self.gamma_n),
            Which::LammpsHookeHistory => classic(ClassicStyle::HookeHistory, self.kn, kt, self.gamma_n),
            Which::LammpsHertzHistory => {
                classic(ClassicStyle::HertzHistory, 4.0 / 3.0 * youngs, 8.0 * shear, self.gamma_hertz)
            }
            Which::GranularHooke => {
                granular(GranularNormal::Hooke(self.kn), mass_velocity, GranularTangential::LinearHistory(kt))
            }
            Which::GranularHertz => granular(
                GranularNormal::Hertz(4.0 / 3.0 * youngs),
                GranularDamping::Viscoelastic(self.gamma_hertz),
                GranularTangential::Mindlin(Some(8.0 * shear)),
            ),
            Which::GranularHertzMaterial => granular(
                GranularNormal::HertzMaterial(m),
                GranularDamping::Tsuji(e),
                GranularTangential::Mindlin(None),
            ),
            Which::GranularNoHistory => {
                granular(GranularNormal::Hooke(self.kn), mass_velocity, GranularTangential::LinearNoHistory)
            }
            Which::LiggghtsHookeStiffness => liggghts(stiffness, history),
            Which::LiggghtsHooke => {
                liggghts(LiggghtsNormal::Hooke { restitution: e, velocity: 0.1 }, history)
            }
            Which::LiggghtsHertz => liggghts(LiggghtsNormal::Hertz { restitution: e }, history),
            Which::LiggghtsNoHistory => liggghts(stiffness, LiggghtsTangential::NoHistory),
        }
    }

    /// One type of body, its law under each name.
    pub fn laws(&self, which: &[Which]) -> Vec<CaseLaw> {
        which.iter().map(|which| case_law(*which, &[self.material], &[((1, 1), self)])).collect()
    }
}

/// Several types, a recipe for each pair of them.
pub fn case_law(which: Which, materials: &[PeerMaterial], recipes: &[((usize, usize), &Recipe)]) -> CaseLaw {
    let laws: BTreeMap<(usize, usize), PeerLaw> =
        recipes.iter().map(|(kinds, recipe)| (*kinds, recipe.law(which))).collect();
    let liggghts = laws.values().all(|law| law.engine() == Engine::Liggghts);
    let materials = materials.iter().map(|material| if liggghts { Some(*material) } else { None }).collect();
    CaseLaw { slug: which.slug().to_owned(), laws, materials }
}
