// Front to back blending, one workgroup a bin. Pixels are numbered along a Morton curve, so that the
// pixels of a subgroup form a rectangle: each of its lanes tests one splat against that rectangle, and
// only splats that some lane found are walked.
// A pixel that has ended keeps its transmittance with the sign turned.

var<workgroup> shapes: array<vec4<f32>, BATCH>;
var<workgroup> weights: array<vec4<f32>, BATCH>;
var<workgroup> colours: array<vec4<f32>, BATCH>;
var<workgroup> indices: array<u32, BATCH>;
var<workgroup> ended_subgroups: atomic<u32>;
var<workgroup> bounds: vec2<u32>;

// Even bits of a number, packed.
fn even_bits(bits: u32) -> u32 {
    var x = bits & 0x5555u;
    x = (x | x >> 1u) & 0x3333u;
    x = (x | x >> 2u) & 0x0f0fu;
    return (x | x >> 4u) & 0x00ffu;
}

fn morton(slot: u32) -> vec2<u32> {
    return vec2<u32>(even_bits(slot), even_bits(slot >> 1u));
}

struct Pixel {
    at: vec2<f32>,
    transmittance: f32,
    colour: vec3<f32>,
    depth: f32,
    weight: f32,
    heaviest: u32,
}

fn fresh(at: vec2<u32>) -> Pixel {
    // Pixels outside the picture have ended before they began.
    let outside = any(at >= frame.size);
    return Pixel(vec2<f32>(at) + 0.5, select(1.0, -1.0, outside), vec3<f32>(0.0), 0.0, 0.0, NOTHING);
}

fn blend(pixel: ptr<function, Pixel>, shape: vec4<f32>, weight: vec4<f32>, colour: vec4<f32>, g: u32) {
    let d = (*pixel).at - shape.xy;
    let e = weight.y - (shape.z * d.x * d.x + weight.x * d.y * d.y + shape.w * d.x * d.y);
    let alpha = select(0.0, min(exp2(e), frame.opacity_cap), e >= frame.alpha_min_log2);
    let t = (*pixel).transmittance;
    let next = t * (1.0 - alpha);
    let ended = next <= frame.stop;
    let w = select(t * alpha, 0.0, ended);
    (*pixel).transmittance = select(next, -abs(t), ended);
    (*pixel).colour += w * colour.xyz;
    if (WITH_DEPTH) { (*pixel).depth += w * colour.w; }
    if (WITH_ID) {
        let heavier = w > (*pixel).weight;
        (*pixel).weight = select((*pixel).weight, w, heavier);
        (*pixel).heaviest = select((*pixel).heaviest, g, heavier);
    }
}

// Blends the splats of the batch that a word of a ballot names, in order.
fn walk(first: u32, vote: u32, a: ptr<function, Pixel>, b: ptr<function, Pixel>) {
    for (var rest = vote; rest != 0u; rest &= rest - 1u) {
        let i = first + countTrailingZeros(rest);
        blend(a, shapes[i], weights[i], colours[i], indices[i]);
        if (PIXELS_A_THREAD == 2u) { blend(b, shapes[i], weights[i], colours[i], indices[i]); }
    }
}

fn put(pixel: Pixel) {
    finish(vec2<u32>(pixel.at), pixel.colour, abs(pixel.transmittance), pixel.depth, pixel.heaviest);
}

@compute @workgroup_size(WORKGROUP)
fn main(
    @builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32,
    @builtin(subgroup_id) subgroup: u32, @builtin(num_subgroups) subgroups: u32,
    @builtin(subgroup_invocation_id) lane: u32, @builtin(subgroup_size) lanes: u32,
) {
    let corner = group.xy * BIN;
    let run = lanes * PIXELS_A_THREAD;
    let first_slot = subgroup * run;
    var a = fresh(corner + morton(first_slot + lane));
    var b = fresh(corner + morton(first_slot + lanes * (PIXELS_A_THREAD - 1u) + lane));

    // The subgroup's rectangle of pixel centres: a Morton run of a power of two.
    let area = 31u - countLeadingZeros(run);
    let low = vec2<f32>(corner + morton(first_slot)) + 0.5;
    let high = low + vec2<f32>(f32((1u << ((area + 1u) / 2u)) - 1u), f32((1u << (area / 2u)) - 1u));

    if (local == 0u) {
        let bin = group.y * frame.bins.x + group.x;
        bounds = vec2<u32>(starts[bin], starts[bin + 1u]);
        atomicStore(&ended_subgroups, 0u);
    }
    let range = workgroupUniformLoad(&bounds);

    var ended = false;
    for (var start = range.x; start < range.y; start += BATCH) {
        let held = min(BATCH, range.y - start);
        for (var k = local; k < held; k += WORKGROUP) {
            let g = order[start + k];
            indices[k] = g;
            shapes[k] = splats[g].shape;
            weights[k] = splats[g].weight;
            colours[k] = splats[g].colour;
        }
        workgroupBarrier();
        for (var chunk = 0u; chunk < held && !ended; chunk += lanes) {
            let k = chunk + lane;
            var hit = false;
            if (k < held) {
                hit = largest_exponent(shapes[k], weights[k], low, high) >= frame.alpha_min_log2 - EXPONENT_SLACK;
            }
            let vote = subgroupBallot(hit);
            walk(chunk, vote.x, &a, &b);
            if (WIDE) {
                walk(chunk + 32u, vote.y, &a, &b);
                walk(chunk + 64u, vote.z, &a, &b);
                walk(chunk + 96u, vote.w, &a, &b);
            }
            ended = subgroupAll(a.transmittance < 0.0 && (PIXELS_A_THREAD == 1u || b.transmittance < 0.0));
            if (ended && lane == 0u) { atomicAdd(&ended_subgroups, 1u); }
        }
        workgroupBarrier();
        // Nobody writes the count until everybody passed the next barrier of the loop.
        if (atomicLoad(&ended_subgroups) == subgroups) { break; }
        workgroupBarrier();
    }
    put(a);
    if (PIXELS_A_THREAD == 2u) { put(b); }
}
