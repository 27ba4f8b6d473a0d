//! Contact sheets: a run at a glance.

use super::raster::{fitted, shrunk};
use super::{ExportError, Raster, font, write_png};
use crate::Frame;
use std::path::Path;

/// Most pictures on a sheet, and how they stand.
const MOST: u32 = 12;
const COLUMNS: u32 = 4;

/// Widest a picture is drawn, the space between pictures, and the strip below each, pixels.
const TILE_WIDTH: u32 = 320;
const GAP: u32 = 8;
const STRIP: u32 = 24;
const TEXT_SCALE: u32 = 2;

const PAPER: [u8; 4] = [250, 250, 252, 255];
const INK: [u8; 4] = [60, 62, 70, 255];

/// Up to twelve small frames, evenly spread over a run from its first to its last, each with its time.
#[derive(Debug)]
pub struct ContactSheet {
    frames_total: u32,
    tiles: Vec<Tile>,
}

/// A small copy of a frame, and its time in seconds.
pub type Tile = (Raster, f64);

impl ContactSheet {
    /// For a run of this many frames.
    pub fn new(frames_total: u32) -> ContactSheet {
        ContactSheet { frames_total: frames_total.max(1), tiles: Vec::new() }
    }

    /// Whether a frame goes on the sheet, so that others need not be read back for it.
    pub fn wants(&self, index: u32) -> bool {
        let tiles = self.frames_total.min(MOST);
        (0..tiles).any(|t| index == spread(t, tiles, self.frames_total))
    }

    /// Keeps a small copy of the frame if it goes on the sheet. Frames come in order.
    pub fn add(&mut self, frame: &Frame) {
        if self.wants(frame.index) {
            self.tiles.extend(ContactSheet::tile(frame));
        }
    }

    /// A small copy of a frame, as [`ContactSheet::add`] makes them, for whoever makes several at once.
    pub fn tile(frame: &Frame) -> Option<Tile> {
        let whole = frame.rgba8.len() == frame.size[0] as usize * frame.size[1] as usize * 4 && !frame.rgba8.is_empty();
        whole.then(|| (shrunk(frame.size, &frame.rgba8, fitted(frame.size, TILE_WIDTH)), frame.time_s))
    }

    /// Adds small copies, in order.
    pub fn extend(&mut self, tiles: impl IntoIterator<Item = Tile>) {
        self.tiles.extend(tiles);
    }

    /// The sheet of what came; none where nothing did. A run that was stopped has fewer pictures.
    pub fn picture(&self) -> Option<Raster> {
        let tile = self.tiles.iter().fold([0, 0], |[w, h], (t, _)| [t.size[0].max(w), t.size[1].max(h)]);
        let count = self.tiles.len() as u32;
        if count == 0 {
            return None;
        }
        let (columns, rows) = (count.min(COLUMNS), count.div_ceil(COLUMNS));
        let size = [GAP + columns * (tile[0] + GAP), GAP + rows * (tile[1] + STRIP)];
        let mut sheet = Raster::filled(size, PAPER);
        for (place, (picture, time_s)) in self.tiles.iter().enumerate() {
            let (column, row) = (place as u32 % COLUMNS, place as u32 / COLUMNS);
            let (x, y) = (GAP + column * (tile[0] + GAP), GAP + row * (tile[1] + STRIP));
            sheet.paste(picture, x, y);
            let label = format!("{time_s:.2} s");
            let [_, height] = font::extent(&label, TEXT_SCALE);
            font::draw(&mut sheet, &label, x + 2, y + tile[1] + (STRIP - height) / 2, TEXT_SCALE, INK);
        }
        Some(sheet)
    }

    /// Writes the sheet as PNG; nothing where no frame came.
    pub fn finish(self, path: &Path) -> Result<(), ExportError> {
        self.picture().map_or(Ok(()), |sheet| write_png(path, sheet.size, &sheet.rgba8))
    }
}

/// The frame of tile `t`: first and last always.
fn spread(t: u32, tiles: u32, frames: u32) -> u32 {
    (u64::from(t) * u64::from(frames - 1) / u64::from((tiles - 1).max(1))) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(index: u32, size: [u32; 2]) -> Frame {
        let shade = (index % 200) as u8;
        let rgba8 = Raster::filled(size, [shade, 100, 255 - shade, 255]).rgba8;
        Frame { index, time_s: f64::from(index) / 50.0, size, rgba8: rgba8.into(), png: Vec::new().into(), depth: None, id: None }
    }

    #[test]
    fn twelve_of_many_with_the_first_and_the_last() {
        let mut sheet = ContactSheet::new(101);
        (0..101).for_each(|i| sheet.add(&frame(i, [640, 360])));
        assert_eq!(sheet.tiles.len(), 12);
        assert_eq!((sheet.tiles[0].1, sheet.tiles[11].1), (0.0, 2.0));
        let picture = sheet.picture().unwrap();
        assert_eq!(picture.size, [8 + 4 * 328, 8 + 3 * 204]);
        // The second tile shows frame 9.
        let at = ((20 * picture.size[0] + 8 + 328 + 5) * 4) as usize;
        assert_eq!(picture.rgba8[at], 9);
    }

    #[test]
    fn few_frames_and_none() {
        let folder = tempfile::tempdir().unwrap();
        let mut sheet = ContactSheet::new(3);
        (0..2).for_each(|i| sheet.add(&frame(i, [100, 50])));
        assert_eq!(sheet.picture().unwrap().size, [8 + 2 * 108, 8 + 74]);
        sheet.finish(&folder.path().join("contact.png")).unwrap();
        assert!(folder.path().join("contact.png").exists());
        ContactSheet::new(0).finish(&folder.path().join("none.png")).unwrap();
        assert!(!folder.path().join("none.png").exists());
    }
}
