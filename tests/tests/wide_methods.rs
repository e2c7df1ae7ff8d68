//! Methods `quad`, `block` and `window` on the real maps at the three calibrated cameras: the right
//! texel, never late, and as few steps beside `mixed-selective` as is promised.
//!
//! Where there are no real maps a procedural one is walked, and steps are not compared; in CI that
//! is a failure.

use rtl_model::calibration::CAMERAS;
use rtl_model::judge::{Truth, Verdict};
use rtl_model::maps::Pyramid;
use rtl_model::scene::{Crossing, Method};
use tests::subjects::{frame, subjects};

/// A method's verdicts over all maps, by camera.
struct Judged {
    verdicts: [Verdict; 3],
    /// Mean steps a ray, the mean of the maps' means.
    steps: [f64; 3],
}

fn judge<const N: usize>(methods: [Method; N], format: &str) -> [Judged; N] {
    let mut judged = methods.map(|_| Judged {
        verdicts: [Verdict::default(); 3],
        steps: [0.0; 3],
    });
    let subjects = subjects();
    let format = format.parse().expect("a format");
    for subject in &subjects {
        let pyramid = Pyramid::new(&subject.map);
        for (camera, (name, _)) in CAMERAS.iter().enumerate() {
            let rays = frame(subject, camera, 160, 120);
            let truth = Truth::of(format, &subject.map, &pyramid, &rays, &|_| ()).expect("a truth");
            for (method, judged) in methods.iter().zip(&mut judged) {
                let verdict = truth
                    .judge_walk(*method, Crossing::Index, &pyramid, &|_| ())
                    .expect("a verdict");
                assert_eq!(
                    (verdict.late, verdict.guards),
                    (0, 0),
                    "{method} in {format}, {} {name}: {verdict:?}",
                    subject.name
                );
                let steps = verdict.mean_steps().expect("rays");
                judged.steps[camera] += steps / subjects.len() as f64;
                judged.verdicts[camera] = judged.verdicts[camera].plus(verdict);
            }
        }
    }
    judged
}

/// The most mean steps of a method, as shares of those of `mixed-selective`: measured at the size below,
/// and a little more. The target of `block` is 0.60, 0.52 and 0.45.
const MOST_STEPS: [(Method, [f64; 3]); 3] = [
    (Method::Quad, [0.65, 0.67, 0.61]),
    (Method::Block, [0.44, 0.41, 0.36]),
    (Method::Window, [0.35, 0.32, 0.35]),
];

#[test]
fn in_f64_no_texel_is_wrong_and_steps_are_few() {
    let is_real = subjects().iter().all(|subject| subject.is_real);
    let [quad, block, window, mixed] = [
        Method::Quad,
        Method::Block,
        Method::Window,
        Method::MixedSelective,
    ];
    let [quad, block, window, mixed] = judge([quad, block, window, mixed], "f64");
    for ((method, most), judged) in MOST_STEPS.into_iter().zip([quad, block, window]) {
        for (camera, verdict) in judged.verdicts.iter().enumerate() {
            let share = judged.steps[camera] / mixed.steps[camera];
            let name = CAMERAS[camera].0;
            println!(
                "{method:6} {name:8} {:6} rays, {:5.2} steps, {share:.3} of mixed-selective, {} wrong",
                verdict.rays, judged.steps[camera], verdict.wrong
            );
            assert_eq!(verdict.wrong, 0, "{method} {name}");
            assert!(verdict.rays > 2_000, "too few rays prove nothing");
            assert!(
                !is_real || share <= most[camera],
                "{method} {name}: {share}"
            );
        }
    }
}

#[test]
fn e7f16_errs_rarely_and_never_late() {
    let methods = [Method::Quad, Method::Block, Method::Window];
    for (method, judged) in methods.iter().zip(judge(methods, "e7f16")) {
        let all = judged.verdicts.into_iter().reduce(Verdict::plus);
        let all = all.expect("cameras");
        let share = 100.0 * all.wrong_share().expect("rays");
        println!(
            "{method:6} {} rays, {share:.4} % in another texel",
            all.rays
        );
        assert!(share <= 0.05, "{method}: {share} %");
    }
}
