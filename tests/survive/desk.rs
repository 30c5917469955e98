//! A folder that the program is started in.

use freeplay::record::ResultFile;
use nix::sys::signal::{Signal, kill};
use nix::unistd::Pid;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// How the program ended and what it said.
#[derive(Debug)]
pub struct Said {
    /// `None` where a signal ended it.
    pub code: Option<i32>,
    pub out: String,
    pub errors: String,
    pub took: Duration,
}

impl Said {
    pub fn assert_code(&self, code: i32) -> &Said {
        assert_eq!(self.code, Some(code), "{self:#?}");
        assert!(!self.errors.contains("panicked"), "{self:#?}");
        self
    }

    pub fn of(output: Output, took: Duration) -> Said {
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
        let (out, errors) = (text(output.stdout), text(output.stderr));
        Said { code: output.status.code(), out, errors, took }
    }
}

pub struct Desk {
    pub folder: TempDir,
}

impl Desk {
    pub fn new() -> Desk {
        Desk { folder: tempfile::tempdir().unwrap() }
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Writes a file; gives its name back.
    pub fn file<'a>(&self, name: &'a str, content: impl AsRef<[u8]>) -> &'a str {
        std::fs::write(self.path(name), content).unwrap();
        name
    }

    pub fn bytes(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).unwrap()
    }

    pub fn command<A: AsRef<OsStr>>(&self, arguments: &[A]) -> Command {
        // tests that run in the background of a script would inherit that signals are ignored
        let mut command = Command::new("env");
        command.args(["--default-signal", env!("CARGO_BIN_EXE_freeplay")]);
        command.args(arguments).current_dir(&self.folder).stdin(Stdio::null());
        command
    }

    pub fn run<A: AsRef<OsStr>>(&self, arguments: &[A]) -> Said {
        ran(&mut self.command(arguments))
    }

    /// The same with so many seconds of processor time, beyond which it is killed, and a minute
    /// altogether: on a machine that is busy with other things only the former tell anything.
    pub fn run_within<A: AsRef<OsStr>>(&self, seconds: u32, arguments: &[A]) -> Said {
        let mut command = Command::new("sh");
        let line = format!("ulimit -t {seconds}; exec timeout -s KILL 60 \"$0\" \"$@\"");
        command.args(["-c", &line, env!("CARGO_BIN_EXE_freeplay")]).args(arguments);
        ran(command.current_dir(&self.folder).stdin(Stdio::null()))
    }

    /// What a line of the shell does, in which `$FREEPLAY` is the program.
    pub fn shell(&self, line: &str) -> Said {
        let mut command = Command::new("sh");
        command.args(["-c", line]).current_dir(&self.folder).stdin(Stdio::null());
        ran(command.env("FREEPLAY", env!("CARGO_BIN_EXE_freeplay")))
    }

    /// Names of the files there, hidden ones too.
    pub fn files(&self) -> Vec<String> {
        let entries = std::fs::read_dir(&self.folder).unwrap();
        let mut names: Vec<String> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    pub fn open(&self, name: &str) -> ResultFile {
        ResultFile::open(&self.path(name)).unwrap()
    }

    /// Starts a run that would take very long, and waits until it has written something.
    pub fn long_run(&self, command: &mut Command) -> Child {
        let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let written = || {
            let partial = self.files().into_iter().find(|name| name.contains("partial"));
            partial.is_some_and(|name| {
                std::fs::metadata(self.path(&name)).is_ok_and(|found| found.len() > 300_000)
            })
        };
        wait_for(written);
        child
    }
}

/// Runs a command to its end.
pub fn ran(command: &mut Command) -> Said {
    let begun = Instant::now();
    let output = command.output().unwrap();
    Said::of(output, begun.elapsed())
}

/// Waits until something is so, a minute at most.
pub fn wait_for(so: impl Fn() -> bool) {
    let begun = Instant::now();
    while !so() {
        assert!(begun.elapsed() < Duration::from_secs(60), "it never came to be");
        std::thread::sleep(Duration::from_millis(10));
    }
}

/// A case file of the project.
pub fn case(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("cases").join(format!("{name}.toml"));
    path.into_os_string().into_string().unwrap()
}

pub fn signal(child: &Child, signal: Signal) {
    kill(Pid::from_raw(i32::try_from(child.id()).unwrap()), signal).unwrap();
}
