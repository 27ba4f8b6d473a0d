// After a substep: what fields add to the velocity of particles. At the end of a segment: how much
// they may add in the next frame, for the length of its substeps.
//
// The functions `field_0`, … and the switch `field` over them are written from the scene's expressions.

struct Field {
    // Which function.
    shape: u32,
    // Its first number in `constants`.
    first: u32,
    // Index of the object that it acts on.
    object: u32,
    // Which field of the settings it is.
    number: u32,
}

struct Fields {
    // Entries in force.
    count: u32,
    // 1 where the largest change is wanted, 0 where it is made.
    asks: u32,
    // When the segment begins, or the frame that is asked about.
    start_s: f32,
    // Length of that frame.
    frame_s: f32,
    records: array<Field>,
}

struct Tally {
    // Bits of the largest change of velocity over any span of the next frame, and over the whole of it.
    change: atomic<u32>,
    change_whole: atomic<u32>,
    // Times that a particle was held at FIELD_SPEED, or got no number.
    limited: atomic<u32>,
    // Times that each field gave no number.
    undefined: array<atomic<u32>>,
}

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read_write> kinematics: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read> matter: array<vec4<f32>>;
// Place in the captured pose and the particle's own number, in the original order.
@group(0) @binding(3) var<storage, read> captured: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read> fields: Fields;
@group(0) @binding(5) var<storage, read> constants: array<f32>;
@group(0) @binding(6) var<storage, read_write> control: Control;
@group(0) @binding(7) var<storage, read_write> tally: Tally;
var<immediate> substep: Substep;

// Everything that pulls at a particle of an object, added up. What is no number counts as nothing.
fn pull(here: Here, object: u32, counts: bool) -> Pull {
    var sum = no_pull();
    for (var f = 0u; f < fields.count; f++) {
        let record = fields.records[f];
        if (record.object != object) {
            continue;
        }
        let p = field(record.shape, record.first, here);
        if (!finite3(p.a)) {
            if (counts) {
                atomicAdd(&tally.undefined[record.number], 1u);
            }
            continue;
        }
        sum.a += p.a;
        // At a corner of a field its slopes may be none; it acts by its value alone there.
        let slopes = p.by_x[0] + p.by_x[1] + p.by_x[2] + p.by_v[0] + p.by_v[1] + p.by_v[2];
        if (finite3(slopes)) {
            sum.by_x += p.by_x;
            sum.by_v += p.by_v;
        }
    }
    return sum;
}

// The largest change at a few times of the frame, over spans from the whole of it to a thousandth: a
// stiff spring changes most over a quarter of its period. Then the largest over the whole.
fn largest_change(at: Here, object: u32) -> vec2<f32> {
    var here = at;
    var largest = vec2<f32>(0.0);
    for (var moment = 0u; moment < 5u; moment++) {
        here.time_s = fields.start_s + 0.249 * fields.frame_s * f32(moment);
        let p = pull(here, object, false);
        var span_s = fields.frame_s;
        for (var k = 0u; k < 6u; k++) {
            let change = length(driven(here.v, velocity_change(p, span_s)) - here.v);
            largest = max(largest, vec2<f32>(change, select(0.0, change, k == 0u)));
            span_s *= 0.25;
        }
    }
    return largest;
}

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(global_invocation_id) id: vec3<u32>, @builtin(subgroup_invocation_id) lane: u32) {
    let n = params.count;
    // A lane beyond the last particle looks at that one and counts for nothing: another writes it meanwhile.
    let alive = id.x < n;
    let i = min(id.x, n - 1u);
    let tag = matter[3u * n + i];
    let own = captured[bitcast<u32>(tag.x)];
    let object = bitcast<u32>(tag.y) & 0xffffu;
    let position = kinematics[i];
    let motion = kinematics[n + i];
    // The middle of the substep: an impulse over a span is right to second order.
    let time_s = fields.start_s + (substep.since_s + 0.5 * substep.dt_s);
    let here = Here(position.xyz, motion.xyz, own.xyz, time_s, position.w, own.w);
    if (fields.asks != 0u) {
        let most = subgroupMax(bitcast<vec2<u32>>(select(largest_change(here, object), vec2<f32>(0.0), has_left(i))));
        if (lane == 0u) {
            atomicMax(&tally.change, most.x);
            atomicMax(&tally.change_whole, most.y);
        }
        return;
    }
    let change = velocity_change(pull(here, object, alive), substep.dt_s);
    let left = has_left(i);
    let v = select(driven(here.v, change), vec3<f32>(0.0), left);
    if (alive && !left) {
        kinematics[n + i] = vec4<f32>(v, motion.w);
        if (!finite3(change) || distance(v, here.v + change) > 1e-3 * FIELD_SPEED) {
            atomicAdd(&tally.limited, 1u);
        }
    }
    // The scale of the next substep's sums, and the watch, see the velocity that it begins with.
    let momentum = momentum_measure(position.w, v, read_affine(i));
    let momentum_most = subgroupMax(select(0u, bitcast<u32>(momentum) & 0x7fffffffu, alive));
    let speed_most = subgroupMax(select(0u, bitcast<u32>(length(v)) & 0x7fffffffu, alive));
    if (lane == 0u) {
        let slot = (substep.index + 1u) & 3u;
        if (momentum_most > atomicLoad(&control.momentum[slot])) {
            atomicMax(&control.momentum[slot], momentum_most);
        }
        if (speed_most > atomicLoad(&control.speed)) {
            atomicMax(&control.speed, speed_most);
        }
    }
}
