//! A contact in the words of each target.

use super::contact::{Contact, Damping, Linear, Normal, Stiffness, Tangential, resolve};
use super::moduli::Moduli;
use super::{Untranslatable, refuse};
use crate::peers::{
    ClassicLaw, ClassicStyle, GranularDamping, GranularLaw, GranularNormal, GranularTangential, LiggghtsLaw,
    LiggghtsNormal, LiggghtsTangential,
};

/// A stand-in for a tangential stiffness that never acts: the engines want a positive number.
const UNUSED_RATIO: f64 = 2.0 / 7.0;

fn rate(damping: Linear, what: &str) -> Result<f64, Untranslatable> {
    match damping.rate {
        Some(rate) => Ok(rate),
        None => refuse(what, "damping per reduced mass, but one coefficient serves several masses"),
    }
}

/// Tangential damping of a linear contact \[1/s\].
fn tangential_rate(damping: Damping, normal: Normal, what: &str) -> Result<f64, Untranslatable> {
    match resolve(damping, normal, None) {
        Some(Damping::Linear(damping)) => rate(damping, what),
        _ => refuse(what, "its tangential damping does not depend on the overlap"),
    }
}

/// LAMMPS `gran/*`.
pub fn classic(contact: &Contact) -> Result<ClassicLaw, Untranslatable> {
    let law = |style, [kn, gamma_n]: [f64; 2], [kt, gamma_t, friction]: [f64; 3]| ClassicLaw {
        style,
        kn,
        kt,
        gamma_n,
        gamma_t,
        friction,
        tangential_damping: true,
        limit_damping: contact.limited,
    };
    let what = "gran/*";
    match (contact.normal, contact.tangential) {
        (Normal::Linear { stiffness, damping }, tangential) => {
            let normal = [stiffness, rate(damping, what)?];
            let unused = UNUSED_RATIO * stiffness;
            match tangential {
                Tangential::None => Ok(law(ClassicStyle::HookeNoHistory, normal, [unused, 0.0, 0.0])),
                Tangential::Viscous { damping, friction } => {
                    let gamma = tangential_rate(damping, contact.normal, what)?;
                    Ok(law(ClassicStyle::HookeNoHistory, normal, [unused, gamma, friction]))
                }
                Tangential::Spring { stiffness: Stiffness::Constant(kt), damping, friction } => {
                    let gamma = tangential_rate(damping, contact.normal, what)?;
                    Ok(law(ClassicStyle::HookeHistory, normal, [kt, gamma, friction]))
                }
                Tangential::Spring { .. } => {
                    refuse(what, "the tangential stiffness of `gran/hooke/history` is one number")
                }
            }
        }
        (Normal::HertzRate { pressure, rate }, tangential) => {
            let normal = [pressure, rate];
            match tangential {
                Tangential::None => {
                    Ok(law(ClassicStyle::HertzHistory, normal, [UNUSED_RATIO * pressure, 0.0, 0.0]))
                }
                Tangential::Spring { stiffness: Stiffness::ContactRadius(kt), damping, friction } => {
                    let gamma = contact_radius_rate(damping, contact.normal, what)?;
                    Ok(law(ClassicStyle::HertzHistory, normal, [kt, gamma, friction]))
                }
                Tangential::Spring { .. } => refuse(
                    what,
                    "the tangential stiffness of `gran/hertz/history` grows with the contact radius",
                ),
                Tangential::Viscous { .. } => refuse(what, "Hertz contacts have a tangential spring"),
            }
        }
        (Normal::Hysteretic { .. }, _) => refuse(what, "there is no hysteretic normal law"),
        (Normal::HertzRoot { .. }, _) => {
            refuse(what, "`gran/hertz/history` damps in proportion to the contact radius, not to its root")
        }
    }
}

/// Tangential damping over the contact radius \[1/(s m)\].
fn contact_radius_rate(damping: Damping, normal: Normal, what: &str) -> Result<f64, Untranslatable> {
    match resolve(damping, normal, None) {
        Some(Damping::ContactRadius(rate)) => Ok(rate),
        Some(Damping::Linear(Linear::ZERO)) => Ok(0.0),
        _ => refuse(what, "its tangential damping grows with the contact radius"),
    }
}

/// LAMMPS `granular`. Hertz contacts are told by stiffness and not by moduli: `hertz/material` at a wall divides by 1 - ν
/// instead of 1 - ν², and `mindlin NULL` there multiplies where it should divide.
pub fn granular(contact: &Contact) -> Result<GranularLaw, Untranslatable> {
    let what = "granular";
    let (normal, damping) = match contact.normal {
        Normal::Linear { stiffness, damping } => {
            let damping = match (damping.rate, damping.coefficient) {
                (Some(rate), _) => GranularDamping::MassVelocity(rate),
                (None, Some(coefficient)) => GranularDamping::Velocity(coefficient),
                (None, None) => return refuse(what, "damping needs one coefficient, or one per mass"),
            };
            (GranularNormal::Hooke(stiffness), damping)
        }
        Normal::HertzRate { pressure, rate } => {
            (GranularNormal::Hertz(pressure), GranularDamping::Viscoelastic(rate))
        }
        Normal::HertzRoot { pressure, alpha: 0.0 } => {
            (GranularNormal::Hertz(pressure), GranularDamping::Velocity(0.0))
        }
        Normal::HertzRoot { pressure, alpha } => {
            (GranularNormal::Hertz(pressure), GranularDamping::Tsuji(tsuji_restitution(alpha)?))
        }
        Normal::Hysteretic { .. } => return refuse(what, "there is no hysteretic normal law"),
    };
    let multiple = |tangential, stiffness| match normal_share(contact.normal, tangential, stiffness) {
        Some(share) => Ok(share),
        None => refuse(what, "its tangential damping is a multiple of the normal one"),
    };
    let (tangential, tangential_damping, friction) = match contact.tangential {
        Tangential::None => (GranularTangential::LinearNoHistory, 0.0, 0.0),
        Tangential::Viscous { damping, friction } => {
            (GranularTangential::LinearNoHistory, multiple(damping, None)?, friction)
        }
        Tangential::Spring { stiffness, damping, friction } => {
            let model = match stiffness {
                Stiffness::Constant(kt) => GranularTangential::LinearHistory(kt),
                Stiffness::ContactRadius(kt) => GranularTangential::Mindlin(kt),
            };
            (model, multiple(damping, Some(stiffness))?, friction)
        }
    };
    Ok(GranularLaw {
        normal,
        damping,
        tangential,
        tangential_damping,
        friction,
        limit_damping: contact.limited,
    })
}

/// Tangential over normal damping, if it is one number.
fn normal_share(normal: Normal, tangential: Damping, stiffness: Option<Stiffness>) -> Option<f64> {
    let over = |tangential: f64, normal: f64| match (tangential, normal) {
        (0.0, _) => Some(0.0),
        (_, 0.0) => None,
        _ => Some(tangential / normal),
    };
    match (tangential, normal) {
        (Damping::OfNormal(share), _) => Some(share),
        (Damping::Linear(Linear::ZERO), _) => Some(0.0),
        (Damping::Linear(tangential), Normal::Linear { damping, .. }) => {
            match (tangential.rate, damping.rate, tangential.coefficient, damping.coefficient) {
                (Some(tangential), Some(normal), ..) | (_, _, Some(tangential), Some(normal)) => {
                    over(tangential, normal)
                }
                _ => None,
            }
        }
        (Damping::ContactRadius(tangential), Normal::HertzRate { rate, .. }) => over(tangential, rate),
        (Damping::Root(tangential), Normal::HertzRoot { pressure, alpha }) => match stiffness {
            Some(Stiffness::ContactRadius(kt)) => over(tangential * (kt / pressure).sqrt(), alpha),
            _ => over(tangential, 0.0),
        },
        (Damping::Root(0.0), _) | (Damping::ContactRadius(0.0), _) => Some(0.0),
        _ => None,
    }
}

/// Tsuji's fit as LAMMPS spells it: damping coefficient α of a restitution. (It asks for another restitution than it gives,
/// see LAMMPS pull request 5113; here it only has to give the α of the scene.)
pub fn tsuji(e: f64) -> f64 {
    1.2728 - 4.2783 * e + 11.087 * e.powi(2) - 22.348 * e.powi(3) + 27.467 * e.powi(4) - 18.022 * e.powi(5)
        + 4.8218 * e.powi(6)
}

/// The restitution for which LAMMPS computes this damping coefficient.
fn tsuji_restitution(alpha: f64) -> Result<f64, Untranslatable> {
    let (mut low, mut high) = (0.0, 1.0);
    if !(alpha <= tsuji(low) && alpha >= tsuji(high)) {
        return refuse(
            "granular",
            format!(
                "`tsuji` reaches damping coefficients from {:.4} to {:.4}, not {alpha}",
                tsuji(1.0),
                tsuji(0.0)
            ),
        );
    }
    // The fit falls monotonically.
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return Ok(middle);
        }
        if tsuji(middle) > alpha {
            low = middle;
        } else {
            high = middle;
        }
    }
}

/// The effective modulus E* from which LIGGGHTS derives this stiffness at its characteristic velocity of 1 m/s:
/// k = 16/15 sqrt(R*) E* (15 m12/(16 sqrt(R*) E*))^(1/5).
fn hysteretic_modulus(stiffness: f64, mass: f64, radius: f64) -> f64 {
    15.0 / 16.0 * (stiffness.powi(5) / (radius * radius * mass)).powf(0.25)
}

/// LIGGGHTS `gran`; contacts by moduli leave what they ask of the materials in `moduli`.
pub fn liggghts(
    contact: &Contact,
    pair: (usize, usize),
    moduli: &mut Moduli,
) -> Result<LiggghtsLaw, Untranslatable> {
    let what = "pair gran";
    let law = |normal, tangential, friction, tangential_damping| LiggghtsLaw {
        normal,
        tangential,
        friction,
        tangential_damping,
        limit_force: contact.limited,
    };
    match contact.normal {
        Normal::Linear { stiffness: kn, damping } => {
            let gamma_n = rate(damping, what)?;
            let (model, kt, gamma_t, friction) = match contact.tangential {
                Tangential::None => (LiggghtsTangential::NoHistory, UNUSED_RATIO * kn, 0.0, 0.0),
                Tangential::Viscous { damping, friction } => {
                    let gamma_t = tangential_rate(damping, contact.normal, what)?;
                    (LiggghtsTangential::NoHistory, UNUSED_RATIO * kn, gamma_t, friction)
                }
                Tangential::Spring { stiffness: Stiffness::Constant(kt), damping, friction } => {
                    let gamma_t = tangential_rate(damping, contact.normal, what)?;
                    (LiggghtsTangential::History, kt, gamma_t, friction)
                }
                Tangential::Spring { .. } => {
                    return refuse(what, "the tangential stiffness of `hooke/stiffness` is one number");
                }
            };
            Ok(law(LiggghtsNormal::HookeStiffness { kn, kt, gamma_n, gamma_t }, model, friction, true))
        }
        Normal::HertzRate { pressure: kn, rate: gamma_n } => {
            let (model, kt, gamma_t, friction) = match contact.tangential {
                Tangential::None => (LiggghtsTangential::NoHistory, UNUSED_RATIO * kn, 0.0, 0.0),
                Tangential::Viscous { damping, friction } => {
                    let gamma_t = contact_radius_rate(damping, contact.normal, what)?;
                    (LiggghtsTangential::NoHistory, UNUSED_RATIO * kn, gamma_t, friction)
                }
                Tangential::Spring { stiffness: Stiffness::ContactRadius(kt), damping, friction } => {
                    let gamma_t = contact_radius_rate(damping, contact.normal, what)?;
                    (LiggghtsTangential::History, kt, gamma_t, friction)
                }
                Tangential::Spring { .. } => {
                    return refuse(
                        what,
                        "the tangential stiffness of `hertz/stiffness` grows with the contact radius",
                    );
                }
            };
            Ok(law(LiggghtsNormal::HertzStiffness { kn, kt, gamma_n, gamma_t }, model, friction, true))
        }
        Normal::Hysteretic { loading, largest, depth, mass, radius } => {
            let normal = LiggghtsNormal::HookeHysteresis { ratio: largest / loading, depth };
            let (model, friction) = match contact.tangential {
                Tangential::None => (LiggghtsTangential::NoHistory, 0.0),
                Tangential::Viscous { .. } => {
                    return refuse(what, "`hooke/hysteresis` derives its damping from a restitution of one");
                }
                Tangential::Spring { stiffness: Stiffness::Constant(kt), damping, friction }
                    if (kt - loading).abs() <= 1e-12 * loading
                        && resolve(damping, contact.normal, None) == Some(Damping::Linear(Linear::ZERO)) =>
                {
                    (LiggghtsTangential::History, friction)
                }
                Tangential::Spring { .. } => {
                    return refuse(
                        what,
                        "the tangential spring of `hooke/hysteresis` has the stiffness of loading and no damper",
                    );
                }
            };
            moduli.ask(pair, hysteretic_modulus(loading, mass, radius), None);
            Ok(law(normal, model, friction, true))
        }
        Normal::HertzRoot { pressure, alpha } => {
            // α = sqrt(5) b with b = |ln e| / sqrt(π² + ln² e).
            let b = alpha / 5.0_f64.sqrt();
            if b >= 1.0 {
                return refuse(what, format!("no restitution gives a damping coefficient of {alpha}"));
            }
            let restitution = (-std::f64::consts::PI * b / ((1.0 - b) * (1.0 + b)).sqrt()).exp();
            let normal = LiggghtsNormal::Hertz { restitution };
            let (shear, model, friction, damped) = match contact.tangential {
                Tangential::None => (None, LiggghtsTangential::NoHistory, 0.0, false),
                Tangential::Viscous { .. } => {
                    return refuse(
                        what,
                        "the damping of `hertz` with `no_history` comes from a shear modulus",
                    );
                }
                Tangential::Spring { stiffness: Stiffness::ContactRadius(kt), damping, friction } => {
                    let derived = 2.0 * (5.0_f64 / 6.0).sqrt() * b;
                    let stiffness = Stiffness::ContactRadius(kt);
                    let damped = match resolve(damping, contact.normal, Some(stiffness)) {
                        Some(Damping::Linear(Linear::ZERO) | Damping::Root(0.0)) => false,
                        Some(Damping::Root(given)) if (given - derived).abs() <= 1e-12 * derived => true,
                        Some(Damping::Root(given)) => {
                            return refuse(
                                what,
                                format!(
                                    "`hertz` derives the tangential damping coefficient {derived} from the restitution; the \
                                     scene has {given}"
                                ),
                            );
                        }
                        _ => {
                            return refuse(
                                what,
                                "the tangential damping of `hertz` comes from the restitution",
                            );
                        }
                    };
                    (Some(kt / 8.0), LiggghtsTangential::History, friction, damped)
                }
                Tangential::Spring { .. } => {
                    return refuse(what, "the tangential stiffness of `hertz` grows with the contact radius");
                }
            };
            moduli.ask(pair, 0.75 * pressure, shear);
            Ok(law(normal, model, friction, damped))
        }
    }
}
