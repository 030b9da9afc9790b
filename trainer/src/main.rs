use anyhow::Result;
use posewise_train::align::{Accuracy, Jitter, Options, evaluate, train};
use posewise_train::faces::photographs;
use std::path::Path;

fn main() -> Result<()> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let data = Path::new(&args[0]);
    let mut options = Options::default();
    let mut out = String::from("/tmp/align.posewise");
    for a in &args[1..] {
        let (k, v) = a.split_once('=').unwrap();
        let f: f32 = v.parse().unwrap_or(0.0);
        match k {
            "features" => options.stages.iter_mut().for_each(|s| s.features = f as usize),
            "zoom" => options.stages.iter_mut().for_each(|s| s.zoom *= f),
            "modes" => options.modes = f as usize,
            "detect" => options.detect_starts = f as usize,
            "track" => options.track_starts = f as usize,
            "loops" => options.closed_loop_rounds = f as usize,
            "share" => options.closed_loop_share = f,
            "tmodes" => options.track_modes = f,
            "from" => options.track_from = f as usize,
            "stage" => {
                let n: Vec<f32> = v.split(',').map(|x| x.parse().unwrap()).collect();
                let s = &mut options.stages[n[0] as usize];
                (s.zoom, s.spacing, s.radius) = (n[1], n[2] as i32, n[3] as i32);
            }
            "last" => { let s = *options.stages.last().unwrap(); options.stages.push(posewise_train::align::StageOptions { zoom: f, ..s }); }
            "drop" => { options.stages.pop(); }
            "out" => out = v.into(),
            _ => panic!("{k}"),
        }
    }
    println!("{args:?}");
    let mut faces = photographs(&data.join("train.csv"), &data.join("train"))?;
    let mirrors: Vec<_> = faces.iter().map(|f| f.mirrored()).collect();
    faces.extend(mirrors);
    let section = train(&faces, &options)?;
    let blob = posewise_train::pack::blob(&[section]);
    std::fs::write(&out, &blob)?;
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
