//! `cargo xtask new-law`: a law crate that compiles, registers and has its page, and whose conformance test fails until its
//! closed form is filled in.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::command::{Error, cargo, run};
use crate::{files, pages};

mod names;
mod template;

pub use names::{Names, SLOTS};
pub use template::FILL_IN;

/// What the user asked for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Options {
    /// Slot and name.
    pub names: Names,
    /// Folder outside of the project, if the law is to live there.
    pub external: Option<PathBuf>,
}

impl Options {
    /// Reads the words after `new-law`.
    ///
    /// # Errors
    /// The name is missing or not allowed, or an option is unknown.
    pub fn parse(words: &[String]) -> Result<Self, Error> {
        let mut law = None;
        let mut external = None;
        let mut words = words.iter();
        while let Some(word) = words.next() {
            match word.as_str() {
                "--external" => {
                    let folder = words.next().filter(|folder| !folder.starts_with('-'));
                    external =
                        Some(PathBuf::from(folder.ok_or_else(|| Error::usage("--external needs a folder"))?));
                }
                option if option.starts_with('-') => {
                    return Err(Error::usage(format!(
                        "new-law does not know `{option}`; it takes --external DIR"
                    )));
                }
                name if law.is_none() => law = Some(Names::parse(name)?),
                extra => {
                    return Err(Error::usage(format!(
                        "new-law makes one law at a time, but got `{extra}`, too"
                    )));
                }
            }
        }
        let names = law.ok_or_else(|| Error::usage("new-law needs SLOT/NAME, as in normal/my-law"))?;
        Ok(Self { names, external })
    }
}

/// Writes the law, and for a law of this project its page; says what to do next.
///
/// # Errors
/// The name is taken, the folder is not empty, or something cannot be written or built.
pub fn new_law(root: &Path, options: &Options) -> Result<(), Error> {
    let names = &options.names;
    let law = names.law();
    let module = names.module();
    match &options.external {
        None => {
            let written = inside(root, names)?;
            let packages = ["-p", "granule-laws", "-p", &format!("granule-law-{}", names.folder)];
            run(Command::new(cargo()).arg("fmt").args(packages).current_dir(root))?;
            pages::pages(root)?;
            report(&written);
            println!("docs/laws/{law}.md");
            println!(
                "\nnext: fill in what laws/{folder}/src/{module}.rs asks for, until\n  \
                 cargo test -p granule-law-{folder}\npasses; then `cargo xtask pages` and `cargo xtask ci`",
                folder = names.folder
            );
        }
        Some(folder) => {
            let written = outside(root, folder, names)?;
            report(&written);
            println!(
                "\nnext, in {}: fill in what {name}/src/{module}.rs asks for, until\n  cargo test -p {name}\npasses; then\n  \
                 cargo run --release -- run scene.ron",
                folder.display(),
                name = names.folder
            );
        }
    }
    Ok(())
}

fn report(written: &[PathBuf]) {
    for path in written {
        println!("{}", path.display());
    }
}

/// Writes a law crate into laws/ and links it; returns what was written, relative to the root.
///
/// # Errors
/// The name is taken, or a file cannot be read or written. Nothing is written if the name is taken.
pub fn inside(root: &Path, names: &Names) -> Result<Vec<PathBuf>, Error> {
    refuse_taken(root, names)?;
    let workspace = root.join("Cargo.toml");
    let catalog = root.join("laws/catalog/Cargo.toml");
    let library = root.join("laws/catalog/src/lib.rs");
    let folder = &names.folder;
    let changes = [
        (
            &workspace,
            insert(
                &files::read(&workspace)?,
                &format!("granule-law-{folder} = {{ path = \"laws/{folder}\" }}"),
                |line| line.starts_with("granule-law-") && line.contains("path = \"laws/"),
            ),
        ),
        (
            &catalog,
            insert(&files::read(&catalog)?, &format!("granule-law-{folder}.workspace = true"), |line| {
                line.starts_with("granule-law-")
            }),
        ),
        (
            &library,
            insert(&files::read(&library)?, &format!("use granule_law_{} as _;", names.module()), |line| {
                line.starts_with("use granule_law_") && line.ends_with(" as _;")
            }),
        ),
    ];
    let mut edits = Vec::new();
    for (path, text) in changes {
        let text = text.ok_or_else(|| {
            Error::new(format!(
                "{}: there is no line of another law to put the new one beside",
                path.display()
            ))
        })?;
        edits.push((path, text));
    }
    let base = Path::new("laws").join(folder);
    let mut written = Vec::new();
    for (path, text) in [
        (base.join("Cargo.toml"), template::manifest(names)),
        (base.join("src/lib.rs"), template::library(names)),
        (base.join(format!("src/{}.rs", names.module())), template::source(names)),
    ] {
        files::write(&root.join(&path), &text)?;
        written.push(path);
    }
    for (path, text) in edits {
        files::write(path, &text)?;
        written.push(path.strip_prefix(root).unwrap_or(path).to_path_buf());
    }
    Ok(written)
}

/// Writes a law crate and a program that links it with the granule command into a folder outside of the project; returns
/// what was written.
///
/// # Errors
/// The name is taken, the folder is inside the project or not empty, or a file cannot be written.
pub fn outside(root: &Path, folder: &Path, names: &Names) -> Result<Vec<PathBuf>, Error> {
    refuse_taken(root, names)?;
    std::fs::create_dir_all(folder).map_err(|error| Error::file(folder, &error))?;
    let absolute = |path: &Path| path.canonicalize().map_err(|error| Error::file(path, &error));
    let (root, folder) = (absolute(root)?, absolute(folder)?);
    if folder.starts_with(&root) {
        return Err(Error::new(format!(
            "{} is inside the project; leave --external out to put the law into laws/",
            folder.display()
        )));
    }
    if !files::entries(&folder)?.is_empty() {
        return Err(Error::new(format!("{} is not empty; name a new folder", folder.display())));
    }
    let granule = root.to_string_lossy().replace('\\', "/");
    let law = folder.join(&names.folder);
    let program = folder.join(format!("{}-granule", names.folder));
    let mut written = Vec::new();
    for (path, text) in [
        (folder.join("Cargo.toml"), template::external_workspace(names, &granule)),
        (folder.join("scene.ron"), template::external_scene(names)),
        (folder.join(".gitignore"), "/target\n/out\n".to_string()),
        (law.join("Cargo.toml"), template::external_law(names)),
        (law.join("src/lib.rs"), template::library(names)),
        (law.join(format!("src/{}.rs", names.module())), template::source(names)),
        (program.join("Cargo.toml"), template::external_program(names)),
        (program.join("src/main.rs"), template::external_main(names)),
        // The versions that the project is tested with.
        (folder.join("Cargo.lock"), files::read(&root.join("Cargo.lock"))?),
    ] {
        files::write(&path, &text)?;
        written.push(path);
    }
    Ok(written)
}

fn refuse_taken(root: &Path, names: &Names) -> Result<(), Error> {
    let folder = root.join("laws").join(&names.folder);
    if folder.exists() {
        return Err(Error::new(format!("{} exists; choose another name", folder.display())));
    }
    let law = names.law();
    let declaration = format!("name: \"{law}\"");
    for path in files::project(root)?.iter().filter(|path| path.starts_with("laws/") && path.ends_with(".rs"))
    {
        if files::read(&root.join(path))?.contains(&declaration) {
            return Err(Error::new(format!("{path} has a law `{law}` already; choose another name")));
        }
    }
    Ok(())
}

/// Inserts a line into the sorted block of lines that `belongs` recognises; `None` if there is no such line.
fn insert(text: &str, new: &str, belongs: impl Fn(&str) -> bool) -> Option<String> {
    let lines: Vec<&str> = text.lines().collect();
    let last = lines.iter().rposition(|line| belongs(line))?;
    let at = lines.iter().position(|line| belongs(line) && *line > new).unwrap_or(last + 1);
    let mut out: Vec<&str> = lines[..at].to_vec();
    out.push(new);
    out.extend(&lines[at..]);
    Some(out.join("\n") + "\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn project() -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        for (path, text) in [
            (
                "Cargo.toml",
                "[workspace.dependencies]\ngranule-law-api = { path = \"crates/law-api\" }\n\
                 granule-law-b = { path = \"laws/b\" }\n\nserde = \"1\"\n",
            ),
            ("Cargo.lock", "version = 4\n"),
            ("laws/catalog/Cargo.toml", "[dependencies]\ngranule-law-b.workspace = true\n"),
            ("laws/catalog/src/lib.rs", "//! Laws.\n\nuse granule_law_b as _;\n"),
            ("laws/b/src/lib.rs", "name: \"Bee\"\n"),
        ] {
            files::write(&folder.path().join(path), text).unwrap();
        }
        folder
    }

    #[test]
    fn links_a_law_in_alphabetical_order() {
        let project = project();
        let root = project.path();
        for name in ["normal/c", "rolling/a-a"] {
            inside(root, &Names::parse(name).unwrap()).unwrap();
        }
        let read = |path: &str| files::read(&root.join(path)).unwrap();
        assert_eq!(
            read("Cargo.toml"),
            "[workspace.dependencies]\ngranule-law-api = { path = \"crates/law-api\" }\n\
             granule-law-a-a = { path = \"laws/a-a\" }\ngranule-law-b = { path = \"laws/b\" }\n\
             granule-law-c = { path = \"laws/c\" }\n\nserde = \"1\"\n"
        );
        assert_eq!(
            read("laws/catalog/Cargo.toml"),
            "[dependencies]\ngranule-law-a-a.workspace = true\n\
             granule-law-b.workspace = true\ngranule-law-c.workspace = true\n"
        );
        assert_eq!(
            read("laws/catalog/src/lib.rs"),
            "//! Laws.\n\nuse granule_law_a_a as _;\nuse granule_law_b as _;\nuse granule_law_c as _;\n"
        );
        assert!(read("laws/a-a/src/a_a.rs").contains("slot: Slot::Rolling"));
    }

    #[test]
    fn refuses_names_that_exist_and_then_writes_nothing() {
        let project = project();
        let root = project.path();
        let before = files::project(root).unwrap();
        for name in ["normal/b", "normal/bee"] {
            let error = inside(root, &Names::parse(name).unwrap()).unwrap_err();
            assert!(error.message.contains("choose another name"), "{error}");
        }
        assert_eq!(files::project(root).unwrap(), before);
    }

    #[test]
    fn writes_outside_only_into_an_empty_folder_elsewhere() {
        let project = project();
        let elsewhere = tempfile::tempdir().unwrap();
        let names = Names::parse("normal/my-law").unwrap();
        let error = outside(project.path(), &project.path().join("mine"), &names).unwrap_err();
        assert!(error.message.contains("inside the project"));
        outside(project.path(), elsewhere.path(), &names).unwrap();
        let program = files::read(&elsewhere.path().join("my-law-granule/src/main.rs")).unwrap();
        assert!(program.contains("use my_law as _;"));
        assert!(outside(project.path(), elsewhere.path(), &names).unwrap_err().message.contains("not empty"));
    }

    #[test]
    fn reads_the_command_line() {
        let parse = |line: &str| Options::parse(&line.split(' ').map(str::to_string).collect::<Vec<_>>());
        let options = parse("normal/my-law --external ../x").unwrap();
        assert_eq!(options.names.law(), "MyLaw");
        assert_eq!(options.external, Some(PathBuf::from("../x")));
        for line in [
            "--external",
            "normal/a normal/b",
            "normal/a --extern",
            "--external x",
            "normal/a --external --x",
        ] {
            assert_eq!(parse(line).unwrap_err().code, 2, "{line}");
        }
    }

    /// The text of every slot says what is to be filled in and fits the columns of the law interface.
    #[test]
    fn every_slot_has_a_text() {
        for slot in SLOTS {
            let names = Names::parse(&format!("{slot}/my-law")).unwrap();
            let source = template::source(&names);
            assert!(source.contains("Oracle::Missing") && source.contains(FILL_IN));
            assert!(source.contains(&format!("slot: Slot::{}", names.variant())));
            assert!(!source.contains("{law}") && !source.contains("{slot}"));
        }
    }
}
