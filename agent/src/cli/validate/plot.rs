//! A small line plot as SVG: what is expected as a line, what was measured as dots.

use phystalk::solver::validate::Plot;
use std::fmt::Write;

const SIZE: (f64, f64) = (640.0, 340.0);
/// Left, right, top and bottom of the frame within the picture.
const FRAME: (f64, f64, f64, f64) = (74.0, 616.0, 18.0, 284.0);

/// The picture's text.
pub fn svg(plot: &Plot) -> String {
    let points = || plot.expected.iter().chain(&plot.measured).filter(|p| p[0].is_finite() && p[1].is_finite());
    let (xs, ys) = (Ticks::over(points().map(|p| p[0])), Ticks::over(points().map(|p| p[1])));
    let place = |p: &[f64; 2]| [FRAME.0 + xs.share(p[0]) * (FRAME.1 - FRAME.0), FRAME.3 - ys.share(p[1]) * (FRAME.3 - FRAME.2)];
    let mut text = format!(r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {} {}" font-family="sans-serif" font-size="12">"#, SIZE.0, SIZE.1);
    let mut put = |line: String| {
        // Writing to a String cannot fail.
        let _ = write!(text, "\n{line}");
    };
    put(format!(r##"<rect width="{}" height="{}" fill="#ffffff"/>"##, SIZE.0, SIZE.1));
    for tick in ys.marks() {
        let y = place(&[xs.low, tick])[1];
        put(format!(r##"<line x1="{}" x2="{}" y1="{y:.1}" y2="{y:.1}" stroke="#dddddd"/>"##, FRAME.0, FRAME.1));
        put(format!(r#"<text x="{:.1}" y="{:.1}" text-anchor="end">{}</text>"#, FRAME.0 - 6.0, y + 4.0, ys.label(tick)));
    }
    for tick in xs.marks() {
        let x = place(&[tick, ys.low])[0];
        put(format!(r##"<line x1="{x:.1}" x2="{x:.1}" y1="{}" y2="{}" stroke="#eeeeee"/>"##, FRAME.2, FRAME.3));
        put(format!(r#"<text x="{x:.1}" y="{:.1}" text-anchor="middle">{}</text>"#, FRAME.3 + 18.0, xs.label(tick)));
    }
    let line: Vec<String> = plot.expected.iter().map(&place).map(|[x, y]| format!("{x:.1},{y:.1}")).collect();
    put(format!(r##"<polyline points="{}" fill="none" stroke="#1f6f78" stroke-width="2"/>"##, line.join(" ")));
    for [x, y] in plot.measured.iter().map(place) {
        put(format!(r##"<circle cx="{x:.1}" cy="{y:.1}" r="2.6" fill="#d1495b"/>"##));
    }
    put(format!(r#"<text x="{:.1}" y="{:.1}" text-anchor="middle">{}</text>"#, 0.5 * (FRAME.0 + FRAME.1), SIZE.1 - 12.0, escaped(plot.x)));
    let middle = 0.5 * (FRAME.2 + FRAME.3);
    put(format!(r#"<text x="16" y="{middle:.1}" text-anchor="middle" transform="rotate(-90 16 {middle:.1})">{}</text>"#, escaped(plot.y)));
    put("</svg>".to_owned());
    text.push('\n');
    text
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;")
}

/// An axis from one round number to another.
struct Ticks {
    low: f64,
    high: f64,
    step: f64,
}

impl Ticks {
    fn over(values: impl Iterator<Item = f64>) -> Ticks {
        let (least, most) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        let (least, most) = if least <= most { (least, most) } else { (0.0, 1.0) };
        let span = if most > least { most - least } else { least.abs().max(1.0) };
        // The largest of 1, 2 and 5 times a power of ten that cuts the span into four or more.
        let power = 10f64.powf((span / 4.0).log10().floor());
        let step = [5.0, 2.0, 1.0].into_iter().map(|m| m * power).find(|s| span / s >= 4.0).unwrap_or(power);
        Ticks { low: (least / step).floor() * step, high: (most / step).ceil().max((least / step).floor() + 1.0) * step, step }
    }

    fn share(&self, value: f64) -> f64 {
        (value - self.low) / (self.high - self.low)
    }

    fn marks(&self) -> impl Iterator<Item = f64> + '_ {
        (0..=((self.high - self.low) / self.step).round() as u32).map(|k| self.low + f64::from(k) * self.step)
    }

    fn label(&self, value: f64) -> String {
        let places = (-self.step.log10().floor()).max(0.0) as usize;
        format!("{value:.places$}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_are_round_and_hold_every_value() {
        let ticks = Ticks::over([0.0, 25.6].into_iter());
        assert_eq!((ticks.low, ticks.high, ticks.step), (0.0, 30.0, 5.0));
        assert_eq!(ticks.marks().count(), 7);
        assert_eq!(ticks.label(5.0), "5");
        let flat = Ticks::over([3.0].into_iter());
        assert!(flat.low <= 3.0 && flat.high > flat.low);
        assert_eq!(Ticks::over([0.0, 0.42].into_iter()).label(0.1), "0.1");
    }
}
