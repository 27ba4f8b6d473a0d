// Liquid: a pressure p = K (1 / J - 1) from its volume; and a shear stress of Maxwell's kind that relaxes with
// the time eta / K. In a steady flow that is 2 eta D, Newton's, whatever the step; what it carries like a solid
// for a moment is a strain of rho v^2 / K, as small as the compression that stands for incompressibility.
//
// A thread that is pulled long pulls its sides in: the pressure in it is below that of the air by what its
// viscosity brings, eta D along a thread, at most sqrt(2/3) of the size of its shear stress whichever way it is
// stretched. So much tension its volume bears as that size, and no more: what flies apart evenly is free.
//
// F = J^(1/3) (I + e), e its traceless elastic strain. values: viscosity, Pa s; surface tension, N/m.

// a : b for a symmetric a.
fn double_dot(a: mat3x3<f32>, b: mat3x3<f32>) -> f32 {
    return dot(a[0], b[0]) + dot(a[1], b[1]) + dot(a[2], b[2]);
}

fn liquid(s: Substance, trial: mat3x3<f32>, rotation: mat3x3<f32>, history: f32, lambda: f32, flow: Flow) -> Answer {
    let unit = mat3x3<f32>(vec3<f32>(1.0, 0.0, 0.0), vec3<f32>(0.0, 1.0, 0.0), vec3<f32>(0.0, 0.0, 1.0));
    let stretched = determinant(trial);
    // Its volume grows no farther than that; where it is seen to be loose it is so already (`liquid_density.wgsl`).
    let before = stretched / max(determinant(unit + flow.dt_s * flow.gradient), 0.1);
    let j = clamp(stretched, LIQUID_J_LEAST, clamp(before, LIQUID_J_MOST, LIQUID_J_LOOSE));
    // Steps of relaxation times, by backward Euler.
    let relaxing = flow.dt_s * lambda / max(s.values[0], 1e-30);
    // Strain that lasts turns with the flow: the left stretch of F.
    let stretch = trial * transpose(rotation);
    let mean = (stretch[0].x + stretch[1].y + stretch[2].z) * (1.0 / 3.0);
    var strain = (stretch * (1.0 / max(mean, 1e-3)) - unit) * (1.0 / (1.0 + relaxing));
    let square = max(double_dot(strain, strain), 1e-30);
    // Newton's stress takes work and gives none back. What the strain gives back, as it shrinks, is but
    // a small share of what it took: no rebound.
    let growing = flow.dt_s * double_dot(strain, flow.gradient) / square;
    let lasting = select(max(1.0 + RECOIL * growing, 0.0), 1.0, growing >= 0.0);
    let bounded = select(0.0, min(lasting, LIQUID_STRAIN_MOST * inverseSqrt(square)), stretched > 0.0);
    strain *= bounded;
    let shape = unit + strain;
    let f = shape * cube_root(j / determinant(shape));
    let size = 2.0 * j * bounded * sqrt(square);
    return Answer(f, history, unit * (lambda * min(j - 1.0, size)) + strain * (2.0 * lambda * j));
}
