//! The figure as a whole, read back as XML.

use super::*;
use roxmltree::{Document, Node};

fn parsed(svg: &str) -> Document<'_> {
    Document::parse(svg).unwrap()
}

fn texts<'a>(doc: &'a Document<'a>) -> Vec<String> {
    doc.descendants()
        .filter(|n| n.has_tag_name("text"))
        .map(|n| n.descendants().filter(Node::is_text).filter_map(|t| t.text()).collect())
        .collect()
}

fn number(node: &Node<'_, '_>, attribute: &str) -> f64 {
    node.attribute(attribute).unwrap().parse().unwrap()
}

/// The points of the path of the series with this name.
fn path(svg: &str, series: &str) -> Vec<(f64, f64)> {
    let doc = parsed(svg);
    let group =
        doc.descendants().find(|n| n.attribute("aria-label") == Some(series) && n.has_tag_name("g")).unwrap();
    let d = group.children().find(|n| n.has_tag_name("path")).unwrap().attribute("d").unwrap().to_owned();
    d.split(['M', 'L'])
        .filter(|part| !part.is_empty())
        .map(|part| {
            let (x, y) = part.split_once(' ').unwrap();
            (x.parse().unwrap(), y.parse().unwrap())
        })
        .collect()
}

fn sine() -> Plot {
    let x: Vec<f64> = (0..500).map(|k| f64::from(k) * 0.01).collect();
    let y = x.iter().map(|v| v.sin()).collect();
    Plot::new("Sine & co <1>", Axis::linear("x [m]"), Axis::linear("y \"quoted\""))
        .with(Series::line("sin", x, y))
}

#[test]
fn curves_are_exact_to_a_hundredth_of_a_pixel() {
    let plot = Plot {
        x: Axis::linear("x").with_range(0.0, 5.0),
        y: Axis::linear("y").with_range(-1.0, 1.0),
        ..sine()
    };
    let svg = plot.to_svg().unwrap();
    let doc = parsed(&svg);
    let inner = doc.descendants().filter(|n| n.has_tag_name("svg")).nth(1).unwrap();
    let (left, top) = (number(&inner, "x"), number(&inner, "y"));
    let (width, height) = (number(&inner, "width"), number(&inner, "height"));
    let points = path(&svg, "sin");
    // Points on straight pieces are left out; the ends stay.
    assert!((40..=500).contains(&points.len()), "{}", points.len());
    assert!(points[points.len() - 1].0 > left + width * 4.98 / 5.0);
    for (px_x, px_y) in &points {
        let x = ((px_x - left) / width * 500.0).round() * 0.01;
        // Point and frame are each rounded to 0.01 px: at most half of that, three times over.
        assert!((px_x - (left + width * x / 5.0)).abs() < 0.015 + 1e-9);
        assert!((px_y - (top + height * (1.0 - x.sin()) / 2.0)).abs() < 0.015 + 1e-9);
    }
}

#[test]
fn text_is_escaped_and_every_figure_is_well_formed() {
    let svg = sine().to_svg().unwrap();
    let doc = parsed(&svg);
    let found = texts(&doc);
    for wanted in ["Sine & co <1>", "x [m]", "y \"quoted\"", "sin"] {
        assert!(found.iter().any(|t| t == wanted), "{wanted} not in {found:?}");
    }
}

#[test]
fn a_log_axis_counts_what_it_cannot_show() {
    let plot = Plot::new("", Axis::linear("t"), Axis::log("difference")).with(Series::line(
        "d",
        vec![0.0, 1.0, 2.0, 3.0, 4.0, 5.0],
        vec![0.0, 1e-16, -1e-16, 1e-13, f64::NAN, 1e-12],
    ));
    assert_eq!(plot.skipped(), SkippedPoints { not_finite: 1, not_positive: 2, out_of_range: 0 });
    let svg = plot.to_svg().unwrap();
    let doc = parsed(&svg);
    let found = texts(&doc);
    assert!(found.iter().any(|t| t.starts_with("Not drawn: 2 points that a logarithmic axis")), "{found:?}");
    assert!(found.iter().any(|t| t == "Not drawn: 1 point that is not a finite number."), "{found:?}");
}

#[test]
fn the_legend_lies_outside_the_axes() {
    for name in ["a", "a rather long name of a series that cannot stand at the right of the figure"] {
        let mut plot = sine();
        plot.series[0].name = name.to_owned();
        let svg = plot.to_svg().unwrap();
        let doc = parsed(&svg);
        let inner = doc.descendants().filter(|n| n.has_tag_name("svg")).nth(1).unwrap();
        let right = number(&inner, "x") + number(&inner, "width");
        let bottom = number(&inner, "y") + number(&inner, "height");
        let entry = doc.descendants().find(|n| n.has_tag_name("text") && n.text() == Some(name)).unwrap();
        assert!(number(&entry, "x") > right || number(&entry, "y") > bottom);
    }
}

#[test]
fn everything_stays_inside_the_picture() {
    let mut plots = vec![sine()];
    for scale in [1e-300, 1e-9, 1.0, 1e9, 1e300] {
        for (x, y) in [(Axis::linear("x"), Axis::linear("y")), (Axis::log("x"), Axis::log("y"))] {
            let values: Vec<f64> = (1..40).map(|k| f64::from(k) * scale).collect();
            plots.push(Plot::new("t", x, y).with(Series::points("s", values.clone(), values)));
        }
    }
    for plot in plots {
        let svg = plot.to_svg().unwrap();
        let doc = parsed(&svg);
        let root = doc.root_element();
        let (width, height) = (number(&root, "width"), number(&root, "height"));
        for text in doc.descendants().filter(|n| n.has_tag_name("text")) {
            let (x, y) = (number(&text, "x"), number(&text, "y"));
            assert!(x > 0.0 && x < width && y > 0.0 && y < height, "{text:?} at {x} {y}");
        }
    }
}

#[test]
fn steps_hold_a_value_until_the_next() {
    let svg = Plot::new("", Axis::linear("x"), Axis::linear("y"))
        .with(Series::steps("h", vec![0.0, 1.0, 2.0], vec![3.0, 5.0, 5.0]))
        .to_svg()
        .unwrap();
    let doc = parsed(&svg);
    let d = doc.descendants().find(|n| n.attribute("aria-label") == Some("h")).unwrap();
    let d = d.children().find(|n| n.has_tag_name("path")).unwrap().attribute("d").unwrap();
    assert_eq!((d.matches('H').count(), d.matches('V').count(), d.matches('L').count()), (2, 2, 0), "{d}");
}

#[test]
fn error_bars_are_drawn_and_widen_the_range() {
    let points = Series::points("s", vec![1.0, 2.0], vec![1.0, 1.0]).with_error(vec![0.5, 4.0]);
    let svg = Plot::new("", Axis::linear("x"), Axis::linear("y")).with(points).to_svg().unwrap();
    let doc = parsed(&svg);
    let found = texts(&doc);
    assert!(found.iter().any(|t| t == "4") && found.iter().any(|t| t == "−2"), "{found:?}");
    assert_eq!(svg.matches("stroke-width=\"1.2\" stroke-opacity=\"0.8\"").count(), 2, "bars and legend");
}

#[test]
fn wrong_data_is_refused_with_its_reason() {
    let with = |s: Series| Plot::new("", Axis::linear("x"), Axis::log("y")).with(s);
    let message = |p: Plot| p.to_svg().unwrap_err().to_string();
    assert_eq!(
        message(with(Series::line("a", vec![1.0], vec![]))),
        "series `a`: arrays of 1 and of 0 values must have the same length"
    );
    let bar = Series::line("a", vec![1.0], vec![2.0]).with_error(vec![-1.0]);
    assert_eq!(message(with(bar)), "series `a`: error bar of negative length -1");
    let plot = Plot { y: Axis::log("y").with_range(0.0, 1.0), ..sine() };
    assert_eq!(message(plot), "the range of the y axis is 0 to 1: needs 0 < low < high, both finite");
    assert!(message(sine().with_size(f64::NAN, 300.0)).starts_with("a plot of NaN by 300 pixels"));
}

#[test]
fn empty_figures_say_so() {
    for axis in [Axis::linear("y"), Axis::log("y")] {
        let plot = Plot::new("", Axis::linear("x"), axis).with(Series::line("", vec![f64::NAN], vec![1.0]));
        assert!(plot.to_svg().unwrap().contains("nothing to draw"));
    }
    let empty = Plot::new("", Axis::default(), Axis::default());
    assert!(empty.to_svg().unwrap().contains("nothing to draw"));
}
