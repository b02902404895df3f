//! Hands the compiler version, the target and the profile to the manifest. It reads no repository state, so a build
//! from a source archive says the same as one from a checkout.

use std::process::Command;

fn main() {
    let rustc = std::env::var("RUSTC").unwrap_or_else(|_| "rustc".to_owned());
    let version = Command::new(rustc)
        .arg("--version")
        .output()
        .ok()
        .and_then(|out| String::from_utf8(out.stdout).ok())
        .map(|text| text.trim().to_owned())
        .filter(|text| !text.is_empty())
        .unwrap_or_else(|| "unknown".to_owned());
    println!("cargo::rustc-env=GRANULE_RUSTC_VERSION={version}");
    for (name, key) in
        [("TARGET", "GRANULE_TARGET"), ("PROFILE", "GRANULE_PROFILE"), ("OPT_LEVEL", "GRANULE_OPT_LEVEL")]
    {
        let value = std::env::var(name).unwrap_or_else(|_| "unknown".to_owned());
        println!("cargo::rustc-env={key}={value}");
    }
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-env-changed=RUSTC");
}
