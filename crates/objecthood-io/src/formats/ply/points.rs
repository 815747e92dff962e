//! The vertices of a text, one a line.

use super::error::PlyError;
use super::header::{Header, Kind, Shape};
use crate::text::Lines;
use crate::text::preview;

/// What a property is used for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    /// A coordinate, by its place in a point.
    Axis(usize),
    /// A part of the colour, by its place there.
    Channel(usize),
    Unused,
}

/// The points and, if there are any, their colours.
pub(super) type Points = (Vec<[f32; 3]>, Option<Vec<[u8; 3]>>);

/// Reads the vertices; `roles` has an entry for each of their properties.
pub(super) fn read(header: &Header<'_>, roles: &[Role], mut lines: Lines<'_>) -> Result<Points, PlyError> {
    // A digit and a separator each; the last line may lack its end.
    let values = header.properties.len().saturating_mul(header.vertices);
    let needed = header.lines_before().saturating_add(values).saturating_mul(2).saturating_sub(1);
    if lines.bytes_left() < needed {
        return Err(PlyError::TooShort { needed, found: lines.bytes_left() });
    }
    let has_color = roles.iter().any(|role| matches!(role, Role::Channel(_)));
    let mut points_m = Vec::with_capacity(header.vertices);
    let mut colors = has_color.then(|| Vec::with_capacity(header.vertices));

    for (number, line) in lines.by_ref().skip(header.lines_before()).take(header.vertices) {
        let vertex = parse_vertex(line, header, roles);
        let (point_m, color) = vertex.map_err(|problem| PlyError::BadVertex { line: number, problem })?;
        points_m.push(point_m);
        if let Some(colors) = &mut colors {
            colors.push(color);
        }
    }
    if points_m.len() < header.vertices {
        return Err(PlyError::MissingVertices { promised: header.vertices, found: points_m.len() });
    }
    Ok((points_m, colors))
}

/// The point and the colour on a line; says what is wrong with the line.
fn parse_vertex(line: &[u8], header: &Header<'_>, roles: &[Role]) -> Result<([f32; 3], [u8; 3]), String> {
    const FEWER: &str = "it has fewer values than the header has properties";
    let mut words = line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
    let (mut point_m, mut color) = ([f32::NAN; 3], [0; 3]);
    for (property, &role) in header.properties.iter().zip(roles) {
        let word = words.next().ok_or(FEWER)?;
        match (property.shape, role) {
            (Shape::List { .. }, _) => {
                let length = str::from_utf8(word).ok().and_then(|word| word.parse::<u32>().ok());
                let length =
                    length.ok_or_else(|| format!("`{}` is not the length of a list", preview(word)))?;
                for _ in 0..length {
                    words.next().ok_or(FEWER)?;
                }
            }
            (Shape::Scalar(_), Role::Unused) => {}
            (Shape::Scalar(kind), Role::Axis(axis)) => {
                point_m[axis] = number(property.name, kind, word)? as f32;
            }
            (Shape::Scalar(kind), Role::Channel(channel)) => {
                color[channel] = intensity(property.name, kind, number(property.name, kind, word)?)?;
            }
        }
    }
    match words.next() {
        None => Ok((point_m, color)),
        Some(_) => Err("it has more values than the header has properties".into()),
    }
}

fn number(name: &str, kind: Kind, word: &[u8]) -> Result<f64, String> {
    let value = str::from_utf8(word).ok().and_then(|word| kind.number(word));
    value.ok_or_else(|| format!("{name} is `{}`, which is no {}", preview(word), kind.meaning()))
}

/// A part of a colour: whole numbers are from 0 to 255, others from 0 to 1.
pub(super) fn intensity(name: &str, kind: Kind, value: f64) -> Result<u8, String> {
    let (most, as_uchar) = if kind.is_whole() { (255.0, 1.0) } else { (1.0, 255.0) };
    if (0.0..=most).contains(&value) {
        return Ok((value * as_uchar).round() as u8);
    }
    let value = value as f32;
    Err(format!(
        "{name} is `{value}`, but a colour is 0 to {most} here; best save colours as uchar, 0 to 255"
    ))
}
