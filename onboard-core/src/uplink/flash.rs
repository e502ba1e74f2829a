//! What is to be done to the flash next, one operation at a time, in the only order that is safe.
//!
//! [`Upload`] and [`Revocation`] hand out operations; the caller carries each out and asks for the
//! next with the slots as they then read. The core writes nothing itself and calls nothing back. An
//! upload erases its slot as a whole, programs the container word by word, and last the COMMIT word.
//! A revocation first programs the floor word of the container that is returned to, which carries the
//! rollback out, and then the REVOKED word of the one that is left.
//!
//! Method: before an operation is handed out, the one before it is read back: erased words must read
//! as ones, programmed ones as they were handed out. Before the COMMIT word the container is read and
//! checked as a whole where it now lies.
//!
//! Limits: an operation that fails ends the plan; after that, or after a reset, ask the slots anew
//! ([`Slots::admit`], [`Slots::roll_back`]). An upload begins again with its erase. Words are
//! [`WORD_BYTES`] long; a controller that programs more at a time gathers them, except the first and
//! the last of an upload, the floor and the REVOKED word, which stand alone.

use super::slot_layout::{
    COMMIT_OFFSET, CONTAINER_OFFSET, ERASED, REVOKED, REVOKED_OFFSET, Slot, Slots, WORD_BYTES,
    Word, commit_word, floor_word, image, is_erased, reads,
};
use super::{Container, Header, UplinkError};
use crate::convert::{rolled, uncounted};

/// The next thing to do to the flash.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FlashOperation {
    /// Erase every sector of the slot, the one with its head first.
    Erase(Slot),
    /// Program this word, which was not programmed since it was erased.
    Program {
        /// The slot.
        slot: Slot,
        /// Where the word begins in the slot, a multiple of [`WORD_BYTES`].
        offset: usize,
        /// Its bytes.
        word: Word,
    },
}

/// Why a plan of operations ends before it is carried out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum FlashError {
    /// The word at this offset of the slot should read as ones, and does not.
    NotErased(Slot, usize),
    /// The word at this offset of the slot does not read as it was to be programmed.
    NotProgrammed(Slot, usize),
    /// The container in the slot is not whole.
    Unsound(UplinkError),
    /// The container in the slot is another one than was admitted.
    Changed,
}

/// How far an upload is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum UploadStage {
    /// The erase is next.
    Erase,
    /// The head is to be read back, then the container's first word is next.
    Head,
    /// The container's word at this offset of it was handed out.
    Word(usize),
    /// The COMMIT word was handed out.
    Commit,
    Over,
}

/// A container that was admitted, on its way into its slot.
#[derive(Debug, Clone, Copy)]
pub struct Upload<'c> {
    candidate: &'c [u8],
    header: Header,
    set_digest: u64,
    slot: Slot,
    stage: UploadStage,
}

impl<'c> Upload<'c> {
    pub(super) const fn new(
        candidate: &'c [u8],
        header: Header,
        set_digest: u64,
        slot: Slot,
    ) -> Self {
        Self { candidate, header, set_digest, slot, stage: UploadStage::Erase }
    }

    /// The slot that is written; the other one stays in use meanwhile.
    #[must_use]
    pub const fn slot(&self) -> Slot {
        self.slot
    }

    /// The next operation, with the slots as they now read; `None` when the container is committed.
    ///
    /// # Errors
    /// [`FlashError`] where the operation before did not do what it should; nothing follows then.
    #[inline(never)]
    // REQ-SLOT-2.
    pub fn next(&mut self, slots: &Slots<'_>) -> Result<Option<FlashOperation>, FlashError> {
        let result = self.advance(slots.bytes(self.slot));
        if result.is_err() {
            self.stage = UploadStage::Over;
        }
        result
    }

    fn advance(&mut self, bytes: &[u8]) -> Result<Option<FlashOperation>, FlashError> {
        match self.stage {
            UploadStage::Erase => {
                self.stage = UploadStage::Head;
                Ok(Some(FlashOperation::Erase(self.slot)))
            }
            UploadStage::Head => {
                let head = bytes.get(..CONTAINER_OFFSET).unwrap_or(&[]);
                for (index, word) in head.as_chunks::<WORD_BYTES>().0.iter().enumerate() {
                    if *word != ERASED {
                        let offset = index.wrapping_mul(WORD_BYTES);
                        return Err(FlashError::NotErased(self.slot, offset));
                    }
                }
                self.program(bytes, 0)
            }
            UploadStage::Word(at) => {
                self.read_back(bytes, CONTAINER_OFFSET.wrapping_add(at), &self.word(at))?;
                let next = at.wrapping_add(WORD_BYTES);
                if next < self.candidate.len() {
                    self.program(bytes, next)
                } else {
                    self.commit(bytes)
                }
            }
            UploadStage::Commit => {
                self.read_back(bytes, COMMIT_OFFSET, &self.commit_word())?;
                self.stage = UploadStage::Over;
                Ok(None)
            }
            UploadStage::Over => Ok(None),
        }
    }

    /// The container's word at this offset of it, filled up with ones.
    #[inline(never)]
    fn word(&self, at: usize) -> Word {
        let mut bytes = self.candidate.get(at..).unwrap_or(&[]).iter();
        let mut word = [0; WORD_BYTES];
        for byte in word.iter_mut().take(uncounted(WORD_BYTES)) {
            rolled();
            *byte = bytes.next().copied().unwrap_or(0xff);
        }
        word
    }

    fn commit_word(&self) -> Word {
        let length = u32::try_from(self.candidate.len()).unwrap_or(u32::MAX);
        commit_word(self.header.sequence, length, self.set_digest)
    }

    #[inline(never)]
    fn program(&mut self, bytes: &[u8], at: usize) -> Result<Option<FlashOperation>, FlashError> {
        let offset = CONTAINER_OFFSET.wrapping_add(at);
        if !is_erased(bytes, offset) {
            return Err(FlashError::NotErased(self.slot, offset));
        }
        self.stage = UploadStage::Word(at);
        Ok(Some(FlashOperation::Program { slot: self.slot, offset, word: self.word(at) }))
    }

    #[inline(never)]
    fn commit(&mut self, bytes: &[u8]) -> Result<Option<FlashOperation>, FlashError> {
        let written = Container::parse(image(bytes)).map_err(FlashError::Unsound)?;
        if written.header() != self.header || written.set_digest() != self.set_digest {
            return Err(FlashError::Changed);
        }
        if !is_erased(bytes, COMMIT_OFFSET) {
            return Err(FlashError::NotErased(self.slot, COMMIT_OFFSET));
        }
        self.stage = UploadStage::Commit;
        let word = self.commit_word();
        Ok(Some(FlashOperation::Program { slot: self.slot, offset: COMMIT_OFFSET, word }))
    }

    fn read_back(&self, bytes: &[u8], offset: usize, word: &Word) -> Result<(), FlashError> {
        if reads(bytes, offset, word) {
            Ok(())
        } else {
            Err(FlashError::NotProgrammed(self.slot, offset))
        }
    }
}

/// How far a revocation is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum RevocationStage {
    /// The floor word is next.
    Floor,
    /// The floor word was handed out.
    Revoked,
    /// The REVOKED word was handed out.
    ReadBack,
    Over,
}

/// A rollback on its way: the floor word of one slot, then the REVOKED word of the other.
#[derive(Debug, Clone, Copy)]
pub struct Revocation {
    /// The slot that is left.
    slot: Slot,
    /// Its container's sequence number.
    sequence: u32,
    /// Where the floor word lies in the other slot.
    floor_offset: usize,
    stage: RevocationStage,
}

impl Revocation {
    pub(super) const fn new(slot: Slot, sequence: u32, floor_offset: usize) -> Self {
        Self { slot, sequence, floor_offset, stage: RevocationStage::Floor }
    }

    /// The slot whose container is revoked.
    #[must_use]
    pub const fn slot(&self) -> Slot {
        self.slot
    }

    /// The next operation, with the slots as they now read; `None` when the container is revoked.
    ///
    /// # Errors
    /// [`FlashError`] where a word did not take what was programmed; nothing follows then.
    #[inline(never)]
    pub fn next(&mut self, slots: &Slots<'_>) -> Result<Option<FlashOperation>, FlashError> {
        let result = self.advance(slots);
        if result.is_err() {
            self.stage = RevocationStage::Over;
        }
        result
    }

    fn advance(&mut self, slots: &Slots<'_>) -> Result<Option<FlashOperation>, FlashError> {
        let kept = self.slot.other();
        let floor = floor_word(self.sequence);
        let floor_is = |word| reads(slots.bytes(kept), self.floor_offset, word);
        match self.stage {
            RevocationStage::Floor => {
                if !floor_is(&ERASED) {
                    return Err(FlashError::NotErased(kept, self.floor_offset));
                }
                self.stage = RevocationStage::Revoked;
                let offset = self.floor_offset;
                Ok(Some(FlashOperation::Program { slot: kept, offset, word: floor }))
            }
            RevocationStage::Revoked => {
                if !floor_is(&floor) {
                    return Err(FlashError::NotProgrammed(kept, self.floor_offset));
                }
                if !is_erased(slots.bytes(self.slot), REVOKED_OFFSET) {
                    return Err(FlashError::NotErased(self.slot, REVOKED_OFFSET));
                }
                self.stage = RevocationStage::ReadBack;
                let (slot, offset) = (self.slot, REVOKED_OFFSET);
                Ok(Some(FlashOperation::Program { slot, offset, word: REVOKED }))
            }
            RevocationStage::ReadBack => {
                if !reads(slots.bytes(self.slot), REVOKED_OFFSET, &REVOKED) {
                    return Err(FlashError::NotProgrammed(self.slot, REVOKED_OFFSET));
                }
                self.stage = RevocationStage::Over;
                Ok(None)
            }
            RevocationStage::Over => Ok(None),
        }
    }
}
