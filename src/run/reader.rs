//! The first stage of a run: decodes frames ahead of the eye.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, SyncSender};
use std::time::{Duration, Instant};

use crate::display::Survey;
use crate::error::Result;
use crate::frames::Footage;
use crate::light::{Frame, Planes};
use crate::percept::Vision;
use crate::run::schedule::Step;
use crate::viewer;

/// A decoded frame and its luminances, on their way to the eye.
pub struct Loaded {
    pub frame: Frame,
    pub survey: Survey,
}

/// Reads the file of every step in order, each file that follows itself once, until the eye hangs up.
/// `spent` holds planes to be written over. Returns the time spent in decoding.
pub fn read_all(
    footage: &dyn Footage,
    vision: &Vision,
    pixels_per_degree: f64,
    steps: &[Step],
    to_eye: &SyncSender<Result<Arc<Loaded>>>,
    spent: &Receiver<Planes>,
) -> Duration {
    let mut busy = Duration::ZERO;
    let mut last: Option<(usize, Arc<Loaded>)> = None;
    for step in steps {
        let frame = match &last {
            Some((file, frame)) if *file == step.file => Ok(frame.clone()),
            _ => {
                // Let go of the frame before, so that its planes can come back to be written over.
                drop(last.take());
                let begun = Instant::now();
                let frame = footage.read(step.file, vision.projection(), spent.try_recv().ok());
                let loaded = frame.map(|frame| {
                    let survey = viewer::survey(vision, &frame.planes, pixels_per_degree);
                    Arc::new(Loaded { frame, survey })
                });
                busy += begun.elapsed();
                loaded
            }
        };
        last = frame.as_ref().ok().map(|frame| (step.file, frame.clone()));
        let failed = frame.is_err();
        if to_eye.send(frame).is_err() || failed {
            break;
        }
    }
    busy
}
