//! Convex hulls of a few points with whole coordinates, by trying every plane.

/// What three or more points span.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum Hull {
    /// Facets as numbers of points, counter-clockwise seen from outside, each beginning with its lowest number; in order.
    Solid(Vec<Vec<u8>>),
    /// All points lie in one plane, or on a line.
    Flat,
}

pub(crate) type Place = [i32; 3];

/// The hull of points of which none lies between others.
pub(crate) fn hull(points: &[Place]) -> Hull {
    let mut facets: Vec<(u32, Vec<u8>)> = Vec::new();
    let n = points.len();
    for i in 0..n {
        for j in i + 1..n {
            for k in j + 1..n {
                let known = 1 << i | 1 << j | 1 << k;
                if facets.iter().any(|(members, _)| members & known == known) {
                    continue;
                }
                let normal = normal([points[i], points[j], points[k]]);
                if normal == [0; 3] {
                    continue;
                }
                let [mut above, mut below, mut members] = [0u32; 3];
                for (p, &point) in points.iter().enumerate() {
                    match dot(normal, minus(point, points[i])) {
                        0 => members |= 1 << p,
                        1.. => above |= 1 << p,
                        _ => below |= 1 << p,
                    }
                }
                match (above, below) {
                    (0, 0) => return Hull::Flat,
                    (0, _) => facets.push((members, polygon(points, members, normal))),
                    (_, 0) => facets.push((members, polygon(points, members, normal.map(|n| -n)))),
                    _ => {}
                }
            }
        }
    }
    if facets.is_empty() {
        return Hull::Flat;
    }
    let mut facets: Vec<Vec<u8>> = facets.into_iter().map(|(_, polygon)| polygon).collect();
    in_order(&mut facets);
    Hull::Solid(facets)
}

/// Sorts a few items. What sorts many is 4 kB in a module for a page.
pub(crate) fn in_order<T: Ord>(items: &mut [T]) {
    for end in 1..items.len() {
        let mut at = end;
        while at > 0 && items[at - 1] > items[at] {
            items.swap(at - 1, at);
            at -= 1;
        }
    }
}

/// Points of one plane in order, counter-clockwise seen from where the normal points, the lowest number first.
pub(crate) fn polygon(points: &[Place], members: u32, normal: Place) -> Vec<u8> {
    let members: Vec<u8> = (0..points.len() as u8).filter(|&p| members >> p & 1 != 0).collect();
    let at = |p: u8| points[usize::from(p)];
    let mut order = vec![members[0]];
    while order.len() < members.len() {
        let last = *order.last().expect("it begins with one");
        // The next one has all others on its left.
        let next = members.iter().copied().filter(|p| !order.contains(p)).find(|&next| {
            let side = minus(at(next), at(last));
            let left = |p: u8| dot(normal, cross(side, minus(at(p), at(last)))) >= 0;
            members.iter().all(|&p| left(p))
        });
        order.push(next.expect("the points are corners of a convex polygon"));
    }
    order
}

pub(crate) fn normal([a, b, c]: [Place; 3]) -> Place {
    cross(minus(b, a), minus(c, a))
}

pub(crate) fn minus(a: Place, b: Place) -> Place {
    [0, 1, 2].map(|i| a[i] - b[i])
}

pub(crate) fn plus(a: Place, b: Place) -> Place {
    [0, 1, 2].map(|i| a[i] + b[i])
}

pub(crate) fn dot(a: Place, b: Place) -> i32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Place, b: Place) -> Place {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cube_has_six_squares_and_faces_outward() {
        let points: Vec<Place> = (0..8).map(|i| [i & 1, i >> 1 & 1, i >> 2]).collect();
        let Hull::Solid(facets) = hull(&points) else { panic!("a cube is solid") };
        assert_eq!(facets.len(), 6);
        // Six times the volume by the divergence theorem: 6 for the unit cube.
        let at = |p: u8| points[usize::from(p)];
        let volume: i32 = facets
            .iter()
            .flat_map(|f| (1..f.len() - 1).map(|i| [at(f[0]), at(f[i]), at(f[i + 1])]))
            .map(|[a, b, c]| dot(a, cross(b, c)))
            .sum();
        assert_eq!(volume, 6);
    }

    #[test]
    fn points_of_a_plane_are_flat() {
        assert_eq!(hull(&[[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]), Hull::Flat);
        assert_eq!(hull(&[[0, 0, 0], [1, 1, 1]]), Hull::Flat);
    }
}
