//! What `ffprobe` tells of a film: its size, its tags, and when each frame is shown.

use std::path::Path;
use std::process::Stdio;

use serde::Deserialize;

use crate::error::{Error, Result};
use crate::frames::film_call::{command, complaint, not_started};
use crate::frames::range::LONGEST;

/// The first video stream of a film. Words are those of ffprobe; absent ones are unknown.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Stream {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) pix_fmt: String,
    pub(crate) color_range: Option<String>,
    pub(crate) color_space: Option<String>,
    pub(crate) color_transfer: Option<String>,
    pub(crate) color_primaries: Option<String>,
    pub(crate) chroma_location: Option<String>,
    pub(crate) field_order: Option<String>,
    pub(crate) sample_aspect_ratio: Option<String>,
    pub(crate) avg_frame_rate: Option<String>,
    pub(crate) r_frame_rate: Option<String>,
    pub(crate) time_base: Option<String>,
    pub(crate) side_data_list: Vec<SideData>,
}

#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct SideData {
    rotation: Option<f64>,
}

#[derive(Default, Deserialize)]
#[serde(default)]
struct Packet {
    pts_time: Option<String>,
    duration_time: Option<String>,
    flags: String,
    pos: Option<String>,
    size: Option<String>,
}

#[derive(Default, Deserialize)]
#[serde(default)]
struct Probed {
    streams: Vec<Stream>,
    packets: Vec<Packet>,
    format: Container,
}

#[derive(Default, Deserialize)]
#[serde(default)]
struct Container {
    format_name: String,
}

const ENTRIES: &str = "stream=width,height,pix_fmt,color_range,color_space,color_transfer,\
                       color_primaries,chroma_location,field_order,sample_aspect_ratio,\
                       avg_frame_rate,r_frame_rate,time_base:stream_side_data=rotation:\
                       packet=pts_time,duration_time,flags,pos,size:\
                       format=format_name";

/// What a probe tells.
pub(super) struct Told {
    pub(crate) stream: Stream,
    /// The starts of all frames and the end of the last, s from 0.
    pub(crate) times: Vec<f64>,
    /// What ffprobe complained of and yet went on.
    pub(crate) complaints: Vec<String>,
}

/// Probes a film.
pub(super) fn probe(path: &Path) -> Result<Told> {
    let mut probe = command("ffprobe", path);
    probe.args(["-select_streams", "v:0", "-show_entries", ENTRIES, "-of", "json"]);
    let output = probe.stdout(Stdio::piped()).stderr(Stdio::piped()).output();
    let output = output.map_err(|error| not_started(path, error))?;
    let mut told: Probed = serde_json::from_slice(&output.stdout).unwrap_or_default();
    let complaints = String::from_utf8_lossy(&output.stderr);
    if let Some(cut) = cut(path, &told, &complaints) {
        return Err(Error::file(path, format!("is cut short: {cut}")));
    }
    let Some(stream) = told.streams.pop().filter(|_| output.status.success()) else {
        let why = complaints.lines().last().unwrap_or("it holds no video").trim();
        return Err(Error::file(path, format!("is no film that ffmpeg can read: {why}")));
    };
    let times = stream.evened(times(&told.packets, stream.rate().unwrap_or(24.0)));
    if times.len() < 2 || times.len() > LONGEST {
        let problem = format!("has {} frames; 1 to {LONGEST} are read", times.len().max(1) - 1);
        return Err(Error::file(path, problem));
    }
    Ok(Told { stream, times, complaints: complaints.lines().map(complaint).collect() })
}

/// How a film ends before its time. Of raw frames (y4m) ffmpeg lets a part at the end go unsaid.
fn cut(path: &Path, told: &Probed, complaints: &str) -> Option<String> {
    let lines = ["partial file", "prematurely", "runcat"];
    let of_cut = |line: &&str| lines.iter().any(|words| line.contains(words));
    if let Some(line) = complaints.lines().find(of_cut) {
        return Some(complaint(line));
    }
    let number = |text: &Option<String>| text.as_deref()?.parse::<u64>().ok();
    let last = told.packets.last().filter(|_| told.format.format_name == "yuv4mpegpipe")?;
    let end = number(&last.pos)? + number(&last.size)?;
    let length = std::fs::metadata(path).ok()?.len();
    (end < length).then(|| format!("a part of a frame stands at its end, from byte {end} on"))
}

/// Starts of the frames in the order in which they are shown, and the end of the last. A film that
/// does not tell (raw streams) is shown at its rate.
fn times(packets: &[Packet], rate: f64) -> Vec<f64> {
    let number = |text: &Option<String>| text.as_deref().and_then(|text| text.parse::<f64>().ok());
    let shown = packets.iter().filter(|packet| !packet.flags.contains('D'));
    let told: Vec<(Option<f64>, Option<f64>)> =
        shown.map(|packet| (number(&packet.pts_time), number(&packet.duration_time))).collect();
    let mut starts: Vec<f64> = told.iter().filter_map(|packet| packet.0).collect();
    starts.sort_by(f64::total_cmp);
    if starts.len() < told.len() || starts.windows(2).any(|pair| pair[0] == pair[1]) {
        return (0..=told.len()).map(|frame| frame as f64 / rate).collect();
    }
    let Some((&first, &last)) = starts.first().zip(starts.last()) else { return Vec::new() };
    let of_last = told.iter().find(|packet| packet.0 == Some(last)).and_then(|packet| packet.1);
    let duration = of_last.filter(|duration| *duration > 0.0).unwrap_or(1.0 / rate);
    starts.iter().copied().chain([last + duration]).map(|time| time - first).collect()
}

/// A fraction as ffprobe prints it, if it is above 0.
fn ratio(text: &str) -> Option<f64> {
    let (above, below) = text.split_once('/')?;
    let ratio = above.parse::<f64>().ok()? / below.parse::<f64>().ok()?;
    (ratio.is_finite() && ratio > 0.0).then_some(ratio)
}

impl Stream {
    /// Frames a second, on average.
    pub(crate) fn rate(&self) -> Option<f64> {
        ratio(self.avg_frame_rate.as_deref()?)
    }

    /// The times of even frames that were rounded to the container's ticks (1 ms in Matroska), as
    /// they were before; others as they are.
    fn evened(&self, times: Vec<f64>) -> Vec<f64> {
        let rates = [&self.r_frame_rate, &self.avg_frame_rate];
        let mut rates = rates.into_iter().filter_map(|rate| ratio(rate.as_deref()?));
        // ffprobe rounds to a microsecond once more; and the first frame, from which all are counted,
        // was rounded too.
        let tick = self.time_base.as_deref().and_then(ratio).unwrap_or(0.0);
        let fits = |(frame, time): (usize, &f64), rate: f64| {
            (frame as f64 / rate - time).abs() <= tick + 4e-6
        };
        let starts = times.len().saturating_sub(1);
        let are_even = |rate: &f64| times[..starts].iter().enumerate().all(|at| fits(at, *rate));
        let Some(rate) = rates.find(are_even) else { return times };
        // The last may last longer.
        let even = |at: (usize, &f64)| if fits(at, rate) { at.0 as f64 / rate } else { *at.1 };
        times.iter().enumerate().map(even).collect()
    }

    /// The EXIF orientation that stands for the film's rotation (degrees counterclockwise).
    pub(crate) fn orientation(&self) -> u16 {
        let rotation = self.side_data_list.iter().find_map(|side| side.rotation).unwrap_or(0.0);
        match (rotation / 90.0).round().rem_euclid(4.0) as u8 {
            1 => 8,
            2 => 3,
            3 => 6,
            _ => 1,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn packet(pts: &str, duration: &str, flags: &str) -> Packet {
        let text = |text: &str| (!text.is_empty()).then(|| text.to_owned());
        Packet {
            pts_time: text(pts),
            duration_time: text(duration),
            flags: flags.into(),
            ..Packet::default()
        }
    }

    #[test]
    fn frames_are_shown_in_order_of_time_from_zero_without_those_that_are_cut_away() {
        let packets = [
            packet("0.2", "0.1", "KD_"),
            packet("0.5", ".04", "K__"),
            packet("0.9", ".3", "___"),
            packet("0.6", ".04", "___"),
        ];
        let found = times(&packets, 24.0);
        let expected = [0.0, 0.1, 0.4, 0.7];
        assert_eq!(found.len(), 4);
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?}");
    }

    #[test]
    fn even_frames_are_even_however_the_container_rounds_them() {
        let rounded = |rate: f64, tick: f64| -> Vec<f64> {
            (0..200).map(|frame| (f64::from(frame) / rate / tick).round() * tick).collect()
        };
        let text = |text: &str| Some(text.to_owned());
        let matroska = |rate: &str, average: &str| Stream {
            r_frame_rate: text(rate),
            avg_frame_rate: text(average),
            time_base: text("1/1000"),
            ..Stream::default()
        };
        for (rate, stream) in [
            (30.0, matroska("30/1", "30/1")),
            (24e3 / 1001.0, matroska("24000/1001", "2997/125")),
            (25.0, matroska("50/1", "25/1")),
        ] {
            let times = stream.evened(rounded(rate, 1e-3));
            let even = times.windows(2).all(|pair| (rate * (pair[1] - pair[0]) - 1.0).abs() < 1e-9);
            assert!(even, "{rate}: {times:?}");
        }
        let uneven = vec![0.0, 0.033, 0.069, 0.1];
        assert_eq!(matroska("30/1", "30/1").evened(uneven.clone()), uneven);
    }

    #[test]
    fn a_raw_stream_is_shown_at_its_rate() {
        assert_eq!(times(&[packet("", "", ""), packet("", "", "")], 10.0), [0.0, 0.1, 0.2]);
        assert!(times(&[], 10.0).is_empty());
    }

    #[test]
    fn rotation_becomes_an_orientation() {
        let turned = |rotation| Stream {
            side_data_list: vec![SideData { rotation: Some(rotation) }],
            ..Stream::default()
        };
        let found = [0.0, 90.0, -90.0, 180.0, -180.0].map(|degrees| turned(degrees).orientation());
        assert_eq!(found, [1, 8, 6, 3, 3]);
    }
}
