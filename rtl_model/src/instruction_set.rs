//! Which instructions a loop over many values is compiled for.
//!
//! Such a loop is written once, in plain Rust without a branch inside, so that the compiler turns it
//! into vector instructions. [`InstructionSet::Plain`] runs it as the rest of the program is
//! compiled, for any machine of its kind; [`InstructionSet::Avx2`] and [`InstructionSet::Detected`] run a copy
//! that was compiled for AVX2, or for AVX-512 too, where the program finds at run time that the machine has
//! it. All give the same bits: the arithmetic is IEEE 754's in either, and Rust never fuses a product and a sum.

use pulp::{Arch, Simd, WithSimd};
use std::fmt;

/// The instructions to use.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum InstructionSet {
    /// Those that every machine has which this program runs on.
    Plain,
    /// AVX2, also where the machine has AVX-512; plain ones where it has neither.
    Avx2,
    /// The best of those this machine has, as found at run time.
    #[default]
    Detected,
}

impl InstructionSet {
    /// All, the plain one first.
    pub const ALL: [InstructionSet; 3] = [
        InstructionSet::Plain,
        InstructionSet::Avx2,
        InstructionSet::Detected,
    ];

    /// Does the work, compiled for these instructions.
    #[inline]
    pub(crate) fn run<W: Work>(self, work: W) -> W::Output {
        match self {
            InstructionSet::Plain => work.run(),
            InstructionSet::Avx2 => {
                #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
                if let Some(avx2) = pulp::x86::V3::try_new() {
                    return Simd::vectorize(avx2, Dispatched(work));
                }
                work.run()
            }
            InstructionSet::Detected => Arch::new().dispatch(Dispatched(work)),
        }
    }
}

impl fmt::Display for InstructionSet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            InstructionSet::Plain => f.write_str("plain"),
            InstructionSet::Avx2 => {
                #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
                if pulp::x86::V3::try_new().is_some() {
                    return f.write_str("AVX2");
                }
                f.write_str("plain")
            }
            InstructionSet::Detected => match Arch::new() {
                Arch::Scalar => f.write_str("plain"),
                #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
                Arch::V3(_) => f.write_str("AVX2"),
                #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
                Arch::V4(_) => f.write_str("AVX-512"),
                #[allow(unreachable_patterns)]
                other => write!(f, "{other:?}"),
            },
        }
    }
}

/// Work to be compiled for several instruction sets. Its `run`, and all that is called from it, must
/// be `#[inline(always)]`: a function of its own is compiled for the plain set only.
pub(crate) trait Work {
    /// What it gives.
    type Output;
    /// Does it.
    fn run(self) -> Self::Output;
}

struct Dispatched<W>(W);

impl<W: Work> WithSimd for Dispatched<W> {
    type Output = W::Output;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> W::Output {
        self.0.run()
    }
}
