//! One connection: a page's head and answer, or the WebSocket of the page that is served.
//!
//! A WebSocket has two threads: this one reads, another paints and writes. They share the socket but nothing else:
//! what the protocol would answer while reading (to a ping, to a close) is swallowed, for the writer alone writes.

use std::io::{Read, Result, Write};
use std::net::TcpStream;
use std::time::Duration;

use tungstenite::protocol::{Role, WebSocketConfig};
use tungstenite::{Bytes, Message as Frame, WebSocket};

use super::exchange::{Exchange, Next};
use super::http::{self, Status, Wanted};
use super::message::Message;
use super::painter::{Painter, Picture};
use crate::page;

/// The longest message of a page, bytes.
const LONGEST: usize = 64 << 10;
/// How long a page may take to say its token, and a socket to take what it is sent.
const PATIENCE: Duration = Duration::from_secs(5);

/// What connections share.
pub(crate) struct Service {
    pub(crate) token: String,
    pub(crate) exchange: Exchange<Picture>,
}

/// Serves one connection to its end. Whatever goes wrong with it ends it and nothing else.
pub(crate) fn serve(service: &Service, mut stream: TcpStream, busy: bool) -> Result<()> {
    stream.set_write_timeout(Some(PATIENCE))?;
    stream.set_nodelay(true)?;
    if busy {
        return http::refuse(&mut stream, Status::Busy);
    }
    let head = http::head(&mut stream)?;
    match head.and_then(|head| Ok((head.wanted()?, head.rest))) {
        Err(status) => http::refuse(&mut stream, status),
        Ok((Wanted::Page(host), _)) => http::send_page(&mut stream, &page::live(&host)),
        Ok((Wanted::Eye(key), rest)) => {
            http::switch(&mut stream, &key)?;
            stream.set_read_timeout(Some(PATIENCE))?;
            talk(service, stream, rest)
        }
    }
}

/// A socket to read from: what is written to it goes nowhere.
struct ReadHalf(TcpStream);

impl Read for ReadHalf {
    fn read(&mut self, room: &mut [u8]) -> Result<usize> {
        self.0.read(room)
    }
}

impl Write for ReadHalf {
    fn write(&mut self, bytes: &[u8]) -> Result<usize> {
        Ok(bytes.len())
    }

    fn flush(&mut self) -> Result<()> {
        Ok(())
    }
}

fn talk(service: &Service, stream: TcpStream, rest: Vec<u8>) -> Result<()> {
    let limits =
        WebSocketConfig::default().max_message_size(Some(LONGEST)).max_frame_size(Some(LONGEST));
    let reads = ReadHalf(stream.try_clone()?);
    let mut reads = WebSocket::from_partially_read(reads, rest, Role::Server, Some(limits));
    let knows = matches!(text(&mut reads).map(|text| Message::read(&text)),
        Some(Ok(Message { hello: Some(token), .. })) if same(&token, &service.token));
    if !knows {
        return stream.shutdown(std::net::Shutdown::Both);
    }
    stream.set_read_timeout(None)?;
    let page = service.exchange.come();
    std::thread::scope(|threads| {
        let writer = std::thread::Builder::new().spawn_scoped(threads, || {
            // A page that is gone has no use for the reason.
            let _ = write(service, stream.try_clone()?, page);
            stream.shutdown(std::net::Shutdown::Both)
        });
        if let Err(error) = writer {
            service.exchange.go(page);
            return Err(error);
        }
        while let Some(text) = text(&mut reads) {
            match Message::read(&text) {
                Ok(message) => service.exchange.ask(page, message),
                Err(problem) => service.exchange.say("note", problem.into()),
            }
        }
        service.exchange.go(page);
        Ok(())
    })
}

/// The next text of a page; `None` at its end, and when it sends anything else.
fn text(reads: &mut WebSocket<ReadHalf>) -> Option<String> {
    loop {
        match reads.read().ok()? {
            Frame::Text(text) => return Some(text.to_string()),
            Frame::Ping(_) | Frame::Pong(_) => {}
            _ => return None,
        }
    }
}

/// Compares two texts in a time that does not tell where they differ.
fn same(a: &str, b: &str) -> bool {
    a.len() == b.len() && a.bytes().zip(b.bytes()).fold(0, |differ, (a, b)| differ | (a ^ b)) == 0
}

/// Sends what the eye shows and says, as long as this page is served.
fn write(service: &Service, stream: TcpStream, page: u64) -> tungstenite::Result<()> {
    let mut socket = WebSocket::from_raw_socket(stream, Role::Server, None);
    let (mut painter, mut sent) = (Painter::default(), 0);
    loop {
        match service.exchange.next(page, sent) {
            Next::Picture(seq, picture) => {
                sent = seq;
                socket.send(Frame::Binary(Bytes::from(painter.paint(seq, &picture)?)))?;
            }
            Next::Note(note) => socket.send(Frame::Text(note.into()))?,
            Next::Taken => {
                socket.send(Frame::Text("{\"taken\":true}".into()))?;
                return socket.close(None);
            }
            Next::End => return socket.close(None),
        }
    }
}
