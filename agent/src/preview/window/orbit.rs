//! The window's camera: it turns about a point, comes nearer, moves aside.

use phystalk::spec::Camera;

/// Nearest and farthest it goes, as multiples of the distance it started at.
const REACH: (f64, f64) = (0.05, 20.0);
/// Highest it climbs, short of straight up, where the picture would flip.
const STEEPEST: f64 = 89.0;

/// A camera in spherical coordinates about its target. World frame, z up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orbit {
    target_m: [f64; 3],
    /// Of the eye as seen from the target, from +x towards +y, degrees.
    azimuth_deg: f64,
    /// Over the horizontal, degrees.
    elevation_deg: f64,
    distance_m: f64,
    start_m: f64,
    fov_deg: f64,
}

impl Orbit {
    /// The same view as a spec's camera; its own turning is left out.
    pub fn of(camera: &Camera) -> Orbit {
        let [x, y, z] = std::array::from_fn(|i| camera.eye_m[i] - camera.target_m[i]);
        let distance_m = (x * x + y * y + z * z).sqrt().max(1e-6);
        Orbit {
            target_m: camera.target_m,
            azimuth_deg: y.atan2(x).to_degrees(),
            elevation_deg: (z / distance_m).clamp(-1.0, 1.0).asin().to_degrees().clamp(-STEEPEST, STEEPEST),
            distance_m,
            start_m: distance_m,
            fov_deg: camera.fov_deg,
        }
    }

    /// As the engine takes it.
    pub fn camera(&self) -> Camera {
        let out = self.outward();
        let eye_m = std::array::from_fn(|i| self.target_m[i] + self.distance_m * out[i]);
        Camera { eye_m, target_m: self.target_m, fov_deg: self.fov_deg, orbit_deg_s: 0.0 }
    }

    /// From the target to the eye, of unit length.
    fn outward(&self) -> [f64; 3] {
        let (sa, ca) = self.azimuth_deg.to_radians().sin_cos();
        let (se, ce) = self.elevation_deg.to_radians().sin_cos();
        [ce * ca, ce * sa, se]
    }

    /// Follows a drag of so many points: the scene turns with the pointer.
    pub fn turn(&mut self, right: f32, down: f32) {
        self.azimuth_deg = (self.azimuth_deg - f64::from(right) * 0.4).rem_euclid(360.0);
        self.elevation_deg = (self.elevation_deg + f64::from(down) * 0.4).clamp(-STEEPEST, STEEPEST);
    }

    /// Moves the target with the pointer; `height` is the picture's, in the same points.
    pub fn pan(&mut self, right: f32, down: f32, height: f32) {
        let metres = 2.0 * self.distance_m * (self.fov_deg.to_radians() / 2.0).tan() / f64::from(height.max(1.0));
        let (sa, ca) = self.azimuth_deg.to_radians().sin_cos();
        let (se, ce) = self.elevation_deg.to_radians().sin_cos();
        let (to_right, to_top) = ([-sa, ca, 0.0], [-se * ca, -se * sa, ce]);
        for i in 0..3 {
            self.target_m[i] += metres * (f64::from(down) * to_top[i] - f64::from(right) * to_right[i]);
        }
    }

    /// Comes nearer by a factor under 1, goes farther by one over 1.
    pub fn zoom(&mut self, factor: f64) {
        self.distance_m = (self.distance_m * factor).clamp(REACH.0 * self.start_m, REACH.1 * self.start_m);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(a: [f64; 3], b: [f64; 3]) -> bool {
        (0..3).all(|i| (a[i] - b[i]).abs() < 1e-9)
    }

    fn camera() -> Camera {
        Camera { eye_m: [-1.5, -0.8, 0.7], target_m: [0.2, 0.1, 0.3], fov_deg: 40.0, orbit_deg_s: 0.0 }
    }

    #[test]
    fn starts_where_the_spec_looks_from() {
        let orbit = Orbit::of(&camera());
        assert!(near(orbit.camera().eye_m, camera().eye_m) && near(orbit.camera().target_m, camera().target_m));
    }

    #[test]
    fn turning_keeps_the_distance_and_never_flips() {
        let mut orbit = Orbit::of(&camera());
        let distance = |o: &Orbit| (0..3).map(|i| (o.camera().eye_m[i] - o.camera().target_m[i]).powi(2)).sum::<f64>().sqrt();
        let before = distance(&orbit);
        orbit.turn(300.0, 5000.0);
        assert!((distance(&orbit) - before).abs() < 1e-9 && orbit.elevation_deg <= STEEPEST);
        orbit.turn(600.0, 0.0);
        assert!((distance(&orbit) - before).abs() < 1e-9);
    }

    #[test]
    fn panning_right_moves_the_target_left_on_the_screen() {
        let mut orbit = Orbit::of(&Camera { eye_m: [-2.0, 0.0, 0.0], target_m: [0.0; 3], fov_deg: 90.0, orbit_deg_s: 0.0 });
        // Seen from -x, +y is on the left: the target goes left, so that the scene follows the pointer.
        orbit.pan(100.0, 0.0, 400.0);
        assert!(near(orbit.camera().target_m, [0.0, 1.0, 0.0]), "{:?}", orbit.camera());
        orbit.pan(0.0, 100.0, 400.0);
        assert!(near(orbit.camera().target_m, [0.0, 1.0, 1.0]), "{:?}", orbit.camera());
    }

    #[test]
    fn zoom_has_ends() {
        let mut orbit = Orbit::of(&camera());
        orbit.zoom(1e-9);
        assert!(orbit.distance_m > 0.0);
        orbit.zoom(1e9);
        assert!(orbit.distance_m <= REACH.1 * orbit.start_m + 1e-9);
    }
}
