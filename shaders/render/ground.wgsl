// The factor of the plain ground behind each pixel: where the pixel's ray meets the plane, the contact
// shadow at that place; above the horizon and far from the object, 1.

@group(0) @binding(0) var<uniform> frame: Frame;
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
        factor = ground_shade(frame.eye.xy + reach * ray.xy);
    }
    backdrop[i] = factor;
}
