//! The preview window: a process of its own that follows the store. The picture is drawn by the
//! engine on its own thread and device; the window only shows it, so that it never holds up a run.

mod app;
mod orbit;
mod studio;

use crate::cli::exit::Failure;
use eframe::egui;
use std::sync::mpsc::channel;
pub use studio::{Setting, Source};

/// Opens the window and stays until it is closed. Must be called on the process's first thread.
pub fn open(setting: Setting, chosen: Option<String>) -> Result<(), Failure> {
    let viewport = egui::ViewportBuilder::default().with_title("PhysTalk").with_inner_size([1180.0, 680.0]).with_min_inner_size([420.0, 280.0]);
    let options = eframe::NativeOptions { viewport, ..Default::default() };
    let create: eframe::AppCreator<'_> = Box::new(move |context| {
        // The usual grey of labels is hard to read beside a bright picture.
        for (theme, ink) in [(egui::Theme::Dark, 225), (egui::Theme::Light, 25)] {
            context.egui_ctx.style_mut_of(theme, |style| style.visuals.override_text_color = Some(egui::Color32::from_gray(ink)));
        }
        let (post, news) = channel();
        let (requests, inbox) = channel();
        let ctx = context.egui_ctx.clone();
        let studio = studio::Studio::new(setting, post, Box::new(move || ctx.request_repaint()));
        std::thread::Builder::new().name("studio".into()).spawn(move || studio.serve(&inbox))?;
        Ok(Box::new(app::Window::new(requests, news, chosen)))
    });
    eframe::run_native("phystalk", options, create).map_err(|e| {
        Failure::other(format!(
            "no window could be opened: {e}\nthe preview shows in the terminal, and pictures are files: phystalk exec SCENE -p \"…\" --out DIR"
        ))
    })
}
