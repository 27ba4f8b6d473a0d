// Where Gaussians lie, in a table of cells: of each the area that its Gaussians were made to cover, that
// area's first and second moments about the cell's middle, and how many they are. Integers, so that no sum depends on an order; found
// by a hash of the cell, which but for one in billions is its own.

struct Immediates {
    origin: vec3<f32>,
    count: u32,
    // Between the particles that a Gaussian follows at rest.
    span_m: f32,
}
var<immediate> params: Immediates;

// Words of a cell: area, three first and six second moments, number.
const CELL_WORDS: u32 = 11u;

fn reach_m() -> f32 {
    return COVER_REACH * params.span_m;
}

// A place in cells.
fn in_cells(x: vec3<f32>) -> vec3<f32> {
    return (x - params.origin) / reach_m();
}

fn stirred(word: u32) -> u32 {
    var h = word;
    h = (h ^ (h >> 16u)) * 0x7feb352du;
    h = (h ^ (h >> 15u)) * 0x846ca68bu;
    return h ^ (h >> 16u);
}

// Never 0, which is an empty place of the table.
fn key_of(cell: vec3<i32>) -> u32 {
    let c = bitcast<vec3<u32>>(cell);
    return max(stirred(c.x ^ stirred(c.y ^ stirred(c.z))), 1u);
}

// Share of its area that a Gaussian lends to a place so far away, squared, in reaches.
fn nearness(apart2: f32) -> f32 {
    let free = max(1.0 - apart2, 0.0);
    return free * free * free;
}
