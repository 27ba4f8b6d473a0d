//! The same passes in plain Rust, for the tests.

/// Exclusive prefixes, the total last.
pub fn scan(values: &[u32]) -> Vec<u32> {
    let mut sum = 0u32;
    let mut prefix = vec![0];
    prefix.extend(values.iter().map(|v| {
        sum = sum.wrapping_add(*v);
        sum
    }));
    prefix
}

/// Keys and their old places, sorted by the lowest `bits` bits; equal keys keep their order.
pub fn sort(keys: &[u32], bits: u32) -> (Vec<u32>, Vec<u32>) {
    let mask = u32::MAX >> (32 - bits);
    let mut order: Vec<u32> = (0..keys.len() as u32).collect();
    order.sort_by_key(|&i| keys[i as usize] & mask);
    (order.iter().map(|&i| keys[i as usize]).collect(), order)
}
