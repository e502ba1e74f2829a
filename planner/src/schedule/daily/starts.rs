//! Whether a sliding window has room for one more start, and where none fits any more.
//!
//! Method: at most `count` starts in every half-open window of a length hold exactly if any `count` + 1
//! starts in order span the length or more.

/// Whether one more start leaves at most `count` in every half-open window; `starts` ascend and
/// leave as much already.
pub(super) fn start_fits(starts: &[i64], start: i64, count: usize, window: i64) -> bool {
    if starts.len() < count {
        return true;
    }
    if count == 0 {
        return false;
    }
    // The new start and `count` neighbours in order must span a window or more.
    let place = starts.partition_point(|&other| other < start);
    let first = place.saturating_sub(count);
    let last = (place + count).min(starts.len());
    starts[first..last].windows(count).all(|run| {
        let from = run[0].min(start);
        let until = run[count - 1].max(start);
        until.saturating_sub(from) >= window
    })
}

/// Where, ends excluded, no start fits any more because of `start`, which stands among `starts`
/// (ascending); nowhere is an empty interval.
pub(super) fn crowded(starts: &[i64], start: i64, (count, window): (usize, i64)) -> (i64, i64) {
    let place = starts.partition_point(|&other| other < start);
    let first = (place + 1).saturating_sub(count);
    let last = (place + count).min(starts.len());
    // A run of `count` starts shorter than the window lets nothing in within a window of both its ends;
    // those that hold `start` exclude intervals about it.
    let runs = starts[first..last].windows(count.max(1)).map(|run| (run[0], run[run.len() - 1]));
    let full = runs.filter(|(from, until)| until.saturating_sub(*from) < window);
    full.fold((start, start), |(low, high), (from, until)| {
        (low.min(until.saturating_sub(window)), high.max(from.saturating_add(window)))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use ephem::random::SplitMix64;

    #[test]
    fn starts_fit_as_every_window_says() {
        let mut random = SplitMix64(5);
        let mut next = |below: i64| random.up_to(below - 1);
        for _ in 0..2_000 {
            let (count, window) = (usize::try_from(next(4) + 1).unwrap(), next(20) + 1);
            let mut starts: Vec<i64> = Vec::new();
            for _ in 0..12 {
                let start = next(40);
                let mut with = starts.clone();
                with.push(start);
                let legal = with.iter().all(|from| {
                    with.iter().filter(|it| (*from..from + window).contains(*it)).count() <= count
                });
                assert_eq!(start_fits(&starts, start, count, window), legal);
                if legal {
                    let fits = |starts: &[i64], at| start_fits(starts, at, count, window);
                    let before: Vec<i64> = (-30..70).filter(|&at| fits(&starts, at)).collect();
                    starts.push(start);
                    starts.sort_unstable();
                    let (low, high) = crowded(&starts, start, (count, window));
                    for at in before {
                        assert_eq!(fits(&starts, at), !(low < at && at < high));
                    }
                }
            }
        }
    }
}
