//! A slice of the proofs in `formal/`, each with a planted fault: what the FIFO counts, and the control
//! of both machines.

use std::path::Path;
use std::process::Command;

const TASKS: [&str; 6] = [
    "fifo.counts",
    "fifo.faulty_counts",
    "paper_machine.rays",
    "paper_machine.faulty_overbooked",
    "exact_machine.rays",
    "exact_machine.faulty_lent",
];

#[test]
fn the_fifo_and_both_machines_are_proven_and_their_faults_found() {
    let check = Path::new(env!("CARGO_MANIFEST_DIR")).join("../formal/check");
    let output = Command::new(check).args(TASKS).output().unwrap();
    let out = String::from_utf8_lossy(&output.stdout);
    let err = String::from_utf8_lossy(&output.stderr);
    let strict = std::env::var("CI").is_ok_and(|value| value == "true");
    if output.status.code() == Some(2) && !strict && err.contains("was not found") {
        println!("{err}: this check is left out");
        return;
    }
    assert!(output.status.success(), "{out}\n{err}");
    assert_eq!(out.lines().count(), TASKS.len(), "{out}");
}
