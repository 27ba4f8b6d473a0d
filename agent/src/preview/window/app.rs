//! The window itself: versions on the left, time below, the picture in the middle.

use super::orbit::Orbit;
use super::studio::{Extent, Listed, News, Request, Wish};
use eframe::egui::{self, Color32, ColorImage, Key, PointerButton, Sense, TextureHandle, TextureOptions, Ui};
use std::sync::mpsc::{Receiver, Sender};
use std::time::Instant;

/// Largest side of a picture that is asked for, pixels.
const LARGEST: f32 = 1920.0;
/// What a picture may take while something moves, seconds: a slow device draws smaller ones then.
const PATIENCE_S: f64 = 0.1;
/// How much smaller at most.
const COARSEST: f64 = 4.0;

/// How much nearer a point of the wheel comes: a click, some 50 points, is a twelfth.
const WHEEL: f32 = 0.0017;

/// How two versions are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Compare {
    /// One beside the other.
    Beside,
    /// One at a time, flipped with a key.
    Flip,
}

/// One version's picture on the screen.
struct Shown {
    version: String,
    texture: TextureHandle,
    extent: Extent,
}

/// State of the window.
pub struct Window {
    requests: Sender<Request>,
    news: Receiver<News>,
    title: String,
    versions: Vec<Listed>,
    /// The version shown; none follows the newest one.
    chosen: Option<String>,
    head: Option<String>,
    other: Option<String>,
    compare: Compare,
    flipped: bool,
    /// Seconds since t = 0.
    time_s: f64,
    playing: bool,
    orbit: Option<Orbit>,
    shown: [Option<Shown>; 2],
    running: Option<f32>,
    trouble: Option<String>,
    asked: Option<Wish>,
    /// A picture was asked for and did not come yet: the next wish waits, so that none piles up.
    waiting: bool,
    /// When it was asked for.
    asked_at: Instant,
    /// Seconds that a pixel took lately.
    pixel_s: f64,
    /// Whether the camera is being moved.
    moving: bool,
}

impl Window {
    /// A window that follows what `news` tells, and starts with a version if one was named.
    pub fn new(requests: Sender<Request>, news: Receiver<News>, chosen: Option<String>) -> Window {
        Window {
            requests,
            news,
            title: String::new(),
            versions: Vec::new(),
            chosen,
            head: None,
            other: None,
            compare: Compare::Beside,
            flipped: false,
            time_s: 0.0,
            playing: true,
            orbit: None,
            shown: [None, None],
            running: None,
            trouble: None,
            asked: None,
            waiting: false,
            asked_at: Instant::now(),
            pixel_s: 0.0,
            moving: false,
        }
    }

    fn current(&self) -> Option<&String> {
        self.chosen.as_ref().or(self.head.as_ref())
    }

    fn extent(&self) -> Option<&Extent> {
        self.shown[0].as_ref().map(|s| &s.extent)
    }

    /// The first of the shown versions that has no motion yet.
    fn unmoved(&self) -> Option<String> {
        let places = if self.other.is_some() { 2 } else { 1 };
        self.shown[..places].iter().flatten().find(|s| s.extent.frames == 0).map(|s| s.version.clone())
    }

    /// Seconds of motion that are there.
    fn end_s(&self) -> f64 {
        self.extent().map_or(0.0, |e| f64::from(e.frames.saturating_sub(1)) / f64::from(e.fps.max(1)))
    }

    fn frame(&self) -> u32 {
        self.extent().map_or(0, |e| (self.time_s * f64::from(e.fps)).round() as u32)
    }

    fn take_news(&mut self, ctx: &egui::Context) {
        while let Ok(news) = self.news.try_recv() {
            match news {
                News::Versions { title, list, head } => {
                    if self.head != head {
                        self.trouble = None;
                    }
                    (self.title, self.versions, self.head) = (title, list, head);
                }
                News::Picture { place, version, size, rgba8, extent } => {
                    let image = ColorImage::from_rgba_unmultiplied(size.map(|s| s as usize), &rgba8);
                    let texture = ctx.load_texture(format!("picture{place}"), image, TextureOptions::LINEAR);
                    self.shown[place] = Some(Shown { version, texture, extent });
                    self.pixel_s = self.asked_at.elapsed().as_secs_f64() / f64::from(size[0] * size[1]);
                    let all = self.asked.as_ref().is_none_or(|wish| place + 1 >= wish.versions.len());
                    self.waiting &= !all;
                    self.trouble = None;
                }
                News::Running(share) => {
                    self.running = (share < 1.0).then_some(share);
                    self.asked = None;
                }
                News::Failed(text) => {
                    self.trouble = Some(text);
                    (self.waiting, self.running) = (false, None);
                }
            }
        }
    }

    fn keys(&mut self, ctx: &egui::Context) {
        let step = self.extent().map_or(0.02, |e| 1.0 / f64::from(e.fps.max(1)));
        ctx.input(|input| {
            if input.key_pressed(Key::Space) {
                self.playing = !self.playing;
            }
            for (key, by) in [(Key::ArrowLeft, -step), (Key::Comma, -step), (Key::ArrowRight, step), (Key::Period, step)] {
                if input.key_pressed(key) {
                    self.playing = false;
                    self.time_s += by;
                }
            }
            if input.key_pressed(Key::Home) {
                self.time_s = 0.0;
            }
            if input.key_pressed(Key::End) {
                self.time_s = f64::INFINITY;
            }
            if input.key_pressed(Key::F) {
                self.orbit = None;
            }
            if input.key_pressed(Key::B) {
                // From beside it goes to flipping first.
                self.flipped = self.compare == Compare::Beside || !self.flipped;
                self.compare = Compare::Flip;
            }
        });
    }

    /// Moves on in time while playing, round and round.
    fn advance(&mut self, ctx: &egui::Context) {
        let end = self.end_s();
        if self.playing && end > 0.0 {
            self.time_s += f64::from(ctx.input(|i| i.stable_dt).min(0.1));
            if self.time_s > end {
                self.time_s = 0.0;
            }
            ctx.request_repaint();
        }
        self.time_s = self.time_s.clamp(0.0, end.max(0.0));
    }

    fn side(&mut self, ui: &mut Ui) {
        ui.heading(if self.title.is_empty() { "no session yet" } else { &self.title });
        let follows = self.chosen.is_none();
        if ui.selectable_label(follows, "follow the newest").clicked() {
            self.chosen = None;
        }
        self.comparison(ui);
        ui.separator();
        egui::ScrollArea::vertical().auto_shrink(false).max_height((ui.available_height() - 120.0).max(60.0)).show(ui, |ui| {
            let current = self.current().cloned();
            for listed in self.versions.iter().rev() {
                let here = current.as_ref() == Some(&listed.name);
                if ui.selectable_label(here, format!("{}  {}", listed.name, listed.words)).clicked() {
                    self.chosen = Some(listed.name.clone());
                }
            }
        });
        ui.separator();
        ui.label("drag: turn · right drag: move\nwheel: nearer · F: as at first\nSpace: play · arrows: step\nB: flip between two");
    }

    fn comparison(&mut self, ui: &mut Ui) {
        let label = self.other.clone().unwrap_or_else(|| "nothing".to_owned());
        egui::ComboBox::from_label("compare with").selected_text(label).show_ui(ui, |ui| {
            ui.selectable_value(&mut self.other, None, "nothing");
            let current = self.current().cloned();
            for listed in self.versions.iter().filter(|v| Some(&v.name) != current.as_ref()) {
                ui.selectable_value(&mut self.other, Some(listed.name.clone()), &listed.name);
            }
        });
        if self.other.is_some() {
            ui.horizontal(|ui| {
                ui.radio_value(&mut self.compare, Compare::Beside, "beside");
                ui.radio_value(&mut self.compare, Compare::Flip, "flip (B)");
            });
        }
    }

    fn timeline(&mut self, ui: &mut Ui) {
        ui.horizontal(|ui| {
            if ui.button(if self.playing { "pause" } else { "play" }).clicked() {
                self.playing = !self.playing;
            }
            let end = self.end_s();
            ui.spacing_mut().slider_width = (ui.available_width() - 150.0).max(80.0);
            let slider = egui::Slider::new(&mut self.time_s, 0.0..=end.max(1e-3)).show_value(false);
            if ui.add(slider).dragged() {
                self.playing = false;
            }
            let last = self.extent().map_or(0, |e| e.frames.saturating_sub(1));
            ui.monospace(format!("{:>3}/{last} {:.2} s", self.frame().min(last), self.time_s));
        });
    }

    fn picture(&mut self, ui: &mut Ui, pixels_per_point: f32) {
        let area = ui.available_rect_before_wrap();
        let response = ui.allocate_rect(area, Sense::click_and_drag());
        self.move_camera(ui, &response, area.height());
        let pair = self.other.is_some();
        let halves = pair && self.compare == Compare::Beside;
        let columns = if halves { 2.0 } else { 1.0 };
        let size = [area.width() / columns, area.height()].map(|s| (s * pixels_per_point).clamp(64.0, LARGEST));
        self.moving = response.dragged();
        self.ask(self.affordable(size));
        let places: &[usize] = if halves {
            &[0, 1]
        } else if pair && self.flipped {
            &[1]
        } else {
            &[0]
        };
        for (column, place) in places.iter().enumerate() {
            let Some(shown) = &self.shown[*place] else { continue };
            let width = area.width() / columns;
            let rect = egui::Rect::from_min_size(area.min + egui::vec2(width * column as f32, 0.0), egui::vec2(width, area.height()));
            let whole = egui::Rect::from_min_max(egui::pos2(0.0, 0.0), egui::pos2(1.0, 1.0));
            ui.painter().image(shown.texture.id(), rect, whole, Color32::WHITE);
            let Extent { frames, frames_total, .. } = shown.extent;
            let part = if frames < frames_total { format!(" · {frames} of {frames_total} frames simulated") } else { String::new() };
            let text = ui.painter().layout_no_wrap(format!("{}{part}", shown.version), egui::FontId::proportional(15.0), Color32::from_gray(20));
            let plate = egui::Rect::from_min_size(rect.min + egui::vec2(8.0, 8.0), text.size() + egui::vec2(12.0, 6.0));
            ui.painter().rect_filled(plate, 4.0, Color32::from_white_alpha(190));
            ui.painter().galley(plate.min + egui::vec2(6.0, 3.0), text, Color32::BLACK);
            if column > 0 {
                ui.painter().vline(rect.left(), rect.y_range(), egui::Stroke::new(2.0, Color32::from_gray(60)));
            }
        }
        self.notices(ui, area);
    }

    /// The size to ask for: smaller on a slow device while something moves, whole at rest.
    fn affordable(&self, size: [f32; 2]) -> [u32; 2] {
        let cost_s = self.pixel_s * f64::from(size[0] * size[1]);
        let moves = self.moving || self.playing && self.end_s() > 0.0;
        let coarse = if moves { (cost_s / PATIENCE_S).sqrt().clamp(1.0, COARSEST) } else { 1.0 };
        size.map(|s| (f64::from(s) / coarse).round() as u32)
    }

    fn move_camera(&mut self, ui: &Ui, response: &egui::Response, height: f32) {
        let wheel = if response.hovered() { ui.input(|i| i.smooth_scroll_delta().y) } else { 0.0 };
        let drag = response.drag_delta();
        if wheel == 0.0 && drag == egui::Vec2::ZERO {
            return;
        }
        let Some(start) = self.extent().map(|e| e.camera) else { return };
        let orbit = self.orbit.get_or_insert_with(|| Orbit::of(&start));
        if response.dragged_by(PointerButton::Primary) {
            orbit.turn(drag.x, drag.y);
        } else if drag != egui::Vec2::ZERO {
            orbit.pan(drag.x, drag.y, height);
        }
        orbit.zoom(f64::from(-wheel * WHEEL).exp());
    }

    /// Asks for the picture that should be seen now, if it is another one than was asked for last.
    fn ask(&mut self, size: [u32; 2]) {
        let Some(current) = self.current().cloned() else { return };
        let versions: Vec<String> = std::iter::once(current).chain(self.other.clone()).collect();
        if self.shown[0].as_ref().is_some_and(|s| s.version != versions[0]) && self.asked.as_ref().is_some_and(|a| a.versions != versions) {
            self.waiting = false;
        }
        let wish = Wish { versions, frame: self.frame(), camera: self.orbit.map(|o| o.camera()), size };
        if self.waiting || self.asked.as_ref() == Some(&wish) {
            return;
        }
        self.waiting = self.requests.send(Request::Draw(wish.clone())).is_ok();
        self.asked = Some(wish);
        self.asked_at = Instant::now();
    }

    /// What is to be known about the picture, on a plate over its lower part.
    fn notices(&mut self, ui: &mut Ui, area: egui::Rect) {
        let unmoved = self.unmoved();
        if self.running.is_none() && unmoved.is_none() && self.trouble.is_none() {
            return;
        }
        let place = egui::Rect::from_center_size(area.center_bottom() - egui::vec2(0.0, 60.0), egui::vec2(area.width().min(560.0), 90.0));
        let plate = egui::UiBuilder::new().max_rect(place).layout(egui::Layout::top_down(egui::Align::Center));
        ui.scope_builder(plate, |ui| egui::Frame::popup(ui.style()).show(ui, |ui| self.notice(ui, unmoved)));
    }

    fn notice(&mut self, ui: &mut Ui, unmoved: Option<String>) {
        if let Some(share) = self.running {
            ui.add(egui::ProgressBar::new(share).text("simulating").desired_width(320.0));
        } else if let Some(version) = unmoved {
            if self.versions.iter().any(|v| v.name == version && v.under_way) {
                ui.label(format!("{version} as captured: if it is being simulated, it moves as soon as the first quarter second is done"));
            } else {
                ui.label(format!("{version} as captured: the store has no motion of it yet (on this device, at this quality)"));
                if ui.button("simulate it").clicked() {
                    self.running = Some(0.0);
                    // The studio's thread ends only with the window.
                    let _ = self.requests.send(Request::Run(version));
                }
            }
        }
        if let Some(text) = &self.trouble {
            ui.colored_label(Color32::from_rgb(240, 120, 100), text);
        }
    }
}

impl eframe::App for Window {
    fn ui(&mut self, ui: &mut Ui, _: &mut eframe::Frame) {
        let ctx = ui.ctx().clone();
        self.take_news(&ctx);
        self.keys(&ctx);
        self.advance(&ctx);
        egui::Panel::left("versions").default_size(230.0).show(ui, |ui| self.side(ui));
        egui::Panel::bottom("time").show(ui, |ui| self.timeline(ui));
        let scale = ctx.pixels_per_point();
        egui::CentralPanel::no_frame().show(ui, |ui| self.picture(ui, scale));
    }
}
