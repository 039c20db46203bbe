//! The live view over its own socket: what a page gets, what a stranger does not, and that neither can stop the eye.

use std::io::{Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::path::{Path, PathBuf};
use std::time::Duration;

use serde_json::{Value, json};
use sungaze::config::Config;
use sungaze::view::View;
use sungaze::view::message::Head;
use tungstenite::client::IntoClientRequest;
use tungstenite::{Message, WebSocket};

struct Server {
    view: View,
    out: tempfile::TempDir,
}

impl Server {
    fn new() -> Server {
        let out = tempfile::tempdir().unwrap();
        let toml = "[input]\nwidth = 64\n[numerics]\nmodel = \"tracked\"";
        let config = Config::parse(toml, "test", "test", Path::new(""), &[]).unwrap();
        Server { view: View::start(config, 0, out.path().join("saved")).unwrap(), out }
    }

    fn address(&self) -> SocketAddr {
        self.view.url()[7..].split_once('/').unwrap().0.parse().unwrap()
    }

    fn token(&self) -> String {
        self.view.url().split_once("#t=").unwrap().1.to_owned()
    }

    fn raw(&self, request: &str) -> String {
        let mut stream = TcpStream::connect(self.address()).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(20))).unwrap();
        stream.write_all(request.replace('\n', "\r\n").as_bytes()).unwrap();
        let mut answer = Vec::new();
        // A connection that is closed with something still unread ends in an error, behind the answer.
        let _ = stream.read_to_end(&mut answer);
        String::from_utf8_lossy(&answer).into_owned()
    }

    fn status(&self, request: &str) -> u16 {
        self.raw(request).split(' ').nth(1).unwrap_or("0").parse().unwrap()
    }

    fn socket(&self) -> Page {
        let stream = TcpStream::connect(self.address()).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(60))).unwrap();
        let mut request = format!("ws://{}/eye", self.address()).into_client_request().unwrap();
        let origin = format!("http://{}", self.address()).parse().unwrap();
        request.headers_mut().insert("Origin", origin);
        Page { socket: tungstenite::client(request, stream).unwrap().0 }
    }

    fn page(&self) -> Page {
        let mut page = self.socket();
        page.say(json!({ "hello": self.token() }));
        page
    }
}

struct Page {
    socket: WebSocket<TcpStream>,
}

/// A picture as it arrives.
struct Shown {
    bytes: Vec<u8>,
}

impl Shown {
    fn u32(&self, at: usize) -> u32 {
        u32::from_le_bytes(self.bytes[at..at + 4].try_into().unwrap())
    }

    fn id(&self) -> u32 {
        self.u32(8)
    }

    fn time(&self) -> f64 {
        f64::from_le_bytes(self.bytes[24..32].try_into().unwrap())
    }

    fn playing(&self) -> bool {
        self.bytes[17] == 1
    }

    /// Whether it is the exact picture that the page rests on.
    fn lasts(&self) -> bool {
        self.bytes[16] == 2
    }

    fn picture(&self) -> &[u8] {
        &self.bytes[Head::LENGTH..]
    }
}

impl Page {
    fn say(&mut self, message: Value) {
        self.socket.send(Message::Text(message.to_string().into())).unwrap();
    }

    /// The next message; every picture is thanked for.
    fn next(&mut self) -> Result<Shown, Value> {
        loop {
            match self.socket.read().unwrap() {
                Message::Binary(bytes) => {
                    let shown = Shown { bytes: bytes.to_vec() };
                    assert_eq!(&shown.bytes[..4], b"SGZ1");
                    self.say(json!({ "shown": shown.u32(4) }));
                    return Ok(shown);
                }
                Message::Text(text) => return Err(serde_json::from_str(&text).unwrap()),
                _ => {}
            }
        }
    }

    fn picture(&mut self, wanted: impl Fn(&Shown) -> bool) -> Shown {
        loop {
            if let Ok(shown) = self.next()
                && wanted(&shown)
            {
                return shown;
            }
        }
    }

    fn words(&mut self, kind: &str) -> Value {
        loop {
            if let Err(words) = self.next()
                && !words[kind].is_null()
            {
                return words[kind].clone();
            }
        }
    }

    fn is_closed(&mut self) -> bool {
        loop {
            match self.socket.read() {
                Ok(Message::Close(_)) | Err(_) => return true,
                Ok(Message::Binary(_)) => return false,
                Ok(_) => {}
            }
        }
    }
}

fn decoded(png: &[u8]) -> (usize, usize, Vec<u8>) {
    sungaze::frames::decode_png(png).expect("an eye at rest is shown as PNG")
}

#[test]
fn a_page_gets_a_picture_at_once_and_every_look_is_answered() {
    let server = Server::new();
    let mut page = server.page();
    let first = page.picture(|_| true);
    assert_eq!((first.time(), first.playing()), (0.0, false));
    assert_eq!(&decoded(first.picture()).0, &64);
    page.say(json!({ "look": [0.25, 0.5], "id": 7 }));
    assert_eq!(page.picture(|shown| shown.id() >= 7).id(), 7);
    page.say(json!({ "play": true }));
    let jpeg = page.picture(Shown::playing);
    assert_eq!(jpeg.picture()[..2], [0xff, 0xd8], "JPEG while time runs");
}

#[test]
fn time_stands_still_at_rest_and_runs_as_fast_as_it_is_told() {
    let server = Server::new();
    let mut page = server.page();
    page.say(json!({ "play": true, "speed": 100 }));
    let ran = page.picture(|shown| shown.time() > 3.0);
    assert!(ran.playing());
    page.say(json!({ "play": false }));
    let stopped = page.picture(|shown| shown.lasts());
    page.say(json!({ "before": true }));
    assert_eq!(page.picture(|_| true).time(), stopped.time(), "asking changes no time");
    page.say(json!({ "scrub": 0.0 }));
    assert_eq!(page.picture(|shown| shown.lasts() && shown.time() == 0.0).time(), 0.0);
    page.say(json!({ "scrub": 1e9 }));
    assert!(!page.words("history").as_array().unwrap().is_empty(), "told before the picture");
    page.picture(|shown| shown.lasts() && shown.time() == stopped.time());
    page.say(json!({ "rest": true }));
    assert_eq!(page.picture(|shown| shown.time() == 0.0).time(), 0.0);
}

#[test]
fn going_back_shows_the_very_picture_that_was_there() {
    let server = Server::new();
    let mut page = server.page();
    page.say(json!({ "play": true, "speed": 20 }));
    page.picture(|shown| shown.time() > 1.0);
    page.say(json!({ "play": false, "look": [0.3, 0.3], "id": 1 }));
    let then = page.picture(|shown| shown.lasts() && shown.id() == 1);
    page.say(json!({ "play": true, "look": [0.8, 0.2], "id": 2 }));
    page.picture(|shown| shown.time() > then.time() + 2.0);
    page.say(json!({ "scrub": then.time() }));
    let again = page.picture(|shown| shown.lasts() && shown.time() <= then.time());
    assert_eq!(again.time(), then.time());
    assert_eq!(decoded(again.picture()), decoded(then.picture()));
}

#[test]
fn strangers_are_refused() {
    let server = Server::new();
    let (own, token) = (server.address(), server.token());
    let get = |host: &str| format!("GET / HTTP/1.1\nHost: {host}\n\n");
    assert_eq!(server.status(&get(&own.to_string())), 200);
    assert_eq!(server.status(&get("localhost:9000")), 200, "a forwarded port");
    for host in ["evil.example", "127.0.0.1.evil.example", "127.0.0.1@evil.example"] {
        assert_eq!(server.status(&get(host)), 421, "{host}");
    }
    let upgrade = "Connection: Upgrade\nUpgrade: websocket\nSec-WebSocket-Version: 13\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\n";
    for origin in
        ["", "Origin: http://evil.example\n", "Origin: null\n", "Origin: http://127.0.0.1:1\n"]
    {
        let request = format!("GET /eye HTTP/1.1\nHost: {own}\n{upgrade}{origin}\n");
        assert_eq!(server.status(&request), 403, "{origin}");
    }
    let wrong = [
        json!({}),
        json!({ "hello": "" }),
        json!({ "hello": token[1..] }),
        json!({ "look": [0.5, 0.5] }),
    ];
    for hello in wrong {
        let mut page = server.socket();
        page.say(hello.clone());
        assert!(page.is_closed(), "{hello}");
    }
    assert_eq!(server.page().picture(|_| true).time(), 0.0, "the eye lives on");
}

#[test]
fn the_page_may_not_be_framed_stored_or_load_anything() {
    let server = Server::new();
    let answer = server.raw(&format!("GET / HTTP/1.1\nHost: {}\n\n", server.address()));
    for header in
        ["frame-ancestors 'none'", "X-Frame-Options: DENY", "no-referrer", "no-store", "nosniff"]
    {
        assert!(answer.contains(header), "{header}");
    }
    let socket = format!("connect-src 'self' ws://{};", server.address());
    assert!(answer.contains(&socket), "the page may open its own socket in any browser");
    let forwarded = server.raw("GET / HTTP/1.1\nHost: localhost:9000\n\n");
    assert!(forwarded.contains("connect-src 'self' ws://localhost:9000;"));
    assert!(!answer.contains(&server.token()), "the token is in the address alone");
}

#[test]
fn broken_and_huge_messages_stop_nothing() {
    let server = Server::new();
    let mut page = server.page();
    let nonsense = [
        "",
        "{",
        "null",
        "{\"look\":[2,2]}",
        "{\"look\":\"up\"}",
        "{\"set\":{\"input.frames\":\"/etc/passwd\"}}",
        "{\"save\":\"/etc/x\"}",
    ];
    for text in nonsense {
        page.socket.send(Message::Text(text.into())).unwrap();
    }
    assert!(page.words("note").is_string());
    page.say(json!({ "set": { "observer.age": -5 } }));
    while !page.words("note").as_str().unwrap().contains("observer.age") {}
    page.say(json!({ "look": [0.1, 0.9], "id": 3 }));
    assert_eq!(page.picture(|shown| shown.id() == 3).id(), 3);
    let _ = page.socket.send(Message::Text("x".repeat(70_000).into()));
    while !page.is_closed() {}
    assert!(server.page().picture(|_| true).time() > 0.0, "the eye lives on");
}

#[test]
fn a_page_that_reads_nothing_and_a_thousand_connections_stop_nothing() {
    let server = Server::new();
    let mut deaf = server.page();
    deaf.say(json!({ "play": true, "speed": 100 }));
    let mut idle = Vec::new();
    for _ in 0..1000 {
        idle.truncate(200);
        idle.insert(0, TcpStream::connect(server.address()).unwrap());
    }
    drop(idle);
    // Those that came first may still hold their places for as long as a head may take.
    let busy = || server.status(&format!("GET / HTTP/1.1\nHost: {}\n\n", server.address())) == 503;
    while busy() {
        std::thread::sleep(Duration::from_millis(50));
    }
    let mut page = server.page();
    page.say(json!({ "look": [0.6, 0.6], "id": 9 }));
    assert_eq!(page.picture(|shown| shown.id() == 9).id(), 9);
    while deaf.next().is_ok_and(|_| true) {}
}

#[test]
fn a_second_page_takes_over_and_the_first_is_told() {
    let server = Server::new();
    let mut first = server.page();
    first.picture(|_| true);
    let mut second = server.page();
    assert_eq!(first.words("taken"), json!(true));
    assert!(first.is_closed());
    second.say(json!({ "look": [0.4, 0.4], "id": 5 }));
    assert_eq!(second.picture(|shown| shown.id() == 5).id(), 5);
}

#[test]
fn a_page_that_outlives_the_program_is_told_of_no_other_page() {
    let server = Server::new();
    let mut page = server.page();
    page.picture(|_| true);
    drop(server);
    while let Ok(message) = page.socket.read() {
        assert!(!message.to_string().contains("taken"), "{message}");
        if message.is_close() {
            break;
        }
    }
}

#[test]
fn a_changed_observer_lives_the_same_path_once_more() {
    let server = Server::new();
    let mut page = server.page();
    page.say(json!({ "play": true, "speed": 10 }));
    page.picture(|shown| shown.time() > 1.0);
    page.say(json!({ "play": false }));
    let young = page.picture(|shown| shown.lasts());
    page.say(json!({ "set": { "observer.half_bleach_log_td": [6.0, 6.0, 6.0] } }));
    let other = page.picture(|shown| shown.lasts() && shown.time() == young.time());
    assert_ne!(decoded(other.picture()), decoded(young.picture()));
    page.say(json!({ "set": { "observer.half_bleach_log_td": null } }));
    let again = page.picture(|shown| {
        shown.lasts() && shown.time() == young.time() && shown.picture() != other.picture()
    });
    assert_eq!(decoded(again.picture()), decoded(young.picture()));
}

#[test]
fn what_is_saved_is_replayed_by_a_run_to_the_picture_that_was_shown_and_opens_again() {
    let server = Server::new();
    let mut page = server.page();
    page.say(json!({ "play": true, "speed": 20 }));
    page.picture(|shown| shown.time() > 2.0);
    page.say(json!({ "play": false, "look": [0.2, 0.7], "id": 1 }));
    let shown = page.picture(|shown| shown.lasts() && shown.id() == 1);
    page.say(json!({ "save": true }));
    let saved = page.words("saved");
    let (out, name) = (saved["folder"].as_str().unwrap(), saved["name"].as_str().unwrap());
    let path = PathBuf::from(out).join(name).join(format!("{name}.toml"));
    let config = Config::load(Some(&path), &[]).unwrap();
    let out = server.out.path().join("run");
    sungaze::run::run(&config, &out, Default::default(), &sungaze::run::Unwatched).unwrap();
    let last = out.join(format!("display.{:04}.png", saved["looks"].as_u64().unwrap()));
    assert_eq!(decoded(&std::fs::read(last).unwrap()), decoded(shown.picture()));
    page.say(json!({ "rest": true }));
    page.picture(|shown| shown.time() == 0.0);
    page.say(json!({ "open": saved["name"] }));
    let opened = page.picture(|again| again.lasts() && again.time() == shown.time());
    assert_eq!(decoded(opened.picture()), decoded(shown.picture()));
    page.say(json!({ "open": "../saved" }));
    while !page.words("note").as_str().unwrap().contains("no saved viewing") {}
}
