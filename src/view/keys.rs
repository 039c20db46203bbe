//! Key frames: states of the eye along its path, few enough to hold and near enough to go back to.

/// The most that are kept.
const MOST: usize = 16;
/// The most memory that they may take, bytes.
const BUDGET: usize = 256 << 20;

/// States by how many looks had been lived, the start always among them.
pub(crate) struct Keys<S> {
    kept: Vec<(usize, S)>,
    /// A state is kept after so many looks.
    spacing: usize,
}

impl<S: Clone> Keys<S> {
    /// The state before the first look.
    pub(crate) fn new(start: S) -> Self {
        Keys { kept: vec![(0, start)], spacing: 16 }
    }

    /// Keeps a state, if it is one's turn. When there are too many, or they take too much memory (`size` bytes each),
    /// every other goes.
    pub(crate) fn keep(&mut self, lived: usize, size: usize, state: impl FnOnce() -> S) {
        let last = self.kept.last().map_or(0, |(at, _)| *at);
        if lived < last + self.spacing {
            return;
        }
        self.kept.push((lived, state()));
        if self.kept.len() > MOST || self.kept.len() * size > BUDGET {
            let mut nth = 0;
            self.kept.retain(|_| {
                nth += 1;
                nth % 2 == 1
            });
            self.spacing *= 2;
        }
    }

    /// How many looks had been lived at the last state at or before this many.
    pub(crate) fn nearest(&self, looks: usize) -> usize {
        self.kept[self.kept.partition_point(|(at, _)| *at <= looks).max(1) - 1].0
    }

    /// The last state at or before this many looks.
    pub(crate) fn before(&self, looks: usize) -> (usize, S) {
        let next = self.kept.partition_point(|(at, _)| *at <= looks);
        self.kept[next.max(1) - 1].clone()
    }

    /// Changes every state alike.
    pub(crate) fn each(&mut self, change: impl Fn(&mut S)) {
        self.kept.iter_mut().for_each(|(_, state)| change(state));
    }

    /// Forgets what lies after this many looks: they will be others.
    pub(crate) fn forget_after(&mut self, looks: usize) {
        self.kept.retain(|(at, _)| *at <= looks);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_stay_few_and_evenly_spread_and_the_start_is_always_there() {
        let mut keys = Keys::new(0);
        (1..=10_000).for_each(|i| keys.keep(i, 1, || i));
        assert!((MOST / 2..=MOST).contains(&keys.kept.len()), "{}", keys.kept.len());
        assert_eq!(keys.before(3), (0, 0));
        let (at, state) = keys.before(9_999);
        assert!(at == state && at > 8_000);
        keys.forget_after(at - 1);
        assert!(keys.before(10_000).0 < at);
    }

    #[test]
    fn large_states_are_fewer() {
        let mut keys = Keys::new(0);
        (1..=10_000).for_each(|i| keys.keep(i, BUDGET / 4, || i));
        assert!(keys.kept.len() <= 4, "{}", keys.kept.len());
    }
}
