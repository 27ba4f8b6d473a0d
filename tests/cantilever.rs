//! The cantilever of V5 along its whole length, and the page of the documents that shows it beside the
//! other cases.

#![allow(clippy::unwrap_used, reason = "a test of good input")]

use phystalk::gpu::{DeviceRequest, Gpu};
use phystalk::solver::validate::{BeamPoint, CASES, cantilever_curve};
use std::fmt::Write;

/// Set to rewrite plot and page; that runs every case.
const UPDATE: &str = "UPDATE_DOCS";

#[test]
fn the_beam_hangs_as_timoshenko_says_along_its_whole_length() {
    let gpu = Gpu::open(&DeviceRequest::default()).unwrap();
    let curve = cantilever_curve(&gpu).unwrap();
    let tip = curve.last().unwrap().expected_m;
    for point in &curve {
        let error = (point.measured_m - point.expected_m).abs() / tip;
        assert!(error < 0.05, "at {:.3} m: {:.5} m, expected {:.5} m", point.x_m, point.measured_m, point.expected_m);
    }
    if std::env::var_os(UPDATE).is_some() {
        std::fs::write(concat!(env!("CARGO_MANIFEST_DIR"), "/docs/media/cantilever.svg"), plot(&curve)).unwrap();
        std::fs::write(concat!(env!("CARGO_MANIFEST_DIR"), "/docs/validation.md"), page(&gpu)).unwrap();
    }
}

/// Deflection over length: the formula as a line, the solver as dots.
fn plot(curve: &[BeamPoint]) -> String {
    let (width, height, left, top) = (640.0, 320.0, 70.0, 30.0);
    let length = curve.last().unwrap().x_m;
    let deepest = curve.iter().map(|p| p.expected_m.max(p.measured_m)).fold(0.0, f64::max);
    let x = |at: f64| left + at / length * (width - left - 30.0);
    let y = |down: f64| top + down / deepest * (height - top - 60.0);
    let mut svg = format!(r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" font-family="sans-serif" font-size="12">"#);
    let mut put = |text: String| writeln!(svg, "{text}").unwrap();
    put(String::new());
    put(format!(r##"<rect width="{width}" height="{height}" fill="#ffffff"/>"##));
    for k in 0..=4 {
        let (down, at) = (deepest * f64::from(k) / 4.0, length * f64::from(k) / 4.0);
        put(format!(r##"<line x1="{left}" x2="{:.1}" y1="{1:.1}" y2="{1:.1}" stroke="#dddddd"/>"##, x(length), y(down)));
        put(format!(r#"<text x="{:.1}" y="{:.1}" text-anchor="end">{:.1} mm</text>"#, left - 6.0, y(down) + 4.0, down * 1e3));
        put(format!(r#"<text x="{:.1}" y="{:.1}" text-anchor="middle">{at:.2} m</text>"#, x(at), height - 38.0));
    }
    let line: Vec<String> = curve.iter().map(|p| format!("{:.1},{:.1}", x(p.x_m), y(p.expected_m))).collect();
    put(format!(r##"<polyline points="{}" fill="none" stroke="#1f6f78" stroke-width="2"/>"##, line.join(" ")));
    for p in curve {
        put(format!(r##"<circle cx="{:.1}" cy="{:.1}" r="2.6" fill="#d1495b"/>"##, x(p.x_m), y(p.measured_m)));
    }
    put(format!(
        r##"<text x="{left}" y="18">Deflection under its own weight: line Timoshenko (k = 5/6), dots the solver, four cells across the height</text>"##
    ));
    put(format!(r#"<text x="{:.1}" y="{:.1}" text-anchor="middle">distance from the clamp</text>"#, width / 2.0, height - 14.0));
    put("</svg>".to_owned());
    svg
}

/// The page: what each case expects and what it measured on this device.
fn page(gpu: &Gpu) -> String {
    let mut text = format!(
        "# Validation\n\nThe solver against formulas, on {}. `UPDATE_DOCS=1 cargo test --test cantilever` makes this page; the test suite runs the same\n\
         cases and fails where one does not hold. A tolerance is a share of what is expected, or absolute where that is 0.\n\n\
         | case | formula | source | expected | measured | tolerance | held |\n|---|---|---|---|---|---|---|\n",
        gpu.name()
    );
    for check in CASES.iter().flat_map(|case| case.run(gpu).unwrap()) {
        let formula = check.formula.replace('|', "\\|");
        let held = if check.held { "yes" } else { "no" };
        let (expected, measured, unit) = (check.expected, check.measured, check.unit);
        writeln!(
            text,
            "| {} | {formula} | {} | {expected:.6} {unit} | {measured:.6} {unit} | {} | {held} |",
            check.name, check.source, check.tolerance
        )
        .unwrap();
    }
    text + "\n![Deflection of a cantilever under its own weight: the solver's dots end 4.5 % above Timoshenko's line](media/cantilever.svg)\n"
}
