//! Where the eye's thread and the page's threads meet: one slot each way, under one lock.
//!
//! A newer picture replaces one that nobody has taken, a newer wish one that the eye has not heeded, a newer note one
//! of its kind. So nothing here grows, and nobody waits for anybody slower.

use std::collections::BTreeMap;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use super::message::{Message, Wish};

/// The most pictures on their way to a page.
const CREDITS: u8 = 2;
/// A page that has shown nothing for so long is not being looked at.
const ABSENT: Duration = Duration::from_secs(2);

/// The meeting place. `P`: what the eye shows.
pub(crate) struct Exchange<P> {
    inside: Mutex<Inside<P>>,
    changed: Condvar,
}

struct Inside<P> {
    wish: Wish,
    picture: Option<(u32, Arc<P>)>,
    notes: BTreeMap<&'static str, Value>,
    /// The page that is served; 0: none.
    page: u64,
    pages: u64,
    credits: u8,
    /// When the page last showed a picture.
    shown: Instant,
    closed: bool,
}

/// What is to be sent to a page next.
pub(crate) enum Next<P> {
    Picture(u32, Arc<P>),
    Note(String),
    /// Another page has taken over.
    Taken,
    /// The page has gone, or the server ends.
    End,
}

impl<P> Exchange<P> {
    pub(crate) fn new() -> Self {
        let inside = Inside {
            wish: Wish::default(),
            picture: None,
            notes: BTreeMap::new(),
            page: 0,
            pages: 0,
            credits: 0,
            shown: Instant::now(),
            closed: false,
        };
        Exchange { inside: Mutex::new(inside), changed: Condvar::new() }
    }

    /// Nothing is done under the lock that could leave it half-changed.
    fn lock(&self) -> MutexGuard<'_, Inside<P>> {
        self.inside.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn change<T>(&self, change: impl FnOnce(&mut Inside<P>) -> T) -> T {
        let result = change(&mut self.lock());
        self.changed.notify_all();
        result
    }

    /// A page comes and takes over. Returns its number.
    pub(crate) fn come(&self) -> u64 {
        self.change(|inside| {
            inside.pages += 1;
            inside.page = inside.pages;
            (inside.credits, inside.shown) = (CREDITS, Instant::now());
            inside.wish.hello = true;
            inside.page
        })
    }

    /// A page goes.
    pub(crate) fn go(&self, page: u64) {
        self.change(|inside| inside.page = if inside.page == page { 0 } else { inside.page });
    }

    /// A page asks for something; one that is no longer served is not heard.
    pub(crate) fn ask(&self, page: u64, message: Message) {
        self.change(|inside| {
            if inside.page != page {
                return;
            }
            if message.shown.is_some() {
                (inside.credits, inside.shown) = (CREDITS.min(inside.credits + 1), Instant::now());
            }
            inside.wish.add(message);
        });
    }

    /// The eye shows a picture. Returns the one before, if nobody else has it.
    pub(crate) fn show(&self, picture: P) -> Option<P> {
        self.change(|inside| {
            let seq = inside.picture.as_ref().map_or(1, |(seq, _)| seq.wrapping_add(1));
            let old = inside.picture.replace((seq, Arc::new(picture)));
            old.and_then(|(_, old)| Arc::into_inner(old))
        })
    }

    /// The eye says something, in place of the last of its kind.
    pub(crate) fn say(&self, kind: &'static str, what: Value) {
        self.change(|inside| inside.notes.insert(kind, what));
    }

    /// The wish that is waiting. While the eye is at rest, or nobody looks, it waits for one; `None`: the end.
    pub(crate) fn heed(&self, at_rest: bool) -> Option<Wish> {
        let mut inside = self.lock();
        loop {
            let absent =
                inside.page == 0 || (inside.credits == 0 && inside.shown.elapsed() > ABSENT);
            if inside.closed {
                return None;
            }
            if !inside.wish.is_empty() || !(at_rest || absent) {
                return Some(std::mem::take(&mut inside.wish));
            }
            inside = self.changed.wait(inside).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// What to send to a page that was last sent the picture `seq`; waits for it. Taking a picture costs a credit.
    pub(crate) fn next(&self, page: u64, seq: u32) -> Next<P> {
        let mut inside = self.lock();
        loop {
            if inside.closed || inside.page == 0 {
                return Next::End;
            }
            if inside.page != page {
                return Next::Taken;
            }
            if let Some((kind, what)) = inside.notes.pop_first() {
                return Next::Note(json!({ kind: what }).to_string());
            }
            match &inside.picture {
                Some((newest, picture)) if *newest != seq && inside.credits > 0 => {
                    let next = Next::Picture(*newest, picture.clone());
                    inside.credits -= 1;
                    return next;
                }
                _ => {}
            }
            inside = self.changed.wait(inside).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Ends everything that waits here.
    pub(crate) fn close(&self) {
        self.change(|inside| inside.closed = true);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seen(next: Next<i32>) -> Option<(u32, i32)> {
        match next {
            Next::Picture(seq, picture) => Some((seq, *picture)),
            _ => None,
        }
    }

    #[test]
    fn of_many_pictures_the_newest_is_sent_and_no_more_than_there_are_credits() {
        let exchange = Exchange::new();
        let page = exchange.come();
        for i in 1..=50 {
            exchange.show(i);
        }
        assert_eq!(seen(exchange.next(page, 0)), Some((50, 50)));
        exchange.show(51);
        assert_eq!(seen(exchange.next(page, 50)), Some((51, 51)));
        exchange.show(52);
        exchange.say("note", json!("no credit"));
        assert!(matches!(exchange.next(page, 51), Next::Note(_)), "words cost nothing");
        exchange.ask(page, Message { shown: Some(50), ..Message::default() });
        assert_eq!(seen(exchange.next(page, 51)), Some((52, 52)));
    }

    #[test]
    fn a_second_page_takes_over_and_the_first_is_no_longer_heard() {
        let exchange = Exchange::<i32>::new();
        let (first, second) = (exchange.come(), exchange.come());
        assert!(matches!(exchange.next(first, 0), Next::Taken));
        exchange.ask(first, Message { speed: Some(50.0), ..Message::default() });
        exchange.ask(second, Message { speed: Some(2.0), ..Message::default() });
        assert_eq!(exchange.heed(true).unwrap().speed, Some(2.0));
        exchange.go(first);
        assert!(exchange.heed(false).is_some(), "the second still looks");
    }

    #[test]
    fn the_eye_waits_while_nobody_looks_and_ends_with_the_server() {
        let exchange = Arc::new(Exchange::<i32>::new());
        let eye = std::thread::spawn({
            let exchange = exchange.clone();
            move || {
                let woken = exchange.heed(false).map(|wish| wish.play);
                (woken, exchange.heed(true))
            }
        });
        let page = exchange.come();
        exchange.ask(page, Message { play: Some(true), ..Message::default() });
        while !exchange.lock().wish.is_empty() {
            std::thread::yield_now();
        }
        exchange.close();
        let (woken, after) = eye.join().unwrap();
        assert!(woken.is_some() && after.is_none());
    }
}
