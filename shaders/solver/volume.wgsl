// Solids that hardly change their volume. A particle's own volume follows velocities so finely that
// keeping it holds shapes that matter takes freely: they lock, the more the nearer Poisson's ratio is to
// a half. What counts is the mean over a cell: at each sort, all that lie in one cell get the mean of what
// their logarithms of volume gained since the last (P0 pressures over quadratic splines; the mean dilation of
// Nagtegaal et al. 1974). Cells between nodes, over which no pressure that alternates goes unnoticed.

// What a particle gained.
struct Gain {
    // Whether its cell counts it.
    counts: bool,
    // Where the cell is stored.
    cell: u32,
    // Of ln det F, since what it remembers.
    gained: f32,
}

fn ln_volume(f: mat3x3<f32>) -> f32 {
    return ln_near_one(max(determinant(f), J_FLOOR));
}

fn gain_of(i: u32) -> Gain {
    let n = params.count;
    let label = matter[3u * n + i];
    let tag = bitcast<u32>(label.y);
    let kind = substances[row_of(tag)].kind;
    let stiff = matter[n + i].w > EVEN_FROM * matter[i].w && matter[i].w > 0.0;
    let place = vec3<i32>(floor(kinematics[i].xyz * params.per_m)) - params.origin;
    let inside = all(place >= vec3<i32>(0)) && all(place < vec3<i32>(params.blocks * 4u));
    let f = read_deformation(i);
    let whole = determinant(f) > J_FLOOR;
    let counts = (kind == ELASTIC || kind == MUSCLE) && stiff && inside && whole && !is_rigid(tag);
    let gained = clamp(ln_volume(f) - label.w, -EVEN_MOST, EVEN_MOST);
    return Gain(counts, stored(vec3<u32>(clamp(place, vec3<i32>(0), vec3<i32>(params.blocks * 4u) - vec3<i32>(1))), layer_of(tag)), gained);
}

// Rest volume in volumes of a cell.
fn rest_share(i: u32) -> f32 {
    return matter[2u * params.count + i].w * params.per_m * params.per_m * params.per_m;
}
