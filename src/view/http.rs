//! HTTP, as far as one page needs it: a request's head, who may ask, and answers.
//!
//! Only programs on this machine can reach the server, but a browser carries any site's requests to it. So the name
//! that was asked for (`Host`) must be this machine's own, compared whole: a foreign name that resolves to 127.0.0.1
//! is refused. Its port is not compared, so that `ssh -L 9000:127.0.0.1:8765` works. A WebSocket must come from
//! the very origin that it asks.

use std::io::{Error, ErrorKind, Read, Result, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

/// The longest head of a request, bytes.
const LONGEST: usize = 16 << 10;
/// The most lines of a head.
const MOST: usize = 64;
/// How long a head may take to arrive.
const PATIENCE: Duration = Duration::from_secs(5);

/// What a request's head says, as far as it matters here.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Head {
    pub(crate) method: String,
    pub(crate) path: String,
    hosts: Vec<String>,
    origins: Vec<String>,
    key: Option<String>,
    upgrades: bool,
    /// Bytes that came after the head.
    pub(crate) rest: Vec<u8>,
}

/// An answer without a body of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Status {
    BadRequest,
    Forbidden,
    NotFound,
    NotGet,
    Misdirected,
    HeadTooLong,
    Busy,
}

impl Status {
    fn line(self) -> &'static str {
        match self {
            Status::BadRequest => "400 Bad Request",
            Status::Forbidden => "403 Forbidden",
            Status::NotFound => "404 Not Found",
            Status::NotGet => "405 Method Not Allowed",
            Status::Misdirected => "421 Misdirected Request",
            Status::HeadTooLong => "431 Request Header Fields Too Large",
            Status::Busy => "503 Service Unavailable",
        }
    }
}

/// What may be had.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Wanted {
    /// The page, by the name and port that it was asked for.
    Page(String),
    /// The WebSocket, by its client's key.
    Eye(String),
}

/// Reads a head.
///
/// # Errors
/// The connection's, or its end; a head that does not arrive in time.
pub(crate) fn head(stream: &mut TcpStream) -> Result<std::result::Result<Head, Status>> {
    let (begun, mut bytes) = (Instant::now(), Vec::new());
    loop {
        match parsed(&bytes) {
            Ok(None) if bytes.len() >= LONGEST => return Ok(Err(Status::HeadTooLong)),
            Ok(None) => {}
            Ok(Some(head)) => return Ok(Ok(head)),
            Err(status) => return Ok(Err(status)),
        }
        let left = PATIENCE.saturating_sub(begun.elapsed());
        if left.is_zero() {
            return Err(Error::from(ErrorKind::TimedOut));
        }
        stream.set_read_timeout(Some(left))?;
        let mut room = [0; 2048];
        match stream.read(&mut room)? {
            0 => return Err(Error::from(ErrorKind::UnexpectedEof)),
            n => bytes.extend_from_slice(&room[..n]),
        }
    }
}

/// The head in these bytes; `None` while it is not whole.
fn parsed(bytes: &[u8]) -> std::result::Result<Option<Head>, Status> {
    let mut room = [httparse::EMPTY_HEADER; MOST];
    let mut request = httparse::Request::new(&mut room);
    let length = match request.parse(bytes) {
        Ok(httparse::Status::Complete(length)) => length,
        Ok(httparse::Status::Partial) => return Ok(None),
        Err(httparse::Error::TooManyHeaders) => return Err(Status::HeadTooLong),
        Err(_) => return Err(Status::BadRequest),
    };
    let all = |name: &str| -> Vec<String> {
        let named = request.headers.iter().filter(|h| h.name.eq_ignore_ascii_case(name));
        named.map(|h| String::from_utf8_lossy(h.value).trim().to_owned()).collect()
    };
    let says = |name: &str, word: &str| {
        all(name).iter().flat_map(|v| v.split(',')).any(|v| v.trim().eq_ignore_ascii_case(word))
    };
    Ok(Some(Head {
        method: request.method.unwrap_or_default().to_owned(),
        path: request.path.unwrap_or_default().to_owned(),
        upgrades: says("upgrade", "websocket")
            && says("connection", "upgrade")
            && says("sec-websocket-version", "13"),
        key: all("sec-websocket-key").pop(),
        hosts: all("host"),
        origins: all("origin"),
        rest: bytes[length..].to_vec(),
    }))
}

impl Head {
    /// What is wanted, if it may be had.
    ///
    /// # Errors
    /// The status to answer with.
    pub(crate) fn wanted(&self) -> std::result::Result<Wanted, Status> {
        let [host] = &self.hosts[..] else { return Err(Status::Misdirected) };
        if !is_this_machine(host) {
            return Err(Status::Misdirected);
        }
        if self.method != "GET" {
            return Err(Status::NotGet);
        }
        match self.path.as_str() {
            "/" => Ok(Wanted::Page(host.clone())),
            "/eye" => self.eye(host),
            _ => Err(Status::NotFound),
        }
    }

    fn eye(&self, host: &str) -> std::result::Result<Wanted, Status> {
        let own = matches!(&self.origins[..], [origin] if *origin == format!("http://{host}"));
        match (own, self.upgrades, &self.key) {
            (false, ..) => Err(Status::Forbidden),
            (true, true, Some(key)) => Ok(Wanted::Eye(key.clone())),
            _ => Err(Status::BadRequest),
        }
    }
}

/// Whether a name, with or without a port, is this machine's own.
fn is_this_machine(host: &str) -> bool {
    let names = ["127.0.0.1", "localhost", "[::1]"];
    let port = |rest: &str| {
        let digits = rest.strip_prefix(':').unwrap_or("none");
        rest.is_empty()
            || digits.parse::<u16>().is_ok() && digits.bytes().all(|b| b.is_ascii_digit())
    };
    names.iter().any(|name| {
        host.get(..name.len()).is_some_and(|head| head.eq_ignore_ascii_case(name))
            && port(&host[name.len()..])
    })
}

/// Answers with a status alone.
pub(crate) fn refuse(stream: &mut TcpStream, status: Status) -> Result<()> {
    let line = status.line();
    let length = line.len() + 1;
    write!(
        stream,
        "HTTP/1.1 {line}\r\nContent-Type: text/plain\r\nContent-Length: {length}\r\nConnection: close\r\n\r\n{line}\n"
    )
}

/// Answers with the page. Its own policy says what it may load; nobody may frame it.
pub(crate) fn send_page(stream: &mut TcpStream, page: &str) -> Result<()> {
    let length = page.len();
    write!(
        stream,
        "HTTP/1.1 200 OK\r\nContent-Type: text/html; charset=utf-8\r\nContent-Length: {length}\r\n\
         Content-Security-Policy: frame-ancestors 'none'\r\nX-Frame-Options: DENY\r\n\
         X-Content-Type-Options: nosniff\r\nReferrer-Policy: no-referrer\r\n\
         Cross-Origin-Resource-Policy: same-origin\r\nCache-Control: no-store\r\nConnection: close\r\n\r\n"
    )?;
    stream.write_all(page.as_bytes())
}

/// Answers a WebSocket's key.
pub(crate) fn switch(stream: &mut TcpStream, key: &str) -> Result<()> {
    let accept = tungstenite::handshake::derive_accept_key(key.as_bytes());
    write!(
        stream,
        "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n\
         Sec-WebSocket-Accept: {accept}\r\n\r\n"
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::result::Result;

    fn wanted(text: &str) -> Result<Wanted, Status> {
        parsed(text.replace('\n', "\r\n").as_bytes()).transpose().unwrap().unwrap().wanted()
    }

    fn page(host: &str) -> Result<Wanted, Status> {
        wanted(&format!("GET / HTTP/1.1\nHost: {host}\n\n"))
    }

    fn eye(headers: &str) -> Result<Wanted, Status> {
        let upgrade =
            "Upgrade: WebSocket\nConnection: keep-alive, Upgrade\nSec-WebSocket-Version: 13\n";
        wanted(&format!("GET /eye HTTP/1.1\n{upgrade}Sec-WebSocket-Key: abc\n{headers}\n"))
    }

    #[test]
    fn only_this_machines_own_names_are_answered_at_any_port() {
        for host in ["127.0.0.1", "127.0.0.1:80", "localhost:9000", "LOCALHOST", "[::1]:8765"] {
            assert_eq!(page(host), Ok(Wanted::Page(host.into())), "{host}");
        }
        let foreign = [
            "evil.example",
            "127.0.0.1.evil.example",
            "localhost.evil.example:80",
            "127.0.0.1:80@evil.example",
        ];
        for host in foreign.into_iter().chain([
            "",
            "127.0.0.1:",
            "127.0.0.1:+80",
            "127.0.0.1:99999",
            "0.0.0.0",
            "[::1",
            "::1",
        ]) {
            assert_eq!(page(host), Err(Status::Misdirected), "{host}");
        }
        assert_eq!(wanted("GET / HTTP/1.1\n\n"), Err(Status::Misdirected));
        let two = "GET / HTTP/1.1\nHost: localhost\nHost: evil.example\n\n";
        assert_eq!(wanted(two), Err(Status::Misdirected));
    }

    #[test]
    fn the_eye_is_for_the_page_that_this_server_sent() {
        let own = "Host: localhost:9000\nOrigin: http://localhost:9000\n";
        assert_eq!(eye(own), Ok(Wanted::Eye("abc".into())));
        for origin in [
            "",
            "Origin: null\n",
            "Origin: http://evil.example\n",
            "Origin: http://localhost:3000\n",
            "Origin: https://localhost:9000\n",
        ] {
            assert_eq!(
                eye(&format!("Host: localhost:9000\n{origin}")),
                Err(Status::Forbidden),
                "{origin}"
            );
        }
        assert_eq!(
            eye("Host: evil.example\nOrigin: http://evil.example\n"),
            Err(Status::Misdirected)
        );
    }

    #[test]
    fn nothing_but_the_page_and_the_eye_is_there() {
        assert_eq!(
            wanted("GET /../etc/passwd HTTP/1.1\nHost: localhost\n\n"),
            Err(Status::NotFound)
        );
        assert_eq!(wanted("POST / HTTP/1.1\nHost: localhost\n\n"), Err(Status::NotGet));
        let plain = "GET /eye HTTP/1.1\nHost: localhost\nOrigin: http://localhost\n\n";
        assert_eq!(wanted(plain), Err(Status::BadRequest));
    }

    #[test]
    fn a_head_may_be_in_pieces_but_neither_broken_nor_endless() {
        assert_eq!(parsed(b"GET / HTTP/1.1\r\nHost: loc"), Ok(None));
        assert_eq!(parsed(b"\x16\x03\x01\x02\x00"), Err(Status::BadRequest));
        let many = format!("GET / HTTP/1.1\r\n{}\r\n", "a: b\r\n".repeat(MOST + 1));
        assert_eq!(parsed(many.as_bytes()), Err(Status::HeadTooLong));
    }
}
