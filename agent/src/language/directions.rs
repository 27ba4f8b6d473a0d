//! Directions as said to directions of the world: by the object's front, by the camera, or by an axis.

use super::sense::{Direction, View};
use glam::DVec3;
use phystalk::spec::{Axis, Camera};

/// A direction of the world, and how to say it.
#[derive(Clone, Debug, PartialEq)]
pub struct Heading {
    /// Of unit length.
    pub unit: DVec3,
    /// "to its left", "forward and up".
    pub said: String,
}

/// What directions are measured against.
pub struct Frame {
    forward: DVec3,
    camera_forward: DVec3,
}

impl Frame {
    /// Of an object whose front is `forward`, standing at `place`, seen by `camera`.
    pub fn new(forward: Axis, place: DVec3, camera: &Camera) -> Frame {
        let ahead = match forward {
            Axis::MinusX => -DVec3::X,
            Axis::PlusY => DVec3::Y,
            Axis::MinusY => -DVec3::Y,
            // A front that points up or down has no way along the ground: +x, as where none is given.
            Axis::PlusX | Axis::PlusZ | Axis::MinusZ => DVec3::X,
        };
        let eye = DVec3::from_array(camera.eye_m);
        let target = DVec3::from_array(camera.target_m);
        // From right above there is no way along the ground to the camera: the picture's own "into" is taken as forward.
        let level = |v: DVec3| v.with_z(0.0).try_normalize();
        Frame { forward: ahead, camera_forward: level(place - eye).or_else(|| level(target - eye)).unwrap_or(ahead) }
    }

    /// The object's front.
    pub fn forward(&self) -> DVec3 {
        self.forward
    }

    /// One direction; clockwise and its opposite are about the vertical, seen from above.
    pub fn unit(&self, direction: Direction) -> DVec3 {
        let left = DVec3::Z.cross(self.forward);
        let screen_left = DVec3::Z.cross(self.camera_forward);
        match direction {
            Direction::Forward => self.forward,
            Direction::Backward => -self.forward,
            Direction::Left | Direction::Sideways => left,
            Direction::Right => -left,
            Direction::Up | Direction::Anticlockwise => DVec3::Z,
            Direction::Down | Direction::Clockwise => -DVec3::Z,
            Direction::Towards => -self.camera_forward,
            Direction::Away => self.camera_forward,
            Direction::ScreenLeft => screen_left,
            Direction::ScreenRight => -screen_left,
            Direction::Axis(axis, positive) => DVec3::AXES[usize::from(axis)] * if positive { 1.0 } else { -1.0 },
        }
    }

    /// Several directions together: "up and to the left". None where they cancel out.
    pub fn heading(&self, directions: &[Direction]) -> Option<Heading> {
        let unit = directions.iter().map(|d| self.unit(*d)).sum::<DVec3>().try_normalize()?;
        let said: Vec<String> = directions.iter().map(|d| said(*d).to_owned()).collect();
        Some(Heading { unit, said: super::say::list(&said) })
    }

    /// Where something stands that sees the object from a side, as a direction from the object; None for "auto".
    pub fn side(&self, view: View) -> Option<DVec3> {
        Some(match view {
            View::Front => self.unit(Direction::Forward),
            View::Back => self.unit(Direction::Backward),
            View::Left => self.unit(Direction::Left),
            View::Right => self.unit(Direction::Right),
            View::Above => DVec3::Z,
            View::Below => -DVec3::Z,
            View::Auto => return None,
        })
    }
}

/// How a direction is said back.
pub fn said(direction: Direction) -> &'static str {
    match direction {
        Direction::Forward => "forward",
        Direction::Backward => "backward",
        Direction::Left => "to its left",
        Direction::Right => "to its right",
        Direction::Sideways => "sideways, to its left (no side said)",
        Direction::Up => "up",
        Direction::Down => "down",
        Direction::Towards => "towards the camera",
        Direction::Away => "away from the camera",
        Direction::ScreenLeft => "to the left of the picture",
        Direction::ScreenRight => "to the right of the picture",
        Direction::Axis(0, true) => "along +x",
        Direction::Axis(0, false) => "along -x",
        Direction::Axis(1, true) => "along +y",
        Direction::Axis(1, false) => "along -y",
        Direction::Axis(_, true) => "along +z",
        Direction::Axis(_, false) => "along -z",
        Direction::Anticlockwise => "counter-clockwise",
        Direction::Clockwise => "clockwise",
    }
}

/// The direction that something coming from a side goes: wind from the left blows to the right.
pub fn from_side(view: View) -> Option<Direction> {
    Some(match view {
        View::Front => Direction::Backward,
        View::Back => Direction::Forward,
        View::Left => Direction::Right,
        View::Right => Direction::Left,
        View::Above => Direction::Down,
        View::Below => Direction::Up,
        View::Auto => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(forward: Axis) -> Frame {
        let camera = Camera { eye_m: [-3.0, 0.0, 1.0], target_m: [0.0; 3], fov_deg: 45.0, orbit_deg_s: 0.0 };
        Frame::new(forward, DVec3::ZERO, &camera)
    }

    #[test]
    fn left_is_counter_clockwise_of_forward() {
        assert_eq!(frame(Axis::PlusX).unit(Direction::Left), DVec3::Y);
        assert_eq!(frame(Axis::PlusY).unit(Direction::Left), -DVec3::X);
        assert_eq!(frame(Axis::MinusX).unit(Direction::Right), DVec3::Y);
    }

    #[test]
    fn the_camera_has_its_own() {
        let frame = frame(Axis::PlusY);
        assert_eq!(frame.unit(Direction::Towards), -DVec3::X);
        assert_eq!(frame.unit(Direction::ScreenLeft), DVec3::Y);
    }

    #[test]
    fn diagonals_have_unit_length_and_opposites_cancel() {
        let frame = frame(Axis::PlusX);
        let heading = frame.heading(&[Direction::Up, Direction::Left]).unwrap();
        assert!((heading.unit - DVec3::new(0.0, 0.5f64.sqrt(), 0.5f64.sqrt())).length() < 1e-12);
        assert_eq!(heading.said, "up and to its left");
        assert_eq!(frame.heading(&[Direction::Left, Direction::Right]), None);
    }
}
