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

const_assert ELEMENTS_A_THREAD == 16u;
const DIGITS_A_THREAD: u32 = (DIGITS + WORKGROUP - 1u) / WORKGROUP;

// First a count of each digit by subgroup, then where the subgroup's next key of that digit goes.
var<workgroup> next: array<atomic<u32>, SUBGROUPS * DIGITS>;

// Lanes of this subgroup whose digit agrees with this lane's in one bit. Subgroups of up to 32 lanes,
// which is most devices, need the first word of a ballot alone.
fn agreeing(peers: vec4<u32>, digit: u32, bit: u32) -> vec4<u32> {
    if (bit >= DIGIT_BITS) { return peers; }
    let one = ((digit >> bit) & 1u) == 1u;
    let vote = subgroupBallot(one);
    if (!WIDE) { return vec4<u32>(peers.x & select(~vote.x, vote.x, one), 0u, 0u, 0u); }
    return peers & select(~vote, vote, vec4<bool>(one));
}

// Lanes of this subgroup that hold the same digit as this one, of those that hold a key at all.
fn peers_of(digit: u32, holds: bool) -> vec4<u32> {
    var peers = subgroupBallot(holds);
    peers = agreeing(peers, digit, 0u);
    peers = agreeing(peers, digit, 1u);
    peers = agreeing(peers, digit, 2u);
    peers = agreeing(peers, digit, 3u);
    peers = agreeing(peers, digit, 4u);
    peers = agreeing(peers, digit, 5u);
    peers = agreeing(peers, digit, 6u);
    return agreeing(peers, digit, 7u);
}

// The lowest lane of a mask, 0 where it is empty.
fn first_lane(mask: vec4<u32>) -> u32 {
    if (!WIDE || mask.x != 0u) { return countTrailingZeros(mask.x) & 31u; }
    if (mask.y != 0u) { return 32u + countTrailingZeros(mask.y); }
    if (mask.z != 0u) { return 64u + countTrailingZeros(mask.z); }
    return select(0u, 96u + countTrailingZeros(mask.w), mask.w != 0u);
}

fn ones(mask: vec4<u32>) -> u32 {
    if (!WIDE) { return countOneBits(mask.x); }
    let counts = countOneBits(mask);
    return counts.x + counts.y + counts.z + counts.w;
}

// The lanes before this one.
fn lanes_before(lane: u32) -> vec4<u32> {
    if (!WIDE) { return vec4<u32>((1u << lane) - 1u, 0u, 0u, 0u); }
    let first = vec4<i32>(0, 32, 64, 96);
    let below = clamp(vec4<i32>(i32(lane)) - first, vec4<i32>(0), vec4<i32>(32));
    let partial = (vec4<u32>(1u) << min(vec4<u32>(below), vec4<u32>(31u))) - vec4<u32>(1u);
    return select(partial, vec4<u32>(0xffffffffu), below == vec4<i32>(32));
}

struct Block {
    index: u32,
    n: u32,
    at: Lane,
    before: vec4<u32>,
}

// A key of one round and its rank among those of its digit that the subgroup holds.
fn ranked(block: Block, round: u32) -> vec2<u32> {
    let i = element(block.index, block.at, round);
    let holds = i < block.n;
    var key = 0u;
    if (holds) { key = keys[i]; }
    let digit = (key >> shift) & (DIGITS - 1u);
    let peers = peers_of(digit, holds);
    let earlier = ones(peers & block.before);
    // The first of the peers counts for all of them and tells them how many came in earlier rounds.
    var count = 0u;
    if (holds && earlier == 0u) { count = atomicAdd(&next[block.at.subgroup * DIGITS + digit], ones(peers)); }
    return vec2<u32>(key, subgroupShuffle(count, first_lane(peers)) + earlier);
}

fn scatter(block: Block, round: u32, held: vec2<u32>) {
    let i = element(block.index, block.at, round);
    if (i < block.n) {
        let digit = (held.x >> shift) & (DIGITS - 1u);
        let to = atomicLoad(&next[block.at.subgroup * DIGITS + digit]) + held.y;
        sorted_keys[to] = held.x;
        sorted_values[to] = values[i];
    }
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
    let block = Block(group.y * groups.x + group.x, n, at, lanes_before(lane));

    for (var slot = thread; slot < SUBGROUPS * DIGITS; slot += WORKGROUP) { atomicStore(&next[slot], 0u); }
    workgroupBarrier();

    // Counts, and ranks. Sixteen names and no array: an array would live in memory.
    let k0 = ranked(block, 0u);
    let k1 = ranked(block, 1u);
    let k2 = ranked(block, 2u);
    let k3 = ranked(block, 3u);
    let k4 = ranked(block, 4u);
    let k5 = ranked(block, 5u);
    let k6 = ranked(block, 6u);
    let k7 = ranked(block, 7u);
    let k8 = ranked(block, 8u);
    let k9 = ranked(block, 9u);
    let k10 = ranked(block, 10u);
    let k11 = ranked(block, 11u);
    let k12 = ranked(block, 12u);
    let k13 = ranked(block, 13u);
    let k14 = ranked(block, 14u);
    let k15 = ranked(block, 15u);
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
        if (digit >= DIGITS || block.index >= blocks) { break; }
        var place = smaller + histogram[digit * blocks + block.index];
        smaller += totals[digit];
        for (var s = 0u; s < subgroups; s++) {
            place += atomicExchange(&next[s * DIGITS + digit], place);
        }
    }
    workgroupBarrier();

    scatter(block, 0u, k0);
    scatter(block, 1u, k1);
    scatter(block, 2u, k2);
    scatter(block, 3u, k3);
    scatter(block, 4u, k4);
    scatter(block, 5u, k5);
    scatter(block, 6u, k6);
    scatter(block, 7u, k7);
    scatter(block, 8u, k8);
    scatter(block, 9u, k9);
    scatter(block, 10u, k10);
    scatter(block, 11u, k11);
    scatter(block, 12u, k12);
    scatter(block, 13u, k13);
    scatter(block, 14u, k14);
    scatter(block, 15u, k15);
}
