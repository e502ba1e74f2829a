//! A kernel whose bodies end at different times.

use ephem::kernel::{EARTH_MOON_BARYCENTER, Kernel, SUN};
use ephem::time::parse_time;

/// Cut from DE440: the Sun ends in 2034, Mars in 2035.
const MIXED: &[u8] = include_bytes!("data/mixed-ends-2032.bsp");

#[test]
fn each_body_is_asked_only_where_its_chain_is_known() {
    let kernel = Kernel::from_bytes("mixed.bsp", MIXED).unwrap();
    let at = parse_time("2032-04-03T00:00:00 TDB").unwrap();
    let same = Kernel::embedded();
    for body in [SUN, EARTH_MOON_BARYCENTER, 4] {
        let found = kernel.state(body, at).unwrap().position_km;
        assert!((found - same.state(body, at).unwrap().position_km).norm() < 1e-6, "{body}");
    }
    let ends = |body| kernel.coverage(body).unwrap().1;
    assert!(ends(SUN) < ends(4));
    assert!(kernel.state(4, ends(4)).is_ok() && kernel.state(SUN, ends(4)).is_err());
}
