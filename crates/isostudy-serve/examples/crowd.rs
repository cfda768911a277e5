//! What one laptop can do to a study, against a server of one's own, to see that people can answer all the same:
//! `cargo run --release -p isostudy-serve --example crowd -- 127.0.0.1:8080 3000 10000 60`
//!
//! So many connections ask for an animation and never read it, each opened again when the server ends it; so many forms are asked
//! for as fast as they are dealt; all of it ends after so many seconds. `--example load` meanwhile tells what others notice.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::{IpAddr, TcpStream};
use std::time::{Duration, Instant};

type Failure = Box<dyn std::error::Error + Send + Sync>;

/// One request; status and body.
fn ask(stream: &mut BufReader<TcpStream>, request: &str) -> Result<(u16, String), Failure> {
    stream.get_mut().write_all(request.as_bytes())?;
    let (mut status, mut length) = (String::new(), 0);
    stream.read_line(&mut status)?;
    loop {
        let mut line = String::new();
        if stream.read_line(&mut line)? == 0 || line.trim().is_empty() {
            break;
        }
        if let Some(value) = line.to_ascii_lowercase().strip_prefix("content-length:") {
            length = value.trim().parse()?;
        }
    }
    let mut body = vec![0; length];
    stream.read_exact(&mut body)?;
    Ok((status.split(' ').nth(1).unwrap_or_default().parse()?, String::from_utf8(body)?))
}

fn begin(stream: &mut BufReader<TcpStream>) -> Result<(u16, String), Failure> {
    let head = "POST /api/sessions HTTP/1.1\r\nhost: localhost\r\ncontent-type: application/json\r\n";
    ask(stream, &format!("{head}content-length: 2\r\n\r\n{{}}"))
}

/// Asks for an animation, and leaves it there.
fn reader(address: &str, code: &str) -> std::io::Result<TcpStream> {
    let mut stream = TcpStream::connect(address)?;
    write!(stream, "GET /stimuli/{code}.gif HTTP/1.1\r\nhost: localhost\r\n\r\n")?;
    Ok(stream)
}

/// Keeps so many connections until the end; returns how many were opened.
fn readers(address: &str, code: &str, count: usize, end: Instant) -> usize {
    let mut open: Vec<TcpStream> = Vec::new();
    let mut opened = 0;
    while Instant::now() < end {
        // A connection that was reset has an error; one that was closed in good order would be read to its end.
        open.retain(|stream| matches!(stream.take_error(), Ok(None)));
        while open.len() < count && Instant::now() < end {
            let Ok(stream) = reader(address, code) else { break };
            open.push(stream);
            opened += 1;
        }
        std::thread::sleep(Duration::from_millis(200));
    }
    opened
}

/// Asks for so many forms, one after the other; returns how many were dealt, refused and not answered.
fn forms(address: &str, count: usize, end: Instant) -> [usize; 3] {
    let mut said = [0; 3];
    let mut stream = None;
    for _ in 0..count {
        if Instant::now() > end {
            break;
        }
        if stream.is_none() {
            stream = TcpStream::connect(address).ok().map(BufReader::new);
        }
        match stream.as_mut().map(begin) {
            Some(Ok((200, _))) => said[0] += 1,
            Some(Ok(_)) => said[1] += 1,
            _ => {
                said[2] += 1;
                stream = None;
            }
        }
    }
    said
}

fn main() -> Result<(), Failure> {
    let mut words = std::env::args().skip(1);
    let address = words.next().ok_or("which address?")?;
    let mut number = |what: &str| -> Result<usize, Failure> { Ok(words.next().ok_or(what)?.parse()?) };
    let (connections, sessions) = (number("how many connections?")?, number("how many forms?")?);
    let end = Instant::now() + Duration::from_secs(number("for how many seconds?")? as u64);
    let ip: IpAddr = address.rsplit_once(':').ok_or("which port?")?.0.parse()?;
    if !ip.is_loopback() {
        return Err("only a server on this machine, such as 127.0.0.1:8080".into());
    }
    let dealt = begin(&mut BufReader::new(TcpStream::connect(&address)?))?.1;
    let form: serde_json::Value = serde_json::from_str(&dealt)?;
    let code = form["form"]["questions"][0].as_str().ok_or("no form was dealt")?;
    let (opened, said) = std::thread::scope(|scope| {
        let readers = scope.spawn(|| readers(&address, code, connections, end));
        let said = forms(&address, sessions, end);
        (readers.join(), said)
    });
    let opened = opened.map_err(|_| "a thread failed")?;
    println!(
        "{opened} connections opened; forms: {} dealt, {} refused, {} without a reply",
        said[0], said[1], said[2]
    );
    Ok(())
}
