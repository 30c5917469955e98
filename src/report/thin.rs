//! Fewer rows, and no extreme lost.

/// Rows to keep of a table that has more than `most`, rising: the first, the last, and in each of
/// many equal stretches those where a column is smallest and largest. With `most` rows or fewer,
/// all of them.
pub(super) fn rows_to_keep(rows: usize, most: usize, columns: &[&[f64]]) -> Vec<usize> {
    if rows <= most {
        return (0..rows).collect();
    }
    // Each column asks for two rows of a stretch at most.
    let stretches = (most.saturating_sub(2) / (2 * columns.len().max(1))).max(1);
    let mut kept = vec![0, rows - 1];
    for stretch in 0..stretches {
        let (from, to) = (rows * stretch / stretches, rows * (stretch + 1) / stretches);
        for column in columns {
            let finite = || (from..to).filter(|row| column[*row].is_finite());
            let by_value = |a: &usize, b: &usize| column[*a].total_cmp(&column[*b]);
            kept.extend(finite().min_by(by_value));
            kept.extend(finite().max_by(by_value));
        }
    }
    kept.sort_unstable();
    kept.dedup();
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_rows_are_all_kept() {
        assert_eq!(rows_to_keep(5, 5, &[&[0.0; 5]]), [0, 1, 2, 3, 4]);
        assert!(rows_to_keep(0, 5, &[]).is_empty());
    }

    #[test]
    fn no_extreme_is_lost_among_a_million_rows() {
        let mut force = vec![0.0; 1_000_000];
        let (peak, trough) = (123_457, 765_432);
        (force[peak], force[trough]) = (1.0, -1.0);
        let ramp: Vec<f64> = (0..force.len()).map(|row| row as f64).collect();
        let kept = rows_to_keep(force.len(), 1000, &[&force, &ramp]);
        assert!(kept.len() <= 1000, "{}", kept.len());
        assert!(kept.is_sorted());
        for row in [0, peak, trough, 999_999] {
            assert!(kept.contains(&row), "row {row} is lost");
        }
    }

    #[test]
    fn columns_without_numbers_ask_for_nothing() {
        assert_eq!(rows_to_keep(10, 4, &[&[f64::NAN; 10]]), [0, 9]);
    }
}
