//! A slice of the campaign of machines, in the embedded simulator; what is planted is seen.

use std::path::Path;

use campaigns::machine_table::{MACHINES_TABLE, machines_lines};
use campaigns::machines::{
    Hardware, MachineCampaign, MachineChoice, MachineFrame, wrong_texels_are_few,
};
use campaigns::record::Provenance;
use campaigns::tier::Tier;
use rtl_model::scene::FrameSize;

const SCREEN: FrameSize = FrameSize {
    width: 16,
    height: 12,
};

fn frames() -> Vec<MachineFrame> {
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let wanted = |map: &str, camera: &str| map == "rocks" && camera != "front";
    MachineFrame::load(&workspace, SCREEN, wanted).expect("maps")
}

#[test]
fn machines_agree_on_a_few_rays() {
    let campaign = MachineCampaign {
        hardware: Hardware::Embedded,
        planted: None,
    };
    for machine in MachineChoice::ALL {
        let mut rows = Vec::new();
        for frame in &frames() {
            for stalls in [false, true] {
                let row = campaign.run(machine, frame, stalls).expect("a run");
                assert!(row.agreed, "{}\n{:?}", row.line(), row.first);
                assert!(row.signals > 100 && row.cycles_compared > row.rays && row.rays > 0);
                rows.push(row);
            }
        }
        assert!(wrong_texels_are_few(&rows));
        rows[0].wrong_texels = 2 + rows.iter().map(|row| row.rays).sum::<u64>() / 1000;
        assert!(!wrong_texels_are_few(&rows));
        let provenance = Provenance {
            tier: Tier::Quick,
            date: "2026-01-01".to_owned(),
            version: "0".to_owned(),
        };
        let line = machines_lines(&rows, SCREEN, &provenance);
        assert_eq!(line.len(), MACHINES_TABLE.columns.len());
        assert_eq!((line[0].as_str(), line[3].as_str()), (machine.name(), "4"));
    }
}

#[test]
fn a_planted_fault_is_seen() {
    let frames = frames();
    for (machine, signal) in [
        (MachineChoice::Paper, "hit_i_o"),
        (MachineChoice::ExactQuad, "hit_i_o"),
        (MachineChoice::ExactBlock, "admits"),
    ] {
        let campaign = MachineCampaign {
            hardware: Hardware::Embedded,
            planted: Some((signal.to_owned(), 0)),
        };
        let row = campaign.run(machine, &frames[0], false).expect("a run");
        assert!(!row.agreed && row.mismatches > 0, "{}", row.line());
        assert!(!row.first.is_empty());
    }
}
