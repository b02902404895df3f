//! `granule selftest`: does this program give the right answers at the extremes?

use anstyle::{AnsiColor, Style};

use super::Exit;
use crate::args::SelftestArguments;
use crate::terminal::{self, ERROR, styled};

const PASSED: Style = AnsiColor::Green.on_default();

/// Runs the extremes and prints what happened in each.
pub fn selftest(arguments: &SelftestArguments) -> Exit {
    if arguments.list {
        let names = granule::selftest_names();
        let lines =
            names.map(|(name, slow)| format!("{name}{}\n", if slow { " (--all, or by name)" } else { "" }));
        terminal::out(&lines.collect::<String>());
        return Exit::Success;
    }
    if let Some(unknown) =
        arguments.names.iter().find(|name| granule::selftest_names().all(|(known, _)| known != name.as_str()))
    {
        terminal::error(&format!("there is no extreme `{unknown}`; `granule selftest --list` names all"));
        return Exit::Input;
    }
    let (mut passed, mut failed) = (0, 0);
    let result = granule::selftest(&arguments.names, arguments.all, &mut |result| {
        let (verdict, what) = match &result.outcome {
            Ok(got) => {
                passed += 1;
                (styled(PASSED, "right"), got.clone())
            }
            Err(why) => {
                failed += 1;
                (styled(ERROR, "WRONG"), format!("{why}\n{:38}expected: {}", "", result.expected))
            }
        };
        terminal::out(&format!("{:30} {verdict}  {what}\n", result.name));
    });
    if let Err(error) = result {
        terminal::error(&error.to_string());
        return Exit::Input;
    }
    terminal::out(&format!("{passed} right, {failed} wrong\n"));
    if failed == 0 { Exit::Success } else { Exit::Run }
}
