use anyhow::Result;
use posewise_train::align::{Accuracy, Jitter, Options, evaluate, train};
use posewise_train::faces::photographs;
use std::path::Path;

fn main() -> Result<()> {
    let data = Path::new("../shared/data/faces68");
    let mut faces = photographs(&data.join("train.csv"), &data.join("train"))?;
    let mirrors: Vec<_> = faces.iter().map(|f| f.mirrored()).collect();
    faces.extend(mirrors);
    let options = Options::default();
    let section = train(&faces, &options)?;
    let blob = posewise_train::pack::blob(&[section]);
    std::fs::write("/tmp/align.posewise", &blob)?;
    let mut words = vec![0u128; blob.len() / 16 + 8];
    let aligned = unsafe { std::slice::from_raw_parts_mut(words.as_mut_ptr() as *mut u8, words.len() * 16) };
    let off = aligned.as_ptr().align_offset(64);
    aligned[off..off + blob.len()].copy_from_slice(&blob);
    let blob = posewise::model::Blob::open(&aligned[off..off + blob.len()])?;
    let model = posewise::align::AlignModel::open(&blob)?;
    let dev = photographs(&data.join("dev.csv"), &data.join("dev"))?;
    let j = Jitter { shift: 0.05, log_size: 0.08, roll: 0.14 };
    for rounds in [0, 1, 10] {
        println!("rounds {rounds}: {:?}", Accuracy::of(&evaluate(&model, &dev, &j, 3, rounds)));
    }
    println!("size {}", blob.total_len());
    Ok(())
}
