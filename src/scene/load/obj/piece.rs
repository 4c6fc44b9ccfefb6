//! What a piece of an OBJ file says, read without knowing the others: vertices, and what faces,
//! names and materials there are, in order.

use super::corners::{Counts, Layout, kept, written};
use super::statements::{Statements, values};
use super::vertices::Vertices;
use crate::geometry::num;
use crate::scene::load::text::Line;
use crate::scene::{LoadCx, Reason};
use crate::task::Charge;

pub(super) struct Piece {
    pub vertices: Vertices,
    /// How many of them there are, also when they were taken away.
    pub counts: Counts,
    /// The indices of all corners, as [`kept`] has them.
    pub indices: Vec<i32>,
    pub steps: Vec<Step>,
    names: Vec<u8>,
    /// Lines, points and faces without corners.
    pub no_triangles: u64,
    /// In bytes of text.
    pub length: usize,
    /// In lines.
    pub lines: usize,
    memory: Charge,
}

/// What stands in a piece besides vertices.
#[derive(Clone, Copy)]
pub(super) enum Step {
    /// So many faces of so many corners each: their indices follow those of the steps before.
    Faces { layout: Layout, corners: u32, count: u32 },
    /// `o` or `g`.
    Name(Name),
    /// `usemtl`.
    Material(Name),
    /// `mtllib`.
    Library(Name),
    /// A face that cannot be read. What follows it does not count.
    Wrong,
}

/// A stretch of the names of a piece.
#[derive(Clone, Copy)]
pub(super) struct Name {
    from: u32,
    length: u32,
}

/// What a byte of text may take while it is read: "g" and a line end are a step, in a list that
/// has twice that room and moves to a place of its own as it grows.
const SPREAD: u64 = 18;

impl Piece {
    /// Reads a piece of which the first line is number `first`, which only errors tell.
    pub fn read(text: &[u8], first: usize, cx: &LoadCx) -> Result<Self, Reason> {
        // The many pieces that are left must not each go on to their own first look at the flag.
        cx.cancel.check()?;
        let mut piece = Self::new(text.len(), cx)?;
        let mut statements = Statements::within(text, first, cx);
        loop {
            while let Some(length) = piece.quick(statements.rest()) {
                statements.pass(length)?;
            }
            let Some(line) = statements.next()? else { break };
            piece.statement(&line)?;
        }
        piece.counts = piece.vertices.counts();
        piece.lines = statements.number() + 1 - first;
        piece.memory = cx.budget.charge(piece.bytes())?;
        Ok(piece)
    }

    fn new(length: usize, cx: &LoadCx) -> Result<Self, Reason> {
        let memory = cx.budget.charge(SPREAD * length as u64)?;
        let (vertices, counts, indices, steps, names) = Default::default();
        Ok(Self { vertices, counts, indices, steps, names, no_triangles: 0, length, lines: 0, memory })
    }

    fn bytes(&self) -> u64 {
        let lists = self.indices.capacity() * 4 + self.steps.capacity() * size_of::<Step>() + self.names.capacity();
        (lists + self.vertices.bytes()) as u64
    }

    /// The vertices, which are no longer held here, and the memory they take.
    pub fn take_vertices(&mut self, cx: &LoadCx) -> Result<(Vertices, Charge), Reason> {
        let vertices = std::mem::take(&mut self.vertices);
        let theirs = cx.budget.charge(vertices.bytes() as u64)?;
        self.memory = cx.budget.charge(self.bytes())?;
        Ok((vertices, theirs))
    }

    /// What was written as a name.
    pub fn name(&self, name: Name) -> &[u8] {
        &self.names[name.from as usize..][..name.length as usize]
    }

    /// The names of the material files.
    pub fn libraries(&self) -> impl Iterator<Item = &[u8]> {
        let library = |step: &Step| if let Step::Library(name) = step { Some(self.name(*name)) } else { None };
        self.steps.iter().filter_map(library)
    }

    /// The triangles that the faces are cut into.
    pub fn triangles(&self) -> usize {
        let of = |step: &Step| match *step {
            Step::Faces { corners, count, .. } => (corners as usize).saturating_sub(2) * count as usize,
            _ => 0,
        };
        self.steps.iter().map(of).sum()
    }

    fn statement(&mut self, line: &Line) -> Result<(), Reason> {
        let Some(word) = line.words().next() else { return Ok(()) };
        match word {
            b"f" | b"fo" => self.face(line),
            b"l" | b"p" => self.no_triangles += 1,
            b"o" | b"g" => self.named(Step::Name, line.tail()),
            b"usemtl" => self.named(Step::Material, line.tail()),
            b"mtllib" => self.named(Step::Library, line.tail()),
            _ => self.vertices.statement(word, line)?,
        }
        Ok(())
    }

    fn named(&mut self, step: impl Fn(Name) -> Step, name: &[u8]) {
        let (from, length) = (num::index(self.names.len()), num::index(name.len()));
        self.names.extend_from_slice(name);
        self.steps.push(step(Name { from, length }));
    }

    fn face(&mut self, line: &Line) {
        let seen = self.vertices.counts();
        let mut corners = 0;
        for word in values(line) {
            let Some(indices) = written(word) else {
                self.steps.push(Step::Wrong);
                return;
            };
            self.indices.extend([0, 1, 2].map(|part| kept(indices[part], seen[part], self.length)));
            corners += 1;
        }
        self.push_faces(Layout::Both, corners);
    }

    /// Counts a face whose indices were added.
    #[inline(always)]
    pub fn push_faces(&mut self, layout: Layout, corners: u32) {
        match self.steps.last_mut() {
            Some(Step::Faces { layout: l, corners: c, count }) if *l == layout && *c == corners => *count += 1,
            _ if corners == 0 => self.no_triangles += 1,
            _ => self.steps.push(Step::Faces { layout, corners, count: 1 }),
        }
    }
}
