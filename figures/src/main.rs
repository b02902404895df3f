//! `granule-figures NAME [--docs]`: the figures of one paper, or of the layer of two species (segregation); `granule-figures atlas [--quick] [--docs]`: the stability atlas.

use std::path::PathBuf;
use std::process::ExitCode;

use granule_figures::{CHAPTERS, Chapter, Error, atlas, segregation};

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    if words.first().is_some_and(|word| word == "atlas") {
        return the_atlas(&words[1..]);
    }
    let names: Vec<&str> = CHAPTERS.iter().map(|chapter| chapter.name).collect();
    let usage = format!(
        "figures NAME [--docs]: makes the figures of a paper; NAME is {} or segregation; --docs writes them into docs/ and not into \
         target/figures",
        names.join(", ")
    );
    if let ["segregation", options @ ..] = &words.iter().map(String::as_str).collect::<Vec<_>>()[..]
        && (options.is_empty() || options == ["--docs"])
    {
        return ended(segregation::make(!options.is_empty()));
    }
    let (chapter, docs) = match words.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        [name] | [name, "--docs"] => (Chapter::named(name), words.len() == 2),
        _ => (None, false),
    };
    let Some(chapter) = chapter else {
        eprintln!("error: {usage}");
        return ExitCode::from(2);
    };
    ended(make(chapter, docs))
}

fn ended(result: Result<(), Error>) -> ExitCode {
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn the_atlas(options: &[String]) -> ExitCode {
    let has = |name: &str| options.iter().any(|option| option == name);
    if let Some(other) = options.iter().find(|option| !["--quick", "--docs"].contains(&option.as_str())) {
        eprintln!("error: atlas takes --quick and --docs, not `{other}`");
        return ExitCode::from(2);
    }
    ended(atlas::make(has("--quick"), has("--docs")))
}

/// Makes the figures of a chapter, below the current folder.
fn make(chapter: &Chapter, docs: bool) -> Result<(), Error> {
    let folder = PathBuf::from(if docs { "docs" } else { "target/figures" });
    let pictures = if docs { format!("figures/{}", chapter.name) } else { chapter.name.to_string() };
    let figures = (chapter.figures)()?;
    chapter.write(&figures, &folder, &pictures)?;
    let place = folder.join(format!("{}-figures.md", chapter.name));
    println!("{} figures: {}", figures.len(), place.display());
    Ok(())
}
