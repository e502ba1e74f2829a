//! One test for each rule of what tables may hold, by the names of the table in `docs/onboard.md`.

extern crate std;

use super::rules::{nowhere, ns, session};
use super::trial::{BODY, Board, DAY};
use crate::time::Instant;
use crate::uplink::{SessionRecord, TableError, Tables};
use std::vec;

#[test]
// REQ-CONT-2.
fn tables_hold_only_sessions_inside_their_validity_and_of_their_telescopes() {
    let session = session();
    let board = Board::default();
    let load = |session: SessionRecord, validity| {
        Tables::load(&board.uplink_valid(1, &[session], validity)).map(|_| ()).unwrap_err()
    };
    let own = (session.start, session.end);
    assert!(Tables::load(&board.uplink_valid(1, &[session], own)).is_ok());
    let outside = TableError::SessionOutside(0);
    assert_eq!(load(session, (ns(own.0, 1), own.1)), outside);
    assert_eq!(load(session, (own.0, ns(own.1, -1))), outside);
    let elsewhere = SessionRecord { telescope: 1, ..session };
    assert_eq!(load(elsewhere, own), TableError::SessionTelescope(0));
}

#[test]
// REQ-CONT-2.
fn tables_hold_only_bodies_that_cover_their_validity() {
    let session = session();
    // The ephemeris reaches from a day before the start to 40 days after it.
    let (from, until) = (Instant::from_tai_ns(-DAY), Instant::from_tai_ns(40 * DAY));
    let with_limit =
        Board { bodies: vec![nowhere(&session)], limits: vec![(0, 0.2)], ..Board::default() };
    let load = |board: &Board, sessions: &[SessionRecord], validity| {
        Tables::load(&board.uplink_valid(1, sessions, validity)).map(|_| ())
    };
    for (board, sessions, body) in
        [(&Board::default(), &[session][..], BODY), (&with_limit, &[][..], Board::number(0))]
    {
        assert_eq!(load(board, sessions, (from, until)), Ok(()));
        let short = Err(TableError::Coverage(body));
        assert_eq!(load(board, sessions, (ns(from, -1), until)), short);
        assert_eq!(load(board, sessions, (from, ns(until, 1))), short);
    }
}
