//! SHA-256 of what a mission and an output are made from.
//!
//! # Example
//! A mission is known by the digest of its text with every key explicit, so a key at its default
//! changes nothing:
//! ```
//! use mission::{Mission, Override, digest::sha256_hex};
//!
//! let preset = Mission::load("litebird", &[])?;
//! let same = Mission::load("litebird", &[Override::set("scan.precession_sign=1")?])?;
//! assert_eq!(sha256_hex(preset.resolved_toml()), same.digest());
//! # Ok::<(), mission::fault::MissionError>(())
//! ```

use sha2::{Digest, Sha256};
use std::fmt::Write;

/// SHA-256 of a text or of bytes, in lower-case hexadecimal digits.
#[must_use]
pub fn sha256_hex(bytes: impl AsRef<[u8]>) -> String {
    let mut hex = String::with_capacity(64);
    for byte in Sha256::digest(bytes.as_ref()) {
        let _ = write!(hex, "{byte:02x}");
    }
    hex
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_digest_is_sha256() {
        assert_eq!(
            sha256_hex("abc"),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"
        );
    }
}
