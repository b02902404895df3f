//! Scenes that ask for an accuracy or a time get a setting that keeps it.

use std::path::Path;

use granule_law_api::Registry;
use granule_laws as _;
use granule_trade::{Choice, decide};

/// Two spheres that meet, with this line of contact laws and this wish.
fn scene(normal: &str, tangential: &str, wish: &str) -> String {
    format!(
        r#"(version: 1, materials: {{ "a": (density: 2500) }},
        bodies: [
            Sphere(material: "a", radius: "0.5 mm", position: (0, 0, 0), velocity: (0.4, 0.2, 0), spin: (0, 0, 100)),
            Sphere(material: "a", radius: "0.6 mm", position: ("1.12 mm", "0.1 mm", 0)),
        ],
        contacts: [(between: ("a", "a"), normal: {normal}{tangential})],
        {wish},
        run: (duration: "0.4 ms"))"#
    )
}

fn decided(text: &str) -> Result<Option<Choice>, Vec<String>> {
    let parsed = granule_scene::parse(text);
    assert!(parsed.diagnostics.is_empty(), "{:?}", parsed.diagnostics);
    let registry = Registry::collect().unwrap();
    decide(text, &parsed.scene.unwrap(), &registry, Path::new("."))
        .map_err(|problems| problems.into_iter().map(|problem| problem.message).collect())
}

fn planned(choice: &Choice) -> granule_plan::Plan {
    let parsed = granule_scene::parse(&choice.text);
    assert!(parsed.diagnostics.is_empty(), "{}: {:?}", choice.text, parsed.diagnostics);
    let scene = parsed.scene.unwrap();
    assert!(scene.accuracy.is_none());
    granule_plan::build(&scene, &Registry::collect().unwrap(), Path::new(".")).0.unwrap()
}

/// The stated error holds at phases of the step at which it was not measured. It is 1.25 times the worst of 48 phases that
/// cover the step evenly and of one at its very end; between two of them the error changes by a few per cent of itself.
#[test]
fn a_stated_error_holds_at_other_phases() {
    let spring = ", tangential: TangentialSpring(stiffness: 285, friction: 0.4)";
    for (normal, tangential, error) in [
        ("LinearSpringDashpot(stiffness: 1e3, restitution: 0.9)", "", 1e-2),
        ("LinearSpringDashpot(stiffness: 1e3, restitution: 0.9)", spring, 3e-3),
        ("LinearSpringDashpot(stiffness: 1e3, restitution: 0.5)", spring, 1e-2),
        ("Hertz(effective_modulus: 1e7, restitution: 0.8)", "", 3e-3),
        ("Hertz(effective_modulus: 1e7, restitution: 0.8)", ", tangential: Coulomb(friction: 0.3)", 1e-2),
        ("WaltonBraun(loading_stiffness: 1e3, restitution: 0.7)", "", 1e-2),
    ] {
        for wished in [error, 0.5 * error] {
            let text = scene(normal, tangential, &format!("accuracy: (restitution: {wished:?})"));
            let choice = decided(&text).unwrap().unwrap();
            assert!(choice.error <= wished, "{normal}: {}", choice.why());
            let plan = planned(&choice);
            let again = choice.measured_again(&plan).unwrap().unwrap();
            assert!(again <= choice.error, "{normal}{tangential}: {again} of {}", choice.error);
            // A choice that is far too fine would cost for nothing: steps differ by a factor of the root of two, and no scheme
            // here converges faster than with the square of the step.
            assert!(
                choice.error > 0.1 * wished || choice.setting.steps_per_contact == 10.0,
                "{}",
                choice.why()
            );
        }
    }
}

/// More time buys a smaller error, and too little is refused with what it would take.
#[test]
fn a_budget_is_spent_on_accuracy() {
    let normal = "LinearSpringDashpot(stiffness: 1e3, restitution: 0.9)";
    let choose = |seconds: f64| decided(&scene(normal, "", &format!("budget: (seconds: {seconds:?})")));
    let (little, much) = (choose(1e-3).unwrap().unwrap(), choose(0.1).unwrap().unwrap());
    assert!(much.setting.steps_per_contact > 4.0 * little.setting.steps_per_contact);
    assert!(much.error < little.error && much.seconds.unwrap() < 0.1);
    let refused = choose(1e-12).unwrap_err();
    assert!(refused[0].contains("does not fit into 0.000000000001 s"), "{refused:?}");
}

/// What cannot be had is said, with what can.
#[test]
fn what_is_out_of_reach_is_refused() {
    let normal = "LinearSpringDashpot(stiffness: 1e3, restitution: 0.9)";
    let refused = decided(&scene(normal, "", "accuracy: (restitution: 1e-13)")).unwrap_err();
    assert!(refused[0].contains("out of reach"), "{refused:?}");
    let text =
        scene(normal, "", "accuracy: (restitution: 1e-3)").replace("duration: \"0.4 ms\"", "steps: 100");
    assert!(decided(&text).unwrap_err()[0].contains("no meaning while `accuracy` chooses the step"));
    let text = scene(normal, "", "accuracy: (observable: \"spins\", error: 0.1, table: \"none\")");
    assert!(decided(&text).unwrap_err()[0].contains("there is no table"));
}

/// A table of a trade decides for the scene that it was made of, and for no other.
#[test]
fn a_table_decides_for_its_scene() {
    let folder = tempfile::tempdir().unwrap();
    let normal = "LinearSpringDashpot(stiffness: 1e3, restitution: 0.9)";
    let place = folder.path().display().to_string();
    let wish =
        |error: f64| format!("accuracy: (observable: \"velocities\", error: {error:?}, table: {place:?})");
    let text = scene(normal, "", &wish(0.01));
    let registry = Registry::collect().unwrap();
    let options = granule_trade::Options {
        directory: folder.path().to_path_buf(),
        observe: Vec::new(),
        realisations: 3,
        target: 0.01,
    };
    struct Quiet;
    impl granule_trade::Watch for Quiet {
        fn progress(&mut self, _: usize, _: usize, _: &str) {}
    }
    let never = std::sync::atomic::AtomicBool::new(false);
    let study = granule_trade::trade(&text, Path::new("."), &registry, &options, &mut Quiet, &never).unwrap();
    granule_trade::write(&study, &text, &registry, Path::new("."), folder.path()).unwrap();
    let choice = decided(&text).unwrap().unwrap();
    let best = &study.settings[study.chosen.unwrap()];
    assert!(choice.error <= 0.01 && choice.quantity == "velocities");
    assert_eq!(choice.setting, best.setting);
    let plan = std::sync::Arc::new(planned(&choice));
    let mut meter = choice.meter(&plan).unwrap();
    let mut driver = granule_drivers::driver(plan.clone(), Some(1)).unwrap();
    meter.begin(&driver.view());
    while let Some(step) = meter.next_due() {
        driver.advance(step, &never).unwrap();
        meter.look(&driver.view());
    }
    // The run is the first of those that the table was made of.
    let realised = choice.realised(meter).unwrap();
    assert!(realised.error <= choice.error, "{realised:?}, {} expected", choice.error);
    assert!(realised.error > 0.0 && realised.chance < 0.01, "{realised:?}");
    assert_eq!(choice.realised(choice.meter(&plan).unwrap()), None, "nobody looked");
    let stricter = decided(&scene(normal, "", &wish(1e-3))).unwrap().unwrap();
    assert!(stricter.error <= 1e-3, "{}", stricter.why());
    let time = format!("budget: (seconds: {:?}, table: {place:?})", 100.0 * choice.seconds.unwrap());
    assert!(decided(&scene(normal, "", &time)).unwrap().unwrap().error <= choice.error);
    let other = scene(&normal.replace("0.9", "0.8"), "", &wish(0.01));
    assert!(decided(&other).unwrap_err()[0].contains("belongs to another scene"));
    let unknown = text.replace("\"velocities\"", "\"mean_height\"");
    assert!(decided(&unknown).unwrap_err()[0].contains("has no `mean_height`"));
    std::fs::write(folder.path().join("trade.json"), "{}").unwrap();
    assert!(decided(&text).unwrap_err()[0].contains("is no table of a trade"));
}
