//! What aligners are measured on: labelled faces, and where posewise's detector finds them.

use posewise::align::{Shape, Views, Workspace};
use posewise::detect::{Detection, DetectorModel};
use posewise::image::Frame;
use posewise_metrics::landmarks::{INNER, bounds, iou};
use posewise_train::align::evaluate::{Accuracy, nme};
use posewise_train::align::start_from_box;
use posewise_train::faces::Face;
use posewise_train::verifier::candidates;
use rayon::prelude::*;

/// Labelled faces.
pub struct Yardstick {
    /// One per picture.
    pub faces: Vec<Face>,
    /// Of each face the candidate that overlaps most with its labels' box.
    found: Vec<Option<Detection>>,
}

impl Yardstick {
    /// Searches all pictures.
    pub fn new(faces: Vec<Face>, detector: &DetectorModel<'_>) -> Yardstick {
        let search = |work: &mut Box<Workspace>, face: &Face| {
            let label = bounds(&face.landmarks);
            let overlap = |at: &Detection| {
                let half = at.size / 2.0;
                iou(
                    &label,
                    &[at.x - half, at.y - half, at.x + half, at.y + half],
                )
            };
            let all = candidates(detector, &face.picture.frame(), work).into_iter();
            let nearest = all
                .map(|at| (overlap(&at), at))
                .max_by(|a, b| a.0.total_cmp(&b.0));
            nearest
                .filter(|(overlap, _)| *overlap > 0.0)
                .map(|(_, at)| at)
        };
        let found = faces
            .par_iter()
            .map_init(|| Box::new(Workspace::new()), search)
            .collect();
        Yardstick { faces, found }
    }

    /// Faces with a candidate.
    pub fn found(&self) -> usize {
        self.found.iter().flatten().count()
    }

    /// Errors from the detector's boxes, over the faces with a candidate. `run` moves the
    /// initial shape of the view that the detector sees; `None` stays where it started.
    pub fn detected_errors(
        &self,
        views: &Views<'_>,
        run: impl Fn(&Frame<'_>, Shape, &mut Workspace) -> Option<Shape> + Sync,
    ) -> Accuracy {
        let align = |work: &mut Box<Workspace>, (face, at): (&Face, Detection)| {
            let initial = views.initial_shape(at.yaw).expect("there is a start shape");
            let start = start_from_box(&initial, [at.x, at.y], at.size, at.roll);
            let shape = run(&face.picture.frame(), start, work).unwrap_or(start);
            (shape, nme(face, &shape, 0), nme(face, &shape, INNER))
        };
        let found = self.faces.par_iter().zip(&self.found);
        let rows: Vec<_> = found
            .filter_map(|(face, at)| at.map(|at| (face, at)))
            .map_init(|| Box::new(Workspace::new()), align)
            .collect();
        Accuracy::of(&rows)
    }
}
