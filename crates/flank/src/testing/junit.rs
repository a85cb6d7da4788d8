//! Results of tests for servers that build software: JUnit's XML.

use std::fmt::Write;

use crate::testing::result::{TestResult, TestedSpec};

/// A result as JUnit's XML: a suite for each spec, a case for each expectation.
pub fn junit(result: &TestResult) -> String {
    let mut out = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    let tests = result.passed + result.failed;
    let _ = writeln!(out, "<testsuites name=\"flank\" tests=\"{tests}\" failures=\"{}\">", result.failed);
    result.specs.iter().filter(|spec| spec.says_something()).for_each(|spec| suite(spec, &mut out));
    out += "</testsuites>\n";
    out
}

fn suite(spec: &TestedSpec, out: &mut String) {
    let (file, tests) = (escaped(&spec.file), spec.passed() + spec.failed());
    let _ = writeln!(out, "  <testsuite name=\"{file}\" tests=\"{tests}\" failures=\"{}\">", spec.failed());
    let mut case = |of: &str, name: &str, failure: Option<String>| {
        let (of, name) = (escaped(of), escaped(name));
        let _ = match failure {
            None => writeln!(out, "    <testcase classname=\"{of}\" name=\"{name}\"/>"),
            Some(text) => {
                let text = escaped(&text);
                writeln!(
                    out,
                    "    <testcase classname=\"{of}\" name=\"{name}\"><failure message=\"{text}\"/></testcase>"
                )
            }
        };
    };
    for item in &spec.items {
        for expectation in &item.expectations {
            let place = &expectation.place;
            let at = format!("{}:{}:{}", place.file, place.line, place.column);
            let told = || [&[at, expectation.found.clone()], &expectation.details[..]].concat().join("; ");
            case(&item.name, &expectation.expected, (!expectation.holds).then(told));
        }
    }
    if let Some(why) = &spec.failure {
        case("spec", "can be tested", Some(why.clone()));
    }
    if spec.is_wrong() {
        case("spec", "is right", Some(spec.findings.rendered(false)));
    }
    if let Some(snapshot) = &spec.snapshot {
        case("snapshot", &snapshot.file, snapshot.differs().then(|| snapshot.differences.join("; ")));
    }
    *out += "  </testsuite>\n";
}

fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => out += "&amp;",
            '<' => out += "&lt;",
            '>' => out += "&gt;",
            '"' => out += "&quot;",
            '\n' => out += "&#10;",
            // no other control characters stand in XML
            letter if letter.is_control() => out.push(' '),
            letter => out.push(letter),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signs_of_xml_are_written_so_that_they_are_none() {
        assert_eq!(escaped("a < b & \"c\"\n\u{1}"), "a &lt; b &amp; &quot;c&quot;&#10; ");
    }
}
