//! One way to run a scene, as a change of the scene.

use std::path::Path;

use granule_law_api::{Registry, Slot};
use granule_scene::{
    Diagnostic, IntegratorChoice, LawBlock, ParameterValue, PrecisionChoice, RunBlock, Scene, Spanned,
    StepChoice, replace_all, set_field,
};
use serde::{Deserialize, Serialize};

use crate::hard;

/// Physics that a setting leaves out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Omission {
    /// Nothing.
    None,
    /// All tangential, rolling and torsion laws, and with them rotation and history.
    Friction,
    /// Gravity.
    Gravity,
    /// The memory of tangential springs: Coulomb friction instead.
    History,
    /// Rolling and torsion laws.
    Rolling,
    /// The duration of contacts: hard bodies with the restitutions, friction and contact duration of the laws.
    Softness,
}

impl Omission {
    /// What is left out, in words; empty for nothing.
    pub fn words(self) -> &'static str {
        match self {
            Self::None => "",
            Self::Friction => "no friction",
            Self::Gravity => "no gravity",
            Self::History => "no history",
            Self::Rolling => "no rolling friction",
            Self::Softness => "hard bodies",
        }
    }

    /// The physics that goes; empty for nothing.
    pub fn physics(self) -> &'static str {
        match self {
            Self::None => "",
            Self::Friction => "friction",
            Self::Gravity => "gravity",
            Self::History => "memory of friction",
            Self::Rolling => "rolling friction",
            Self::Softness => "soft contacts",
        }
    }
}

/// One way to run a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setting {
    /// Scheme.
    pub integrator: IntegratorChoice,
    /// Steps in the shortest contact.
    pub steps_per_contact: f64,
    /// Arithmetic of the laws.
    pub precision: PrecisionChoice,
    /// Factor on all stiffnesses; dampings follow so that restitution stays.
    pub stiffness: f64,
    /// What is left out.
    pub without: Omission,
}

impl Setting {
    /// What the setting is called.
    pub fn label(&self) -> String {
        if self.without == Omission::Softness {
            return self.without.words().to_string();
        }
        let mut label = format!("{} {}", integrator_name(self.integrator), self.steps_per_contact);
        if self.precision == PrecisionChoice::Single {
            label.push_str(" single");
        }
        if self.stiffness != 1.0 {
            label.push_str(&format!(" k x {}", self.stiffness));
        }
        if self.without != Omission::None {
            label.push_str(&format!(" {}", self.without.words()));
        }
        label
    }

    /// The family of settings that differ in the steps in a contact only.
    pub fn family(&self) -> String {
        let label = self.label();
        label.replacen(&format!(" {}", self.steps_per_contact), "", 1)
    }

    /// The scene with this setting, without outputs, running for `duration` \[s\]; why not, if the setting does not apply.
    /// `folder` is where the scene lies.
    pub(crate) fn apply(
        &self,
        scene: &Scene,
        registry: &Registry,
        folder: &Path,
        duration: f64,
    ) -> Result<Scene, String> {
        let mut scene = scene.clone();
        let at = scene.driver.step.span.clone();
        scene.driver.step =
            Spanned::new(StepChoice::Auto { steps_per_contact: self.steps_per_contact }, at.clone());
        scene.driver.integrator = Some(Spanned::new(self.integrator, at.clone()));
        scene.accuracy = None;
        scene.precision = self.precision;
        scene.run = Some(RunBlock::Duration(Spanned::new(duration, at)));
        scene.outputs.items.clear();
        match self.without {
            Omission::None => {}
            Omission::Gravity => scene.gravity = None,
            Omission::Friction => {
                for contact in &mut scene.contacts.items {
                    contact.laws.retain(|(slot, _)| !is_friction(slot));
                }
            }
            Omission::Rolling => {
                for contact in &mut scene.contacts.items {
                    contact.laws.retain(|(slot, _)| !is_rolling(slot));
                }
            }
            Omission::History => {
                for (block, law) in forgetful(&scene)?.into_iter().enumerate() {
                    let laws = &mut scene.contacts.items[block].laws;
                    for (slot, old) in laws.iter_mut() {
                        if *slot == "tangential"
                            && let Some(law) = &law
                        {
                            *old = law.clone();
                        }
                    }
                }
            }
            Omission::Softness => hard::harden(&mut scene, registry, folder, duration)?,
        }
        if self.stiffness != 1.0 {
            for contact in &mut scene.contacts.items {
                for (slot, law) in &mut contact.laws {
                    let entry = registry.get(&law.name.value).map_err(|error| error.to_string())?;
                    let mut scaled = entry.info.slot != Slot::Normal;
                    for (name, value) in &mut law.parameters {
                        if let Some(power) = stiffness_power(&name.value) {
                            value.value = scaled_value(&value.value, self.stiffness.powf(power))
                                .ok_or("a stiffness of it cannot be read")?;
                            scaled |= power == 1.0 || name.value == "contact_duration";
                        }
                    }
                    if !scaled && *slot == "normal" {
                        return Err("its stiffness is no parameter of these laws".into());
                    }
                }
            }
        }
        Ok(scene)
    }
}

/// Coulomb friction with the coefficient of the tangential law, for each contact block that has a law with memory.
fn forgetful(scene: &Scene) -> Result<Vec<Option<LawBlock>>, String> {
    let mut any = false;
    let laws = scene
        .contacts
        .items
        .iter()
        .map(|contact| {
            let (_, law) = contact.laws.iter().find(|(slot, _)| *slot == "tangential")?;
            let friction = law.parameters.iter().find(|(name, _)| name.value == "friction")?;
            let spring = law.name.value == "TangentialSpring";
            any |= spring;
            spring.then(|| LawBlock {
                name: Spanned::new("Coulomb".into(), law.name.span.clone()),
                parameters: vec![friction.clone()],
                span: law.span.clone(),
            })
        })
        .collect();
    if any { Ok(laws) } else { Err("no law of it remembers a tangential displacement".into()) }
}

/// The text of a scene with a setting written into it, comments and everything else as they were. `folder` is where the
/// scene lies.
///
/// # Errors
/// The text has errors, or the setting cannot be written into it.
pub fn chosen_scene(
    text: &str,
    setting: &Setting,
    registry: &Registry,
    folder: &Path,
) -> Result<String, Vec<Diagnostic>> {
    let parsed = granule_scene::parse(text);
    let Some(scene) = parsed.scene else { return Err(parsed.diagnostics) };
    if setting.without == Omission::Softness {
        return hard::write(text, &scene, registry, folder);
    }
    let mut changes = Vec::new();
    for contact in &scene.contacts.items {
        for (slot, law) in &contact.laws {
            let gone = (setting.without == Omission::Friction && is_friction(slot))
                || (setting.without == Omission::Rolling && is_rolling(slot));
            if gone {
                changes.push((field_span(text, slot, law.span.clone()), String::new()));
                continue;
            }
            for (name, value) in &law.parameters {
                let factor = stiffness_power(&name.value).map_or(1.0, |power| setting.stiffness.powf(power));
                if factor != 1.0
                    && let Some(scaled) = scaled_value(&value.value, factor)
                {
                    let words = match scaled {
                        ParameterValue::Number(number) => format!("{number:?}"),
                        ParameterValue::Text(words) => format!("{words:?}"),
                    };
                    changes.push((value.span.clone(), words));
                }
            }
        }
    }
    if setting.without == Omission::History {
        let laws = forgetful(&scene).unwrap_or_default();
        for (contact, law) in scene.contacts.items.iter().zip(laws) {
            for (slot, old) in &contact.laws {
                if *slot == "tangential"
                    && let Some(law) = &law
                {
                    changes.retain(|(span, _)| span.start < old.span.start || span.end > old.span.end);
                    let friction = &text[law.parameters[0].1.span.clone()];
                    changes.push((old.span.clone(), format!("Coulomb(friction: {friction})")));
                }
            }
        }
    }
    let one = |diagnostic| vec![diagnostic];
    let mut text = replace_all(text, changes);
    let driver = Some(("driver", "TimeStep"));
    let step = format!("Auto(steps_per_contact: {})", setting.steps_per_contact);
    text = set_field(&text, driver, "step", &step).map_err(one)?;
    text = set_field(&text, driver, "integrator", integrator_name(setting.integrator)).map_err(one)?;
    if setting.precision != scene.precision {
        text = set_field(&text, None, "precision", precision_name(setting.precision)).map_err(one)?;
    }
    if setting.without == Omission::Gravity {
        let zero = if scene.dimensions.value == 2 { "(0, 0)" } else { "(0, 0, 0)" };
        text = set_field(&text, None, "gravity", zero).map_err(one)?;
    }
    Ok(text)
}

/// The bytes of `slot: value,` around the bytes of the value.
fn field_span(text: &str, slot: &str, value: std::ops::Range<usize>) -> std::ops::Range<usize> {
    let start = text[..value.start].rfind(slot).unwrap_or(value.start);
    let rest = &text[value.end..];
    let blank = rest.len() - rest.trim_start().len();
    let end = if rest[blank..].starts_with(',') { value.end + blank + 1 } else { value.end };
    start..end
}

fn is_rolling(slot: &str) -> bool {
    matches!(slot, "rolling" | "torsion")
}

fn is_friction(slot: &str) -> bool {
    matches!(slot, "tangential" | "rolling" | "torsion")
}

/// The power of a stiffness factor with which a parameter goes so that restitution stays as it is; `None` if it does not
/// change. Stiffnesses and moduli go with the factor, times with its inverse root, dampings with its root.
fn stiffness_power(name: &str) -> Option<f64> {
    match name {
        "stiffness" | "modulus" | "youngs_modulus" | "shear_modulus" => Some(1.0),
        "contact_duration" => Some(-0.5),
        "damping" | "damping_rate" => Some(0.5),
        _ => None,
    }
}

fn scaled_value(value: &ParameterValue, factor: f64) -> Option<ParameterValue> {
    match value {
        ParameterValue::Number(number) => Some(ParameterValue::Number(number * factor)),
        ParameterValue::Text(text) => {
            let trimmed = text.trim();
            let length = (1..=trimmed.len())
                .rev()
                .filter(|end| trimmed.is_char_boundary(*end))
                .find(|end| trimmed[..*end].parse::<f64>().is_ok())?;
            let number: f64 = trimmed[..length].parse().ok()?;
            Some(ParameterValue::Text(format!("{:e}{}", number * factor, &trimmed[length..])))
        }
    }
}

/// Schemes by their names in scenes.
const INTEGRATORS: [(&str, IntegratorChoice); 5] = [
    ("VelocityVerlet", IntegratorChoice::VelocityVerlet),
    ("ClassicVelocityVerlet", IntegratorChoice::ClassicVelocityVerlet),
    ("ContactResolved", IntegratorChoice::ContactResolved),
    ("Leapfrog", IntegratorChoice::Leapfrog),
    ("SymplecticEuler", IntegratorChoice::SymplecticEuler),
];

/// Name of a scheme as in scenes.
pub(crate) fn integrator_name(integrator: IntegratorChoice) -> &'static str {
    INTEGRATORS.iter().find(|(_, known)| *known == integrator).map_or("?", |(name, _)| name)
}

/// The scheme of a name.
pub(crate) fn integrator_named(name: &str) -> Option<IntegratorChoice> {
    INTEGRATORS.iter().find(|(known, _)| *known == name).map(|(_, integrator)| *integrator)
}

/// Name of an arithmetic as in scenes.
pub(crate) fn precision_name(precision: PrecisionChoice) -> &'static str {
    match precision {
        PrecisionChoice::Double => "Double",
        PrecisionChoice::Single => "Single",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCENE: &str = r#"(
    version: 1,
    // grains
    materials: { "a": (density: 2500) },
    bodies: [Sphere(material: "a", radius: 0.01, position: (0, 0, 0))],
    contacts: [(between: ("a", "a"), normal: LinearSpringDashpot(contact_duration: "0.2 ms", restitution: 0.8),
        tangential: TangentialSpring(stiffness: 3e3, friction: 0.5))],
    run: (duration: 1),
)"#;

    fn setting() -> Setting {
        Setting {
            integrator: IntegratorChoice::Leapfrog,
            steps_per_contact: 40.0,
            precision: PrecisionChoice::Double,
            stiffness: 0.25,
            without: Omission::None,
        }
    }

    fn chosen(text: &str, setting: &Setting) -> Result<String, Vec<Diagnostic>> {
        chosen_scene(text, setting, &Registry::collect().unwrap(), Path::new("."))
    }

    #[test]
    fn a_choice_is_written_into_the_text() {
        let text = chosen(SCENE, &setting()).unwrap();
        assert!(text.contains("// grains") && text.contains("contact_duration: \"4e-1 ms\""), "{text}");
        assert!(text.contains("stiffness: 750.0"), "{text}");
        let scene = granule_scene::parse(&text).scene.unwrap();
        assert_eq!(scene.driver.step.value, StepChoice::Auto { steps_per_contact: 40.0 });
        assert_eq!(scene.driver.integrator.unwrap().value, IntegratorChoice::Leapfrog);
        let smooth = chosen(SCENE, &Setting { without: Omission::Friction, ..setting() }).unwrap();
        let scene = granule_scene::parse(&smooth).scene.unwrap();
        assert_eq!(scene.contacts.items[0].laws.len(), 1, "{smooth}");
    }

    #[test]
    fn labels_name_what_differs() {
        assert_eq!(setting().label(), "Leapfrog 40 k x 0.25");
        assert_eq!(setting().family(), "Leapfrog k x 0.25");
    }
}
