//! A network's head: a linear function of features, whose outputs move the points.

/// `out = expand·(project·features + bias) + outer`: a linear function of low rank.
#[derive(Clone, Debug)]
pub struct Head {
    /// Features read.
    pub inputs: usize,
    /// Rank: dimensions between the two matrices.
    pub rank: usize,
    /// Coordinates written: two per point.
    pub outputs: usize,
    /// What it reads: `GLOBAL`, `SHAPE_INDEXED` or both.
    pub reads: u32,
    /// Its parameters start here: `project[rank][inputs]`, `bias[rank]`,
    /// `expand[outputs][rank]`, `outer[outputs]`.
    pub at: usize,
}

impl Head {
    /// Number of its parameters.
    pub fn size(&self) -> usize {
        self.rank * (self.inputs + 1) + self.outputs * (self.rank + 1)
    }

    /// This head's parameters: `project`, `bias`, `expand`, `outer`.
    pub fn split<'a>(&self, parameters: &'a [f32]) -> [&'a [f32]; 4] {
        let (project, rest) = parameters[self.at..].split_at(self.rank * self.inputs);
        let (bias, rest) = rest.split_at(self.rank);
        let (expand, rest) = rest.split_at(self.outputs * self.rank);
        [project, bias, expand, &rest[..self.outputs]]
    }

    /// The same, to be changed.
    pub fn split_mut<'a>(&self, parameters: &'a mut [f32]) -> [&'a mut [f32]; 4] {
        let own = &mut parameters[self.at..self.at + self.size()];
        let (project, rest) = own.split_at_mut(self.rank * self.inputs);
        let (bias, rest) = rest.split_at_mut(self.rank);
        let (expand, outer) = rest.split_at_mut(self.outputs * self.rank);
        [project, bias, expand, outer]
    }

    /// Computes the outputs, and the values between the two matrices into `inner`.
    pub fn forward(&self, parameters: &[f32], features: &[f32], inner: &mut [f32]) -> Vec<f32> {
        let [project, bias, expand, outer] = self.split(parameters);
        for ((i, row), b) in inner
            .iter_mut()
            .zip(project.chunks_exact(self.inputs))
            .zip(bias)
        {
            *i = dot(row, features) + b;
        }
        let rows = expand.chunks_exact(self.rank).zip(outer);
        rows.map(|(row, o)| dot(row, inner) + o).collect()
    }

    /// Adds the gradients by this head's parameters to `gradient`; sets those by the features.
    pub fn backward(
        &self,
        parameters: &[f32],
        features: &[f32],
        inner: &[f32],
        by_outputs: &[f32],
        gradient: &mut [f32],
        by_features: &mut [f32],
    ) {
        let [project, _, expand, _] = self.split(parameters);
        let [by_project, by_bias, by_expand, by_outer] = self.split_mut(gradient);
        let mut by_inner = vec![0.0; self.rank];
        for (((by, w), g), o) in by_outputs
            .iter()
            .zip(expand.chunks_exact(self.rank))
            .zip(by_expand.chunks_exact_mut(self.rank))
            .zip(by_outer)
        {
            *o += by;
            add_scaled(g, inner, *by);
            add_scaled(&mut by_inner, w, *by);
        }
        by_features.fill(0.0);
        for (((by, w), g), b) in by_inner
            .iter()
            .zip(project.chunks_exact(self.inputs))
            .zip(by_project.chunks_exact_mut(self.inputs))
            .zip(by_bias)
        {
            *b += by;
            add_scaled(g, features, *by);
            add_scaled(by_features, w, *by);
        }
    }
}

fn dot(a: &[f32], b: &[f32]) -> f32 {
    // Eight sums side by side, so that the compiler may use vectors.
    let mut sums = [0.0f32; 8];
    let (a8, b8) = (a.as_chunks::<8>(), b.as_chunks::<8>());
    for (x, y) in a8.0.iter().zip(b8.0) {
        for k in 0..8 {
            sums[k] += x[k] * y[k];
        }
    }
    let rest: f32 = a8.1.iter().zip(b8.1).map(|(x, y)| x * y).sum();
    sums.iter().sum::<f32>() + rest
}

/// to += by · from.
pub fn add_scaled(to: &mut [f32], from: &[f32], by: f32) {
    to.iter_mut().zip(from).for_each(|(t, f)| *t += by * f);
}
