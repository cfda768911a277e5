//! The palette's nearest colour.

use crate::Palette;

/// The palette by channel, for a search that vectorises.
pub(crate) struct Search {
    red: [f32; 256],
    green: [f32; 256],
    blue: [f32; 256],
}

impl Search {
    pub(crate) fn new(palette: &Palette) -> Search {
        // Far away, so that places without a colour are never the nearest.
        let mut search = Search { red: [1e6; 256], green: [1e6; 256], blue: [1e6; 256] };
        for (i, &[r, g, b]) in palette.colours().iter().enumerate() {
            (search.red[i], search.green[i], search.blue[i]) = (r as f32, g as f32, b as f32);
        }
        search
    }

    /// The lowest index at the least Euclidean distance.
    pub(crate) fn nearest(&self, [r, g, b]: [f32; 3]) -> u8 {
        let mut distance = [0.0f32; 256];
        for (i, d) in distance.iter_mut().enumerate() {
            let (dr, dg, db) = (self.red[i] - r, self.green[i] - g, self.blue[i] - b);
            *d = dr * dr + dg * dg + db * db;
        }
        let mut lanes = [f32::MAX; 8];
        for eight in distance.chunks_exact(8) {
            for (least, &d) in lanes.iter_mut().zip(eight) {
                *least = if d < *least { d } else { *least };
            }
        }
        let least = lanes.iter().copied().fold(f32::MAX, f32::min);
        distance.iter().position(|&d| d == least).expect("the least is one of them") as u8
    }
}
