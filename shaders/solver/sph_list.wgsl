// Four neighbours from an entry on.

fn liquids_from(k: u32, i: u32) -> vec4<u32> {
    return neighbours[(k >> 2u) * params.count + i];
}

fn solids_from(k: u32, i: u32) -> vec4<u32> {
    return neighbours[(solve.columns - 1u - (k >> 2u)) * params.count + i];
}
