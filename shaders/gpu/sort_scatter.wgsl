// Radix sort, last pass of a digit: each key goes to
//   (keys of smaller digits) + (same digit, earlier blocks) + (same digit, earlier in this block).
// The last term comes from ballots: DIGIT_BITS of them stand in for a match instruction.

var<immediate> shift: u32;

@group(0) @binding(0) var<storage, read> extent: array<u32>;
@group(0) @binding(1) var<storage, read> keys: array<u32>;
@group(0) @binding(2) var<storage, read> values: array<u32>;
@group(0) @binding(3) var<storage, read> histogram: array<u32>;
@group(0) @binding(4) var<storage, read> totals: array<u32>;
@group(0) @binding(5) var<storage, read_write> sorted_keys: array<u32>;
@group(0) @binding(6) var<storage, read_write> sorted_values: array<u32>;

const DIGITS_A_THREAD: u32 = (DIGITS + WORKGROUP - 1u) / WORKGROUP;

// First a count of each digit by subgroup, then where the subgroup's next key of that digit goes.
var<workgroup> next: array<atomic<u32>, SUBGROUPS * DIGITS>;

// Lanes of this subgroup that hold the same digit as this one, of those that hold a key at all.
fn peers_of(digit: u32, holds: bool) -> vec4<u32> {
    var peers = subgroupBallot(holds);
    for (var bit = 0u; bit < DIGIT_BITS; bit++) {
        let one = ((digit >> bit) & 1u) == 1u;
        let vote = subgroupBallot(one);
        peers &= select(~vote, vote, vec4<bool>(one));
    }
    return peers;
}

// The lowest lane of a mask, 0 where it is empty.
fn first_lane(mask: vec4<u32>) -> u32 {
    if (mask.x != 0u) { return countTrailingZeros(mask.x); }
    if (mask.y != 0u) { return 32u + countTrailingZeros(mask.y); }
    if (mask.z != 0u) { return 64u + countTrailingZeros(mask.z); }
    return select(0u, 96u + countTrailingZeros(mask.w), mask.w != 0u);
}

fn ones(mask: vec4<u32>) -> u32 {
    let counts = countOneBits(mask);
    return counts.x + counts.y + counts.z + counts.w;
}

// The lanes before this one.
fn lanes_before(lane: u32) -> vec4<u32> {
    let first = vec4<u32>(0u, 32u, 64u, 96u);
    let below = clamp(vec4<i32>(i32(lane)) - vec4<i32>(first), vec4<i32>(0), vec4<i32>(32));
    let partial = (vec4<u32>(1u) << min(vec4<u32>(below), vec4<u32>(31u))) - vec4<u32>(1u);
    return select(partial, vec4<u32>(0xffffffffu), below == vec4<i32>(32));
}

@compute @workgroup_size(WORKGROUP)
fn main(
    @builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(subgroup_id) subgroup: u32, @builtin(num_subgroups) subgroups: u32,
    @builtin(subgroup_invocation_id) lane: u32, @builtin(subgroup_size) lanes: u32,
) {
    let at = Lane(subgroup, subgroups, lane, lanes);
    let thread = subgroup * lanes + lane;
    let block_size = WORKGROUP * ELEMENTS_A_THREAD;
    let n = extent[0];
    let blocks = (n + block_size - 1u) / block_size;
    let block = group.y * groups.x + group.x;
    let before = lanes_before(lane);
    let mine = subgroup * DIGITS;

    for (var slot = thread; slot < SUBGROUPS * DIGITS; slot += WORKGROUP) { atomicStore(&next[slot], 0u); }
    workgroupBarrier();

    // Counts, and the rank of each key among its subgroup's.
    var rank: array<u32, ELEMENTS_A_THREAD>;
    var held: array<u32, ELEMENTS_A_THREAD>;
    for (var round = 0u; round < ELEMENTS_A_THREAD; round++) {
        let i = element(block, at, round);
        let holds = i < n;
        var key = 0u;
        if (holds) { key = keys[i]; }
        let digit = (key >> shift) & (DIGITS - 1u);
        let peers = peers_of(digit, holds);
        let earlier = ones(peers & before);
        // The first of the peers counts for all of them and tells them how many came in earlier rounds.
        var count = 0u;
        if (holds && earlier == 0u) { count = atomicAdd(&next[mine + digit], ones(peers)); }
        held[round] = key;
        rank[round] = subgroupShuffle(count, first_lane(peers)) + earlier;
    }
    workgroupBarrier();

    // Where each subgroup's first key of each digit goes.
    var sum = 0u;
    for (var k = 0u; k < DIGITS_A_THREAD; k++) {
        let digit = thread * DIGITS_A_THREAD + k;
        if (digit < DIGITS) { sum += totals[digit]; }
    }
    var smaller = workgroup_exclusive(sum, at).x;
    for (var k = 0u; k < DIGITS_A_THREAD; k++) {
        let digit = thread * DIGITS_A_THREAD + k;
        if (digit >= DIGITS || block >= blocks) { break; }
        var place = smaller + histogram[digit * blocks + block];
        smaller += totals[digit];
        for (var s = 0u; s < subgroups; s++) {
            place += atomicExchange(&next[s * DIGITS + digit], place);
        }
    }
    workgroupBarrier();

    for (var round = 0u; round < ELEMENTS_A_THREAD; round++) {
        let i = element(block, at, round);
        if (i < n) {
            let key = held[round];
            let to = atomicLoad(&next[mine + ((key >> shift) & (DIGITS - 1u))]) + rank[round];
            sorted_keys[to] = key;
            sorted_values[to] = values[i];
        }
    }
}
