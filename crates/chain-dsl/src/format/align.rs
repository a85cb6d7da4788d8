//! Neighbouring lines made into tables.

use super::WIDTH;
use super::print::Line;

/// Aligns statements of one family, and the comments at the ends of lines.
pub(super) fn align(lines: &mut [Line]) {
    let mut start = 0;
    while start < lines.len() {
        let end = family_end(lines, start);
        stops(&mut lines[start..end]);
        start = end;
    }
    let are_neighbours =
        |line: &Line, next: &Line| line.behind.is_some() && next.behind.is_some() && line.indent == next.indent;
    lines.chunk_by_mut(are_neighbours).for_each(comments);
}

/// Where lines that are aligned with the one at `start` end. Comments between them do not matter; an empty line ends a table,
/// and so does the second line of a statement.
fn family_end(lines: &[Line], start: usize) -> usize {
    let Some(family) = lines[start].family else { return start + 1 };
    let table = lines[start..].iter().take_while(|line| line.is_remark || line.family == Some(family));
    start + table.count()
}

/// Brings the stops of lines below each other, if all of them stay short enough.
fn stops(lines: &mut [Line]) {
    let count = lines.iter().map(|line| line.stops.len()).max().unwrap_or(0);
    let mut padding = vec![Vec::new(); lines.len()];
    for stop in 0..count {
        let cells: Vec<Option<usize>> = lines.iter().map(|line| cell(line, stop)).collect();
        let widest = cells.iter().flatten().max().copied().unwrap_or(0);
        for (padding, cell) in padding.iter_mut().zip(cells) {
            padding.extend(cell.map(|cell| widest - cell));
        }
    }
    let all_fit = lines.iter().zip(&padding).all(|(line, added)| line.width() + added.iter().sum::<usize>() <= WIDTH);
    if !all_fit {
        return;
    }
    for (line, padding) in lines.iter_mut().zip(padding) {
        for (&stop, added) in line.stops.iter().zip(&padding).rev() {
            line.text.insert_str(stop, &" ".repeat(*added));
        }
    }
}

/// Characters between a stop and the one before it.
fn cell(line: &Line, stop: usize) -> Option<usize> {
    let end = *line.stops.get(stop)?;
    let start = stop.checked_sub(1).map_or(0, |before| line.stops[before]);
    Some(line.text[start..end].chars().count())
}

/// Brings the comments at the ends of lines below each other.
fn comments(lines: &mut [Line]) {
    let widest = lines.iter().map(Line::width).max().unwrap_or(0);
    for line in lines {
        line.padding = widest - line.width();
    }
}
