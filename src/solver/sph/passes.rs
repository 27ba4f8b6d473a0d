//! The kernels of the smoothed particles.

use crate::solver::passes::SUBSTEP;

passes! {
    /// The passes of DFSPH, compiled where a scene has such a liquid.
    SphPasses;
    sph_place: ["substance", "particle", "sph_place"] [Read, Read, Read, Read, Read, Write, Write, Write, Write, Write, Write, Write, Write] 0;
    sph_near: ["control", "cell", "contact", "sph", "sph_viscous", "sph_solve", "sph_near"] [Read, Read, Read, Read, Read, Read, Read, Write, Write, Write, Write, Write, Write, Write, Write, Read] 0;
    sph_begin: ["sph_begin"] [Read, Write, Write] 0;
    sph_skin: ["sph", "sph_tension", "sph_solve", "sph_list", "sph_skin"] [Read, Read, Read, Read, Read, Read, Read, Write] 0;
    sph_press: ["substep", "sph", "sph_solve", "sph_list", "sph_push", "sph_press"] [Read, Read, Read, Read, Read, Read, Read, Read, Read, Read, Read, Write, Write] SUBSTEP;
    sph_correct: ["substep", "sph", "sph_solve", "sph_list", "sph_correct"] [Read, Read, Read, Read, Read, Read, Read, Read, Read, Write, Write, Write] SUBSTEP;
    sph_forces: ["substep", "contact", "sph", "sph_viscous", "sph_tension", "sph_solve", "sph_list", "sph_forces"] [Read, Read, Read, Read, Read, Read, Read, Read, Read, Read, Read, Read, Read, Read, Write, Write] SUBSTEP;
    sph_implicit: ["substep", "contact", "sph", "sph_viscous", "sph_solve", "sph_list", "sph_implicit"] [Read, Read, Read, Read, Read, Read, Read, Read, Read, Write, Write] SUBSTEP;
    sph_foresee: ["substep", "sph_foresee"] [Read, Read, Read, Read, Write] SUBSTEP;
    sph_settle: ["substep", "sph", "sph_settle"] [Read, Read, Read, Write, Write, Read, Write] SUBSTEP;
    sph_advance: ["control", "substep", "contact", "particle", "particle_write", "sph", "sph_solve", "sph_list", "sph_push", "sph_advance"] [Read, Read, Read, Read, Read, Read, Read, Read, Read, Read, Read, Read, Read, Write, Write, Write] SUBSTEP;
}
