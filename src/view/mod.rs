//! The live view: a page in the browser, served by this program alone, behind which an eye lives.
//!
//! ```text
//! accept           a thread for each connection, at most 16
//! connection       head -> page, or WebSocket: reads messages into the wish          http, connection, message
//! pace             the eye's thread: heeds the newest wish, lives one look, shows it  pace, live, keys, reel
//! painter          a WebSocket's second thread: newest picture -> sRGB -> JPEG, PNG   painter
//! exchange         one wish and one picture between them, under one lock              exchange
//! ```
//!
//! Nobody queues: a slow page sees fewer pictures and never holds the eye up, and an eye that nobody looks at rests.
//! The server listens on 127.0.0.1 only, answers to this machine's own names only, and serves whoever says the token,
//! 128 bits from the system's source. The page names no file: it sets keys of `message::KEYS` and saves into one
//! folder.

mod connection;
mod exchange;
mod http;
mod keys;
mod live;
pub mod message;
mod pace;
mod painter;
mod reel;
mod saved;

use std::net::{Ipv4Addr, SocketAddr, TcpListener, TcpStream};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread::JoinHandle;

use crate::config::Config;
use crate::error::{Error, Result};

use connection::Service;
use exchange::Exchange;
pub use live::Live;
use pace::Pace;
pub use saved::save;

/// The most connections at a time.
const CONNECTIONS: usize = 16;

/// A server with an eye behind it. It ends when it is dropped.
pub struct View {
    address: SocketAddr,
    service: Arc<Service>,
    ends: Arc<AtomicBool>,
    threads: Vec<JoinHandle<()>>,
}

impl View {
    /// Opens what a configuration names and serves it on a port of 127.0.0.1; 0: a free one. `out`: where viewings
    /// are saved.
    ///
    /// # Errors
    /// Those of opening a run; a port that is taken.
    pub fn start(config: Config, port: u16, out: PathBuf) -> Result<View> {
        let live = Live::open(config)?;
        let refused = |e| Error::config("--port", port.to_string(), format!("cannot listen: {e}"));
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).map_err(refused)?;
        let address = listener.local_addr().map_err(refused)?;
        let exchange = Exchange::new();
        let service = Arc::new(Service { token: token()?, exchange });
        let ends = Arc::new(AtomicBool::new(false));
        let eye = spawn("eye", {
            let service = service.clone();
            move || Pace::new(live, out).live(&service.exchange)
        })?;
        let accepts = spawn("accept", {
            let (service, ends) = (service.clone(), ends.clone());
            move || accept(&listener, &service, &ends)
        })?;
        Ok(View { address, service, ends, threads: vec![eye, accepts] })
    }

    /// The address for a browser, with the token where no server and no log gets to see it.
    pub fn url(&self) -> String {
        format!("http://{}/#t={}", self.address, self.service.token)
    }
}

impl Drop for View {
    fn drop(&mut self) {
        self.ends.store(true, Ordering::SeqCst);
        self.service.exchange.close();
        // A last connection wakes the thread that accepts.
        drop(TcpStream::connect(self.address));
        for thread in self.threads.drain(..) {
            // A thread that panicked (our bug) has said so.
            let _ = thread.join();
        }
    }
}

fn spawn(name: &str, work: impl FnOnce() + Send + 'static) -> Result<JoinHandle<()>> {
    let builder = std::thread::Builder::new().name(name.into());
    builder.spawn(work).map_err(Error::io("view", "start a thread for"))
}

/// Serves connections until the end. One that the system refuses a thread for is dropped.
fn accept(listener: &TcpListener, service: &Arc<Service>, ends: &AtomicBool) {
    let count = Arc::new(AtomicUsize::new(0));
    for stream in listener.incoming() {
        if ends.load(Ordering::SeqCst) {
            return;
        }
        let Ok(stream) = stream else { continue };
        let busy = count.fetch_add(1, Ordering::SeqCst) >= CONNECTIONS;
        let (service, served) = (service.clone(), Served(count.clone()));
        let _ = spawn("page", move || {
            let _served = served;
            // Whatever went wrong with a connection has ended it.
            let _ = connection::serve(&service, stream, busy);
        });
    }
}

/// A connection that counts as long as it is served.
struct Served(Arc<AtomicUsize>);

impl Drop for Served {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::SeqCst);
    }
}

/// 128 bits that nobody can guess, in hexadecimal.
fn token() -> Result<String> {
    let mut bits = [0; 16];
    getrandom::fill(&mut bits)
        .map_err(|e| Error::file("view", format!("no random numbers: {e}")))?;
    Ok(data_encoding::HEXLOWER.encode(&bits))
}
