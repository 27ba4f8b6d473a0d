// Turns a count that a kernel wrote into the sizes of the dispatches that follow it.
// extent: [0] n, [1] n as wanted before the clamp, [2..5] groups of one thread an element,
// [5..8] groups of one block each.

struct Request { source: u32, capacity: u32 }
var<immediate> request: Request;

@group(0) @binding(0) var<storage, read> source: array<u32>;
@group(0) @binding(1) var<storage, read_write> extent: array<u32>;

// Folds groups into x and y, since x alone ends at 65535.
fn fold(at: u32, groups: u32) {
    let rows = (groups + FOLD - 1u) / FOLD;
    extent[at] = select(groups, FOLD, rows > 1u);
    extent[at + 1u] = max(rows, 1u);
    extent[at + 2u] = 1u;
}

@compute @workgroup_size(1)
fn main() {
    let wanted = source[request.source];
    let n = min(wanted, request.capacity);
    extent[0] = n;
    extent[1] = wanted;
    // One thread more than elements, so that the last one can close what lies behind them.
    fold(2u, n / THREADS + 1u);
    fold(5u, (n + GROUP_ELEMENTS - 1u) / GROUP_ELEMENTS);
}
