//! The 3D faces that comparators fit: the morphable head, or Candide-3, which the thesis uses.

use super::state::UNITS;
use crate::rigid::rotation_onto;
use anyhow::Result;
use clap::ValueEnum;
use glam::Vec3;
use posewise::shape::LANDMARKS;
use posewise_metrics::landmarks::INNER;
use posewise_train::head::{Head, Wfm};
use posewise_train::render::mesh::Mesh;
use serde::Serialize;
use std::path::Path;

/// Identity modes that are fitted; as many as the thesis uses of Candide-3.
const MODES: usize = 12;

/// Which 3D face.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// The morphable head (`--facekit`).
    #[default]
    Morphable,
    /// Candide-3 (`--candide`): 113 vertices, 184 triangles.
    Candide,
}

impl Kind {
    /// What is serialised without it.
    pub fn is_morphable(&self) -> bool {
        *self == Kind::Morphable
    }
}

/// A head that can be drawn and moved.
pub struct FaceModel {
    /// What is drawn.
    pub mesh: Mesh,
    /// Of each mode, displacements of all vertices \[mm\].
    pub identity: Vec<Vec<Vec3>>,
    /// By unit, displacement of every vertex at weight 1 \[mm\].
    pub units: Vec<Vec<Vec3>>,
    /// From each landmark's vertex to the landmark \[mm\].
    offsets: Vec<Vec3>,
    /// Of each landmark, the nearest vertex of a triangle: where its normal is taken.
    pub surface: Vec<u32>,
}

impl FaceModel {
    /// The morphable head.
    pub fn morphable(path: &Path) -> Result<FaceModel> {
        let head = Head::load(path)?;
        let offsets = vectors(&head.conventional_offsets_mm());
        FaceModel::of(&head, offsets)
    }

    /// Candide-3. Its zero pose is set to that of the morphable head by the inner landmarks.
    pub fn candide(wfm: &Path, kit: &Path) -> Result<FaceModel> {
        let mut head = Head::of_wfm(&Wfm::read(wfm)?)?;
        let kit = Head::load(kit)?;
        let inner = |head: &Head, offsets: &[[f32; 3]]| -> Vec<Vec3> {
            let at = |i: usize| head.mean[head.landmarks[i] as usize];
            let all = INNER..LANDMARKS;
            all.map(|i| Vec3::from(at(i)) + Vec3::from(offsets[i]))
                .collect()
        };
        let none = [[0.0; 3]; LANDMARKS];
        let turn = rotation_onto(
            &inner(&head, &none),
            &inner(&kit, &kit.conventional_offsets_mm()),
        );
        let turned = |points: &mut Vec<[f32; 3]>| {
            let all = points.iter_mut();
            all.for_each(|p| *p = (turn * Vec3::from(*p)).to_array());
        };
        turned(&mut head.mean);
        head.identity.iter_mut().for_each(turned);
        head.expressions
            .iter_mut()
            .for_each(|e| turned(&mut e.delta));
        FaceModel::of(&head, vec![Vec3::ZERO; LANDMARKS])
    }

    fn of(head: &Head, offsets: Vec<Vec3>) -> Result<FaceModel> {
        let unit = |names: &&[&str]| {
            let mut sum = vec![Vec3::ZERO; head.mean.len()];
            let moved = head.expressions.iter();
            for expression in moved.filter(|e| names.contains(&e.name.as_str())) {
                let delta = vectors(&expression.delta);
                sum.iter_mut().zip(delta).for_each(|(s, d)| *s += d);
            }
            sum
        };
        let mesh = Mesh::new(head)?;
        Ok(FaceModel {
            identity: head
                .identity
                .iter()
                .take(MODES)
                .map(|m| vectors(m))
                .collect(),
            units: UNITS.iter().map(unit).collect(),
            offsets,
            surface: surface(&mesh),
            mesh,
        })
    }

    /// A landmark of a face with these vertices \[mm, head frame\].
    pub fn landmark(&self, vertices: &[Vec3], landmark: usize) -> Vec3 {
        vertices[self.mesh.landmarks[landmark] as usize] + self.offsets[landmark]
    }
}

fn vectors(points: &[[f32; 3]]) -> Vec<Vec3> {
    points.iter().map(|v| Vec3::from(*v)).collect()
}

/// Candide's landmarks lie between vertices and belong to no triangle.
fn surface(mesh: &Mesh) -> Vec<u32> {
    let mut drawn: Vec<u32> = mesh.triangles.iter().flatten().copied().collect();
    drawn.sort();
    drawn.dedup();
    let nearest = |landmark: &u32| {
        let at = mesh.mean[*landmark as usize];
        let distance = |v: &u32| mesh.mean[*v as usize].distance_squared(at);
        let found = drawn
            .iter()
            .min_by(|a, b| distance(a).total_cmp(&distance(b)));
        found.copied().unwrap_or(*landmark)
    };
    mesh.landmarks.iter().map(nearest).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::PathBuf;

    #[test]
    fn candide_faces_as_the_morphable_head_does() {
        let data = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
        let (kit, wfm) = (data.join("facekit.npz"), data.join("candide3.wfm"));
        if !kit.exists() || !wfm.exists() {
            crate::skip::skipped("heads of the shared data");
            return;
        }
        let head = FaceModel::morphable(&kit).unwrap();
        let candide = FaceModel::candide(&wfm, &kit).unwrap();
        assert_eq!(candide.mesh.triangles.len(), 184);
        assert_eq!(candide.identity.len(), MODES);
        let inner = |model: &FaceModel| -> Vec<Vec3> {
            let all = INNER..LANDMARKS;
            all.map(|i| model.landmark(&model.mesh.mean, i)).collect()
        };
        let turn = rotation_onto(&inner(&candide), &inner(&head));
        assert!(turn.abs_diff_eq(glam::Mat3::IDENTITY, 1e-3), "{turn}");
        // The tip of the nose looks at the camera in both.
        for model in [&head, &candide] {
            let normals = model.mesh.normals(&model.mesh.mean);
            assert!(normals[model.surface[30] as usize].z < -0.7);
        }
    }
}
