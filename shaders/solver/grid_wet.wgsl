// Acceleration by surface tension, m/s^2; kinematic viscosity, m^2/s.
@group(0) @binding(9) var<storage, read> pull: array<vec4<f32>>;
// Thickness of the liquid that walls brake; the same again where that is a film as a whole, metres.
@group(0) @binding(10) var<storage, read> film: array<vec2<f32>>;

// Of liquid alone: what else is at the node is on another layer, and its surface is not the liquid's.
fn liquid_pull(node: Node) -> vec4<f32> {
    let wet = ((params.wet_layers >> node.layer) & 1u) != 0u;
    return select(vec4<f32>(0.0), pull[stored(vec3<u32>(node.cell), 0u)], wet);
}

// Whether a wall brakes the liquid or paste of a node: along one without friction any slips. Solids of a wet
// layer have nothing poured.
fn wets(mark: u32, x: vec3<f32>, at: Node) -> bool {
    let c = colliders[(mark & 1023u) >> 3u];
    let node = stored(vec3<u32>(at.cell), 0u);
    let near = film[node].y > 0.0 || touch(c, x).distance_m <= 0.5 * params.cell_m;
    let paste = ((params.wet_layers >> at.layer) & 1u) != 0u && pull[node].w > 0.0;
    return near && ((mark & SLIPS) != 0u || paste) && c.surface.x > 0.0;
}

// What a wall's friction leaves of its velocity: rough turbulent flow is braked by f / 8 rho v^2
// (Darcy and Weisbach), a film that is too thin for the grid by 3 mu v / h besides (Nusselt 1916).
// By backward Euler, which can but brake.
fn braked(v: vec3<f32>, mark: u32, x: vec3<f32>, at: Node) -> vec3<f32> {
    let node = stored(vec3<u32>(at.cell), 0u);
    if (!wets(mark, x, at)) {
        return v;
    }
    let normal = surface_normal(colliders[(mark & 1023u) >> 3u], mark & 7u, x);
    let across = normal * dot(v, normal);
    let sliding = v - across;
    let thick_m = max(film[node].x, FILM_LEAST * params.cell_m);
    let laminar = select(0.0, 3.0 * pull[node].w / thick_m, film[node].y > 0.0);
    let rate = (laminar + WALL_FRICTION * length(sliding)) / thick_m;
    return across + sliding / (1.0 + substep.dt_s * rate);
}

// How far a wall holds what slides along it: all the way where a liquid's viscosity reaches through a
// cell soon enough, hardly where it is thin, nor where it is a film that brakes as a whole.
fn held_by(mark: u32, x: vec3<f32>, at: Node) -> f32 {
    let node = stored(vec3<u32>(at.cell), 0u);
    if (!wets(mark, x, at) || film[node].y > 0.0) {
        return 0.0;
    }
    let rate = pull[node].w * params.per_m * params.per_m;
    let grip = substep.dt_s * WALL_GRIP * rate * (1.0 + rate * WALL_SOON_S);
    return grip / (1.0 + grip);
}
