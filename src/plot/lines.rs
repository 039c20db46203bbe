//! Lines: as few points as a curve needs, and labels that keep apart.

use super::sheet::Point;

/// How far a line may leave the points that it is drawn without, units.
const THIN: f64 = 0.05;

/// The points without which a line would be another: those left out lie within [`THIN`] of it
/// (Ramer 1972; Douglas & Peucker 1973).
pub(super) fn thinned(points: &[Point]) -> Vec<Point> {
    let [first, .., last] = points else { return points.to_vec() };
    let (along, down) = (last.0 - first.0, last.1 - first.1);
    let length = along.hypot(down);
    let away = |p: &Point| match length > 0.0 {
        true => ((p.0 - first.0) * down - (p.1 - first.1) * along).abs() / length,
        false => (p.0 - first.0).hypot(p.1 - first.1),
    };
    let farthest =
        (1..points.len() - 1).max_by(|a, b| away(&points[*a]).total_cmp(&away(&points[*b])));
    match farthest.filter(|i| away(&points[*i]) > THIN) {
        None => vec![*first, *last],
        Some(i) => {
            let mut kept = thinned(&points[..=i]);
            kept.pop();
            kept.extend(thinned(&points[i..]));
            kept
        }
    }
}

/// Heights as near to the wanted ones as they can be `pitch` apart, in the same order, inside
/// `room` while all of them fit there.
pub(super) fn apart(wanted: &[f64], pitch: f64, room: [f64; 2]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..wanted.len()).collect();
    order.sort_by(|&a, &b| wanted[a].total_cmp(&wanted[b]));
    // Groups of neighbours that touch: how many, and the sum of where each would have the first.
    let mut groups: Vec<(usize, f64)> = Vec::new();
    let first = |&(count, sum): &(usize, f64)| {
        let most = room[1] - pitch * (count as f64 - 1.0);
        (sum / count as f64).min(most).max(room[0])
    };
    for &i in &order {
        let mut group = (1, wanted[i]);
        while let Some(last) = groups.last().copied() {
            if first(&last) + pitch * last.0 as f64 <= first(&group) {
                break;
            }
            let shift = pitch * last.0 as f64 * group.0 as f64;
            group = (last.0 + group.0, last.1 + group.1 - shift);
            groups.pop();
        }
        groups.push(group);
    }
    let places = groups.iter().flat_map(|group| {
        let first = first(group);
        (0..group.0).map(move |i| first + pitch * i as f64)
    });
    let mut heights = vec![0.0; wanted.len()];
    order.iter().zip(places).for_each(|(&i, place)| heights[i] = place);
    heights
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_stand_at_their_curves_where_there_is_room_and_apart_where_there_is_none() {
        assert_eq!(apart(&[10.0, 50.0], 12.0, [0.0, 100.0]), [10.0, 50.0]);
        assert_eq!(apart(&[50.0, 50.0, 50.0], 10.0, [0.0, 100.0]), [40.0, 50.0, 60.0]);
        assert_eq!(apart(&[99.0, 100.0], 10.0, [0.0, 100.0]), [90.0, 100.0]);
        assert_eq!(apart(&[3.0, 1.0, 2.0], 10.0, [0.0, 100.0]), [20.0, 0.0, 10.0]);
        let many = apart(&[7.0; 30], 10.0, [0.0, 100.0]);
        assert!(many.windows(2).all(|pair| pair[1] - pair[0] == 10.0), "{many:?}");
    }

    #[test]
    fn a_thinned_line_keeps_its_corners_and_stays_within_a_twentieth_of_a_unit() {
        let straight: Vec<Point> = (0..50).map(|i| (f64::from(i), 2.0 * f64::from(i))).collect();
        assert_eq!(thinned(&straight), [straight[0], straight[49]]);
        let curve: Vec<Point> =
            (0..=400).map(|i| (f64::from(i), 200.0 * (-f64::from(i) / 30.0).exp())).collect();
        let kept = thinned(&curve);
        assert!(kept.len() < 60, "{} points", kept.len());
        for &(x, y) in &curve {
            let i = kept.partition_point(|p| p.0 < x).max(1);
            let (a, b) = (kept[i - 1], kept[i]);
            let on_line = a.1 + (x - a.0) / (b.0 - a.0) * (b.1 - a.1);
            let slope = (b.1 - a.1) / (b.0 - a.0);
            assert!((y - on_line).abs() / 1f64.hypot(slope) <= THIN + 1e-9, "{x}");
        }
    }
}
