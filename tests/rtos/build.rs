//! Tells the linker where the board's memory is, and the firmware which container it flies: the file
//! that `GYRFALCON_UPLINK` names.

fn main() {
    println!("cargo::rustc-link-search={}", env!("CARGO_MANIFEST_DIR"));
    println!("cargo::rerun-if-env-changed=GYRFALCON_UPLINK");
    println!("cargo::rerun-if-changed=memory.x");
}
