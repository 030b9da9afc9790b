//! Makes the section: what is taken of the refiners, then the network.

use super::network::{self, Trained};
use super::outputs::{Figures, HELD_OUT, Options, Row};
use super::shots::Shot;
use super::{tracked, views};
use anyhow::{Result, ensure};
use posewise::align::{GEOMETRY, WEIGHTS_TAG};
use posewise::track::Model;
use posewise_format::{AlignedBytes, SHEET_TAG, SectionWriter, blob};

/// Trains the section for a finished model.
pub fn train(model: &[u8], shots: &[Shot], options: &Options) -> Result<(SectionWriter, Figures)> {
    let is_held_out = |person: u32| person.is_multiple_of(HELD_OUT);
    let bytes = AlignedBytes::new(model);
    let (without, views) = {
        let model = Model::load(&bytes)?;
        let views = views::train(&model, shots, &options.taken, is_held_out)?;
        let kept = SectionWriter::all_but(&[WEIGHTS_TAG, SHEET_TAG], model.blob());
        (kept, views)
    };
    let inputs = GEOMETRY + 2 * options.taken.iter().sum::<usize>();
    let with = |network: &Trained| -> Result<Vec<u8>> {
        let mut sections = without.clone();
        sections.push(section(&views, network));
        Ok(blob(&sections))
    };
    let blank = AlignedBytes::new(&with(&Trained::blank(inputs))?);
    let model = Model::load(&blank)?;
    ensure!(model.align().weights().inputs() == inputs, "other inputs");
    let rows = tracked::rows(&model, shots)?;
    println!(
        "weights: {} of {} pictures tracked",
        rows.len(),
        shots.len()
    );
    let (tests, trains): (Vec<Row>, Vec<Row>) =
        rows.into_iter().partition(|r| is_held_out(r.person));
    let trained = network::train(&trains, &tests, inputs, options);
    let figures = trained.figures(&tests, trains.len());
    Ok((section(&views, &trained), figures))
}

fn section(views: &[views::View], network: &Trained) -> SectionWriter {
    let mut out = SectionWriter::new(WEIGHTS_TAG);
    views.iter().for_each(|view| view.write(&mut out));
    network.write(&mut out);
    out
}
