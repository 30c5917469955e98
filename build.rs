//! Binds what `sundials-sys` leaves out of SUNDIALS, its version and its sparse linear solver, and
//! tells the program which commit it is built from.

use std::path::{Path, PathBuf};
use std::process::{Command, exit};

const HEADERS_MISSING: &str = "the headers of SUNDIALS were not found: freeplay needs SUNDIALS 6.4 \
    with IDA and KLU (Debian and Ubuntu: `apt install libsundials-dev libclang-dev`); if they are \
    installed elsewhere, set SUNDIALS_INCLUDE_DIR and SUNDIALS_LIBRARY_DIR";

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-env-changed=SUNDIALS_INCLUDE_DIR");
    println!("cargo::rustc-env=FREEPLAY_COMMIT={}", commit().unwrap_or_default());
    if let Err(complaint) = bind_sundials() {
        eprintln!("error: {complaint}");
        exit(1);
    }
}

fn bind_sundials() -> Result<(), String> {
    let include = std::env::var("SUNDIALS_INCLUDE_DIR").map(|folder| format!("-I{folder}"));
    println!("cargo::rustc-link-lib=sundials_sunlinsolklu");
    let bindings = bindgen::Builder::default()
        .header_contents(
            "sundials.h",
            "#include <sundials/sundials_version.h>\n#include <sunlinsol/sunlinsol_klu.h>\n",
        )
        .clang_args(include.ok())
        .clang_arg("-I/usr/include/suitesparse")
        .allowlist_function("SUNDIALSGetVersionNumber")
        .allowlist_function("SUNLinSol_KLU(ReInit)?")
        .allowlist_var("SUNKLU_REINIT_PARTIAL")
        // these are those of `sundials-sys`
        .blocklist_type(".*")
        .raw_line("use std::os::raw::c_char;")
        .raw_line(
            "use sundials_sys::{N_Vector, SUNContext, SUNLinearSolver, SUNMatrix, sunindextype};",
        )
        .layout_tests(false)
        .generate()
        .map_err(|cause| format!("{HEADERS_MISSING}\n{cause}"))?;
    let out = std::env::var("OUT_DIR").map_err(|cause| format!("OUT_DIR: {cause}"))?;
    bindings
        .write_to_file(PathBuf::from(out).join("sundials.rs"))
        .map_err(|cause| format!("the bindings could not be written: {cause}"))
}

/// What the program is made of; a commit does not tell it where one of these differs from it.
const SOURCES: [&str; 4] = ["src", "build.rs", "Cargo.toml", "Cargo.lock"];

/// The commit that the sources were built at, with " and changes" behind it where they were not
/// those of the commit; nothing without git, and in a folder that is no checkout of its own. A
/// commit alone has nothing built again: what was built is still what it says.
fn commit() -> Option<String> {
    let folder = std::env::var("CARGO_MANIFEST_DIR").ok()?;
    let top = git(&folder, &["rev-parse", "--show-toplevel"])?;
    if Path::new(&top).canonicalize().ok()? != Path::new(&folder).canonicalize().ok()? {
        return None;
    }
    let commit = git(&folder, &["rev-parse", "--short=12", "HEAD"])?;
    for source in SOURCES {
        println!("cargo::rerun-if-changed={source}");
    }
    let differs = git(&folder, &[&["diff", "--name-only", "HEAD", "--"], &SOURCES[..]].concat())?;
    Some(if differs.is_empty() { commit } else { format!("{commit} and changes") })
}

/// What git says, without the end of the line; nothing if it is not there or fails.
fn git(folder: &str, arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").arg("-C").arg(folder).args(arguments).output().ok()?;
    let said = output.status.success().then_some(output.stdout)?;
    Some(String::from_utf8(said).ok()?.trim_end().to_owned())
}
