//! Options of the library as flags: its messages name them as "option `no_align`", the command line as `--no-align`.

use clap::CommandFactory;

use crate::arguments::Arguments;

const OPTION: &str = "option `";

/// A message with flags for the options that the program has: `--margin` for "option `margin`", and in backticks for "the option `margin`".
pub(crate) fn with_flags(message: &str) -> String {
    let mut out = String::new();
    let mut rest = message;
    while let Some((before, (option, behind))) =
        rest.split_once(OPTION).and_then(|(before, after)| Some((before, after.split_once('`')?)))
    {
        let (name, value) = option.split_at(option.find([' ', '=']).unwrap_or(option.len()));
        let flag = name.replace('_', "-");
        if !is_flag(&flag) {
            out += &rest[..before.len() + OPTION.len()];
            rest = &rest[before.len() + OPTION.len()..];
            continue;
        }
        match before.strip_suffix("the ") {
            Some(before) => out += &format!("{before}`--{flag}{value}`"),
            None => out += &format!("{before}--{flag}{value}"),
        }
        rest = behind;
    }
    out + rest
}

/// Whether one of the commands has it.
fn is_flag(name: &str) -> bool {
    let program = Arguments::command();
    program.get_subcommands().flat_map(clap::Command::get_arguments).any(|argument| argument.get_long() == Some(name))
}

#[cfg(test)]
mod tests {
    use super::with_flags;

    #[test]
    fn options_become_flags() {
        assert_eq!(
            with_flags("option `rows` and option `columns 3` of option `measured`"),
            "--rows and --columns 3 of --measured"
        );
        assert_eq!(with_flags("the option `set teeth=3` is given twice"), "`--set teeth=3` is given twice");
        assert_eq!(with_flags("the option `no_align` does"), "`--no-align` does");
    }

    #[test]
    fn other_words_stay() {
        for text in ["", "an option `heard of`", "option `unknown_name` and option `rows", "option"] {
            assert_eq!(with_flags(text), text);
        }
    }
}
