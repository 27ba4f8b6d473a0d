//! `phystalk scene info FILE` and `phystalk convert IN OUT`.

use super::exit::{Failure, Kind};
use super::flags::Flags;
use super::output;
use clap::{Args, Subcommand};
use phystalk::scene::{self, SceneInfo};
use serde_json::json;
use std::path::PathBuf;

#[derive(Args, Debug)]
#[command(args_conflicts_with_subcommands = true, arg_required_else_help = true)]
pub struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,
    /// Splat file: the same as `info FILE`
    file: Option<PathBuf>,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Format, count, degree of the spherical harmonics, bounds, which way is up, floaters
    Info {
        /// Splat file, .ply or .splat
        file: PathBuf,
    },
}

#[derive(Args, Debug)]
pub struct ConvertArguments {
    /// Splat file to read
    input: PathBuf,
    /// Splat file to write, .ply or .splat
    output: PathBuf,
}

pub fn run(arguments: &Arguments, flags: &Flags) -> Result<(), Failure> {
    let named = arguments.command.as_ref().map(|Command::Info { file }| file);
    let Some(file) = named.or(arguments.file.as_ref()) else {
        return Err(Failure::new(Kind::Usage, "which file? phystalk scene info FILE.ply"));
    };
    let loaded = scene::read(file)?;
    loaded.warnings.iter().filter(|_| !flags.quiet).for_each(|w| output::note(format!("warning: {w}")));
    let info = scene::info(&loaded);
    if flags.json { output::json(&info) } else { output::line(report(&info)) }
}

fn report(info: &SceneInfo) -> String {
    let point = |p: [f32; 3]| format!("({:.3}, {:.3}, {:.3})", p[0], p[1], p[2]);
    let size: Vec<f32> = (0..3).map(|i| info.bounds.high[i] - info.bounds.low[i]).collect();
    let rows = [
        ("gaussians", info.gaussians.to_string()),
        ("format", name(&info.format)),
        ("sh degree", info.sh_degree.to_string()),
        ("bounds", format!("{} to {}", point(info.bounds.low), point(info.bounds.high))),
        ("size", format!("{:.3} x {:.3} x {:.3}, units of the file", size[0], size[1], size[2])),
        ("up", format!("{} ({})", name(&info.up_guess.axis), info.up_guess.why)),
        ("floaters", format!("{} isolated, left out of the solid", info.floaters)),
    ];
    output::table(&rows.map(|(what, found)| vec![what.to_owned(), found]))
}

/// A unit variant as files spell it.
fn name(value: &impl serde::Serialize) -> String {
    serde_json::to_value(value).ok().and_then(|v| v.as_str().map(str::to_owned)).unwrap_or_default()
}

/// Writes a scene in the format of the output's name.
pub fn convert(arguments: &ConvertArguments, flags: &Flags) -> Result<(), Failure> {
    let loaded = scene::read(&arguments.input)?;
    let lost = scene::write(&arguments.output, &loaded.gaussians)?;
    if flags.json {
        return output::json(
            &json!({ "gaussians": loaded.gaussians.len(), "output": phystalk::spec::file_name::encode(&arguments.output), "lost": lost, "warnings": loaded.warnings }),
        );
    }
    loaded.warnings.iter().filter(|_| !flags.quiet).for_each(|w| output::note(format!("warning: {w}")));
    lost.iter().filter(|_| !flags.quiet).for_each(|l| output::note(format!("lost: {l}")));
    output::line(format!("{} Gaussians -> {}", loaded.gaussians.len(), arguments.output.display()))
}
