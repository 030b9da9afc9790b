//! All trackers, ready for clips.

use super::follow::{self, Clip, Frame};
use super::person::FaceModel;
use super::settings::{Method, Settings};
use crate::product::Product;
use crate::video::Video;
use anyhow::{Context, Result};
use std::path::Path;

/// What clips are followed with.
pub struct Trackers {
    settings: Settings,
    product: Product,
    model: Option<FaceModel>,
}

impl Trackers {
    /// Reads the models; the head only where a comparator needs it.
    pub fn new(settings: &Settings, methods: &[Method]) -> Result<Trackers> {
        let needs_head = methods.iter().any(|m| *m != Method::Posewise);
        let read = || FaceModel::read(&settings.facekit);
        Ok(Trackers {
            product: Product::new(&settings.product)?,
            model: needs_head.then(read).transpose()?,
            settings: settings.clone(),
        })
    }

    /// Follows a clip.
    pub fn follow(&self, method: Method, input: &Path, focal: Option<f32>) -> Result<Vec<Frame>> {
        let mut video = Video::open(input)?;
        let limit = self.settings.frames.unwrap_or(usize::MAX);
        match &self.model {
            Some(model) if method != Method::Posewise => {
                let clip = Clip {
                    method,
                    settings: &self.settings,
                    product: &self.product,
                    focal,
                    limit,
                };
                follow::comparator(&clip, model, &mut video)
            }
            _ => follow::product(&self.product, focal, limit, &mut video),
        }
        .with_context(|| format!("{} on {}", method.name(), input.display()))
    }
}
