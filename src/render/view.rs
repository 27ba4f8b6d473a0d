//! A camera and its picture's size.

use glam::{Mat4, Vec3, Vec4};
use serde::{Deserialize, Deserializer, Serialize, Serializer, de};

/// A pinhole camera with OpenCV axes: x right, y down, z forward; pixel centres lie at +0.5.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct View {
    /// Pixels.
    pub width: u32,
    /// Pixels.
    pub height: u32,
    /// Focal length, pixels.
    pub fx: f32,
    /// Focal length, pixels.
    pub fy: f32,
    /// Where the axis meets the picture, pixels from the left edge.
    pub cx: f32,
    /// Where the axis meets the picture, pixels from the top edge.
    pub cy: f32,
    /// Camera from world; four rows of four in files.
    #[serde(serialize_with = "write_rows", deserialize_with = "read_rows")]
    pub world_to_camera: Mat4,
    /// Display-referred, 0 to 1; `#rrggbb` in files too.
    #[serde(default, deserialize_with = "read_background")]
    pub background: [f32; 3],
}

impl View {
    /// Stands at `eye`, looks at `target`, z up; the field of view is the vertical one.
    pub fn look_at(eye: Vec3, target: Vec3, fov_deg: f32, size: [u32; 2]) -> View {
        let forward = (target - eye).try_normalize().unwrap_or(Vec3::X);
        // Straight up or down, the world's y stays towards the picture's top.
        let right = forward.cross(Vec3::Z).try_normalize().unwrap_or(Vec3::X);
        let down = forward.cross(right);
        let row = |axis: Vec3| axis.extend(-axis.dot(eye));
        let rows = [row(right), row(down), row(forward), Vec4::W];
        let focal = 0.5 * size[1] as f32 / (0.5 * fov_deg.to_radians()).tan();
        View {
            width: size[0],
            height: size[1],
            fx: focal,
            fy: focal,
            cx: 0.5 * size[0] as f32,
            cy: 0.5 * size[1] as f32,
            world_to_camera: Mat4::from_cols_array_2d(&rows.map(|r| r.to_array())).transpose(),
            background: [0.0; 3],
        }
    }

    /// The same camera before another background.
    pub fn with_background(self, background: [f32; 3]) -> View {
        View { background, ..self }
    }

    /// Where the camera stands in the world.
    pub fn eye(&self) -> Vec3 {
        self.world_to_camera.as_dmat4().inverse().transform_point3(glam::DVec3::ZERO).as_vec3()
    }
}

/// `#rrggbb` as display-referred fractions.
pub fn parse_colour(text: &str) -> Option<[f32; 3]> {
    let digits = text.strip_prefix('#').filter(|d| d.len() == 6 && d.is_ascii())?;
    let byte = |i: usize| u8::from_str_radix(&digits[2 * i..2 * i + 2], 16).ok().map(|b| f32::from(b) / 255.0);
    Some([byte(0)?, byte(1)?, byte(2)?])
}

fn write_rows<S: Serializer>(matrix: &Mat4, serializer: S) -> Result<S::Ok, S::Error> {
    matrix.transpose().to_cols_array_2d().serialize(serializer)
}

fn read_rows<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Mat4, D::Error> {
    let rows = <[[f32; 4]; 4]>::deserialize(deserializer)?;
    let matrix = Mat4::from_cols_array_2d(&rows).transpose();
    if matrix.is_finite() && rows[3] == [0.0, 0.0, 0.0, 1.0] && matrix.determinant().abs() > 0.0 {
        Ok(matrix)
    } else {
        Err(de::Error::custom("world_to_camera must be an invertible rigid motion whose last row is 0 0 0 1"))
    }
}

fn read_background<'de, D: Deserializer<'de>>(deserializer: D) -> Result<[f32; 3], D::Error> {
    #[derive(Deserialize)]
    #[serde(untagged)]
    enum Either {
        Fractions([f32; 3]),
        Text(String),
    }
    match Either::deserialize(deserializer)? {
        Either::Fractions(rgb) => Ok(rgb),
        Either::Text(text) => parse_colour(&text).ok_or_else(|| de::Error::custom(format!("background \"{text}\" is not #rrggbb"))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn looking_at_puts_the_target_on_the_axis_and_up_up() {
        let view = View::look_at(Vec3::new(3.0, -2.0, 1.0), Vec3::new(0.5, 0.25, -1.0), 45.0, [64, 48]);
        let at = |p: Vec3| view.world_to_camera.transform_point3(p);
        let centre = at(Vec3::new(0.5, 0.25, -1.0));
        assert!(centre.truncate().length() < 1e-5 && centre.z > 0.0);
        assert!(at(Vec3::new(0.5, 0.25, 0.0)).y < 0.0, "up in the world is up on the screen");
        assert!(view.eye().distance(Vec3::new(3.0, -2.0, 1.0)) < 1e-5);
        let straight_down = View::look_at(Vec3::Z, Vec3::ZERO, 45.0, [8, 8]);
        assert!(straight_down.world_to_camera.is_finite());
        assert!(straight_down.world_to_camera.transform_point3(Vec3::Y).y < 0.0);
    }

    #[test]
    fn files_hold_rows_and_either_background() {
        let text = r##"{"width":4,"height":3,"fx":1,"fy":2,"cx":3,"cy":4,"background":"#ff8000",
            "world_to_camera":[[1,0,0,5],[0,1,0,6],[0,0,1,7],[0,0,0,1]]}"##;
        let view: View = serde_json::from_str(text).unwrap();
        assert_eq!(view.world_to_camera.transform_point3(Vec3::ZERO), Vec3::new(5.0, 6.0, 7.0));
        assert_eq!(view.background, [1.0, 128.0 / 255.0, 0.0]);
        let again: View = serde_json::from_str(&serde_json::to_string(&view).unwrap()).unwrap();
        assert_eq!(again, view);
        assert!(serde_json::from_str::<View>(&text.replace("#ff8000", "#ff80é")).is_err());
        assert!(serde_json::from_str::<View>(&text.replace("[0,0,1,7]", "[0,0,0,7]")).is_err(), "singular");
    }
}
