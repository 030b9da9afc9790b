//! Networks of a few random layers: each kernel of this machine gives the maps of the scalar one,
//! byte by byte. So whole layers with their edges are compared, beside the strips of the kernels'
//! own tests.

use super::input::{Input, scramble};
use posewise::image::{Crop, Frame, FrameLayout, warp};
use posewise::math::Similarity;
use posewise::network::{
    ARENA, Activations, KernelName, MAX_CHANNELS, MAX_NODES, Network, OP_ADD, OP_CONV,
    OP_DEPTHWISE, OP_INPUT, OP_LATERAL, OP_LINEAR, chosen_kernel, select_kernel,
};
use posewise_format::{AlignedBytes, Blob, SectionWriter, blob};

/// Channels of a block.
const BLOCK: usize = 8;
/// Largest number of inputs of one output, and of weights of a node: what a model may have.
const MAX_COLUMNS: usize = 9 * 64;
const MAX_WEIGHTS: usize = 80 * 80;
const TAG: [u8; 4] = *b"TEST";

/// Place, side and channels of a node's output.
#[derive(Clone, Copy)]
struct Map {
    at: usize,
    side: usize,
    channels: usize,
}

impl Map {
    fn bytes(&self) -> usize {
        self.side * self.side * self.channels
    }
}

/// A network that is being written.
struct Nodes {
    written: SectionWriter,
    maps: Vec<Map>,
    /// Memory that is taken.
    taken: usize,
    seed: u32,
    /// Whether all numbers are the least and the largest of their kinds.
    extreme: bool,
}

impl Nodes {
    /// A number in `least..=most`.
    fn within(&mut self, least: i32, most: i32) -> i32 {
        let bytes = [(); 4].map(|()| scramble(&mut self.seed));
        let random = u32::from_le_bytes(bytes);
        match (self.extreme, random & 1) {
            (true, 0) => least,
            (true, _) => most,
            (false, _) => least.wrapping_add_unsigned(random % (most.abs_diff(least) + 1)),
        }
    }

    /// A place for a new map, if the memory has one.
    fn place(&mut self, side: usize, channels: usize) -> Option<Map> {
        let map = Map {
            at: self.taken,
            side,
            channels,
        };
        let fits = self.taken + map.bytes() <= ARENA;
        self.taken += if fits { map.bytes() } else { 0 };
        fits.then_some(map)
    }

    /// Appends a node with random numbers.
    fn push(
        &mut self,
        op: u8,
        [kernel, stride]: [usize; 2],
        inputs: [usize; 2],
        map: Map,
        weights: usize,
    ) {
        let zero_point = self.within(0, 255);
        let shifts = match self.extreme {
            true => [self.within(0, 24), self.within(1, 30)],
            // Such that most sums are neither 0 nor 255 afterwards.
            false => [self.within(3, 8), self.within(10, 18)],
        };
        let sizes = [
            op as usize,
            kernel,
            stride,
            inputs[0],
            inputs[1],
            map.channels,
            map.at,
        ];
        for number in sizes
            .into_iter()
            .chain([zero_point, shifts[0], shifts[1]].map(|n| n as usize))
        {
            self.written.scalar(number as u32);
        }
        let weights: Vec<i8> = (0..weights).map(|_| self.within(-127, 127) as i8).collect();
        let constants = match op {
            OP_INPUT => 0,
            OP_ADD => 2,
            _ => map.channels,
        };
        let bias = if self.extreme { (1 << 28) - 1 } else { 1 << 12 };
        let bias: Vec<i32> = (0..constants).map(|_| self.within(-bias, bias)).collect();
        let limit = (1 << 15) - 1;
        let multiplier: Vec<i32> = (0..constants).map(|_| self.within(-limit, limit)).collect();
        self.written.array(&weights).array(&bias).array(&multiplier);
        self.maps.push(map);
    }

    /// Appends the node that the input describes, if its sizes fit.
    fn push_next(&mut self, input: &mut Input<'_>) -> Option<()> {
        let [op, size, from, channels] = input.bytes();
        let from = from as usize % self.maps.len();
        let source = self.maps[from];
        let channels = BLOCK * (1 + channels as usize % (MAX_CHANNELS / BLOCK));
        let (kernel, stride) = ([1, 3, 5][size as usize % 3], 1 + size as usize / 3 % 2);
        let columns = |kernel: usize| (kernel * kernel * source.channels).next_multiple_of(2);
        match op % 5 {
            0 => {
                let weights = columns(kernel) * channels;
                if columns(kernel) > MAX_COLUMNS || weights > MAX_WEIGHTS {
                    return None;
                }
                let map = self.place(source.side.div_ceil(stride), channels)?;
                self.push(OP_CONV, [kernel, stride], [from, 0], map, weights);
            }
            1 if source.channels.is_multiple_of(BLOCK) => {
                let map = self.place(source.side.div_ceil(stride), source.channels)?;
                self.push(
                    OP_DEPTHWISE,
                    [3, stride],
                    [from, 0],
                    map,
                    9 * source.channels,
                );
            }
            2 => {
                let alike = |map: &Map| {
                    map.at != source.at
                        && (map.side, map.channels) == (source.side, source.channels)
                };
                let other = self.maps.iter().position(alike)?;
                self.push(OP_ADD, [1, 1], [from, other], source, 0);
            }
            op => {
                let half = |map: &Map| 2 * map.side == source.side;
                let lateral = self.maps.iter().position(half).filter(|_| op == 3);
                let channels = match lateral {
                    Some(other) => self.maps[other].channels,
                    None => channels,
                };
                let weights = columns(1) * channels;
                if !channels.is_multiple_of(BLOCK) || weights > MAX_WEIGHTS {
                    return None;
                }
                let map = self.place(source.side, channels)?;
                let op = if lateral.is_some() {
                    OP_LATERAL
                } else {
                    OP_LINEAR
                };
                self.push(op, [1, 1], [from, lateral.unwrap_or(0)], map, weights);
            }
        }
        Some(())
    }
}

/// Compares all kernels on the network that the input describes.
pub fn run(data: &[u8]) {
    compared(data);
}

/// As [`run`]; the number of layers, or `None` if the input describes none.
pub fn compared(data: &[u8]) -> Option<usize> {
    let input = &mut Input::new(data);
    let [flags, side] = input.bytes();
    let side = 16 + side as usize % 65;
    let mut nodes = Nodes {
        written: SectionWriter::new(TAG),
        maps: Vec::new(),
        taken: 0,
        seed: input.u32(),
        extreme: flags & 1 != 0,
    };
    // Their number, which is known at the end.
    nodes.written.scalar(0u32);
    let map = nodes.place(side, 1)?;
    nodes.push(OP_INPUT, [1, 1], [0, 0], map, 0);
    while !input.is_empty() && nodes.maps.len() < MAX_NODES {
        // What does not fit is left out.
        let _ = nodes.push_next(input);
    }
    if nodes.maps.len() < 2 {
        return None;
    }
    let mut section = nodes.written.bytes().to_vec();
    section[..4].copy_from_slice(&(nodes.maps.len() as u32).to_le_bytes());
    let file = AlignedBytes::new(&blob(&[SectionWriter::of_bytes(TAG, section)]));
    let model = Blob::open(&file).expect("a whole file");
    let network = Network::open(&mut model.section(&TAG).expect("it is there"), side);
    let network = network.expect("the sizes fit");

    let luma: Vec<u8> = (0..side * side)
        .map(|_| nodes.within(0, 255) as u8)
        .collect();
    let layout = FrameLayout::grey(side as u32, side as u32);
    let frame = Frame::new(&layout, &luma).expect("a frame");
    let mut crop = Box::new(Crop::new());
    warp(&frame, &Similarity::IDENTITY, side, &mut crop);
    crop.standardise();
    let before = chosen_kernel();
    let maps = |kernel: KernelName| {
        assert!(select_kernel(kernel));
        let mut work = Box::new(Activations::new());
        network.run(&crop, &mut work);
        work.scratch()[..nodes.taken.min(ARENA)].to_vec()
    };
    let expected = maps(KernelName::Scalar);
    for kernel in KernelName::ALL.into_iter().filter(|k| k.is_available()) {
        assert!(maps(kernel) == expected, "{kernel:?} differs");
    }
    select_kernel(before);
    Some(nodes.maps.len() - 1)
}
