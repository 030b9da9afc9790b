//! What every call of the C ABI asks of addresses and lengths (src/ffi/gates.rs) is right: for
//! addresses of one byte by trying every block of memory, for those of 32 and 64 bits by a solver,
//! Z3, which is given what the compiler makes of that file.

use crate::common::c::{require, succeed};
use crate::common::{root, scratch};
use std::fmt::Write;
use std::process::{Command, Stdio};

type Word = u8;

#[path = "../../src/ffi/gates.rs"]
mod narrow;

/// Addresses of one byte.
const ADDRESSES: usize = 256;

/// The addresses of a block, as a set.
type Set = [u64; ADDRESSES / 64];

/// Every block that such a memory can have: address, length, and the set of its addresses.
fn blocks() -> Vec<(Word, Word, Set)> {
    let mut blocks = Vec::new();
    for at in 0..ADDRESSES {
        for len in 0..=(ADDRESSES - at).min(ADDRESSES - 1) {
            let mut set = Set::default();
            (at..at + len).for_each(|byte| set[byte / 64] |= 1 << (byte % 64));
            blocks.push((at as Word, len as Word, set));
        }
    }
    blocks
}

#[test]
fn blocks_of_a_small_memory_are_told_apart() {
    let blocks = blocks();
    for (a, a_len, a_set) in &blocks {
        let wrong = blocks.iter().filter(|(b, b_len, b_set)| {
            let common = a_set.iter().zip(b_set).any(|(a, b)| a & b != 0);
            narrow::share_a_byte(*a, *a_len, *b, *b_len) != common
        });
        assert_eq!(wrong.count(), 0, "{a} {a_len}");
    }
}

#[test]
fn lengths_and_alignments_of_a_small_memory() {
    for at in 0..=Word::MAX {
        for len in 0..=Word::MAX {
            let ends = at as usize + len as usize;
            let can_be = ends < ADDRESSES && (len as usize) < ADDRESSES / 2;
            assert_eq!(narrow::can_be(at, len), can_be, "{at} {len}");
            for bit in 0..Word::BITS {
                let align = 1 << bit;
                let is_aligned = at % align == 0;
                assert_eq!(narrow::is_aligned(at, align), is_aligned);
                let holds = is_aligned && len >= 100;
                assert_eq!(narrow::holds(at, len, 100, align), holds);
            }
        }
    }
    for (most, size) in [(16, 15), (1, 255), (255, 1), (0, 255)] {
        for capacity in 0..=Word::MAX {
            let items = capacity.min(most) as usize;
            let bytes = narrow::written(capacity, most, size) as usize;
            assert_eq!(bytes, items * size as usize);
        }
    }
}

/// The gates as functions that the compiler must keep.
fn wrappers(width: usize) -> String {
    let gates = root().join("src/ffi/gates.rs");
    format!(
        "#![no_std]
type Word = u{width};
#[path = {gates:?}]
mod gates;
#[unsafe(no_mangle)]
pub extern \"C\" fn share(a: Word, b: Word, c: Word, d: Word) -> bool {{
    gates::share_a_byte(a, b, c, d)
}}
#[unsafe(no_mangle)]
pub extern \"C\" fn can_be(a: Word, b: Word) -> bool {{
    gates::can_be(a, b)
}}
#[unsafe(no_mangle)]
pub extern \"C\" fn holds(a: Word, b: Word) -> bool {{
    gates::holds(a, b, 4096, 64)
}}
#[unsafe(no_mangle)]
pub extern \"C\" fn written(a: Word) -> Word {{
    gates::written(a, 800, 16)
}}
"
    )
}

/// What must hold for all numbers: Z3 is asked for some for which it does not. One bit more than
/// the addresses have holds every end of a block.
const CLAIMS: [(&str, &str); 5] = [
    // x is a byte of both blocks, and yet they are said to share none.
    (
        "share",
        "(and (not (share a b c d)) (bvuge x (long a)) (bvult x (end a b))
            (bvuge x (long c)) (bvult x (end c d)))",
    ),
    // They are said to share one, and yet the later of the two starts is in one block only.
    (
        "share",
        "(let ((x (ite (bvuge a c) (long a) (long c)))) (and (share a b c d)
            (not (and (bvult x (end a b)) (bvult x (end c d))))))",
    ),
    (
        "can_be",
        "(not (= (can_be a b) (and (bvult (end a b) (bvshl (long one) (long width)))
            (bvult (bvshl (long b) (long one)) (bvshl (long one) (long width))))))",
    ),
    (
        "holds",
        "(not (= (holds a b) (and (= ((_ extract 5 0) a) #b000000) (bvuge b (n 4096)))))",
    ),
    (
        "written",
        "(not (= (written a) (bvmul (n 16) (ite (bvult a (n 800)) a (n 800)))))",
    ),
];

/// Claims that are wrong, so that the solver must find numbers: a limit is off by one.
const WRONG: [(&str, &str); 2] = [
    (
        "share",
        "(and (not (share a b c d)) (bvuge x (long a)) (bvule x (end a b))
            (bvuge x (long c)) (bvult x (end c d)))",
    ),
    (
        "holds",
        "(not (= (holds a b) (and (= ((_ extract 5 0) a) #b000000) (bvugt b (n 4096)))))",
    ),
];

#[test]
#[ignore = "a solver takes ten seconds of processor time: .ci/nightly"]
fn a_solver_finds_no_exception() {
    if !require("z3") {
        return;
    }
    for width in [32, 64] {
        let source = scratch("gates").join(format!("gates{width}.rs"));
        std::fs::write(&source, wrappers(width)).expect("target/ is writable");
        let mut rustc = Command::new(std::env::var("RUSTC").unwrap_or("rustc".into()));
        rustc.args(["--edition=2024", "--crate-type=lib", "-Copt-level=2"]);
        rustc.args(["-Cpanic=abort", "--emit=llvm-ir", "-o"]);
        let code = source.with_extension("ll");
        succeed(rustc.arg(&code).arg(&source));
        let code = std::fs::read_to_string(code).expect("just written");
        let functions = functions(&code, width);
        for (name, claim) in CLAIMS {
            assert_eq!(solved(&functions, claim, width), "unsat", "{name} u{width}");
        }
        for (name, claim) in WRONG {
            assert_eq!(solved(&functions, claim, width), "sat", "{name} u{width}");
        }
    }
}

/// What Z3 says of a claim about the functions.
fn solved(functions: &str, claim: &str, width: usize) -> String {
    let numbers: String = ["a", "b", "c", "d"]
        .map(|name| format!("(declare-const {name} (_ BitVec {width}))\n"))
        .concat();
    let claim = claim.split("(n ").enumerate().map(|(i, part)| match i {
        0 => part.to_owned(),
        _ => part.replacen(')', &format!(" {width})"), 1),
    });
    let claim = claim.collect::<Vec<_>>().join("(_ bv");
    let question = format!(
        "(define-fun one () (_ BitVec {width}) (_ bv1 {width}))
(define-fun width () (_ BitVec {width}) (_ bv{width} {width}))
(define-fun long ((v (_ BitVec {width}))) (_ BitVec {more}) ((_ zero_extend 1) v))
(define-fun end ((v (_ BitVec {width})) (l (_ BitVec {width}))) (_ BitVec {more})
    (bvadd (long v) (long l)))
(declare-const x (_ BitVec {more}))
{numbers}{functions}(assert {claim})\n(check-sat)\n",
        more = width + 1
    );
    let path = scratch("gates").join("question.smt2");
    std::fs::write(&path, &question).expect("target/ is writable");
    let mut z3 = Command::new("z3");
    let said = succeed(z3.args(["-T:60", "-smt2"]).arg(path).stdin(Stdio::null()));
    said.trim().to_owned()
}

/// The functions of LLVM's code in the language of solvers. They have no loops.
fn functions(code: &str, width: usize) -> String {
    let mut all = String::new();
    for function in code.split("\ndefine ").skip(1) {
        let (head, body) = function.split_once("{\n").expect("a body");
        let (body, _) = body.split_once("\n}").expect("an end");
        let (_, head) = head.split_once('@').expect("a name");
        let (name, head) = head.split_once('(').expect("arguments");
        let (arguments, _) = head.rsplit_once(") ").expect("arguments");
        let names = arguments
            .split(", ")
            .map(|a| a.rsplit(' ').next().expect("a name"));
        let names: Vec<_> = names
            .map(|n| format!("({} (_ BitVec {width}))", symbol(n)))
            .collect();
        let kind = if name == "written" {
            format!("(_ BitVec {width})")
        } else {
            "Bool".into()
        };
        let value = Blocks::new(body).value("start", "", width);
        writeln!(
            all,
            "(define-fun {name} ({}) {kind} {value})",
            names.join(" ")
        )
        .expect("a text");
    }
    all
}

/// The basic blocks of a function: name and instructions.
struct Blocks<'a>(Vec<(&'a str, Vec<&'a str>)>);

impl<'a> Blocks<'a> {
    fn new(body: &'a str) -> Self {
        let mut blocks: Vec<(&str, Vec<&str>)> = Vec::new();
        for line in body.lines() {
            let line = line.split(" ;").next().expect("a part");
            let line = line.split(';').next().expect("a part").trim();
            match line.strip_suffix(':') {
                Some(name) => blocks.push((name, Vec::new())),
                None if !line.is_empty() => blocks.last_mut().expect("a block").1.push(line),
                None => {}
            }
        }
        Blocks(blocks)
    }

    /// What a block that was entered from another one returns in the end.
    fn value(&self, name: &str, from: &str, width: usize) -> String {
        let block = self.0.iter().find(|(known, _)| *known == name);
        let (_, lines) = block.unwrap_or_else(|| panic!("no block {name}"));
        let mut lets = String::new();
        let mut depth = 0;
        for line in lines {
            if let Some((result, line)) = line.split_once(" = ") {
                let value = computed(line, from, width);
                write!(lets, "(let (({} {value})) ", symbol(result)).expect("a text");
                depth += 1;
                continue;
            }
            let words: Vec<&str> = line.split([' ', ',']).filter(|w| !w.is_empty()).collect();
            let to = |i: usize| self.value(words[i].trim_start_matches('%'), name, width);
            let end = match words[..] {
                ["ret", _, value] => operand(value, width),
                ["br", "i1", test, "label", _, "label", _] => {
                    format!("(ite {} {} {})", symbol(test), to(4), to(6))
                }
                ["br", "label", _] => to(2),
                _ => panic!("not known: {line}"),
            };
            return format!("{lets}{end}{}", ")".repeat(depth));
        }
        panic!("{name} has no end")
    }
}

/// The value of an instruction, in a block that was entered from another one.
fn computed(line: &str, from: &str, width: usize) -> String {
    // Attributes say what is known of a result; it is not needed.
    let mut words: Vec<&str> = line.split([' ', ',']).filter(|w| !w.is_empty()).collect();
    words.retain(|word| !["tail", "nuw", "nsw", "noundef", "samesign", "disjoint"].contains(word));
    let is_bit = words.contains(&"i1");
    let value = |word: &str| match is_bit {
        true => boolean(word),
        false => operand(word, width),
    };
    if words[0] == "phi" {
        let (_, choices) = line.split_once('[').expect("choices");
        for choice in choices.split('[') {
            let (word, rest) = choice.trim().split_once(',').expect("two");
            if rest.split(']').next().expect("an end").trim() == format!("%{from}") {
                return value(word);
            }
        }
        panic!("not entered from {from}: {line}");
    }
    if words[0] == "call" {
        let (call, arguments) = line.split_once('(').expect("arguments");
        // The range of a result may have brackets too.
        let (call, arguments) = match call.contains('@') {
            true => (call, arguments),
            false => arguments.split_once('(').expect("arguments"),
        };
        let numbers = arguments.trim_end_matches(')').split(", ");
        let [a, b] = [0, 1].map(|i| {
            let argument = numbers.clone().nth(i).expect("two");
            operand(argument.rsplit(' ').next().expect("a name"), width)
        });
        let name = call.rsplit_once("@llvm.").expect("a function of LLVM").1;
        return match name.rsplit_once('.').expect("a type").0 {
            "umin" => format!("(ite (bvult {a} {b}) {a} {b})"),
            "umax" => format!("(ite (bvugt {a} {b}) {a} {b})"),
            "usub.sat" => format!("(ite (bvult {a} {b}) (_ bv0 {width}) (bvsub {a} {b}))"),
            other => panic!("not known: {other}"),
        };
    }
    match words[..] {
        ["icmp", "eq", _, a, b] => format!("(= {} {})", value(a), value(b)),
        ["icmp", "ne", _, a, b] => format!("(distinct {} {})", value(a), value(b)),
        ["icmp", order, _, a, b] => format!("(bv{order} {} {})", value(a), value(b)),
        ["select", "i1", test, _, a, _, b] => {
            let value = |word: &str, kind: &str| match kind {
                "i1" => boolean(word),
                _ => operand(word, width),
            };
            let kind = words[3];
            let test = boolean(test);
            format!("(ite {test} {} {})", value(a, kind), value(b, kind))
        }
        [operation @ ("and" | "or" | "xor"), _, a, b] => {
            let prefix = if is_bit { "" } else { "bv" };
            format!("({prefix}{operation} {} {})", value(a), value(b))
        }
        [
            operation @ ("add" | "sub" | "mul" | "shl" | "lshr"),
            _,
            a,
            b,
        ] => {
            format!("(bv{operation} {} {})", value(a), value(b))
        }
        _ => panic!("not known: {line}"),
    }
}

/// A name of LLVM's.
fn symbol(name: &str) -> String {
    format!("|{name}|")
}

fn boolean(word: &str) -> String {
    match word {
        "true" | "false" => word.into(),
        _ => symbol(word),
    }
}

fn operand(word: &str, width: usize) -> String {
    match word.parse::<i64>() {
        Ok(number) if width == 32 => format!("(_ bv{} 32)", number as u32),
        Ok(number) => format!("(_ bv{} 64)", number as u64),
        Err(_) => boolean(word),
    }
}
