//! Memory of a run.

use super::kernel::Staging;
use super::plan::{ARENA, Map};

/// Working memory of one run.
#[derive(Clone)]
pub struct Activations {
    /// The maps; each node's output has its place ([`Map`]).
    pub(super) arena: [u8; ARENA],
    /// Operands of the kernels: input values of a strip, or weights of depthwise channels.
    pub(super) staging: Staging,
}

impl Default for Activations {
    fn default() -> Self {
        Self::new()
    }
}

impl Activations {
    /// Zeroed memory.
    pub const fn new() -> Self {
        Activations {
            arena: [0; ARENA],
            staging: Staging::new(),
        }
    }

    /// The memory of the maps, [`ARENA`] bytes, for other use between two runs.
    pub fn scratch(&mut self) -> &mut [u8] {
        &mut self.arena
    }

    /// A map's values, `[side][side][channels]`; empty when the map is not one of the network's.
    pub fn values(&self, map: &Map) -> &[u8] {
        self.arena.get(map.range()).unwrap_or(&[])
    }
}
