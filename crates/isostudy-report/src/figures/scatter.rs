//! A panel of marks over two axes.

use super::axis::Axis;
use super::bars::{frame, room_for_labels};
use super::canvas::{Align, BLACK, Canvas, Colour, text_width, wrapped};
use super::marks::Mark;
use super::style::{GRID, IDEAL};

const RIGHT: f64 = 26.0;
const TOP: f64 = 34.0;
const BOTTOM: f64 = 44.0;
/// From one line of a heading to the next.
const LINE: f64 = 16.0;
const HEADING: f64 = 12.5;

/// A rectangle in canvas units.
#[derive(Debug, Clone, Copy)]
struct Room {
    left: f64,
    right: f64,
    top: f64,
    bottom: f64,
}

impl Room {
    fn around((x, y): (f64, f64), half: f64) -> Self {
        Self { left: x - half, right: x + half, top: y - half, bottom: y + half }
    }

    fn holds(self, other: Self) -> bool {
        self.left <= other.left
            && other.right <= self.right
            && self.top <= other.top
            && other.bottom <= self.bottom
    }

    fn overlaps(self, other: Self) -> bool {
        self.left < other.right
            && other.left < self.right
            && self.top < other.bottom
            && other.top < self.bottom
    }

    /// Whether the segment passes through: the share of it that lies between both pairs of sides is not empty.
    fn is_crossed(self, from: (f64, f64), to: (f64, f64)) -> bool {
        let between = |from: f64, to: f64, low: f64, high: f64| match to - from {
            0.0 if low < from && from < high => (0.0, 1.0),
            0.0 => (1.0, 0.0),
            run => {
                let (a, b) = ((low - from) / run, (high - from) / run);
                (a.min(b).max(0.0), a.max(b).min(1.0))
            }
        };
        let across = between(from.0, to.0, self.left, self.right);
        let down = between(from.1, to.1, self.top, self.bottom);
        across.0.max(down.0) < across.1.min(down.1)
    }
}

/// A panel.
pub(super) struct Scatter {
    pub(super) heading: String,
    pub(super) labels: (String, String),
    pub(super) x: Axis,
    pub(super) y: Axis,
    /// Lines under the marks.
    pub(super) lines: Vec<(Colour, Vec<(f64, f64)>)>,
    /// A dashed line at this height.
    pub(super) dashed: Option<f64>,
    pub(super) marks: Vec<((f64, f64), Mark)>,
    /// Names of points, each where it is clear of lines, marks and the names before it, and nowhere if there is no such place.
    pub(super) names: Vec<((f64, f64), String)>,
}

impl Scatter {
    /// Draws the panel into a rectangle.
    pub(super) fn draw(&self, canvas: &mut Canvas, from: (f64, f64), to: (f64, f64)) {
        let sheet = canvas.sheet();
        let em = sheet.em();
        let (left, right) = (from.0 + room_for_labels(sheet, &self.y), to.0 - sheet.length(RIGHT, 14.0));
        let heading = wrapped(&self.heading, HEADING, to.0 - from.0);
        let (top, bottom) = (from.1 + TOP + LINE * (heading.len() - 1) as f64, to.1 - BOTTOM);
        frame(canvas, &self.y, &self.labels.1, (left, right), (bottom, top));
        let place = |(x, y): (f64, f64)| (self.x.place(x, left, right), self.y.place(y, bottom, top));
        for &tick in &self.x.ticks {
            let x = self.x.place(tick, left, right);
            canvas.line(vec![(x, top), (x, bottom + 4.0)], GRID, 0.5);
        }
        for (x, text) in self.x.labels_between(left, right, em) {
            canvas.text_within(text, (x, bottom + 16.0), (from.0, to.0), em);
        }
        for tick in self.x.minor() {
            let x = self.x.place(tick, left, right);
            canvas.line(vec![(x, bottom), (x, bottom + 3.0)], BLACK, 0.5);
        }
        canvas.line(vec![(left, bottom), (right, bottom)], BLACK, 1.0);
        let at = ((left + right) / 2.0, bottom + 34.0);
        canvas.text_within(&self.labels.0, at, (from.0, to.0), em);
        for (line, text) in heading.into_iter().enumerate() {
            let at = ((left + right) / 2.0, from.1 + 20.0 + LINE * line as f64);
            canvas.text_within(text, at, (from.0, to.0), HEADING);
        }
        if let Some(height) = self.dashed {
            canvas.dashes(left, right, self.y.place(height, bottom, top), BLACK);
        }
        for (colour, line) in &self.lines {
            canvas.line(line.iter().map(|&point| place(point)).collect(), *colour, 1.5);
        }
        for (at, mark) in &self.marks {
            mark.draw(canvas, place(*at));
        }
        self.write_names(canvas, &place, Room { left, right, top, bottom });
    }

    fn write_names(&self, canvas: &mut Canvas, place: &dyn Fn((f64, f64)) -> (f64, f64), within: Room) {
        let em = canvas.sheet().em();
        let lines: Vec<Vec<(f64, f64)>> =
            self.lines.iter().map(|(_, line)| line.iter().map(|&at| place(at)).collect()).collect();
        let mut taken: Vec<Room> =
            self.marks.iter().map(|(at, _)| Room::around(place(*at), 0.45 * em)).collect();
        for (at, name) in &self.names {
            let (x, y) = place(*at);
            let width = text_width(name, em) + 2.0;
            let room = |(start, baseline): (f64, f64)| Room {
                left: start,
                right: start + width,
                top: baseline - 0.8 * em,
                bottom: baseline + 0.25 * em,
            };
            let clear = |of: &Room| {
                let crossed = |line: &Vec<(f64, f64)>| line.windows(2).any(|s| of.is_crossed(s[0], s[1]));
                within.holds(*of)
                    && !taken.iter().any(|other| of.overlaps(*other))
                    && !lines.iter().any(crossed)
            };
            // Corners first, below on the right before all; then the sides; then the same farther off.
            let places = [1.1, 2.3, 3.5, 4.7].into_iter().flat_map(|down| {
                let (below, above) = (y + down * em, y + (0.7 - down) * em);
                let (right, left, middle) = (x + 8.0, x - 8.0 - width, x - 0.5 * width);
                let corners = [(right, below), (left, above), (right, above), (left, below)];
                let level = y + 0.35 * em;
                corners.into_iter().chain([
                    (right + 4.0, level),
                    (left - 4.0, level),
                    (middle, below + 4.0),
                    (middle, above - 4.0),
                ])
            });
            let is_near = |(start, baseline): (f64, f64)| {
                let of = room((start, baseline));
                of.overlaps(Room::around((x, y), 1.2 * em))
            };
            // Where all is taken, the mark itself has to do: the legend says whose it is.
            let Some(start) = places.into_iter().find(|at| clear(&room(*at))) else { continue };
            taken.push(room(start));
            // A line leads to a mark that is farther off.
            if !is_near(start) {
                let of = room(start);
                let end = (x.clamp(of.left, of.right), y.clamp(of.top, of.bottom));
                let share = 7.0 / (end.0 - x).hypot(end.1 - y);
                let begin = (x + share * (end.0 - x), y + share * (end.1 - y));
                canvas.line(vec![begin, end], IDEAL, 0.5);
            }
            // Towards the mark, so that it is near.
            let (x, align) = match start.0 {
                from if from > x => (from, Align::Start),
                from if from + width < x => (from + width, Align::End),
                from => (from + 0.5 * width, Align::Middle),
            };
            canvas.text(name, (x, start.1), em, align);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_room_knows_what_passes_through() {
        let room = Room { left: 10.0, right: 20.0, top: 10.0, bottom: 20.0 };
        assert!(room.is_crossed((0.0, 0.0), (30.0, 30.0)) && room.is_crossed((15.0, 0.0), (15.0, 12.0)));
        assert!(
            !room.is_crossed((0.0, 15.0), (30.0, 30.0 + 15.0)) && !room.is_crossed((15.0, 0.0), (15.0, 9.0))
        );
        assert!(!room.is_crossed((0.0, 25.0), (30.0, 25.0)) && room.is_crossed((0.0, 15.0), (30.0, 15.0)));
        assert!(
            room.overlaps(Room::around((21.0, 15.0), 2.0)) && !room.overlaps(Room::around((23.0, 15.0), 2.0))
        );
    }
}
