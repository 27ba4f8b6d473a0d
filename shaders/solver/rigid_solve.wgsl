// Moves all bodies through one substep, in one workgroup: forces, contacts, positions.
//
// Sequential impulses with warm starting: overlaps are pushed out by soft springs, whose energy a second
// set of rounds takes away again (Catto, "Solver2D", 2024), and grow no deeper, whatever drives them; gaps may close exactly; friction keeps to
// Coulomb's cone; restitution comes last, from the speed of approach before any of it. Manifolds of
// one colour share no body and run side by side; those that found no colour follow one after another.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read_write> bodies: array<Body>;
@group(0) @binding(2) var<storage, read> shapes: array<Shape>;
@group(0) @binding(3) var<storage, read_write> manifolds: array<Manifold>;
@group(0) @binding(4) var<storage, read_write> contacts: array<Contact>;
// Acceleration of each object, beside gravity.
@group(0) @binding(5) var<storage, read> objects: array<vec4<f32>>;
// Two vec4 a chunk of members: momentum and angular momentum that the grid gives.
@group(0) @binding(6) var<storage, read> given: array<vec4<f32>>;
// What fields gave, see rigid_driven.wgsl; left at zero.
@group(0) @binding(7) var<storage, read_write> driven: array<u32>;
var<immediate> substep: Substep;

// Velocity; w: 1 / mass, 0 for what is held.
var<workgroup> speed: array<vec4<f32>, RIGID_BODIES>;
// w: 1 where gravity alone moves it, before contacts.
var<workgroup> spin: array<vec4<f32>, RIGID_BODIES>;
// Inverse of the inertia tensor, world frame: xx yy zz, xy xz yz. w of the first: twice its energy before contacts, all that
// static ones leave; negative where it meets other bodies, which may give it more.
var<workgroup> ease_diagonal: array<vec4<f32>, RIGID_BODIES>;
var<workgroup> ease_mixed: array<vec4<f32>, RIGID_BODIES>;
// Colours that manifolds of a body have, a bit each.
var<workgroup> taken: array<vec4<u32>, RIGID_BODIES>;
var<workgroup> colours: u32;

const NO_BODY: u32 = 0xffffffffu;

fn eased(b: u32, v: vec3<f32>) -> vec3<f32> {
    let m = ease_mixed[b].xyz;
    return ease_diagonal[b].xyz * v + vec3<f32>(m.x * v.y + m.y * v.z, m.x * v.x + m.z * v.z, m.y * v.x + m.z * v.y);
}

fn other_body(manifold: u32) -> u32 {
    let other = manifolds[manifold].other;
    return select(NO_BODY, other - params.collider_count, other >= params.collider_count);
}

fn relative(a: u32, b: u32, arm: vec3<f32>, arm_other: vec3<f32>) -> vec3<f32> {
    let v = speed[a].xyz + cross(spin[a].xyz, arm);
    if (b == NO_BODY) {
        return v;
    }
    return v - speed[b].xyz - cross(spin[b].xyz, arm_other);
}

fn push(a: u32, b: u32, arm: vec3<f32>, arm_other: vec3<f32>, impulse: vec3<f32>) {
    speed[a] += vec4<f32>(impulse * speed[a].w, 0.0);
    spin[a] += vec4<f32>(eased(a, cross(arm, impulse)), 0.0);
    if (b != NO_BODY) {
        speed[b] -= vec4<f32>(impulse * speed[b].w, 0.0);
        spin[b] -= vec4<f32>(eased(b, cross(arm_other, impulse)), 0.0);
    }
}

// Velocity along e that a unit impulse along d brings, at a contact of a and b.
fn ease_between(a: u32, b: u32, arm: vec3<f32>, arm_other: vec3<f32>, d: vec3<f32>, e: vec3<f32>) -> f32 {
    var sum = speed[a].w * dot(d, e) + dot(eased(a, cross(arm, d)), cross(arm, e));
    if (b != NO_BODY) {
        sum += speed[b].w * dot(d, e) + dot(eased(b, cross(arm_other, d)), cross(arm_other, e));
    }
    return sum;
}

fn tangent(n: vec3<f32>) -> vec3<f32> {
    let axis = select(vec3<f32>(1.0, 0.0, 0.0), vec3<f32>(0.0, 1.0, 0.0), abs(n.x) > 0.6);
    return normalize(cross(n, axis));
}

fn prepare(m: u32) {
    let a = m / RIGID_SLOTS;
    let b = other_body(m);
    for (var k = 0u; k < manifolds[m].count; k++) {
        let at = 4u * m + k;
        let n = contacts[at].normal.xyz;
        let arm = contacts[at].arm.xyz;
        let arm_other = contacts[at].arm_other.xyz;
        let ease = ease_between(a, b, arm, arm_other, n, n);
        let t = tangent(n);
        let s = cross(n, t);
        let tt = ease_between(a, b, arm, arm_other, t, t);
        let ts = ease_between(a, b, arm, arm_other, t, s);
        let ss = ease_between(a, b, arm, arm_other, s, s);
        // One number for both tangents, the one along which most moves: what slides is then held against
        // its motion, not aside.
        let most = 0.5 * (tt + ss) + sqrt(0.25 * (tt - ss) * (tt - ss) + ts * ts);
        contacts[at].arm.w = select(0.0, 1.0 / ease, ease > 0.0);
        contacts[at].grip = vec4<f32>(select(0.0, 1.0 / most, most > 0.0), 0.0, 0.0, 0.0);
        contacts[at].normal.w = -dot(relative(a, b, arm, arm_other), n);
        // What it was along the old surface, along the new one.
        let held = contacts[at].impulse.xyz;
        contacts[at].impulse = vec4<f32>(held - n * dot(held, n), contacts[at].impulse.w);
    }
}

fn start_warm(m: u32) {
    let a = m / RIGID_SLOTS;
    let b = other_body(m);
    for (var k = 0u; k < manifolds[m].count; k++) {
        let c = contacts[4u * m + k];
        push(a, b, c.arm.xyz, c.arm_other.xyz, c.impulse.xyz + c.normal.xyz * c.impulse.w);
    }
}

// How an overlap pushes: the rate at which it goes, the share of a rigid contact's impulse, the share
// of the impulse so far that it gives back.
fn soft() -> vec3<f32> {
    let omega = 6.2831853 * min(RIGID_HERTZ, 0.25 / substep.dt_s);
    let one = 2.0 * RIGID_DAMPING + substep.dt_s * omega;
    let two = substep.dt_s * omega * one;
    let three = 1.0 / (1.0 + two);
    return vec3<f32>(omega / one, two * three, three);
}

fn solve(m: u32, biased: bool, spring: vec3<f32>) {
    let a = m / RIGID_SLOTS;
    let b = other_body(m);
    let friction = manifolds[m].friction;
    for (var k = 0u; k < manifolds[m].count; k++) {
        let at = 4u * m + k;
        let c = contacts[at];
        let n = c.normal.xyz;
        let gap_m = c.local.w;
        var impulse = c.impulse;

        // A gap that this substep's impulses closed is none for the calm rounds.
        var bias = select(max(gap_m, 0.0) / substep.dt_s, 0.0, !biased && c.grip.w > 0.0);
        var share = 1.0;
        var given_back = 0.0;
        if (biased && gap_m < 0.0) {
            bias = max(spring.x * gap_m, -RIGID_PUSH_RATE * shapes[a].radius_m);
            share = spring.y;
            given_back = spring.z;
        }
        let approach = dot(relative(a, b, c.arm.xyz, c.arm_other.xyz), n);
        var wanted = impulse.w - c.arm.w * share * (approach + bias) - given_back * impulse.w;
        if (gap_m < 0.0) {
            wanted = max(wanted, impulse.w - c.arm.w * approach);
        }
        let normal_now = max(wanted, 0.0);
        push(a, b, c.arm.xyz, c.arm_other.xyz, n * (normal_now - impulse.w));
        impulse.w = normal_now;

        let v = relative(a, b, c.arm.xyz, c.arm_other.xyz);
        var along = impulse.xyz - c.grip.x * (v - n * dot(v, n));
        let most = friction * normal_now;
        let size = length(along);
        along *= select(1.0, most / max(size, 1e-30), size > most);
        push(a, b, c.arm.xyz, c.arm_other.xyz, along - impulse.xyz);
        contacts[at].impulse = vec4<f32>(along, normal_now);
        contacts[at].grip.w = max(c.grip.w, normal_now);
    }
}

// What came fast enough leaves with its share of that speed.
fn bounce(m: u32) {
    let a = m / RIGID_SLOTS;
    let b = other_body(m);
    let restitution = manifolds[m].restitution;
    // Speeds that weight alone brings within a few substeps do not bounce.
    let resting = 4.0 * length(params.gravity_m_s2) * substep.dt_s;
    for (var k = 0u; k < manifolds[m].count; k++) {
        let at = 4u * m + k;
        let c = contacts[at];
        if (restitution == 0.0 || c.normal.w < resting || c.grip.w == 0.0) {
            continue;
        }
        let approach = dot(relative(a, b, c.arm.xyz, c.arm_other.xyz), c.normal.xyz);
        let more = max(-c.arm.w * (approach - restitution * c.normal.w), -c.impulse.w);
        push(a, b, c.arm.xyz, c.arm_other.xyz, c.normal.xyz * more);
        contacts[at].impulse.w = c.impulse.w + more;
    }
}

// The first colour that neither body has yet; RIGID_COLOURS where there is none.
fn colour_all() -> u32 {
    var most = 0u;
    for (var m = 0u; m < arrayLength(&manifolds); m++) {
        if (manifolds[m].count == 0u) {
            continue;
        }
        let a = m / RIGID_SLOTS;
        let b = other_body(m);
        var used = taken[a];
        if (b != NO_BODY) {
            used |= taken[b];
        }
        var colour = RIGID_COLOURS;
        for (var word = 0u; word < 4u; word++) {
            if (used[word] != 0xffffffffu) {
                colour = 32u * word + firstTrailingBit(~used[word]);
                break;
            }
        }
        let bit = 1u << (colour & 31u);
        let mask = select(vec4<u32>(0u), vec4<u32>(bit), vec4<u32>(colour >> 5u) == vec4<u32>(0u, 1u, 2u, 3u));
        taken[a] |= mask;
        if (b != NO_BODY) {
            taken[b] |= mask;
            ease_diagonal[a].w = -1.0;
            ease_diagonal[b].w = -1.0;
        }
        manifolds[m].colour = colour;
        most = max(most, colour + 1u);
    }
    return most;
}

// Takes a sum of two words a coordinate. What the low one holds beyond its bits goes to the high one first, exactly.
fn take_driven(at: u32) -> vec3<f32> {
    var sum = vec3<f32>(0.0);
    for (var k = 0u; k < 3u; k++) {
        let low = driven[at + 3u + k];
        let high = bitcast<i32>(driven[at + k] + (low >> DRIVEN_BITS));
        sum[k] = (f32(high) * DRIVEN_LOW + f32(low & ((1u << DRIVEN_BITS) - 1u))) * DRIVEN_UNIT;
        driven[at + k] = 0u;
        driven[at + 3u + k] = 0u;
    }
    return sum;
}

// Gravity, what the grid and fields gave, and the spin that follows from the angular momentum.
fn drive(b: u32) {
    var body = bodies[b];
    let shape = shapes[b];
    let held = body.velocity.w != 0.0;
    let mass = shape.inertia[0].w;
    var momentum = vec3<f32>(0.0);
    var turning = vec3<f32>(0.0);
    for (var k = 0u; k < shape.chunks; k++) {
        momentum += given[2u * (shape.first_chunk + k)].xyz;
        turning += given[2u * (shape.first_chunk + k) + 1u].xyz;
    }
    // What hangs on soft matter, or meets it, moves as it does: by the velocity at the end of the substep.
    let alone = shape.bonded == 0u && all(momentum == vec3<f32>(0.0)) && all(turning == vec3<f32>(0.0));
    momentum += mass * take_driven(12u * b);
    turning += mass * shape.radius_m * take_driven(12u * b + 6u);
    let driven_v = body.velocity.xyz + momentum / mass + substep.dt_s * (params.gravity_m_s2 + objects[shape.object].xyz);
    body.angular_momentum += vec4<f32>(turning, 0.0);
    let followed = followed_share(body, shape, driven_v);
    let v = driven_v * followed;
    body.angular_momentum *= followed;
    bodies[b].angular_momentum = body.angular_momentum;
    speed[b] = vec4<f32>(v, 1.0 / mass);
    spin[b] = vec4<f32>(spin_of(shape.inverse, body.turn, body.angular_momentum.xyz), select(0.0, 1.0, alone));
    let r = rotation_of(body.turn);
    let columns = mat3x3<f32>(shape.inverse[0].xyz, shape.inverse[1].xyz, shape.inverse[2].xyz);
    let ease = r * columns * transpose(r);
    let energy = mass * dot(v, v) + dot(body.angular_momentum.xyz, spin[b].xyz);
    ease_diagonal[b] = vec4<f32>(ease[0].x, ease[1].y, ease[2].z, energy);
    ease_mixed[b] = vec4<f32>(ease[0].y, ease[0].z, ease[1].z, 0.0);
    if (held) {
        // As fast as its pin.
        speed[b] = vec4<f32>(body.velocity.xyz, 0.0);
        spin[b] = vec4<f32>(0.0);
        ease_diagonal[b] = vec4<f32>(0.0, 0.0, 0.0, -1.0);
        ease_mixed[b] = vec4<f32>(0.0);
        bodies[b].angular_momentum = vec4<f32>(0.0);
    }
}

// Angular momentum with what contacts added to the spin.
fn momentum_now(b: u32) -> vec3<f32> {
    let q = bodies[b].turn;
    let kept = bodies[b].angular_momentum.xyz;
    let change = spin[b].xyz - spin_of(shapes[b].inverse, q, kept);
    return kept + turned(q, tensor(shapes[b].inertia, turned_back(q, change)));
}

// A rotation by dt omega after q.
fn advanced(q: vec4<f32>, omega: vec3<f32>, dt_s: f32) -> vec4<f32> {
    let angle = 0.5 * dt_s * length(omega);
    let scale = select(0.5 * dt_s * (1.0 - angle * angle / 6.0), sin(angle) * 0.5 * dt_s / max(angle, 1e-20), angle > 1e-2);
    let c = select(1.0 - 0.5 * angle * angle * (1.0 - angle * angle / 12.0), cos(angle), angle > 1e-2);
    let h = omega * scale;
    let turned_by = vec4<f32>(c * q.xyz + q.w * h + cross(h, q.xyz), c * q.w - dot(h, q.xyz));
    return turned_by * inverseSqrt(dot(turned_by, turned_by));
}

// Positions add up in whole quanta and what is left of one, so that rounding stops no slow body; a body
// that flies falls along its parabola. Orientation by the implicit midpoint, which keeps the energy of a
// body that tumbles freely as well as its angular momentum.
fn travel(b: u32) {
    let flies = all(taken[b] == vec4<u32>(0u)) && spin[b].w != 0.0;
    let acceleration = params.gravity_m_s2 + objects[shapes[b].object].xyz;
    let late = select(vec3<f32>(0.0), 0.5 * substep.dt_s * acceleration, flies);
    let low = bodies[b].low.xyz + (speed[b].xyz - late) * substep.dt_s;
    let quanta = round(low / RIGID_QUANTUM_M);
    let sum = bodies[b].whole.xyz + vec3<i32>(quanta);
    let metres = sum >> vec3<u32>(RIGID_QUANTUM_BITS);
    let whole = sum - (metres << vec3<u32>(RIGID_QUANTUM_BITS));
    let metre = bodies[b].metre.xyz + metres;
    let rest = low - quanta * RIGID_QUANTUM_M;
    bodies[b].metre = vec4<i32>(metre, 0);
    bodies[b].whole = vec4<i32>(whole, 0);
    bodies[b].low = vec4<f32>(rest, bodies[b].low.w);
    bodies[b].centre = vec4<f32>(vec3<f32>(metre) + (vec3<f32>(whole) * RIGID_QUANTUM_M + rest), 0.0);
    let momentum = momentum_now(b);
    let q = bodies[b].turn;
    var omega = spin[b].xyz;
    if (speed[b].w != 0.0) {
        for (var k = 0u; k < 4u; k++) {
            omega = spin_of(shapes[b].inverse, advanced(q, omega, 0.5 * substep.dt_s), momentum);
        }
    }
    // Kept for the contacts that follow: they act on the body as it stood.
    old_turn[b] = q;
    bodies[b].turn = advanced(q, omega, substep.dt_s);
}

var<workgroup> old_turn: array<vec4<f32>, RIGID_BODIES>;

// Velocities at the end; the angular momentum gains what contacts added to the spin. What stands still does no work: where
// rounds that do not settle, between surfaces that leave no room, say otherwise, all that the body had is left to it.
fn settle(b: u32) {
    let held = bodies[b].velocity.w;
    let q = old_turn[b];
    let kept = bodies[b].angular_momentum.xyz;
    let change = spin[b].xyz - spin_of(shapes[b].inverse, q, kept);
    let momentum = kept + turned(q, tensor(shapes[b].inertia, turned_back(q, change)));
    let energy = dot(speed[b].xyz, speed[b].xyz) / max(speed[b].w, 1e-30) + dot(momentum, spin[b].xyz);
    let had = ease_diagonal[b].w;
    let grew = had >= 0.0 && energy > had && any(taken[b] != vec4<u32>(0u));
    let share = select(1.0, sqrt(had / energy), grew);
    bodies[b].velocity = vec4<f32>(speed[b].xyz * share, held);
    bodies[b].angular_momentum = vec4<f32>(momentum * share, 0.0);
}

// What a sweep does.
const START_WARM: u32 = 0u;
const SOLVE_BIASED: u32 = 1u;
const SOLVE_CALM: u32 = 2u;
const BOUNCES: u32 = 3u;

// All manifolds once, colour after colour.
fn sweep(act: u32, last: u32, lane: u32, spring: vec3<f32>) {
    let slots = arrayLength(&manifolds);
    for (var colour = 0u; colour < last; colour++) {
        let alone = colour == RIGID_COLOURS;
        let step = select(RIGID_LANES, 1u, alone);
        for (var m = select(lane, slots * lane, alone); m < slots; m += step) {
            if (manifolds[m].count == 0u || manifolds[m].colour != colour) {
                continue;
            }
            if (act == START_WARM) {
                start_warm(m);
            } else if (act == BOUNCES) {
                bounce(m);
            } else {
                solve(m, act == SOLVE_BIASED, spring);
            }
        }
        workgroupBarrier();
    }
}

@compute @workgroup_size(RIGID_LANES)
fn main(@builtin(local_invocation_index) lane: u32) {
    let count = arrayLength(&bodies);
    for (var b = lane; b < count; b += RIGID_LANES) {
        taken[b] = vec4<u32>(0u);
        drive(b);
    }
    workgroupBarrier();
    if (lane == 0u) {
        colours = colour_all();
    }
    let last = workgroupUniformLoad(&colours);
    storageBarrier();
    for (var m = lane; m < arrayLength(&manifolds); m += RIGID_LANES) {
        prepare(m);
    }
    workgroupBarrier();
    let spring = soft();
    sweep(START_WARM, last, lane, spring);
    for (var round = 0u; round < RIGID_ROUNDS; round++) {
        sweep(SOLVE_BIASED, last, lane, spring);
    }
    for (var b = lane; b < count; b += RIGID_LANES) {
        travel(b);
    }
    workgroupBarrier();
    for (var round = 0u; round < RIGID_CALM_ROUNDS; round++) {
        sweep(SOLVE_CALM, last, lane, spring);
    }
    sweep(BOUNCES, last, lane, spring);
    for (var b = lane; b < count; b += RIGID_LANES) {
        settle(b);
    }
}
