//! The preview pane: which picture of the film is shown, and when the next one is due.

use crate::preview::terminal::Painter;
use crate::preview::{Picture, Reel};
use ratatui::layout::Rect;
use ratatui_image::protocol::Protocol;
use std::time::{Duration, Instant};

/// Shortest time between two pictures while playing: what a terminal over SSH can take.
const TICK: Duration = Duration::from_millis(66);
/// How long a finished run plays by itself, over and over: an idle terminal is left in peace after that.
const ENCORE: Duration = Duration::from_secs(60);

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
    /// It rests after the round that is played then.
    until: Option<Instant>,
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
    /// Whether it plays, rests, or is a single picture.
    pub play: Play,
}

/// What the pane does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Play {
    /// A picture that does not move.
    Still,
    /// New frames are shown as they come.
    Following,
    /// Over and over.
    Playing,
    /// On one frame.
    Paused,
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

    /// A run ended: play it for a while.
    pub fn run_ended(&mut self, now: Instant) {
        if self.following && self.last() > 0 {
            self.following = false;
            self.start(now, 0.0, Some(now + ENCORE));
        }
    }

    /// Plays without end, or pauses; false where nothing moves.
    pub fn toggle(&mut self, now: Instant) -> bool {
        if self.last() == 0 || self.painter.is_none() {
            return false;
        }
        self.following = false;
        match self.playing {
            Some(_) => self.playing = None,
            None => {
                let from = if self.shown >= self.last() { 0 } else { self.shown };
                let from_s = self.reel.film().pictures.get(from).map_or(0.0, |p| p.time_s);
                self.start(now, from_s, None);
            }
        }
        true
    }

    fn start(&mut self, now: Instant, from_s: f64, until: Option<Instant>) {
        if self.painter.is_some() {
            self.playing = Some(Playing { since: now, from_s, until });
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
        let index = (elapsed / interval) as usize % count;
        // It rests where a round ends.
        if index < before && playing.until.is_some_and(|until| now >= until) {
            self.playing = None;
            self.shown = count - 1;
            return true;
        }
        self.shown = index;
        self.shown != before
    }

    /// The caption of what is shown.
    pub fn caption(&self) -> Option<Caption> {
        let film = self.reel.film();
        let picture = film.pictures.get(self.shown)?;
        let last = film.pictures.last().map_or(0, |p| p.index);
        let play = match (self.playing, self.following) {
            (Some(_), _) => Play::Playing,
            _ if film.pictures.len() < 2 => Play::Still,
            (None, true) => Play::Following,
            (None, false) => Play::Paused,
        };
        Some(Caption { version: film.version.clone(), frame: picture.index, last, time_s: picture.time_s, play })
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
    fn plays_in_real_time_over_and_over_and_rests_after_a_minute() {
        let mut pane = Pane::new(reel(50), Some(Painter::Halfblocks));
        let start = Instant::now();
        pane.pictures_came();
        pane.run_ended(start);
        assert!(pane.advance(start + Duration::from_millis(505)));
        assert_eq!(pane.frame(), Some(25));
        assert!(!pane.advance(start + Duration::from_millis(507)), "nothing to draw within one frame");
        assert!(pane.due(start).is_some());
        pane.advance(start + Duration::from_millis(1_205));
        assert_eq!((pane.frame(), pane.caption().map(|c| c.play)), (Some(10), Some(Play::Playing)), "a second round");
        pane.advance(start + Duration::from_millis(60_950));
        assert!(pane.due(start).is_some(), "the round is played to its end");
        assert!(pane.advance(start + Duration::from_millis(61_010)), "that it rests has to be drawn");
        assert_eq!((pane.frame(), pane.due(start)), (Some(49), None), "rests on the last frame and asks for no more");
        assert_eq!(pane.caption().map(|c| c.play), Some(Play::Paused));
        assert!(pane.toggle(start) && pane.due(start).is_some());
    }

    #[test]
    fn one_picture_is_a_still_that_cannot_play() {
        let mut pane = Pane::new(reel(1), Some(Painter::Halfblocks));
        pane.pictures_came();
        pane.run_ended(Instant::now());
        assert_eq!(pane.caption().map(|c| c.play), Some(Play::Still));
        assert!(!pane.toggle(Instant::now()));
    }

    #[test]
    fn frames_can_be_shown_and_stepped() {
        let mut pane = Pane::new(reel(10), Some(Painter::Halfblocks));
        assert!(pane.show(4) && !pane.show(10));
        pane.step(-1);
        assert_eq!(pane.frame(), Some(3));
        pane.step(100);
        assert_eq!(pane.caption().map(|c| (c.frame, c.last, c.play)), Some((9, 9, Play::Paused)));
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
