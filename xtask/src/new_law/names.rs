//! Names of a new law: folder, package, module and type.

use crate::command::Error;

/// Slots and what their laws write.
pub const SLOTS: [&str; 5] = ["normal", "cohesion", "tangential", "rolling", "torsion"];

/// Words that Rust keeps for itself and that would name the module or the type.
const KEYWORDS: [&str; 51] = [
    "abstract", "as", "async", "await", "become", "box", "break", "const", "continue", "crate", "do", "dyn",
    "else", "enum", "extern", "false", "final", "fn", "for", "gen", "if", "impl", "in", "let", "loop",
    "macro", "match", "mod", "move", "mut", "override", "priv", "pub", "ref", "return", "self", "static",
    "struct", "super", "trait", "true", "try", "type", "typeof", "unsafe", "unsized", "use", "virtual",
    "where", "while", "yield",
];

/// Types that a law's file uses, and crates that would be hidden by the new one.
const TAKEN: [&str; 34] = [
    "Api",
    "Alloc",
    "Box",
    "Catalog",
    "Columns",
    "Compiled",
    "ContactChunk",
    "ContactLaw",
    "Core",
    "Dimension",
    "DurationRule",
    "Err",
    "Form",
    "Impact",
    "LawError",
    "LawInfo",
    "None",
    "NormalSummary",
    "Ok",
    "Option",
    "Oracle",
    "PairContext",
    "ParamSpec",
    "Params",
    "Real",
    "Result",
    "Slot",
    "Some",
    "Source",
    "Stage",
    "Std",
    "Test",
    "TimeScale",
    "ValueRange",
];

/// Slot and names of a new law.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Names {
    /// Slot, as in `normal`.
    pub slot: String,
    /// Folder and end of the package name, as in `my-law`.
    pub folder: String,
}

impl Names {
    /// Reads `SLOT/NAME`.
    ///
    /// # Errors
    /// The slot is unknown, or the name does not follow the pattern; the message says what is allowed.
    pub fn parse(text: &str) -> Result<Self, Error> {
        let (slot, name) = text
            .split_once('/')
            .ok_or_else(|| Error::usage(format!("`{text}` must be SLOT/NAME, as in normal/my-law")))?;
        if !SLOTS.contains(&slot) {
            return Err(Error::usage(format!("there is no slot `{slot}`; there are {}", SLOTS.join(", "))));
        }
        let refuse = |why: &str| {
            Err(Error::usage(format!(
                "the name `{name}` {why}; allowed are words of small letters and digits that begin with a letter, joined \
                 by single hyphens, at most 40 characters, as in my-law"
            )))
        };
        let word = |word: &str| {
            word.starts_with(|first: char| first.is_ascii_lowercase())
                && word.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit())
        };
        if name.len() > 40 || !name.split('-').all(word) {
            return refuse("does not follow the pattern");
        }
        if KEYWORDS.contains(&name) {
            return refuse("is a word that Rust keeps for itself");
        }
        let names = Self { slot: slot.to_string(), folder: name.to_string() };
        if TAKEN.contains(&names.law().as_str()) {
            return refuse("is taken by something else that a law needs");
        }
        Ok(names)
    }

    /// Module and file, as in `my_law`.
    pub fn module(&self) -> String {
        self.folder.replace('-', "_")
    }

    /// Type and name in scenes, as in `MyLaw`.
    pub fn law(&self) -> String {
        self.folder.split('-').map(capital).collect()
    }

    /// Slot as the variant of the law interface, as in `Tangential`.
    pub fn variant(&self) -> String {
        capital(&self.slot)
    }
}

fn capital(word: &str) -> String {
    let mut letters = word.chars();
    letters.next().map(|first| first.to_ascii_uppercase()).into_iter().chain(letters).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn makes_all_names_from_one() {
        let names = Names::parse("tangential/soft-core2").unwrap();
        assert_eq!((names.module().as_str(), names.law().as_str()), ("soft_core2", "SoftCore2"));
        assert_eq!((names.slot.as_str(), names.variant().as_str()), ("tangential", "Tangential"));
    }

    #[test]
    fn refuses_bad_names_and_says_what_is_allowed() {
        let long = "a".repeat(41);
        let bad = [
            "",
            "My-Law",
            "my-2nd-law",
            "my_law",
            "-x",
            "x-",
            "a--b",
            "2x",
            "ä",
            "../x",
            "a b",
            "loop",
            "catalog",
            "pair-context",
            long.as_str(),
        ];
        for name in bad {
            let error = Names::parse(&format!("normal/{name}")).unwrap_err();
            assert!(error.message.contains("allowed are words") && error.code == 2, "{name}: {error}");
        }
        assert!(Names::parse("my-law").unwrap_err().message.contains("SLOT/NAME"));
        assert!(Names::parse("friction/my-law").unwrap_err().message.contains("no slot `friction`"));
    }
}
