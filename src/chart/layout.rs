//! Where everything of a figure stands. Room for labels is measured before anything is drawn, so nothing overlaps.

use super::axis::Scale;
use super::legend::Legend;
use super::marks::Window;
use super::panel::{Panel, Shape};
use super::style::{Colour, Stroke};
use super::svg::{Anchor, Font, Svg, rectangle, segment};
use super::ticks::{LABEL, Ticks};
use super::{Figure, FigureError, text};

/// Sizes of text \[px\].
const TITLE: f64 = 16.0;
const PANEL_TITLE: f64 = 13.0;
const NAME: f64 = 13.0;
/// Room around the figure, and between panels \[px\].
const MARGIN: f64 = 14.0;
const GAP: f64 = 16.0;
/// Length of a tick \[px\].
const TICK: f64 = 5.0;
/// The narrowest plot \[px\]; figures of many columns become wider.
const NARROWEST: f64 = 130.0;

/// A panel with all that is known before drawing.
struct Placed<'a> {
    panel: &'a Panel,
    window: Window,
    x: Ticks,
    y: Ticks,
    legend: Legend<'a>,
    /// What the data ask for, before both axes get one scale.
    natural: [Scale; 2],
    /// Upper left corner of the plot \[px\].
    corner: (f64, f64),
    /// Whether the name of the x axis is left to the panel below.
    unnamed: bool,
}

/// Draws the figure.
pub(super) fn draw(figure: &Figure) -> Result<String, FigureError> {
    if figure.panels.is_empty() {
        return Err(FigureError::NoPanel { title: figure.title.clone() });
    }
    let columns = figure.columns.clamp(1, figure.panels.len());
    let column_width = (figure.width - 2.0 * MARGIN - GAP * (columns - 1) as f64) / columns as f64;
    let mut placed = figure.panels.iter().map(|p| place(p, figure.plot_height)).collect::<Result<Vec<_>, _>>()?;
    // Where both axes have one scale, the labels of y depend on the width, and the width on those labels.
    let again = figure.panels.iter().any(|panel| panel.equal);
    let mut right = across(&mut placed, columns, column_width);
    if again {
        right = across(&mut placed, columns, column_width);
    }
    let shared = Legend::shared(&figure.panels, right - MARGIN);
    let top = MARGIN + title_height(&figure.title, TITLE);
    let bottom = stack(&mut placed, columns, top + shared.as_ref().map_or(0.0, Legend::height), shared.is_some());

    let mut svg = Svg::new(right + MARGIN, bottom + MARGIN, &figure.title);
    title(
        &mut svg,
        &figure.title,
        Font { bold: true, ..Font::new(TITLE, Anchor::Start) },
        [MARGIN, MARGIN, right - MARGIN],
    );
    if let Some(shared) = &shared {
        shared.draw(&mut svg, (MARGIN, top));
    }
    for placed in &placed {
        placed.draw(&mut svg, shared.is_some());
    }
    Ok(svg.finish())
}

/// Gives the columns of panels their places side by side; gives the right end of the last.
fn across(placed: &mut [Placed<'_>], columns: usize, column_width: f64) -> f64 {
    let mut corner = MARGIN;
    for column in 0..columns {
        let left = left_margin(placed, column, columns);
        let width = (column_width - left - right_margin()).max(NARROWEST);
        for placed in placed.iter_mut().skip(column).step_by(columns) {
            placed.spread(width);
            placed.corner.0 = corner + left;
        }
        corner += left + width + right_margin() + GAP;
    }
    corner - GAP
}

fn place(panel: &Panel, height: f64) -> Result<Placed<'_>, FigureError> {
    // A course over x fills the panel; scattered points have room around them.
    let scattered = panel.equal || panel.marks.iter().all(|mark| matches!(mark.shape, Shape::Points { .. }));
    let x = panel.x.scale(panel.xs(), if scattered { 0.04 } else { 0.0 })?;
    let y = panel.y.scale(panel.ys(), 0.05)?;
    let window = Window { x, y, width: NARROWEST, height };
    let (y, legend) = (Ticks::up(&panel.y, y, height), Legend::default());
    let natural = [window.x, window.y];
    Ok(Placed { panel, window, x: Ticks::default(), y, legend, natural, corner: (0.0, 0.0), unnamed: false })
}

/// Room for names and labels left of the plots of a column.
fn left_margin(placed: &[Placed<'_>], column: usize, columns: usize) -> f64 {
    let widest = placed.iter().skip(column).step_by(columns).map(|p| p.y.label_width()).fold(0.0, f64::max);
    NAME + 10.0 + widest + TICK + 3.0
}

/// Room for half of the last label right of a plot.
const fn right_margin() -> f64 {
    26.0
}

fn title_height(title: &str, size: f64) -> f64 {
    if title.is_empty() { 0.0 } else { size * 1.2 + 8.0 }
}

/// A title from (x, y), its upper left corner, over a width \[px\].
fn title(svg: &mut Svg, title: &str, font: Font, [x, y, width]: [f64; 3]) {
    if !title.is_empty() {
        // Bold letters are about a tenth wider.
        let shown = text::fitted(title, 1.1 * font.size, width);
        svg.text((x, y + font.size), font, &shown, title);
    }
}

/// Puts the rows of panels under one another from `top` on; gives the bottom of the last.
fn stack(placed: &mut [Placed<'_>], columns: usize, top: f64, shared_legend: bool) -> f64 {
    name_once(placed, columns);
    let mut top = top;
    for row in placed.chunks_mut(columns) {
        let head = row.iter().map(|p| p.head(shared_legend)).fold(0.0, f64::max);
        let foot = row.iter().map(Placed::foot).fold(0.0, f64::max);
        let height = row.iter().map(|p| p.window.height).fold(0.0, f64::max);
        for placed in row {
            placed.corner.1 = top + head;
        }
        top += head + height + foot + GAP;
    }
    top - GAP
}

/// Of panels under one another with the same x axis, only the last names it.
fn name_once(placed: &mut [Placed<'_>], columns: usize) {
    for i in columns..placed.len() {
        let (above, below) = (&placed[i - columns], &placed[i]);
        placed[i - columns].unnamed = above.panel.x == below.panel.x && above.x.name == below.x.name;
    }
}

impl<'a> Placed<'a> {
    /// Takes its width, on which ticks and the rows of the legend depend.
    fn spread(&mut self, width: f64) {
        let panel: &'a Panel = self.panel;
        self.window.width = width;
        if panel.equal && !self.natural.iter().any(|scale| scale.log) {
            let [x, y] = self.natural;
            let height = self.window.height;
            let per_pixel = ((x.high - x.low) / width).max((y.high - y.low) / height);
            (self.window.x, self.window.y) = (x.widened(width, per_pixel), y.widened(height, per_pixel));
            self.y = Ticks::up(&panel.y, self.window.y, height);
        }
        self.x = Ticks::along(&panel.x, self.window.x, width);
        self.legend = Legend::of(&panel.marks, width);
    }

    /// Room above the plot.
    fn head(&self, shared_legend: bool) -> f64 {
        let legend = if shared_legend { 0.0 } else { self.legend.height() };
        title_height(&self.panel.title, PANEL_TITLE) + legend + 4.0
    }

    /// Room below the plot.
    fn foot(&self) -> f64 {
        TICK + LABEL + 6.0 + if self.unnamed { 0.0 } else { NAME + 8.0 }
    }

    fn draw(&self, svg: &mut Svg, shared_legend: bool) {
        let (left, top) = self.corner;
        let Window { width, height, .. } = self.window;
        let head = top - self.head(shared_legend);
        title(
            svg,
            &self.panel.title,
            Font { bold: true, ..Font::new(PANEL_TITLE, Anchor::Start) },
            [left, head, width],
        );
        if !shared_legend {
            self.legend.draw(svg, (left, head + title_height(&self.panel.title, PANEL_TITLE)));
        }
        self.grid(svg);
        let mut drawn = false;
        for mark in &self.panel.marks {
            let reference = matches!(mark.shape, Shape::Horizontal { .. } | Shape::Vertical { .. });
            // Markers on the frame are shown whole.
            let margin = if matches!(mark.shape, Shape::Points { .. }) { 10.0 } else { 0.0 };
            svg.open_window([left, top, width, height], margin);
            drawn |= self.window.draw(svg, &mark.shape) && !reference;
            svg.close_window();
        }
        if !drawn {
            let middle = (left + 0.5 * width, top + 0.5 * height - 6.0);
            svg.text(middle, Font::new(NAME, Anchor::Middle), "no data", "no data");
        }
        svg.stroke(&rectangle([left, top, width, height]), Stroke::new(Colour::Black).width(1.0));
        self.label_x(svg);
        self.label_y(svg);
    }

    /// Faint lines at the ticks, under the data.
    fn grid(&self, svg: &mut Svg) {
        let Window { width, height, .. } = self.window;
        let (left, top) = self.corner;
        let across = self.x.major.iter().map(|(share, _)| left + share * width);
        let up = self.y.major.iter().map(|(share, _)| top + (1.0 - share) * height);
        let across = across.map(|x| segment((x, top), (x, top + height)));
        let path: String = across.chain(up.map(|y| segment((left, y), (left + width, y)))).collect();
        if !path.is_empty() {
            svg.stroke(&path, Stroke::new(Colour::Pale).width(0.7));
        }
    }

    fn label_x(&self, svg: &mut Svg) {
        let (left, bottom) = (self.corner.0, self.corner.1 + self.window.height);
        let place = |share: f64| left + share * self.window.width;
        let tick = |share: f64, length: f64| segment((place(share), bottom), (place(share), bottom + length));
        let mut path: String = self.x.major.iter().map(|(share, _)| tick(*share, TICK)).collect();
        path.extend(self.x.minor.iter().map(|share| tick(*share, 0.5 * TICK)));
        lines(svg, &path);
        for (share, label) in &self.x.major {
            let at = (place(*share), bottom + TICK + LABEL + 1.0);
            svg.text(at, Font::new(LABEL, Anchor::Middle), label, label);
        }
        if !self.unnamed {
            let at = (place(0.5), bottom + TICK + LABEL + 6.0 + NAME);
            let shown = text::fitted(&self.x.name, NAME, self.window.width + 40.0);
            svg.text(at, Font::new(NAME, Anchor::Middle), &shown, &self.x.name);
        }
    }

    fn label_y(&self, svg: &mut Svg) {
        let (left, top) = self.corner;
        let height = self.window.height;
        let place = |share: f64| top + (1.0 - share) * height;
        let tick = |share: f64, length: f64| segment((left - length, place(share)), (left, place(share)));
        let mut path: String = self.y.major.iter().map(|(share, _)| tick(*share, TICK)).collect();
        path.extend(self.y.minor.iter().map(|share| tick(*share, 0.5 * TICK)));
        lines(svg, &path);
        for (share, label) in &self.y.major {
            let at = (left - TICK - 3.0, place(*share) + 0.36 * LABEL);
            svg.text(at, Font::new(LABEL, Anchor::End), label, label);
        }
        let at = (left - TICK - 3.0 - self.y.label_width() - 9.0, place(0.5));
        let shown = text::fitted(&self.y.name, NAME, height + 20.0);
        svg.text(at, Font { upright: true, ..Font::new(NAME, Anchor::Middle) }, &shown, &self.y.name);
    }
}

fn lines(svg: &mut Svg, path: &str) {
    if !path.is_empty() {
        svg.stroke(path, Stroke::new(Colour::Black).width(1.0));
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Axis, Marker};
    use super::*;

    #[test]
    fn a_map_has_one_scale() {
        for points in [[(0.0, 0.0), (1000.0, 3.0)], [(5.0, -1e6), (6.0, 1e6)]] {
            let panel =
                Panel::new(Axis::new("e"), Axis::new("n")).equal().points("", (Marker::Dot, Colour::Grey), points);
            let mut placed = [place(&panel, 300.0).unwrap()];
            for _ in 0..2 {
                across(&mut placed, 1, 700.0);
            }
            let Window { x, y, width, height } = placed[0].window;
            let [across, up] = [(x.high - x.low) / width, (y.high - y.low) / height];
            assert!((across / up - 1.0).abs() < 1e-12, "{across} and {up} a pixel");
            let [from, to] = points;
            let inside = [x.share(from.0), x.share(to.0), y.share(from.1), y.share(to.1)];
            assert!(inside.iter().flatten().all(|share| (0.0..=1.0).contains(share)), "{inside:?}");
        }
    }
}
