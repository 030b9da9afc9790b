//! AdamW (Loshchilov and Hutter 2019) with averaged parameters, and its checkpoints.

use super::options::Options;
use crate::checkpoint;
use anyhow::Result;
use std::path::Path;

/// Adam's decays of the means of gradients and of their squares.
const DECAYS: [f32; 2] = [0.9, 0.999];
/// Decay of the averaged parameters; less at the begin.
const AVERAGE: f32 = 0.998;
/// Smallest rate, as a share of the largest.
const LEAST_RATE: f32 = 0.01;

/// The state of a training run, which a checkpoint stores.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// Batches so far.
    pub step: usize,
    pub parameters: Vec<f32>,
    first: Vec<f32>,
    second: Vec<f32>,
    /// Averaged over steps: what ships.
    pub average: Vec<f32>,
}

impl State {
    /// Before the first step.
    pub fn new(parameters: Vec<f32>) -> State {
        let zeros = vec![0.0; parameters.len()];
        State {
            step: 0,
            average: parameters.clone(),
            parameters,
            first: zeros.clone(),
            second: zeros,
        }
    }

    /// Reads a checkpoint; `None` when there is none or it has another number of parameters.
    pub fn read(path: &Path, parameters: usize) -> Option<State> {
        let (step, [parameters, first, second, average]) = checkpoint::read(path, parameters)?;
        Some(State {
            step,
            parameters,
            first,
            second,
            average,
        })
    }

    /// Writes a checkpoint.
    pub fn write(&self, path: &Path) -> Result<()> {
        let arrays = [
            &self.parameters[..],
            &self.first,
            &self.second,
            &self.average,
        ];
        checkpoint::write(path, self.step, &arrays)
    }

    /// One step down the gradient.
    pub fn descend(&mut self, gradient: &[f32], options: &Options) {
        let done = self.step as f32 / options.steps as f32;
        self.step += 1;
        let rise = (self.step as f32 / options.warm_up as f32).min(1.0);
        let cosine = 0.5 * (1.0 + (std::f32::consts::PI * done).cos());
        let rate = options.rate * rise * (LEAST_RATE + (1.0 - LEAST_RATE) * cosine);
        let corrections = DECAYS.map(|d| 1.0 - d.powi(self.step as i32));
        let kept = AVERAGE.min(self.step as f32 / (self.step as f32 + 10.0));
        let [b1, b2] = DECAYS;
        let [c1, c2] = corrections;
        let moments = self.first.iter_mut().zip(&mut self.second);
        let parameters = self.parameters.iter_mut().zip(&mut self.average);
        for (((p, average), g), (m, v)) in parameters.zip(gradient).zip(moments) {
            *m = b1 * *m + (1.0 - b1) * g;
            *v = b2 * *v + (1.0 - b2) * g * g;
            *p -= rate * (*m / c1 / ((*v / c2).sqrt() + 1e-8) + options.decay * *p);
            *average = kept * *average + (1.0 - kept) * *p;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_checkpoint_goes_on_where_it_was_written() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("state.checkpoint");
        let options = Options::default();
        let mut state = State::new(vec![1.0, -2.0]);
        state.descend(&[0.5, 0.25], &options);
        state.write(&path).unwrap();
        let mut read = State::read(&path, 2).unwrap();
        assert_eq!(read, state);
        assert!(State::read(&path, 3).is_none());
        state.descend(&[0.5, 0.25], &options);
        read.descend(&[0.5, 0.25], &options);
        assert_eq!(read, state);
        assert!(state.parameters[0] < 1.0);
    }
}
