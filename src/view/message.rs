//! Messages between the page and the eye, over one WebSocket.
//!
//! ```text
//! page -> eye   {"hello": token}                    first; anything else before it closes the socket
//!               {"look": [x, y], "id": n}           fractions of the picture, from the top left
//!               {"play": true} {"speed": 10} {"scrub": seconds} {"rest": true} {"before": true}
//!               {"set": {"observer.age": 60}}       keys of the configuration
//!               {"shown": seq}                      one credit back, once the picture is on the screen
//!               {"save": true} {"open": name}
//! eye -> page   text: {"note"}, {"lived"}, {"history"}, {"settings"}, {"saved"}, {"taken"}
//!               binary: a head of 72 bytes, little-endian, then the picture
//!               u32 'SGZ1' | u32 seq | u32 id applied | u16 width, height | u8 form | u8 playing | u16 0 | u32 0
//!               | f64 time | f64 duration | f32 p[3] | f32 pupil mm | f32 fovea cd/m2 | f32 gaze[2] | f32 0
//! ```

use std::collections::BTreeMap;

use serde::Deserialize;
use serde_json::Value;

/// The fastest that time runs.
pub(crate) const FASTEST: f64 = 100.0;

/// Keys that a page may set: the eye's, its optics' and the display's, and none that names a file.
pub(crate) const KEYS: [&str; 14] = [
    "observer.age",
    "observer.pupil",
    "observer.pupil_mm",
    "observer.constants",
    "observer.half_bleach_log_td",
    "observer.tau_s",
    "observer.stiles_crawford",
    "observer.pigmentation",
    "optics.psf",
    "optics.straylight",
    "optics.draw",
    "display.tone",
    "display.exposure_ev",
    "display.highlights",
];

/// What a page says.
#[derive(Clone, Debug, Default, Deserialize, PartialEq)]
#[serde(default, deny_unknown_fields)]
pub(crate) struct Message {
    pub(crate) hello: Option<String>,
    pub(crate) look: Option<[f64; 2]>,
    pub(crate) id: Option<u32>,
    pub(crate) play: Option<bool>,
    pub(crate) speed: Option<f64>,
    pub(crate) scrub: Option<f64>,
    pub(crate) rest: bool,
    pub(crate) before: Option<bool>,
    pub(crate) set: BTreeMap<String, Value>,
    pub(crate) shown: Option<u32>,
    pub(crate) save: bool,
    pub(crate) open: Option<String>,
}

impl Message {
    /// Reads a message.
    ///
    /// # Errors
    /// What is wrong with it.
    pub(crate) fn read(text: &str) -> Result<Message, String> {
        if !text.trim_start().starts_with('{') {
            return Err("not understood; accepted: a JSON object".into());
        }
        let message: Message =
            serde_json::from_str(text).map_err(|e| format!("not understood: {e}"))?;
        let inside = |at: [f64; 2]| at.iter().all(|v| (0.0..=1.0).contains(v));
        if message.look.is_some_and(|at| !inside(at)) {
            return Err("look: accepted: two fractions of the picture, 0 to 1".into());
        }
        if message.speed.is_some_and(|speed| !(1.0..=FASTEST).contains(&speed)) {
            return Err(format!("speed: accepted: 1 to {FASTEST}"));
        }
        if message.scrub.is_some_and(|time| !(time >= 0.0 && time.is_finite())) {
            return Err("scrub: accepted: seconds, 0 or more".into());
        }
        match message.set.keys().find(|key| !KEYS.contains(&key.as_str())) {
            Some(key) => Err(format!("{key}: cannot be set here; accepted: {}", KEYS.join(", "))),
            None => Ok(message),
        }
    }
}

/// What the page wants of the eye: the newest of each kind, never a queue.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Wish {
    /// A page has come.
    pub(crate) hello: bool,
    pub(crate) look: Option<[f64; 2]>,
    /// The greatest number of a look; 0: none.
    pub(crate) id: u32,
    pub(crate) play: Option<bool>,
    pub(crate) speed: Option<f64>,
    pub(crate) scrub: Option<f64>,
    pub(crate) rest: bool,
    pub(crate) before: Option<bool>,
    pub(crate) set: BTreeMap<String, Value>,
    pub(crate) save: bool,
    pub(crate) open: Option<String>,
}

impl Wish {
    /// Adds what a message asks for on top of what is still waiting.
    pub(crate) fn add(&mut self, message: Message) {
        self.look = message.look.or(self.look);
        self.id = message.id.unwrap_or(0).max(self.id);
        self.play = message.play.or(self.play);
        self.speed = message.speed.or(self.speed);
        self.scrub = message.scrub.or(self.scrub);
        self.rest |= message.rest;
        self.before = message.before.or(self.before);
        self.set.extend(message.set);
        self.save |= message.save;
        self.open = message.open.or(self.open.take());
    }

    /// Whether nothing is wanted.
    pub(crate) fn is_empty(&self) -> bool {
        *self == Wish::default()
    }
}

/// How a picture is encoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Form {
    Jpeg = 1,
    Png = 2,
}

/// What stands before a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Head {
    pub(crate) seq: u32,
    /// The last look that this picture has seen.
    pub(crate) id: u32,
    pub(crate) size: [usize; 2],
    pub(crate) form: Form,
    pub(crate) playing: bool,
    /// The end of the look, s.
    pub(crate) time: f64,
    pub(crate) duration: f64,
    /// Unbleached fractions at the gaze.
    pub(crate) p: [f64; 3],
    pub(crate) pupil_mm: f64,
    /// Mean luminance over the fovea, cd/m2.
    pub(crate) fovea: f64,
    /// Fractions of the picture.
    pub(crate) gaze: [f64; 2],
}

impl Head {
    /// The head of a picture that nobody has looked at yet.
    pub(crate) fn rested(size: [usize; 2], gaze: [f64; 2]) -> Head {
        Head {
            seq: 0,
            id: 0,
            size,
            form: Form::Png,
            playing: false,
            time: 0.0,
            duration: 0.0,
            p: [1.0; 3],
            pupil_mm: 0.0,
            fovea: 0.0,
            gaze,
        }
    }

    /// Length in bytes.
    pub const LENGTH: usize = 72;

    /// The head as bytes, with room for a picture behind it.
    pub(crate) fn bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(1 << 17);
        bytes.extend_from_slice(b"SGZ1");
        bytes.extend([self.seq, self.id].iter().flat_map(|v| v.to_le_bytes()));
        bytes.extend(self.size.iter().flat_map(|&v| (v.min(65535) as u16).to_le_bytes()));
        bytes.extend([self.form as u8, u8::from(self.playing), 0, 0, 0, 0, 0, 0]);
        bytes.extend([self.time, self.duration].iter().flat_map(|v| v.to_le_bytes()));
        let [l, m, s] = self.p;
        let floats = [l, m, s, self.pupil_mm, self.fovea, self.gaze[0], self.gaze[1], 0.0];
        bytes.extend(floats.iter().flat_map(|&v| (v as f32).to_le_bytes()));
        bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn of_many_wishes_the_newest_of_each_kind_is_left() {
        let mut wish = Wish::default();
        for i in 0..200 {
            wish.add(Message {
                look: Some([0.0, f64::from(i) / 200.0]),
                id: Some(i),
                ..Message::default()
            });
        }
        wish.add(Message::read(r#"{"set": {"observer.age": 60}}"#).unwrap());
        wish.add(Message::read(r#"{"set": {"observer.age": 70}}"#).unwrap());
        assert_eq!((wish.look, wish.id), (Some([0.0, 199.0 / 200.0]), 199));
        assert_eq!(wish.set, BTreeMap::from([("observer.age".into(), json!(70))]));
    }

    #[test]
    fn no_message_reaches_a_file_or_a_number_that_is_none() {
        let wrong = [
            "",
            "[]",
            "nonsense",
            "{\"look\": [0.5]}",
            "{\"look\": [0.5, 1.5]}",
            "{\"look\": [1e999, 0]}",
            "{\"speed\": 0}",
            "{\"speed\": 1e9}",
            "{\"scrub\": -1}",
            "{\"unknown\": 1}",
            "{\"set\": {\"input.frames\": \"/etc/passwd\"}}",
            "{\"set\": {\"output.video\": \"a.mp4\"}}",
            "{\"set\": {\"observer.start\": \"/etc/passwd\"}}",
        ];
        for text in wrong {
            assert!(Message::read(text).is_err(), "{text}");
        }
    }

    #[test]
    fn a_head_is_as_long_as_it_says() {
        let head = Head {
            seq: 7,
            id: 3,
            size: [960, 540],
            form: Form::Jpeg,
            playing: true,
            time: 1.5,
            duration: 0.25,
            p: [1.0, 0.5, 0.25],
            pupil_mm: 3.0,
            fovea: 1e4,
            gaze: [0.25, 0.75],
        };
        let bytes = head.bytes();
        assert_eq!((bytes.len(), &bytes[..4]), (Head::LENGTH, &b"SGZ1"[..]));
        assert_eq!(
            (bytes[12..14].to_vec(), bytes[24..32].to_vec()),
            (960u16.to_le_bytes().to_vec(), 1.5f64.to_le_bytes().to_vec())
        );
    }
}
