//! All trackers, ready for clips.

use super::face_model::{FaceModel, Kind};
use super::follow::{self, Clip};
use super::settings::{Method, Settings};
use super::training::Trained;
use crate::product;
use crate::store::sum;
use crate::tracked::Frame;
use crate::video;
use anyhow::{Context, Result};
use image::GrayImage;
use posewise_cli::model_file::ModelFile;
use serde_json::{Value, json};
use std::path::Path;

/// What clips are followed with.
pub struct Trackers {
    settings: Settings,
    product: ModelFile,
    model: Option<FaceModel>,
    /// Checksums of the product's model and of the head.
    sums: [String; 2],
    trained: Option<Trained>,
}

impl Trackers {
    /// Reads the models; the head only where a comparator needs it.
    pub fn new(settings: &Settings, methods: &[Method]) -> Result<Trackers> {
        let needs_head = methods.iter().any(|m| *m != Method::Posewise);
        let product = product::read(&settings.product)?;
        let trained = match methods.iter().any(|m| m.is_trained()) {
            true => {
                let model = product.model()?;
                let (training, facekit) = (&settings.training, &settings.facekit);
                Some(Trained::new(training, facekit, model.align(), methods)?)
            }
            false => None,
        };
        let read = || match settings.face_model {
            Kind::Morphable => FaceModel::morphable(&settings.facekit),
            Kind::Candide => FaceModel::candide(&settings.candide, &settings.facekit),
        };
        Ok(Trackers {
            model: needs_head.then(read).transpose()?,
            sums: [
                sum(product.bytes()),
                match needs_head {
                    true => sum_of(&settings.facekit)?,
                    false => String::new(),
                },
            ],
            trained,
            product,
            settings: settings.clone(),
        })
    }

    /// What the result of a method on a clip depends on.
    pub fn key(&self, method: Method, input: &Path, focal: Option<f32>) -> Result<Value> {
        let mut key = json!({
            "version": env!("CARGO_PKG_VERSION"),
            "method": method.name(),
            "clip": sum_of(input)?,
            "focal": focal,
            "frames": self.settings.frames,
            "model": self.sums[0],
        });
        if method != Method::Posewise {
            key["head"] = json!(self.sums[1]);
            if self.settings.face_model == Kind::Candide {
                key["candide"] = json!(sum_of(&self.settings.candide)?);
            }
            key["weight"] = json!(method.weight());
            key["settings"] = serde_json::to_value(&self.settings)?;
            let trained = self.trained.as_ref();
            key["learned"] = json!(trained.map_or(Vec::new(), |t| t.sums(method)));
        }
        Ok(key)
    }

    /// Follows a clip.
    pub fn follow(&self, method: Method, input: &Path, focal: Option<f32>) -> Result<Vec<Frame>> {
        self.follow_frames(method, video::frames(input)?, focal)
            .with_context(|| format!("{} on {}", method.name(), input.display()))
    }

    /// Follows frames.
    pub fn follow_frames(
        &self,
        method: Method,
        frames: impl Iterator<Item = Result<GrayImage>>,
        focal: Option<f32>,
    ) -> Result<Vec<Frame>> {
        let frames = frames.take(self.settings.frames.unwrap_or(usize::MAX));
        let product = self.product.model()?;
        match &self.model {
            Some(model) if method != Method::Posewise => {
                let clip = Clip {
                    method,
                    settings: &self.settings,
                    product: &product,
                    trained: self.trained.as_ref(),
                    focal,
                };
                follow::comparator(&clip, model, frames)
            }
            _ => follow::product(&product, focal, frames),
        }
    }

    /// The product's model.
    pub fn product(&self) -> &ModelFile {
        &self.product
    }
}

fn sum_of(path: &Path) -> Result<String> {
    let bytes = std::fs::read(path).with_context(|| path.display().to_string())?;
    Ok(sum(&bytes))
}
