//! Markdown tables.

/// A line of a table. A vertical bar in a cell is escaped.
pub fn row(cells: &[impl AsRef<str>]) -> String {
    let cells = cells.iter().map(|cell| cell.as_ref().replace('|', "\\|"));
    format!("| {} |\n", cells.collect::<Vec<String>>().join(" | "))
}

#[cfg(test)]
mod tests {
    use super::row;

    #[test]
    fn a_bar_within_a_cell_does_not_end_it() {
        assert_eq!(row(&["|a - b|", "1"]), "| \\|a - b\\| | 1 |\n");
    }
}
