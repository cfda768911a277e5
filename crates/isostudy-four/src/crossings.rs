//! The vertices: one on each lattice edge between an inside and an outside sample.

use crate::error::FourError;

/// Samples of a frame, and the isovalue there.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Level<'a> {
    pub(crate) samples: &'a [f32],
    pub(crate) isovalue: f32,
}

impl Level<'_> {
    /// Inside is above; what equals the isovalue is outside.
    pub(crate) fn is_inside(&self, sample: usize) -> bool {
        self.samples[sample] > self.isovalue
    }

    /// In double precision, so that it is 0 for equal numbers alone.
    fn difference(&self, sample: usize) -> f64 {
        f64::from(self.samples[sample]) - f64::from(self.isovalue)
    }
}

/// Vertices on lattice edges of one kind: those of a frame, along x, y and z, or those from a frame to the next.
pub(crate) struct Crossings {
    first: Vec<u32>,
    /// The axes along which the edge that begins at a sample is crossed, one bit each.
    axes: Vec<u8>,
}

impl Crossings {
    /// The vertex on an edge that is crossed.
    pub(crate) fn vertex(&self, sample: usize, axis: u8) -> u32 {
        self.first[sample] + (self.axes[sample] & ((1 << axis) - 1)).count_ones()
    }

    /// Those of a frame. `push` gets the coordinates of each, in the lattice, in the order of their numbers: that of the samples that
    /// their edges begin at, then of axes. The first has the number `from`.
    ///
    /// # Errors
    /// [`FourError::TooMany`].
    pub(crate) fn within(
        counts: [usize; 3],
        level: Level,
        from: usize,
        mut push: impl FnMut([f64; 3]),
    ) -> Result<Self, FourError> {
        let steps = [1, counts[0], counts[0] * counts[1]];
        let mut vertices = Numbers::new(level.samples.len(), from);
        for z in 0..counts[2] {
            for y in 0..counts[1] {
                for x in 0..counts[0] {
                    let (place, here) = ([x, y, z], (z * counts[1] + y) * counts[0] + x);
                    let side = level.is_inside(here);
                    let mut axes = 0;
                    for axis in (0..3).filter(|&axis| place[axis] + 1 < counts[axis]) {
                        let there = here + steps[axis];
                        if level.is_inside(there) != side {
                            axes |= 1 << axis;
                            let mut at = place.map(|i| i as f64);
                            at[axis] += share(level.difference(here), level.difference(there));
                            push(at);
                        }
                    }
                    vertices.add(axes)?;
                }
            }
        }
        Ok(vertices.made)
    }

    /// Those from a frame to the next. `push` gets the sample that each is at, and the share of the way.
    ///
    /// # Errors
    /// [`FourError::TooMany`].
    pub(crate) fn between(
        levels: [Level; 2],
        from: usize,
        mut push: impl FnMut(usize, f64),
    ) -> Result<Self, FourError> {
        let mut vertices = Numbers::new(levels[0].samples.len(), from);
        for sample in 0..levels[0].samples.len() {
            let [before, after] = levels.map(|level| level.is_inside(sample));
            if before != after {
                let [before, after] = levels.map(|level| level.difference(sample));
                push(sample, share(before, after));
            }
            vertices.add(u8::from(before != after))?;
        }
        Ok(vertices.made)
    }
}

/// How far from one difference to another is 0: from 0 to 1, since one is above 0 and the other is not.
fn share(from: f64, to: f64) -> f64 {
    from / (from - to)
}

struct Numbers {
    made: Crossings,
    next: usize,
}

impl Numbers {
    fn new(samples: usize, from: usize) -> Self {
        let made = Crossings { first: Vec::with_capacity(samples), axes: Vec::with_capacity(samples) };
        Self { made, next: from }
    }

    fn add(&mut self, axes: u8) -> Result<(), FourError> {
        self.made.first.push(u32::try_from(self.next).map_err(|_| FourError::TooMany)?);
        self.made.axes.push(axes);
        self.next += axes.count_ones() as usize;
        Ok(())
    }
}
