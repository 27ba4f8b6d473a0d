//! The solver's kernels, and their compiled set.

use super::constants;
use crate::gpu::{Access, Gpu, Kernel, KernelSource};
use Access::{Read, Write};

macro_rules! shader {
    ($name:literal) => {
        (concat!("solver/", $name, ".wgsl"), include_str!(concat!("../../shaders/solver/", $name, ".wgsl")))
    };
}

/// Bytes of the immediates of a pass of the substep.
const SUBSTEP: u32 = 16;
/// Bytes of the immediates of a kick.
const KICK: u32 = 32;

fn source(label: &'static str, parts: Vec<(&'static str, &'static str)>, bindings: &[Access], immediate_bytes: u32) -> KernelSource {
    let mut all = vec![shader!("common")];
    all.extend(parts);
    KernelSource { label, entry: "main", parts: all, constants: constants::all(), bindings: bindings.to_vec(), immediate_bytes }
}

/// Every pass of the solver, for validation and keys.
pub fn kernels() -> Vec<KernelSource> {
    sources().into()
}

/// In the order of [`Passes`].
fn sources() -> [KernelSource; 18] {
    [
        source("solver.bin", vec![shader!("control"), shader!("cell"), shader!("bin")], &[Read, Read, Write, Write, Write], 0),
        source("solver.scan_sums", vec![shader!("scan"), shader!("scan_sums")], &[Read, Read, Write], 0),
        source("solver.scan_blocks", vec![shader!("scan"), shader!("scan_blocks")], &[Read, Write, Read, Write, Write, Write], 0),
        source("solver.scan_cells", vec![shader!("scan"), shader!("scan_cells")], &[Read, Read, Read, Read, Write], 0),
        source("solver.scatter", vec![shader!("cell"), shader!("scatter")], &[Read, Read, Read, Write, Read, Write], 0),
        source("solver.order", vec![shader!("order")], &[Read, Read, Read, Read, Write, Write], 0),
        source(
            "solver.stress",
            vec![shader!("control"), shader!("substep"), shader!("material"), shader!("particle"), shader!("particle_write"), shader!("stress")],
            &[Read, Write, Read, Write],
            SUBSTEP,
        ),
        source(
            "solver.p2g",
            vec![shader!("control"), shader!("substep"), shader!("particle"), shader!("contact"), shader!("p2g")],
            &[Read, Read, Read, Read, Write, Write, Write],
            SUBSTEP,
        ),
        source(
            "solver.grid",
            vec![shader!("control"), shader!("substep"), shader!("contact"), shader!("grid")],
            &[Read, Read, Read, Read, Write, Write, Write, Write],
            SUBSTEP,
        ),
        source(
            "solver.g2p",
            vec![
                shader!("control"),
                shader!("substep"),
                shader!("material"),
                shader!("particle"),
                shader!("particle_write"),
                shader!("contact"),
                shader!("gather"),
                shader!("g2p"),
            ],
            &[Read, Write, Write, Read, Read, Read, Write],
            SUBSTEP,
        ),
        source("solver.measure", vec![shader!("control"), shader!("particle"), shader!("measure")], &[Read, Read, Read, Write], 0),
        source("solver.kick", vec![shader!("particle"), shader!("particle_write"), shader!("kick")], &[Read, Write, Read], KICK),
        source(
            "solver.prestress_gather",
            vec![
                shader!("control"),
                shader!("substep"),
                shader!("material"),
                shader!("particle"),
                shader!("particle_write"),
                shader!("prestress"),
                shader!("gather"),
                shader!("prestress_gather"),
            ],
            &[Read, Write, Write, Read, Write],
            SUBSTEP,
        ),
        source(
            "solver.prestress_residual",
            vec![
                shader!("control"),
                shader!("substep"),
                shader!("contact"),
                shader!("prestress"),
                shader!("prestress_sum"),
                shader!("prestress_residual"),
            ],
            &[Read, Read, Read, Read, Write, Write, Write, Write, Write, Write],
            SUBSTEP,
        ),
        source(
            "solver.prestress_product",
            vec![shader!("control"), shader!("substep"), shader!("prestress"), shader!("prestress_sum"), shader!("prestress_product")],
            &[Read, Read, Write, Write, Write, Write, Write],
            SUBSTEP,
        ),
        source(
            "solver.prestress_control",
            vec![shader!("substep"), shader!("prestress"), shader!("prestress_sum"), shader!("prestress_control")],
            &[Read, Read, Read, Write],
            SUBSTEP,
        ),
        source(
            "solver.prestress_update",
            vec![shader!("substep"), shader!("prestress"), shader!("prestress_sum"), shader!("prestress_update")],
            &[Read, Read, Read, Write, Write, Write],
            SUBSTEP,
        ),
        source("solver.frame", vec![shader!("particle"), shader!("frame")], &[Read, Read, Read, Read, Write, Write], 0),
    ]
}

/// Shader text of all passes, for the keys of stages.
pub fn shader_text() -> String {
    kernels().iter().map(KernelSource::wgsl).collect()
}

/// The compiled passes.
#[derive(Clone, Debug)]
pub(super) struct Passes {
    pub bin: Kernel,
    pub scan_sums: Kernel,
    pub scan_blocks: Kernel,
    pub scan_cells: Kernel,
    pub scatter: Kernel,
    pub order: Kernel,
    pub stress: Kernel,
    pub p2g: Kernel,
    pub grid: Kernel,
    pub g2p: Kernel,
    pub measure: Kernel,
    pub kick: Kernel,
    pub prestress_gather: Kernel,
    pub prestress_residual: Kernel,
    pub prestress_product: Kernel,
    pub prestress_control: Kernel,
    pub prestress_update: Kernel,
    pub frame: Kernel,
}

impl Passes {
    pub fn new(gpu: &Gpu) -> Passes {
        let [
            bin,
            scan_sums,
            scan_blocks,
            scan_cells,
            scatter,
            order,
            stress,
            p2g,
            grid,
            g2p,
            measure,
            kick,
            prestress_gather,
            prestress_residual,
            prestress_product,
            prestress_control,
            prestress_update,
            frame,
        ] = sources().map(|source| gpu.kernel(&source));
        Passes {
            bin,
            scan_sums,
            scan_blocks,
            scan_cells,
            scatter,
            order,
            stress,
            p2g,
            grid,
            g2p,
            measure,
            kick,
            prestress_gather,
            prestress_residual,
            prestress_product,
            prestress_control,
            prestress_update,
            frame,
        }
    }
}
