//! Faults planted in a waveform, and what the comparison says of them.

mod damage;
mod divergence;
mod extent;
mod pipeline;
