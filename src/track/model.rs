//! All of a model's sections, opened and checked once.

use crate::align::{AlignModel, EnsembleMember, EyeModel, Refiners, RotationRegression};
use crate::detect::{self, DetectorModel};
use crate::shape::{FACE_TAG, FaceModel};
#[cfg(feature = "mesh")]
use crate::shape::{MeshModel, MeshTopology};
use crate::verifier::Verifier;
use posewise_format::{Blob, ModelError};

/// A checked model: views into the blob's bytes. Many trackers can share one.
#[derive(Clone, Debug)]
pub struct Model<'m> {
    #[cfg(feature = "unstable-internals")]
    blob: Blob<'m>,
    /// The face detector.
    pub(crate) detector: DetectorModel<'m>,
    /// The cascade.
    pub(crate) align: AlignModel<'m>,
    /// Face and landmark probabilities.
    pub(crate) verifier: Verifier<'m>,
    /// The head's rotation by what the cascade sees.
    pub(crate) rotation: RotationRegression<'m>,
    /// The network of single eyes.
    pub(crate) eyes: EyeModel<'m>,
    /// The 3D face.
    pub(crate) face: FaceModel<'m>,
    /// Its dense mesh.
    #[cfg(feature = "mesh")]
    pub(crate) mesh: MeshModel<'m>,
}

impl<'m> Model<'m> {
    /// Checks the whole blob: header, checksum, table and the content of every section that this
    /// build reads. `bytes` must start at a multiple of 64 bytes; see [`Aligned`](crate::Aligned).
    ///
    /// # Errors
    /// The first thing found wrong.
    pub fn load(bytes: &'m [u8]) -> Result<Self, ModelError> {
        let blob = Blob::open(bytes)?;
        let align = AlignModel::open(&blob, EnsembleMember::open(&blob)?, Refiners::open(&blob)?)?;
        Ok(Model {
            detector: DetectorModel::open(blob.section(&detect::TAG)?)?,
            verifier: Verifier::open(&blob, align.features(), align.signed_views())?,
            rotation: RotationRegression::open(&blob, align.features(), align.signed_views())?,
            align,
            eyes: EyeModel::open(&blob)?,
            face: FaceModel::open(blob.section(&FACE_TAG)?)?,
            #[cfg(feature = "mesh")]
            mesh: MeshModel::open(&blob)?,
            #[cfg(feature = "unstable-internals")]
            blob,
        })
    }

    /// What of the mesh of [`Tracker::mesh`](super::Tracker::mesh) is the same for every face;
    /// `None` where the model has no mesh.
    #[cfg(feature = "mesh")]
    pub fn mesh_topology(&self) -> Option<MeshTopology<'m>> {
        self.mesh.mesh().map(|mesh| mesh.topology)
    }
}

/// The parts of a model, for programs that run them one by one.
#[cfg(feature = "unstable-internals")]
impl<'m> Model<'m> {
    /// The blob that the model was read from.
    pub fn blob(&self) -> &Blob<'m> {
        &self.blob
    }

    /// The face detector.
    pub fn detector(&self) -> &DetectorModel<'m> {
        &self.detector
    }

    /// The cascade.
    pub fn align(&self) -> &AlignModel<'m> {
        &self.align
    }

    /// The network of single eyes.
    pub fn eyes(&self) -> &EyeModel<'m> {
        &self.eyes
    }

    /// Face and landmark probabilities.
    pub fn verifier(&self) -> &Verifier<'m> {
        &self.verifier
    }

    /// The 3D face.
    pub fn face(&self) -> &FaceModel<'m> {
        &self.face
    }
}
