//! The picture as a whole, read back as XML.

use super::*;
use roxmltree::Document;

fn circles(svg: &str) -> Vec<[f64; 3]> {
    let doc = Document::parse(svg).unwrap();
    let number = |n: &roxmltree::Node<'_, '_>, a: &str| n.attribute(a).unwrap().parse::<f64>().unwrap();
    doc.descendants()
        .filter(|n| n.has_tag_name("circle"))
        .map(|n| [number(&n, "cx"), number(&n, "cy"), number(&n, "r")])
        .collect()
}

#[test]
fn spheres_keep_their_proportions_from_the_side() {
    let positions = [[0.0, 0.0, 1.0], [4.0, 0.0, 2.0]];
    let picture = ScenePicture::new(&positions, &[1.0, 2.0], &[0.0, 1.0], "speed").with_view(View::Side);
    let found = circles(&picture.to_svg().unwrap());
    assert_eq!(found.len(), 2);
    // Equal depth: the one with the smaller index is painted first. Coordinates are rounded to 0.01 pixels.
    let [a, b] = [found[0], found[1]];
    assert!((b[2] - 2.0 * a[2]).abs() < 0.02);
    assert!((b[0] - a[0] - 4.0 * a[2]).abs() < 0.05);
    assert!((a[1] - b[1] - a[2]).abs() < 0.05);
}

#[test]
fn nearer_spheres_are_painted_later_and_hidden_ones_not_at_all() {
    let positions = [[0.0, 5.0, 0.0], [0.5, -3.0, 0.0], [0.0, 9.0, 0.0]];
    let picture =
        ScenePicture::new(&positions, &[1.0, 1.0, 0.3], &[0.0, 1.0, 2.0], "x").with_view(View::Side);
    let found = circles(&picture.to_svg().unwrap());
    assert_eq!(found.len(), 2);
    assert!(found[1][0] > found[0][0], "the one at y = -3 is in front");
}

#[test]
fn references_meet_definitions_and_differ_between_pictures() {
    let picture = |shift: f64| {
        let positions: Vec<[f64; 3]> = (0..50).map(|k| [f64::from(k), shift * f64::from(k), 0.0]).collect();
        let scalars: Vec<f64> = (0..50).map(|k| if k == 7 { f64::NAN } else { f64::from(k) }).collect();
        ScenePicture::new(&positions, &[0.5; 50], &scalars, "x").to_svg().unwrap()
    };
    let (one, two) = (picture(0.0), picture(0.3));
    let ids = |svg: &str| {
        let doc = Document::parse(svg).unwrap();
        let ids: Vec<String> =
            doc.descendants().filter_map(|n| n.attribute("id")).map(str::to_owned).collect();
        for node in doc.descendants().filter(|n| n.has_tag_name("circle")) {
            let fill = node.attribute("fill").unwrap();
            assert!(ids.iter().any(|id| fill == format!("url(#{id})")), "{fill}");
        }
        assert!(ids.iter().any(|id| id.ends_with("-g")), "the sphere without a number is grey");
        ids
    };
    let (ids_one, ids_two) = (ids(&one), ids(&two));
    assert!(ids_one.iter().all(|id| !ids_two.contains(id)));
    assert_eq!(one, picture(0.0));
}

#[test]
fn everything_lies_inside_for_every_view() {
    let positions: Vec<[f64; 3]> = (0..300)
        .map(|k| [f64::from(k % 7), f64::from(k % 11), f64::from(k % 13)].map(|v| v * 0.01))
        .collect();
    let scalars: Vec<f64> = (0..300).map(|k| f64::from(k) * 1e-4).collect();
    for view in [View::Isometric, View::Side, View::Top, View::Angles { azimuth: 20.0, elevation: 15.0 }] {
        let svg = ScenePicture::new(&positions, &[0.005; 300], &scalars, "speed [m/s]")
            .with_view(view)
            .with_floor(-0.005)
            .with_frame([-0.01; 3], [0.1, 0.12, 0.14])
            .with_title("A <box>")
            .to_svg()
            .unwrap();
        let doc = Document::parse(&svg).unwrap();
        let size = |a: &str| doc.root_element().attribute(a).unwrap().parse::<f64>().unwrap();
        for [x, y, r] in circles(&svg) {
            assert!(x - r >= 0.0 && x + r <= size("width") && y - r >= 0.0 && y + r <= size("height"));
        }
    }
}

#[test]
fn an_empty_scene_and_equal_scalars_are_pictures_too() {
    assert!(ScenePicture::new(&[], &[], &[], "x").with_floor(0.0).to_svg().unwrap().contains("<svg"));
    let svg = ScenePicture::new(&[[0.0; 3]; 2], &[1.0; 2], &[3.0; 2], "x").to_svg().unwrap();
    assert_eq!(svg.matches("<radialGradient").count(), 1);
}

#[test]
fn wrong_data_is_refused_with_its_reason() {
    let one = [[0.0; 3]];
    let message = |p: ScenePicture<'_>| p.to_svg().unwrap_err().to_string();
    assert!(message(ScenePicture::new(&one, &[], &[0.0], "x")).contains("positions and radii"));
    assert!(message(ScenePicture::new(&one, &[0.0], &[0.0], "x")).contains("radius 0 of sphere 0"));
    assert!(
        message(ScenePicture::new(&[[0.0, f64::NAN, 0.0]], &[1.0], &[0.0], "x")).contains("value 0 is not")
    );
    let picture = ScenePicture::new(&one, &[1.0], &[0.0], "x");
    let tilted = picture.clone().with_view(View::Angles { azimuth: 0.0, elevation: 91.0 });
    assert!(message(tilted).contains("elevation 91"));
    assert!(
        message(ScenePicture { scalar_range: Some([1.0, 1.0]), ..picture.clone() }).contains("scalar range")
    );
    assert!(message(ScenePicture { width: 10.0, ..picture }).contains("width 10"));
}
