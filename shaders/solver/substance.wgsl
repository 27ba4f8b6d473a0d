// What particles are made of: a row of the table for each substance, named by the upper half of a
// particle's tag. Moduli and density are the particle's own.

struct Substance {
    // ELASTIC and so on.
    kind: u32,
    // Of an elastic one: 1 neo-Hookean, 0 fixed corotated.
    model: u32,
    values: array<f32, 6>,
}

fn row_of(tag: u32) -> u32 {
    return tag >> 16u;
}
