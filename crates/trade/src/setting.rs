//! One way to run a scene, as a change of the scene.

use granule_law_api::{Registry, Slot};
use granule_scene::{
    Diagnostic, IntegratorChoice, ParameterValue, PrecisionChoice, RunBlock, Scene, Spanned, StepChoice,
    replace_all, set_field,
};
use serde::{Deserialize, Serialize};

/// Physics that a setting leaves out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Omission {
    /// Nothing.
    None,
    /// All tangential, rolling and torsion laws, and with them rotation and history.
    Friction,
    /// Gravity.
    Gravity,
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
        let mut label = format!("{} {}", integrator_name(self.integrator), self.steps_per_contact);
        if self.precision == PrecisionChoice::Single {
            label.push_str(" single");
        }
        if self.stiffness != 1.0 {
            label.push_str(&format!(" k x {}", self.stiffness));
        }
        match self.without {
            Omission::None => {}
            Omission::Friction => label.push_str(" no friction"),
            Omission::Gravity => label.push_str(" no gravity"),
        }
        label
    }

    /// The family of settings that differ in the steps in a contact only.
    pub fn family(&self) -> String {
        let label = self.label();
        label.replacen(&format!(" {}", self.steps_per_contact), "", 1)
    }

    /// The scene with this setting, without outputs, running for `duration` \[s\]. `None` if the setting does not apply.
    pub(crate) fn apply(&self, scene: &Scene, registry: &Registry, duration: f64) -> Option<Scene> {
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
        }
        if self.stiffness != 1.0 {
            for contact in &mut scene.contacts.items {
                for (slot, law) in &mut contact.laws {
                    let entry = registry.get(&law.name.value).ok()?;
                    let mut scaled = entry.info.slot != Slot::Normal;
                    for (name, value) in &mut law.parameters {
                        if let Some(power) = stiffness_power(&name.value) {
                            value.value = scaled_value(&value.value, self.stiffness.powf(power))?;
                            scaled |= power == 1.0 || name.value == "contact_duration";
                        }
                    }
                    if !scaled && *slot == "normal" {
                        return None;
                    }
                }
            }
        }
        Some(scene)
    }
}

/// The text of a scene with a setting written into it, comments and everything else as they were. `step` is the time step
/// that the setting has led to \[s\].
///
/// # Errors
/// The text has errors, or the setting cannot be written into it.
pub fn chosen_scene(text: &str, setting: &Setting) -> Result<String, Vec<Diagnostic>> {
    let parsed = granule_scene::parse(text);
    let Some(scene) = parsed.scene else { return Err(parsed.diagnostics) };
    let mut changes = Vec::new();
    for contact in &scene.contacts.items {
        for (slot, law) in &contact.laws {
            if setting.without == Omission::Friction && is_friction(slot) {
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
const INTEGRATORS: [(&str, IntegratorChoice); 4] = [
    ("VelocityVerlet", IntegratorChoice::VelocityVerlet),
    ("ClassicVelocityVerlet", IntegratorChoice::ClassicVelocityVerlet),
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

    #[test]
    fn a_choice_is_written_into_the_text() {
        let text = chosen_scene(SCENE, &setting()).unwrap();
        assert!(text.contains("// grains") && text.contains("contact_duration: \"4e-1 ms\""), "{text}");
        assert!(text.contains("stiffness: 750.0"), "{text}");
        let scene = granule_scene::parse(&text).scene.unwrap();
        assert_eq!(scene.driver.step.value, StepChoice::Auto { steps_per_contact: 40.0 });
        assert_eq!(scene.driver.integrator.unwrap().value, IntegratorChoice::Leapfrog);
        let smooth = chosen_scene(SCENE, &Setting { without: Omission::Friction, ..setting() }).unwrap();
        let scene = granule_scene::parse(&smooth).scene.unwrap();
        assert_eq!(scene.contacts.items[0].laws.len(), 1, "{smooth}");
    }

    #[test]
    fn labels_name_what_differs() {
        assert_eq!(setting().label(), "Leapfrog 40 k x 0.25");
        assert_eq!(setting().family(), "Leapfrog k x 0.25");
    }
}
