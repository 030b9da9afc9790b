//! Streams of `posewise track`: datagrams to a real receiver, and addresses as input.

use std::io::{BufRead, BufReader, Write};
use std::net::{SocketAddr, TcpListener, UdpSocket};
use std::time::{Duration, Instant};

use crate::common::{csv, fails_with, gradient_clip, has_program, posewise, skip};
use rosc::{OscMessage, OscPacket, OscType};
use serde_json::Value;

/// A rendered head; 20 frames a second.
const DEMO: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/data/demo.y4m.gz");
const FRAMES: usize = 8;

/// Tracks the first frames of the demo clip; gives what the JSON lines say of them, what was
/// received, and how long it took.
fn track(option: &str, more: &[&str]) -> (Vec<Value>, Vec<Vec<u8>>, Duration) {
    let receiver = UdpSocket::bind("127.0.0.1:0").unwrap();
    let to = receiver.local_addr().unwrap().to_string();
    let start = Instant::now();
    let run = posewise()
        .args(["track", DEMO, "--frames", &FRAMES.to_string(), "--quiet"])
        .args(["--jsonl", "-", option, &to])
        .args(more)
        .assert()
        .success();
    let taken = start.elapsed();
    let lines = String::from_utf8(run.get_output().stdout.clone()).unwrap();
    let rows = lines
        .lines()
        .map(|line| serde_json::from_str(line).unwrap());
    receiver.set_nonblocking(true).unwrap();
    let mut received = Vec::new();
    let mut buffer = [0; 65536];
    while let Ok(length) = receiver.recv(&mut buffer) {
        received.push(buffer[..length].to_vec());
    }
    (rows.collect(), received, taken)
}

fn has_face(row: &Value) -> bool {
    row["state"] != "searching"
}

#[test]
fn opentrack_receives_six_doubles_a_frame() {
    let (rows, received, taken) = track("--udp-opentrack", &[]);
    let rows: Vec<&Value> = rows.iter().filter(|row| has_face(row)).collect();
    assert!(rows.len() >= FRAMES - 2, "the face is found");
    assert_eq!(received.len(), rows.len());
    for (row, datagram) in rows.into_iter().zip(received) {
        let (doubles, []) = datagram.as_chunks::<8>() else {
            panic!("{} bytes", datagram.len());
        };
        let values: Vec<f64> = doubles.iter().map(|b| f64::from_le_bytes(*b)).collect();
        let at = |key: &str| row[key].as_f64().unwrap();
        let mm = |axis: usize| row["translation_mm"][axis].as_f64().unwrap();
        let expected = [
            mm(0) / 10.0,
            -mm(1) / 10.0,
            mm(2) / 10.0,
            -at("yaw_deg"),
            at("pitch_deg"),
            at("roll_deg"),
        ];
        assert_eq!(values.len(), expected.len());
        for (value, expected) in values.iter().zip(expected) {
            assert!((value - expected).abs() < 1e-4, "{value} {expected}");
        }
    }
    // A recording is sent at its own rate.
    assert!(
        taken >= Duration::from_millis(50 * (FRAMES as u64 - 1)),
        "{taken:?}"
    );
}

/// All messages, in the order in which they came.
fn messages(packet: OscPacket) -> Vec<OscMessage> {
    match packet {
        OscPacket::Message(message) => vec![message],
        OscPacket::Bundle(bundle) => bundle.content.into_iter().flat_map(messages).collect(),
    }
}

#[test]
fn vmc_receives_head_and_blendshapes() {
    check_vmc(&[]);
}

#[test]
fn vmc_receives_the_weights_of_the_eyes_with_gaze() {
    check_vmc(&["--gaze"]);
    check_vmc(&["--natural-gaze"]);
}

/// Compares what is received with the JSON lines.
fn check_vmc(options: &[&str]) {
    let (rows, received, _) = track("--osc", options);
    let received: Vec<OscMessage> = received
        .iter()
        .flat_map(|datagram| messages(rosc::decoder::decode_udp(datagram).unwrap().1))
        .collect();
    let of = |address: &str| -> Vec<&OscMessage> {
        received.iter().filter(|m| m.addr == address).collect()
    };
    let with_face: Vec<&Value> = rows.iter().filter(|row| has_face(row)).collect();
    assert_eq!(of("/VMC/Ext/OK").len(), FRAMES);
    assert_eq!(of("/VMC/Ext/T").len(), FRAMES);
    let last = OscType::Int;
    assert_eq!(
        of("/VMC/Ext/OK")[FRAMES - 1].args,
        [last(1), last(3), last(0), last(1)]
    );
    let heads = of("/VMC/Ext/Bone/Pos");
    let applied = of("/VMC/Ext/Blend/Apply");
    assert!(with_face.len() >= FRAMES - 2, "the face is found");
    assert_eq!(
        (heads.len(), applied.len()),
        (with_face.len(), with_face.len())
    );
    for (row, head) in with_face.iter().zip(heads) {
        assert_eq!(head.args[0], OscType::String("Head".into()));
        let floats: Vec<f32> = head.args.iter().filter_map(|a| a.clone().float()).collect();
        let rotation = row["rotation"].as_array().unwrap();
        let rotation = rotation.iter().map(|v| v.as_f64().unwrap() as f32);
        assert_eq!(
            floats,
            [0.0; 3].into_iter().chain(rotation).collect::<Vec<_>>()
        );
    }
    let values = of("/VMC/Ext/Blend/Val");
    let gaze = !options.is_empty();
    let weights = with_face.iter().flat_map(|row| {
        let looks = row["eyes"]["look"].as_object().unwrap().iter();
        let animation = row["animation"].as_object().unwrap().iter();
        animation.chain(looks.filter(move |_| gaze))
    });
    let count = weights.clone().count();
    for (value, (name, weight)) in values.iter().zip(weights) {
        let OscType::String(sent) = &value.args[0] else {
            panic!("a name");
        };
        assert!(sent.eq_ignore_ascii_case(name) && sent.starts_with(char::is_uppercase));
        assert_eq!(
            value.args[1],
            OscType::Float(weight.as_f64().unwrap() as f32)
        );
    }
    assert_eq!(values.len(), count);
    let looks = values.iter().filter(|value| match &value.args[..] {
        [OscType::String(name), OscType::Float(weight)] => {
            name.starts_with("EyeLook") && *weight > 0.0
        }
        other => panic!("{other:?}"),
    });
    assert_eq!(looks.count() > 0, gaze, "somewhere they look");
}

/// Prints the messages of datagrams, which come as lines of hexadecimal digits.
const DECODE: &str = "
import json, sys
from pythonosc.osc_packet import OscPacket
for line in sys.stdin:
    for timed in OscPacket(bytes.fromhex(line)).messages:
        print(json.dumps([timed.message.address, *timed.message.params]))
";

/// python-osc, which others wrote and which has no code in common with what sends.
#[test]
fn another_library_reads_the_datagrams() {
    let python = std::env::var("POSEWISE_PYTHON").unwrap_or("python3".into());
    let mut asked = std::process::Command::new(&python);
    let asked = asked.args(["-c", "import pythonosc"]).output();
    let can = asked.is_ok_and(|answer| answer.status.success());
    if !skip::need("python-osc (.ci/requirements.txt)", can) {
        return;
    }
    let (rows, received, _) = track("--osc", &["--gaze"]);
    let hex = |datagram: &Vec<u8>| -> String {
        let digits = datagram.iter().map(|byte| format!("{byte:02x}"));
        digits.chain(["\n".to_string()]).collect()
    };
    let lines: String = received.iter().map(hex).collect();
    let run = assert_cmd::Command::new(&python)
        .args(["-c", DECODE])
        .write_stdin(lines)
        .assert()
        .success();
    let said = String::from_utf8(run.get_output().stdout.clone()).unwrap();
    let read: Vec<Value> = (said.lines())
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    let faces: Vec<&Value> = rows.iter().filter(|row| has_face(row)).collect();
    let of = |address: &str| -> Vec<&Value> { read.iter().filter(|m| m[0] == address).collect() };
    assert_eq!(of("/VMC/Ext/OK").len(), rows.len());
    assert_eq!(of("/VMC/Ext/Blend/Apply").len(), faces.len());
    let close = |a: &Value, b: &Value| (a.as_f64().unwrap() - b.as_f64().unwrap()).abs() < 1e-6;
    for (head, row) in of("/VMC/Ext/Bone/Pos").iter().zip(&faces) {
        assert_eq!(head[1], "Head");
        assert!(
            (0..4).all(|k| close(&head[5 + k], &row["rotation"][k])),
            "{head}"
        );
    }
    let weights = faces.iter().flat_map(|row| {
        let looks = row["eyes"]["look"].as_object().unwrap();
        row["animation"].as_object().unwrap().iter().chain(looks)
    });
    let values = of("/VMC/Ext/Blend/Val");
    assert_eq!(values.len(), weights.clone().count());
    assert_eq!(values.len(), faces.len() * (29 + 8));
    for (value, (name, weight)) in values.iter().zip(weights) {
        assert!(value[1].as_str().unwrap().eq_ignore_ascii_case(name));
        assert!(close(&value[2], weight), "{value} {weight}");
    }
}

#[test]
fn receivers_that_cannot_be() {
    let wrong = ["host", ":39539", "host:0", "host:99999"];
    for option in ["--osc", "--udp-opentrack"] {
        for value in wrong {
            let run = posewise().args(["track", "-", option, value]).assert();
            let said = String::from_utf8_lossy(&run.get_output().stderr).into_owned();
            assert_eq!(run.get_output().status.code(), Some(2), "{value}");
            assert!(
                said.contains(option) && said.contains("HOST:PORT"),
                "{said}"
            );
        }
    }
    let args = ["track", "-", "--osc", "no-such-host.invalid:39539"];
    let words = ["cannot find", "no-such-host.invalid"];
    fails_with(&args, gradient_clip(64, 48, 1), &words);
    // Nobody listens: datagrams are lost, as they may be.
    posewise()
        .args(["track", "-", "--quiet", "--udp-opentrack", "127.0.0.1:9"])
        .write_stdin(gradient_clip(64, 48, 2))
        .assert()
        .success();
}

/// Serves one body at `/clip.y4m`, and nothing else.
fn serve(body: Vec<u8>) -> SocketAddr {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap();
    std::thread::spawn(move || {
        for stream in listener.incoming() {
            let mut stream = stream.unwrap();
            let mut lines = BufReader::new(stream.try_clone().unwrap()).lines();
            let request = lines.next().unwrap().unwrap();
            while lines
                .next()
                .is_some_and(|line| line.is_ok_and(|l| !l.is_empty()))
            {}
            let (status, body) = match request.starts_with("GET /clip.y4m?a=[1] ") {
                true => ("200 OK", &body[..]),
                false => ("404 Not Found", &b""[..]),
            };
            let length = body.len();
            let head = format!("HTTP/1.1 {status}\r\nContent-Length: {length}\r\n\r\n");
            // ffmpeg may have read enough before the end.
            let _ = stream.write_all(head.as_bytes());
            let _ = stream.write_all(body);
        }
    });
    address
}

#[test]
fn http_addresses_are_read_as_files_are() {
    if !has_program("ffmpeg") {
        return;
    }
    let clip = gradient_clip(64, 48, 5);
    let server = serve(clip.clone());
    let table = csv(&format!("http://{server}/clip.y4m?a=[1]"), b"");
    assert_eq!(table.lines().count(), 6);
    assert_eq!(table, csv("-", &clip));

    let missing = format!("http://me:secret@{server}/other.mp4");
    let said = posewise().args(["track", &missing]).assert().code(1);
    let said = String::from_utf8_lossy(&said.get_output().stderr).into_owned();
    assert!(
        said.contains("404") && said.contains("/other.mp4"),
        "{said}"
    );
    assert!(!said.contains("secret"), "{said}");
}

/// A camera that sends an MPEG transport stream over RTSP, within the connection, to one client.
fn rtsp_camera(stream: Vec<u8>) -> SocketAddr {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap();
    std::thread::spawn(move || {
        let (mut client, _) = listener.accept().unwrap();
        let mut lines = BufReader::new(client.try_clone().unwrap()).lines();
        while let Some(Ok(request)) = lines.next() {
            let mut headers = lines.by_ref().map(|line| line.unwrap());
            let mut sequence = String::new();
            for header in headers.by_ref().take_while(|line| !line.is_empty()) {
                if header.starts_with("CSeq") {
                    sequence = header;
                }
            }
            let sdp = "v=0\r\no=- 0 0 IN IP4 127.0.0.1\r\ns=x\r\nt=0 0\r\n\
                       m=video 0 RTP/AVP 33\r\na=control:track1\r\n";
            let (header, body) = match request.split(' ').next().unwrap() {
                "OPTIONS" => ("Public: DESCRIBE, SETUP, PLAY", ""),
                "DESCRIBE" => ("Content-Type: application/sdp", sdp),
                "SETUP" => (
                    "Session: 1\r\nTransport: RTP/AVP/TCP;unicast;interleaved=0-1",
                    "",
                ),
                _ => ("Session: 1", ""),
            };
            let length = body.len();
            let answer = format!(
                "RTSP/1.0 200 OK\r\n{sequence}\r\n{header}\r\n\
                 Content-Length: {length}\r\n\r\n{body}"
            );
            client.write_all(answer.as_bytes()).unwrap();
            if request.starts_with("PLAY") {
                break;
            }
        }
        // Seven packets of the transport stream make one of RTP.
        for (number, part) in (0u16..).zip(stream.chunks(7 * 188)) {
            let mut packet = vec![b'$', 0];
            packet.extend((12 + part.len() as u16).to_be_bytes());
            packet.extend([0x80, 33]);
            packet.extend(number.to_be_bytes());
            packet.extend([0, 0, 0, 0, 0, 0, 0, 1]);
            packet.extend(part);
            client.write_all(&packet).unwrap();
        }
    });
    address
}

#[test]
fn an_rtsp_camera_is_tracked() {
    if !has_program("ffmpeg") {
        return;
    }
    let dir = tempfile::tempdir().unwrap();
    let (clip, stream) = (dir.path().join("a.y4m"), dir.path().join("a.ts"));
    std::fs::write(&clip, gradient_clip(64, 48, 30)).unwrap();
    let coded = std::process::Command::new("ffmpeg")
        .args(["-v", "error", "-i"])
        .arg(&clip)
        .args(["-c:v", "mpeg2video", "-g", "5"])
        .arg(&stream)
        .status();
    assert!(coded.unwrap().success());
    let camera = rtsp_camera(std::fs::read(&stream).unwrap());
    let run = posewise()
        .args(["track", &format!("rtsp://me:secret@{camera}/live")])
        .assert()
        .success();
    let said = String::from_utf8_lossy(&run.get_output().stdout).into_owned();
    let frames = said.lines().next().unwrap().trim_start_matches("frames");
    // The decoder may leave out the last ones.
    assert!(frames.trim().parse::<u32>().unwrap() >= 25, "{said}");
}

#[test]
fn addresses_that_cannot_be_read() {
    if !has_program("ffmpeg") {
        return;
    }
    let closed = TcpListener::bind("127.0.0.1:0")
        .unwrap()
        .local_addr()
        .unwrap();
    for scheme in ["http", "rtsp"] {
        let input = format!("{scheme}://{closed}/x");
        let words = [&input[..], "refused"];
        fails_with(&["track", &input], Vec::new(), &words);
    }
    fails_with(&["track", "ftp://x/y.mp4"], Vec::new(), &["ftp", "rtsp"]);
}
