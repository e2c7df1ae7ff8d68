//! Frames of the methods that sample.
//!
//! Parallax occlusion mapping samples a ray by its angle in the world, which the frame's surface
//! tells. Depth-interval grids need the frame itself: the rays of a pixel block's corners are
//! sampled first, from top to bottom, and between the depths they find the block's pixels are
//! searched.
//!
//! # The grid
//!
//! Blocks are [`BLOCK`] pixels on a side. The corners of a block are the first pixels of four
//! blocks: its own, those to the right and below, and the one across; where there is none, the
//! frame's last pixel stands in. A corner ray that passes above the surface at sample n - 1 and
//! below it at n says that it is met between them. A block's pixels are searched from the least
//! n - 1 to the greatest n of its corners, [`INTERVAL_MARGIN`](crate::units::linear_ray::INTERVAL_MARGIN) samples further on both sides. If a
//! corner pixel has no ray, the block's pixels are searched from top to bottom.
//!
//! A corner ray is that of a pixel, and its samples count as steps of that pixel, beside those of
//! the pixel's own search.

use rayon::prelude::*;

use super::{Progress, WalkFrameError, admit};
use crate::maps::Pyramid;
use crate::scene::{LinearSearch, Scene};
use crate::units::linear_ray::{LINEAR_SAMPLES, SampleRange};
use crate::units::pixel_block::BLOCK;
use crate::units::traverse::Hit;
use crate::walker::Walker;

/// Rows of pixels that a thread takes at once: of blocks.
const ROWS: usize = BLOCK as usize;

/// The hits of a frame whose rays have been checked, row by row.
pub(super) fn walk_sampled(
    scene: &Scene,
    search: LinearSearch,
    pyramid: &Pyramid,
    progress: Progress<'_>,
) -> Result<Vec<Option<Hit<f64>>>, WalkFrameError> {
    let (width, height) = (scene.frame.width, scene.frame.height);
    let grid = match search {
        LinearSearch::Dig => Some(Grid::of(scene, pyramid)?),
        LinearSearch::Relief | LinearSearch::Pom => None,
    };
    let view = scene.view();
    let mut hits = vec![None; width as usize * height as usize];
    let rows = hits.par_chunks_mut(width as usize * ROWS).enumerate();
    rows.try_for_each_init(
        || Walker::for_frame(scene.walk, pyramid, &scene.surface),
        |walker, (number, places)| {
            let walker = walker.as_mut().map_err(|error| *error)?;
            for (place, answer) in places.iter_mut().enumerate() {
                let (x, y) = super::place(number * ROWS * width as usize + place, width);
                let Some(ray) = admit(walker, &view, x, y)? else {
                    continue;
                };
                *answer = Some(match &grid {
                    None => walker.walk(ray),
                    Some(grid) => {
                        let hit = walker.search_within(ray, grid.samples(x, y));
                        let steps = hit.steps + grid.corner_steps(x, y);
                        Hit { steps, ..hit }
                    }
                });
            }
            progress(places.len() as u64);
            Ok::<(), WalkFrameError>(())
        },
    )?;
    Ok(hits)
}

/// The first samples below the surface of all corner rays of a frame.
struct Grid {
    width: u32,
    height: u32,
    /// Corners in a row.
    columns: u32,
    /// Row by row; none where the corner's pixel has no ray.
    samples: Vec<Option<u32>>,
}

impl Grid {
    fn of(scene: &Scene, pyramid: &Pyramid) -> Result<Grid, WalkFrameError> {
        let (width, height) = (scene.frame.width, scene.frame.height);
        let (columns, rows) = (width.div_ceil(BLOCK) + 1, height.div_ceil(BLOCK) + 1);
        let mut grid = Grid {
            width,
            height,
            columns,
            samples: Vec::new(),
        };
        let view = scene.view();
        let corners = (0..columns * rows).into_par_iter().map_init(
            || Walker::for_frame(scene.walk, pyramid, &scene.surface),
            |walker, corner| {
                let walker = walker.as_mut().map_err(|error| *error)?;
                let (x, y) = grid.pixel(corner % columns, corner / columns);
                let ray = admit(walker, &view, x, y)?;
                Ok(ray.map(|ray| walker.first_sample_below(ray)))
            },
        );
        let samples = corners.collect::<Result<_, WalkFrameError>>()?;
        grid.samples = samples;
        Ok(grid)
    }

    /// The pixel of a corner.
    fn pixel(&self, column: u32, row: u32) -> (u32, u32) {
        (
            (column * BLOCK).min(self.width - 1),
            (row * BLOCK).min(self.height - 1),
        )
    }

    /// The samples to search for a pixel.
    fn samples(&self, x: u32, y: u32) -> SampleRange {
        let (column, row) = (x / BLOCK, y / BLOCK);
        let corners = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|corner| {
            let place = (row + corner.1) * self.columns + column + corner.0;
            self.samples[place as usize]
        });
        match corners {
            [Some(a), Some(b), Some(c), Some(d)] => SampleRange::between_corners(&[a, b, c, d]),
            _ => SampleRange::whole(LINEAR_SAMPLES),
        }
    }

    /// Samples that the pixel's ray took as a corner ray: none if it is none.
    fn corner_steps(&self, x: u32, y: u32) -> u32 {
        let corner = |pixel: u32, last: u32| match pixel {
            pixel if pixel.is_multiple_of(BLOCK) => Some(pixel / BLOCK),
            pixel if pixel == last => Some(pixel / BLOCK + 1),
            _ => None,
        };
        let corner = corner(x, self.width - 1).zip(corner(y, self.height - 1));
        corner
            .and_then(|(column, row)| self.samples[(row * self.columns + column) as usize])
            .unwrap_or(0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A grid over 10 x 5 pixels: corners at 0, 4, 8, 9 and at 0, 4, 4.
    fn grid() -> Grid {
        let samples = [
            [10, 20, 30, 40].map(Some),
            [12, 18, 90, 100].map(Some),
            [Some(1), Some(1), None, Some(2)],
        ];
        Grid {
            width: 10,
            height: 5,
            columns: 4,
            samples: samples.concat(),
        }
    }

    fn range(first: u32, last: u32) -> SampleRange {
        SampleRange {
            samples_to_bottom: LINEAR_SAMPLES,
            first,
            last,
        }
    }

    #[test]
    fn a_block_is_searched_between_its_corners_and_a_margin() {
        let grid = grid();
        for (x, y) in [(0, 0), (3, 3), (1, 2)] {
            assert_eq!(grid.samples(x, y), range(9, 21));
        }
        assert_eq!(grid.samples(5, 0), range(17, 91));
        assert_eq!(grid.samples(9, 3), range(29, 100));
        assert_eq!(grid.samples(0, 4), range(1, 19));
    }

    #[test]
    fn a_corner_without_a_ray_confines_nothing() {
        assert_eq!(grid().samples(8, 4), range(1, 100));
        assert_eq!(grid().samples(4, 4), range(1, 100));
    }

    #[test]
    fn samples_of_a_corner_ray_are_its_pixels() {
        let grid = grid();
        assert_eq!(grid.pixel(3, 2), (9, 4));
        let steps: Vec<u32> = (0..10).map(|x| grid.corner_steps(x, 0)).collect();
        assert_eq!(steps, [10, 0, 0, 0, 20, 0, 0, 0, 30, 40]);
        let steps: Vec<u32> = (0..5).map(|y| grid.corner_steps(4, y)).collect();
        // The last row of pixels is also the first of a block: its corners are one row, not two.
        assert_eq!(steps, [20, 0, 0, 0, 18]);
    }
}
