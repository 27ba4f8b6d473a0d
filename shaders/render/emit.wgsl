// One pair of bin and Gaussian for each bin touched, nearest Gaussian first: a stable sort by bin keeps
// the order of depth within each bin. Pairs past the capacity are dropped; the frame is then redrawn.

@group(0) @binding(0) var<storage, read> frame: Frame;
@group(0) @binding(1) var<storage, read> extent: array<u32>;
@group(0) @binding(2) var<storage, read> order: array<u32>;
@group(0) @binding(3) var<storage, read> covers: array<Cover>;
@group(0) @binding(4) var<storage, read> start: array<u32>;
@group(0) @binding(5) var<storage, read> splats: array<Splat>;
@group(0) @binding(6) var<storage, read_write> keys: array<u32>;
@group(0) @binding(7) var<storage, read_write> values: array<u32>;

fn put(at: u32, bin: u32, g: u32) {
    if (at < frame.capacity) {
        keys[at] = bin;
        values[at] = g;
    }
}

fn emit_masked(cover: Cover, g: u32, first: u32) {
    let across = low(cover.size);
    var at = first;
    for (var rest = cover.hits; rest != 0u; rest &= rest - 1u) {
        let bit = countTrailingZeros(rest);
        let bin = (high(cover.corner) + bit / across) * frame.bins.x + low(cover.corner) + bit % across;
        put(at, bin, g);
        at++;
    }
}

// More bins than a mask has bits: tested again. Should rounding differ from the count's, the count
// rules: what is missing is filled with a bin that does not exist, what is over is left out.
fn emit_many(cover: Cover, g: u32, first: u32) {
    let splat = splats[g];
    let end = first + cover.hits;
    let whole = cover.hits == low(cover.size) * high(cover.size);
    var at = first;
    for (var y = 0u; y < high(cover.size); y++) {
        for (var x = 0u; x < low(cover.size); x++) {
            let bin = vec2<u32>(low(cover.corner) + x, high(cover.corner) + y);
            if (at < end && (whole || reaches(splat, bin))) {
                put(at, bin.y * frame.bins.x + bin.x, g);
                at++;
            }
        }
    }
    for (; at < end; at++) { put(at, frame.bins.x * frame.bins.y, g); }
}

@compute @workgroup_size(THREADS)
fn main(
    @builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let rank = thread_index(group, groups, local);
    if (rank >= extent[0]) { return; }
    let g = order[rank];
    let cover = covers[g];
    if (is_masked(cover)) {
        emit_masked(cover, g, start[rank]);
    } else {
        emit_many(cover, g, start[rank]);
    }
}
