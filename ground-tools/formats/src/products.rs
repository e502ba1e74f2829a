//! Which files a plan's folder holds, and what fills them.
//!
//! # Example
//! A day's plan for STK, beside what every plan has:
//! ```
//! use formats::products::{Also, Products};
//! use formats::timeline::timeline;
//! use mission::{Mission, Override};
//! use planner::plan::{Revision, plan};
//! use planner::{progress::Quietly, world::World};
//!
//! let mission = Mission::load("litebird", &[Override::set("span.duration_days=1")?])?;
//! let world = &World::open(mission, None)?;
//! let plan = plan(world, &Revision::default(), &Quietly)?;
//! let (timeline, sun) = (&timeline(world, &plan, None)?, world.sun(plan.offered.tables.parse()?)?);
//! let (stamp, error_rad, whole, spacecraft) = (world.start, 1e-5, false, -999);
//! let products = Products { world, sun, timeline, stamp, error_rad, whole, spacecraft };
//! let mut files = products.fills(&[Also::Stk])?.into_iter();
//! assert_eq!(files.next().map(|it| it.0), Some("timeline.ics"));
//! let (name, fill) = files.next().ok_or("no attitude for STK")?;
//! let mut bytes = Vec::new();
//! fill(&mut bytes)?;
//! assert!(name == "attitude.a" && bytes.starts_with(b"stk.v.11.0"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::attitude::{
    Attitudes, BodyFrame, Kernels, Message, Motion, Notation, Span, write_stk_attitude,
    write_stk_intervals,
};
use crate::calendar;
use crate::error::WriteError;
use crate::periods;
use crate::rows::Format;
use crate::timeline::Timeline;
use onboard_core::rotation::Rotation;
use onboard_core::sun::SunModel;
use onboard_core::time::Instant;
use planner::world::World;
use std::io::Write;

/// What fills a file as it is written.
pub type Fill<'f> = Box<dyn FnOnce(&mut dyn Write) -> Result<(), WriteError> + 'f>;

/// What `plan` always writes: what [`Products`] fills of it comes from here, the rest from elsewhere.
pub const ALWAYS: [&str; 5] =
    ["timeline.json", "timeline.csv", "timeline.ics", "uplink.tbl", "report.html"];

/// A product on request.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Also {
    /// timeline.parquet: the timeline as Apache Parquet
    Parquet,
    /// attitude.aem: the attitude as CCSDS AEM
    Aem,
    /// attitude.xml: the AEM in XML
    AemXml,
    /// pointing-periods.csv: what is observed when, between sessions too
    Ppl,
    /// attitude.a and sessions.int, for STK
    Stk,
    /// attitude.bc, clock.tsc and frame.tf, for SPICE
    Ck,
}

impl Also {
    /// Every product on request.
    pub const EACH: [Self; 6] =
        [Self::Parquet, Self::Aem, Self::AemXml, Self::Ppl, Self::Stk, Self::Ck];

    /// Its files.
    #[must_use]
    pub const fn files(self) -> &'static [&'static str] {
        match self {
            Self::Parquet => &["timeline.parquet"],
            Self::Aem => &["attitude.aem"],
            Self::AemXml => &["attitude.xml"],
            Self::Ppl => &["pointing-periods.csv"],
            Self::Stk => &["attitude.a", "sessions.int"],
            Self::Ck => &["attitude.bc", "clock.tsc", "frame.tf"],
        }
    }
}

/// What the products are made from.
#[derive(Debug)]
pub struct Products<'p> {
    /// The mission among the planets.
    pub world: &'p World,
    /// The Sun model on the table that goes on board.
    pub sun: SunModel<'p>,
    /// The timeline.
    pub timeline: &'p Timeline,
    /// When the files say they were made.
    pub stamp: Instant,
    /// Largest error of interpolation between samples of the attitude.
    pub error_rad: f64,
    /// Attitudes of the whole mission, not of the sessions alone.
    pub whole: bool,
    /// The spacecraft's NAIF number, negative.
    pub spacecraft: i32,
}

impl Products<'_> {
    /// What fills each file: those that are always there and those of `also`, in order.
    ///
    /// # Errors
    /// [`WriteError`] where the calendar cannot be written.
    pub fn fills<'f>(&'f self, also: &[Also]) -> Result<Vec<(&'static str, Fill<'f>)>, WriteError> {
        let attitudes = self.attitudes();
        let spans = std::rc::Rc::new(self.spans(&attitudes));
        let calendar = calendar::write(self.timeline, self.stamp)?;
        let mut fills: Vec<(&'static str, Fill<'f>)> = Vec::new();
        fills.push(("timeline.ics", Box::new(move |out| Ok(out.write_all(&calendar)?))));
        for product in also {
            let spans = spans.clone();
            match product {
                Also::Parquet => fills.push((
                    "timeline.parquet",
                    Box::new(|out| self.timeline.write_table(out, Format::Parquet)),
                )),
                Also::Aem => fills.push((
                    "attitude.aem",
                    Box::new(move |out| {
                        let message = message(Notation::Kvn, attitudes);
                        message.write(out, &spans, &|at| self.named(at))
                    }),
                )),
                Also::AemXml => fills.push((
                    "attitude.xml",
                    Box::new(move |out| {
                        let message = message(Notation::Xml, attitudes);
                        message.write(out, &spans, &|at| self.named(at))
                    }),
                )),
                Also::Ppl => fills.push((
                    "pointing-periods.csv",
                    Box::new(move |out| {
                        let mission = (self.world.start, self.world.end);
                        periods::write(out, self.timeline, &attitudes.motion, mission)
                    }),
                )),
                Also::Stk => {
                    fills.push((
                        "attitude.a",
                        Box::new(move |out| write_stk_attitude(out, &attitudes, &spans)),
                    ));
                    fills.push((
                        "sessions.int",
                        Box::new(|out| write_stk_intervals(out, self.timeline)),
                    ));
                }
                Also::Ck => {
                    let (clock, frame) = (spans.clone(), spans.clone());
                    fills.push((
                        "attitude.bc",
                        Box::new(move |out| self.kernels(attitudes, &spans).write_attitude(out)),
                    ));
                    fills.push((
                        "clock.tsc",
                        Box::new(move |out| self.kernels(attitudes, &clock).write_clock(out)),
                    ));
                    fills.push((
                        "frame.tf",
                        Box::new(move |out| self.kernels(attitudes, &frame).write_frame(out)),
                    ));
                }
            }
        }
        Ok(fills)
    }

    fn attitudes(&self) -> Attitudes<'_> {
        let motion = Motion { scan: &self.world.scan, sun: self.sun, frame: Rotation::IDENTITY };
        Attitudes {
            product: &self.world.mission.product,
            provenance: &self.timeline.provenance,
            stamp: self.stamp,
            motion,
            step: motion.step(self.error_rad),
        }
    }

    /// Where attitudes are written.
    fn spans(&self, attitudes: &Attitudes<'_>) -> Vec<Span> {
        let mission = (self.world.start, self.world.end);
        if self.whole {
            return vec![Span::whole(mission)];
        }
        let sessions: Vec<(Instant, Instant)> = self
            .timeline
            .sessions
            .iter()
            .map(|it| (Instant::from_tai_ns(it.start_tai_ns), Instant::from_tai_ns(it.end_tai_ns)))
            .collect();
        Span::of_sessions(&sessions, mission, attitudes.step.step)
    }

    fn named(&self, session: usize) -> String {
        let it = &self.timeline.sessions[session];
        format!("session {}: {} to {}", it.id, it.start_utc, it.end_utc)
    }

    fn kernels<'k>(&self, attitudes: Attitudes<'k>, spans: &'k [Span]) -> Kernels<'k> {
        Kernels { spacecraft: self.spacecraft, attitudes, spans }
    }
}

fn message(notation: Notation, attitudes: Attitudes<'_>) -> Message<'_> {
    Message { notation, frame: BodyFrame::Boresight, attitudes }
}
