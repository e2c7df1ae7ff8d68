//! Methods `quad`, `block` and `window` on the seven real maps at the three calibrated cameras: the right texel, never
//! late, and as few steps as is promised.
//!
//! Where there are no real maps a procedural one is walked, and steps are not compared; in CI that
//! is a failure.

use rtl_model::calibration::{CAMERAS, SURFACES, real_maps};
use rtl_model::camera::{Surface, View};
use rtl_model::judge::{Truth, Verdict};
use rtl_model::maps::{Channel, HeightMap, MapSource, Pyramid};
use rtl_model::ray::Ray;
use rtl_model::scene::{Crossing, Method};

struct Subject {
    name: String,
    map: HeightMap,
    surface: Surface,
}

/// The maps, and whether they are the real ones.
fn subjects() -> (Vec<Subject>, bool) {
    let found = real_maps(tests::command_line::workspace()).expect("in CI the real maps are there");
    let Some(folder) = found else {
        println!("no real height maps: a procedural one stands in (set STEPWELL_MAPS)");
        let source = MapSource::parse("procedural:rocks:256:1").expect("a procedural map");
        let stand_in = Subject {
            name: source.to_string(),
            map: source.load(Channel::Grey, false).expect("a procedural map"),
            surface: SURFACES[0].surface,
        };
        return (vec![stand_in], false);
    };
    let load = |file| HeightMap::load(&folder.join(file), Channel::Alpha, false);
    let subjects = SURFACES.iter().map(|calibrated| Subject {
        name: calibrated.name.to_owned(),
        map: load(calibrated.file).expect("a height map of the paper"),
        surface: calibrated.surface,
    });
    (subjects.collect(), true)
}

fn frame(subject: &Subject, camera: usize, width: u32, height: u32) -> Vec<Ray<f64>> {
    let view = View::new(&CAMERAS[camera].1, &subject.surface, width, height);
    let rays = view.rays(subject.map.size()).expect("rays within reach");
    rays.into_iter().flatten().collect()
}

/// The verdicts over all maps, by camera, and mean steps a ray: the mean of the maps' means.
fn judge(method: Method, format: &str, width: u32, height: u32) -> ([Verdict; 3], [f64; 3]) {
    let mut verdicts = [Verdict::default(); 3];
    let mut steps = [0.0; 3];
    let (subjects, _) = subjects();
    for subject in &subjects {
        let pyramid = Pyramid::new(&subject.map);
        for camera in 0..CAMERAS.len() {
            let rays = frame(subject, camera, width, height);
            let format = format.parse().expect("a format");
            let truth = Truth::of(format, &subject.map, &pyramid, &rays, &|_| ()).expect("a truth");
            let verdict = truth
                .judge_walk(method, Crossing::Index, &pyramid, &|_| ())
                .expect("a verdict");
            assert_eq!(
                (verdict.late, verdict.guards),
                (0, 0),
                "{method} in {format}, {} {}: {verdict:?}",
                subject.name,
                CAMERAS[camera].0
            );
            steps[camera] += verdict.mean_steps().expect("rays") / subjects.len() as f64;
            verdicts[camera] = verdicts[camera].plus(verdict);
        }
    }
    (verdicts, steps)
}

/// Mean steps of `mixed-selective` at these cameras, the mean of the seven maps at 1024 x 768.
const MIXED_SELECTIVE: [f64; 3] = [5.0, 10.1, 18.4];

/// The most mean steps of a method, as shares of [`MIXED_SELECTIVE`]: measured at 1024 x 768, and a
/// little more.
const MOST_STEPS: [(Method, [f64; 3]); 3] = [
    (Method::Quad, [0.65, 0.67, 0.61]),
    (Method::Block, [0.44, 0.40, 0.36]),
    (Method::Window, [0.35, 0.32, 0.35]),
];

#[test]
fn in_f64_no_texel_is_wrong_and_steps_are_few() {
    let is_real = subjects().1;
    for (method, most) in MOST_STEPS {
        let (verdicts, steps) = judge(method, "f64", 160, 120);
        for (camera, verdict) in verdicts.iter().enumerate() {
            let share = steps[camera] / MIXED_SELECTIVE[camera];
            println!(
                "{method} {:8} {:6} rays, {:5.2} steps, {share:.3} of mixed-selective, {} wrong",
                CAMERAS[camera].0, verdict.rays, steps[camera], verdict.wrong
            );
            assert_eq!(verdict.wrong, 0, "{method} {}", CAMERAS[camera].0);
            assert!(
                !is_real || share <= most[camera],
                "{method} {}",
                CAMERAS[camera].0
            );
        }
        assert!(verdicts[1].rays > 50_000, "too few rays prove nothing");
    }
}

#[test]
fn e7f16_errs_rarely_and_never_late() {
    for method in [Method::Quad, Method::Block, Method::Window] {
        let (verdicts, _) = judge(method, "e7f16", 160, 120);
        let all = verdicts.into_iter().reduce(Verdict::plus).expect("cameras");
        let share = 100.0 * all.wrong_share().expect("rays");
        println!("{method}: {} rays, {share:.4} % in another texel", all.rays);
        assert!(share <= 0.05, "{method}: {share} %");
    }
}
