//! How stored numbers become what they mean, and back. In f64, so that each direction rounds once.

/// Y_0^0 = 1 / (2 sqrt(pi)): the constant spherical harmonic, colour = 0.5 + SH_C0 f_dc.
pub const SH_C0: f32 = 0.282_094_8;

/// Stands for the logarithm of zero and for the logit of 0 and 1: exp(-110) is 0 in f32.
const FINITE_EXTREME: f32 = 110.0;

/// exp(x), as .ply stores standard deviations.
pub fn exp(x: f32) -> f32 {
    f64::from(x).exp() as f32
}

/// ln(x) for x >= 0; finite at 0, where [`exp`] gives 0 back.
pub fn ln(x: f32) -> f32 {
    (f64::from(x).ln() as f32).max(-FINITE_EXTREME)
}

/// 1 / (1 + exp(-x)), as .ply stores opacity.
pub fn sigmoid(x: f32) -> f32 {
    (1.0 / (1.0 + (-f64::from(x)).exp())) as f32
}

/// ln(x / (1 - x)); finite at 0 and 1, where [`sigmoid`] gives them back.
pub fn logit(x: f32) -> f32 {
    let x = f64::from(x);
    ((x / (1.0 - x)).ln() as f32).clamp(-FINITE_EXTREME, FINITE_EXTREME)
}

/// f_dc of a colour byte, as .splat stores it.
pub fn dc_of_byte(byte: u8) -> f32 {
    (f32::from(byte) / 255.0 - 0.5) / SH_C0
}

/// The nearest colour byte of f_dc, clamped to what a byte holds.
pub fn byte_of_dc(dc: f32) -> u8 {
    unit_byte(0.5 + SH_C0 * dc)
}

/// 0..=1 to the nearest of 0..=255, clamped.
pub fn unit_byte(x: f32) -> u8 {
    (x.clamp(0.0, 1.0) * 255.0).round() as u8
}

/// A quaternion's bytes, (b - 128) / 128 a component.
pub fn rotation_of_bytes(bytes: [u8; 4]) -> [f32; 4] {
    bytes.map(|b| (f32::from(b) - 128.0) / 128.0)
}

/// The bytes that hold a quaternion exactly, where there are any; else the nearest of its unit
/// multiple, of the two signs the one whose largest component is negative: a byte reaches -1, not 1.
pub fn bytes_of_rotation(q: [f32; 4]) -> [u8; 4] {
    let raw = q.map(|c| c * 128.0 + 128.0);
    if raw.iter().all(|&c| c.fract() == 0.0 && (0.0..=255.0).contains(&c)) {
        return raw.map(|c| c as u8);
    }
    let largest = q.into_iter().fold(0.0_f32, |best, c| if c.abs() > best.abs() { c } else { best });
    let shrunk = q.map(|c| c / largest);
    let length = -shrunk.iter().map(|c| c * c).sum::<f32>().sqrt();
    shrunk.map(|c| (c / length * 128.0 + 128.0).round().clamp(0.0, 255.0) as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_byte_survives_what_a_ply_stores() {
        for byte in 0..=255_u8 {
            let opacity = f32::from(byte) / 255.0;
            assert_eq!(unit_byte(sigmoid(logit(opacity))), byte);
            assert_eq!(byte_of_dc(dc_of_byte(byte)), byte);
            let q = rotation_of_bytes([byte, 128, 0, 255]);
            assert_eq!(bytes_of_rotation(q), [byte, 128, 0, 255]);
        }
        assert_eq!(sigmoid(logit(0.0)), 0.0);
        assert_eq!(sigmoid(logit(1.0)), 1.0);
        assert_eq!(exp(ln(0.0)), 0.0);
        assert_eq!(bytes_of_rotation([0.0; 4]), [128; 4]);
    }

    #[test]
    fn a_turn_that_bytes_cannot_hold_keeps_its_direction() {
        assert_eq!(rotation_of_bytes(bytes_of_rotation([1.0, 0.0, 0.0, 0.0])), [-1.0, 0.0, 0.0, 0.0]);
        let q = [0.3_f32, -0.7, 0.2, 0.6];
        let back = rotation_of_bytes(bytes_of_rotation(q));
        let dot: f32 = q.iter().zip(back).map(|(a, b)| a * b).sum();
        let lengths: f32 = q.iter().map(|c| c * c).sum::<f32>().sqrt() * back.iter().map(|c| c * c).sum::<f32>().sqrt();
        assert!((dot / lengths).abs() > 0.9999, "{back:?}");
    }
}
