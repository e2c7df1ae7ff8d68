//! What the float operators are held against: exact results in big integers, rounded by finding the
//! two representable neighbours; hard operands; and the comparer.
//!
//! Nothing here calls an operator of `rtl_model::float` except [`compare::implementation`], the
//! thing under test. Of the format, only the two widths are used.

#![allow(
    dead_code,
    reason = "each test program that includes this module uses a part of it"
)]

pub mod compare;
pub mod counter_examples;
pub mod exact;
pub mod neighbours;
pub mod operands;
