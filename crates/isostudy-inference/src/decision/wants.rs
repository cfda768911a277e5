//! What somebody may want of a mesh, and who is the best at it on each object.

use super::{Candidate, Each, Estimate, ObjectCandidates};
use crate::mesh_set::known;
use isostudy_design::config::{ObjectSection, Quantity};
use isostudy_design::{Method, MethodId};

/// What somebody may want; times are in milliseconds, errors in edges of the object's cubes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Goal {
    /// What people like most: the largest worth.
    Preferred,
    /// The shortest time.
    Fastest,
    /// The shortest time for a chunk.
    Chunk,
    /// The shortest time for an edit, in chunks.
    Edit,
    /// The shortest time from stored samples.
    StoredFastest,
    /// The same for a chunk.
    StoredChunk,
    /// The same for an edit.
    StoredEdit,
    /// The smallest mean error.
    Closest,
    /// The same with as many triangles.
    ClosestPerTriangle,
    /// The smallest mean error at sharp edges.
    SharpEdges,
    /// The largest mean radius ratio.
    Regular,
    /// The shortest time without a fault in the mesh.
    Faultless,
    /// The same with the topology of the interpolated samples.
    Topology,
}

/// One quantity that somebody wants, of the methods that can be compared in it.
pub struct Want {
    /// What it is.
    pub goal: Goal,
    among: Among,
    quantity: fn(&Candidate<'_>) -> Option<Estimate>,
    is_larger_better: bool,
    /// What decides between those that are not told apart from the best, if not the quantity itself; less is better.
    between: fn(&Candidate<'_>) -> Option<Estimate>,
    /// Times that are compared one by one, if they are there.
    pairs: for<'b> fn(&'b Candidate<'_>) -> Option<&'b Each>,
}

/// Times the best: who is farther from it is not taken in its place, however wide the intervals of a busy machine are.
const CLOSE: f64 = 1.05;

/// Who takes part.
#[derive(Clone, Copy, PartialEq)]
enum Among {
    /// Those with the object's own cubes.
    SameCells,
    /// The same, without a fault in the mesh.
    Faultless,
    /// The same, with as many components and tunnels as the trilinear interpolant of the samples.
    RightTopology,
    /// Those with as many triangles as one of them, and that one.
    SameTriangles,
    /// Everybody.
    All,
}

impl Want {
    /// A number without a unit, of those with the object's own cubes; less is better.
    const PLAIN: Self = Self {
        goal: Goal::Preferred,
        among: Among::SameCells,
        quantity: |_| None,
        is_larger_better: false,
        between: |_| None,
        pairs: |_| None,
    };
}

const WANTS: [Want; 13] = [
    Want {
        goal: Goal::Preferred,
        among: Among::All,
        quantity: |of| of.preference,
        is_larger_better: true,
        ..Want::PLAIN
    },
    Want {
        goal: Goal::Fastest,
        quantity: |of| of.time_s.map(milliseconds),
        between: |of| of.error,
        ..Want::PLAIN
    },
    Want {
        goal: Goal::Chunk,
        quantity: |of| of.chunks.as_ref().map(|of| milliseconds(of.median_s)),
        between: |of| of.error,
        pairs: |of| of.chunks.as_ref(),
        ..Want::PLAIN
    },
    Want {
        goal: Goal::Edit,
        quantity: |of| of.edits.as_ref().map(|of| milliseconds(of.median_s)),
        between: |of| of.error,
        pairs: |of| of.edits.as_ref(),
        ..Want::PLAIN
    },
    Want {
        goal: Goal::StoredFastest,
        quantity: |of| of.stored.as_ref()?.whole_s.map(milliseconds),
        between: |of| of.error,
        ..Want::PLAIN
    },
    Want {
        goal: Goal::StoredChunk,
        quantity: |of| Some(milliseconds(of.stored.as_ref()?.chunks.as_ref()?.median_s)),
        between: |of| of.error,
        pairs: |of| of.stored.as_ref()?.chunks.as_ref(),
        ..Want::PLAIN
    },
    Want {
        goal: Goal::StoredEdit,
        quantity: |of| Some(milliseconds(of.stored.as_ref()?.edits.as_ref()?.median_s)),
        between: |of| of.error,
        pairs: |of| of.stored.as_ref()?.edits.as_ref(),
        ..Want::PLAIN
    },
    Want { goal: Goal::Closest, quantity: |of| of.error, between: |of| of.time_s, ..Want::PLAIN },
    Want {
        goal: Goal::ClosestPerTriangle,
        among: Among::SameTriangles,
        quantity: |of| of.error,
        between: |of| of.time_s,
        ..Want::PLAIN
    },
    Want { goal: Goal::SharpEdges, quantity: |of| of.sharp_edges, between: |of| of.time_s, ..Want::PLAIN },
    Want {
        goal: Goal::Regular,
        quantity: |of| known(&of.mesh.judged().quality.radius_ratio, |ratio| ratio.mean).map(Estimate::exact),
        is_larger_better: true,
        ..Want::PLAIN
    },
    Want {
        goal: Goal::Faultless,
        among: Among::Faultless,
        quantity: |of| of.time_s.map(milliseconds),
        between: |of| of.error,
        ..Want::PLAIN
    },
    Want {
        goal: Goal::Topology,
        among: Among::RightTopology,
        quantity: |of| of.time_s.map(milliseconds),
        between: |of| of.error,
        ..Want::PLAIN
    },
];

fn milliseconds(seconds: Estimate) -> Estimate {
    let Estimate { value, low, high } = seconds;
    Estimate { value: 1e3 * value, low: 1e3 * low, high: 1e3 * high }
}

/// The best at a want, and the objects on which it is.
pub struct Pick<'a> {
    /// What is wanted.
    pub want: &'static Want,
    /// The best at it.
    pub method: &'a Method,
    /// Where.
    pub on: Vec<Best<'a>>,
}

/// What to take on one object: the best, or one that is not told apart from it.
pub struct Best<'a> {
    pub object: &'a ObjectSection,
    pub value: Estimate,
    /// The best of all others, and its value; `None` where no other qualifies.
    pub next: Option<(&'a Method, Estimate)>,
    /// Which others are not told apart from the best.
    pub alike: Vec<MethodId>,
    /// Whether nobody was shown to be worse.
    pub is_everybody_alike: bool,
    pub cost: Cost,
}

/// What the best has to be paid with, beside all with the object's own cubes; among those with as many triangles, beside them.
pub struct Cost {
    /// Its time over the shortest; `None` where there are no times.
    pub time: Option<f64>,
    /// Its triangles over the fewest.
    pub triangles: f64,
    /// Values of the field that it asks for over the fewest; `None` where they were not counted.
    pub samples: Option<f64>,
    /// Bytes that its extraction takes beside the field over the least; `None` where nobody saw them.
    pub memory: Option<f64>,
    /// Its error over the smallest.
    pub error: Option<f64>,
    /// Pairs of triangles that pass through each other.
    pub crossing_triangles: u64,
    /// Edges and vertices at which the mesh is no manifold.
    pub no_manifold: u64,
}

/// The picks of every want that two methods or more can be compared in, want by want; methods in the study's order.
pub fn picks<'a>(objects: &[ObjectCandidates<'a>]) -> Vec<Pick<'a>> {
    let mut picks: Vec<Pick<'a>> = Vec::new();
    for want in &WANTS {
        let from = picks.len();
        for of in objects {
            let Some((method, best)) = want.best(of) else { continue };
            match picks[from..].iter_mut().find(|pick| pick.method.id == method.id) {
                Some(pick) => pick.on.push(best),
                None => picks.push(Pick { want, method, on: vec![best] }),
            }
        }
    }
    picks
}

impl Want {
    fn best<'a>(&'static self, of: &ObjectCandidates<'a>) -> Option<(&'a Method, Best<'a>)> {
        let pool = self.among.pool(&of.candidates);
        // Of equals the study's first.
        let mut ranked: Vec<(&Candidate<'a>, Estimate)> =
            pool.iter().filter_map(|&candidate| Some((candidate, (self.quantity)(candidate)?))).collect();
        let sign = if self.is_larger_better { -1.0 } else { 1.0 };
        ranked.sort_by(|a, b| (sign * a.1.value).total_cmp(&(sign * b.1.value)));
        let &(leader, least) = ranked.first()?;
        if of.candidates.len() < 2 || !self.among.is_strict() && ranked.len() < 2 {
            return None;
        }
        // By worths the top of the scale knows who was shown to differ from it.
        let most_liked = of.most_liked.as_ref().filter(|_| self.goal == Goal::Preferred);
        // Not where nobody is, or where whoever is differs from a candidate in its look alone, and is none.
        if self.goal == Goal::Preferred && most_liked.is_none_or(|top| top.best != leader.id()) {
            return None;
        }
        let is_alike = |(other, value): &&(&Candidate<'a>, Estimate)| {
            if let Some(top) = most_liked {
                return top.best == other.id() || top.alike.contains(&other.id());
            }
            let in_pairs = (self.pairs)(leader).zip((self.pairs)(other)).and_then(|(a, b)| a.may_equal(b));
            in_pairs.unwrap_or_else(|| value.meets(least))
        };
        let is_close = |(_, value): &&(&Candidate<'a>, Estimate)| value.value <= CLOSE * least.value;
        // The best of a run is chance among those that are not told apart from it.
        let tied: Vec<&(&Candidate<'a>, Estimate)> =
            ranked.iter().filter(is_alike).filter(is_close).collect();
        let between = |of: &Candidate<'_>| (self.between)(of);
        let least_of_tied =
            tied.iter().filter_map(|(of, _)| between(of)).min_by(|a, b| a.value.total_cmp(&b.value));
        let is_as_good = |of: &Candidate<'_>| least_of_tied.zip(between(of)).is_none_or(|(a, b)| a.meets(b));
        let &&(taken, value) = tied.iter().find(|(of, _)| is_as_good(of)).unwrap_or(&&ranked[0]);
        let others = || ranked.iter().filter(|(of, _)| of.id() != taken.id());
        let next = others().next().map(|(of, value)| (of.method, *value));
        let alike: Vec<MethodId> = others().filter(is_alike).map(|(of, _)| of.id()).collect();
        let is_everybody_alike = !alike.is_empty() && alike.len() == others().count();
        let cost = match self.among {
            Among::SameTriangles => Cost::of(taken, &pool),
            _ => Cost::of(taken, &Among::SameCells.pool(&of.candidates)),
        };
        Some((taken.method, Best { object: of.object, value, next, alike, is_everybody_alike, cost }))
    }
}

impl Cost {
    fn of(taken: &Candidate<'_>, beside: &[&Candidate<'_>]) -> Self {
        let over_least = |quantity: fn(&Candidate<'_>) -> Option<f64>| {
            let least = beside.iter().filter_map(|&of| quantity(of)).min_by(f64::total_cmp);
            Some(quantity(taken)? / least.filter(|&least| least > 0.0)?)
        };
        let topology = &taken.mesh.topology;
        Self {
            time: over_least(|of| of.time_s.map(|time| time.value)),
            triangles: over_least(|of| Some(of.triangles().value)).unwrap_or(1.0),
            samples: over_least(|of| of.mesh.counts.evaluations.map(|calls| calls as f64)),
            memory: over_least(|of| of.memory.map(|bytes| bytes as f64)),
            error: over_least(|of| of.error.map(|error| error.value)),
            crossing_triangles: taken.mesh.judged().self_intersections.unwrap_or(0),
            no_manifold: topology.non_manifold_edges + topology.non_manifold_vertices,
        }
    }
}

impl Among {
    /// Whether a single one that qualifies is worth naming.
    fn is_strict(self) -> bool {
        matches!(self, Self::Faultless | Self::RightTopology)
    }

    fn pool<'b, 'a>(self, all: &'b [Candidate<'a>]) -> Vec<&'b Candidate<'a>> {
        let same_cells = |of: &Candidate<'_>| of.method.budget.is_none();
        let models: Vec<MethodId> = all
            .iter()
            .filter_map(|of| of.method.budget.filter(|budget| budget.quantity == Quantity::Triangles))
            .map(|budget| budget.of)
            .collect();
        // A study may match several; the first is taken.
        let model = models.first().copied();
        // Where no mesh is closed, the object itself ends at its box.
        let can_close = all.iter().any(|of| of.mesh.topology.boundary_edges == 0);
        let is_whole = |of: &Candidate<'_>| of.mesh.topology.boundary_edges == 0 || !can_close;
        let matched = |of: &Candidate<'_>| match of.method.budget {
            Some(budget) => budget.quantity == Quantity::Triangles && Some(budget.of) == model,
            None => Some(of.id()) == model,
        };
        let is_faultless = |of: &Candidate<'_>| same_cells(of) && of.is_faultless() && is_whole(of);
        let takes = |of: &&Candidate<'_>| match self {
            Self::SameCells => same_cells(of),
            Self::Faultless => is_faultless(of),
            Self::RightTopology => is_faultless(of) && of.has_right_topology(),
            Self::SameTriangles => matched(of),
            Self::All => true,
        };
        all.iter().filter(takes).collect()
    }
}
