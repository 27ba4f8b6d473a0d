//! `phystalk doctor`: what this machine offers, and what to do where something is missing.

use super::exit::{Failure, Kind};
use super::flags::Flags;
use super::output;
use phystalk::gpu::{Gpu, Tier, list_adapters};
use serde::Serialize;
use std::io::IsTerminal;
use std::path::{Path, PathBuf};

/// All that was found.
#[derive(Debug, Serialize)]
struct Findings {
    version: &'static str,
    adapters: Vec<Adapter>,
    device: Option<Device>,
    vulkan: Vulkan,
    terminal: Terminal,
    store: Option<PathBuf>,
    window: Window,
    providers: Vec<&'static str>,
    advice: Vec<String>,
}

#[derive(Debug, Serialize)]
struct Adapter {
    name: String,
    kind: String,
    backend: String,
    driver: String,
    pci: String,
}

/// The device that runs would use.
#[derive(Debug, Serialize)]
struct Device {
    name: String,
    tier: &'static str,
    default_quality: &'static str,
    subgroup_lanes: (u32, u32),
}

/// What the Vulkan loader would find.
#[derive(Debug, Serialize)]
struct Vulkan {
    loader: Option<PathBuf>,
    drivers: Vec<PathBuf>,
}

#[derive(Debug, Serialize)]
struct Terminal {
    is_terminal: bool,
    term: Option<String>,
    multiplexer: Option<&'static str>,
    colour: bool,
}

#[derive(Debug, Serialize)]
struct Window {
    built: bool,
    display: Option<String>,
}

pub fn run(flags: &Flags) -> Result<(), Failure> {
    let opened = Gpu::open(&flags.device_request());
    let findings = examine(flags, opened.as_ref().ok());
    if flags.json {
        output::json(&findings)?;
    } else {
        output::line(report(&findings))?;
    }
    match opened {
        Ok(_) => Ok(()),
        Err(error) if flags.json => Err(Failure::new(Kind::Device, error)),
        Err(_) => Err(Failure::new(Kind::Device, "no device to run on; see the advice above")),
    }
}

fn examine(flags: &Flags, gpu: Option<&Gpu>) -> Findings {
    let variable = |name: &str| std::env::var(name).ok().filter(|v| !v.is_empty());
    let multiplexer = [("TMUX", "tmux"), ("ZELLIJ", "zellij"), ("STY", "screen")].into_iter().find(|(v, _)| variable(v).is_some()).map(|(_, n)| n);
    let (store, of_store) = super::stores::examine(flags);
    let mut findings = Findings {
        version: env!("CARGO_PKG_VERSION"),
        adapters: adapters(),
        device: gpu.map(device),
        vulkan: Vulkan { loader: vulkan_loader(), drivers: vulkan_drivers() },
        terminal: Terminal {
            is_terminal: std::io::stdout().is_terminal(),
            term: variable("TERM"),
            multiplexer,
            colour: variable("NO_COLOR").is_none(),
        },
        store,
        window: Window { built: cfg!(feature = "window"), display: variable("WAYLAND_DISPLAY").or_else(|| variable("DISPLAY")) },
        providers: vec!["phrasebook"],
        advice: Vec::new(),
    };
    findings.advice = advice(&findings).into_iter().chain(of_store).collect();
    findings
}

fn adapters() -> Vec<Adapter> {
    let describe = list_adapters().into_iter().map(|info| Adapter {
        name: info.name,
        kind: format!("{:?}", info.device_type),
        backend: info.backend.to_string(),
        driver: format!("{} {}", info.driver, info.driver_info).trim().to_owned(),
        pci: info.device_pci_bus_id,
    });
    describe.collect()
}

fn device(gpu: &Gpu) -> Device {
    let (tier, default_quality) = match gpu.tier {
        Tier::Gpu => ("gpu", "full"),
        Tier::Cpu => ("cpu", "draft"),
    };
    Device { name: gpu.name().to_owned(), tier, default_quality, subgroup_lanes: gpu.subgroup_lanes }
}

/// One sentence for each thing that could be better, the command to type included.
fn advice(findings: &Findings) -> Vec<String> {
    let mut advice = Vec::new();
    match &findings.device {
        None if findings.vulkan.loader.is_none() => {
            advice.push("install the Vulkan loader: sudo apt install libvulkan1 (dnf install vulkan-loader; pacman -S vulkan-icd-loader)".to_owned());
        }
        None => advice.push(
            "no adapter answered: install the GPU's driver, or a software one: sudo apt install mesa-vulkan-drivers \
             (dnf install mesa-vulkan-drivers; pacman -S vulkan-swrast)"
                .to_owned(),
        ),
        Some(device) if device.tier == "cpu" => {
            advice
                .push("everything runs on the CPU, at draft quality unless --quality full asks for more; a GPU is 10 to 100 times faster".to_owned());
        }
        Some(_) => {}
    }
    if findings.terminal.multiplexer.is_some() {
        advice.push("inside a terminal multiplexer the preview is made of half-blocks; outside it kitty graphics can be used".to_owned());
    }
    if findings.window.built && findings.window.display.is_none() {
        advice.push("no display: `view --window` is not available here; pictures show in the terminal and as files".to_owned());
    }
    advice
}

fn vulkan_loader() -> Option<PathBuf> {
    const FOLDERS: [&str; 6] =
        ["/usr/lib/x86_64-linux-gnu", "/usr/lib/aarch64-linux-gnu", "/usr/lib64", "/usr/lib", "/usr/local/lib", "/opt/homebrew/lib"];
    let given = std::env::var_os("LD_LIBRARY_PATH").unwrap_or_default();
    let folders = std::env::split_paths(&given).chain(FOLDERS.iter().map(PathBuf::from));
    folders.flat_map(|f| ["libvulkan.so.1", "libvulkan.dylib"].map(|n| f.join(n))).find(|p| p.exists())
}

fn vulkan_drivers() -> Vec<PathBuf> {
    let named = ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"].iter().find_map(std::env::var_os);
    if let Some(named) = named {
        return std::env::split_paths(&named).collect();
    }
    let folders = ["/etc/vulkan/icd.d", "/usr/share/vulkan/icd.d", "/usr/local/share/vulkan/icd.d"];
    let entries = folders.iter().filter_map(|f| std::fs::read_dir(Path::new(f)).ok()).flatten().filter_map(Result::ok);
    let mut drivers: Vec<PathBuf> = entries.map(|e| e.path()).filter(|p| p.extension().is_some_and(|e| e == "json")).collect();
    drivers.sort();
    drivers
}

fn report(findings: &Findings) -> String {
    let path = |p: &Option<PathBuf>| p.as_ref().map_or_else(|| "not found".to_owned(), |p| p.display().to_string());
    let mut rows = vec![("phystalk", findings.version.to_owned())];
    match &findings.device {
        Some(d) => rows.push(("device", format!("{} ({}; quality {} unless said otherwise)", d.name, d.tier, d.default_quality))),
        None => rows.push(("device", "none".to_owned())),
    }
    let shown = |a: &Adapter| {
        [&a.name, &a.kind, &a.backend, &a.driver, &a.pci].into_iter().filter(|s| !s.is_empty()).cloned().collect::<Vec<_>>().join(" · ")
    };
    rows.extend(findings.adapters.iter().map(|a| ("adapter", shown(a))));
    rows.push(("vulkan loader", path(&findings.vulkan.loader)));
    rows.extend(findings.vulkan.drivers.iter().map(|d| ("vulkan driver", d.display().to_string())));
    let terminal = &findings.terminal;
    let kind = terminal.term.clone().unwrap_or_else(|| "unknown".to_owned());
    let inside = terminal.multiplexer.map(|m| format!(" inside {m}")).unwrap_or_default();
    rows.push(("terminal", format!("{kind}{inside}{}", if terminal.colour { "" } else { ", without colour" })));
    let window = match (findings.window.built, &findings.window.display) {
        (false, _) => "not built in".to_owned(),
        (true, None) => "no display".to_owned(),
        (true, Some(display)) => format!("display {display}"),
    };
    rows.push(("window", window));
    rows.push(("store", findings.store.as_ref().map_or_else(|| "none yet; made when first needed".to_owned(), |p| p.display().to_string())));
    rows.push(("words", "phrasebook, offline; language models are not built yet".to_owned()));
    rows.extend(findings.advice.iter().map(|a| ("advice", a.clone())));
    output::table(&rows.into_iter().map(|(what, found)| vec![what.to_owned(), found]).collect::<Vec<_>>())
}
