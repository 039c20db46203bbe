//! The configuration of a saved viewing.

use toml::Value;

use super::settings::OneOrMany;
use super::{Config, insert, remove};
use crate::error::Result;

impl Config {
    /// The TOML of a run that follows a gaze path beside it, under all else that this configuration
    /// gives. Its frames are named so that it may lie anywhere. `still`: there is one frame, which
    /// has no times of its own.
    pub(crate) fn viewing(&self, path: &str, still: bool) -> Result<String> {
        let mut keys = self.keys.clone();
        remove(&mut keys, "gaze.at");
        for time in ["time.times_s", "time.duration_s"] {
            remove(&mut keys, time);
        }
        let mut changes = vec![("gaze.path", path.into()), ("time.times_s", "gaze.path".into())];
        if let Some(times) = self.settings.time.listed().filter(|_| !still) {
            changes.push(("time.frames_s", times.to_vec().into()));
        }
        if let Some(frames) = &self.settings.input.frames {
            changes.push(("input.frames", self.anywhere(frames)));
        }
        for (key, value) in changes {
            insert(&mut keys, key, value).map_err(|problem| self.wrong(key, problem))?;
        }
        toml::to_string(&keys).map_err(|e| self.wrong("save", e.to_string()))
    }

    /// Frames by names that do not depend on where the configuration lies.
    fn anywhere(&self, frames: &OneOrMany) -> Value {
        let absolute = |name: &String| {
            let path = self.path(name);
            let path = std::path::absolute(&path).unwrap_or(path);
            Value::String(path.to_string_lossy().into_owned())
        };
        match frames {
            OneOrMany::One(name) => absolute(name),
            OneOrMany::Many(names) => Value::Array(names.iter().map(absolute).collect()),
        }
    }
}
