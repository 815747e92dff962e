//! The first document of a YAML text as the same values that JSON has.
//!
//! Aliases are refused: with them, a short text may stand for a very long one.

use saphyr_parser::{Event, Parser, ScalarStyle, ScanError, StrInput};
use serde_json::{Map, Number, Value};

use super::wrong;
use crate::error::{Error, Result};

/// Lists within lists that are followed.
const DEEPEST: usize = 16;

/// Reads the text up to the end of its first document.
///
/// # Errors
/// It is no YAML, or uses what cameras have no need of: aliases, lists as keys, nesting deeper than [`DEEPEST`].
pub(super) fn read(text: &str) -> Result<Value> {
    // OpenCV's own kind of first line, which YAML does not know.
    let text = match text.split_once('\n') {
        Some((first, rest)) if first.starts_with("%YAML:") => rest,
        _ => text,
    };
    let mut parser = Parser::new_from_str(text);
    loop {
        match next(&mut parser)? {
            Event::StreamStart | Event::DocumentStart(_) | Event::Nothing => {}
            event => return value(event, &mut parser, 0),
        }
    }
}

/// The value that begins with `event`.
fn value<'a>(event: Event<'a>, parser: &mut Parser<'a, StrInput<'a>>, depth: usize) -> Result<Value> {
    if depth > DEEPEST {
        return Err(wrong(format!("its lists are nested more than {DEEPEST} deep")));
    }
    match event {
        Event::Scalar(text, style, ..) => Ok(scalar(&text, style)),
        Event::SequenceStart(..) => {
            let mut list = Vec::new();
            loop {
                match next(parser)? {
                    Event::SequenceEnd => return Ok(Value::Array(list)),
                    event => list.push(value(event, parser, depth + 1)?),
                }
            }
        }
        Event::MappingStart(..) => {
            let mut fields = Map::new();
            loop {
                let name = match next(parser)? {
                    Event::MappingEnd => return Ok(Value::Object(fields)),
                    Event::Scalar(name, ..) => name.into_owned(),
                    _ => return Err(wrong("a field has no name")),
                };
                let event = next(parser)?;
                let value = value(event, parser, depth + 1)?;
                fields.insert(name, value);
            }
        }
        Event::Alias(_) => Err(wrong("aliases (*name) are not read: write the values themselves")),
        _ => Err(wrong("it is empty")),
    }
}

/// What a word stands for: a number, or text.
fn scalar(text: &str, style: ScalarStyle) -> Value {
    let number = || {
        let whole = text.parse::<u64>().ok().map(Number::from);
        whole.or_else(|| text.parse::<f64>().ok().and_then(Number::from_f64))
    };
    match style {
        ScalarStyle::Plain => number().map_or_else(|| text.into(), Value::Number),
        _ => text.into(),
    }
}

fn next<'a>(parser: &mut Parser<'a, StrInput<'a>>) -> Result<Event<'a>> {
    match parser.next_event() {
        Some(Ok((event, _))) => Ok(event),
        Some(Err(error)) => Err(not_yaml(&error)),
        None => Err(wrong("it is cut short")),
    }
}

fn not_yaml(error: &ScanError) -> Error {
    wrong(format!("line {} is no YAML: {}", error.marker().line(), error.info()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn values_are_those_of_json() {
        let text = "a: 1\nb: [1.5, -2, 3e2, .inf]\nc:\n- 'x'\n- \"7\"\n- {d: e}\nf:\n...\nrest: [";
        let expected = json!({"a": 1, "b": [1.5, -2.0, 300.0, ".inf"], "c": ["x", "7", {"d": "e"}], "f": ""});
        assert_eq!(read(text).unwrap(), expected);
    }

    #[test]
    fn what_is_not_read_is_said() {
        let deep = "[".repeat(100);
        for (text, said) in [
            ("", "it is empty"),
            ("a: &b [1]\nc: *b", "aliases (*name) are not read"),
            (&*deep, "nested more than 16 deep"),
            ("a: [1", "line "),
            ("? [a]\n: 1", "a field has no name"),
            ("a: 1\n\tb: 2", "is no YAML"),
        ] {
            let message = read(text).unwrap_err().to_string();
            assert!(message.contains(said), "{text}: {message}");
        }
    }
}
