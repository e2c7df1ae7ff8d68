//! A corpus of test vectors for anybody's float unit: operands, results and flags of every operator
//! in text files that users of Berkeley TestFloat can read, and a manifest.
//!
//! Results and flags are the golden arithmetic's ([`rtl_model::float`]). The corpus of `e7f16` is
//! committed in `vectors/fp24`, beside a program that recomputes every line of it without any of
//! this.

mod manifest;
mod operands;
mod write;

pub use manifest::{CorpusFile, CorpusManifest};
pub use write::{CorpusPlan, write_corpus};

/// The digest of a file of this text, as the manifest has it.
pub fn file_digest(text: &str) -> String {
    crate::vectors::sha256(text)
}
