//! The emitted Verilog as text, and on disk.

mod common;
#[path = "common/tools.rs"]
mod tools;

use std::path::Path;
use std::process::Command;
use std::sync::Arc;

use hdl_gen::emit::{EmitError, verilog, write_design};
use hdl_gen::netlist::{Builder, Module};

/// Compares with the committed file, or rewrites it where UPDATE_EXPECTED=1.
fn expect_file(module: &Module) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/expected")
        .join(format!("{}.v", module.name));
    let text = verilog(module, "VERSION");
    if std::env::var_os("UPDATE_EXPECTED").is_some_and(|value| value == "1") {
        std::fs::write(&path, &text).unwrap();
    }
    let expected = std::fs::read_to_string(&path).unwrap_or_default();
    assert_eq!(
        text,
        expected,
        "{} differs; UPDATE_EXPECTED=1 rewrites it",
        path.display()
    );
}

#[test]
fn emitted_text_is_as_committed() {
    expect_file(&common::leading_zeros());
    expect_file(&common::normalised_difference());
}

#[test]
fn tools_read_it_without_a_word() {
    let top = common::normalised_difference();
    if tools::has_tool("verilator") {
        assert_eq!(tools::lint(&top, &[]), "");
    }
    if tools::has_tool("yosys") {
        let folder = tempfile::tempdir().unwrap();
        let paths = write_design(&top, folder.path()).unwrap();
        let files: Vec<_> = paths
            .iter()
            .map(|path| path.display().to_string())
            .collect();
        let script = format!(
            "read_verilog {}; hierarchy -check -top {}; proc; check -assert",
            files.join(" "),
            top.name
        );
        let said = tools::run(Command::new("yosys").args(["-q", "-e", ".*", "-p", &script]));
        assert_eq!(said, "");
    }
}

#[test]
fn a_design_is_written_one_module_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().join("deep/verilog");
    let paths = write_design(&common::normalised_difference(), &dir).unwrap();
    let names: Vec<_> = paths.iter().map(|path| path.file_name().unwrap()).collect();
    assert_eq!(names, ["leading_zeros_8.v", "normalised_difference.v"]);
    let on_disk = std::fs::read_dir(&dir).unwrap().count();
    assert_eq!(on_disk, 2, "nothing else is left there");
    // Written over what was there.
    assert_eq!(
        write_design(&common::normalised_difference(), &dir).unwrap(),
        paths
    );
    let text = std::fs::read_to_string(&paths[0]).unwrap();
    assert!(text.contains(&format!(
        "Emitted by stepwell {}",
        env!("CARGO_PKG_VERSION")
    )));
}

fn wrapper(name: &str, constant: u64) -> Arc<Module> {
    let mut b = Builder::new(name);
    let a = b.input("a_i", 4);
    let constant = b.constant(constant, 4);
    let sum = b.add(a, constant);
    b.output("y_o", sum);
    b.finish()
}

#[test]
fn two_modules_of_one_name_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let user = |modules: [Arc<Module>; 2]| {
        let mut b = Builder::new("user");
        let a = b.input("a_i", 4);
        let first = b.instance("first", &modules[0], &[a]);
        let second = b.instance("second", &modules[1], &[first[0]]);
        b.output("y_o", second[0]);
        b.finish()
    };
    let same = user([wrapper("offset", 1), wrapper("offset", 1)]);
    assert_eq!(write_design(&same, folder.path()).unwrap().len(), 2);
    let different = user([wrapper("offset", 1), wrapper("offset", 2)]);
    let error = write_design(&different, folder.path()).unwrap_err();
    assert!(matches!(error, EmitError::NameClash { name } if name == "offset"));
}

#[test]
fn a_folder_that_cannot_be_made_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("taken");
    std::fs::write(&file, "").unwrap();
    let error = write_design(&wrapper("offset", 1), &file).unwrap_err();
    assert!(error.to_string().contains("taken"), "{error}");
}
