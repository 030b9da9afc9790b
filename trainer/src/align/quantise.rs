//! From floats to the integers of section `ALGN`.

use super::basis::Basis;
use super::ridge::FEATURE_UNIT;
use super::starts::StartShapes;
use crate::pack::SectionWriter;
use faer::Mat;
use posewise::align::AlignModel;
use posewise::descriptor::VALUES;

/// Standard deviation that projected features are scaled to.
const FEATURE_DEVIATION: f32 = 32.0;

/// The integers of a `Projection`.
#[derive(Clone)]
pub struct ProjectionWeights {
    pub weight: Vec<i8>,
    pub bias: Vec<i32>,
    pub gain: Vec<i32>,
}

impl ProjectionWeights {
    /// Principal components of descriptors: the leading `features`, each scaled to the same
    /// deviation.
    pub fn principal(values: &[[u8; VALUES]], features: usize) -> ProjectionWeights {
        let n = values.len() as f64;
        let mean: Vec<f64> = (0..VALUES)
            .map(|i| values.iter().map(|v| v[i] as f64).sum::<f64>() / n)
            .collect();
        let mut covariance = Mat::<f64>::zeros(VALUES, VALUES);
        for v in values {
            let d: Vec<f64> = v.iter().zip(&mean).map(|(v, m)| *v as f64 - m).collect();
            for i in 0..VALUES {
                for j in 0..VALUES {
                    covariance[(i, j)] += d[i] * d[j] / n;
                }
            }
        }
        let eigen = covariance
            .self_adjoint_eigen(faer::Side::Lower)
            .expect("finite covariance");
        let mut out = ProjectionWeights {
            weight: vec![],
            bias: vec![],
            gain: vec![],
        };
        for k in (VALUES - features..VALUES).rev() {
            let row: Vec<f32> = (0..VALUES).map(|i| eigen.U()[(i, k)] as f32).collect();
            out.push(&row, &mean, (eigen.S()[k].max(1e-6).sqrt()) as f32);
        }
        out
    }

    /// Adds a feature: weights for descriptor values, the values' mean, the output's deviation.
    fn push(&mut self, row: &[f32], mean: &[f64], deviation: f32) {
        let largest = row.iter().fold(1e-9f32, |m, w| m.max(w.abs()));
        let scale = 127.0 / largest;
        let start = self.weight.len();
        self.weight
            .extend(row.iter().map(|w| (w * scale).round() as i8));
        let at_mean: f64 = self.weight[start..]
            .iter()
            .zip(mean)
            .map(|(w, m)| *w as f64 * m)
            .sum();
        self.bias.push(-at_mean.round() as i32);
        self.gain
            .push((FEATURE_DEVIATION / (deviation * scale) * (1 << 24) as f32) as i32);
    }

    /// What the core computes.
    pub fn project(&self, values: &[u8; VALUES], out: &mut [i8]) {
        let rows = self
            .weight
            .chunks_exact(VALUES)
            .zip(&self.bias)
            .zip(&self.gain);
        for (((weight, bias), gain), out) in rows.zip(out) {
            let sum: i32 = weight
                .iter()
                .zip(values)
                .map(|(w, v)| *w as i32 * *v as i32)
                .sum();
            *out = (((sum + bias) as i64 * *gain as i64) >> 24).clamp(-127, 127) as i8;
        }
    }

    pub fn features(&self) -> usize {
        self.bias.len()
    }

    pub fn write(&self, out: &mut SectionWriter) {
        out.scalar(self.features() as u32);
        out.array(&self.weight).array(&self.bias).array(&self.gain);
    }
}

/// The integers of a `Regressor`.
pub struct RegressorWeights {
    pub weight: Vec<i8>,
    pub scale: Vec<f32>,
    pub bias: Vec<f32>,
}

impl RegressorWeights {
    /// Quantises ridge weights: one scale per output.
    pub fn quantise(weights: &Mat<f32>) -> RegressorWeights {
        let inputs = weights.nrows() - 1;
        let mut out = RegressorWeights {
            weight: vec![],
            scale: vec![],
            bias: vec![],
        };
        for o in 0..weights.ncols() {
            let column: Vec<f32> = (0..inputs).map(|i| weights[(i, o)]).collect();
            let largest = column.iter().fold(1e-9f32, |m, w| m.max(w.abs()));
            let scale = largest / 127.0;
            out.weight
                .extend(column.iter().map(|w| (w / scale).round() as i8));
            out.scale.push(scale / FEATURE_UNIT);
            out.bias.push(weights[(inputs, o)]);
        }
        out
    }

    pub fn write(&self, out: &mut SectionWriter) {
        out.array(&self.weight).array(&self.scale).array(&self.bias);
    }
}

/// A finished stage.
pub struct StageWeights {
    pub options: super::StageOptions,
    pub projection: ProjectionWeights,
    /// By view.
    pub regressors: Vec<RegressorWeights>,
}

/// Section `ALGN`, as [`AlignModel::open`] reads it.
pub fn section(
    basis: &Basis,
    starts: &StartShapes,
    stages: &[StageWeights],
    track_from: usize,
) -> SectionWriter {
    let mut out = SectionWriter::new(AlignModel::TAG);
    out.scalar(basis.rows.len() as u32)
        .scalar(starts.turns.len() as u32);
    out.scalar(stages.len() as u32).scalar(track_from as u32);
    out.array(&super::basis::flat(&basis.mean));
    out.array(
        &starts
            .shapes
            .iter()
            .flat_map(super::basis::flat)
            .collect::<Vec<_>>(),
    );
    out.array(&starts.turns);
    let scales: Vec<f32> = basis
        .rows
        .iter()
        .map(|row| row.iter().fold(1e-9f32, |m, v| m.max(v.abs())) / 127.0)
        .collect();
    let rows = basis.rows.iter().zip(&scales);
    let quantised = rows.flat_map(|(r, s)| r.iter().map(move |v| (v / s).round() as i8));
    out.array(&quantised.collect::<Vec<_>>());
    out.array(&scales);
    for stage in stages {
        let o = &stage.options;
        out.scalar(o.side as u32).scalar(o.zoom);
        out.scalar(o.spacing as u32).scalar(o.radius as u32);
        stage.projection.write(&mut out);
        stage.regressors.iter().for_each(|r| r.write(&mut out));
    }
    out
}
