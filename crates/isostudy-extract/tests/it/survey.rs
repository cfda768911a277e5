//! A survey of a mesh's components, and every way in which it is not a manifold. Written apart from the crates' own
//! checks; only sorting and joining are needed.

/// Euler characteristic and boundary loops of a component.
pub(crate) type Component = (i64, usize);

/// The components of an oriented manifold that uses all its vertices, sorted; or what is wrong with it.
pub(crate) fn survey(vertices: usize, triangles: &[[u32; 3]]) -> Result<Vec<Component>, String> {
    let mut sides: Vec<(u32, u32, u32)> = Vec::with_capacity(3 * triangles.len());
    let mut corner_sets: Vec<[u32; 3]> = Vec::with_capacity(triangles.len());
    for (t, &[a, b, c]) in triangles.iter().enumerate() {
        if a == b || b == c || c == a {
            return Err(format!("triangle {a} {b} {c} repeats a vertex"));
        }
        let t = 3 * t as u32;
        sides.extend([(a, b, t), (b, c, t + 1), (c, a, t + 2)]);
        let mut set = [a, b, c];
        set.sort_unstable();
        corner_sets.push(set);
    }
    corner_sets.sort_unstable();
    if let Some(twice) = corner_sets.windows(2).find(|pair| pair[0] == pair[1]) {
        return Err(format!("two triangles on {:?}", twice[0]));
    }
    sides.sort_unstable();
    if let Some(twice) = sides.windows(2).find(|pair| (pair[0].0, pair[0].1) == (pair[1].0, pair[1].1)) {
        return Err(format!("directed side {} {} twice", twice[0].0, twice[0].1));
    }
    let mut fans = Joined::new(3 * triangles.len());
    let mut parts = Joined::new(vertices);
    let mut loops = Joined::new(vertices);
    let mut open = Vec::new();
    for &(a, b, side) in &sides {
        parts.join(a, b);
        // The corner that a side ends in.
        let end = |side: u32| side - side % 3 + (side + 1) % 3;
        match sides.binary_search_by_key(&(b, a), |&(from, to, _)| (from, to)) {
            Ok(other) => {
                let other = sides[other].2;
                fans.join(side, end(other));
                fans.join(end(side), other);
            }
            Err(_) => {
                loops.join(a, b);
                open.push(a);
            }
        }
    }
    let mut fans_at = vec![0; vertices];
    for (t, triangle) in triangles.iter().enumerate() {
        for (k, &v) in triangle.iter().enumerate() {
            let corner = (3 * t + k) as u32;
            fans_at[v as usize] += u32::from(fans.root(corner) == corner);
        }
    }
    if let Some(v) = fans_at.iter().position(|&fans| fans != 1) {
        return Err(format!("vertex {v} has {} fans", fans_at[v]));
    }
    let mut components = vec![(0, 0); vertices];
    for v in 0..vertices as u32 {
        components[parts.root(v) as usize].0 += 1;
    }
    for &(a, b, _) in &sides {
        let part = &mut components[parts.root(a) as usize].0;
        *part -=
            i64::from(a < b || sides.binary_search_by_key(&(b, a), |&(from, to, _)| (from, to)).is_err());
    }
    for triangle in triangles {
        components[parts.root(triangle[0]) as usize].0 += 1;
    }
    for v in open {
        if loops.root(v) == v {
            components[parts.root(v) as usize].1 += 1;
        }
    }
    let mut found: Vec<Component> =
        (0..vertices as u32).filter(|&v| parts.root(v) == v).map(|v| components[v as usize]).collect();
    found.sort_unstable();
    Ok(found)
}

/// Disjoint sets.
struct Joined(Vec<u32>);

impl Joined {
    fn new(n: usize) -> Self {
        Self((0..n as u32).collect())
    }

    fn root(&mut self, mut v: u32) -> u32 {
        while self.0[v as usize] != v {
            self.0[v as usize] = self.0[self.0[v as usize] as usize];
            v = self.0[v as usize];
        }
        v
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b) as usize] = a.min(b);
    }
}
