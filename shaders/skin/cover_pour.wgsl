// One thread a moving Gaussian that has lost its shape or may: adds its area to its cell.

@group(0) @binding(0) var<storage, read> moving: array<u32>;
@group(0) @binding(1) var<storage, read> loose: array<f32>;
@group(0) @binding(2) var<storage, read> sizes: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> geometry: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read_write> keys: array<atomic<u32>>;
@group(0) @binding(5) var<storage, read_write> sums: array<atomic<i32>>;

// The place of a key in the table: its own, or the first free one after where it should be.
fn claimed(key: u32) -> u32 {
    let last = arrayLength(&keys) - 1u;
    var place = key & last;
    for (var k = 0u; k < PROBES; k++) {
        let found = atomicCompareExchangeWeak(&keys[place], 0u, key);
        if found.exchanged || found.old_value == key {
            return place;
        }
        // A weak exchange may fail for nothing.
        if found.old_value != 0u {
            place = (place + 1u) & last;
        }
    }
    return last + 1u;
}

@compute @workgroup_size(GROUP_SIZE)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let slot = (group.y * groups.x + group.x) * GROUP_SIZE + lane;
    if slot >= params.count || loose[slot] < 0.0 {
        return;
    }
    let x = in_cells(geometry[moving[slot] * 4u].xyz);
    let cell = floor(x);
    let place = claimed(key_of(vec3<i32>(cell)));
    if place >= arrayLength(&keys) {
        return;
    }
    let d = x - cell - vec3(0.5);
    let share = sizes[slot].x / params.span_m;
    let area = max(share * share * COVER_UNITS, 1.0);
    let first = round(area * d);
    let square = round(area * d * d);
    let mixed = round(area * d.yzx * d.zxy);
    let at = place * CELL_WORDS;
    atomicAdd(&sums[at], i32(round(area)));
    atomicAdd(&sums[at + 1u], i32(first.x));
    atomicAdd(&sums[at + 2u], i32(first.y));
    atomicAdd(&sums[at + 3u], i32(first.z));
    atomicAdd(&sums[at + 4u], i32(square.x));
    atomicAdd(&sums[at + 5u], i32(square.y));
    atomicAdd(&sums[at + 6u], i32(square.z));
    atomicAdd(&sums[at + 7u], i32(mixed.x));
    atomicAdd(&sums[at + 8u], i32(mixed.y));
    atomicAdd(&sums[at + 9u], i32(mixed.z));
    atomicAdd(&sums[at + 10u], 1);
}
