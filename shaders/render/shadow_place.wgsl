// The map that the bounds ask for, read from them by every pass that needs it.

fn current_map() -> Map {
    let high = vec3(from_ordered(bounds[0]), from_ordered(bounds[1]), from_ordered(bounds[2]));
    let low = -vec3(from_ordered(bounds[3]), from_ordered(bounds[4]), from_ordered(bounds[5]));
    return map_around(low, high);
}
