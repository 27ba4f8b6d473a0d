// Particles to grid, a workgroup for each item of the blocks' particles.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read> kinematics: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read> matter: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> colliders: array<Collider>;
// As in `p2g.wgsl`.
@group(0) @binding(4) var<storage, read_write> sums: array<atomic<i32>>;
@group(0) @binding(5) var<storage, read_write> marks: array<atomic<u32>>;
@group(0) @binding(6) var<storage, read_write> control: Control;
@group(0) @binding(7) var<storage, read> substances: array<Substance>;
@group(0) @binding(8) var<storage, read> items: array<vec4<u32>>;
var<immediate> substep: Substep;

@compute @workgroup_size(TILE_LANES)
fn main(@builtin(local_invocation_index) lane: u32, @builtin(workgroup_id) group: vec3<u32>) {
    let number = group.y * GROUPS_ACROSS + group.x;
    if (number >= items[0].x) {
        return;
    }
    let item = item_of(number);
    look_around(item, lane);
    let unit = momentum_units(substep.index, substep.lag);
    for (var t = lane; t < item.count; t += TILE_LANES) {
        let i = item.first + t;
        let label = matter[3u * params.count + i];
        let tag = bitcast<u32>(label.y);
        if (on_grid(tag)) {
            let position = kinematics[i];
            let v = kinematics[params.count + i].xyz;
            let load = load_of(position.xyz, position.w, v, read_affine(i), label, matter[i].w != 0.0, unit, substep.index);
            hand_over(item, position.xyz, tag, load);
        }
    }
    workgroupBarrier();
    unload(lane);
}
