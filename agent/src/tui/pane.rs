//! The preview pane: which picture of the film is shown, and when the next one is due.

use crate::preview::terminal::Painter;
use crate::preview::{Picture, Reel};
use ratatui::layout::Rect;
use ratatui_image::protocol::Protocol;
use std::time::{Duration, Instant};

/// Shortest time between two pictures while playing: what a terminal over SSH can take.
const TICK: Duration = Duration::from_millis(66);
/// How often a finished run plays by itself.
const ENCORES: u32 = 3;

/// Plays one film.
pub struct Pane {
    reel: Reel,
    painter: Option<Painter>,
    shown: usize,
    /// While pictures still come, the newest is shown.
    following: bool,
    playing: Option<Playing>,
    painted: Option<Painted>,
    turn: u32,
}

#[derive(Clone, Copy, Debug)]
struct Playing {
    since: Instant,
    from_s: f64,
    rounds_left: Option<u32>,
}

struct Painted {
    film: u64,
    index: usize,
    area: Rect,
    place: Rect,
    protocol: Protocol,
}

/// What the line under the picture says.
#[derive(Clone, Debug, PartialEq)]
pub struct Caption {
    /// The version's name.
    pub version: String,
    /// Index of the frame shown.
    pub frame: u32,
    /// Index of the last one there is.
    pub last: u32,
    /// Its time.
    pub time_s: f64,
    /// Whether it plays.
    pub playing: bool,
}

impl Pane {
    /// An empty pane that will show what comes into `reel`.
    pub fn new(reel: Reel, painter: Option<Painter>) -> Pane {
        Pane { reel, painter, shown: 0, following: true, playing: None, painted: None, turn: 0 }
    }

    /// Whether there is anything to show.
    pub fn is_empty(&self) -> bool {
        self.painter.is_none() || self.reel.film().pictures.is_empty()
    }

    /// Pictures came: show the newest while following.
    pub fn pictures_came(&mut self) {
        if self.following {
            self.shown = self.last();
        }
    }

    /// A run begins: follow it.
    pub fn follow(&mut self) {
        self.following = true;
        self.playing = None;
    }

    /// A run ended: play it a few times.
    pub fn run_ended(&mut self, now: Instant) {
        if self.following && self.last() > 0 {
            self.following = false;
            self.start(now, 0.0, Some(ENCORES));
        }
    }

    /// Plays without end, or pauses.
    pub fn toggle(&mut self, now: Instant) {
        self.following = false;
        match self.playing {
            Some(_) => self.playing = None,
            None => {
                let from = if self.shown >= self.last() { 0 } else { self.shown };
                let from_s = self.reel.film().pictures.get(from).map_or(0.0, |p| p.time_s);
                self.start(now, from_s, None);
            }
        }
    }

    fn start(&mut self, now: Instant, from_s: f64, rounds_left: Option<u32>) {
        if self.painter.is_some() {
            self.playing = Some(Playing { since: now, from_s, rounds_left });
        }
    }

    /// Shows one frame and pauses; false where there is none.
    pub fn show(&mut self, frame: u32) -> bool {
        let found = self.reel.film().pictures.iter().position(|p| p.index == frame);
        if let Some(index) = found {
            (self.shown, self.following, self.playing) = (index, false, None);
        }
        found.is_some()
    }

    /// Steps by frames and pauses.
    pub fn step(&mut self, by: isize) {
        self.following = false;
        self.playing = None;
        self.shown = self.shown.saturating_add_signed(by).min(self.last());
    }

    /// Index of the frame shown.
    pub fn frame(&self) -> Option<u32> {
        self.reel.film().pictures.get(self.shown).map(|p| p.index)
    }

    fn last(&self) -> usize {
        self.reel.film().pictures.len().saturating_sub(1)
    }

    /// When the picture must change next, where it plays.
    pub fn due(&self, now: Instant) -> Option<Instant> {
        self.playing.map(|_| now + TICK)
    }

    /// Moves on to the picture of this moment; whether another one is to be drawn.
    pub fn advance(&mut self, now: Instant) -> bool {
        let Some(playing) = self.playing else { return false };
        let before = self.shown;
        let film = self.reel.film();
        let (count, interval) = (film.pictures.len(), film.interval_s());
        drop(film);
        if count < 2 {
            return false;
        }
        let elapsed = playing.from_s + now.duration_since(playing.since).as_secs_f64();
        let (round, index) = ((elapsed / (interval * count as f64)) as u32, (elapsed / interval) as usize % count);
        if playing.rounds_left.is_some_and(|rounds| round >= rounds) {
            self.playing = None;
            self.shown = count - 1;
        } else {
            self.shown = index;
        }
        self.shown != before
    }

    /// The caption of what is shown.
    pub fn caption(&self) -> Option<Caption> {
        let film = self.reel.film();
        let picture = film.pictures.get(self.shown)?;
        let last = film.pictures.last().map_or(0, |p| p.index);
        Some(Caption { version: film.version.clone(), frame: picture.index, last, time_s: picture.time_s, playing: self.playing.is_some() })
    }

    /// The picture encoded for `area`, and where it goes; encoded anew only when one of them changed.
    pub fn painted(&mut self, area: Rect) -> Option<(Rect, &Protocol)> {
        let painter = self.painter?;
        let (film, picture): (u64, Picture) = {
            let film = self.reel.film();
            (film.number, film.pictures.get(self.shown)?.clone())
        };
        let same = |p: &Painted| p.film == film && p.index == self.shown && p.area == area;
        if !self.painted.as_ref().is_some_and(same) {
            self.turn = self.turn.wrapping_add(1);
            let (place, protocol) = painter.paint(&picture, area, self.turn)?;
            self.painted = Some(Painted { film, index: self.shown, area, place, protocol });
        }
        self.painted.as_ref().map(|p| (p.place, &p.protocol))
    }

    /// Forgets what is on the screen, which was cleared: it is sent again.
    pub fn repaint(&mut self) {
        self.painted = None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use phystalk::Frame;

    fn reel(frames: u32) -> Reel {
        let reel = Reel::default();
        reel.start("v1");
        for index in 0..frames {
            let rgba8: Vec<u8> = vec![(index * 10) as u8; 16 * 9 * 4];
            reel.add(&Frame {
                index,
                time_s: f64::from(index) / 50.0,
                size: [16, 9],
                rgba8: rgba8.into(),
                png: Vec::new().into(),
                depth: None,
                id: None,
            });
        }
        reel
    }

    #[test]
    fn plays_in_real_time_and_ends_after_its_encores() {
        let mut pane = Pane::new(reel(50), Some(Painter::Halfblocks));
        let start = Instant::now();
        pane.pictures_came();
        pane.run_ended(start);
        assert!(pane.advance(start + Duration::from_millis(505)));
        assert_eq!(pane.frame(), Some(25));
        assert!(!pane.advance(start + Duration::from_millis(507)), "nothing to draw within one frame");
        assert!(pane.due(start).is_some());
        pane.advance(start + Duration::from_secs(4));
        assert_eq!((pane.frame(), pane.due(start)), (Some(49), None), "rests on the last frame and asks for no more");
    }

    #[test]
    fn frames_can_be_shown_and_stepped() {
        let mut pane = Pane::new(reel(10), Some(Painter::Halfblocks));
        assert!(pane.show(4) && !pane.show(10));
        pane.step(-1);
        assert_eq!(pane.frame(), Some(3));
        pane.step(100);
        assert_eq!(pane.caption().map(|c| (c.frame, c.last, c.playing)), Some((9, 9, false)));
    }

    #[test]
    fn a_picture_is_encoded_once_for_its_place() {
        let mut pane = Pane::new(reel(3), Some(Painter::Halfblocks));
        let area = Rect::new(0, 0, 20, 10);
        pane.painted(area);
        let turn = pane.turn;
        pane.painted(area);
        assert_eq!(pane.turn, turn);
        pane.painted(Rect::new(0, 0, 30, 10));
        assert_eq!(pane.turn, turn + 1);
    }
}
