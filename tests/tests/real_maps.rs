//! The walk against the exact reference, and its mean steps against the 2013 paper, on the seven
//! real maps at the three calibrated cameras.

use rayon::prelude::*;
use rtl_model::calibration::{CAMERAS, SURFACES, real_maps};
use rtl_model::camera::View;
use rtl_model::exact::exact_hit;
use rtl_model::maps::{Channel, HeightMap, Pyramid};
use rtl_model::ray::Ray;
use rtl_model::readings::{E7F16, F64Reading, FloatReading, NumberFormat};
use rtl_model::units::traverse::{Status, walk};
use std::cmp::Ordering;

#[derive(Clone, Copy, Debug, Default)]
struct Tally {
    rays: u64,
    wrong: u64,
    late: u64,
    guards: u64,
    steps: u64,
}

impl Tally {
    fn plus(self, other: Tally) -> Tally {
        Tally {
            rays: self.rays + other.rays,
            wrong: self.wrong + other.wrong,
            late: self.late + other.late,
            guards: self.guards + other.guards,
            steps: self.steps + other.steps,
        }
    }
}

fn judge<R: NumberFormat + Default>(
    map: &HeightMap,
    pyramid: &Pyramid,
    rays: &[Ray<f64>],
) -> Tally {
    rays.par_chunks(1024)
        .map(|rays| {
            let mut reading = R::default();
            let mut tally = Tally::default();
            for &ray in rays {
                reading.forget();
                let ray = Ray {
                    u: reading.coordinate(ray.u),
                    v: reading.coordinate(ray.v),
                    du: reading.direction(ray.du),
                    dv: reading.direction(ray.dv),
                };
                let hit = walk(&mut reading, pyramid, pyramid.memory(), ray);
                let truth = exact_hit(map, ray.map(|value| reading.to_f64(value))).unwrap();
                let t = reading.to_f64(hit.t);
                tally.rays += 1;
                tally.steps += u64::from(hit.steps);
                tally.guards += u64::from(hit.status == Status::Guard);
                if (hit.i, hit.j) != (truth.i, truth.j) {
                    tally.wrong += 1;
                }
                if truth.t.compare_with(t) == Ordering::Less {
                    tally.late += 1;
                    if tally.late < 3 {
                        println!("late: {hit:?} {t} {truth:?} {}", truth.t.to_f64());
                    }
                }
            }
            tally
        })
        .reduce(Tally::default, Tally::plus)
}

#[test]
fn e7f16_errs_early_and_rarely() {
    let folder = real_maps(std::path::Path::new("..")).unwrap().unwrap();
    let mut all = Tally::default();
    for calibrated in SURFACES {
        let map = HeightMap::load(&folder.join(calibrated.file), Channel::Alpha, false).unwrap();
        let pyramid = Pyramid::new(&map);
        for (name, camera) in CAMERAS {
            let view = View::new(&camera, &calibrated.surface, 256, 192);
            let rays: Vec<_> = view
                .rays(map.size())
                .unwrap()
                .into_iter()
                .flatten()
                .collect();
            let f = judge::<F64Reading>(&map, &pyramid, &rays);
            let e = judge::<FloatReading<E7F16>>(&map, &pyramid, &rays);
            println!(
                "{:8} {name:8} f64 {:.2} wrong {} late {} | e7f16 {:.2} wrong {} ({:.4} %) late {} guards {}",
                calibrated.name,
                f.steps as f64 / f.rays as f64,
                f.wrong,
                f.late,
                e.steps as f64 / e.rays as f64,
                e.wrong,
                100.0 * e.wrong as f64 / e.rays as f64,
                e.late,
                e.guards
            );
            all = all.plus(e);
        }
    }
    println!("{all:?} {}", all.wrong as f64 / all.rays as f64);
}
