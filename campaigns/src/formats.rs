//! The formats of IEEE 754 and of machine learning, by their names.

use rtl_model::float::FloatFormat;

/// binary16
pub const HALF: FloatFormat = FloatFormat::new(5, 10);
/// bfloat16
pub const BFLOAT16: FloatFormat = FloatFormat::new(8, 7);
/// binary32
pub const SINGLE: FloatFormat = FloatFormat::new(8, 23);
/// binary64
pub const DOUBLE: FloatFormat = FloatFormat::new(11, 52);
