//! Marks told apart by shape, so that neither colour nor lightness is needed.

use super::canvas::{BLACK, Canvas, Colour, WHITE};

/// Shapes, in the order they are given out.
const SHAPES: [Shape; 8] = [
    Shape::Circle,
    Shape::Triangle,
    Shape::Square,
    Shape::Diamond,
    Shape::Down,
    Shape::Cross,
    Shape::Hourglass,
    Shape::Star,
];
/// How many shapes there are.
pub(super) const SHAPE_COUNT: usize = SHAPES.len();

#[derive(Debug, Clone, Copy, PartialEq)]
enum Shape {
    Circle,
    Triangle,
    Square,
    Diamond,
    Down,
    Cross,
    Hourglass,
    Star,
}

/// What is inside a shape.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Filling {
    Full,
    Hollow,
    /// Hollow, with a dot.
    Dotted,
    /// Full, with a hole.
    Holed,
}

/// A shape and its filling.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Mark {
    shape: Shape,
    filling: Filling,
    colour: Colour,
}

impl Mark {
    /// The mark of the n-th of several things; after eight they begin again.
    pub(super) fn nth(n: usize, filled: bool) -> Self {
        Self::of(n, if filled { Filling::Full } else { Filling::Hollow })
    }

    /// As [`Mark::nth`], of more than two kinds.
    pub(super) fn of(n: usize, filling: Filling) -> Self {
        Self { shape: SHAPES[n % SHAPES.len()], filling, colour: BLACK }
    }

    /// In a colour, which says no more than the shape does.
    pub(super) fn coloured(self, colour: Colour) -> Self {
        Self { colour, ..self }
    }

    pub(super) fn draw(self, canvas: &mut Canvas, (x, y): (f64, f64)) {
        let outline = |r: f64| -> Vec<(f64, f64)> {
            let at = |points: &[(f64, f64)]| points.iter().map(|(a, b)| (x + r * a, y + r * b)).collect();
            match self.shape {
                Shape::Circle => (0..20)
                    .map(|i| f64::from(i) * std::f64::consts::TAU / 20.0)
                    .map(|t| (x + r * t.cos(), y + r * t.sin()))
                    .collect(),
                Shape::Triangle => at(&[(0.0, -1.2), (1.1, 0.8), (-1.1, 0.8)]),
                Shape::Square => at(&[(-0.9, -0.9), (0.9, -0.9), (0.9, 0.9), (-0.9, 0.9)]),
                Shape::Diamond => at(&[(0.0, -1.25), (1.25, 0.0), (0.0, 1.25), (-1.25, 0.0)]),
                Shape::Down => at(&[(0.0, 1.2), (1.1, -0.8), (-1.1, -0.8)]),
                Shape::Hourglass => {
                    at(&[(-1.0, -1.1), (1.0, -1.1), (0.45, 0.0), (1.0, 1.1), (-1.0, 1.1), (-0.45, 0.0)])
                }
                Shape::Star => (0..10)
                    .map(|i| {
                        (f64::from(i) * std::f64::consts::TAU / 10.0, if i % 2 == 0 { 1.4 } else { 0.6 })
                    })
                    .map(|(t, share)| (x + r * share * t.sin(), y - r * share * t.cos()))
                    .collect(),
                Shape::Cross => at(&[
                    (-0.35, -1.1),
                    (0.35, -1.1),
                    (0.35, -0.35),
                    (1.1, -0.35),
                    (1.1, 0.35),
                    (0.35, 0.35),
                    (0.35, 1.1),
                    (-0.35, 1.1),
                    (-0.35, 0.35),
                    (-1.1, 0.35),
                    (-1.1, -0.35),
                    (-0.35, -0.35),
                ]),
            }
        };
        // White-edged, so that marks on top of each other stay apart.
        canvas.polygon(outline(6.2), WHITE);
        canvas.polygon(outline(5.0), self.colour);
        match self.filling {
            Filling::Full => {}
            Filling::Hollow => canvas.polygon(outline(3.2), WHITE),
            Filling::Dotted => {
                canvas.polygon(outline(3.2), WHITE);
                canvas.polygon(outline(1.6), self.colour);
            }
            Filling::Holed => canvas.polygon(outline(2.0), WHITE),
        }
    }
}
