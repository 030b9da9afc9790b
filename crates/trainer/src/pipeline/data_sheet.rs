//! Stage `data-sheet`: errors of the cascade on the dev photographs; and the text of the model's
//! data sheet.

use super::args::Args;
use super::context::Context;
use super::stage::Stage;
use super::store::Output;
use super::{global_network, refiners, sections};
use crate::align::{self, Accuracy, Trained};
use crate::faces::{self, Face};
use crate::photographs::DEV;
use crate::sources::{Source, Sources, Terms, What};
use anyhow::Result;
use posewise::align::AlignModel;
use posewise_format::{SHEET_FREE, SHEET_RESEARCH, SHEET_TAG, SHEET_TITLE, SectionWriter, Tag};
use posewise_metrics::BoxJitter;
use std::path::Path;

/// Errors that the data sheet names.
const ACCURACY: &str = "accuracy.json";
/// What else was measured, as it was printed.
const REPORT: &str = "report.txt";

/// Measures the cascade (global network, ensemble member, refiners, shape regression) from jittered
/// true boxes.
pub fn make(context: &Context<'_>, cascade: &[(&Output, Tag); 4]) -> Result<Output> {
    let mut stage = sections::with_cascade(Stage::new("data-sheet", 2), cascade)?;
    for name in [DEV.table, DEV.images] {
        stage = stage.input(name, context.store.data(&context.data(name))?);
    }
    let output = context.store.make(&stage, &[ACCURACY, REPORT], |folder| {
        let dev = faces::of_set(&DEV, &context.args.data)?;
        let network = cascade[0].0.path(global_network::NETWORK);
        let trained = Trained::read(&network, &global_network::options(context).sizes);
        let mut report = Vec::new();
        sections::with_model(&cascade[..1], |global| {
            report_global(global, trained.as_ref(), &dev, &mut report);
            Ok(())
        })?;
        let accuracy = sections::with_model(cascade, |model| {
            for rounds in [1, 10] {
                let again = Accuracy::of(&align::evaluate(model, &dev, &boxes(1), rounds));
                report.push(format!("dev, {rounds} more iterations: {again:.2?}"));
            }
            Ok(Accuracy::of(&align::evaluate(model, &dev, &boxes(3), 0)))
        })?;
        report.push(format!("dev: {accuracy:.2?}\n"));
        std::fs::write(folder.join(REPORT), report.join("\n"))?;
        Ok(std::fs::write(
            folder.join(ACCURACY),
            serde_json::to_vec(&accuracy)?,
        )?)
    })?;
    print!("{}", String::from_utf8_lossy(&output.read(REPORT)?));
    Ok(output)
}

/// Reads the errors back.
pub fn read(output: &Output) -> Result<Accuracy> {
    Ok(serde_json::from_slice(&output.read(ACCURACY)?)?)
}

fn boxes(count: usize) -> align::Boxes {
    align::Boxes {
        jitter: BoxJitter::DETECTOR,
        count,
    }
}

/// Errors of the global stage's network after each of its predictions, and after it was quantized.
fn report_global(
    global: &AlignModel<'_>,
    trained: Option<&Trained>,
    dev: &[Face],
    report: &mut Vec<String>,
) {
    let Some(trained) = trained else { return };
    let all = trained.network.heads.len();
    for predictions in 1..=all {
        let rows = align::evaluate_float(global, trained, predictions, dev, &boxes(1));
        let float = Accuracy::of(&rows);
        report.push(format!(
            "dev, global stage in f32, {predictions} of {all} predictions: {float:.3?}"
        ));
    }
    let integers = Accuracy::of(&align::evaluate(global, dev, &boxes(1), 0));
    report.push(format!("dev, global stage in i8: {integers:.3?}"));
}

/// The text of the data sheet.
pub fn text(args: &Args, sources: &Sources, dev: &Accuracy) -> String {
    format!(
        "\
{SHEET_TITLE}{name}

Made by `cargo run --release -p posewise-train -- model --terms {terms} --seed {seed}
--renders {plain} --near-renders {near} --steps {steps} --detector-steps {detector}
--refiner-steps {refiner} --share-of-from {share}{without}{from}`.

Trained on:
{made_from}
Cascade on 202 photographs with manual landmarks (HELEN, AFW) of other people, from boxes 5 %
shifted, 8 % resized and 8 degrees turned (r.m.s.): mean error over 68 landmarks {mean:.2} % of the
inter-ocular distance, median {median:.2} %, above 10 %: {failure:.2} %.
",
        made_from = made_from(args, sources),
        name = args
            .out
            .file_name()
            .and_then(|n| n.to_str())
            .unwrap_or("the model"),
        terms = args.terms.name(),
        detector = args.detector_steps,
        refiner = refiners::steps(args),
        share = args.share_of_from,
        without = args.without_option(),
        from = args.from_option(),
        seed = args.seed,
        plain = args.renders,
        near = args.near_renders,
        steps = args.steps,
        mean = dev.nme68,
        median = dev.nme68_median,
        failure = 100.0 * dev.failure,
    )
}

/// Headings of the parts on sections that are added to a finished model, in the order in which they
/// stand.
const PARTS: [&str; 4] = [
    VERIFIER_HEADING,
    MESH_HEADING,
    WEIGHTS_HEADING,
    EYES_HEADING,
];
/// Those of sections `VRFY`, `MESH`, `WGHT` and `EYES`.
pub const VERIFIER_HEADING: &str = "\n\nVerifier (section VRFY):\n";
/// See [`VERIFIER_HEADING`].
pub const MESH_HEADING: &str = "\n\nMesh (section MESH):\n";
/// See [`VERIFIER_HEADING`].
pub const WEIGHTS_HEADING: &str = "\n\nWeights (section WGHT):\n";
/// See [`VERIFIER_HEADING`].
pub const EYES_HEADING: &str = "\n\nEyes (section EYES):\n";

/// What the data sheet says of a verifier that was trained for a finished model.
pub fn about_verifier(args: &Args, sources: &Sources) -> String {
    let of_faces = |source: &&Source| !matches!(source.what, What::SingleEyes | What::InfraredEyes);
    let names = sources.iter().filter(of_faces).map(|source| source.name);
    let names = names.collect::<Vec<_>>().join(", ");
    format!(
        "\
trained anew for the networks above by `cargo run --release -p posewise-train -- model
--terms {terms} --seed {seed} --renders {plain} --near-renders {near} --steps 0
--detector-steps 0 --refiner-steps 0{without}{from}`, on
{names}, and {plain} rendered faces.",
        terms = args.terms.name(),
        seed = args.seed,
        plain = args.renders,
        near = args.near_renders,
        without = args.without_option(),
        from = args.from_option(),
    )
}

/// A data sheet in which the part below a heading is new.
pub fn with_part(sheet: &str, heading: &str, text: &str) -> String {
    let sheet = sheet.trim_end_matches(PADDING);
    let starts: Vec<usize> = PARTS.iter().filter_map(|part| sheet.find(part)).collect();
    let first = starts.iter().copied().min().unwrap_or(sheet.len());
    let parts = PARTS.iter().map(|part| {
        if *part == heading {
            return format!("{heading}{text}");
        }
        let Some(start) = sheet.find(part) else {
            return String::new();
        };
        let later = starts.iter().copied().filter(|at| *at > start);
        sheet[start..later.min().unwrap_or(sheet.len())].to_owned()
    });
    let parts: String = parts.collect();
    format!("{}{parts}", sheet[..first].trim_end())
}

/// A section of the finished model as it is, if it has one, and the part below this heading of the
/// model's data sheet.
pub fn kept_part(
    context: &Context<'_>,
    tag: Tag,
    heading: &str,
) -> Result<Option<(SectionWriter, String)>> {
    let Some(section) = context.kept(tag)? else {
        return Ok(None);
    };
    let sheet = context.kept(SHEET_TAG)?.map(|sheet| sheet.bytes().to_vec());
    let sheet = String::from_utf8_lossy(sheet.as_deref().unwrap_or_default()).into_owned();
    let part = sheet.find(heading).map_or("", |start| {
        let ends = PARTS.iter().filter_map(|part| sheet.find(part));
        let end = ends.filter(|end| *end > start).min();
        &sheet[start..end.unwrap_or(sheet.len())]
    });
    Ok(Some((section, part.to_string())))
}

/// Adds a part to a data sheet, after an empty line.
pub fn add(sheet: &mut String, part: &str) {
    sheet.truncate(sheet.trim_end_matches(PADDING).len());
    *sheet += &format!("\n\n{}\n", part.trim_matches(PADDING));
}

/// What may stand at the end of a data sheet and says nothing.
pub const PADDING: [char; 3] = ['\0', '\n', ' '];

/// A data sheet of another model as that of one at this path, without padding at its end.
pub fn titled(sheet: &str, path: &Path) -> String {
    let (_, rest) = sheet.split_once('\n').unwrap_or_default();
    let name = path.file_name().unwrap_or_default().display();
    let rest = rest.trim_end_matches(PADDING);
    format!("{SHEET_TITLE}{name}\n{rest}")
}

/// What the model is made from, with its terms.
fn made_from(args: &Args, sources: &Sources) -> String {
    let renders = args.renders + args.near_renders;
    let mut text = String::new();
    for source in sources.iter() {
        text += &format!("- {}: {};\n", source.name, source.sheet);
    }
    text += &format!(
        "- {renders} rendered faces of these heads, with procedural skins and \
         skins from\n  those photographs that show whole heads.\n"
    );
    if sources.labels().is_some() {
        text += "- 39 offsets of landmarks, from where the labels above have them to where people \
                 mark them,\n  measured on 999 photographs with manual landmarks.\n";
    }
    text + &match sources.terms() {
        Terms::Free => format!("\n{SHEET_FREE}, also in products.\n"),
        Terms::Research => {
            format!("\n{SHEET_RESEARCH} may restrict the use of a model trained on them.\n")
        }
    }
}
