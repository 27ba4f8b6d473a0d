// Four neighbours from an entry on, and V W' / q of each, of the kernel that it is felt by.

fn liquids_from(k: u32, i: u32) -> u32 {
    return (k >> 2u) * params.count + i;
}

fn solids_from(k: u32, i: u32) -> u32 {
    return (solve.columns - 1u - (k >> 2u)) * params.count + i;
}
