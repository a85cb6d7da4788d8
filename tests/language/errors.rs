//! Every page of `docs/errors` says what is so: its wrong texts give its code and the report it quotes, its right ones nothing.
//!
//! `UPDATE_PAGES=1 cargo test -p flank-tests --test errors` writes what is reported now into the pages, to be read before
//! it is believed.

use std::path::{Path, PathBuf};

use flank_chain_dsl::{Code, Compilation, Diagnostic, compile_file, compile_text, limits::Limit, render};
use flank_expr::Graph;
use flank_tests::repository;

/// Where the readers of a page keep their files.
const HOME: &str = "/home/ada/gears";

/// A fenced block of a page: what stands behind the fence, its lines with their ends, where they stand.
struct Block {
    kind: String,
    text: String,
    start: usize,
}

fn blocks(page: &str) -> Vec<Block> {
    let mut blocks: Vec<Block> = Vec::new();
    let mut is_open = false;
    let mut at = 0;
    for line in page.split_inclusive('\n') {
        at += line.len();
        match (is_open, line.trim_end().strip_prefix("```")) {
            (false, Some(kind)) => blocks.push(Block { kind: kind.to_string(), text: String::new(), start: at }),
            (true, None) => blocks.last_mut().expect("an open block").text.push_str(line),
            _ => {}
        }
        is_open ^= line.starts_with("```");
    }
    assert!(!is_open, "a block is not closed");
    blocks
}

/// The findings on a block, with the report as a reader of the page would see it.
fn findings(code: Code, block: &Block) -> (Vec<Diagnostic>, String) {
    let graph = Graph::new();
    if !block.kind.ends_with(",files") {
        let mut compilation = compile_text(&graph, "example.chain", &block.text, &[]);
        let report = report(&mut compilation, code);
        return (compilation.diagnostics, report);
    }
    let (folder, main) = project(code, block);
    let mut compilation = compile_file(&graph, &main, &[]);
    let folder = folder.to_str().expect("a plain path").to_string();
    let report = report(&mut compilation, code).replace(&format!("{folder}/"), "").replace(&folder, HOME);
    (compilation.diagnostics, report)
}

/// The report; for the code about missing jobs, jobs are asked for as the command line does.
fn report(compilation: &mut Compilation<'_>, code: Code) -> String {
    if code == Code::NoJob && !compilation.has_errors() {
        let missing = compilation.take_jobs(&[""; 0]).err();
        compilation.diagnostics.extend(missing.into_iter().flatten());
    }
    render(&compilation.diagnostics, &compilation.sources, false)
}

/// Writes the files of a block, which begin with lines like `// jobs/gear.chain`; gives their folder and the first file.
fn project(code: Code, block: &Block) -> (PathBuf, PathBuf) {
    let is_wrong = block.kind.contains("wrong");
    let name = format!("{}-{}", code.as_str(), if is_wrong { "wrong" } else { "right" });
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("errors").join(name);
    let _ = std::fs::remove_dir_all(&folder);
    let mut files: Vec<(PathBuf, String)> = Vec::new();
    for line in block.text.split_inclusive('\n') {
        match line.trim_end().strip_prefix("// ").filter(|path| path.ends_with(".chain") || path.ends_with(".csv")) {
            Some(path) => files.push((folder.join(path), String::new())),
            None => files.last_mut().expect("a block of files begins with a path").1.push_str(line),
        }
    }
    for (path, text) in &files {
        std::fs::create_dir_all(path.parent().expect("a folder")).expect("a folder for the test");
        std::fs::write(path, text).expect("a file of the test");
    }
    std::fs::write(folder.join("flank.toml"), "").expect("a file of the test");
    let folder = folder.canonicalize().expect("the folder is there");
    let main = files[0].0.canonicalize().expect("the file is there");
    (folder, main)
}

/// A page with the reports that its wrong blocks give now.
fn updated(code: Code, page: &str) -> String {
    let mut out = String::new();
    let mut done = 0;
    let mut last = None;
    for block in blocks(page) {
        if block.kind.contains("wrong") {
            last = Some(findings(code, &block).1);
        } else if let Some(report) = last.take() {
            out += &page[done..block.start];
            out += &report;
            done = block.start + block.text.len();
        }
    }
    out + &page[done..]
}

#[test]
fn every_page_says_what_is_so() {
    for &code in Code::ALL {
        let path = repository(&format!("docs/errors/{}.md", code.as_str()));
        let mut page = std::fs::read_to_string(&path).expect("every code has its page");
        if std::env::var_os("UPDATE_PAGES").is_some() {
            page = updated(code, &page);
            std::fs::write(&path, &page).expect("a writable page");
        } else {
            assert_eq!(page.replace('\r', ""), code.page().replace('\r', ""), "the page in the program");
        }
        check(code, &page);
    }
}

fn check(code: Code, page: &str) {
    let name = code.as_str();
    assert_eq!(page.lines().next(), Some(format!("# {name}: {}", code.title()).as_str()));
    assert!(page.contains("\nOther causes:\n\n- "), "{name} says what else may cause it");
    let blocks = blocks(page);
    let (mut wrong, mut right) = (0, 0);
    for (k, block) in blocks.iter().enumerate() {
        match block.kind.trim_end_matches(",files") {
            "chain,wrong" => {
                wrong += 1;
                let (found, report) = findings(code, block);
                let codes: Vec<&str> = found.iter().map(|finding| finding.code.as_str()).collect();
                assert_eq!(codes, [name], "a wrong block of {name}:\n{report}");
                let quoted = blocks.get(k + 1).filter(|next| next.kind == "text");
                let quoted = quoted.expect("the report stands behind the wrong block");
                assert_eq!(quoted.text, report, "the report on the page {name}");
            }
            "chain" => {
                right += 1;
                let (found, report) = findings(code, block);
                assert!(found.is_empty(), "a right block of {name}:\n{report}");
            }
            "text" => {}
            other => panic!("{name} has a block of an unknown kind `{other}`"),
        }
    }
    assert!(wrong > 0 && right > 0, "{name} shows what is wrong and what is right");
}

#[test]
fn pages_and_index_name_each_code_once() {
    let index = std::fs::read_to_string(repository("docs/errors/README.md")).expect("the index is there");
    let rows: Vec<&str> = index.lines().filter(|line| line.starts_with("| [")).collect();
    let row = |code: &Code| format!("| [{0}]({0}.md) | {1} |", code.as_str(), code.title());
    assert_eq!(rows, Code::ALL.iter().map(row).collect::<Vec<_>>());
    let mut files: Vec<String> = std::fs::read_dir(repository("docs/errors"))
        .expect("the folder is there")
        .map(|entry| entry.expect("an entry").file_name().into_string().expect("a plain name"))
        .filter(|name| name != "README.md")
        .collect();
    files.sort();
    assert_eq!(files, Code::ALL.iter().map(|code| format!("{}.md", code.as_str())).collect::<Vec<_>>());
}

#[test]
fn pages_are_readable_in_a_terminal() {
    for code in Code::ALL {
        let too_wide = code.page().lines().find(|line| line.chars().count() > 120);
        assert_eq!(too_wide, None, "{}", code.as_str());
    }
}

/// The same table on the page of the error and in the language reference, made from the limits themselves.
#[test]
fn the_limits_are_stated_as_they_are() {
    let rows = Limit::ALL.iter().map(|limit| format!("| {} | {} |\n", limit.what, limit.stated()));
    let table = format!("| what | at most |\n| --- | --- |\n{}\n", rows.collect::<String>());
    for path in ["docs/errors/E0004.md", "docs/language.md"] {
        let mut page = std::fs::read_to_string(repository(path)).expect("the page is there").replace('\r', "") + "\n";
        if std::env::var_os("UPDATE_PAGES").is_some() {
            let start = page.find("| what | at most |").expect("a table of limits");
            let end = start + page[start..].find("\n\n").expect("the end of the table") + 2;
            page.replace_range(start..end, &table);
            std::fs::write(repository(path), page.trim_end().to_string() + "\n").expect("a writable page");
        }
        assert!(page.contains(&table), "the table of limits in {path} should be\n{table}");
    }
}
