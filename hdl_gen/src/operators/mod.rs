//! Float operators as netlists, written without a look at the golden arithmetic.
