//! The command, as people and scripts run it.

mod common;
mod demo;
mod faces;
mod head;
mod index;
mod manual;
mod model;
mod monitor;
mod outputs;
mod retarget;
mod streams;
mod track;
