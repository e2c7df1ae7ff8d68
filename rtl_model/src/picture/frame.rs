//! What a traversal found for each pixel.

use thiserror::Error;

/// Where a pixel's ray met the surface, and what that took.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelHit {
    /// Column of the texel that was hit.
    pub i: u32,
    /// Its row.
    pub j: u32,
    /// Depth of the hit, 0 (top) to 1 (bottom).
    pub t: f64,
    /// Position of the hit, in texture coordinates; 1.0 is one repeat of the map.
    pub u: f64,
    /// Position of the hit along the other axis.
    pub v: f64,
    /// Trips of the traversal's main loop.
    pub steps: u32,
    /// Node borders crossed.
    pub crossings: u32,
}

/// A frame of pixels, row by row from the upper left; none where a pixel has no ray.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    width: u32,
    height: u32,
    hits: Vec<Option<PixelHit>>,
}

/// A frame whose pixels are not as many as its size says.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{found} pixels for a frame of {width} x {height}; give one for each, and at least one")]
pub struct FrameError {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Pixels given.
    pub found: usize,
}

impl Frame {
    /// A frame of `width` x `height` pixels.
    ///
    /// # Errors
    /// Another number of hits than of pixels, or no pixel.
    pub fn new(width: u32, height: u32, hits: Vec<Option<PixelHit>>) -> Result<Frame, FrameError> {
        let pixels = u64::from(width) * u64::from(height);
        if pixels == 0 || hits.len() as u64 != pixels {
            return Err(FrameError {
                width,
                height,
                found: hits.len(),
            });
        }
        Ok(Frame {
            width,
            height,
            hits,
        })
    }

    /// Pixels in a row.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// All pixels, row by row.
    pub fn hits(&self) -> &[Option<PixelHit>] {
        &self.hits
    }

    /// The hit of pixel `(x, y)`, counted from the upper left; none outside the frame too.
    pub fn hit(&self, x: u32, y: u32) -> Option<&PixelHit> {
        if x >= self.width {
            return None;
        }
        let index = y as usize * self.width as usize + x as usize;
        self.hits.get(index)?.as_ref()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_has_as_many_hits_as_pixels() {
        assert!(Frame::new(2, 3, vec![None; 6]).is_ok());
        assert!(Frame::new(2, 3, vec![None; 5]).is_err());
        assert!(Frame::new(0, 3, vec![]).is_err());
    }

    #[test]
    fn hits_are_found_by_column_and_row() {
        let hit = PixelHit {
            i: 1,
            j: 2,
            t: 0.5,
            u: 0.1,
            v: 0.2,
            steps: 9,
            crossings: 0,
        };
        let mut hits = vec![None; 6];
        hits[3] = Some(hit);
        let frame = Frame::new(2, 3, hits).unwrap();
        assert_eq!(frame.hit(1, 1), Some(&hit));
        assert_eq!(frame.hit(0, 1), None);
        assert_eq!(frame.hit(3, 0), None);
        assert_eq!(frame.hit(1, 3), None);
    }
}
