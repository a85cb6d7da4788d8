//! What the pages point to is there: files, pictures, headings.

use std::path::Path;

use flank_tests::{all_pages, repository};

/// Targets of links and pictures, `](target)`, outside of code.
fn targets(page: &str) -> Vec<(usize, String)> {
    let mut targets = Vec::new();
    let mut fenced = false;
    for (index, line) in page.lines().enumerate() {
        if line.trim_start().starts_with("```") {
            fenced = !fenced;
            continue;
        }
        if fenced || line.starts_with("    ") {
            continue;
        }
        // every second piece between backticks is code; what is left is put together again
        let text: Vec<&str> = line.split('`').step_by(2).collect();
        for piece in text.join("`").split("](").skip(1) {
            let target = piece.split(')').next().expect("split gives one piece at least");
            targets.push((index + 1, target.to_string()));
        }
    }
    targets
}

/// The names by which headings are linked to.
fn anchors(page: &str) -> Vec<String> {
    let mut fenced = false;
    let headings = page.lines().filter(|line| {
        fenced ^= line.trim_start().starts_with("```");
        !fenced && line.starts_with('#')
    });
    let anchor = |heading: &str| {
        let kept = heading.trim_start_matches('#').trim().to_lowercase();
        kept.chars()
            .filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'))
            .map(|c| if c == ' ' { '-' } else { c })
            .collect()
    };
    headings.map(anchor).collect()
}

#[test]
fn links_and_pictures_are_there() {
    let mut checked = 0;
    let mut missing = Vec::new();
    for page in all_pages() {
        let text = std::fs::read_to_string(&page).expect("the page is there");
        let folder = page.parent().unwrap_or(Path::new("."));
        for (line, target) in targets(&text) {
            if target.contains("://") || target.starts_with("mailto:") {
                continue;
            }
            checked += 1;
            let (path, anchor) = target.split_once('#').map_or((target.as_str(), None), |(p, a)| (p, Some(a)));
            let file = if path.is_empty() { page.clone() } else { folder.join(path) };
            let found = file.exists()
                && anchor.is_none_or(|anchor| {
                    let text = std::fs::read_to_string(&file).unwrap_or_default();
                    anchors(&text).iter().any(|known| known == anchor)
                });
            if !found {
                missing.push(format!("{}:{line}: {target}", page.display()));
            }
        }
    }
    assert!(missing.is_empty(), "nothing there:\n{}", missing.join("\n"));
    assert!(checked >= 20, "the pages have their links: {checked}");
}

/// Whoever opens the book at its contents finds every page, in the repository as in the book that is built of it.
#[test]
fn contents_name_every_page() {
    let docs = repository("docs");
    for contents in ["README.md", "SUMMARY.md"] {
        let text = std::fs::read_to_string(docs.join(contents)).expect("the contents are there");
        for page in flank_tests::pages() {
            let name = page.strip_prefix(&docs).expect("a page of the book").to_string_lossy().replace('\\', "/");
            let is_contents = ["README.md", "SUMMARY.md"].contains(&&*name);
            assert!(is_contents || text.contains(&format!("]({name})")), "docs/{contents} does not name {name}");
        }
    }
}
