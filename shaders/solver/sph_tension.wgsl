// Surface tension, as pulls between pairs of particles on the surface, along it: where the surface is bent they
// have a sum inwards. Pairs inside do not pull, so that tension makes no pressure of its own; and whatever the
// surface's shape and its particles' distances, momentum is kept pair by pair.
//
// A surface that is stretched evenly by a share e gains 2 sigma A e. Each particle has a part of the area A,
// by how steeply the density falls beside it, and the pulls of its neighbours on the surface are scaled so that
// sum r F is 2 sigma times that part.

// How far a particle belongs to the surface, by the gradient of density beside it, times the cell: 1.02 in the
// outermost layer of a lattice, 0 in the next one.
fn on_surface(gradient: f32) -> f32 {
    return smoothstep(SURFACE_FROM, SURFACE_TO, gradient);
}

// How the pull of a pair goes with its distance.
fn tug(q: f32) -> f32 {
    return q * max(1.0 - q, 0.0);
}

// Solids and walls count as liquid to that gradient, so that a surface meets them at a right angle; what they wet
// beyond that is a pull on the liquid beside them: nearer than PULL_ZERO they push. Of a pair, sigma V_i V_j pull(q)
// over cell, in cells; two half-spaces are then held together by 2 sigma a unit of area (Fowler 1937):
// (pi / 8) int q^4 pull dq = 1.

fn pull(q: f32) -> f32 {
    let rest = max(1.0 - q, 0.0);
    return PULL * rest * rest * (q - PULL_ZERO);
}

// All of a half-space's pull on a particle at a distance: pi int_s^1 pull (q^2 - s^2) dq.
fn wall_pull(s: f32) -> f32 {
    let c = clamp(s, 0.0, 1.0);
    let r = 1.0 - c;
    let a = 1.0 - PULL_ZERO;
    let b = 1.0 + c;
    let all = a * r * b / 3.0 + r * (-(a * r + a * b + r * b) / 4.0 + r * ((a + r + b) / 5.0 - r / 6.0));
    return PI * PULL * WETTING * r * r * r * all;
}
