//! Reads values and blocks, and collects what is wrong with them.

use std::ops::Range;

use granule_units::{Dimension, parse_as};

use crate::scene::{Spanned, Vector};
use crate::spec::Block;
use crate::syntax::{Entry, Node};
use crate::{Diagnostic, nearest, suggestion};

/// Which numbers are allowed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Allowed {
    /// Finite.
    Any,
    /// Finite or infinite.
    Infinite,
    /// Greater than 0.
    Positive,
    /// At least 0.
    NonNegative,
    /// At least this.
    AtLeast(f64),
    /// Greater than 0 and at most 1.
    PositiveUnit,
    /// Greater than 0 and less than 1.
    InsideUnit,
}

impl Allowed {
    fn admits(self, value: f64) -> bool {
        match self {
            Self::Infinite => !value.is_nan(),
            _ if !value.is_finite() => false,
            Self::Any => true,
            Self::Positive => value > 0.0,
            Self::NonNegative => value >= 0.0,
            Self::AtLeast(least) => value >= least,
            Self::PositiveUnit => value > 0.0 && value <= 1.0,
            Self::InsideUnit => value > 0.0 && value < 1.0,
        }
    }

    fn describe(self, value: f64) -> String {
        match self {
            Self::Infinite => "a number".to_string(),
            _ if !value.is_finite() => "finite".to_string(),
            Self::Any => "finite".to_string(),
            Self::Positive => "greater than 0".to_string(),
            Self::NonNegative => "at least 0".to_string(),
            Self::AtLeast(least) => format!("at least {least}"),
            Self::PositiveUnit => "greater than 0 and at most 1".to_string(),
            Self::InsideUnit => "greater than 0 and less than 1".to_string(),
        }
    }
}

/// The fields of one block.
pub struct Fields<'a> {
    block: &'static Block,
    entries: Vec<Entry<'a>>,
}

impl<'a> Fields<'a> {
    /// The value of a field, if it is given.
    pub fn get(&self, name: &str) -> Option<Node<'a>> {
        debug_assert!(self.block.names().contains(&name), "{} has no field {name}", self.block.name);
        self.entries.iter().find(|entry| entry.name == name).map(|entry| entry.value)
    }

    /// The fields that are given and known.
    pub fn entries(&self) -> Vec<Entry<'a>> {
        let names = self.block.names();
        self.entries.iter().filter(|entry| names.contains(&entry.name.as_str())).cloned().collect()
    }
}

/// A name followed by content in parentheses, or not.
#[derive(Clone, Debug)]
pub struct Variant<'a> {
    /// The name.
    pub name: &'a str,
    /// Where it stands.
    pub span: Range<usize>,
    /// The content.
    pub content: Option<Node<'a>>,
}

/// Collects problems.
#[derive(Default)]
pub struct Reader {
    /// All problems so far.
    pub diagnostics: Vec<Diagnostic>,
}

impl Reader {
    /// Records an error.
    pub fn error(&mut self, span: Range<usize>, message: impl Into<String>, help: impl Into<String>) {
        let help = help.into();
        let error = Diagnostic::error(span, message);
        self.diagnostics.push(if help.is_empty() { error } else { error.help(help) });
    }

    /// Opens a block: unknown, repeated and missing fields are reported. `at` is where a missing field is reported.
    pub fn block<'a>(
        &mut self,
        node: Option<Node<'a>>,
        block: &'static Block,
        at: Range<usize>,
    ) -> Option<Fields<'a>> {
        let entries = match node {
            None => Vec::new(),
            Some(node) => {
                let empty = node.items().is_some_and(|items| items.is_empty());
                match node.fields() {
                    Some(entries) => entries,
                    None if empty => Vec::new(),
                    None => {
                        self.error(
                            node.span(),
                            format!(
                                "{} needs named fields in parentheses, not `{}`",
                                block.name,
                                node.quoted()
                            ),
                            format!("fields: {}", block.names().join(", ")),
                        );
                        return None;
                    }
                }
            }
        };
        let names = block.names();
        for (index, entry) in entries.iter().enumerate() {
            if !names.contains(&entry.name.as_str()) {
                let message = format!("unknown field `{}` in {}", entry.name, block.name);
                self.error(entry.span.clone(), message, suggestion("fields", &entry.name, &names));
            } else if entries[..index].iter().any(|earlier| earlier.name == entry.name) {
                self.error(entry.span.clone(), format!("field `{}` is given twice", entry.name), "");
            }
        }
        for field in block.fields.iter().filter(|field| field.default.is_none()) {
            if !entries.iter().any(|entry| entry.name == field.name) {
                // An unknown name that is near was meant to be this field, and is reported already.
                let slip = entries.iter().any(|entry| {
                    !names.contains(&entry.name.as_str())
                        && nearest(&entry.name, names.iter().copied()) == Some(field.name)
                });
                if !slip {
                    let message = format!("missing field `{}` in {}", field.name, block.name);
                    self.error(at.clone(), message, format!("{}: {}", field.name, field.takes));
                }
            }
        }
        Some(Fields { block, entries })
    }

    /// A number in SI units, or a text with a unit.
    pub fn quantity(
        &mut self,
        name: &str,
        node: Node<'_>,
        dimension: Dimension,
        allowed: Allowed,
    ) -> Option<Spanned<f64>> {
        let value = if let Some(text) = node.string() {
            match parse_as(&text, dimension) {
                Ok(value) => value,
                Err(error) => {
                    self.error(node.span(), format!("`{name}`: {error}"), "");
                    return None;
                }
            }
        } else if let Some(number) = node.number() {
            number
        } else {
            let kind = match dimension.name() {
                _ if dimension.is_dimensionless() => "a number".to_string(),
                Some(kind) => format!("a number in {dimension}, or text with a unit of {kind}"),
                None => format!("a number in {dimension}, or text with such a unit"),
            };
            self.error(node.span(), format!("`{name}` must be {kind}, not `{}`", node.quoted()), "");
            return None;
        };
        if !allowed.admits(value) {
            let message = format!("`{name}` must be {}, not {}", allowed.describe(value), node.quoted());
            self.error(node.span(), message, "");
            return None;
        }
        Some(Spanned::new(value, node.span()))
    }

    /// A vector of quantities. The number of components is checked against the dimensions later; it is 2 or 3 here.
    pub fn vector(
        &mut self,
        name: &str,
        node: Node<'_>,
        dimension: Dimension,
        allowed: Allowed,
    ) -> Option<Vector> {
        let items = node.items().filter(|items| (2..=3).contains(&items.len()));
        let Some(items) = items else {
            self.error(
                node.span(),
                format!("`{name}` must be a vector such as (0, 0, 1), not `{}`", node.quoted()),
                "two components in 2 dimensions, three in 3",
            );
            return None;
        };
        let components: Vec<Option<Spanned<f64>>> =
            items.into_iter().map(|item| self.quantity(name, item, dimension, allowed)).collect();
        Some(Vector { components: components.into_iter().collect::<Option<_>>()?, span: node.span() })
    }

    /// A text.
    pub fn string(&mut self, name: &str, node: Node<'_>) -> Option<Spanned<String>> {
        match node.string() {
            Some(text) => Some(Spanned::new(text, node.span())),
            None => {
                self.error(
                    node.span(),
                    format!("`{name}` must be a text in quotes, not `{}`", node.quoted()),
                    "",
                );
                None
            }
        }
    }

    /// `true` or `false`.
    pub fn boolean(&mut self, name: &str, node: Node<'_>) -> Option<bool> {
        let value = node.boolean();
        if value.is_none() {
            self.error(node.span(), format!("`{name}` must be true or false, not `{}`", node.quoted()), "");
        }
        value
    }

    /// A whole number within bounds.
    pub fn whole(&mut self, name: &str, node: Node<'_>, least: u64, most: u64) -> Option<Spanned<u64>> {
        match node.whole_number().filter(|value| (least..=most).contains(value)) {
            Some(value) => Some(Spanned::new(value, node.span())),
            None => {
                let range = match (least, most) {
                    _ if most - least == 1 => format!("{least} or {most}"),
                    (0, u64::MAX) => "a whole number".to_string(),
                    (_, u64::MAX) => format!("a whole number from {least}"),
                    _ => format!("a whole number from {least} to {most}"),
                };
                self.error(node.span(), format!("`{name}` must be {range}, not `{}`", node.quoted()), "");
                None
            }
        }
    }

    /// A list.
    pub fn list<'a>(&mut self, name: &str, node: Node<'a>) -> Option<Vec<Node<'a>>> {
        let items = node.items();
        if items.is_none() {
            let message = format!("`{name}` must be a list such as [a, b], not `{}`", node.quoted());
            self.error(node.span(), message, "");
        }
        items
    }

    /// A map of names to values; names must not repeat.
    pub fn named<'a>(&mut self, name: &str, node: Node<'a>) -> Option<Vec<(Spanned<String>, Node<'a>)>> {
        let Some(entries) = node.map() else {
            let message =
                format!("`{name}` must be a map such as {{ \"name\": .. }}, not `{}`", node.quoted());
            self.error(node.span(), message, "");
            return None;
        };
        let mut named: Vec<(Spanned<String>, Node<'a>)> = Vec::new();
        for (key, value) in entries {
            let Some(key) = self.string("name", key) else { continue };
            if named.iter().any(|(earlier, _)| earlier.value == key.value) {
                self.error(key.span, format!("`{}` is given twice in `{name}`", key.value), "");
            } else {
                named.push((key, value));
            }
        }
        Some(named)
    }

    /// `Name` or `Name(..)`.
    pub fn variant<'a>(&mut self, name: &str, node: Node<'a>, known: &[&str]) -> Option<Variant<'a>> {
        let found = node.variant().filter(|(name, _, _)| !matches!(*name, "true" | "false" | "inf" | "NaN"));
        let Some((variant, span, content)) = found else {
            let message = format!("`{name}` cannot be `{}`", node.quoted());
            self.error(node.span(), message, format!("allowed: {}", known.join(", ")));
            return None;
        };
        if !known.is_empty() && !known.contains(&variant) {
            self.error(
                span,
                format!("`{name}` cannot be `{variant}`"),
                suggestion("allowed", variant, known),
            );
            return None;
        }
        Some(Variant { name: variant, span, content })
    }

    /// A choice without content.
    pub fn choice<T: Copy>(&mut self, name: &str, node: Node<'_>, table: &[(&str, T)]) -> Option<Spanned<T>> {
        let known: Vec<&str> = table.iter().map(|(name, _)| *name).collect();
        let variant = self.variant(name, node, &known)?;
        if let Some(content) = variant.content {
            self.error(content.span(), format!("`{}` takes nothing in parentheses", variant.name), "");
            return None;
        }
        let (_, value) = table.iter().find(|(name, _)| *name == variant.name)?;
        Some(Spanned::new(*value, variant.span))
    }

    /// Reads a field that may be absent. `None`: it could not be read; `Some(None)`: it is absent.
    pub fn optional<'a, T>(
        &mut self,
        fields: &Fields<'a>,
        name: &str,
        read: impl FnOnce(&mut Self, &str, Node<'a>) -> Option<T>,
    ) -> Option<Option<T>> {
        match fields.get(name) {
            None => Some(None),
            Some(node) => read(self, name, node).map(Some),
        }
    }

    /// Reads a field that must be given; its absence is reported by [`Self::block`].
    pub fn required<'a, T>(
        &mut self,
        fields: &Fields<'a>,
        name: &str,
        read: impl FnOnce(&mut Self, &str, Node<'a>) -> Option<T>,
    ) -> Option<T> {
        read(self, name, fields.get(name)?)
    }
}
