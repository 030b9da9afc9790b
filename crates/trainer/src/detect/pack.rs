//! Writes section `DTCT`, in the order in which `posewise::detect::DetectorModel` reads it.

use posewise::detect::{Pixel, TAG};

use super::boost::Node;
use super::cascade::Cascade;
use super::options::SIDE_Q8;
use super::refine::Forest;
use posewise_format::SectionWriter;

/// Ratio of successive window sizes, 1/1.2, and step between windows, 0.12 of the size \[1/256\]:
/// the jitter of training covers half a step each way.
const RATIO_Q8: u32 = 213;
const STEP_Q8: u32 = 31;
/// Centres come within a sixth of the size to the edge: a third of a face may lie beyond it.
const MARGIN_Q8: u32 = 43;
/// 0 and ±30° \[1/65536 turn\].
const ROLLS: [i16; 3] = [0, 5461, -5461];

/// The section; `confirm` is the strength from which merged hits are a face.
pub fn section(cascade: &Cascade, refiner: &Forest, confirm: u32) -> SectionWriter {
    let mut w = SectionWriter::new(TAG);
    w.scalar(RATIO_Q8).scalar(STEP_Q8).scalar(SIDE_Q8 as u32);
    w.scalar(MARGIN_Q8).scalar(confirm);
    w.scalar(ROLLS.len() as u32).array(&ROLLS);
    w.scalar(1u32).scalar(0u32);
    let flat = cascade.flat();
    trees(&mut w, cascade.depth, cascade.trees.len(), &flat.nodes);
    w.array(&flat.leaves).array(&cascade.thresholds);
    let (nodes, leaves) = refiner.flat();
    w.scalar(refiner.rounds as u32);
    trees(&mut w, refiner.depth, refiner.trees.len(), &nodes);
    w.array(&leaves);
    w
}

/// Depth and number of trees, the pixels that their nodes compare, and by how much.
fn trees(w: &mut SectionWriter, depth: usize, count: usize, nodes: &[Node]) {
    let pixels: Vec<[Pixel; 2]> = nodes.iter().map(|[a, b, _]| [*a, *b]).collect();
    let margins: Vec<u8> = nodes.iter().map(|node| node[2] as u8).collect();
    w.scalar(depth as u32).scalar(count as u32);
    w.array(pixels.as_flattened()).array(&margins);
}
