// Grid to particles, a workgroup for each item of the blocks' particles.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read_write> kinematics: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read_write> matter: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> velocity: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read> colliders: array<Collider>;
// Acceleration of each object, beside gravity.
@group(0) @binding(5) var<storage, read> objects: array<vec4<f32>>;
@group(0) @binding(6) var<storage, read_write> control: Control;
@group(0) @binding(7) var<storage, read> substances: array<Substance>;
@group(0) @binding(8) var<storage, read> items: array<vec4<u32>>;
var<immediate> substep: Substep;

@compute @workgroup_size(TILE_LANES)
fn main(
    @builtin(local_invocation_index) lane: u32,
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(subgroup_invocation_id) sublane: u32,
) {
    let number = group.y * GROUPS_ACROSS + group.x;
    if (number >= items[0].x) {
        return;
    }
    let item = item_of(number);
    look_around(item, lane);
    workgroupBarrier();
    load_flow(lane);
    workgroupBarrier();
    var momentum = 0u;
    var speed = 0u;
    for (var t = lane; t < item.count; t += TILE_LANES) {
        let i = item.first + t;
        let known = matter_of(i);
        let m = moved(i, known, gathered(item, known.position.xyz, bitcast<u32>(known.label.y)), true);
        if (m.carried) {
            write_motion(i, m.v, m.affine);
        }
        momentum = max(momentum, ordered_bits(m.momentum));
        speed = max(speed, ordered_bits(m.speed));
    }
    note(momentum, speed, sublane);
}
