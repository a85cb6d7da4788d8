//! Emitted functions, compiled by the compilers of their languages and run; those in JavaScript are run as they are.

use std::io::{self, Write};
use std::path::Path;
use std::process::{Command, Stdio};

use flank_expr::Language;

/// What a text is compiled with, the strictest settings of each compiler; nothing for a language that is run as it is.
fn compiler(language: Language, source: &Path, program: &Path) -> Option<Command> {
    let (name, settings, libraries): (_, &[&str], &[&str]) = match language {
        Language::C => ("cc".to_owned(), &["-std=c99", "-O2", "-Wall", "-Wextra", "-Wpedantic", "-Werror"], &["-lm"]),
        Language::Rust => {
            let rustc = std::env::var("RUSTC").unwrap_or_else(|_| "rustc".to_owned());
            (rustc, &["--edition", "2024", "-O", "-D", "warnings"], &[])
        }
        Language::JavaScript => return None,
    };
    let mut command = Command::new(name);
    command.args(settings).arg("-o").arg(program).arg(source).args(libraries);
    Some(command)
}

/// The name of the file that a program's text stands in.
fn source_name(language: Language) -> &'static str {
    match language {
        Language::C => "program.c",
        Language::Rust => "program.rs",
        Language::JavaScript => "program.mjs",
    }
}

/// The text of a program: the function, the standard input and output, and a `main`.
fn program_text(language: Language, function: &str, main: &str) -> String {
    match language {
        Language::C => {
            format!("#define _POSIX_C_SOURCE 199309L\n{function}\n#include <stdio.h>\n#include <time.h>\n{main}")
        }
        Language::Rust => format!("{function}\nuse std::io::{{Read, Write}};\n{main}"),
        Language::JavaScript => format!("{function}\nimport {{ readFileSync, writeFileSync }} from 'node:fs';\n{main}"),
    }
}

/// What a program writes that was made from an emitted function and a `main` which calls it; nothing if the compiler, or Node, is
/// not installed.
///
/// # Panics
/// With what the compiler says, if it does not like the text; if the program fails.
pub fn output_of(language: Language, function: &str, main: &str, input: &[u8]) -> Option<Vec<u8>> {
    let folder = tempfile::tempdir().expect("a folder for the program");
    let program = folder.path().join("program");
    let source = folder.path().join(source_name(language));
    std::fs::write(&source, program_text(language, function, main)).expect("the text is written");
    let mut run = match compiler(language, &source, &program) {
        Some(mut compiler) => {
            let compiled = unless_missing(compiler.output())?;
            assert!(compiled.status.success(), "{language:?}: {}", String::from_utf8_lossy(&compiled.stderr));
            Command::new(&program)
        }
        None => {
            let mut node = Command::new("node");
            node.arg(&source);
            node
        }
    };
    let mut child = unless_missing(run.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn())?;
    let mut stdin = child.stdin.take().expect("its input is a pipe");
    let input = input.to_vec();
    let writer = std::thread::spawn(move || stdin.write_all(&input));
    let output = child.wait_with_output().expect("the program ends");
    writer.join().expect("no panic").expect("all points are read");
    assert!(output.status.success(), "{language:?}: {}", output.status);
    Some(output.stdout)
}

/// Nothing if a program is not installed.
fn unless_missing<T>(started: io::Result<T>) -> Option<T> {
    match started {
        Err(error) if error.kind() == io::ErrorKind::NotFound => None,
        result => Some(result.expect("the program starts")),
    }
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
        Language::JavaScript => JAVASCRIPT_MAIN,
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

const JAVASCRIPT_MAIN: &str = "
const input = readFileSync(0);
const points = new Float64Array(input.buffer.slice(input.byteOffset, input.byteOffset + input.byteLength));
const output = [];
for (let at = 0; at < points.length; at += ARGUMENTS) {
    const point = points.subarray(at, at + ARGUMENTS);
    const values = new Float64Array(VALUES), derivatives = new Float64Array(DERIVATIVES);
    NAME(POINT, values, derivatives);
    output.push(new Uint8Array(values.buffer), new Uint8Array(derivatives.buffer));
}
writeFileSync(1, Buffer.concat(output));
";
