//! Progress of a run: a bar on a terminal, a line now and then elsewhere.

use std::io::IsTerminal;
use std::time::{Duration, Instant};

use granule::prelude::{Outlook, Progress, Status};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::{terminal, text};

/// Shortest time between two lines where there is no terminal.
const LINE_INTERVAL: Duration = Duration::from_secs(10);

/// The progress display that fits to standard error.
pub fn display(quiet: bool) -> Box<dyn Progress> {
    if quiet {
        Box::new(granule::prelude::Silent)
    } else if std::io::stderr().is_terminal() {
        Box::new(Bar::default())
    } else {
        Box::new(Lines::default())
    }
}

fn header(outlook: &Outlook<'_>) -> String {
    let title = if outlook.title.is_empty() { String::new() } else { format!("{}: ", outlook.title) };
    format!(
        "{title}{} bodies, {} steps, {} s, {} thread{}; outputs in {}",
        outlook.bodies,
        outlook.steps,
        text::number(text::rounded(outlook.duration)),
        outlook.threads,
        if outlook.threads == 1 { "" } else { "s" },
        outlook.directory.display()
    )
}

fn left(status: &Status) -> String {
    status.left.map_or_else(|| "?".to_string(), text::duration)
}

/// Shortest time between two drawings of the bar.
const DRAW_INTERVAL: Duration = Duration::from_millis(100);

/// A bar that is drawn anew.
#[derive(Default)]
struct Bar {
    bar: Option<ProgressBar>,
    duration: f64,
    last: Option<Instant>,
}

impl Progress for Bar {
    fn begin(&mut self, outlook: &Outlook<'_>) {
        terminal::err(&format!("{}\n", header(outlook)));
        let bar = ProgressBar::with_draw_target(Some(outlook.steps), ProgressDrawTarget::stderr());
        // The default style takes over should the template ever be wrong; a test reads it.
        if let Ok(style) = style() {
            bar.set_style(style);
        }
        self.duration = outlook.duration;
        self.bar = Some(bar);
    }

    fn warn(&mut self, message: &str) {
        match &self.bar {
            Some(bar) => bar.suspend(|| terminal::err(&format!("{message}\n"))),
            None => terminal::err(&format!("{message}\n")),
        }
    }

    fn advance(&mut self, status: &Status) {
        if self.last.is_some_and(|last| last.elapsed() < DRAW_INTERVAL) {
            return;
        }
        self.last = Some(Instant::now());
        if let Some(bar) = &self.bar {
            bar.set_position(status.step);
            bar.set_message(format!(
                "t = {} of {} s, {}particle-steps/s, {} left",
                text::number(text::rounded(status.time)),
                text::number(text::rounded(self.duration)),
                text::short(status.particle_steps_per_second),
                left(status)
            ));
        }
    }

    fn end(&mut self, _status: &Status) {
        if let Some(bar) = self.bar.take() {
            bar.finish_and_clear();
        }
    }
}

fn style() -> Result<ProgressStyle, indicatif::style::TemplateError> {
    Ok(ProgressStyle::with_template("[{bar:30}] {percent:>3} % {msg}")?.progress_chars("=> "))
}

/// One line now and then.
#[derive(Default)]
struct Lines {
    steps: u64,
    last: Option<Instant>,
}

impl Progress for Lines {
    fn begin(&mut self, outlook: &Outlook<'_>) {
        terminal::err(&format!("{}\n", header(outlook)));
        self.steps = outlook.steps;
        self.last = Some(Instant::now());
    }

    fn advance(&mut self, status: &Status) {
        if self.last.is_some_and(|last| last.elapsed() < LINE_INTERVAL) {
            return;
        }
        self.last = Some(Instant::now());
        let percent = if self.steps > 0 { 100.0 * status.step as f64 / self.steps as f64 } else { 100.0 };
        terminal::err(&format!(
            "{percent:.0} %: step {} of {}, t = {} s, {}particle-steps/s, {} left\n",
            status.step,
            self.steps,
            text::number(text::rounded(status.time)),
            text::short(status.particle_steps_per_second),
            left(status)
        ));
    }

    fn warn(&mut self, message: &str) {
        terminal::err(&format!("{message}\n"));
    }

    fn end(&mut self, _status: &Status) {}
}

/// A count of things done: a bar on a terminal, a line now and then elsewhere.
pub struct Count {
    bar: Option<ProgressBar>,
    last: Option<Instant>,
}

impl Count {
    /// Of so many things.
    pub fn new(all: usize) -> Self {
        let bar = std::io::stderr().is_terminal().then(|| {
            let bar = ProgressBar::with_draw_target(Some(all as u64), ProgressDrawTarget::stderr());
            if let Ok(style) = style() {
                bar.set_style(style);
            }
            bar
        });
        Self { bar, last: None }
    }

    /// So many are done.
    pub fn show(&mut self, done: usize, message: &str) {
        if let Some(bar) = &self.bar {
            bar.set_position(done as u64);
            bar.set_message(message.to_string());
        } else if self.last.is_none_or(|last| last.elapsed() >= LINE_INTERVAL) {
            self.last = Some(Instant::now());
            terminal::err(&format!("{message}\n"));
        }
    }

    /// No more to come.
    pub fn end(self) {
        if let Some(bar) = self.bar {
            bar.finish_and_clear();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_template_of_the_bar_is_right() {
        assert!(style().is_ok());
    }
}
