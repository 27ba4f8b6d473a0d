// What lies around a place: the area lent to it, and its spread.

struct Around {
    // In squares of the span.
    area: f32,
    // And of each Gaussian, on average.
    each: f32,
    // Mean of d d^T over it about its own middle, in squares of the reach.
    spread: mat3x3<f32>,
}

fn place_of(key: u32) -> u32 {
    let last = arrayLength(&keys) - 1u;
    var place = key & last;
    for (var k = 0u; k < PROBES; k++) {
        let found = keys[place];
        if found == key {
            return place;
        }
        if found == 0u {
            break;
        }
        place = (place + 1u) & last;
    }
    return last + 1u;
}

// A cell counts by how near the middle of its area is: as that moves, and not its border, so it does.
fn around(x: vec3<f32>) -> Around {
    let home = vec3<i32>(floor(x));
    var area = 0.0;
    var number = 0.0;
    var first = vec3(0.0);
    var square = vec3(0.0);
    var mixed = vec3(0.0);
    for (var k = 0; k < 27; k++) {
        let cell = home + vec3(k % 3, k / 3 % 3, k / 9) - vec3(1);
        let place = place_of(key_of(cell));
        if place >= arrayLength(&keys) {
            continue;
        }
        let at = place * CELL_WORDS;
        let own = f32(sums[at]);
        let s = vec3(f32(sums[at + 1u]), f32(sums[at + 2u]), f32(sums[at + 3u]));
        let away = vec3<f32>(cell) + vec3(0.5) - x;
        let middle = away + s / own;
        let w = nearness(dot(middle, middle));
        area += w * own;
        number += w * f32(sums[at + 10u]);
        first += w * (s + own * away);
        square += w * (vec3(f32(sums[at + 4u]), f32(sums[at + 5u]), f32(sums[at + 6u])) + away * (2.0 * s + own * away));
        mixed += w * (vec3(f32(sums[at + 7u]), f32(sums[at + 8u]), f32(sums[at + 9u]))
            + away.yzx * s.zxy + s.yzx * away.zxy + own * away.yzx * away.zxy);
    }
    let per = 1.0 / max(area, 1.0);
    let mean = first * per;
    let d = square * per - mean * mean;
    let o = mixed * per - mean.yzx * mean.zxy;
    return Around(area / COVER_UNITS, area / (COVER_UNITS * max(number, 1e-6)), mat3x3(d.x, o.z, o.y, o.z, d.y, o.x, o.y, o.x, d.z));
}
