//! A folder in which the commands of a page run.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::output;

/// The command under test.
pub const PROGRAM: &str = env!("CARGO_BIN_EXE_dalembert");

/// The folder of one page. It is removed with the session.
pub struct Session {
    folder: PathBuf,
}

impl Session {
    pub fn begin(name: &str) -> Self {
        let name = format!("dalembert-book-{name}-{}", std::process::id());
        let folder = std::env::temp_dir().join(name);
        fs::create_dir_all(folder.join("python")).expect("a folder");
        let checker = "python/check_certificate.py";
        let repository = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        fs::copy(repository.join(checker), folder.join(checker))
            .expect("the checker of certificates");
        Self { folder }
    }

    /// Saves a declaration and loads it. It must be accepted, or refused if `accepted` is false.
    pub fn load(&mut self, name: &str, text: &str, accepted: bool) -> Result<(), String> {
        fs::write(self.folder.join(name), text).map_err(|error| error.to_string())?;
        let (status, output) = self.run(&format!("dalembert check {name}"))?;
        match (status, accepted) {
            (0, true) | (2, false) => Ok(()),
            (0, false) => Err(format!("`{name}` is loaded")),
            (_, _) => Err(output),
        }
    }

    /// Runs commands and compares the output of each with the text below it.
    pub fn commands(&mut self, text: &str, succeed: bool) -> Result<(), String> {
        for (command, expected) in split(text) {
            let (status, output) = self.run(&command)?;
            if (status == 0) != succeed {
                return Err(format!("`{command}`: exit status {status}\n{output}"));
            }
            if !expected.is_empty() {
                output::compare(&expected, &output)
                    .map_err(|mistake| format!("`{command}`: {mistake}"))?;
            }
        }
        Ok(())
    }

    /// Runs the `cargo run` commands of a block with the command under test.
    pub fn cargo_commands(&mut self, text: &str) -> Result<(), String> {
        let commands = text
            .lines()
            .filter_map(|line| line.strip_prefix("cargo run --release -- "));
        for command in commands.filter(|command| !command.starts_with("gallery")) {
            let (status, output) = self.run(&format!("dalembert {command}"))?;
            if status != 0 {
                return Err(format!("`{command}`: exit status {status}\n{output}"));
            }
        }
        Ok(())
    }

    /// Runs a command line; returns its status, and its output with its messages.
    fn run(&self, command: &str) -> Result<(i32, String), String> {
        let programs = Path::new(PROGRAM).parent().map(Path::display);
        let programs = programs.map_or_else(String::new, |folder| folder.to_string());
        let path = format!("{programs}:{}", std::env::var("PATH").unwrap_or_default());
        let done = Command::new("sh")
            .args(["-c", &format!("{{ {command}\n}} 2>&1")])
            .current_dir(&self.folder)
            .env("PATH", path)
            .output()
            .map_err(|error| error.to_string())?;
        let output = String::from_utf8_lossy(&done.stdout).into_owned();
        Ok((done.status.code().unwrap_or(-1), output))
    }

    /// Compares the texts of a stored picture (title, axes, legend) with those of the picture that a command drew under
    /// the same name.
    pub fn compare_picture(&self, stored: &Path) -> Result<(), String> {
        let name = stored.file_name().unwrap_or_default();
        let drawn = fs::read_to_string(self.folder.join(name))
            .map_err(|_| format!("no command of the page draws {}", name.display()))?;
        if std::env::var_os("ACCEPT").is_some() {
            fs::write(stored, &drawn).map_err(|error| error.to_string())?;
        }
        let kept =
            fs::read_to_string(stored).map_err(|error| format!("{}: {error}", stored.display()))?;
        output::compare(&labels(&kept), &labels(&drawn))
            .map_err(|mistake| format!("{}: {mistake}", name.display()))
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.folder);
    }
}

/// The commands of a block, each with the lines below it.
pub fn split(text: &str) -> Vec<(String, String)> {
    let mut commands: Vec<(String, String)> = Vec::new();
    let mut continued = false;
    for line in text.lines() {
        let started = line.strip_prefix("$ ");
        match (started, commands.last_mut()) {
            (Some(command), _) => commands.push((command.to_owned(), String::new())),
            (None, Some((command, _))) if continued => {
                command.push('\n');
                command.push_str(line);
            }
            (None, Some((_, output))) => {
                output.push_str(line);
                output.push('\n');
            }
            (None, None) => commands.push((line.to_owned(), String::new())),
        }
        continued = (started.is_some() || continued) && line.ends_with('\\');
    }
    commands
}

/// The texts of a picture, one per line.
fn labels(picture: &str) -> String {
    let texts = picture.split("<text").skip(1);
    let texts = texts.filter_map(|text| text.split_once('>')?.1.split_once('<'));
    texts
        .map(|(text, _)| format!("{}\n", text.trim()))
        .collect()
}
