//! The solver's numbers, in one place; WGSL gets them from here.

use super::substance;
use crate::gpu::Constant;

/// Threads a workgroup of the passes over particles. A multiple of every subgroup size.
pub const WORKGROUP: u32 = 128;
/// Threads a workgroup of the passes over a block's particles.
pub const TILE_LANES: u32 = 256;
/// Fewer particles than this are spread over more workgroups.
pub const FEW_PARTICLES: usize = 60_000;
/// Threads a workgroup of the scans; one for each cell of a block.
pub const SCAN_LANES: u32 = 64;
/// Blocks that each thread of a scan sums alone.
pub const SCAN_RUN: u32 = 16;
/// Workgroups along x of a pass over active blocks; more go along y.
pub const GROUPS_ACROSS: u32 = 32_768;
/// Cells that what is fastest may go in a substep.
pub const CFL: f32 = 0.4;
/// Share that a substep takes of what is stable for a particle alone on its nodes.
pub const BREATH: f32 = 0.7;
/// Modulus that bounds a substep, over the bulk modulus times three: see `step_modulus` in `substance.wgsl`.
pub const BREATHING: f32 = (CFL / BREATH) * (CFL / BREATH);
/// Newton steps of the polar decomposition.
pub const POLAR_STEPS: u32 = 5;
/// det F below which the polar decomposition takes the form that survives inversion.
pub const FLAT: f32 = 0.1;
/// Turns of that form.
pub const FLAT_STEPS: u32 = 48;
/// Neo-Hookean ln J goes no lower than ln of this.
pub const J_FLOOR: f32 = 0.05;
/// A particle below or above these det F makes its object suspect when a segment fails.
pub const J_LEAST: f32 = 0.05;
/// See [`J_LEAST`].
pub const J_MOST: f32 = 20.0;
/// Largest norm of F, sqrt(3) at rest: a stretch by seven, or by four every way.
pub const F_MOST: f32 = 7.0;
/// Steps of the gap in a contact mark.
pub const GAP_STEPS: f32 = 1_048_576.0;
/// In a contact mark: the particle slides without Coulomb friction.
pub const SLIPS: u32 = 1024;
/// Contact is marked from this far off, in cells: a particle moves less in a substep.
pub const REACH_CELLS: f32 = 0.75;
/// Rest offsets of sampled particles end here, in cells: standing on its support, a particle is
/// about that far from it.
pub const REST_CELLS: f32 = 0.25;
/// Captured things that stand up to this far above their support count as touching it, in cells.
pub const REST_CELLS_MAX: f32 = 1.0;
/// A contribution or sum in fixed point beyond this trips the watch.
pub const SUM_LIMIT: f32 = 536_870_912.0;
/// Bits of the heaviest particle's mass, and of the largest momentum that a particle hands on, in the
/// fixed point of the grid: 32 of them fit a node, four times what a body at rest brings together.
pub const FIXED_BITS: u32 = 26;
/// Scales of momentum are made for at least this speed, m/s, and for what a substep brings to what is at rest.
pub const LEAST_SPEED_M_S: f32 = 1e-3;
/// Bits given up at each retry after a node held more.
pub const FIXED_BITS_RETREAT: u32 = 2;
/// Cells that a particle may travel between two sorts.
pub const SLACK_CELLS: i32 = 1;
/// Where workgroups go by block: within half of it particles stay in the tile.
pub const BLOCK_SLACK_CELLS: i32 = 2;
/// Share of that by which a surface may push out what stands inside it: speeds take up to half.
pub const PUSH_SHARE: f32 = 0.25;
/// A node whose nearest particle is within this of its rest offset stands on its support, in cells. No
/// more than the rounding of marks: what is a hair above it would fall by that hair.
pub const TOUCHING_CELLS: f32 = 1e-4;
/// A node that pulls at its support by more than this share of its weight lets go.
pub const RELEASE: f32 = 0.02;
/// Rounds, and the share of each step, of the search for the stretch that carries a stress. A share
/// of 0.6 converges for principal stretches of 0.7 to 1.6.
pub const CARRY_STEPS: u32 = 32;
/// See [`CARRY_STEPS`].
pub const CARRY_SHARE: f32 = 0.6;
/// Largest entry of F - I that the search comes to.
pub const CARRY_MOST: f32 = 0.45;
/// Pseudo mass, in fixed-point units, below which a node of the prestress counts as this heavy: a
/// thousandth of the heaviest particle's.
pub const LIGHTEST: f32 = 65_536.0;
/// Kind of substance that is a liquid of smoothed particles.
pub const SPH_LIQUID: u32 = substance::SPH_LIQUID;
/// Counters of the smoothed particles' errors, one a round; the last is the stiffest viscous coupling.
pub const SPH_SLOTS: u32 = 32;
/// Steps a cell of the places that the search for neighbours first sees: ten bits hold four cells.
pub const COARSE_STEPS: f32 = 256.0;
/// Square of how many of them a neighbour may be away: a cell, and four for the rounding of both places, of which they
/// take two and windows up to 40 000 cells wide the rest.
pub const COARSE_REACH: i32 = 260 * 260;
/// Rounds of pressures made in any case.
pub const SPH_LEAST_ROUNDS: u32 = 2;
/// Share of a Jacobi step of the pressures: with momentum, more than half of one does not settle.
pub const SPH_RELAX: f32 = 0.4;
/// Of the kernel between a liquid and a solid particle: one of a cubic lattice half a spacing from a solid whose
/// lattice goes on from its own finds the density that it misses, 0.150, and twice the gradient, 2.04.
pub const SOLID_STRENGTH: f32 = 6.48;
/// Momentum that those steps keep, at most.
pub const MOMENTUM: f32 = 0.9;
/// Mean relative change of density in a substep that is small enough: [`DRIFT_SHARE`] keeps a density that changes
/// so within 5e-4.
pub const TOLERATED: f32 = 1e-4;
/// Share of an excess of density that a substep takes back. All at once would shake what is at rest.
pub const DRIFT_SHARE: f32 = 0.2;
/// Factor of the viscous force between pairs. 2 (d + 2) = 10 makes the viscosity of a flow that neighbours
/// follow exactly (Monaghan 2005); they give way to each other, which leaves 0.43 of it in channels 10 to 24 particles
/// wide and at 50 to 1000 Pa s: of that, the middle of what these channels ask.
pub const VISCOUS: f32 = 23.2;
/// Of walls, which do not give way.
pub const WALL_VISCOUS: f32 = 10.0;
/// Ratio of the ends of the viscous spectrum that implicit rounds are made for at most.
pub const VISCOUS_RANGE: f32 = 2400.0;
/// Viscosity of unresolved eddies, as a share of density, cell and the speed at which neighbours part.
pub const EDDIES: f32 = 0.04;
/// Most that pairs brake, over [`VISCOUS`] and viscosity / (density cell^2): Gershgorin's bound where particles are as dense as at rest.
pub const VISCOUS_BOUND: f32 = 24.0;
/// Viscosity of eddies, over density cell^2 / substep, at most: what pairs brake then stays stable.
pub const EDDIES_MOST: f32 = 1.0 / (VISCOUS_BOUND * VISCOUS);
/// An excess of density is made good no faster than this, 1/s: what overlaps parts without flying off.
pub const THIN_OUT: f32 = 25.0;
/// What is too dense from the start thins out as if springs of this over a cell pulled its excess down: little beside weight,
/// and without a jerk.
pub const EASE_OUT_M_S2: f32 = 8.0;
/// Gradient of density, times the cell, from which on a particle counts to a liquid's surface.
pub const SURFACE_FROM: f32 = 0.25;
/// And at which it does wholly.
pub const SURFACE_TO: f32 = 0.6;
/// Twice the part of the area over volume times that gradient, 2 / 0.51 where the outermost layer has 1.02; by 1.68 more, for
/// a surface under tension has fewer neighbours than a lattice and does not follow as one: by V21 and V22.
pub const TENSION: f32 = 1.68 * 3.92;
/// Levers of a particle's pulls count for at least this: 1.09 on a lattice. What has few neighbours pulls them less.
pub const LEVERS_LEAST: f32 = 0.3;
/// Viscosity of a surface under tension, over sqrt(tension density cell).
pub const SKIN_CALM: f32 = 0.115;
/// Solids and walls push a liquid with tension off when nearer than this, in cells, and pull when farther apart.
pub const PULL_ZERO: f32 = 0.44;
/// Of that pull, such that (pi / 8) int q^4 pull dq = 1 over pull = this (1 - q)^2 (q - [`PULL_ZERO`]).
pub const PULL: f32 = 8.0 / (std::f32::consts::PI * (1.0 / 168.0 - PULL_ZERO / 105.0));
/// Share of it that they pull by: half the cosine of the angle of contact. Water wets most things at about 60 degrees.
pub const WETTING: f32 = 0.25;

/// Lame's lambda over mu from which on a solid's changes of volume are evened over each cell: Poisson's ratio 0.41.
pub const EVEN_FROM: f32 = 4.5;
/// The largest change of ln J between two sorts that is evened.
pub const EVEN_MOST: f32 = 0.25;
/// Fixed-point units of a cell's volume; 128 of them fit a cell.
pub const VOLUME_UNITS: f32 = 16_777_216.0;
/// And of a cell's volume times a gain of ln J by 1: 64 cells' volumes at [`EVEN_MOST`] fit.
pub const GAIN_UNITS: f32 = 134_217_728.0;

/// Sweeps of the singular values, each over all three pairs of columns; most matrices take three.
pub const SVD_SWEEPS: u32 = 6;
/// Logarithmic laws follow stretches from this.
pub const STRETCH_LEAST: f32 = 0.05;
/// To this.
pub const STRETCH_MOST: f32 = 20.0;
/// Share of its yield stress that softening leaves.
pub const YIELD_FLOOR: f32 = 0.01;
/// ln of the volume that sand takes up while loose, at most: what flew apart farther does not come
/// together as one.
pub const LOOSE_MOST: f32 = 0.4;
/// Packing of snow, det of the plastic part of F, goes no lower: packed corners would harden without
/// limit.
pub const PACKING_LEAST: f32 = 0.6;
/// Nor higher.
pub const PACKING_MOST: f32 = 20.0;
/// Fields bring nothing beyond this speed, m/s: the fastest that a spec may ask for.
pub const FIELD_SPEED: f32 = crate::spec::limits::SPEED_M_S as f32;
/// The largest change of a field over one substep, in shares of what it depends on, that is resolved.
pub const FIELD_STIFFEST: f32 = 1e4;
/// J of a liquid goes no lower.
pub const LIQUID_J_LEAST: f32 = 0.3;
/// Nor higher by what stretches it: it closes up at once when it comes together.
pub const LIQUID_J_MOST: f32 = 1.02;
/// But where it is seen to have gaps, up to this: gaps that nothing holds open.
pub const LIQUID_J_LOOSE: f32 = 2.5;
/// Elastic strain that a thick liquid holds for a moment, at most.
pub const LIQUID_STRAIN_MOST: f32 = 0.3;
/// A liquid's elastic strain that shrinks with the flow is lost so many times faster than it shrinks.
pub const RECOIL: f32 = 10.0;
/// Newton steps of a cube root of 0.3 to 2.
pub const CUBE_ROOT_STEPS: u32 = 4;
/// For the wave speed in thick liquids, seconds; any length of substeps will do that is not far off.
pub const USUAL_STEP_S: f32 = 1e-4;
/// Fixed-point units of a cell full of liquid, and of the largest of its properties.
pub const FILL_UNITS: f32 = 1_048_576.0;
/// Where less of a node's spline is on the free side of walls, the node counts for nothing.
pub const ROOM_LEAST: f32 = 0.02;
/// Liquid whose nodes are all as full as this, as a share of the fullest of them, is inside. Elsewhere it is only ever made
/// denser, which noise drives on: at 0.8 what floats sinks by a millimetre a second.
pub const FULL: f32 = 0.6;
/// Share of the difference in density that liquid makes up in the time that sound takes through a cell.
pub const CALM: f32 = 0.008;
/// Change of fullness from node to node below which there is no surface.
pub const SURFACE_LEAST: f32 = 0.02;
/// Wall nodes of a liquid lose their slip at so many times r + r^2 [`WALL_SOON_S`], r = nu / cell^2: what
/// viscosity carries through a cell soon enough sticks, water hardly does.
pub const WALL_GRIP: f32 = 50.0;
/// See [`WALL_GRIP`], seconds.
pub const WALL_SOON_S: f32 = 0.1;
/// f / 8 of Darcy's and Weisbach's friction, tau = f / 8 rho v^2: f = 0.03 is that of rough turbulent flow where
/// the roughness is some hundredth of the depth (Moody 1944).
pub const WALL_FRICTION: f32 = 0.03 / 8.0;
/// Films brake as if no thinner, cells: a drop alone on its wall.
pub const FILM_LEAST: f32 = 0.01;
/// The grid resolves how a liquid shears on a wall where the first node clear of it is this full, as a share of the
/// fullest that the wall brakes.
pub const FILM_RESOLVED: f32 = 0.6;
/// Time in which the Gaussians of a liquid go back to their captured shape, seconds.
pub const LIQUID_SHOWN_S: f32 = 0.25;
/// Rigid bodies of one scene, at most.
pub const RIGID_BODIES: u32 = crate::spec::limits::RIGID;
/// Threads a workgroup of the passes over bodies.
pub const RIGID_LANES: u32 = 64;
/// Points of a body's surface, at most.
pub const RIGID_POINTS: u32 = 512;
/// Coefficients of all bodies' distance fields together.
pub const RIGID_FIELD: u32 = 4_000_000;
/// Other things that a body's points meet at one time, at most: of more that touch it the deepest.
pub const RIGID_SLOTS: u32 = 12;
/// Contacts that a body had in the substep before, at most: four a slot.
pub const RIGID_OLD: u32 = 4 * RIGID_SLOTS;
/// Steps in which a surface point slides to where it is nearest, at most; twice as many where that is sharp.
pub const RIGID_SLIDES: u32 = 4;
/// Two surfaces that turn towards each other by more than this, as a sum of sines, from one point to the next: one is sharp.
/// The edge of a box that stands on a plane makes 1, a needle under a face 2.
pub const RIGID_SHARP: f32 = 1.2;
/// Colours of manifolds that share no body. What finds none is solved one after another.
pub const RIGID_COLOURS: u32 = 128;
/// Rounds of impulses before positions move.
pub const RIGID_ROUNDS: u32 = 8;
/// And after, without the push that takes overlaps apart.
pub const RIGID_CALM_ROUNDS: u32 = 4;
/// Stiffness of that push, as the frequency of a spring. At half of it a stack of ten sways for two seconds; at
/// twice, contacts rattle.
pub const RIGID_HERTZ: f32 = 120.0;
/// Its damping ratio.
pub const RIGID_DAMPING: f32 = 10.0;
/// No overlap opens faster than this many radii of the body a second.
pub const RIGID_PUSH_RATE: f32 = 5.0;
/// What positions of bodies are counted in is 2^-this metres, so that whole numbers of it are exact.
pub const RIGID_QUANTUM_BITS: u32 = 20;
/// See [`RIGID_QUANTUM_BITS`].
pub const RIGID_QUANTUM_M: f32 = 1.0 / (1u32 << RIGID_QUANTUM_BITS) as f32;
/// What fields give a body is summed in shares of its mass times this speed, m/s.
pub const DRIVEN_UNIT: f32 = 1.0 / 2_147_483_648.0;
/// Bits of what a particle adds to the low word of such a sum.
pub const DRIVEN_BITS: u32 = 12;
/// Units in the high word.
pub const DRIVEN_LOW: f32 = (1u32 << DRIVEN_BITS) as f32;
/// Longest substep of rigid bodies, seconds.
pub const RIGID_STEP_S: f64 = 5e-4;
/// And in units of the time in which the smallest body falls by its own radius.
pub const RIGID_STEP_SHARE: f64 = 0.02;

/// Coulomb coefficient of what has none of its own, against other objects.
pub const FRICTION: f32 = 0.3;
/// Layers of the grid at most: objects that move apart from each other.
pub const MOST_LAYERS: u32 = 8;
/// Objects that layers are dealt to: all that a spec may have. A solver's others share theirs.
pub const DEALT: u32 = crate::spec::limits::OBJECTS;
/// Rounds over the pairs of a node where more than two objects meet.
pub const MEETING_ROUNDS: u32 = 4;
/// Gradient of mass over mass, a cell, below which a node lies too deep in a body to tell where its surface is.
pub const FAINT_SLOPE: f32 = 0.3;
/// And above which it lies too far off: the surface is 0.7 cells away, and other nodes are nearer.
pub const FAR_SLOPE: f32 = 4.0;
/// Central difference of mass over mass at a node on the surface of a half-space: (N(1) - N(-1)) / 2 N(0),
/// N the integral of the quadratic spline.
pub const SURFACE_SLOPE: f32 = 23.0 / 24.0;

/// All of them as WGSL constants.
pub fn all() -> Vec<(&'static str, Constant)> {
    vec![
        ("WORKGROUP", Constant::U32(WORKGROUP)),
        ("TILE_LANES", Constant::U32(TILE_LANES)),
        ("SCAN_LANES", Constant::U32(SCAN_LANES)),
        ("SCAN_RUN", Constant::U32(SCAN_RUN)),
        ("GROUPS_ACROSS", Constant::U32(GROUPS_ACROSS)),
        ("BREATHING", Constant::F32(BREATHING)),
        ("POLAR_STEPS", Constant::U32(POLAR_STEPS)),
        ("FLAT", Constant::F32(FLAT)),
        ("FLAT_STEPS", Constant::U32(FLAT_STEPS)),
        ("F_MOST", Constant::F32(F_MOST)),
        ("J_FLOOR", Constant::F32(J_FLOOR)),
        ("J_LEAST", Constant::F32(J_LEAST)),
        ("J_MOST", Constant::F32(J_MOST)),
        ("GAP_STEPS", Constant::F32(GAP_STEPS)),
        ("REST_CELLS", Constant::F32(REST_CELLS)),
        ("REST_CELLS_MAX", Constant::F32(REST_CELLS_MAX)),
        ("TOUCHING_CELLS", Constant::F32(TOUCHING_CELLS)),
        ("RELEASE", Constant::F32(RELEASE)),
        ("LIGHTEST", Constant::F32(LIGHTEST)),
        ("CARRY_STEPS", Constant::U32(CARRY_STEPS)),
        ("CARRY_SHARE", Constant::F32(CARRY_SHARE)),
        ("CARRY_MOST", Constant::F32(CARRY_MOST)),
        ("MOST_LAYERS", Constant::U32(MOST_LAYERS)),
        ("DEALT", Constant::U32(DEALT)),
        ("MEETING_ROUNDS", Constant::U32(MEETING_ROUNDS)),
        ("FAINT_SLOPE", Constant::F32(FAINT_SLOPE)),
        ("FAR_SLOPE", Constant::F32(FAR_SLOPE)),
        ("SURFACE_SLOPE", Constant::F32(SURFACE_SLOPE)),
        ("SUM_LIMIT", Constant::F32(SUM_LIMIT)),
        ("ELASTIC", Constant::U32(substance::ELASTIC)),
        ("MUSCLE", Constant::U32(substance::MUSCLE)),
        ("PLASTIC", Constant::U32(substance::PLASTIC)),
        ("VISCOPLASTIC", Constant::U32(substance::VISCOPLASTIC)),
        ("SAND", Constant::U32(substance::SAND)),
        ("SNOW", Constant::U32(substance::SNOW)),
        ("EVEN_FROM", Constant::F32(EVEN_FROM)),
        ("EVEN_MOST", Constant::F32(EVEN_MOST)),
        ("VOLUME_UNITS", Constant::F32(VOLUME_UNITS)),
        ("GAIN_UNITS", Constant::F32(GAIN_UNITS)),
        ("SVD_SWEEPS", Constant::U32(SVD_SWEEPS)),
        ("STRETCH_LEAST", Constant::F32(STRETCH_LEAST)),
        ("STRETCH_MOST", Constant::F32(STRETCH_MOST)),
        ("YIELD_FLOOR", Constant::F32(YIELD_FLOOR)),
        ("SQRT_2_3", Constant::F32(0.816_496_6)),
        ("LOOSE_MOST", Constant::F32(LOOSE_MOST)),
        ("PACKING_LEAST", Constant::F32(PACKING_LEAST)),
        ("PACKING_MOST", Constant::F32(PACKING_MOST)),
        ("FIELD_SPEED", Constant::F32(FIELD_SPEED)),
        ("FIELD_STIFFEST", Constant::F32(FIELD_STIFFEST)),
        ("LIQUID", Constant::U32(substance::LIQUID)),
        ("SLIPS", Constant::U32(SLIPS)),
        ("LIQUID_J_LEAST", Constant::F32(LIQUID_J_LEAST)),
        ("LIQUID_J_MOST", Constant::F32(LIQUID_J_MOST)),
        ("LIQUID_J_LOOSE", Constant::F32(LIQUID_J_LOOSE)),
        ("LIQUID_STRAIN_MOST", Constant::F32(LIQUID_STRAIN_MOST)),
        ("RECOIL", Constant::F32(RECOIL)),
        ("CUBE_ROOT_STEPS", Constant::U32(CUBE_ROOT_STEPS)),
        ("USUAL_STEP_S", Constant::F32(USUAL_STEP_S)),
        ("FILL_UNITS", Constant::F32(FILL_UNITS)),
        ("ROOM_LEAST", Constant::F32(ROOM_LEAST)),
        ("FULL", Constant::F32(FULL)),
        ("CALM", Constant::F32(CALM)),
        ("SURFACE_LEAST", Constant::F32(SURFACE_LEAST)),
        ("WALL_GRIP", Constant::F32(WALL_GRIP)),
        ("WALL_SOON_S", Constant::F32(WALL_SOON_S)),
        ("WALL_FRICTION", Constant::F32(WALL_FRICTION)),
        ("FILM_LEAST", Constant::F32(FILM_LEAST)),
        ("FILM_RESOLVED", Constant::F32(FILM_RESOLVED)),
        ("LIQUID_SHOWN_S", Constant::F32(LIQUID_SHOWN_S)),
        ("SPH_LIQUID", Constant::U32(SPH_LIQUID)),
        ("SPH_SLOTS", Constant::U32(SPH_SLOTS)),
        ("STIFFEST", Constant::U32(SPH_SLOTS - 1)),
        ("SPH_LEAST_ROUNDS", Constant::U32(SPH_LEAST_ROUNDS)),
        ("COARSE_STEPS", Constant::F32(COARSE_STEPS)),
        ("COARSE_REACH", Constant::I32(COARSE_REACH)),
        ("DRIFT_SHARE", Constant::F32(DRIFT_SHARE)),
        ("SPH_RELAX", Constant::F32(SPH_RELAX)),
        ("SOLID_STRENGTH", Constant::F32(SOLID_STRENGTH)),
        ("MOMENTUM", Constant::F32(MOMENTUM)),
        ("TOLERATED", Constant::F32(TOLERATED)),
        ("EDDIES", Constant::F32(EDDIES)),
        ("EDDIES_MOST", Constant::F32(EDDIES_MOST)),
        ("VISCOUS", Constant::F32(VISCOUS)),
        ("WALL_VISCOUS", Constant::F32(WALL_VISCOUS)),
        ("VISCOUS_RANGE", Constant::F32(VISCOUS_RANGE)),
        ("THIN_OUT", Constant::F32(THIN_OUT)),
        ("EASE_OUT_M_S2", Constant::F32(EASE_OUT_M_S2)),
        ("SURFACE_FROM", Constant::F32(SURFACE_FROM)),
        ("SURFACE_TO", Constant::F32(SURFACE_TO)),
        ("TENSION", Constant::F32(TENSION)),
        ("LEVERS_LEAST", Constant::F32(LEVERS_LEAST)),
        ("SKIN_CALM", Constant::F32(SKIN_CALM)),
        ("PULL_ZERO", Constant::F32(PULL_ZERO)),
        ("PULL", Constant::F32(PULL)),
        ("WETTING", Constant::F32(WETTING)),
        ("RIGID_BODIES", Constant::U32(RIGID_BODIES)),
        ("RIGID_LANES", Constant::U32(RIGID_LANES)),
        ("RIGID_POINTS", Constant::U32(RIGID_POINTS)),
        ("RIGID_SLOTS", Constant::U32(RIGID_SLOTS)),
        ("RIGID_OLD", Constant::U32(RIGID_OLD)),
        ("RIGID_SLIDES", Constant::U32(RIGID_SLIDES)),
        ("RIGID_SHARP", Constant::F32(RIGID_SHARP)),
        ("RIGID_COLOURS", Constant::U32(RIGID_COLOURS)),
        ("RIGID_ROUNDS", Constant::U32(RIGID_ROUNDS)),
        ("RIGID_CALM_ROUNDS", Constant::U32(RIGID_CALM_ROUNDS)),
        ("RIGID_HERTZ", Constant::F32(RIGID_HERTZ)),
        ("RIGID_DAMPING", Constant::F32(RIGID_DAMPING)),
        ("DRIVEN_UNIT", Constant::F32(DRIVEN_UNIT)),
        ("DRIVEN_BITS", Constant::U32(DRIVEN_BITS)),
        ("DRIVEN_LOW", Constant::F32(DRIVEN_LOW)),
        ("RIGID_QUANTUM_BITS", Constant::U32(RIGID_QUANTUM_BITS)),
        ("RIGID_QUANTUM_M", Constant::F32(RIGID_QUANTUM_M)),
        ("RIGID_PUSH_RATE", Constant::F32(RIGID_PUSH_RATE)),
    ]
}
