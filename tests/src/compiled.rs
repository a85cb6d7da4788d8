//! Emitted functions, compiled and run by the compilers of their languages.

use std::io::{self, Write};
use std::path::Path;
use std::process::{Command, Stdio};

use flank_expr::Language;

/// What a text is compiled with, the strictest settings of each compiler.
fn compiler(language: Language, source: &Path, program: &Path) -> Command {
    let mut command = match language {
        Language::C => Command::new("cc"),
        Language::Rust => Command::new(std::env::var("RUSTC").unwrap_or_else(|_| "rustc".to_owned())),
    };
    match language {
        Language::C => command.args(["-std=c99", "-O2", "-Wall", "-Wextra", "-Wpedantic", "-Werror"]),
        Language::Rust => command.args(["--edition", "2024", "-O", "-D", "warnings"]),
    };
    command.arg("-o").arg(program).arg(source);
    if language == Language::C {
        command.arg("-lm");
    }
    command
}

/// The text of a program: the function, the standard input and output, and a `main`.
fn program_text(language: Language, function: &str, main: &str) -> String {
    match language {
        Language::C => {
            format!("#define _POSIX_C_SOURCE 199309L\n{function}\n#include <stdio.h>\n#include <time.h>\n{main}")
        }
        Language::Rust => format!("{function}\nuse std::io::{{Read, Write}};\n{main}"),
    }
}

/// What a program writes that was compiled from an emitted function and a `main` which calls it; nothing if the compiler is not
/// installed.
///
/// # Panics
/// With what the compiler says, if it does not like the text; if the program fails.
pub fn output_of(language: Language, function: &str, main: &str, input: &[u8]) -> Option<Vec<u8>> {
    let folder = tempfile::tempdir().expect("a folder for the program");
    let program = folder.path().join("program");
    let source = folder.path().join(if language == Language::C { "program.c" } else { "program.rs" });
    std::fs::write(&source, program_text(language, function, main)).expect("the text is written");
    let compiled = match compiler(language, &source, &program).output() {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return None,
        result => result.expect("the compiler starts"),
    };
    assert!(compiled.status.success(), "{language:?}: {}", String::from_utf8_lossy(&compiled.stderr));
    let mut child =
        Command::new(&program).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().expect("the program starts");
    let mut stdin = child.stdin.take().expect("its input is a pipe");
    let input = input.to_vec();
    let writer = std::thread::spawn(move || stdin.write_all(&input));
    let output = child.wait_with_output().expect("the program ends");
    writer.join().expect("no panic").expect("all points are read");
    assert!(output.status.success(), "{language:?}: {}", output.status);
    Some(output.stdout)
}

/// Values and derivatives of an emitted function at points, one array for each point; nothing if the compiler is not installed.
///
/// # Panics
/// As [`output_of`].
pub fn values_at<const ARGUMENTS: usize>(
    language: Language,
    (name, function): (&str, &str),
    outputs: usize,
    points: &[[f64; ARGUMENTS]],
) -> Option<Vec<Vec<f64>>> {
    let main = match language {
        Language::C => C_MAIN,
        Language::Rust => RUST_MAIN,
    };
    let call: Vec<String> = (0..ARGUMENTS).map(|k| format!("point[{k}]")).collect();
    let main = main
        .replace("NAME", name)
        .replace("POINT", &call.join(", "))
        .replace("ARGUMENTS", &ARGUMENTS.to_string())
        .replace("DERIVATIVES", &(outputs * ARGUMENTS).to_string())
        .replace("VALUES", &outputs.to_string());
    let input: Vec<u8> = points.iter().flatten().flat_map(|x| x.to_ne_bytes()).collect();
    let bytes = output_of(language, function, &main, &input)?;
    let numbers: Vec<f64> =
        bytes.chunks_exact(8).map(|bytes| f64::from_ne_bytes(bytes.try_into().expect("eight bytes"))).collect();
    let rows: Vec<Vec<f64>> = numbers.chunks(outputs * (1 + ARGUMENTS)).map(<[f64]>::to_vec).collect();
    assert_eq!(rows.len(), points.len());
    Some(rows)
}

const C_MAIN: &str = "
int main(void)
{
    double point[ARGUMENTS], values[VALUES], derivatives[DERIVATIVES];
    while (fread(point, sizeof(double), ARGUMENTS, stdin) == ARGUMENTS) {
        NAME(POINT, values, derivatives);
        fwrite(values, sizeof(double), VALUES, stdout);
        fwrite(derivatives, sizeof(double), DERIVATIVES, stdout);
    }
    return 0;
}
";

const RUST_MAIN: &str = "
fn main() {
    let mut input = Vec::new();
    std::io::stdin().read_to_end(&mut input).unwrap();
    let numbers: Vec<f64> = input.chunks_exact(8).map(|b| f64::from_ne_bytes(b.try_into().unwrap())).collect();
    let mut output = Vec::new();
    for point in numbers.chunks_exact(ARGUMENTS) {
        let (mut values, mut derivatives) = ([f64::NAN; VALUES], [f64::NAN; DERIVATIVES]);
        NAME(POINT, &mut values, &mut derivatives);
        output.extend(values.iter().chain(&derivatives).flat_map(|x| x.to_ne_bytes()));
    }
    std::io::stdout().write_all(&output).unwrap();
}
";
