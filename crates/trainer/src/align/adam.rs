//! AdamW (Loshchilov and Hutter 2019) and its checkpoints.

use super::options::Options;
use crate::checkpoint;
use anyhow::Result;
use std::path::Path;

/// The state of a training run, which a checkpoint stores.
pub struct State {
    /// Batches so far.
    pub step: usize,
    pub parameters: Vec<f32>,
    /// Adam's means of gradients and of their squares.
    first: Vec<f32>,
    second: Vec<f32>,
}

impl State {
    /// Before the first step.
    pub fn new(parameters: Vec<f32>) -> State {
        let zeros = vec![0.0; parameters.len()];
        State {
            step: 0,
            parameters,
            first: zeros.clone(),
            second: zeros,
        }
    }

    /// Reads a checkpoint; `None` when there is none or it has another number of parameters.
    pub fn read(path: &Path, parameters: usize) -> Option<State> {
        let (step, [parameters, first, second]) = checkpoint::read(path, parameters)?;
        Some(State {
            step,
            parameters,
            first,
            second,
        })
    }

    /// Writes a checkpoint.
    pub fn write(&self, path: &Path) -> Result<()> {
        let arrays = [&self.parameters[..], &self.first, &self.second];
        checkpoint::write(path, self.step, &arrays)
    }

    /// One step of AdamW down the gradient.
    pub fn descend(&mut self, gradient: &[f32], options: &Options) {
        let (b1, b2) = (0.9f32, 0.999f32);
        self.step += 1;
        let done = self.step as f32 / options.steps as f32;
        let rise = (self.step as f32 / options.warm_up as f32).min(1.0);
        let rate = options.rate * rise * 0.5 * (1.0 + (std::f32::consts::PI * done).cos());
        let (c1, c2) = (
            1.0 - b1.powi(self.step as i32),
            1.0 - b2.powi(self.step as i32),
        );
        let moments = self.first.iter_mut().zip(&mut self.second);
        for ((p, g), (m, v)) in self.parameters.iter_mut().zip(gradient).zip(moments) {
            *m = b1 * *m + (1.0 - b1) * g;
            *v = b2 * *v + (1.0 - b2) * g * g;
            *p -= rate * (*m / c1 / ((*v / c2).sqrt() + 1e-8) + options.decay * *p);
        }
    }
}
