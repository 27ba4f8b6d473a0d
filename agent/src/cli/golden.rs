//! `phystalk golden SPEC|VERSION --frames … --dir DIR`: a golden-image test of a user's own scene.

use super::exit::{Failure, Kind};
use super::flags::Flags;
use super::{output, setup, signals, stores};
use clap::Args;
use phystalk::export::{Comparison, Raster, Tolerance, compare, read_png, write_png};
use phystalk::stages::RunOptions;
use phystalk::{Frame, Progress, Sink, Stop};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

#[derive(Args, Debug)]
pub struct Arguments {
    /// A spec (.toml, .json) or a version, as v3
    #[arg(value_parser = setup::file_argument())]
    what: String,
    /// Which frames to compare, as 0,25,50
    #[arg(long, value_name = "N,N…", value_delimiter = ',', required = true)]
    frames: Vec<u32>,
    /// Folder of the expected pictures, named as 0025.png
    #[arg(long, value_name = "DIR")]
    dir: PathBuf,
    /// Write the pictures instead of comparing
    #[arg(long)]
    update: bool,
    /// Least peak signal-to-noise ratio, dB
    #[arg(long, value_name = "DB", default_value_t = Tolerance::default().psnr_db)]
    psnr: f64,
    /// Largest share of pixels that may visibly differ, 0 to 1
    #[arg(long, value_name = "SHARE", default_value_t = Tolerance::default().differing_share)]
    share: f64,
}

pub fn run(arguments: &Arguments, flags: &Flags) -> Result<(), Failure> {
    let pictures = draw(arguments, flags)?;
    if arguments.update {
        return update(arguments, flags, &pictures);
    }
    let tolerance = Tolerance { psnr_db: arguments.psnr, differing_share: arguments.share, ..Tolerance::default() };
    let beside = flags.out.clone().unwrap_or_else(|| PathBuf::from("phystalk-out").join("golden"));
    let mut results = Vec::new();
    for (index, frame) in &pictures {
        results.push(check(*index, frame, arguments, &beside, tolerance)?);
    }
    let failed = results.iter().filter(|r| !r.held).count();
    if flags.json {
        let frames: Vec<&Value> = results.iter().map(|r| &r.json).collect();
        output::json(&json!({ "held": failed == 0, "tolerance": tolerance, "frames": frames }))?;
    } else {
        results.iter().try_for_each(|r| output::line(&r.text))?;
        output::line(format!(
            "tolerance: at least {} dB, at most {} % of the pixels off by more than {} of 255",
            tolerance.psnr_db,
            tolerance.differing_share * 100.0,
            tolerance.visible
        ))?;
    }
    match failed {
        0 => Ok(()),
        n => Err(Failure::new(
            Kind::Expectation,
            format!("{n} of {} frames differ from {}; look at {}", results.len(), arguments.dir.display(), beside.display()),
        )),
    }
}

/// Runs the spec and keeps the frames that were asked for.
fn draw(arguments: &Arguments, flags: &Flags) -> Result<BTreeMap<u32, Frame>, Failure> {
    let (spec, _) = setup::spec_by_name(&arguments.what, flags)?;
    let camera = if setup::is_file(&arguments.what) { None } else { stores::session(flags)?.1.camera() };
    let stop = Stop::default();
    let _guard = signals::stop_on_signal(&stop);
    let mut keeper = Keeper { wanted: arguments.frames.clone(), kept: BTreeMap::new() };
    let options = RunOptions { render: true, camera, ..flags.run_options() };
    let report = setup::engine(flags, stores::of_results(flags)?).run(&spec, Path::new(""), &options, None, &mut keeper, &stop)?;
    if let Some(missing) = arguments.frames.iter().find(|f| !keeper.kept.contains_key(f)) {
        return Err(Failure::other(format!("there is no frame {missing}: the last one is {}", report.metrics.frames.saturating_sub(1))));
    }
    Ok(keeper.kept)
}

fn file(folder: &Path, index: u32) -> PathBuf {
    folder.join(format!("{index:04}.png"))
}

fn update(arguments: &Arguments, flags: &Flags, pictures: &BTreeMap<u32, Frame>) -> Result<(), Failure> {
    let mut written = Vec::new();
    for (index, frame) in pictures {
        let path = file(&arguments.dir, *index);
        write_png(&path, frame.size, &frame.rgba8)?;
        written.push(path);
    }
    if flags.json {
        return output::json(&json!({ "updated": written }));
    }
    written.iter().try_for_each(|p| output::line(format!("wrote {}", p.display())))
}

struct Checked {
    held: bool,
    text: String,
    json: Value,
}

/// Compares one frame; where it differs, the actual and the difference picture are written.
fn check(index: u32, frame: &Frame, arguments: &Arguments, beside: &Path, tolerance: Tolerance) -> Result<Checked, Failure> {
    let golden = file(&arguments.dir, index);
    if !golden.exists() {
        return Err(Failure::new(Kind::Expectation, format!("{} is not there; --update writes it from what is drawn now", golden.display())));
    }
    let actual = Raster { size: frame.size, rgba8: frame.rgba8.to_vec() };
    let result = compare(&actual, &read_png(&golden)?, tolerance);
    let mut described = serde_json::to_value(&result).map_err(Failure::other)?;
    described["frame"] = json!(index);
    let mut text = format!("{index:04} {}: {}", if result.held { "ok" } else { "differs" }, result.sentence());
    if !result.held {
        let (actual_path, difference_path) = write_difference(index, &actual, &result, beside)?;
        text += &format!("\n     actual {}", actual_path.display());
        described["actual"] = json!(actual_path);
        if let Some(path) = difference_path {
            text += &format!("\n     difference {}", path.display());
            described["difference"] = json!(path);
        }
    }
    Ok(Checked { held: result.held, text, json: described })
}

fn write_difference(index: u32, actual: &Raster, result: &Comparison, beside: &Path) -> Result<(PathBuf, Option<PathBuf>), Failure> {
    let path = |what: &str| beside.join(format!("{index:04}-{what}.png"));
    write_png(&path("actual"), actual.size, &actual.rgba8)?;
    let difference = match &result.difference {
        Some(picture) => {
            write_png(&path("difference"), picture.size, &picture.rgba8)?;
            Some(path("difference"))
        }
        None => None,
    };
    Ok((path("actual"), difference))
}

/// A sink that keeps some frames.
struct Keeper {
    wanted: Vec<u32>,
    kept: BTreeMap<u32, Frame>,
}

impl Sink for Keeper {
    fn progress(&mut self, _: Progress) {}
    fn frame(&mut self, frame: Frame) {
        if self.wanted.contains(&frame.index) {
            self.kept.insert(frame.index, frame);
        }
    }
    fn warning(&mut self, text: &str) {
        output::note(format!("warning: {text}"));
    }
}
