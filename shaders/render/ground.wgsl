// The factor of the plain ground behind each pixel: where the pixel's ray meets the plane, the contact
// shadow at that place on a floor a shade darker than the background, which it fades into; above the
// horizon, 1.

@group(0) @binding(0) var<storage, read> frame: Frame;
@group(0) @binding(1) var<storage, read> ground_map: array<f32>;
@group(0) @binding(2) var<storage, read_write> backdrop: array<f32>;

@compute @workgroup_size(THREADS)
fn main(
    @builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let i = thread_index(group, groups, local);
    if (i >= frame.size.x * frame.size.y) { return; }
    let pixel = vec2<f32>(f32(i % frame.size.x), f32(i / frame.size.x)) + 0.5;
    let slope = (pixel - frame.centre) / frame.focal;
    let ray = slope.x * frame.camera[0].xyz + slope.y * frame.camera[1].xyz + frame.camera[2].xyz;
    let reach = (frame.ground_m - frame.eye.z) / ray.z;
    var factor = 1.0;
    // Seen from above only; a level ray has no reach and fails both.
    if (reach > 0.0 && reach < FAR && frame.eye.z > frame.ground_m) {
        let p = frame.eye.xy + reach * ray.xy;
        factor = ground_shade(p) * floor_tone(p);
    }
    backdrop[i] = factor;
}

// A pool of tone under the object: the eye reads it as a floor, and it has no edge.
fn floor_tone(p: vec2<f32>) -> f32 {
    if (frame.pool.z <= 0.0) { return 1.0; }
    let d = length(p - frame.pool.xy) / frame.pool.z;
    return 1.0 - POOL_TONE * exp(-d * d);
}
