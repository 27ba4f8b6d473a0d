// The box around the centres of everything that casts. Few workgroups walk all of it, so that few
// atomics meet at the six words.

@group(0) @binding(0) var<storage, read> caster: array<u32>;
@group(0) @binding(1) var<storage, read> geometry: array<vec4<f32>>;
/// The largest x, y, z, -x, -y, -z, ordered; zeros before.
@group(0) @binding(2) var<storage, read_write> bounds: array<atomic<u32>, 6>;

var<workgroup> shared_bounds: array<atomic<u32>, 6>;

@compute @workgroup_size(BOUNDS_GROUP)
fn main(@builtin(global_invocation_id) id: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    var found = false;
    var low = vec3(0.0);
    var high = vec3(0.0);
    for (var i = id.x; i < params.count; i += BOUNDS_GROUP * BOUNDS_GROUPS) {
        let p = geometry[caster[i] * 4u];
        // What is not seen casts nothing, wherever it is.
        if p.w > 0.0 {
            low = select(p.xyz, min(low, p.xyz), found);
            high = select(p.xyz, max(high, p.xyz), found);
            found = true;
        }
    }
    if found {
        for (var axis = 0u; axis < 3u; axis++) {
            atomicMax(&shared_bounds[axis], ordered(high[axis]));
            atomicMax(&shared_bounds[axis + 3u], ordered(-low[axis]));
        }
    }
    workgroupBarrier();
    if lane < 6u {
        atomicMax(&bounds[lane], atomicLoad(&shared_bounds[lane]));
    }
}
