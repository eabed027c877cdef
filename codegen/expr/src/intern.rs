//! Hash-consing: a hash table of node ids, and the hash function.

use std::hash::{BuildHasherDefault, Hash, Hasher};

/// A multiply-rotate hash of machine words.
///
/// NOTE: the standard hasher is keyed and, in an unoptimised build, several times slower; nodes are hashed on every
/// constructor call.
#[derive(Default, Clone, Debug)]
pub struct WordHasher(u64);

impl WordHasher {
    /// The hash of one value.
    pub(crate) fn hash_of(value: &impl Hash) -> u64 {
        let mut hasher = Self::default();
        value.hash(&mut hasher);
        hasher.finish()
    }
}

impl Hasher for WordHasher {
    fn write(&mut self, bytes: &[u8]) {
        for chunk in bytes.chunks(8) {
            let mut word = [0; 8];
            word[..chunk.len()].copy_from_slice(chunk);
            self.write_u64(u64::from_le_bytes(word));
        }
    }

    fn write_u64(&mut self, word: u64) {
        // The multiplier is 2^64 divided by the golden ratio, made odd.
        self.0 = (self.0.rotate_left(5) ^ word).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    }

    fn write_u8(&mut self, word: u8) {
        self.write_u64(u64::from(word));
    }

    fn write_u32(&mut self, word: u32) {
        self.write_u64(u64::from(word));
    }

    fn write_i64(&mut self, word: i64) {
        self.write_u64(word.cast_unsigned());
    }

    fn write_usize(&mut self, word: usize) {
        self.write_u64(word as u64);
    }

    fn write_isize(&mut self, word: isize) {
        self.write_u64(word as u64);
    }

    fn finish(&self) -> u64 {
        self.0 ^ (self.0 >> 32)
    }
}

/// Hasher for maps with lookups only. NOTE: never iterate over such a map.
pub type WordHash = BuildHasherDefault<WordHasher>;

/// An open-addressing table of positions into a vector that its owner keeps.
#[derive(Clone, Debug, Default)]
pub(crate) struct Table {
    /// Position + 1; 0 marks a free slot. The length is 0 or a power of two.
    slots: Vec<u32>,
    hashes: Vec<u64>,
}

impl Table {
    /// The position of the item with this hash for which `equal` holds.
    pub(crate) fn find(&self, hash: u64, equal: impl Fn(usize) -> bool) -> Option<usize> {
        let mask = self.slots.len().checked_sub(1)?;
        let mut slot = hash as usize & mask;
        while let Some(position) = (self.slots[slot] as usize).checked_sub(1) {
            if self.hashes[position] == hash && equal(position) {
                return Some(position);
            }
            slot = (slot + 1) & mask;
        }
        None
    }

    /// Adds the next position, `0, 1, 2, ...`.
    pub(crate) fn push(&mut self, hash: u64) {
        self.hashes.push(hash);
        if self.hashes.len() * 2 > self.slots.len() {
            self.slots = vec![0; (self.slots.len() * 2).max(64)];
            for position in 0..self.hashes.len() {
                self.place(position);
            }
        } else {
            self.place(self.hashes.len() - 1);
        }
    }

    fn place(&mut self, position: usize) {
        let mask = self.slots.len() - 1;
        let mut slot = self.hashes[position] as usize & mask;
        while self.slots[slot] != 0 {
            slot = (slot + 1) & mask;
        }
        self.slots[slot] = position as u32 + 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn items_are_found_after_the_table_has_grown() {
        let items: Vec<u64> = (0..1000).map(|k| k * 64).collect();
        let mut table = Table::default();
        for item in &items {
            table.push(WordHasher::hash_of(item));
        }
        for (position, item) in items.iter().enumerate() {
            let found = table.find(WordHasher::hash_of(item), |p| items[p] == *item);
            assert_eq!(found, Some(position));
        }
        assert_eq!(
            table.find(WordHasher::hash_of(&7u64), |p| items[p] == 7),
            None
        );
    }
}
