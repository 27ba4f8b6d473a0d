//! The page of all checks, with a plot for each that has one.

use super::super::exit::Failure;
use super::{number, plot, tolerance};
use phystalk::solver::validate::Check;
use std::fmt::Write;
use std::fs;
use std::path::Path;

/// Writes the page, and its plots into `media/` beside it.
pub fn write(file: &Path, device: &str, checks: &[Check]) -> Result<(), Failure> {
    let told = |path: &Path, error: std::io::Error| Failure::other(format!("{} cannot be written: {error}", path.display()));
    let media = file.parent().unwrap_or(Path::new("")).join("media");
    fs::create_dir_all(&media).map_err(|e| told(&media, e))?;
    for (check, plot) in checks.iter().filter_map(|c| Some((c, c.plot.as_ref()?))) {
        let path = media.join(picture(check));
        fs::write(&path, plot::svg(plot)).map_err(|e| told(&path, e))?;
    }
    fs::write(file, page(device, checks)).map_err(|e| told(file, e))
}

fn page(device: &str, checks: &[Check]) -> String {
    let mut text = format!(
        "# Validation\n\nThe solver against formulas and published data, on {device}. `phystalk validate --page docs/validation.md` makes this page; the test suite runs the same\n\
         cases and fails where one does not hold. A tolerance is a share of what is expected, or absolute where that is 0.\n\n\
         | check | formula | source | expected | measured | tolerance | held |\n|---|---|---|---|---|---|---|\n"
    );
    for check in checks {
        let cells = [
            check.name.to_owned(),
            check.formula.replace('|', "\\|"),
            check.source.to_owned(),
            format!("{} {}", number(check.expected), check.unit),
            format!("{} {}", number(check.measured), check.unit),
            tolerance(check),
            if check.held { "yes" } else { "**no**" }.to_owned(),
        ];
        let cells = cells.each_ref().map(|c| c.trim_end());
        // Writing to a String cannot fail.
        let _ = writeln!(text, "| {} |", cells.join(" | "));
    }
    for (check, plot) in checks.iter().filter_map(|c| Some((c, c.plot.as_ref()?))) {
        let _ = write!(text, "\n{}.\n\n![{}](media/{})\n", plot.caption, check.name, picture(check));
    }
    text
}

/// `v5-cantilever-tip.svg`
fn picture(check: &Check) -> String {
    let words: Vec<String> = check.name.split(|c: char| !c.is_ascii_alphanumeric()).filter(|w| !w.is_empty()).map(str::to_ascii_lowercase).collect();
    format!("{}.svg", words.join("-"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use phystalk::solver::validate::Plot;

    #[test]
    fn a_page_has_a_row_a_check_and_its_plot_beside_it() {
        let plot = Plot { caption: "It falls".to_owned(), x: "t, s", y: "z, m", expected: vec![[0.0, 0.0], [1.0, 4.9]], measured: vec![[1.0, 4.8]] };
        let check = Check {
            name: "V1 free fall",
            formula: "|g| t^2 / 2",
            source: "Galilei",
            expected: 4.9,
            measured: 4.8,
            tolerance: 0.05,
            unit: "m",
            held: true,
            plot: Some(plot),
        };
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("validation.md");
        write(&file, "a device", &[check]).unwrap();
        let text = fs::read_to_string(&file).unwrap();
        assert!(text.contains("| V1 free fall | \\|g\\| t^2 / 2 | Galilei | 4.9000 m | 4.8000 m | 5 % | yes |"), "{text}");
        assert!(text.contains("![V1 free fall](media/v1-free-fall.svg)"), "{text}");
        let svg = fs::read_to_string(folder.path().join("media/v1-free-fall.svg")).unwrap();
        assert_eq!(svg.matches("<circle").count(), 1);
        assert_eq!(svg.matches("<polyline").count(), 1);
    }
}
