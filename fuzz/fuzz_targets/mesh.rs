#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| posewise_fuzz::targets::mesh::run(data));
