//! The toolkit on hostile data: every picture is well-formed, and its numbers are numbers.

use proptest::prelude::*;

use super::*;

/// Parses a picture; every number in it must be finite and every text inside the page.
pub(crate) fn texts(svg: &str) -> Vec<String> {
    let document = roxmltree::Document::parse(svg).unwrap();
    for attribute in document.descendants().flat_map(|node| node.attributes()) {
        let value = attribute.value();
        assert!(!value.contains("NaN") && !value.contains("inf"), "{}={value:?}", attribute.name());
    }
    let page: Vec<f64> = ["width", "height"]
        .iter()
        .map(|name| document.root_element().attribute(*name).unwrap().parse().unwrap())
        .collect();
    for text in document.descendants().filter(|node| node.has_tag_name("text")) {
        let [left, right, low, high] = extent(text);
        let inside = left >= 0.0 && right <= page[0] + 0.5 && low >= 0.0 && high <= page[1] + 0.5;
        assert!(inside, "{:?} from {left} to {right}, {low} to {high} leaves {page:?}", text.text());
    }
    let all = document.descendants().filter(|node| node.has_tag_name("text"));
    all.filter_map(|node| node.text().map(str::to_owned)).collect()
}

/// Left, right, upper and lower end of a text.
fn extent(node: roxmltree::Node<'_, '_>) -> [f64; 4] {
    let number = |name| node.attribute(name).unwrap().parse::<f64>().unwrap();
    let (x, y, size) = (number("x"), number("y"), number("font-size"));
    let bold = if node.has_attribute("font-weight") { 1.1 } else { 1.0 };
    let width = bold * text::width(node.text().unwrap_or_default(), size);
    let before = match node.attribute("text-anchor") {
        Some("middle") => 0.5 * width,
        Some("end") => width,
        _ => 0.0,
    };
    if node.has_attribute("transform") {
        return [x - size, x + 0.3 * size, y - before, y + before];
    }
    [x - before, x - before + width, y - size, y + 0.3 * size]
}

fn of_everything(points: &[(f64, f64)], axes: (Axis, Axis), label: &str) -> Panel {
    let around = |&(x, y): &(f64, f64)| (x, [y - 1.0, y + 1.0]);
    Panel::new(axes.0, axes.1)
        .title(label)
        .band(&format!("{label} band"), Colour::Blue, points.iter().map(around))
        .region("region", 200, vec![points.to_vec()])
        .bars("bars", Colour::Amber, points.iter().map(|&(x, y)| ([x, x + 1.0], y)))
        .line(label, Stroke::new(Colour::Black), points.iter().copied())
        .steps("steps", Stroke::of_series(1), points.iter().copied())
        .points("points", (Marker::Triangle, Colour::Red), points.iter().copied())
        .horizontal("level", Stroke::dashed(Colour::Grey, Dash::Dotted), points.first().map_or(f64::NAN, |p| p.1))
        .vertical("", Stroke::of_series(2), 0.0)
}

pub(crate) fn any_value() -> impl Strategy<Value = f64> {
    prop_oneof![
        any::<f64>(),
        -10.0..10.0f64,
        Just(f64::NAN),
        Just(f64::MAX),
        Just(0.0),
        (0..1000u32).prop_map(|i| 5.0 + 1e-12 * f64::from(i)),
        (0..1000u32).prop_map(|i| 1.7e9 + f64::from(i)),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]
    #[test]
    fn any_data_and_names_give_a_picture(
        points in prop::collection::vec((any_value(), any_value()), 0..30),
        name in ".{0,60}",
        log in prop::array::uniform2(any::<bool>()),
        panels in 1..5usize,
        columns in 0..4usize,
        width in any_value(),
    ) {
        let axis = |log: bool| { let axis = Axis::new(name.clone()).unit(name.clone()); if log { axis.log() } else { axis } };
        let panel = of_everything(&points, (axis(log[0]), axis(log[1])), &name);
        let figure = Figure::new(name.clone()).columns(columns).size(width, 80.0);
        let svg = figure.panels(std::iter::repeat_n(panel, panels)).to_svg().unwrap();
        texts(&svg);
    }
}

#[test]
fn names_units_and_labels_are_on_the_picture() {
    let axes = (Axis::new("time").unit("s"), Axis::new("σ² <noise>").unit("m²"));
    let panel = of_everything(&[(0.0, 1.0), (1.0, 2.0)], axes, "estimate");
    let svg = Figure::new("A & B").panel(panel).to_svg().unwrap();
    let found = texts(&svg);
    for expected in ["A & B", "time [s]", "σ² <noise> [m²]", "estimate", "estimate band", "steps", "points", "level"]
    {
        assert!(found.iter().any(|text| text == expected), "{expected:?} is missing of {found:?}");
    }
}

#[test]
fn panels_with_the_same_legend_share_it() {
    let panel = |x: f64| Panel::new(Axis::new("k"), Axis::new("v")).line("tuned", Stroke::of_series(0), [(x, 1.0)]);
    let count = |panels: Vec<Panel>| {
        let svg = Figure::new("two").panels(panels).to_svg().unwrap();
        let found = texts(&svg);
        ["tuned", "k"].map(|name| found.iter().filter(|text| *text == name).count())
    };
    assert_eq!(count(vec![panel(0.0), panel(0.0)]), [1, 1], "one legend, one name of the axis below both");
    let more = panel(0.0).line("start", Stroke::of_series(1), []);
    assert_eq!(count(vec![panel(0.0), more]), [1, 1], "the second panel adds to the legend of both");
    let other = Panel::new(Axis::new("k"), Axis::new("v")).line("tuned", Stroke::of_series(3), [(0.0, 1.0)]);
    assert_eq!(count(vec![panel(0.0), other]), [2, 1], "the same label means another line");
}

#[test]
fn nothing_to_draw_says_so() {
    let empty = Panel::new(Axis::new("x"), Axis::new("y").log()).line("line", Stroke::of_series(0), [(1.0, -1.0)]);
    let svg = Figure::new("empty").panel(empty.clone()).to_svg().unwrap();
    assert!(texts(&svg).iter().any(|text| text == "no data"), "{svg}");
    let refused = Figure::new("none").to_svg();
    assert_eq!(refused, Err(FigureError::NoPanel { title: "none".to_owned() }));
    let range = Figure::new("range").panel(Panel { x: Axis::new("x").range(2.0, 1.0), ..empty }).to_svg();
    assert!(range.unwrap_err().to_string().contains("cannot run from 2 to 1"));
}

#[test]
fn a_million_points_are_a_small_file() {
    let noise = |k: u32| f64::from(k.wrapping_mul(2_654_435_761) >> 8) / 1e6;
    let points: Vec<(f64, f64)> = (0..1_000_000).map(|k| (f64::from(k), noise(k))).collect();
    let panel = Panel::new(Axis::new("x"), Axis::new("y"))
        .line("line", Stroke::of_series(0), points.iter().copied())
        .band("band", Colour::Blue, points.iter().map(|&(x, y)| (x, [y - 1.0, y + 1.0])))
        .points("points", (Marker::Dot, Colour::Grey), points.iter().copied());
    let svg = Figure::new("many").panel(panel).to_svg().unwrap();
    assert!(svg.len() < 2_000_000, "{} bytes", svg.len());
    assert!(texts(&svg).iter().any(|text| text == "x"), "the axis is named");
}
