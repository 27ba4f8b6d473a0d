//! `phystalk bench [NAME]…`: how fast this device is, with a figure beside each that tells how fast it
//! was clocked meanwhile.

mod rooms;
mod whole;

use super::exit::{Failure, Kind};
use super::flags::{Flags, QualityFlag};
use super::output;
use crate::conversation::duration;
use clap::Args;
use phystalk::gpu::{Gpu, PassTime, Tier};
use serde::Serialize;

#[derive(Args, Debug)]
pub struct Arguments {
    /// mpm, sph, skin, render, sort, frame, load, edit, exec, cold, or one size of it, as mpm/100k [default: all]
    names: Vec<String>,
    /// Scene of frame, load, edit, exec and cold
    #[arg(long, value_name = "FILE", default_value = "builtin:demo")]
    scene: String,
}

/// One figure.
#[derive(Clone, Debug, Serialize)]
pub struct Figure {
    /// What was timed.
    pub name: &'static str,
    /// How much of it.
    pub size: String,
    /// Middle sample.
    pub median: f64,
    /// Fastest sample.
    pub min: f64,
    /// Slowest sample.
    pub max: f64,
    /// Of the three.
    pub unit: &'static str,
    /// On what.
    pub device: String,
    /// Milliseconds of the fixed kernel beside it: the same on two runs that compare.
    pub calibration_ms: f64,
    /// Each pass alone, with -v.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub passes: Vec<Pass>,
}

/// One label of the pass table.
#[derive(Clone, Debug, Serialize)]
pub struct Pass {
    label: &'static str,
    ms: f64,
    count: usize,
}

/// Samples in seconds, in any order.
pub struct Timing {
    /// At least one.
    pub seconds: Vec<f64>,
    /// Shares.
    pub passes: Vec<PassTime>,
}

impl Timing {
    /// Whole runs have no pass table.
    pub fn of(seconds: Vec<f64>) -> Timing {
        Timing { seconds, passes: Vec::new() }
    }
}

/// What a benchmark does on a device.
pub type Work = Box<dyn Fn(&Gpu) -> Result<Timing, Failure>>;

/// A benchmark at one size.
pub struct Job {
    /// As named on the command line.
    pub name: &'static str,
    /// `100k`, `1M at 1920x1080`.
    pub size: String,
    /// Too much for a CPU adapter, unless full quality was asked for.
    pub heavy: bool,
    /// Does it.
    pub run: Work,
}

pub fn run(arguments: &Arguments, flags: &Flags) -> Result<(), Failure> {
    let gpu = Gpu::open(&flags.device_request())?;
    let jobs: Vec<Job> = rooms::jobs().into_iter().chain(whole::jobs(&arguments.scene, flags)).collect();
    check_names(&arguments.names, &jobs)?;
    let all_sizes = gpu.tier == Tier::Gpu || flags.quality == Some(QualityFlag::Full);
    let mut left_out = 0;
    let mut figures = Vec::new();
    for job in jobs.iter().filter(|j| arguments.names.is_empty() || arguments.names.iter().any(|n| fits(n, j))) {
        if job.heavy && !all_sizes {
            left_out += 1;
            continue;
        }
        if !flags.quiet {
            output::note(format!("{} {} …", job.name, job.size));
        }
        let figure = measure(job, &gpu, flags.verbose)?;
        if !flags.json {
            output::line(line(&figure))?;
            figure.passes.iter().try_for_each(|p| output::line(format!("    {:<28} {:>10.4} ms  x{}", p.label, p.ms, p.count)))?;
        }
        figures.push(figure);
    }
    if left_out > 0 {
        output::note(format!("{left_out} larger sizes were left out on a CPU adapter; --quality full takes them too"));
    }
    if flags.json { output::json(&figures) } else { Ok(()) }
}

fn fits(name: &str, job: &Job) -> bool {
    match name.split_once('/') {
        Some((name, size)) => name == job.name && job.size.starts_with(size),
        None => name == job.name,
    }
}

fn check_names(names: &[String], jobs: &[Job]) -> Result<(), Failure> {
    match names.iter().find(|n| !jobs.iter().any(|j| fits(n, j))) {
        None => Ok(()),
        Some(wrong) => {
            let mut known: Vec<String> = jobs.iter().map(|j| j.name.to_owned()).collect();
            known.dedup();
            let hint = phystalk::spec::nearest(wrong, known.iter().map(String::as_str)).map(|n| format!("; did you mean {n}?")).unwrap_or_default();
            Err(Failure::new(Kind::Usage, format!("there is no benchmark {wrong}{hint}\nthere are {}", known.join(", "))))
        }
    }
}

fn measure(job: &Job, gpu: &Gpu, with_passes: bool) -> Result<Figure, Failure> {
    let timing = (job.run)(gpu)?;
    let mut ms: Vec<f64> = timing.seconds.iter().map(|s| s * 1e3).collect();
    ms.sort_by(f64::total_cmp);
    let passes = timing.passes.iter().filter(|_| with_passes);
    Ok(Figure {
        name: job.name,
        size: job.size.clone(),
        median: ms.get(ms.len() / 2).copied().unwrap_or(f64::NAN),
        min: ms.first().copied().unwrap_or(f64::NAN),
        max: ms.last().copied().unwrap_or(f64::NAN),
        unit: "ms",
        device: gpu.name().to_owned(),
        calibration_ms: gpu.calibrate()? * 1e3,
        passes: passes.map(|p| Pass { label: p.label, ms: p.seconds * 1e3, count: p.count }).collect(),
    })
}

fn line(figure: &Figure) -> String {
    let said = if figure.median >= 1000.0 { format!("  ({})", duration(figure.median / 1e3)) } else { String::new() };
    format!(
        "{:<7} {:<22} {:>10.4} ms  ({:.4} to {:.4})  calibration {:.3} ms{said}",
        figure.name, figure.size, figure.median, figure.min, figure.max, figure.calibration_ms
    )
}
