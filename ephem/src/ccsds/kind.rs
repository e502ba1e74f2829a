//! What tells an OEM from an AEM: keywords, versions, blocks.

/// The keywords around a block of KVN.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Fence {
    /// The block's name in sentences.
    pub name: &'static str,
    /// Keyword that begins it.
    pub start: &'static str,
    /// Keyword that ends it.
    pub stop: &'static str,
}

/// Around the metadata of every message.
pub(super) const META: Fence = Fence { name: "META", start: "META_START", stop: "META_STOP" };

/// Keywords of a header, after the one of the version.
pub(super) const HEADER_KEYS: [&str; 5] =
    ["CLASSIFICATION", "COMMENT", "CREATION_DATE", "MESSAGE_ID", "ORIGINATOR"];

/// A kind of message.
#[derive(Debug, Clone, Copy)]
pub struct MessageKind {
    /// Its name.
    pub name: &'static str,
    /// Keyword of its version, with which its KVN begins.
    pub opening: &'static str,
    /// Its element in XML.
    pub element: &'static str,
    /// Versions that are read.
    pub versions: &'static [&'static str],
    /// Keywords that may stand in its metadata.
    pub keys: &'static [&'static str],
    /// Time systems that are read.
    pub time_systems: &'static [&'static str],
    /// Around the data in KVN; `None` where the data simply follows the metadata.
    pub data: Option<Fence>,
    /// A block among the data in KVN that is passed over.
    pub passed_over: Option<Fence>,
    /// Element of a record in XML.
    pub record: &'static str,
}

impl MessageKind {
    /// Orbit Ephemeris Message \[CCSDS502\], versions 1 to 3.
    pub const OEM: Self = Self {
        name: "OEM",
        opening: "CCSDS_OEM_VERS",
        element: "oem",
        versions: &["1.0", "2.0", "3.0"],
        keys: &[
            "CENTER_NAME",
            "COMMENT",
            "INTERPOLATION",
            "INTERPOLATION_DEGREE",
            "META_STOP",
            "OBJECT_ID",
            "OBJECT_NAME",
            "REF_FRAME",
            "REF_FRAME_EPOCH",
            "START_TIME",
            "STOP_TIME",
            "TIME_SYSTEM",
            "USEABLE_START_TIME",
            "USEABLE_STOP_TIME",
        ],
        time_systems: &["UTC", "TDB", "TAI", "TT"],
        data: None,
        passed_over: Some(Fence {
            name: "covariance",
            start: "COVARIANCE_START",
            stop: "COVARIANCE_STOP",
        }),
        record: "stateVector",
    };

    /// Attitude Ephemeris Message \[CCSDS504\], versions 1 and 2.
    pub const AEM: Self = Self {
        name: "AEM",
        opening: "CCSDS_AEM_VERS",
        element: "aem",
        versions: &["1.0", "2.0"],
        keys: &[
            "ANGVEL_FRAME",
            "ATTITUDE_DIR",
            "ATTITUDE_TYPE",
            "CENTER_NAME",
            "COMMENT",
            "EULER_ROT_SEQ",
            "INTERPOLATION_DEGREE",
            "INTERPOLATION_METHOD",
            "OBJECT_ID",
            "OBJECT_NAME",
            "QUATERNION_TYPE",
            "RATE_FRAME",
            "REF_FRAME_A",
            "REF_FRAME_B",
            "START_TIME",
            "STOP_TIME",
            "TIME_SYSTEM",
            "USEABLE_START_TIME",
            "USEABLE_STOP_TIME",
        ],
        time_systems: &["UTC", "TAI", "TT", "TDB"],
        data: Some(Fence { name: "data", start: "DATA_START", stop: "DATA_STOP" }),
        passed_over: None,
        record: "attitudeState",
    };
}
