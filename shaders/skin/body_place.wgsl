// One thread a particle: where it is sorted to, and how far those that were around it have left.

/// (x, y, z, G - I as nine halves, how it flows), 32 bytes.
@group(0) @binding(0) var<storage, read> motion: array<PackedDelta>;
/// Captured positions.
@group(0) @binding(1) var<storage, read> rest_particle: array<vec4<f32>>;
/// BESIDE particles that were nearest, of each; itself where it had fewer.
@group(0) @binding(2) var<storage, read> beside: array<u32>;
@group(0) @binding(3) var<storage, read_write> keys: array<u32>;
@group(0) @binding(4) var<storage, read_write> values: array<u32>;
/// 0: all are still around it, 1: none to speak of.
@group(0) @binding(5) var<storage, read_write> parted: array<f32>;

fn place(i: u32) -> vec3<f32> {
    return bitcast<vec3<f32>>(motion[i].a.xyz);
}

@compute @workgroup_size(GROUP_SIZE)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let i = (group.y * groups.x + group.x) * GROUP_SIZE + lane;
    if i >= params.count {
        return;
    }
    values[i] = i;
    let x = place(i);
    let flow = unpack2x16float(motion[i].b.w).y;
    if flow < 0.5 || !proper(x) {
        keys[i] = params.mask + 1u;
        parted[i] = 0.0;
        return;
    }
    keys[i] = key_of(cell_of(x));
    // Grains that slide past each other are grains, liquid that shears is still smooth.
    let low = select(GONE_LOW, GRAINS_GONE_LOW, flow < 1.5);
    let high = select(GONE_HIGH, GRAINS_GONE_HIGH, flow < 1.5);
    var gone = 0.0;
    for (var k = 0u; k < BESIDE; k++) {
        let j = beside[i * BESIDE + k];
        let farther = distance(place(j), x) - distance(rest_particle[j].xyz, rest_particle[i].xyz);
        gone += smoothstep(low, high, farther / params.spacing_m);
    }
    parted[i] = smoothstep(PARTED_LOW, PARTED_HIGH, gone / f32(BESIDE));
}
