//! The parts of the `posewise` command, which feeds files, pipes and cameras to the tracker.
//!
//! What is public here serves the developer's program `posewise-lab` too, and may change with it.
//!
//! | module | what it does |
//! |---|---|
//! | `cli`, `parse` | the grammar, and the ranges of its values |
//! | `program` | a program's frame: thread, signals, exit code |
//! | `command` | which command runs |
//! | `source/` | INPUT → a stream of [`picture::Picture`]s |
//! | `track`, `faces`, `session` | `posewise track`: the loop and its trackers |
//! | `csv`, `jsonl`, `log`, `overlay/`, `plot` | its outputs |
//! | `fields`, `value` | the fields of a result, whatever their type |
//! | `head/` | the head as files for 3D programs: glTF, OBJ |
//! | `streams/` | its results as datagrams for other programs |
//! | `retarget` | its weights for an avatar, by a file |
//! | `monitor/` | a driver monitor over the results |
//! | `lens`, `calibration` | the camera, by options, EXIF or a file |
//! | `view/` | `posewise view`: a web server that shows the tracker's frames |
//! | `index/` | `posewise index`: tables of many videos |
//! | `demo/` | `posewise demo`, with the clip that ships with posewise |
//! | `bounded` | reading files that may be anything |
//! | `destination`, `interrupt`, `output` | output files, signals, standard output |
//! | `model_file`, `model_info` | reading models, `posewise model info` |
//! | `manual` | manual pages and shell completions, for packages |

mod bounded;
mod calibration;
pub mod cli;
pub mod command;
mod csv;
pub mod demo;
mod destination;
mod faces;
#[rustfmt::skip] // generated
mod fields;
mod head;
mod index;
mod interrupt;
mod jsonl;
mod lens;
mod log;
mod manual;
pub mod model_file;
mod model_info;
pub mod monitor;
pub mod output;
mod overlay;
pub mod parse;
pub mod picture;
mod plot;
pub mod program;
mod retarget;
pub mod session;
pub mod source;
mod streams;
mod text;
mod track;
mod value;
mod view;
