//! Binds the two functions that tell SUNDIALS' version and that `sundials-sys` leaves out.

use std::path::PathBuf;
use std::process::exit;

const HEADERS_MISSING: &str = "the headers of SUNDIALS were not found: freeplay needs SUNDIALS 6.4 \
    with IDA (Debian and Ubuntu: `apt install libsundials-dev libclang-dev`); if they are \
    installed elsewhere, set SUNDIALS_INCLUDE_DIR and SUNDIALS_LIBRARY_DIR";

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-env-changed=SUNDIALS_INCLUDE_DIR");
    if let Err(complaint) = bind_version() {
        eprintln!("error: {complaint}");
        exit(1);
    }
}

fn bind_version() -> Result<(), String> {
    let include = std::env::var("SUNDIALS_INCLUDE_DIR").map(|folder| format!("-I{folder}"));
    let bindings = bindgen::Builder::default()
        .header_contents("version.h", "#include <sundials/sundials_version.h>\n")
        .clang_args(include.ok())
        .allowlist_function("SUNDIALSGetVersion.*")
        .layout_tests(false)
        .generate()
        .map_err(|cause| format!("{HEADERS_MISSING}\n{cause}"))?;
    let out = std::env::var("OUT_DIR").map_err(|cause| format!("OUT_DIR: {cause}"))?;
    bindings
        .write_to_file(PathBuf::from(out).join("sundials_version.rs"))
        .map_err(|cause| format!("the bindings could not be written: {cause}"))
}
