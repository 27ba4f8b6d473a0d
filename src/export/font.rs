//! A tiny bitmap font: what labels on contact sheets need.

use super::Raster;

/// Pixels of a glyph, and the gap to the next.
const WIDTH: u32 = 5;
const HEIGHT: u32 = 7;
const ADVANCE: u32 = 6;

/// Glyphs of 5 x 7: one row a byte, the leftmost pixel in bit 4.
const GLYPHS: [(char, [u8; 7]); 14] = [
    ('0', [0x0e, 0x11, 0x13, 0x15, 0x19, 0x11, 0x0e]),
    ('1', [0x04, 0x0c, 0x04, 0x04, 0x04, 0x04, 0x0e]),
    ('2', [0x0e, 0x11, 0x01, 0x06, 0x08, 0x10, 0x1f]),
    ('3', [0x1f, 0x02, 0x04, 0x06, 0x01, 0x11, 0x0e]),
    ('4', [0x02, 0x06, 0x0a, 0x12, 0x1f, 0x02, 0x02]),
    ('5', [0x1f, 0x10, 0x1e, 0x01, 0x01, 0x11, 0x0e]),
    ('6', [0x06, 0x08, 0x10, 0x1e, 0x11, 0x11, 0x0e]),
    ('7', [0x1f, 0x01, 0x02, 0x04, 0x08, 0x08, 0x08]),
    ('8', [0x0e, 0x11, 0x11, 0x0e, 0x11, 0x11, 0x0e]),
    ('9', [0x0e, 0x11, 0x11, 0x0f, 0x01, 0x02, 0x0c]),
    ('.', [0x00, 0x00, 0x00, 0x00, 0x00, 0x0c, 0x0c]),
    ('-', [0x00, 0x00, 0x00, 0x0e, 0x00, 0x00, 0x00]),
    ('s', [0x00, 0x00, 0x0f, 0x10, 0x0e, 0x01, 0x1e]),
    (' ', [0x00; 7]),
];

/// Width and height of a text at a scale, pixels.
pub(super) fn extent(text: &str, scale: u32) -> [u32; 2] {
    [(text.chars().count() as u32 * ADVANCE).saturating_sub(ADVANCE - WIDTH) * scale, HEIGHT * scale]
}

/// Draws a text with its upper left corner at (x, y). A character the font does not have leaves a gap.
pub(super) fn draw(target: &mut Raster, text: &str, x: u32, y: u32, scale: u32, colour: [u8; 4]) {
    for (place, character) in text.chars().enumerate() {
        let Some((_, rows)) = GLYPHS.iter().find(|(c, _)| *c == character) else { continue };
        for pixel in 0..(WIDTH * scale * HEIGHT * scale) {
            let (px, py) = (pixel % (WIDTH * scale), pixel / (WIDTH * scale));
            if rows[(py / scale) as usize] >> (WIDTH - 1 - px / scale) & 1 == 0 {
                continue;
            }
            if let Some(bytes) = target.pixel_mut(x + place as u32 * ADVANCE * scale + px, y + py) {
                bytes.copy_from_slice(&colour);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn draws_within_its_extent_and_never_outside_the_picture() {
        let [width, height] = extent("1.25 s", 2);
        let mut picture = Raster::filled([width + 4, height + 4], [0; 4]);
        draw(&mut picture, "1.25 s", 2, 2, 2, [255; 4]);
        let lit = |x: u32, y: u32| picture.rgba8[((y * picture.size[0] + x) * 4) as usize] == 255;
        assert!((0..picture.size[0]).all(|x| !lit(x, 0) && !lit(x, height + 2)));
        assert!((0..picture.size[1]).any(|y| lit(width + 1, y)) && (0..picture.size[1]).all(|y| !lit(width + 2, y)));
        draw(&mut picture, "99999999999999", 3, height, 3, [255; 4]);
        assert_eq!(extent("", 2), [0, 14]);
    }
}
