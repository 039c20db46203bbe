//! Ranges of frame numbers: `1001-1100`, `1-100x2,120`.

/// The most frames of one sequence: eleven hours at 24 a second.
pub(super) const LONGEST: usize = 1_000_000;

/// The numbers of a range, rising, each once.
pub(crate) fn parse(text: &str) -> Result<Vec<u32>, String> {
    let mut numbers = Vec::new();
    for part in text.split(',') {
        let (first, last, step) = span(part.trim()).ok_or_else(|| {
            format!(
                "`{}` is no range of frames; write for instance 1001-1100 or 1-100x2,120",
                part.trim()
            )
        })?;
        if last < first {
            return Err(format!(
                "`{}` runs backwards; frames are taken in rising order",
                part.trim()
            ));
        }
        if ((last - first) / step) as usize + numbers.len() >= LONGEST {
            return Err(format!("`{text}` has more than {LONGEST} frames"));
        }
        numbers.extend((first..=last).step_by(step as usize));
    }
    numbers.sort_unstable();
    numbers.dedup();
    Ok(numbers)
}

/// First, last and step of `first[-last[xstep]]`.
fn span(part: &str) -> Option<(u32, u32, u32)> {
    let number = |text: &str| -> Option<u32> {
        let plain = text.bytes().all(|b| b.is_ascii_digit());
        plain.then(|| text.parse().ok())?
    };
    let Some((first, rest)) = part.split_once('-') else {
        return Some((number(part)?, number(part)?, 1));
    };
    let (last, step) = match rest.split_once('x') {
        Some((last, step)) => (last, number(step)?),
        None => (rest, 1),
    };
    (step > 0).then_some((number(first)?, number(last)?, step))
}

/// Numbers as a range, at most eight runs of them.
pub(super) fn show(numbers: &[u32]) -> String {
    let mut runs: Vec<(u32, u32)> = Vec::new();
    for &number in numbers {
        match runs.last_mut() {
            Some((_, last)) if *last + 1 == number => *last = number,
            _ => runs.push((number, number)),
        }
    }
    let more = if runs.len() > 8 { ",..." } else { "" };
    let run = |&(first, last): &(u32, u32)| {
        if first == last { first.to_string() } else { format!("{first}-{last}") }
    };
    runs.iter().take(8).map(run).collect::<Vec<_>>().join(",") + more
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn ranges_step_join_and_sort() {
        assert_eq!(parse("1-7x2,4, 3").unwrap(), [1, 3, 4, 5, 7]);
        assert_eq!(show(&[1, 2, 3, 5, 7, 8]), "1-3,5,7-8");
    }

    #[test]
    fn nonsense_and_eternity_are_refused() {
        for text in [
            "",
            "a",
            "1-",
            "-1",
            "5-1",
            "1-5x0",
            "1-5x",
            "1,,2",
            "0-4294967295",
            "99999999999",
            "+1",
        ] {
            assert!(parse(text).is_err(), "{text}");
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 10_000, failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn no_range_panics_or_grows_without_end(text in "[0-9x,\\- ]{0,12}|\\PC{0,8}") {
            if let Ok(numbers) = parse(&text) {
                prop_assert!(!numbers.is_empty() && numbers.len() <= LONGEST);
            }
        }

        #[test]
        fn what_is_shown_is_read_back(mut numbers in prop::collection::vec(0u32..40, 1..8)) {
            numbers.sort_unstable();
            numbers.dedup();
            prop_assert_eq!(parse(&show(&numbers)).unwrap(), numbers);
        }
    }
}
