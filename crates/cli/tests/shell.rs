//! Completions and manual pages.

mod support;

use std::process::Command;

use support::{flank, folder, text};

#[test]
fn every_shell_gets_a_script_that_knows_the_commands() {
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let run = flank(&["completions", shell]);
        assert!(run.status.success());
        let script = text(&run.stdout);
        ["solve", "convert", "--tolerance"].into_iter().for_each(|word| {
            let word = if shell == "fish" { word.trim_start_matches("--") } else { word };
            assert!(script.contains(word), "{shell}: {word}");
        });
    }
    let run = flank(&["completions", "cmd"]);
    assert_eq!(run.status.code(), Some(2));
    assert!(text(&run.stderr).contains("possible values: bash"), "{}", text(&run.stderr));
}

#[test]
fn bash_takes_its_script() {
    let script = text(&flank(&["completions", "bash"]).stdout);
    let asked = format!(
        "{script}\nCOMP_WORDS=(flank so); COMP_CWORD=1; _flank flank so flank; printf '%s\\n' \"${{COMPREPLY[@]}}\""
    );
    let Ok(run) = Command::new("bash").args(["-c", &asked]).output() else {
        eprintln!("skipped 1 of 1 shells: bash is not installed");
        return;
    };
    assert_eq!(text(&run.stdout).trim(), "solve", "{}", text(&run.stderr));
}

#[test]
fn each_command_has_a_manual_page() {
    let out = folder("man");
    let run = flank(&["man", "--out", out.to_str().expect("a plain path")]);
    assert!(run.status.success(), "{}", text(&run.stderr));
    let help = text(&flank(&["--help"]).stdout);
    let listed = help.lines().skip_while(|line| *line != "Commands:").skip(1).take_while(|line| !line.is_empty());
    // long descriptions go on, further in
    let listed = listed.filter(|line| !line.starts_with("   "));
    for command in listed.filter_map(|line| line.split_whitespace().next()).filter(|name| *name != "help") {
        let page = std::fs::read_to_string(out.join(format!("flank-{command}.1"))).expect("a page for each command");
        assert!(page.contains(".SH NAME") && page.contains(&format!("flank\\-{command}")), "{page}");
    }
    assert!(std::fs::read_to_string(out.join("flank.1")).expect("written").contains("Exit codes"));
}
