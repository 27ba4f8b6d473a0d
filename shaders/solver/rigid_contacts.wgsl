// Where a body meets colliders and other bodies. One workgroup a body: each of its surface points
// slides down the other's distance to where the two surfaces face each other, and at most four of the
// points in reach are kept: the deepest, the one farthest from it, and the two that widen them most. Of
// more things that touch it than there are slots the deepest are kept.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read> colliders: array<Collider>;
@group(0) @binding(2) var<storage, read> bodies: array<Body>;
@group(0) @binding(3) var<storage, read> shapes: array<Shape>;
// Of all surfaces.
@group(0) @binding(4) var<storage, read> points: array<vec4<f32>>;
@group(0) @binding(5) var<storage, read> field: array<f32>;
@group(0) @binding(6) var<storage, read_write> manifolds: array<Manifold>;
@group(0) @binding(7) var<storage, read_write> contacts: array<Contact>;
// Two vec4 a point: its place in the body frame and its gap, the normal.
@group(0) @binding(8) var<storage, read_write> scratch: array<vec4<f32>>;
@group(0) @binding(9) var<storage, read_write> control: Control;
var<immediate> substep: Substep;

// Colliders and bodies within reach: a bit each, then a list.
var<workgroup> reached: array<atomic<u32>, 8>;
var<workgroup> listed: array<u32, 256>;
var<workgroup> listed_count: u32;
// The smallest gap in each slot that is taken, how many are, and the one of the present thing.
var<workgroup> slot_gap_m: array<f32, RIGID_SLOTS>;
var<workgroup> slots_taken: u32;
var<workgroup> own_slot: u32;
var<workgroup> best_value: array<f32, RIGID_LANES>;
var<workgroup> best_point: array<u32, RIGID_LANES>;
// The contacts of the substep before: place, impulse, with whom.
var<workgroup> old_local: array<vec4<f32>, RIGID_OLD>;
var<workgroup> old_impulse: array<vec4<f32>, RIGID_OLD>;
var<workgroup> old_other: array<u32, RIGID_OLD>;

struct Facing {
    distance_m: f32,
    normal: vec3<f32>,
}

// Past the edges of a box its nearest point counts, not the planes of its faces: what slides along it meets the edge.
fn beside_collider(c: Collider, x: vec3<f32>) -> Facing {
    let d = x - c.at.xyz;
    let beyond = max(abs(d) - c.shape.xyz, vec3<f32>(0.0));
    let away_m = length(beyond);
    if (c.at.w == 1.0 && away_m > 0.0) {
        return Facing(away_m, sign(d) * beyond / away_m);
    }
    let t = touch(c, x);
    return Facing(t.distance_m, surface_normal(c, t.face, x));
}

// The other's surface as seen from a point of the world.
fn facing(other: u32, x: vec3<f32>) -> Facing {
    if (other < params.collider_count) {
        return beside_collider(colliders[other], x);
    }
    let b = other - params.collider_count;
    let q = bodies[b].turn;
    let level = level_at(b, turned_back(q, x - bodies[b].centre.xyz));
    let size = max(length(level.gradient), 1e-6);
    return Facing(level.distance_m / size, turned(q, level.gradient / size));
}

struct Found {
    local: vec3<f32>,
    gap_m: f32,
    normal: vec3<f32>,
}

const NOWHERE: f32 = 1e30;

fn outward_at(a: u32, x: vec3<f32>) -> vec3<f32> {
    let g = level_at(a, x).gradient;
    return g * inverseSqrt(max(dot(g, g), 1e-12));
}

// The point of the body's surface near `start` that is nearest to the other. Both surfaces turn towards
// each other along the way: how fast is measured over one spacing of the points, which is Newton's
// method with a slope that small bumps do not upset. Where they turn by far more than a right angle something sharp lies
// between the points of the surface: that is found by halves.
fn slide(a: u32, other: u32, start: vec3<f32>, margin_m: f32) -> Found {
    let q = bodies[a].turn;
    let centre = bodies[a].centre.xyz;
    var step_m = shapes[a].apart_m;
    var x = start;
    var seen = facing(other, centre + turned(q, x));
    // Whatever touches the surface is no farther from the nearest point, and what bends little much less.
    if (seen.distance_m > margin_m + step_m) {
        return Found(x, NOWHERE, seen.normal);
    }
    var far = seen.distance_m > margin_m + 0.35 * step_m;
    var rounds = RIGID_SLIDES;
    var outward = vec3<f32>(0.0);
    for (var k = 0u; k < rounds; k++) {
        let level = level_at(a, x);
        let size2 = max(dot(level.gradient, level.gradient), 1e-6);
        x -= level.gradient * (level.distance_m / size2);
        outward = level.gradient * inverseSqrt(size2);
        let n = turned_back(q, seen.normal);
        let down = outward * dot(n, outward) - n;
        let tilt = length(down);
        if (tilt < 1e-4 || k + 1u == rounds) {
            break;
        }
        let d = down / tilt;
        let ahead = x + step_m * d;
        let there = turned_back(q, facing(other, centre + turned(q, ahead)).normal);
        let bend = dot(outward_at(a, ahead) - outward + there - n, d);
        x += d * (step_m * min(tilt / max(bend, 0.05), 1.0));
        if (bend > RIGID_SHARP) {
            far = false;
            rounds = 2u * RIGID_SLIDES;
            step_m *= 0.5;
        } else if (far) {
            return Found(x, NOWHERE, seen.normal);
        }
        seen = facing(other, centre + turned(q, x));
    }
    seen = facing(other, centre + turned(q, x));
    // A point on the far side of something thin does not touch what is before it.
    if (dot(turned(q, outward), seen.normal) > 0.2) {
        return Found(x, NOWHERE, seen.normal);
    }
    return Found(x, seen.distance_m - select(0.0, bodies[a].low.w, other < params.collider_count), seen.normal);
}

// The point with the largest value, the smaller index among equals; RIGID_POINTS where none has one.
fn winner(lane: u32, value: f32, point: u32) -> u32 {
    best_value[lane] = value;
    best_point[lane] = select(RIGID_POINTS, point, value > -NOWHERE);
    workgroupBarrier();
    for (var half = RIGID_LANES / 2u; half > 0u; half /= 2u) {
        if (lane < half) {
            let v = best_value[lane + half];
            let p = best_point[lane + half];
            if (v > best_value[lane] || (v == best_value[lane] && p < best_point[lane])) {
                best_value[lane] = v;
                best_point[lane] = p;
            }
        }
        workgroupBarrier();
    }
    return workgroupUniformLoad(&best_point[0]);
}

// How far a point lies outside a triangle, in its plane, beyond the side that it is farthest from.
fn outside(p: vec3<f32>, a: vec3<f32>, b: vec3<f32>, c: vec3<f32>) -> f32 {
    let up = cross(b - a, c - a);
    let m = up * inverseSqrt(max(dot(up, up), 1e-30));
    let ab = dot(cross(normalize(b - a), m), p - a);
    let bc = dot(cross(normalize(c - b), m), p - b);
    let ca = dot(cross(normalize(a - c), m), p - c);
    return max(ab, max(bc, ca));
}

fn old_contacts(a: u32, lane: u32) {
    for (var k = lane; k < RIGID_OLD; k += RIGID_LANES) {
        let slot = a * RIGID_SLOTS + k / 4u;
        let kept = k % 4u < manifolds[slot].count;
        old_other[k] = select(0xffffffffu, manifolds[slot].other, kept);
        old_local[k] = contacts[4u * slot + k % 4u].local;
        old_impulse[k] = contacts[4u * slot + k % 4u].impulse;
    }
}

// How fast two things may approach each other, and how far from touching they are.
fn closing_m_s(a: u32, other: u32) -> f32 {
    let own = length(bodies[a].velocity.xyz) + shapes[a].radius_m * length(spin_of(shapes[a].inverse, bodies[a].turn, bodies[a].angular_momentum.xyz));
    if (other < params.collider_count) {
        return own;
    }
    let b = other - params.collider_count;
    return own + length(bodies[b].velocity.xyz) + shapes[b].radius_m * length(spin_of(shapes[b].inverse, bodies[b].turn, bodies[b].angular_momentum.xyz));
}

fn margin_of(a: u32, other: u32) -> f32 {
    return substep.dt_s * (closing_m_s(a, other) + 2.0 * substep.dt_s * length(params.gravity_m_s2)) + 0.05 * shapes[a].apart_m;
}

fn within_reach(a: u32, other: u32) -> bool {
    let x = bodies[a].centre.xyz;
    let margin_m = margin_of(a, other);
    if (other < params.collider_count) {
        return touch(colliders[other], x).distance_m < shapes[a].radius_m + margin_m;
    }
    let b = other - params.collider_count;
    // Parts of one object are held together by what is between them.
    if (shapes[b].object == shapes[a].object) {
        return false;
    }
    return distance(x, bodies[b].centre.xyz) < shapes[a].radius_m + shapes[b].radius_m + margin_m;
}

// Takes the impulse of the nearest old contact with the same other.
fn inherit(other: u32, local: vec3<f32>, apart_m: f32) -> vec4<f32> {
    var nearest = apart_m * apart_m;
    var found = RIGID_OLD;
    for (var k = 0u; k < RIGID_OLD; k++) {
        let d = old_local[k].xyz - local;
        if (old_other[k] == other && dot(d, d) < nearest) {
            nearest = dot(d, d);
            found = k;
        }
    }
    if (found == RIGID_OLD) {
        return vec4<f32>(0.0);
    }
    old_other[found] = 0xffffffffu;
    return old_impulse[found];
}

// Lists what is within reach of the body, by its number; how much that is.
fn list_reached(a: u32, lane: u32) -> u32 {
    let others = params.collider_count + arrayLength(&bodies);
    if (lane < 8u) {
        atomicStore(&reached[lane], 0u);
    }
    workgroupBarrier();
    for (var other = lane; other < others; other += RIGID_LANES) {
        if (other != params.collider_count + a && within_reach(a, other)) {
            atomicOr(&reached[other >> 5u], 1u << (other & 31u));
        }
    }
    workgroupBarrier();
    if (lane == 0u) {
        var count = 0u;
        for (var word = 0u; word < 8u; word++) {
            var bits = atomicLoad(&reached[word]);
            while (bits != 0u) {
                listed[count] = 32u * word + firstTrailingBit(bits);
                bits &= bits - 1u;
                count += 1u;
            }
        }
        listed_count = count;
        slots_taken = 0u;
    }
    return workgroupUniformLoad(&listed_count);
}

// Slides all points towards the other; the deepest, RIGID_POINTS where none is in reach.
fn deepest_point(a: u32, other: u32, lane: u32) -> u32 {
    let first = shapes[a].first_point;
    let margin_m = margin_of(a, other);
    var value = -NOWHERE;
    var mine = RIGID_POINTS;
    for (var p = lane; p < shapes[a].points; p += RIGID_LANES) {
        let found = slide(a, other, points[first + p].xyz, margin_m);
        scratch[2u * (first + p)] = vec4<f32>(found.local, select(NOWHERE, found.gap_m, found.gap_m < margin_m));
        scratch[2u * (first + p) + 1u] = vec4<f32>(found.normal, 0.0);
        if (found.gap_m < margin_m && -found.gap_m > value) {
            value = -found.gap_m;
            mine = p;
        }
    }
    storageBarrier();
    return winner(lane, value, mine);
}

// A slot for what comes as near as this: a free one, or that of what is farthest off; RIGID_SLOTS where all are nearer.
fn slot_for(gap_m: f32) -> u32 {
    var slot = slots_taken;
    if (slot < RIGID_SLOTS) {
        slots_taken += 1u;
    } else {
        atomicStore(&control.unmet, 1u);
        slot = 0u;
        for (var k = 1u; k < RIGID_SLOTS; k++) {
            slot = select(slot, k, slot_gap_m[k] > slot_gap_m[slot]);
        }
        if (gap_m >= slot_gap_m[slot]) {
            return RIGID_SLOTS;
        }
    }
    slot_gap_m[slot] = gap_m;
    return slot;
}

// The deepest point, and up to three that spread from it.
fn spread_from(a: u32, p0: u32, lane: u32) -> vec4<u32> {
    let count = shapes[a].points;
    let first = shapes[a].first_point;
    let least = 0.25 * shapes[a].apart_m;
    let x0 = scratch[2u * (first + p0)].xyz;
    var chosen = vec4<u32>(p0, RIGID_POINTS, RIGID_POINTS, RIGID_POINTS);
    var value = -NOWHERE;
    var mine = RIGID_POINTS;
    for (var p = lane; p < count; p += RIGID_LANES) {
        let s = scratch[2u * (first + p)];
        let far = distance(s.xyz, x0);
        if (s.w < NOWHERE && far > max(value, least)) {
            value = far;
            mine = p;
        }
    }
    chosen.y = winner(lane, value, mine);
    let x1 = scratch[2u * (first + min(chosen.y, count - 1u))].xyz;

    value = -NOWHERE;
    for (var p = lane; p < count; p += RIGID_LANES) {
        let s = scratch[2u * (first + p)];
        let far = length(cross(s.xyz - x0, x1 - x0)) / max(distance(x0, x1), 1e-20);
        if (s.w < NOWHERE && far > max(value, least)) {
            value = far;
            mine = p;
        }
    }
    chosen.z = select(RIGID_POINTS, winner(lane, value, mine), chosen.y < RIGID_POINTS);
    let x2 = scratch[2u * (first + min(chosen.z, count - 1u))].xyz;

    value = -NOWHERE;
    for (var p = lane; p < count; p += RIGID_LANES) {
        let s = scratch[2u * (first + p)];
        let far = outside(s.xyz, x0, x1, x2);
        if (s.w < NOWHERE && far > max(value, least)) {
            value = far;
            mine = p;
        }
    }
    chosen.w = select(RIGID_POINTS, winner(lane, value, mine), chosen.z < RIGID_POINTS);
    return chosen;
}

@compute @workgroup_size(RIGID_LANES)
fn main(@builtin(local_invocation_index) lane: u32, @builtin(workgroup_id) group: vec3<u32>) {
    let a = group.x;
    old_contacts(a, lane);
    let count = list_reached(a, lane);
    for (var k = 0u; k < count; k++) {
        let other = workgroupUniformLoad(&listed[k]);
        let deepest = deepest_point(a, other, lane);
        if (deepest == RIGID_POINTS) {
            continue;
        }
        if (lane == 0u) {
            own_slot = slot_for(scratch[2u * (shapes[a].first_point + deepest)].w);
        }
        let slot = workgroupUniformLoad(&own_slot);
        if (slot == RIGID_SLOTS) {
            continue;
        }
        let chosen = spread_from(a, deepest, lane);
        if (lane == 0u) {
            keep(a, slot, other, chosen);
        }
        workgroupBarrier();
    }
    for (var slot = workgroupUniformLoad(&slots_taken) + lane; slot < RIGID_SLOTS; slot += RIGID_LANES) {
        manifolds[a * RIGID_SLOTS + slot].count = 0u;
    }
}

// Writes a manifold and its contacts.
fn keep(a: u32, own: u32, other: u32, chosen: vec4<u32>) {
    let slot = a * RIGID_SLOTS + own;
    let first = shapes[a].first_point;
    var count = 0u;
    for (var c = 0u; c < 4u; c++) {
        if (chosen[c] == RIGID_POINTS) {
            break;
        }
        let s = scratch[2u * (first + chosen[c])];
        let n = scratch[2u * (first + chosen[c]) + 1u].xyz;
        let arm = turned(bodies[a].turn, s.xyz);
        var arm_other = vec3<f32>(0.0);
        if (other >= params.collider_count) {
            arm_other = arm + (bodies[a].centre.xyz - bodies[other - params.collider_count].centre.xyz);
        }
        contacts[4u * slot + c] = Contact(s, vec4<f32>(n, 0.0), vec4<f32>(arm, 0.0), vec4<f32>(arm_other, 0.0), vec4<f32>(0.0), inherit(other, s.xyz, shapes[a].apart_m));
        count += 1u;
    }
    var surface = vec2<f32>(shapes[a].friction, shapes[a].restitution);
    if (other < params.collider_count) {
        let met = colliders[other].surface;
        surface = vec2<f32>(sqrt(surface.x * met.x), max(surface.y, met.y));
    } else {
        let b = other - params.collider_count;
        surface = vec2<f32>(sqrt(surface.x * shapes[b].friction), max(surface.y, shapes[b].restitution));
    }
    manifolds[slot] = Manifold(other, count, 0u, 0u, surface.x, surface.y, vec2<f32>(0.0));
}
