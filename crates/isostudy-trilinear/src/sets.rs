//! Disjoint sets of numbered things.

/// Sets that are joined and never parted; the lowest number of each is its name.
#[derive(Debug, Clone)]
pub(crate) struct Sets {
    towards_root: Vec<u32>,
}

impl Sets {
    pub(crate) fn new(len: usize) -> Self {
        Self { towards_root: (0..len as u32).collect() }
    }

    pub(crate) fn root(&mut self, of: u32) -> u32 {
        let mut v = of as usize;
        while self.towards_root[v] as usize != v {
            self.towards_root[v] = self.towards_root[self.towards_root[v] as usize];
            v = self.towards_root[v] as usize;
        }
        v as u32
    }

    pub(crate) fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.towards_root[a.max(b) as usize] = a.min(b);
    }
}
