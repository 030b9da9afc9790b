//! Which local features a linear cascade should see: one table, all else equal.

pub mod cascade;
mod crop;
mod filters;
pub mod local;
mod rbm;
mod refine;
pub mod regression;
mod stored;

use anyhow::Result;
use cascade::{Cascade, Training};
use local::Kind;
use posewise_metrics::BoxJitter;
use posewise_train::align::{Boxes, StartShapes, mean_shape};
use posewise_train::faces::{self, Face};
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use regression::Links;
use std::collections::HashSet;
use std::path::PathBuf;
use std::time::Instant;

/// Settings of `posewise-lab features`.
#[derive(Clone, Debug, clap::Args)]
pub struct Args {
    /// The shared data.
    #[arg(long, default_value = "../shared/data")]
    pub data: PathBuf,
    /// A file of renders; without it the rows that need them are left out.
    #[arg(long)]
    pub renders: Option<PathBuf>,
    /// Where the table goes, rewritten after each row.
    #[arg(long)]
    pub out: Option<PathBuf>,
    /// Seed of everything random.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Starts on each photograph and on each mirrored one; renders have half as many.
    #[arg(long, default_value_t = 2)]
    pub starts: usize,
    /// Rendered faces that are used.
    #[arg(long, default_value_t = 12_000)]
    pub render_count: usize,
}

/// What a row's cascade is trained on.
struct Row<'a> {
    name: String,
    faces: &'a [Face],
    kind: Kind,
    late: Links,
}

/// Trains the cascades and prints their errors on the dev photographs.
pub fn run(args: &Args) -> Result<()> {
    let labels = args.data.join("faces68");
    let dev = faces::photographs(&labels.join("dev.csv"), &labels.join("dev"))?;
    let photographs = faces::photographs(&labels.join("train.csv"), &labels.join("train"))?;
    let photographs = with_mirrors(photographs);
    let mut table = Table::new(args, &dev);
    let all = |name: &str, kind, late| Row {
        name: name.into(),
        faces: &photographs,
        kind,
        late,
    };
    let kinds = [
        ("gradient histograms", Kind::Hog),
        ("principal components of patches", Kind::Pca),
        ("RBM", Kind::Rbm),
        ("RBM, refined", Kind::Refined),
    ];
    let mut best = (f32::MAX, kinds[0]);
    for (name, kind) in kinds {
        let error = table.row(&all(name, kind, Links::Global))?;
        if error < best.0 {
            best = (error, (name, kind));
        }
    }
    let (name, kind) = best.1;
    let late = [
        ("own features", Links::Own),
        ("8 best landmarks", Links::Best(8)),
    ];
    for (what, late) in late {
        table.row(&all(
            &format!("{name}; last two stages: {what}"),
            kind,
            late,
        ))?;
    }
    for share in [4, 2] {
        let some = of_some_people(&photographs, share, args.seed);
        let name = format!("{name}; 1/{share} of the people");
        let faces = &some[..];
        table.row(&Row {
            name,
            faces,
            ..all("", kind, Links::Global)
        })?;
    }
    if let Some(path) = &args.renders {
        let mut faces = faces::rendered(path, args.render_count)?;
        let mut row = |what: &str, faces: &[Face]| {
            let name = format!("{name}; {what}");
            table.row(&Row {
                name,
                faces,
                ..all("", kind, Links::Global)
            })
        };
        row("renders only", &faces)?;
        faces.extend_from_slice(&photographs);
        row("photographs and renders", &faces)?;
    }
    Ok(())
}

/// The faces and their mirror images.
fn with_mirrors(mut faces: Vec<Face>) -> Vec<Face> {
    let mirrors: Vec<Face> = faces.par_iter().map(Face::mirrored).collect();
    faces.extend(mirrors);
    faces
}

/// The faces of one in so many people.
fn of_some_people(faces: &[Face], share: usize, seed: u64) -> Vec<Face> {
    let mut people: Vec<u32> = faces.iter().map(|f| f.person).collect();
    people.sort();
    people.dedup();
    people.shuffle(&mut ChaCha8Rng::seed_from_u64(seed));
    let taken: HashSet<u32> = people.iter().take(people.len() / share).copied().collect();
    let of = |face: &&Face| taken.contains(&face.person);
    faces.iter().filter(of).cloned().collect()
}

struct Table<'a> {
    args: &'a Args,
    dev: &'a [Face],
    text: String,
}

impl<'a> Table<'a> {
    fn new(args: &'a Args, dev: &'a [Face]) -> Table<'a> {
        let text = "\
| features | samples | NME68 mean | median | NME51 mean | failures % |
|---|---|---|---|---|---|
";
        Table {
            args,
            dev,
            text: text.into(),
        }
    }

    /// Trains a row's cascade; returns its NME68 mean.
    fn row(&mut self, row: &Row<'_>) -> Result<f32> {
        let began = Instant::now();
        println!("{}", row.name);
        let boxes = |count| Boxes {
            jitter: BoxJitter::DETECTOR,
            count,
        };
        let starts = StartShapes::fit(row.faces, &mean_shape(row.faces), &[0.0, 0.4, 0.8]);
        let seed = self.args.seed ^ 0x1ab;
        let training = Training::new(row.faces, &starts, &boxes(self.args.starts), seed);
        let samples = training.samples();
        let cascade = Cascade::train(training, row.kind, row.late);
        let found = cascade.evaluate(self.dev, &starts, &boxes(3));
        let line = format!(
            "| {} | {samples} | {:.2} | {:.2} | {:.2} | {:.2} |\n",
            row.name,
            found.nme68,
            found.nme68_median,
            found.nme51,
            100.0 * found.failure
        );
        print!("{line}");
        println!("    {:.0?}", began.elapsed());
        self.text += &line;
        if let Some(out) = &self.args.out {
            std::fs::write(out, &self.text)?;
        }
        Ok(found.nme68)
    }
}
