//! Flags that every command takes.

use super::exit::{Failure, Kind};
use clap::{Args, ValueEnum};
use phystalk::gpu::DeviceRequest;
use phystalk::stages::{Quality, RunOptions};
use std::path::PathBuf;

/// Common flags; each command uses those that mean something to it.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Common options")]
pub struct Flags {
    /// Print one JSON object (`exec`: one JSON object a line) on standard output
    #[arg(long, global = true)]
    pub json: bool,
    /// Folder for pictures, metrics and specs
    #[arg(long, global = true, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Let the files of another session in the output folder be replaced
    #[arg(long, global = true)]
    pub replace: bool,
    /// Folder that keeps versions and results [default: `.phystalk` here or above, else made here]
    #[arg(long, global = true, value_name = "DIR")]
    pub store: Option<PathBuf>,
    /// Work on this session [default: a new one for `exec` and the REPL, else the last one that was used in this folder]
    #[arg(long, global = true, value_name = "NAME")]
    pub session: Option<String>,
    /// Go on with the last session that was used in this folder
    #[arg(long = "continue", global = true)]
    pub resume: bool,
    /// Who understands words: `phrasebook` is built in
    #[arg(long, global = true, value_name = "NAME")]
    pub provider: Option<String>,
    /// Model of the provider
    #[arg(long, global = true, value_name = "NAME")]
    pub model: Option<String>,
    /// Never use the network (nothing does yet)
    #[arg(long, global = true)]
    pub offline: bool,
    /// How fine to simulate and draw [default: full on a GPU, draft on a CPU adapter]
    #[arg(long, global = true, value_name = "QUALITY")]
    pub quality: Option<QualityFlag>,
    /// Size of the pictures, as 1280x720
    #[arg(long, global = true, value_name = "WxH", value_parser = parse_size)]
    pub size: Option<[u32; 2]>,
    /// Use the adapter whose name or PCI address contains this (see doctor)
    #[arg(long, global = true, value_name = "SUBSTRING")]
    pub device: Option<String>,
    /// Use a software adapter even where there is a GPU
    #[arg(long, global = true)]
    pub cpu: bool,
    /// Change one value of the spec, as object.vase.material.young_pa=3e4; may be repeated
    #[arg(long, global = true, value_name = "PATH=VALUE")]
    pub set: Vec<String>,
    /// Simulate and measure, draw nothing
    #[arg(long, global = true)]
    pub no_render: bool,
    /// Say only results and errors
    #[arg(short, long, global = true)]
    pub quiet: bool,
    /// Say more
    #[arg(short, long, global = true)]
    pub verbose: bool,
}

/// `--quality`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum QualityFlag {
    /// 24 cells along the longest side, 640x360
    Draft,
    /// 64 cells along the longest side, 1280x720
    Full,
}

impl QualityFlag {
    /// As written on the command line.
    pub fn as_str(self) -> &'static str {
        match self {
            QualityFlag::Draft => "draft",
            QualityFlag::Full => "full",
        }
    }
}

impl Flags {
    /// Which device to open.
    pub fn device_request(&self) -> DeviceRequest {
        DeviceRequest { contains: self.device.clone(), cpu: self.cpu }
    }

    /// Choices of a run, outside the spec.
    pub fn run_options(&self) -> RunOptions {
        let quality = self.quality.map(|q| match q {
            QualityFlag::Draft => Quality::Draft,
            QualityFlag::Full => Quality::Full,
        });
        RunOptions { quality, size: self.size, render: !self.no_render, camera: None }
    }

    /// Refuses a provider that is not there; words are never guessed by another one.
    pub fn check_provider(&self) -> Result<(), Failure> {
        match (self.provider.as_deref(), self.model.as_deref()) {
            (None | Some("phrasebook"), None) => Ok(()),
            (None | Some("phrasebook"), Some(model)) => Err(Failure::new(
                Kind::NoModel,
                format!("no provider offers the model \"{model}\": language models are not built yet; leave --model out to use the phrasebook"),
            )),
            (Some(provider), _) => Err(Failure::new(
                Kind::NoModel,
                format!(
                    "no provider is called \"{provider}\": only the phrasebook is built, which needs neither a model nor a key; leave --provider out"
                ),
            )),
        }
    }
}

/// `1280x720`, each side 16 to 8192.
pub fn parse_size(text: &str) -> Result<[u32; 2], String> {
    let expected = || format!("\"{text}\" is not a size: expected WIDTHxHEIGHT in pixels, each 16 to 8192, as 1280x720");
    let (width, height) = text.split_once(['x', 'X', '×']).ok_or_else(expected)?;
    let side = |s: &str| s.trim().parse::<u32>().ok().filter(|v| (16..=8192).contains(v)).ok_or_else(expected);
    Ok([side(width)?, side(height)?])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes() {
        assert_eq!(parse_size("1280x720"), Ok([1280, 720]));
        assert_eq!(parse_size("64×32"), Ok([64, 32]));
        for bad in ["1280", "0x10", "axb", "99999x10", "-1x20"] {
            assert!(parse_size(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn only_the_phrasebook_is_there() {
        let with = |provider: Option<&str>, model: Option<&str>| Flags {
            provider: provider.map(str::to_owned),
            model: model.map(str::to_owned),
            ..Flags::default()
        };
        assert!(with(None, None).check_provider().is_ok());
        assert!(with(Some("phrasebook"), None).check_provider().is_ok());
        for flags in [with(Some("openai"), None), with(None, Some("large")), with(Some("openai"), Some("large"))] {
            assert_eq!(flags.check_provider().unwrap_err().kind, Kind::NoModel);
        }
    }
}
