//! The best one-to-one assignment of rows to columns (rectangular linear sum assignment).
//!
//! Shortest augmenting paths with dual variables: each row in turn enters the assignment along the path that
//! costs least (D. F. Crouse, "On implementing 2D rectangular assignment algorithms", IEEE TAES 52(4), 2016).
//! O(r²·c) for the smaller side r and the larger side c.
//!
//! Among several best assignments the one of `scipy.optimize.linear_sum_assignment` is taken, because equal
//! values with unequal overlaps would otherwise change a printed digit: the open columns are searched in the same
//! order, and of equally near columns an unassigned one wins.

/// The assignment of as many pairs as the smaller side has that maximises the sum of `values` (row-major,
/// `rows` x `columns`, finite). Pairs (row, column) by ascending row.
pub fn maximize(values: &[f64], rows: usize, columns: usize) -> Vec<(usize, usize)> {
    debug_assert_eq!(values.len(), rows * columns);
    debug_assert!(values.iter().all(|x| x.is_finite()));
    if rows > columns {
        let transposed: Vec<f64> =
            (0..columns).flat_map(|c| (0..rows).map(move |r| values[r * columns + c])).collect();
        let mut pairs: Vec<_> =
            maximize(&transposed, columns, rows).into_iter().map(|(c, r)| (r, c)).collect();
        pairs.sort_unstable();
        return pairs;
    }

    let mut row_price = vec![0.0; rows];
    let mut column_price = vec![0.0; columns];
    let mut column_of = vec![0; rows];
    let mut row_of: Vec<Option<usize>> = vec![None; columns];
    // Of the search: how far each column is from the row that enters, and the row before it on that path.
    let mut distance = vec![0.0; columns];
    let mut row_before = vec![0; columns];
    let mut reached = Vec::with_capacity(columns);

    for entering in 0..rows {
        distance.fill(f64::INFINITY);
        reached.clear();
        let mut open: Vec<usize> = (0..columns).rev().collect();
        let (mut row, mut walked) = (entering, 0.0);
        let sink = loop {
            let (mut nearest, mut place) = (f64::INFINITY, 0);
            for (k, &column) in open.iter().enumerate() {
                let through = walked - values[row * columns + column] - row_price[row] - column_price[column];
                if through < distance[column] {
                    distance[column] = through;
                    row_before[column] = row;
                }
                let here = distance[column];
                if here < nearest || (here == nearest && row_of[column].is_none()) {
                    (nearest, place) = (here, k);
                }
            }
            walked = nearest;
            let column = open.swap_remove(place);
            reached.push(column);
            match row_of[column] {
                Some(next) => row = next,
                None => break column,
            }
        };

        row_price[entering] += walked;
        for &column in &reached {
            let slack = walked - distance[column];
            column_price[column] -= slack;
            if let Some(row) = row_of[column] {
                row_price[row] += slack;
            }
        }

        let mut column = sink;
        loop {
            let row = row_before[column];
            row_of[column] = Some(row);
            let freed = std::mem::replace(&mut column_of[row], column);
            if row == entering {
                break;
            }
            column = freed;
        }
    }
    column_of.into_iter().enumerate().collect()
}
