//! Fewer rows, and no extreme lost.

use std::ops::Range;

/// Rows that are read at once, at the least.
pub(super) const BLOCK: usize = 65_536;

/// Rows to keep of a table that has more than `most`, rising: the first, the last, and in each of
/// many equal stretches those where a column is smallest and largest. With `most` rows or fewer,
/// all of them. There are `count` columns, of which `read` tells those of some rows.
///
/// # Errors
/// Those of `read`.
pub(super) fn rows_to_keep<E>(
    rows: usize,
    most: usize,
    count: usize,
    mut read: impl FnMut(Range<usize>) -> Result<Vec<Vec<f64>>, E>,
) -> Result<Vec<usize>, E> {
    if rows <= most {
        return Ok((0..rows).collect());
    }
    // Each column asks for two rows of a stretch at most.
    let stretches = (most.saturating_sub(2) / (2 * count.max(1))).max(1);
    let begin = |stretch: usize| rows * stretch / stretches;
    let mut kept = vec![0, rows - 1];
    let mut first = 0;
    while first < stretches {
        let full = |stretch: &usize| begin(*stretch) - begin(first) >= BLOCK;
        let next = (first + 1..stretches).find(full).unwrap_or(stretches);
        let columns = read(begin(first)..begin(next))?;
        for stretch in first..next {
            for column in &columns {
                let value = |row: &usize| column[*row - begin(first)];
                let finite =
                    || (begin(stretch)..begin(stretch + 1)).filter(|row| value(row).is_finite());
                let by_value = |a: &usize, b: &usize| value(a).total_cmp(&value(b));
                kept.extend(finite().min_by(by_value));
                kept.extend(finite().max_by(by_value));
            }
        }
        first = next;
    }
    kept.sort_unstable();
    kept.dedup();
    Ok(kept)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    /// The rows to keep of columns that are there.
    fn keep(rows: usize, most: usize, columns: &[&[f64]]) -> Vec<usize> {
        let read = |rows: Range<usize>| {
            Ok::<_, Infallible>(
                columns.iter().map(|column| column[rows.clone()].to_vec()).collect(),
            )
        };
        rows_to_keep(rows, most, columns.len(), read).unwrap()
    }

    #[test]
    fn few_rows_are_all_kept() {
        assert_eq!(keep(5, 5, &[&[0.0; 5]]), [0, 1, 2, 3, 4]);
        assert!(keep(0, 5, &[]).is_empty());
    }

    #[test]
    fn no_extreme_is_lost_among_a_million_rows() {
        let mut force = vec![0.0; 1_000_000];
        let (peak, trough) = (123_457, 765_432);
        (force[peak], force[trough]) = (1.0, -1.0);
        let ramp: Vec<f64> = (0..force.len()).map(|row| row as f64).collect();
        let kept = keep(force.len(), 1000, &[&force, &ramp]);
        assert!(kept.len() <= 1000, "{}", kept.len());
        assert!(kept.is_sorted());
        for row in [0, peak, trough, 999_999] {
            assert!(kept.contains(&row), "row {row} is lost");
        }
    }

    #[test]
    fn columns_without_numbers_ask_for_nothing() {
        assert_eq!(keep(10, 4, &[&[f64::NAN; 10]]), [0, 9]);
    }
}
