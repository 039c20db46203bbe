//! Memory that is free, so that what cannot fit is refused before it is asked for.

use std::fs::read_to_string;

/// Bytes that this process can still get: the least of what the system has free, what is left of
/// the process's address space, and what is left to its control group. `None`: the system does not
/// tell.
fn free() -> Option<u64> {
    let read = |path: &str| read_to_string(path).unwrap_or_default();
    let status = read("/proc/self/status");
    let spaces = [
        kibibytes(&read("/proc/meminfo"), "MemAvailable:"),
        limit(&read("/proc/self/limits"), "Max address space")
            .map(|most| most.saturating_sub(kibibytes(&status, "VmSize:").unwrap_or(0))),
        number(&read("/sys/fs/cgroup/memory.max"))
            .zip(number(&read("/sys/fs/cgroup/memory.current")))
            .map(|(most, used)| most.saturating_sub(used)),
    ];
    spaces.into_iter().flatten().min()
}

/// Bytes that are not worth asking for.
const LITTLE: u64 = 1 << 27;

/// Refuses what needs more bytes than are free.
///
/// # Errors
/// What would not fit, how much it needs and how much is free.
pub(crate) fn must_hold(what: &str, bytes: u64) -> Result<(), String> {
    if bytes < LITTLE { Ok(()) } else { fits(what, bytes, free()) }
}

fn fits(what: &str, bytes: u64, free: Option<u64>) -> Result<(), String> {
    let gigabytes = |bytes: u64| bytes as f64 / 1e9;
    match free {
        Some(free) if bytes > free => Err(format!(
            "{what} needs at least {:.1} GB of memory; free are {:.1} GB",
            gigabytes(bytes),
            gigabytes(free)
        )),
        _ => Ok(()),
    }
}

/// The number behind a name in a list of kibibytes, in bytes.
fn kibibytes(list: &str, name: &str) -> Option<u64> {
    let line = list.lines().find_map(|line| line.strip_prefix(name))?;
    number(line.trim().strip_suffix("kB")?).map(|n| n.saturating_mul(1024))
}

/// The soft limit behind a name in a list of limits; `None`: there is none.
fn limit(list: &str, name: &str) -> Option<u64> {
    let line = list.lines().find_map(|line| line.strip_prefix(name))?;
    number(line.split_whitespace().next()?)
}

fn number(text: &str) -> Option<u64> {
    text.trim().parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_system_says_is_read_and_no_limit_is_none() {
        let list = "MemTotal:       24625000 kB\nMemAvailable:   23000000 kB\n";
        assert_eq!(kibibytes(list, "MemAvailable:"), Some(23_000_000 * 1024));
        assert_eq!(kibibytes(list, "MemFree:"), None);
        let limits = "Limit    Soft Limit  Hard Limit  Units\n\
                      Max address space         12288000000          unlimited            bytes\n\
                      Max file size             unlimited            unlimited            bytes\n";
        assert_eq!(limit(limits, "Max address space"), Some(12_288_000_000));
        assert_eq!(limit(limits, "Max file size"), None);
    }

    #[test]
    fn what_does_not_fit_is_named_with_what_it_needs_and_what_is_free() {
        let refused = fits("a frame of 9 x 9 pixels", 3_000_000_000, Some(2_000_000_000));
        let message = refused.unwrap_err();
        assert!(message.contains("9 x 9") && message.contains("3.0 GB"), "{message}");
        assert!(message.contains("free are 2.0 GB"), "{message}");
        assert!(fits("", 3, Some(3)).is_ok() && fits("", u64::MAX, None).is_ok());
    }
}
