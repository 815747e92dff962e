//! The vertices of a binary file, one behind the other.

use super::error::PlyError;
use super::header::{Encoding, Header, Kind, Others, Shape};
use super::points::{Points, Role, intensity};

/// Reads the vertices from what stands behind the header; `roles` has an entry for each of their properties.
pub(super) fn read(header: &Header<'_>, roles: &[Role], bytes: &[u8]) -> Result<Points, PlyError> {
    let Header { encoding, vertices, ref properties, ref before, .. } = *header;
    let missing = |found| PlyError::MissingVertices { promised: vertices, found };
    let mut data = Data { rest: bytes, is_big: encoding == Encoding::BigEndian };
    before.iter().try_for_each(|others| data.skip(others)).ok_or_else(|| missing(0))?;

    let least = properties.iter().map(|property| match property.shape {
        Shape::Scalar(kind) | Shape::List { length: kind, .. } => kind.size(),
    });
    let needed = least.sum::<usize>().saturating_mul(vertices);
    if data.rest.len() < needed {
        return Err(PlyError::TooShort { needed, found: data.rest.len() });
    }
    let has_color = roles.iter().any(|role| matches!(role, Role::Channel(_)));
    let mut points_m = Vec::with_capacity(vertices);
    let mut colors = has_color.then(|| Vec::with_capacity(vertices));
    for vertex in 0..vertices {
        let (mut point_m, mut color) = ([f32::NAN; 3], [0; 3]);
        for (property, &role) in properties.iter().zip(roles) {
            match property.shape {
                Shape::List { length, value } => {
                    data.skip_list(length, value).ok_or_else(|| missing(vertex))?;
                }
                Shape::Scalar(kind) => {
                    let number = data.number(kind).ok_or_else(|| missing(vertex))?;
                    match role {
                        Role::Axis(axis) => point_m[axis] = number as f32,
                        Role::Channel(channel) => {
                            let part = intensity(property.name, kind, number);
                            color[channel] =
                                part.map_err(|problem| PlyError::BadBinaryVertex { vertex, problem })?;
                        }
                        Role::Unused => {}
                    }
                }
            }
        }
        points_m.push(point_m);
        colors.iter_mut().for_each(|colors| colors.push(color));
    }
    Ok((points_m, colors))
}

/// Numbers that are left. `None` where there are too few, or a list has a length below 0.
struct Data<'a> {
    rest: &'a [u8],
    is_big: bool,
}

impl Data<'_> {
    fn number(&mut self, kind: Kind) -> Option<f64> {
        Some(match kind {
            Kind::Char => i8::from_le_bytes(self.take()?).into(),
            Kind::UChar => u8::from_le_bytes(self.take()?).into(),
            Kind::Short => i16::from_le_bytes(self.take()?).into(),
            Kind::UShort => u16::from_le_bytes(self.take()?).into(),
            Kind::Int => i32::from_le_bytes(self.take()?).into(),
            Kind::UInt => u32::from_le_bytes(self.take()?).into(),
            Kind::Float => f32::from_le_bytes(self.take()?).into(),
            Kind::Double => f64::from_le_bytes(self.take()?),
        })
    }

    /// The bytes of the next number, the least significant first.
    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (&bytes, rest) = self.rest.split_first_chunk::<N>()?;
        self.rest = rest;
        let mut bytes = bytes;
        if self.is_big {
            bytes.reverse();
        }
        Some(bytes)
    }

    fn skip_bytes(&mut self, bytes: usize) -> Option<()> {
        self.rest = self.rest.get(bytes..)?;
        Some(())
    }

    fn skip_list(&mut self, length: Kind, value: Kind) -> Option<()> {
        let length = self.number(length).filter(|&length| length >= 0.0)? as usize;
        self.skip_bytes(length.checked_mul(value.size())?)
    }

    /// Each list has a byte at least, so the time is bounded by the bytes that are there.
    fn skip(&mut self, Others { count, shapes }: &Others) -> Option<()> {
        let sizes = shapes.iter().map(|shape| match shape {
            Shape::Scalar(kind) => Some(kind.size()),
            Shape::List { .. } => None,
        });
        if let Some(size) = sizes.sum::<Option<usize>>() {
            return self.skip_bytes(count.checked_mul(size)?);
        }
        for _ in 0..*count {
            for shape in shapes {
                match *shape {
                    Shape::Scalar(kind) => self.skip_bytes(kind.size())?,
                    Shape::List { length, value } => self.skip_list(length, value)?,
                }
            }
        }
        Some(())
    }
}
