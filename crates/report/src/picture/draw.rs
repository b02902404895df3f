//! The SVG of a picture: floor, shadows, back edges, spheres, front edges, colour bar.

use super::ScenePicture;
use super::project::{Disc, Screen, visible};
use crate::Colour;
use crate::colour::viridis;
use crate::number::format_number;
use crate::plot::draw::common;
use crate::plot::ticks::{Label, linear};
use crate::svg::{Anchor, Svg, px, text_width, wrap};
use std::collections::BTreeSet;
use std::fmt::Write as _;
use xxhash_rust::xxh3::xxh3_64;

/// Shades of the colour map; one gradient each.
const SHADES: usize = 48;
const GREY: Colour = Colour::new(0x9A, 0xA0, 0xA6);
const BLACK: Colour = Colour::new(0, 0, 0);
const WHITE: Colour = Colour::new(255, 255, 255);
const MARGIN: f64 = 16.0;
const BAR_WIDTH: f64 = 14.0;
const TEXT: f64 = 12.0;

/// Pixels from screen lengths.
struct Placement {
    scale: f64,
    left: f64,
    top: f64,
    low_x: f64,
    high_y: f64,
}

impl Placement {
    fn pixel(&self, screen: [f64; 3]) -> (f64, f64) {
        (self.left + (screen[0] - self.low_x) * self.scale, self.top + (self.high_y - screen[1]) * self.scale)
    }
}

/// The extent of what is drawn on the screen: left, right, low, high.
struct Extent([f64; 4]);

impl Extent {
    fn add(&mut self, x: f64, y: f64, radius: f64) {
        let [left, right, low, high] = &mut self.0;
        *left = left.min(x - radius);
        *right = right.max(x + radius);
        *low = low.min(y - radius);
        *high = high.max(y + radius);
    }
}

/// The whole picture. The input was checked before.
pub(super) fn picture(scene: &ScenePicture<'_>) -> String {
    let screen = Screen::of(scene.view);
    let range = scalar_range(scene);
    let floor = scene.floor.map(|z| floor_corners(scene, z));
    let mut extent = Extent([f64::INFINITY, f64::NEG_INFINITY, f64::INFINITY, f64::NEG_INFINITY]);
    for (position, radius) in scene.positions.iter().zip(scene.radii) {
        let [x, y, _] = screen.project(*position);
        extent.add(x, y, *radius);
    }
    let corners = floor.iter().flatten().copied().chain(scene.frame.iter().flat_map(box_corners));
    for corner in corners {
        let [x, y, _] = screen.project(corner);
        extent.add(x, y, 0.0);
    }
    if !extent.0.iter().all(|v| v.is_finite()) {
        extent = Extent([0.0, 1.0, 0.0, 1.0]);
    }
    let [left, right, low, high] = extent.0;

    let title = wrap(&scene.title, 15.0, scene.width - 2.0 * MARGIN);
    let top = MARGIN + title.len() as f64 * 19.0;
    let label = wrap(&scene.scalar_label, TEXT, 150.0);
    let bar_labels = range.map(BarLabels::of).unwrap_or_default();
    let bar_room = bar_labels.room(&label);
    let room = scene.width - 2.0 * MARGIN - if range.is_some() { bar_room + 24.0 } else { 0.0 };
    // Neither a tower nor a single sphere makes a picture higher than wide.
    let scale = (room / (right - left)).min(room / (high - low));
    let used = (right - left) * scale;
    let body = (high - low) * scale;
    let bar_height = if range.is_some() { (0.8 * body).min(220.0).max(110.0) } else { 0.0 };
    let label_height = label.len() as f64 * 15.0 + 10.0 + bar_labels.head();
    let inner = if range.is_some() { body.max(bar_height + label_height) } else { body };
    let height = top + inner + MARGIN;
    let place = Placement {
        scale,
        left: MARGIN + 0.5 * (room - used),
        top: top + 0.5 * (inner - body),
        low_x: left,
        high_y: high,
    };

    let mut svg =
        Svg::new(scene.width, height, if scene.title.is_empty() { "spheres" } else { &scene.title });
    for (k, line) in title.iter().enumerate() {
        let at = (MARGIN, MARGIN + 12.0 + k as f64 * 19.0);
        svg.text(at, 15.0, Anchor::Start, "font-weight=\"600\"", line);
    }
    let discs: Vec<Disc> = (0..scene.positions.len())
        .map(|index| {
            let at = screen.project(scene.positions[index]);
            let (x, y) = place.pixel(at);
            Disc { index, x, y, radius: scene.radii[index] * scale, depth: at[2] }
        })
        .collect();
    if let Some(corners) = &floor {
        draw_floor(&mut svg, scene, &screen, &place, corners);
    }
    if let Some(frame) = &scene.frame {
        draw_edges(&mut svg, frame, &screen, &place, false);
    }
    draw_spheres(&mut svg, scene, range, visible(discs, scene.width, height));
    if let Some(frame) = &scene.frame {
        draw_edges(&mut svg, frame, &screen, &place, true);
    }
    if range.is_some() {
        let at = (scene.width - MARGIN - bar_room, top + 0.5 * (inner - bar_height - label_height));
        draw_bar(&mut svg, at, bar_height, &bar_labels, &label);
    }
    svg.finish()
}

/// The scalars at the ends of the bar; `None` if no sphere has a finite one, and no range was given.
fn scalar_range(scene: &ScenePicture<'_>) -> Option<(f64, f64)> {
    if let Some([low, high]) = scene.scalar_range {
        return Some((low, high));
    }
    let finite = scene.scalars.iter().copied().filter(|v| v.is_finite());
    let (low, high) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    (low <= high).then_some((low, high))
}

/// Place of a scalar on the bar, 0 to 1; `None` if it is not finite. A bar without extent is all low.
fn fraction(value: f64, (low, high): (f64, f64)) -> Option<f64> {
    let span = 0.5 * high - 0.5 * low;
    value
        .is_finite()
        .then(|| if span > 0.0 { (0.5 * value - 0.5 * low) / span } else { 0.0 }.max(0.0).min(1.0))
}

fn shade(fraction: f64) -> usize {
    ((fraction * SHADES as f64) as usize).min(SHADES - 1)
}

fn shade_colour(shade: usize) -> Colour {
    viridis((shade as f64 + 0.5) / SHADES as f64)
}

fn draw_spheres(svg: &mut Svg, scene: &ScenePicture<'_>, range: Option<(f64, f64)>, discs: Vec<Disc>) {
    let shade_of = |index: usize| range.and_then(|r| fraction(scene.scalars[index], r)).map(shade);
    let used: BTreeSet<Option<usize>> = discs.iter().map(|d| shade_of(d.index)).collect();
    let mut body = String::new();
    for disc in &discs {
        let name = shade_of(disc.index).map_or("g".to_owned(), |s| s.to_string());
        let _ = writeln!(
            body,
            "<circle cx=\"{}\" cy=\"{}\" r=\"{}\" fill=\"url(#@{name})\"/>",
            px(disc.x),
            px(disc.y),
            px(disc.radius)
        );
    }
    // Gradients need ids. The hash of what is drawn makes them differ between the pictures of one page.
    let mut definitions = String::from("<defs>\n");
    for shade in used {
        let (name, colour) = shade.map_or(("g".to_owned(), GREY), |s| (s.to_string(), shade_colour(s)));
        let _ = writeln!(
            definitions,
            "<radialGradient id=\"@{name}\" cx=\"0.5\" cy=\"0.5\" r=\"0.5\" fx=\"0.36\" fy=\"0.32\">\
             <stop offset=\"0\" stop-color=\"{}\"/><stop offset=\"0.3\" stop-color=\"{}\"/>\
             <stop offset=\"0.8\" stop-color=\"{}\"/><stop offset=\"1\" stop-color=\"{}\"/></radialGradient>",
            colour.mix(WHITE, 0.5).hex(),
            colour.mix(WHITE, 0.1).hex(),
            colour.mix(BLACK, 0.22).hex(),
            colour.mix(BLACK, 0.58).hex()
        );
    }
    definitions.push_str("</defs>\n");
    let prefix = format!("s{:08x}-", xxh3_64((definitions.clone() + &body).as_bytes()) as u32);
    svg.raw(&definitions.replace("=\"@", &format!("=\"{prefix}")));
    svg.raw(&body.replace("#@", &format!("#{prefix}")));
}

/// The floor: the horizontal extent of the spheres and the frame, and somewhat more.
fn floor_corners(scene: &ScenePicture<'_>, z: f64) -> [[f64; 3]; 4] {
    let mut extent = Extent([f64::INFINITY, f64::NEG_INFINITY, f64::INFINITY, f64::NEG_INFINITY]);
    for (p, r) in scene.positions.iter().zip(scene.radii) {
        extent.add(p[0], p[1], *r);
    }
    for corner in scene.frame.iter().flatten() {
        extent.add(corner[0], corner[1], 0.0);
    }
    let [left, right, low, high] = if extent.0[0].is_finite() { extent.0 } else { [0.0, 1.0, 0.0, 1.0] };
    let more = 0.06 * (right - left).max(high - low);
    let (l, r, b, t) = (left - more, right + more, low - more, high + more);
    [[l, b, z], [r, b, z], [r, t, z], [l, t, z]]
}

fn draw_floor(
    svg: &mut Svg,
    scene: &ScenePicture<'_>,
    screen: &Screen,
    place: &Placement,
    corners: &[[f64; 3]; 4],
) {
    let points: Vec<(f64, f64)> = corners.iter().map(|c| place.pixel(screen.project(*c))).collect();
    let path: Vec<String> = points.iter().map(|p| format!("{},{}", px(p.0), px(p.1))).collect();
    svg.raw(&format!(
        "<polygon points=\"{}\" fill=\"currentColor\" fill-opacity=\"0.06\" stroke=\"currentColor\" \
         stroke-opacity=\"0.35\" stroke-width=\"1\" stroke-linejoin=\"round\"/>\n",
        path.join(" ")
    ));
    if !screen.shows_upper_side() {
        return;
    }
    // Soft shadows only where a sphere is close enough to the floor to throw one that is not hidden by others.
    let floor = corners[0][2];
    svg.raw("<g fill=\"#000000\" fill-opacity=\"0.16\">\n");
    for (position, radius) in scene.positions.iter().zip(scene.radii) {
        let gap = position[2] - floor;
        if gap < 0.0 || gap > 2.5 * radius {
            continue;
        }
        let (x, y) = place.pixel(screen.project([position[0], position[1], floor]));
        let wide = 1.12 * radius * place.scale;
        let flat = wide * screen.flatness();
        svg.raw(&format!(
            "<ellipse cx=\"{}\" cy=\"{}\" rx=\"{}\" ry=\"{}\"/>\n",
            px(x),
            px(y),
            px(wide),
            px(flat)
        ));
    }
    svg.raw("</g>\n");
}

fn box_corners(frame: &[[f64; 3]; 2]) -> [[f64; 3]; 8] {
    std::array::from_fn(|k| std::array::from_fn(|axis| frame[k >> axis & 1][axis]))
}

/// Edges of the box: those that meet its nearest corner are in front of the spheres, all others behind.
fn draw_edges(svg: &mut Svg, frame: &[[f64; 3]; 2], screen: &Screen, place: &Placement, front: bool) {
    let corners = box_corners(frame).map(|c| screen.project(c));
    let mut nearest = 0;
    for k in 1..8 {
        if corners[k][2] > corners[nearest][2] {
            nearest = k;
        }
    }
    for from in 0..8usize {
        for axis in 0..3 {
            let to = from | 1 << axis;
            let is_front = from == nearest || to == nearest;
            if to != from && is_front == front {
                let opacity = if front { 0.3 } else { 0.5 };
                svg.line(place.pixel(corners[from]), place.pixel(corners[to]), 1.0, opacity);
            }
        }
    }
}

/// Labels of the bar with their places (0 to 1), and the factor that they leave out.
#[derive(Default)]
struct BarLabels {
    places: Vec<(Label, f64)>,
    common: Vec<Label>,
}

impl BarLabels {
    fn of((low, high): (f64, f64)) -> Self {
        // Scalars that agree to rounding are one value.
        if high - low <= 1e-12 * low.abs().max(high.abs()) {
            let label = Label { text: format_number(low, 3), exponent: None };
            return Self { places: vec![(label, 0.0)], common: Vec::new() };
        }
        let ticks = linear(low, high, 5);
        let place = |value: f64| fraction(value, (low, high)).unwrap_or(0.0);
        Self { places: ticks.major.into_iter().map(|(v, l)| (l, place(v))).collect(), common: ticks.common }
    }

    /// Lines above the bar.
    fn head(&self) -> f64 {
        if self.common.is_empty() { 0.0 } else { 17.0 }
    }

    fn room(&self, title: &[String]) -> f64 {
        let numbers = self.places.iter().map(|(label, _)| label.width(TEXT)).fold(0.0, f64::max);
        let words = title.iter().map(|text| text_width(text, TEXT)).fold(0.0, f64::max);
        let common = self.common.iter().map(|label| label.width(TEXT) + 4.0).sum::<f64>();
        words.max(BAR_WIDTH + 8.0 + numbers).max(common)
    }
}

fn draw_bar(svg: &mut Svg, (x, y): (f64, f64), height: f64, labels: &BarLabels, title: &[String]) {
    for (k, line) in title.iter().enumerate() {
        svg.text((x, y + 12.0 + k as f64 * 15.0), TEXT, Anchor::Start, "", line);
    }
    let top = y + title.len() as f64 * 15.0 + 10.0 + labels.head();
    common(svg, (x, top - 6.0), Anchor::Start, &labels.common);
    let step = height / SHADES as f64;
    // Each stripe reaches under the next, or hairlines would show between them.
    for shade in 0..SHADES {
        let at = top + height - (shade + 1) as f64 * step;
        let tall = if shade == 0 { step } else { step + 0.5 };
        svg.raw(&format!(
            "<rect x=\"{}\" y=\"{}\" width=\"{BAR_WIDTH}\" height=\"{}\" fill=\"{}\"/>\n",
            px(x),
            px(at),
            px(tall),
            shade_colour(shade).hex()
        ));
    }
    for (label, place) in &labels.places {
        let at = top + height * (1.0 - place);
        svg.line((x + BAR_WIDTH, at), (x + BAR_WIDTH + 4.0, at), 1.0, 0.8);
        svg.rich_text((x + BAR_WIDTH + 8.0, at + 4.3), TEXT, Anchor::Start, "", &label.markup(TEXT));
    }
}
