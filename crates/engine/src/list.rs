//! The pairs of a tile in the form that the force loop reads. They are checked when the list is made, so that the loop need
//! not check each access: half of the instructions of a gather would be comparisons with the lengths of arrays.

use granule_state::Row;

use crate::tile::{Outgoing, Pair, Shared};

/// Entries read ahead of the current one. So many repetitions stand behind the last pair of a list.
pub(crate) const AHEAD: usize = 24;

/// All pairs that a tile evaluates, as columns.
#[derive(Clone, Debug, Default)]
pub(crate) struct ForceList {
    /// Place of i within the tile, times 32, plus the image code of j.
    i_image: Vec<u32>,
    /// Place of j among all bodies.
    j: Vec<u32>,
    /// Where the force on j goes: its place within the tile, or the number of bodies of the tile plus a slot of the
    /// outbox.
    to: Vec<u32>,
    first: usize,
    own: usize,
    bodies: usize,
    slots: usize,
}

impl ForceList {
    /// Begins a list of the tile of the bodies `first..first + own` of `bodies`.
    pub fn clear(&mut self, first: usize, own: usize, bodies: usize) {
        assert!(first + own <= bodies, "a tile has bodies of the run");
        for column in [&mut self.i_image, &mut self.j, &mut self.to] {
            column.clear();
        }
        (self.first, self.own, self.bodies, self.slots) = (first, own, bodies, 0);
    }

    /// Adds a pair whose force on j goes to `to`.
    pub fn push(&mut self, pair: Pair, to: usize) {
        assert!(pair.place() < self.own && (pair.j as usize) < self.bodies, "a pair has bodies of the tile");
        self.slots = self.slots.max((to + 1).saturating_sub(self.own));
        self.i_image.push(pair.i_image);
        self.j.push(pair.j);
        self.to.push(to as u32);
    }

    /// Ends the list; the outbox has `slots` slots.
    pub fn finish(&mut self, slots: usize) {
        assert!(self.slots <= slots && self.own + slots <= u32::MAX as usize, "targets exist");
        self.slots = slots;
        for column in [&mut self.i_image, &mut self.j, &mut self.to] {
            if let Some(last) = column.last().copied() {
                column.extend([last; AHEAD + 4]);
            }
        }
    }

    /// The pairs with the rows that they refer to, after a check that these are as many as when the list was made.
    pub fn view<'a>(&'a self, bodies: &Shared<'a>) -> View<'a> {
        let own = self.first..self.first + self.own;
        let rows = |rows: &'a [Row]| -> RowsOf<'a> {
            assert_eq!(rows.len(), self.bodies, "the bodies are those of the list");
            RowsOf { own: &rows[own.clone()], all: rows }
        };
        View {
            i_image: &self.i_image,
            j: &self.j,
            to: &self.to,
            position: rows(bodies.position),
            velocity: rows(bodies.velocity),
            spin: if bodies.spin.is_empty() { RowsOf { own: &[], all: &[] } } else { rows(bodies.spin) },
        }
    }

    /// Checks that forces have the rows that the targets of this list need.
    pub fn check_sums(&self, force: &[Row], torque: &[Row], outbox: &[Outgoing]) {
        let torques = torque.is_empty() || torque.len() == self.own;
        assert!(
            force.len() == self.own && torques && outbox.len() == self.slots,
            "forces are those of the list"
        );
    }

    /// Heap bytes.
    pub fn bytes(&self) -> usize {
        (self.i_image.capacity() + self.j.capacity() + self.to.capacity()) * 4
    }
}

/// One column of rows: those of the bodies of the tile, and all.
#[derive(Clone, Copy)]
pub(crate) struct RowsOf<'a> {
    pub own: &'a [Row],
    pub all: &'a [Row],
}

/// A list with the rows that its entries refer to. `own` and `all` of position and velocity, and of spin unless it is
/// empty, have a row for every i and j of every entry.
#[derive(Clone, Copy)]
pub(crate) struct View<'a> {
    i_image: &'a [u32],
    j: &'a [u32],
    to: &'a [u32],
    pub position: RowsOf<'a>,
    pub velocity: RowsOf<'a>,
    pub spin: RowsOf<'a>,
}

/// Four pairs of a list.
#[derive(Clone, Copy)]
pub(crate) struct Four<'a> {
    /// Places of i within the tile, times 32, plus image codes of j.
    pub i_image: &'a [u32; 4],
    /// Places of j among all bodies.
    pub j: &'a [u32; 4],
    /// Where the forces on j go.
    pub to: &'a [u32; 4],
    /// Places of j of four pairs far ahead.
    pub ahead: &'a [u32; 4],
}

impl<'a> View<'a> {
    /// Four pairs from `index` on; `None` behind the last one.
    #[inline(always)]
    pub fn four_from(&self, index: usize) -> Option<Four<'a>> {
        let j = self.j.get(index..index + AHEAD + 4)?;
        Some(Four {
            i_image: self.i_image.get(index..)?.first_chunk()?,
            j: j.first_chunk()?,
            to: self.to.get(index..)?.first_chunk()?,
            ahead: j.last_chunk()?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pair(place: u32, j: u32) -> Pair {
        Pair { i_image: place << 5 | 13, j }
    }

    #[test]
    fn entries_say_what_was_pushed() {
        let mut list = ForceList::default();
        list.clear(2, 3, 10);
        list.push(pair(0, 3), 1);
        list.push(pair(2, 9), 3);
        list.finish(1);
        let rows = [Row::ZERO; 10];
        let shared = Shared { position: &rows, velocity: &rows, spin: &[], mass: &[] };
        let view = list.view(&shared);
        assert_eq!((view.position.own.len(), view.position.all.len()), (3, 10));
        let four = view.four_from(0).unwrap();
        assert_eq!((four.i_image[1], four.j[1], four.to[1]), (2 << 5 | 13, 9, 3));
        assert_eq!(four.ahead, &[9; 4], "the last pair is repeated");
        list.check_sums(&[Row::ZERO; 3], &[], &[Outgoing::default()]);
    }

    #[test]
    #[should_panic(expected = "a pair has bodies of the tile")]
    fn a_place_outside_of_the_tile_is_refused() {
        let mut list = ForceList::default();
        list.clear(0, 3, 10);
        list.push(pair(3, 4), 1);
    }

    #[test]
    #[should_panic(expected = "a pair has bodies of the tile")]
    fn a_body_that_does_not_exist_is_refused() {
        let mut list = ForceList::default();
        list.clear(0, 3, 10);
        list.push(pair(0, 10), 1);
    }

    #[test]
    #[should_panic(expected = "targets exist")]
    fn a_slot_that_does_not_exist_is_refused() {
        let mut list = ForceList::default();
        list.clear(0, 3, 10);
        list.push(pair(0, 9), 4);
        list.finish(1);
    }

    #[test]
    #[should_panic(expected = "the bodies are those of the list")]
    fn rows_of_other_bodies_are_refused() {
        let mut list = ForceList::default();
        list.clear(0, 3, 10);
        list.finish(0);
        let rows = [Row::ZERO; 9];
        list.view(&Shared { position: &rows, velocity: &rows, spin: &[], mass: &[] });
    }
}
