//! How long answers take to be acknowledged when many people answer at once:
//! `cargo run --release -p isostudy-serve --example load -- 127.0.0.1:8080 300 1.0`
//!
//! So many participants begin within the first seconds, each with a connection of their own, and answer a form with this many
//! seconds between answers. Prints quantiles of the time from sending an answer to its acknowledgement.

use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::sync::Mutex;
use std::time::{Duration, Instant};

type Failure = Box<dyn std::error::Error + Send + Sync>;

fn post(stream: &mut BufReader<TcpStream>, path: &str, body: &str) -> Result<String, Failure> {
    let request = format!(
        "POST {path} HTTP/1.1\r\nhost: localhost\r\ncontent-type: application/json\r\ncontent-length: {}\r\n\r\n{body}",
        body.len()
    );
    stream.get_mut().write_all(request.as_bytes())?;
    let (mut status, mut length) = (String::new(), 0);
    stream.read_line(&mut status)?;
    loop {
        let mut line = String::new();
        stream.read_line(&mut line)?;
        if line.trim().is_empty() {
            break;
        }
        if let Some(value) = line.to_ascii_lowercase().strip_prefix("content-length:") {
            length = value.trim().parse()?;
        }
    }
    let mut body = vec![0; length];
    stream.read_exact(&mut body)?;
    let body = String::from_utf8(body)?;
    if status.contains(" 200 ") { Ok(body) } else { Err(format!("{status} {body}").into()) }
}

fn participant(
    address: &str,
    number: usize,
    between: Duration,
    times: &Mutex<Vec<f64>>,
) -> Result<(), Failure> {
    std::thread::sleep(between.mul_f64(number as f64 % 97.0 / 97.0));
    let stream = TcpStream::connect(address)?;
    stream.set_nodelay(true)?;
    let mut stream = BufReader::new(stream);
    let dealt = loop {
        match post(&mut stream, "/api/sessions", "{}") {
            // As the page says to whoever begins when too many do.
            Err(failure) if failure.to_string().contains(" 429 ") => {
                std::thread::sleep(Duration::from_secs(1))
            }
            dealt => break dealt?,
        }
    };
    let session: Value = serde_json::from_str(&dealt)?;
    let form = &session["form"];
    let first = form["training"].as_array().map_or(0, Vec::len) + 1;
    for (place, stimulus) in form["questions"].as_array().into_iter().flatten().enumerate() {
        std::thread::sleep(between);
        let answer = json!({ "token": session["token"], "order": first + place, "stimulus": stimulus, "choice": "L", "rt_ms": 2000 });
        let start = Instant::now();
        post(&mut stream, "/api/answers", &answer.to_string())?;
        times.lock().expect("nobody panics").push(start.elapsed().as_secs_f64() * 1e3);
    }
    post(&mut stream, "/api/finish", &json!({ "token": session["token"] }).to_string())?;
    Ok(())
}

fn main() -> Result<(), Failure> {
    let mut words = std::env::args().skip(1);
    let address = words.next().ok_or("which address?")?;
    let people: usize = words.next().ok_or("how many participants?")?.parse()?;
    let between = Duration::from_secs_f64(words.next().ok_or("how many seconds between answers?")?.parse()?);
    let (times, start) = (Mutex::new(Vec::new()), Instant::now());
    let failed = Mutex::new(0);
    std::thread::scope(|scope| {
        for number in 0..people {
            let (address, times, failed) = (&address, &times, &failed);
            scope.spawn(move || {
                if let Err(failure) = participant(address, number, between, times) {
                    eprintln!("participant {number}: {failure}");
                    *failed.lock().expect("nobody panics") += 1;
                }
            });
        }
    });
    let mut times = times.into_inner()?;
    times.sort_by(f64::total_cmp);
    let at = |share: f64| times.get((share * times.len() as f64) as usize).copied().unwrap_or(f64::NAN);
    println!(
        "{people} participants, {} answers in {:.1} s, {} failed; acknowledged in ms: median {:.1}, 90 % {:.1}, 99 % {:.1}, longest {:.1}",
        times.len(),
        start.elapsed().as_secs_f64(),
        failed.into_inner()?,
        at(0.5),
        at(0.9),
        at(0.99),
        times.last().copied().unwrap_or(f64::NAN)
    );
    Ok(())
}
