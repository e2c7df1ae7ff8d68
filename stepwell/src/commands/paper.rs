//! `stepwell paper`: the papers' tables beside ours.

mod elements;
mod offset;
mod report;
mod subject;
mod table;

use std::path::PathBuf;

use clap::{Args, Subcommand};

use rtl_model::published::Table;
use rtl_model::scene::{FrameSize, Method};

use super::Outcome;
use crate::options::{AnswerOptions, NumberFormat, Size, ThreadOptions};

/// The papers' tables beside ours
///
/// Walks the real height maps with the calibrated cameras. The maps are not part of this
/// repository: they are found in the folder that --maps or the environment variable STEPWELL_MAPS
/// names, or in ../shared/heightmaps.
#[derive(Args, Debug)]
#[command(
    arg_required_else_help = true,
    subcommand_value_name = "TABLE",
    subcommand_help_heading = "Tables",
    after_help = "Examples: stepwell paper table4 --screen 1024x768\n          \
                  stepwell paper table2 --method oh -o out/table2"
)]
pub struct Arguments {
    #[command(subcommand)]
    table: PaperTable,
}

#[derive(Debug, Subcommand)]
enum PaperTable {
    /// Float elements of the traverse unit (2013 hardware paper, table 1)
    ///
    /// Counted in the recorded datapath of the machine of 15 stages, beside the paper's figures.
    Table1(elements::ElementArguments),
    /// Node crossings among the steps, in percent (2013 hardware paper, table 2)
    ///
    /// Every hit is judged by the exact reference. Exit code 1 says that a method that promises the
    /// right texel has a wrong one, or that ours are further from the paper than 3 % in a method's
    /// mean or 10 % in a cell; doubtful cells are shown and do not count.
    Table2(TableArguments),
    /// Mean steps on Rocks, one to four levels down at once (the same, table 3)
    ///
    /// As table2.
    Table3(TableArguments),
    /// Mean steps of every method (the same, table 4)
    ///
    /// As table2.
    Table4(TableArguments),
    /// What crossing a border by a small offset costs: wrong texels and hangs
    ///
    /// The published way to cross a border moves the position a little beyond it and finds the node
    /// anew. Every hit is judged by the exact reference, in several formats, offsets and map sizes,
    /// beside the index that is carried along. Exit code 1 says that the index has a late hit, a
    /// hang, or a wrong texel in f64 or exact numbers; of an offset nothing is asked.
    Offset(offset::OffsetArguments),
}

/// Of a table of the 2013 hardware paper.
#[derive(Args, Debug)]
pub struct TableArguments {
    /// Pixels of each frame; the paper's are 1024x768
    #[arg(long, value_name = "WIDTHxHEIGHT", default_value = "1024x768")]
    screen: Size,

    /// Number format: f64 as in the paper's counts, exact, or a float such as e7f16
    #[arg(long, value_name = "FORMAT", default_value = "f64")]
    format: NumberFormat,

    /// Only these methods, such as oh: repeat the option, or put commas between. Table 4 also takes
    /// methods that the paper does not have
    #[arg(long, value_name = "METHOD", value_delimiter = ',')]
    method: Vec<Method>,

    #[command(flatten)]
    maps: MapsOption,

    /// Folder for the table as TABLE.csv, TABLE.json and TABLE.png (ours over the paper's), made if
    /// missing
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,

    #[command(flatten)]
    threads: ThreadOptions,

    #[command(flatten)]
    answer: AnswerOptions,
}

/// Where the real height maps are.
#[derive(Args, Clone, Debug)]
pub struct MapsOption {
    /// Folder of the seven real height maps
    #[arg(long, value_name = "DIR")]
    maps: Option<PathBuf>,
}

impl TableArguments {
    fn screen(&self) -> FrameSize {
        self.screen.0
    }
}

/// Shows the table.
pub fn run(arguments: Arguments) -> anyhow::Result<Outcome> {
    match arguments.table {
        PaperTable::Table1(arguments) => elements::run(&arguments),
        PaperTable::Table2(arguments) => table::run(Table::CrossingProbability, arguments),
        PaperTable::Table3(arguments) => table::run(Table::LevelsDown, arguments),
        PaperTable::Table4(arguments) => table::run(Table::StepsPerPixel, arguments),
        PaperTable::Offset(arguments) => offset::run(arguments),
    }
}
