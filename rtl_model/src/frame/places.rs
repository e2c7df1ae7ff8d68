//! Places of an answer filled on all threads, a chunk at a time, in packets where that pays.

use rayon::prelude::*;

use super::Progress;
use crate::fixed_packet::FixedPacketWalker;
use crate::float::FloatFormat;
use crate::maps::Pyramid;
use crate::packet::PacketWalker;
use crate::ray::Ray;
use crate::ray_format::RayFormat;
use crate::scene::{Crossing, Method, Walk, WalkFormat};
use crate::units::traverse::{Hit, Status};
use crate::walker::{Walker, WalkerError};

/// Places that a thread fills before it takes others, and calls the progress function: of rays
/// walked one at a time.
const CHUNK: usize = 256;

/// The same of rays walked in packets, whose lanes run empty at the end of a chunk.
const PACKET_CHUNK: usize = 4096;

/// What stands in each place until its ray has been walked.
pub(super) const UNWALKED: Hit<f64> = Hit {
    i: 0,
    j: 0,
    t: 0.0,
    u: 0.0,
    v: 0.0,
    steps: 0,
    crossings: 0,
    status: Status::Guard,
};

/// Fills each place of `answers` that `ray_of` has an admitted ray for with what `answer` makes of
/// its hit, on all threads.
pub(super) fn walk_places<T: Send, E: Send + From<WalkerError>>(
    walk: Walk,
    pyramid: &Pyramid,
    progress: Progress<'_>,
    answers: &mut [T],
    ray_of: impl Fn(&Walker<'_>, usize) -> Result<Option<Ray<f64>>, E> + Sync,
    answer: impl Fn(Hit<f64>) -> T + Sync,
) -> Result<(), E> {
    if let Some(packets) = packets_for(walk, pyramid, answers.len()) {
        let checker = Walker::new(walk, pyramid)?;
        let chunks = answers.par_chunks_mut(PACKET_CHUNK).enumerate();
        return chunks.try_for_each_init(PacketChunk::default, |chunk, (number, places)| {
            chunk.clear();
            for offset in 0..places.len() {
                if let Some(ray) = ray_of(&checker, number * PACKET_CHUNK + offset)? {
                    chunk.rays.push(ray);
                    chunk.places.push(offset);
                }
            }
            chunk.hits.resize(chunk.rays.len(), UNWALKED);
            packets.walk(&chunk.rays, &mut chunk.hits);
            for (&offset, &hit) in chunk.places.iter().zip(&chunk.hits) {
                places[offset] = answer(hit);
            }
            progress(places.len() as u64);
            Ok(())
        });
    }
    answers.par_chunks_mut(CHUNK).enumerate().try_for_each_init(
        || Walker::new(walk, pyramid),
        |walker, (number, places)| {
            let walker = walker.as_mut().map_err(|error| *error)?;
            for (offset, place) in places.iter_mut().enumerate() {
                if let Some(ray) = ray_of(walker, number * CHUNK + offset)? {
                    *place = answer(walker.walk(ray));
                }
            }
            progress(places.len() as u64);
            Ok(())
        },
    )
}

/// A walk in packets.
pub(super) enum Packets<'a> {
    E7f16(PacketWalker<'a>),
    Fixed(Box<FixedPacketWalker<'a>>),
}

impl Packets<'_> {
    fn walk(&self, admitted: &[Ray<f64>], hits: &mut [Hit<f64>]) {
        match self {
            Packets::E7f16(packets) => packets.walk(admitted, hits),
            Packets::Fixed(packets) => packets.walk(admitted, hits),
        }
    }
}

/// The packets that this walk can go in, if there are rays enough to make up for the copy of the
/// pyramid that they need.
pub(super) fn packets_for(walk: Walk, pyramid: &Pyramid, rays: usize) -> Option<Packets<'_>> {
    if walk.crossing != Crossing::Index || rays < pyramid.memory().len() / 16 {
        return None;
    }
    match (walk.method, walk.format) {
        (Method::Oh, WalkFormat::Float(FloatFormat::E7F16)) => {
            Some(Packets::E7f16(PacketWalker::new(pyramid)))
        }
        (method, WalkFormat::Fixed(Some(format))) => {
            let format = RayFormat::told(format, pyramid).ok()?;
            let packets = FixedPacketWalker::new(method, pyramid, &format)?;
            Some(Packets::Fixed(Box::new(packets)))
        }
        _ => None,
    }
}

/// The rays of a chunk, kept from one to the next.
#[derive(Default)]
struct PacketChunk {
    rays: Vec<Ray<f64>>,
    /// Where in the chunk each ray's answer goes.
    places: Vec<usize>,
    hits: Vec<Hit<f64>>,
}

impl PacketChunk {
    fn clear(&mut self) {
        self.rays.clear();
        self.places.clear();
        self.hits.clear();
    }
}
