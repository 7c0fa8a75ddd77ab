//! `roadgrade completions`, and the hidden `roadgrade man`.

use crate::error::{Error, Result, on_one_line};
use crate::files::output::write_whole;
use crate::terminal::print::{note, print};
use clap::Command;
use clap_complete::Shell;
use clap_mangen::Man;
use std::path::{Path, PathBuf};

/// Name of the program.
const PROGRAM: &str = "roadgrade";

/// Arguments of `completions`.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  roadgrade completions bash > ~/.local/share/bash-completion/completions/roadgrade
  roadgrade completions zsh > ~/.zfunc/_roadgrade
  roadgrade completions fish > ~/.config/fish/completions/roadgrade.fish")]
pub struct CompletionArgs {
    /// The shell.
    shell: Shell,
}

/// Arguments of `man`.
#[derive(Debug, clap::Args)]
pub struct ManArgs {
    /// Folder for one page per subcommand.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

/// Prints the completions of a shell.
pub fn completions(args: &CompletionArgs, mut command: Command) -> Result<()> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut command, PROGRAM, &mut script);
    print(&String::from_utf8_lossy(&script))
}

/// Writes the man pages.
pub fn man(args: &ManArgs, mut command: Command) -> Result<()> {
    command.build();
    let pages = write_pages(&args.out, &command)?;
    note(format_args!("{}: {pages} pages", on_one_line(&args.out)));
    Ok(())
}

/// Writes the page of a command and those of its subcommands. Returns their number.
fn write_pages(folder: &Path, command: &Command) -> Result<usize> {
    let name = command.get_display_name().unwrap_or(command.get_name());
    let path = folder.join(format!("{name}.1"));
    let page = Man::new(command.clone());
    let mut text = Vec::new();
    page.render(&mut text).map_err(Error::io(&path))?;
    write_whole(&path, |out| out.write_all(&text))?;
    let shown = command.get_subcommands().filter(|of| !of.is_hide_set());
    let shown = shown.filter(|of| of.get_name() != "help");
    let counts: Result<Vec<usize>> = shown.map(|of| write_pages(folder, of)).collect();
    Ok(1 + counts?.iter().sum::<usize>())
}
