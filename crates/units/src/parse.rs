//! Reading a number with a unit.

use std::fmt;

use crate::table::{self, Unit};
use crate::{Dimension, UnitError};

/// A value in SI units and its dimension. `Display` prints text that [`parse`] reads back to the same bits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quantity {
    /// The value in SI units (m, kg, s, rad).
    pub value: f64,
    /// The dimension.
    pub dimension: Dimension,
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // `{:?}` is the shortest text that reads back to the same number, with an exponent where it is shorter.
        if self.dimension.is_dimensionless() {
            write!(f, "{:?}", self.value)
        } else {
            write!(f, "{:?} {}", self.value, self.dimension)
        }
    }
}

/// Reads a quantity such as `1e5 N/m`, `30 deg` or `0.5`; the grammar is in the crate documentation.
///
/// # Errors
/// Any [`UnitError`] except `WrongDimension`.
pub fn parse(text: &str) -> Result<Quantity, UnitError> {
    let trimmed = text.trim();
    let number = split_number(trimmed)?;
    let unit_text = number.rest.trim();
    let unit = if unit_text.is_empty() { ONE } else { UnitParser::new(unit_text).whole()? };
    // Decimal prefixes go into the exponent of the number, so that "3 mm" rounds once, as 3e-3 does.
    let exponent = number.exponent.saturating_add(unit.exponent);
    let decimal: f64 = format!("{}e{exponent}", number.mantissa)
        .parse()
        .map_err(|_| UnitError::BadNumber { text: text.to_string() })?;
    let value = decimal * unit.factor;
    if !value.is_finite() {
        return Err(UnitError::NotFinite { text: text.to_string() });
    }
    Ok(Quantity { value, dimension: unit.dimension })
}

/// Reads a quantity of the given dimension and returns its value in SI units.
///
/// # Errors
/// Any [`UnitError`]; `WrongDimension` when the text is a quantity of another dimension.
pub fn parse_as(text: &str, expected: Dimension) -> Result<f64, UnitError> {
    let quantity = parse(text)?;
    if quantity.dimension != expected {
        let found = quantity.dimension;
        return Err(UnitError::WrongDimension { text: text.trim().to_string(), found, expected });
    }
    Ok(quantity.value)
}

const ONE: Unit = Unit { exponent: 0, factor: 1.0, dimension: Dimension::DIMENSIONLESS };

/// A decimal number, `mantissa * 10^exponent`, and the text behind it.
struct Number<'a> {
    mantissa: &'a str,
    exponent: i32,
    rest: &'a str,
}

fn split_number(text: &str) -> Result<Number<'_>, UnitError> {
    let bytes = text.as_bytes();
    let digits = |from: usize| bytes[from..].iter().take_while(|b| b.is_ascii_digit()).count();
    let sign = usize::from(matches!(bytes.first(), Some(b'+' | b'-')));
    let unsigned = text[sign..].to_ascii_lowercase();
    if unsigned.starts_with("inf") || unsigned.starts_with("nan") {
        return Err(UnitError::NotFinite { text: text.to_string() });
    }
    let whole = digits(sign);
    let mut end = sign + whole;
    let mut count = whole;
    if bytes.get(end) == Some(&b'.') {
        let fraction = digits(end + 1);
        count += fraction;
        end += 1 + fraction;
    }
    if count == 0 {
        return Err(UnitError::BadNumber { text: text.to_string() });
    }
    let mantissa = &text[..end];
    let mut exponent = 0;
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let signed = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
        let length = digits(end + 1 + signed);
        if length > 0 {
            let stop = end + 1 + signed + length;
            let negative = bytes[end + 1] == b'-';
            // An exponent too long for i32 is as good as the largest: zero or not finite.
            let size = text[end + 1 + signed..stop].parse::<i32>().unwrap_or(i32::MAX);
            exponent = if negative { -size } else { size };
            end = stop;
        }
    }
    // "1.2.3" and "1_000" are mistyped numbers, not numbers with a unit.
    if matches!(bytes.get(end), Some(b'.' | b',' | b'_')) {
        return Err(UnitError::BadNumber { text: text.to_string() });
    }
    Ok(Number { mantissa, exponent, rest: &text[end..] })
}

/// Nested parentheses beyond this are refused, so that no input can exhaust the stack.
const MAX_DEPTH: u32 = 16;

struct UnitParser<'a> {
    text: &'a str,
    at: usize,
    depth: u32,
}

impl<'a> UnitParser<'a> {
    fn new(text: &'a str) -> Self {
        Self { text, at: 0, depth: 0 }
    }

    fn bad(&self, reason: &'static str) -> UnitError {
        UnitError::BadUnit { unit: self.text.to_string(), reason }
    }

    fn peek(&self) -> Option<char> {
        self.text[self.at..].chars().next()
    }

    fn skip_spaces(&mut self) {
        while let Some(c) = self.peek().filter(|c| c.is_whitespace()) {
            self.at += c.len_utf8();
        }
    }

    fn whole(mut self) -> Result<Unit, UnitError> {
        let unit = self.expression()?;
        match self.peek() {
            None => Ok(unit),
            Some(_) => Err(self.bad("a closing parenthesis has no partner")),
        }
    }

    /// factor { operator factor }, up to the end or a closing parenthesis.
    fn expression(&mut self) -> Result<Unit, UnitError> {
        let mut divided = false;
        self.skip_spaces();
        let mut unit = if self.peek() == Some('/') { ONE } else { self.factor()? };
        loop {
            self.skip_spaces();
            match self.peek() {
                None | Some(')') => return Ok(unit),
                Some('/') => {
                    divided = true;
                    self.at += 1;
                    let factor = self.factor()?;
                    unit = self.times(unit, self.power(factor, -1)?)?;
                }
                Some(c) => {
                    if divided {
                        return Err(self.bad("a product after `/` needs parentheses, such as `kg/(m s^2)`"));
                    }
                    if matches!(c, '*' | '.' | '·' | '⋅') {
                        self.at += c.len_utf8();
                    }
                    let factor = self.factor()?;
                    unit = self.times(unit, factor)?;
                }
            }
        }
    }

    /// A name, `1`, or a group in parentheses, with an optional power.
    fn factor(&mut self) -> Result<Unit, UnitError> {
        self.skip_spaces();
        let base = match self.peek() {
            Some('(') => self.group()?,
            Some('1') => {
                self.at += 1;
                ONE
            }
            Some(c) if is_name(c) => self.name()?,
            Some(c) if c.is_ascii_digit() => return Err(self.bad("a number stands where a unit should")),
            Some('^') => return Err(self.bad("`^` has no unit before it")),
            Some('*' | '/' | '.' | '·' | '⋅') => return Err(self.bad("two operators follow each other")),
            Some(')') => return Err(self.bad("a unit is missing before `)`")),
            Some(_) => return Err(self.bad("it holds a character that no unit has")),
            None => return Err(self.bad("it ends where a unit should follow")),
        };
        let power = self.exponent()?;
        self.power(base, power)
    }

    fn group(&mut self) -> Result<Unit, UnitError> {
        self.depth += 1;
        if self.depth > MAX_DEPTH {
            return Err(self.bad("too many parentheses"));
        }
        self.at += 1;
        let unit = self.expression()?;
        if self.peek() != Some(')') {
            return Err(self.bad("a parenthesis is not closed"));
        }
        self.at += 1;
        self.depth -= 1;
        Ok(unit)
    }

    fn name(&mut self) -> Result<Unit, UnitError> {
        let start = self.at;
        while let Some(c) = self.peek().filter(|c| is_name(*c)) {
            self.at += c.len_utf8();
        }
        let name = &self.text[start..self.at];
        table::unit(name)
            .ok_or_else(|| UnitError::UnknownUnit { unit: name.to_string(), nearest: table::nearest(name) })
    }

    /// `^2`, `^-1`, `^(-1)`, `²`, `⁻¹`; 1 when there is none.
    fn exponent(&mut self) -> Result<i8, UnitError> {
        let mut digits = String::new();
        if self.peek() == Some('^') {
            self.at += 1;
            let grouped = self.peek() == Some('(');
            self.at += usize::from(grouped);
            while let Some(c) = self.peek().filter(|c| c.is_ascii_digit() || matches!(c, '+' | '-')) {
                digits.push(c);
                self.at += 1;
            }
            if grouped {
                if self.peek() != Some(')') {
                    return Err(self.bad("a power must be a whole number"));
                }
                self.at += 1;
            }
            // A point here is a fraction, not a product: "m^0.5".
            if self.peek() == Some('.') && self.text[self.at + 1..].starts_with(|c: char| c.is_ascii_digit())
            {
                return Err(self.bad("a power must be a whole number"));
            }
        } else {
            while let Some((c, digit)) = self.peek().and_then(|c| Some((c, superscript(c)?))) {
                digits.push(digit);
                self.at += c.len_utf8();
            }
            if digits.is_empty() {
                return Ok(1);
            }
        }
        digits.parse().map_err(|_| self.bad("a power must be a whole number from -127 to 127"))
    }

    fn times(&self, a: Unit, b: Unit) -> Result<Unit, UnitError> {
        let dimension =
            a.dimension.checked_mul(b.dimension).ok_or_else(|| self.bad("a power is out of range"))?;
        Ok(Unit { exponent: a.exponent.saturating_add(b.exponent), factor: a.factor * b.factor, dimension })
    }

    fn power(&self, unit: Unit, power: i8) -> Result<Unit, UnitError> {
        let dimension =
            unit.dimension.checked_pow(power).ok_or_else(|| self.bad("a power is out of range"))?;
        let exponent = unit.exponent.saturating_mul(i32::from(power));
        Ok(Unit { exponent, factor: unit.factor.powi(i32::from(power)), dimension })
    }
}

fn is_name(c: char) -> bool {
    c.is_alphabetic() || matches!(c, '°' | 'µ' | '_' | '%')
}

fn superscript(c: char) -> Option<char> {
    Some(match c {
        '⁻' => '-',
        '⁰' => '0',
        '¹' => '1',
        '²' => '2',
        '³' => '3',
        '⁴' => '4',
        '⁵' => '5',
        '⁶' => '6',
        '⁷' => '7',
        '⁸' => '8',
        '⁹' => '9',
        _ => return None,
    })
}

#[cfg(test)]
mod tests;
