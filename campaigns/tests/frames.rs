//! A slice of the campaign of frames: small ones, of the maps as they are, tiled and enlarged.

use std::path::Path;

use campaigns::frames::{FrameRun, Variant};
use rtl_model::scene::{FrameSize, Method};

fn run(variant: Variant, format: &str, screen: (u32, u32)) {
    let run = FrameRun {
        variant,
        format: format.parse().unwrap(),
        methods: Method::ALL.into_iter().filter(|m| m.is_safe()).collect(),
        screen: FrameSize {
            width: screen.0,
            height: screen.1,
        },
    };
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let rows = run.walk(&workspace, &|| ()).unwrap();
    assert_eq!(rows.len(), run.methods.len());
    for row in &rows {
        println!("{}", row.line());
    }
    for row in rows {
        assert!(row.rays > 300, "{}", row.line());
        // Of so few rays a share means little: what may never be is asked for, and that wrong
        // texels are few.
        assert_eq!(row.guards + row.late, 0, "{}", row.line());
        match format {
            "e7f16" => assert!(row.wrong * 100 <= row.rays, "{}", row.line()),
            _ => assert_eq!(row.wrong, 0, "{}", row.line()),
        }
    }
}

#[test]
fn maps_as_they_are() {
    for format in ["f64", "exact", "e7f16"] {
        run(Variant::Own, format, (48, 36));
    }
}

#[test]
fn maps_enlarged_and_tiled() {
    for variant in [Variant::Enlarged(1024), Variant::Tiled(1024)] {
        for format in ["f64", "exact", "e7f16"] {
            run(variant, format, (16, 12));
        }
    }
}
