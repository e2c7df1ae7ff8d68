//! The families of hard cases as generators: maps and rays of each kind, by every method, in the
//! formats that promise something.

use proptest::prelude::*;
use proptest::sample::select;
use rtl_model::hard::{ExpectedHit, HardCase, HardFamily, HardRay, PreparedCase};
use rtl_model::judge::JudgeError;
use rtl_model::maps::HeightMap;
use rtl_model::ray::Ray;
use rtl_model::scene::{Crossing, Method};

/// Heights whose depths are thirds and fifths, the ends and a step beside them.
const HEIGHTS: [u16; 10] = [0, 1, 51, 85, 102, 153, 170, 204, 254, 255];

/// A map, of so many texels a side.
fn map(
    heights: impl Strategy<Value = u16> + Clone + 'static,
    largest: u32,
) -> BoxedStrategy<HeightMap> {
    (0..=largest)
        .prop_flat_map(move |log2_size| {
            let size = 1_u32 << log2_size;
            let texels = (size * size) as usize;
            prop::collection::vec(heights.clone(), texels)
                .prop_map(move |heights| HeightMap::new("family", size, 8, heights).unwrap())
        })
        .boxed()
}

/// A map of many ties.
fn any_map() -> BoxedStrategy<HeightMap> {
    map(select(&HEIGHTS[..]), 4)
}

/// A plain with a few texels of another height.
fn plain(ground: &'static [u16], others: &'static [u16]) -> BoxedStrategy<HeightMap> {
    (
        1_u32..=4,
        select(ground),
        prop::collection::vec((0_u32..256, select(others)), 1..4),
    )
        .prop_map(|(log2_size, ground, texels)| {
            let size = 1_u32 << log2_size;
            let count = (size * size) as usize;
            let mut heights = vec![ground; count];
            for (texel, height) in texels {
                heights[texel as usize % count] = height;
            }
            HeightMap::new("plain", size, 8, heights).unwrap()
        })
        .boxed()
}

/// Places in texels, in 2^-`bits` of one; slopes in texels from top to bottom.
#[derive(Clone, Copy, Debug)]
struct TexelRay([f64; 4]);

impl TexelRay {
    fn on(self, map: &HeightMap) -> Ray<f64> {
        let [u, v, du, dv] = self.0.map(|texels| texels / f64::from(map.size()));
        Ray { u, v, du, dv }
    }
}

/// A number of texels in steps of `2^-bits`, exactly.
fn texels(range: std::ops::Range<i32>, bits: i32) -> impl Strategy<Value = f64> + Clone {
    let steps = 2_f64.powi(bits);
    ((range.start << bits)..(range.end << bits)).prop_map(move |place| f64::from(place) / steps)
}

/// A border, or as little beside it as e7f16, or f64, can tell.
fn at_border() -> impl Strategy<Value = f64> {
    (
        1..16_i32,
        select(&[0.0, 0.0, 1.0, -1.0][..]),
        select(&[-12, -16, -20, -40][..]),
    )
        .prop_map(|(border, side, exponent)| f64::from(border) + side * 2_f64.powi(exponent))
}

/// Slopes that meet borders at thirds and fifths of the depth.
fn tie_slope() -> impl Strategy<Value = f64> {
    select(
        &[
            0.0, 0.5, 1.0, 1.5, 2.5, 3.0, 5.0, 7.5, 15.0, -0.5, -1.0, -1.5, -2.5, -3.0, -5.0, -7.5,
            -15.0,
        ][..],
    )
}

fn ray(
    u: impl Strategy<Value = f64> + 'static,
    v: impl Strategy<Value = f64> + 'static,
    du: impl Strategy<Value = f64> + 'static,
    dv: impl Strategy<Value = f64> + 'static,
) -> BoxedStrategy<TexelRay> {
    (u, v, du, dv)
        .prop_map(|(u, v, du, dv)| TexelRay([u, v, du, dv]))
        .boxed()
}

/// The maps and rays of a family.
fn family(family: HardFamily) -> (BoxedStrategy<HeightMap>, BoxedStrategy<TexelRay>) {
    let sign = || select(&[1.0, -1.0][..]);
    match family {
        HardFamily::AlongBorder => {
            let border = || (0..16).prop_map(f64::from);
            let along_v = ray(border(), texels(0..16, 3), Just(0.0), texels(-16..17, 2));
            let along_u = ray(texels(0..16, 3), border(), texels(-16..17, 2), Just(0.0));
            (any_map(), prop_oneof![along_u, along_v].boxed())
        }
        HardFamily::AlongDiagonal => {
            let rays = (
                0..16_i32,
                0..16_i32,
                1..17_i32,
                sign(),
                sign(),
                prop::bool::ANY,
            )
                .prop_map(|(i, j, length, right, down, is_centred)| {
                    let offset = if is_centred { 0.5 } else { 0.0 };
                    let [u, v] = [i, j].map(|place| f64::from(place) + offset);
                    TexelRay([u, v, right * f64::from(length), down * f64::from(length)])
                });
            (any_map(), rays.boxed())
        }
        HardFamily::ZeroDirection => {
            let hardly = || {
                select(vec![
                    0.0,
                    -0.0,
                    2_f64.powi(-62),
                    -2_f64.powi(-62),
                    1.0,
                    -2.5,
                ])
            };
            (
                any_map(),
                ray(texels(0..16, 2), texels(0..16, 2), hardly(), hardly()),
            )
        }
        HardFamily::ExtremeSlope => {
            let extreme = || {
                let magnitude = select(&[-60, -30, -14, -8, 3, 8, 11, 14][..]);
                (magnitude, sign()).prop_map(|(exponent, sign)| sign * 2_f64.powi(exponent))
            };
            (
                any_map(),
                ray(texels(0..16, 3), texels(0..16, 3), extreme(), extreme()),
            )
        }
        HardFamily::EntryOnBorder => (
            any_map(),
            ray(at_border(), at_border(), texels(-4..5, 2), texels(-4..5, 2)),
        ),
        HardFamily::HitOnBorder | HardFamily::EqualHeights => {
            let place = || texels(0..16, 1);
            (any_map(), ray(place(), place(), tie_slope(), tie_slope()))
        }
        HardFamily::HitOnCorner => {
            let rays = (0..16_i32, 0..16_i32, tie_slope(), sign(), sign()).prop_map(
                |(i, j, slope, right, down)| {
                    TexelRay([f64::from(i), f64::from(j), right * slope, down * slope])
                },
            );
            (any_map(), rays.boxed())
        }
        HardFamily::TopAndBottom => {
            let maps = map(select(&[0_u16, 0, 1, 254, 255][..]), 3);
            (
                maps,
                ray(
                    texels(0..8, 1),
                    texels(0..8, 1),
                    texels(-8..9, 1),
                    texels(-8..9, 1),
                ),
            )
        }
        HardFamily::Spike => {
            let maps = plain(&[0, 1, 51], &[1, 204, 254, 255]);
            (
                maps,
                ray(
                    texels(0..16, 4),
                    texels(0..16, 4),
                    texels(-32..33, 3),
                    texels(-32..33, 3),
                ),
            )
        }
        HardFamily::Pit => {
            let maps = plain(&[255, 254, 204], &[0, 1, 254]);
            (
                maps,
                ray(
                    texels(0..16, 2),
                    texels(0..16, 2),
                    texels(-300..301, 0),
                    texels(-8..9, 2),
                ),
            )
        }
        HardFamily::Checkerboard => {
            let maps = (1_u32..=4, select(&HEIGHTS[..]), select(&HEIGHTS[..])).prop_map(
                |(log2_size, one, other)| {
                    let size = 1_u32 << log2_size;
                    let squares = (0..size * size).map(|texel| (texel % size + texel / size) % 2);
                    let heights = squares.map(|square| if square == 0 { one } else { other });
                    HeightMap::new("checkerboard", size, 8, heights.collect()).unwrap()
                },
            );
            (
                maps.boxed(),
                ray(texels(0..16, 1), texels(0..16, 1), tie_slope(), tie_slope()),
            )
        }
        HardFamily::Plateau => {
            let maps = map(select(&[102_u16, 102, 102, 153][..]), 3);
            (
                maps,
                ray(texels(0..8, 1), texels(0..8, 1), tie_slope(), tie_slope()),
            )
        }
        HardFamily::WrapAround => {
            let maps = plain(&[0], &[20, 51, 255]);
            (
                maps,
                ray(
                    texels(0..16, 2),
                    texels(0..16, 2),
                    texels(-600..601, 0),
                    texels(-600..601, 1),
                ),
            )
        }
        HardFamily::MapSize => {
            let maps = map(select(&HEIGHTS[..]), 1);
            (
                maps,
                ray(
                    texels(0..2, 4),
                    texels(0..2, 4),
                    texels(-64..65, 4),
                    texels(-64..65, 4),
                ),
            )
        }
        HardFamily::Grazing => {
            let maps = plain(&[0, 51], &[60, 200]);
            let slope = || (sign(), texels(200..900, 6)).prop_map(|(sign, slope)| sign * slope);
            (
                maps,
                ray(
                    texels(0..16, 6),
                    texels(0..16, 6),
                    slope(),
                    prop_oneof![slope(), texels(-2..3, 4)],
                ),
            )
        }
        HardFamily::ReEntry => {
            let maps = plain(&[0, 51], &[204, 255]);
            let slope = || {
                (1..16_i32, 1..12_i32, sign()).prop_map(|(over, under, sign)| {
                    // Near a fraction, as e7f16 holds it: depths and positions round every time.
                    let slope = f64::from(over) / f64::from(under) * 4096.0;
                    sign * slope.round() / 4096.0
                })
            };
            (maps, ray(at_border(), at_border(), slope(), slope()))
        }
        HardFamily::NearCorner => {
            let maps = plain(&[0], &[204, 255]);
            let rays = (
                0..16_i32,
                0..16_i32,
                1..16_i32,
                sign(),
                sign(),
                select(&[-8, -12, -14, -15, -16, -20][..]),
            )
                .prop_map(|(i, j, length, right, down, exponent)| {
                    let length = f64::from(length);
                    TexelRay([
                        f64::from(i) + 2_f64.powi(exponent),
                        f64::from(j),
                        right * length,
                        down * length,
                    ])
                });
            (maps, rays.boxed())
        }
        // The published cases are files; rays of any kind on any map stand for what is not known yet.
        HardFamily::Published => (
            any_map(),
            ray(
                texels(0..16, 12),
                texels(0..16, 12),
                texels(-20..21, 12),
                texels(-20..21, 12),
            ),
        ),
    }
}

/// A map with some rays of a family.
fn case(kind: HardFamily) -> impl Strategy<Value = HardCase> {
    let (maps, rays) = family(kind);
    (maps, prop::collection::vec(rays, 1..6)).prop_map(move |(map, rays)| {
        let expected = ExpectedHit {
            i: 0,
            j: 0,
            depth: (0, 1),
            side: false,
        };
        let rays = rays.into_iter().map(|ray| HardRay {
            note: String::new(),
            ray: ray.on(&map),
            expected,
        });
        HardCase {
            name: kind.to_string(),
            family: kind,
            why: String::new(),
            source: String::new(),
            rays: rays.collect(),
            map,
        }
    })
}

/// Walks a case by every method in every format: promises are kept. Rays walked.
fn walked(case: &HardCase) -> Result<u64, TestCaseError> {
    let mut rays = 0;
    for format in ["e7f16", "e8f23", "f64", "exact", "fixed"] {
        let prepared = PreparedCase::new(case, format.parse().unwrap());
        let prepared = prepared.map_err(|problem| TestCaseError::fail(problem.to_string()))?;
        let levels = [1, 3, 4].map(Method::MultiLevelDown);
        for method in Method::ALL.into_iter().chain(levels) {
            let assessment = match prepared.assess(method, Crossing::Index) {
                // Samplers do not walk in every format, nor a list of rays.
                Err(JudgeError::Walk(_)) if !method.is_safe() => continue,
                assessment => {
                    assessment.map_err(|problem| TestCaseError::fail(problem.to_string()))?
                }
            };
            let defects: Vec<_> = assessment.defects().collect();
            prop_assert_eq!(
                defects,
                vec![],
                "{} in {}: heights {:?}, rays {:?}",
                method,
                format,
                case.map.heights(),
                case.rays.iter().map(|ray| ray.ray).collect::<Vec<_>>()
            );
            rays += assessment.walked();
        }
    }
    prop_assert!(rays > 0, "nothing was walked");
    Ok(rays)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(600))]

    /// Every kind in turn: a failure is kept in `hard_families.proptest-regressions`.
    #[test]
    fn every_promise_is_kept_in_every_family(
        case in select(&HardFamily::ALL[..]).prop_flat_map(case)
    ) {
        walked(&case)?;
    }
}
