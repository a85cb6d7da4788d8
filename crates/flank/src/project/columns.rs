//! Text in columns.

/// Rows with their cells below each other, all to the left but those whose place in `sides` holds a `>`.
pub(crate) fn aligned<const N: usize>(rows: &[[String; N]], sides: &str) -> String {
    let widths: [usize; N] = std::array::from_fn(|k| rows.iter().map(|row| row[k].chars().count()).max().unwrap_or(0));
    let cell = |k: usize, text: &str| match sides.as_bytes().get(k) {
        Some(b'>') => format!("  {text:>0$}", widths[k]),
        _ => format!("  {text:<0$}", widths[k]),
    };
    let line = |row: &[String; N]| (0..N).map(|k| cell(k, &row[k])).collect::<String>();
    rows.iter().map(|row| line(row).trim_end().to_string() + "\n").collect()
}
