//! Studies on many machines, by the engines that others have made. Known in advance: whatever starts the
//! shards of a study, and whatever is killed on the way, its tables are to the byte those of one process with
//! one job.

mod written;

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::PathBuf;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};
use written::{alone, python, root};

const PROGRAM: &str = env!("CARGO_BIN_EXE_freeplay");
const TABLES: [&str; 4] = ["runs", "revolutions", "sections", "failures"];

/// A folder with a study of 48 runs, 8 of which fail, and its tables as one job makes them.
struct Desk(tempfile::TempDir);

impl Desk {
    fn new() -> Desk {
        let folder = tempfile::tempdir().unwrap();
        let case = root().join("cases/four-bar-a.toml");
        let text = format!(
            "case = {:?}\nset = [\"solver.engine=explicit\", \"solver.relative_tolerance=1e-9\"]\n\
             [[vary]]\nkey = \"drives.crank.speed_rpm\"\nfrom = 2000\nto = 5000\ncount = 8\n\
             [[vary]]\nkey = \"joints.A.clearance.radial\"\nfrom = 1e-4\nto = 2e-2\ncount = 6\n\
             spacing = \"log\"\n\
             [span]\nrevolutions = 12\n[keep]\nruns = [\"clearances.A.contacts\"]\n\
             revolutions = [\"clearances.A.contacts\"]\n[section]\n",
            case.to_str().unwrap()
        );
        fs::write(folder.path().join("study.toml"), text).unwrap();
        let desk = Desk(folder);
        let done = desk.sweep("--jobs 1 -o one");
        assert_eq!(done.status.code(), Some(4), "{}", errors(&done));
        desk
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn sweep(&self, line: &str) -> Output {
        let _alone = alone();
        let mut command = Command::new(PROGRAM);
        command.args(["sweep", "study.toml", "--quiet"]).args(line.split_whitespace());
        command.current_dir(self.0.path()).output().unwrap()
    }

    fn assert_same(&self, folder: &str) {
        for name in TABLES {
            let [one, other] = ["one", folder]
                .map(|folder| fs::read(self.path(folder).join(format!("{name}.parquet"))).unwrap());
            assert!(one == other, "{folder}/{name}");
        }
    }

    fn has_begun(&self, folder: &str) -> bool {
        let packs = fs::read_dir(self.path(folder).join("packs"));
        packs.is_ok_and(|packs| packs.flatten().any(|pack| pack.metadata().unwrap().len() > 1000))
    }
}

fn errors(said: &Output) -> String {
    String::from_utf8_lossy(&said.stderr).into_owned()
}

/// Waits until something is so.
fn until(what: &str, so: impl Fn() -> bool) {
    let begun = Instant::now();
    while !so() {
        assert!(begun.elapsed() < Duration::from_secs(120), "waited in vain for {what}");
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Processes that end with this.
struct Processes(Vec<Child>);

impl Drop for Processes {
    fn drop(&mut self) {
        for child in &mut self.0 {
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

#[test]
fn dask_makes_the_study_though_a_worker_is_killed_in_its_midst() {
    let desk = Desk::new();
    let cluster = desk.path("cluster.json");
    let dask = |what: &str, more: &[&str]| {
        let mut command = Command::new(python());
        command.args(["-m", "dask", what, "--no-dashboard", "--scheduler-file"]).arg(&cluster);
        command.args(more).current_dir(desk.0.path());
        command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap()
    };
    let mut running = Processes(Vec::new());
    let mut driver = {
        let _alone = alone();
        running.0.push(dask("scheduler", &["--host", "127.0.0.1", "--port", "0"]));
        until("the scheduler", || cluster.exists());
        for _ in 0..3 {
            running.0.push(dask("worker", &["--nthreads", "1", "--no-nanny"]));
        }
        let mut driver = Command::new(python());
        driver.arg(root().join("scripts/cluster/dask_sweep.py"));
        driver.args(["study.toml", "-o", "many", "--shards", "12", "--freeplay", PROGRAM]);
        driver.arg("--scheduler-file").arg(&cluster).current_dir(desk.0.path());
        driver.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap()
    };
    until("the first run", || desk.has_begun("many"));
    assert_eq!(driver.try_wait().unwrap(), None, "it was done before it could be disturbed");
    running.0[1].kill().unwrap();
    let said = driver.wait_with_output().unwrap();
    assert_eq!(said.status.code(), Some(4), "{}", errors(&said));
    desk.assert_same("many");
}

/// The program under another name, which is killed soon after it has begun shard 2 for the first time.
fn disturbed(desk: &Desk) -> PathBuf {
    let path = desk.path("disturbed");
    let text = format!(
        "#!/bin/sh\ncase \"$*\" in *\"--shard 2/\"*)\n\
         [ -e killed ] || {{ touch killed; exec timeout -s KILL 0.05 {PROGRAM} \"$@\"; }};;\nesac\n\
         exec {PROGRAM} \"$@\"\n"
    );
    fs::write(&path, text).unwrap();
    fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).unwrap();
    path
}

#[test]
fn gnu_parallel_makes_the_study_though_a_shard_is_killed() {
    let desk = Desk::new();
    let program = disturbed(&desk);
    let _alone = alone();
    let mut parallel = Command::new("parallel");
    parallel.args(["--jobs", "2", "--retries", "3", "--joblog", "log"]).arg(&program);
    parallel.args(["sweep", "study.toml", "--shard", "{}/6", "-o", "many", "--quiet", ":::"]);
    parallel.args(["1", "2", "3", "4", "5", "6"]).current_dir(desk.0.path());
    let said = parallel.output().expect("GNU parallel, of Debian's package of this name");
    assert!(desk.path("killed").exists());
    // it tells how many ended with something else than 0: those with runs that fail
    let log = fs::read_to_string(desk.path("log")).unwrap();
    let codes: Vec<&str> =
        log.lines().skip(1).map(|line| line.split('\t').nth(6).unwrap()).collect();
    assert!(codes.iter().all(|code| ["0", "4"].contains(code)), "{log}{}", errors(&said));
    drop(_alone);
    let said = desk.sweep("--gather many");
    assert_eq!(said.status.code(), Some(4), "{}", errors(&said));
    desk.assert_same("many");
}

/// What Slurm would do for each task of an array: the template by itself, in the environment that it gets,
/// with an `scontrol` that takes note of what is put into the queue again.
#[test]
fn the_template_for_slurm_puts_a_shard_that_is_stopped_into_the_queue_again() {
    let desk = Desk::new();
    let control = desk.path("scontrol");
    fs::write(&control, "#!/bin/sh\necho \"$@\" >> queue\n").unwrap();
    fs::set_permissions(&control, fs::Permissions::from_mode(0o755)).unwrap();
    let task = |number: &str| {
        let mut task = Command::new("bash");
        task.arg(root().join("scripts/cluster/slurm_sweep.sh")).args(["study.toml", "many"]);
        let path = std::env::var("PATH").unwrap();
        task.env("PATH", format!("{}:{path}", desk.0.path().display())).env("FREEPLAY", PROGRAM);
        task.env("SLURM_ARRAY_JOB_ID", "17").env("SLURM_ARRAY_TASK_COUNT", "3");
        task.env("SLURM_ARRAY_TASK_ID", number).current_dir(desk.0.path());
        task.stderr(Stdio::null()).spawn().unwrap()
    };
    let _alone = alone();
    let mut stopped = task("1");
    until("the first run", || desk.has_begun("many"));
    let pid = nix::unistd::Pid::from_raw(stopped.id() as i32);
    nix::sys::signal::kill(pid, nix::sys::signal::Signal::SIGTERM).unwrap();
    assert_eq!(stopped.wait().unwrap().code(), Some(0));
    assert_eq!(fs::read_to_string(desk.path("queue")).unwrap(), "requeue 17_1\n");
    let codes: Vec<_> = ["1", "2", "3"].map(|k| task(k).wait().unwrap().code()).into();
    assert!(codes.iter().all(|code| [Some(0), Some(4)].contains(code)), "{codes:?}");
    drop(_alone);
    assert_eq!(desk.sweep("--gather many").status.code(), Some(4));
    desk.assert_same("many");
}
